/* Encoding of a mesh by Draco, verified by decoding it again. */
#ifndef FORMATS_CODEC_DRACO_PACK_H
#define FORMATS_CODEC_DRACO_PACK_H

#include "formats/codec/draco_wrap.h"

/* The encoded and the decoded mesh. Free it with cwi_draco_packed_free(). */
typedef struct cwi_draco_packed {
    unsigned char *bytes;
    size_t size;
    cwi_draco_ids ids;
    cwi_arrays decoded; /* places on the grid in place of positions, if it has bits */
} cwi_draco_packed;

/* Encodes a mesh on a grid, or with positions as they are if it has no bits. No triangle may name a vertex twice.
 * colors   vertex_count x 4, in place of the mesh's; NULL: none
 * texture  vertex_count x 2: texture coordinates; NULL: none
 * tangents vertex_count, with texture coordinates; NULL: none
 * comment  of the file; NULL: none
 * desc     for its level
 * facts    adds the seconds used, and raises the normals' error to the maximum
 * Returns  CW_ERR_CHECK when the decoded mesh is not the one that was encoded; CW_ERR_BACKEND;
 *          CW_ERR_UNSUPPORTED; CW_ERR_LIMIT for more bits than memory allows; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_draco_pack(const cw_mesh *mesh, const uint8_t *colors,
                                      const float *texture, const float (*tangents)[4],
                                      const cwi_quantization_grid *grid, const char *comment,
                                      const cw_write_desc *desc, cwi_draco_packed *packed,
                                      cw_compressed *facts, cw_error *err);

/* Encodes a mesh whose positions are integers from 0 to 2^bits - 1, as integers; bits is at most
 * 16. Otherwise as cwi_draco_pack(). packed has no decoded mesh. */
CW_NODISCARD cw_status cwi_draco_pack_integers(const cw_mesh *mesh, int bits,
                                               const cw_write_desc *desc,
                                               cwi_draco_packed *packed, cw_compressed *facts,
                                               cw_error *err);
void cwi_draco_packed_free(cwi_draco_packed *packed);

/* Counts triangles that name a vertex twice: Draco cannot store them. */
size_t cwi_draco_count_degenerate(const cw_mesh *mesh);

/* Leaves such triangles out of a mesh that owns its triangles; no edge becomes open. */
void cwi_draco_drop_degenerate(cw_mesh *mesh);

#endif
