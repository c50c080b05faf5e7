/* The topology of { f >= iso } for the trilinear field f of a small grid, found without the
 * extractor: slow, and in two ways that share no idea. Outside the grid everything is outside,
 * so the surface is closed. */
#ifndef TESTS_TRUTH_H
#define TESTS_TRUTH_H

#include <stdbool.h>
#include <stddef.h>

typedef struct test_truth {
    bool decidable;    /* the two ways agree */
    size_t components; /* closed surfaces: components of inside and of outside, less one */
    long euler;        /* of the surface: twice that of the inside */
} test_truth;

/* Both ways: pictures finer and finer until two in a row agree with the critical points.
 * voxels   packed, x fastest; at most 16 along an axis, finite
 * Threads  reentrant */
test_truth test_topology_of(const float *voxels, const size_t dim[3], float iso);

/* One way: a picture of `points` (2 to 64) points a cell and axis. Always decidable. */
test_truth test_topology_pictured(const float *voxels, const size_t dim[3], float iso,
                                  size_t points);

/* The other: counting critical points. Decidable unless one is too close to call. */
test_truth test_topology_counted(const float *voxels, const size_t dim[3], float iso);

/* Both ways where samples or saddles stand on the isovalue. There pictures are of no use: the
 * inside has parts without any width. But it is closed, so a step below the isovalue it is the
 * same with some width, as far as no critical value lies between; which the count knows. */
test_truth test_topology_tied(const float *voxels, const size_t dim[3], float iso, float step);

/* Disjoint sets of the numbers below count: all alone at first; whose number a set goes by;
 * join two, and whether they were apart. */
void test_sets_start(size_t *sets, size_t count);
size_t test_sets_find(size_t *sets, size_t n);
bool test_sets_join(size_t *sets, size_t a, size_t b);

#endif
