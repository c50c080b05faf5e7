/* A glTF file on its way out: its arrays planned and, where that is asked for, compressed. */
#ifndef FORMATS_GLTF_GLTF_PACK_H
#define FORMATS_GLTF_GLTF_PACK_H

#include "formats/gltf/gltf_document.h"

/* Bytes of the file, compressed, in memory. */
typedef struct cwi_gltf_block {
    unsigned char *bytes;
    size_t size;
} cwi_gltf_block;

/* A zeroed plan is empty; free it with cwi_gltf_plan_free(). */
typedef struct cwi_gltf_plan {
    cwi_parts parts; /* as they are written: with one origin and in another order, if that
                        is what compression needs */
    cw_mesh *own;    /* the arrays of those parts that are not the caller's */
    cwi_gltf_piece *pieces;
    cwi_gltf_document document;
    bool rounded;               /* positions are on the grid, and normals are bytes */
    cwi_quantization_grid grid; /* bits 0: positions are as they were */
    cwi_gltf_block *blocks;     /* of the whole buffer, one behind another; NULL: as planned */
    size_t block_count, block_room;
    unsigned char *keys; /* of the animation: behind all else in the buffer; NULL: none */
    size_t keys_size;
    unsigned char linear[256]; /* of sRGB */
} cwi_gltf_plan;

/* Plans a file for what out->desc asks for.
 * Returns CW_ERR_CHECK when what is compressed cannot keep what was promised, CW_ERR_LIMIT when
 * the buffer is too large, CW_ERR_UNSUPPORTED, CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_gltf_plan_make(cwi_gltf_plan *plan, const cwi_parts *parts,
                                          const cwi_mesh_output *out, cw_error *err);
void cwi_gltf_plan_free(cwi_gltf_plan *plan);

/* Arrays for a part, uncompressed: as they are, or on the plan's grid (a dyadic one: as the
 * exponential filter of EXT_meshopt_compression has them). */
void cwi_gltf_plan_arrays(const cwi_gltf_plan *plan, cwi_gltf_piece *piece);

/* Rounds, compresses and verifies; fills pieces and blocks. As cwi_gltf_plan_make(). */
CW_NODISCARD cw_status cwi_gltf_compress(cwi_gltf_plan *plan, const cw_write_desc *desc,
                                         cw_error *err);

/* Plans the animation that shows the parts, if there is one, behind what is planned already. */
CW_NODISCARD cw_status cwi_gltf_plan_animation(cwi_gltf_plan *plan, cw_error *err);

/* Puts element i of an array at to: array->stride bytes. */
void cwi_gltf_put(const cwi_gltf_plan *plan, const cwi_gltf_piece *piece,
                  const cwi_gltf_array *array, size_t i, unsigned char *to);

/* The number that the accessor of positions holds for a coordinate, filters undone. */
double cwi_gltf_stored(const cwi_gltf_plan *plan, float coordinate, int axis);

#endif
