/* Random solids, to try booleans on: closed meshes in pairs of several kinds. */
#ifndef TESTS_SOLIDS_H
#define TESTS_SOLIDS_H

#include "support/surface.h"

/* Kinds of pairs. */
typedef enum test_pair_kind {
    PAIR_FIELDS, /* extracted spheres, tori and gyroids, turned and moved */
    PAIR_SCANS,  /* extracted noise of few grey values, moved by halves of voxels */
    PAIR_BOXES,  /* boxes between whole numbers: they touch in faces, edges and points */
    PAIR_COPIES, /* a solid and its copy, turned by less than floats can tell, or a little more */
    PAIR_NEEDLES, /* needles and plates, 0.0001 to 10 thick, that cross */
    PAIR_SHELLS,  /* nested shells, outward and inward alternately */
    PAIR_SPHERES, /* several spheres in a mesh, which overlap */
    PAIR_STARS,   /* polyhedra with spikes */
    PAIR_FACES,   /* boxes that share faces, then turned and rounded */
    PAIR_CROPS, /* blocks of a real scan in one place: their faces at the border lie in common planes */
    PAIR_KINDS
} test_pair_kind;

extern const char *const test_pair_names[PAIR_KINDS];

/* Makes a pair, which the seed decides, by rand(). One in five is 1e-6 as large, one in five 1e6 times. Free both. */
void test_make_pair(test_pair_kind kind, unsigned seed, cw_mesh pair[2]);

/* Returns true if CUBEWRIGHT_DATA has the scan that PAIR_CROPS needs. */
bool test_has_scan(void);

/* Returns a random number from 0 to less than 1, by rand(). */
double test_random(void);

/* Returns a mesh without triangles, with capacity for boxes. */
cw_mesh test_make_boxes(size_t capacity);

/* Adds a box to a mesh with capacity for it. */
void test_add_box(cw_mesh *mesh, const double low[3], const double high[3], bool inward);

/* Extracts a field of n x n x n voxels. */
cw_mesh test_extract_field(cw_field field, size_t n);

/* Turns a mesh about z, moves and scales it, and drops its normals. */
void test_move_mesh(cw_mesh *mesh, double angle, double scale, const double by[3]);

/* Names what keeps a mesh from being closed, oriented, a manifold without crossings; or NULL. */
const char *test_solid_fault(const cw_mesh *mesh);

/* Fails unless a mesh is closed, oriented, a manifold, and does not cross itself. */
void test_check_solid(const cw_mesh *mesh);

#endif
