/* Verification that compressed bytes hold the mesh that was compressed, by decoding them. */
#ifndef FORMATS_CODEC_VERIFY_DECODED_H
#define FORMATS_CODEC_VERIFY_DECODED_H

#include "formats/codec/quantization_grid.h"

/* A mesh as a decoder returns it, in any order: positions, or numbers of the grid in their place. */
typedef struct cwi_decoded {
    size_t vertex_count, triangle_count;
    const float *positions;      /* vertex_count x 3; where the grid has no bits */
    const uint32_t *grid_points; /* vertex_count x 3 */
    const float *normals;        /* vertex_count x 3; NULL: none */
    const uint32_t *triangles;
    const float *texture;         /* vertex_count x 2: texture coordinates; NULL: none */
    const float *texture_encoded; /* those of the mesh's vertices; NULL: none */
    int texture_bits;             /* that each of them kept */
    const float *tangents, *tangents_encoded; /* the same of tangents, x 4; NULL: none */
} cwi_decoded;

/* Compares a decoded mesh with the one that was encoded. It must have the same triangles
 * between the same positions, each equally often and with the same winding. A vertex must have
 * a texture coordinate that one at its position had.
 * normal_degrees  set to the largest turn of a normal
 * Returns CW_ERR_CHECK, with the difference; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_verify(const cw_mesh *mesh, const cwi_quantization_grid *grid,
                                  const cwi_decoded *decoded, double *normal_degrees,
                                  cw_error *err);

#endif
