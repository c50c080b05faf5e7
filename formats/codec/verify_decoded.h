/* Whether compressed bytes hold what was compressed: asked of the decoded mesh. */
#ifndef FORMATS_CODEC_VERIFY_DECODED_H
#define FORMATS_CODEC_VERIFY_DECODED_H

#include "formats/codec/quantization_grid.h"

/* A mesh as a decoder gives it back: places on the grid, in any order. */
typedef struct cwi_decoded {
    size_t vertex_count, triangle_count;
    const uint32_t *places; /* vertex_count x 3 */
    const float *normals;   /* vertex_count x 3; NULL: none */
    const uint32_t *triangles;
} cwi_decoded;

/* Holds a decoded mesh against the one that was encoded: the same triangles between the same
 * places of the grid, each as often and wound the same way.
 * normal_degrees  set to the most that a normal was turned
 * Returns CW_ERR_CHECK, saying what differs; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_verify(const cw_mesh *mesh, const cwi_quantization_grid *grid,
                                  const cwi_decoded *decoded, double *normal_degrees,
                                  cw_error *err);

#endif
