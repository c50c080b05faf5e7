/* Surfaces under test: made, compared, and held against what every surface must be. */
#ifndef TESTS_SURFACE_H
#define TESTS_SURFACE_H

#include "support/support.h"

/* A field in n x n x n voxels; free it. */
cw_volume test_sample(cw_field field, size_t n, cw_type type);

/* Its mesh; the test fails where extraction does. */
cw_mesh test_extract(const cw_volume *volume, const cw_extract_desc *desc,
                     cw_extract_counts *counts);

/* What of the promise on any input a mesh does not keep, in words; NULL when it keeps all: a
 * manifold, indexed and welded, without zero-area triangles, equal points or equal triangles,
 * with finite positions and unit normals, and no edge open unless open is asked for.
 * quality  as indexed; may be NULL */
const char *test_mesh_fault(const cw_mesh *mesh, bool open, cw_quality *quality);

/* Fails with the fault if there is one. */
cw_quality test_check_promise(const cw_mesh *mesh, bool open);

/* Every vertex normal is on the outer side of every triangle around it: of smooth fields. */
bool test_normals_agree(const cw_mesh *mesh);

void test_assert_same_mesh(const cw_mesh *a, const cw_mesh *b);

/* A random affine with shear; every third one a mirror. */
void test_turn(cw_volume *volume, int round);

#endif
