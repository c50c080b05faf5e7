/* Surfaces under test: made, compared, and held against what every surface must be. */
#ifndef TESTS_SURFACE_H
#define TESTS_SURFACE_H

#include "support/support.h"

/* A field in n x n x n voxels; free it. */
cw_volume test_sample(cw_field field, size_t n, cw_type type);

/* Its mesh; the test fails where extraction does. */
cw_mesh test_extract(const cw_volume *volume, const cw_extract_desc *desc,
                     cw_extract_counts *counts);

/* Names a part of the promise on any input that a mesh breaks, or NULL when it keeps all:
 * a manifold, indexed and welded, without zero-area triangles, equal points or equal triangles,
 * with finite positions and unit normals, and no edge open unless open is asked for.
 * quality  as indexed; may be NULL */
const char *test_mesh_fault(const cw_mesh *mesh, bool open, cw_quality *quality);

/* Fails with the fault if there is one. */
cw_quality test_check_promise(const cw_mesh *mesh, bool open);

/* Every vertex normal is on the outer side of every triangle around it: of smooth fields. */
bool test_normals_agree(const cw_mesh *mesh);

/* The same, but for triangles thinner than a fraction of the largest coordinate: crossings are
 * kept off the samples by a part of an edge, which tilts the smallest triangles. */
bool test_normals_agree_but(const cw_mesh *mesh, double share);

void test_assert_same_mesh(const cw_mesh *a, const cw_mesh *b);

/* The same triangles, to the bit, in any order. */
void test_assert_same_triangles(const cw_mesh *a, const cw_mesh *b);

/* Its quality, with default settings. */
cw_quality test_measure(const cw_mesh *mesh);

/* Pairs of triangles that meet and should not. */
size_t test_count_crossings(const cw_mesh *mesh);

/* Names the topology or soundness of a sound mesh that a reduced one has lost, in words; or
 * NULL. */
const char *test_reduced_fault(const cw_mesh *before, const cw_mesh *after);
void test_assert_sound(const cw_mesh *before, const cw_mesh *after);

/* Fails each allocation of a repair in turn: it says so, and leaves nothing. There are more than `least`. */
void test_repair_without_memory(const cw_mesh *mesh, const cw_repair_desc *desc, long least);

/* No point of a is farther than so much from b: by our measure; and where it is there by CGAL's,
 * which takes minutes for 100,000 triangles. */
void test_bound_is_measured(const cw_mesh *a, const cw_mesh *b, double error_mm);
void test_bound_is_kept(const cw_mesh *a, const cw_mesh *b, double error_mm);

/* A random affine with shear; every third one a mirror. */
void test_turn(cw_volume *volume, int round);

#endif
