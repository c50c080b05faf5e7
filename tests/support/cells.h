/* Irregular grids under test: made cell by cell, or a box cut into cells of many shapes. */
#ifndef TESTS_CELLS_H
#define TESTS_CELLS_H

#include "support/support.h"

/* A grid under construction. Zeroed it is empty; it has to stay where it is, as the volume
 * points into it. */
typedef struct test_grid {
    cw_volume volume; /* doubles */
    cw_cells cells;
    double *points, *values;
    uint8_t *shapes;
    uint32_t *corners;
    size_t samples, corner_count, room[3]; /* of samples, cells, corners */
} test_grid;

/* A new sample, of value 0; its number. */
uint32_t test_grid_sample(test_grid *g, double x, double y, double z);
void test_grid_cell(test_grid *g, cw_shape shape, const uint32_t *corners);
void test_grid_free(test_grid *g);

/* The first corner of a cell. */
uint32_t *test_grid_corners(test_grid *g, size_t cell);

/* Turns a cell inside out: what its corners name is its mirror image. */
void test_grid_mirror(test_grid *g, size_t cell);

/* How a box is cut. Mixed has all four shapes: from low to high x hexahedra, pyramids around
 * centres, tetrahedra around centres, pyramids and tetrahedra, wedges. */
typedef enum test_cut {
    TEST_TETRAHEDRA, /* six in a box */
    TEST_PYRAMIDS,   /* six around its centre */
    TEST_WEDGES,     /* two */
    TEST_HEXAHEDRA,
    TEST_MIXED,
    TEST_CUT_COUNT
} test_cut;

/* The box from -1 to 1, cut into n x n x n boxes and these into cells that fit together. Inner
 * points are moved at random by up to so much of a box. The samples of the lattice come first,
 * x fastest. */
void test_grid_make(test_grid *g, test_cut cut, size_t n, double jitter);

/* Values from a function of the point. */
void test_grid_fill(test_grid *g, double (*field)(const double p[3]));

#endif
