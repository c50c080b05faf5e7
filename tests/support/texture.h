/* Textures under test: areas and overlaps of triangles there. */
#ifndef TESTS_TEXTURE_H
#define TESTS_TEXTURE_H

#include "support/surface.h"

/* Texels of the pictures in which overlaps are looked for. */
enum { TEST_PICTURE = 1024 };

/* Returns the texture coordinates of corners; the test fails where there are none. */
const float (*test_coordinates(const cw_mesh *mesh))[2];

/* Returns the area of a triangle: positive as seen in the image, whose second axis goes down. */
double test_texture_area(const float (*uv)[2]);

/* Counts texels whose middle lies within two triangles, away from their sides by what single precision
 * rounds; sets the number that lie in one. */
size_t test_count_overlaps(const cw_mesh *mesh, size_t *covered);

/* Counts charts: sets of triangles that share edges and the places of both ends. */
size_t test_count_charts(const cw_mesh *mesh);

#endif
