/* Texels of a mesh's texture: the triangles that they lie in. */
#ifndef SIMPLIFY_BAKE_TEXELS_H
#define SIMPLIFY_BAKE_TEXELS_H

#include <cubewright/mesh.h>

#define CWI_NO_TEXEL UINT32_MAX

/* Sets the triangle in which the middle of each texel lies, CWI_NO_TEXEL where there is none; the first of
 * several. mesh: has texture coordinates of vertices, and fewer than 2^32 - 1 triangles
 * triangle  size x size, set; top row first */
void cwi_texels_find(const cw_mesh *mesh, uint32_t size, uint32_t *triangle);

/* Computes the weights of a triangle's corners at the middle of a texel. uv: two for each vertex */
void cwi_texel_weights(const float *uv, const uint32_t v[3], uint32_t size, uint32_t x,
                       uint32_t y, double weights[3]);

/* Gives texels beside filled ones the mean of these, step by step. Returns CW_ERR_NO_MEMORY.
 * triangle  as above
 * steps     texels, at most 254
 * texels    size x size x 3 */
CW_NODISCARD cw_status cwi_texels_spread(const uint32_t *triangle, uint32_t size,
                                         uint32_t steps, uint16_t *texels, cw_error *err);

/* Gives filled texels the mean of the filled ones among the nine around each. Returns CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_texels_smooth(const uint32_t *triangle, uint32_t size,
                                         uint16_t *texels, cw_error *err);

#endif
