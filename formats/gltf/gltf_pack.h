/* The plan of a glTF file to write: its arrays and, if requested, their compressed bytes. */
#ifndef FORMATS_GLTF_GLTF_PACK_H
#define FORMATS_GLTF_GLTF_PACK_H

#include "formats/gltf/gltf_document.h"

/* A block of compressed bytes of the file, in memory. */
typedef struct cwi_gltf_block {
    unsigned char *bytes;
    size_t size;
} cwi_gltf_block;

/* The plan of a file. A zeroed one is empty; free it with cwi_gltf_plan_free(). */
typedef struct cwi_gltf_plan {
    cwi_parts parts; /* as they are written: with one origin and in another order, if the
                        compression needs that */
    cw_mesh *own;    /* the arrays of parts that are copies */
    cw_mesh
        *seamed;    /* the arrays of parts whose vertices were split at seams of the texture, */
    cw_mesh *split; /* and of those split by colour after that */
    float *
        settled; /* positions of all parts, where the grid moved some; NULL: they are as they came */
    cwi_gltf_piece *pieces;
    cwi_gltf_document document;
    bool rounded;               /* positions are on the grid, and normals are bytes */
    cwi_quantization_grid grid; /* bits 0: positions are unchanged */
    cwi_gltf_block *blocks;     /* of the whole buffer, one after another; NULL: as planned */
    size_t block_count, block_capacity;
    unsigned char *keys; /* of the animation, at the end of the buffer; NULL: none */
    size_t keys_size;
    uint16_t linear[256]; /* linear values of sRGB bytes, in 16 bits */
    bool fits_byte[256];  /* 8 bits of linear light give the sRGB byte back */
} cwi_gltf_plan;

/* Plans a file as out->desc requests.
 * Returns CW_ERR_CHECK when compression cannot keep the tolerance, CW_ERR_LIMIT when
 * the buffer is too large, CW_ERR_UNSUPPORTED, CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_gltf_plan_make(cwi_gltf_plan *plan, const cwi_parts *parts,
                                          const cwi_mesh_output *out, cw_error *err);
void cwi_gltf_plan_free(cwi_gltf_plan *plan);

/* The component type of accessors of single precision. */
enum { CWI_GLTF_FLOAT = 5126 };

/* Returns true if positions are stored on the plan's grid. */
static inline bool cwi_gltf_on_grid(const cwi_gltf_plan *plan)
{
    return plan->rounded && plan->grid.bits;
}

/* Plans arrays for a part, uncompressed: unchanged, or on the plan's grid. A dyadic grid gives
 * numbers for the exponential filter of EXT_meshopt_compression. */
void cwi_gltf_plan_arrays(const cwi_gltf_plan *plan, cwi_gltf_piece *piece);

/* Computes the tangents of a part with a normal map, if it has normals. Its arrays are final.
 * Returns CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_gltf_add_tangents(cwi_gltf_piece *piece, cw_error *err);

/* Stores colours in 8 bits each, for Draco, whatever the loss. */
void cwi_gltf_use_bytes(cwi_gltf_array *colors);

/* Rounds, compresses and verifies; fills pieces and blocks. Returns as cwi_gltf_plan_make(). */
CW_NODISCARD cw_status cwi_gltf_compress(cwi_gltf_plan *plan, const cw_write_desc *desc,
                                         cw_error *err);

/* Plans the animation that shows the parts, if there is one, behind the planned arrays. */
CW_NODISCARD cw_status cwi_gltf_plan_animation(cwi_gltf_plan *plan, cw_error *err);

/* Puts element i of an array at `to`: array->stride bytes. */
void cwi_gltf_put(const cwi_gltf_plan *plan, const cwi_gltf_piece *piece,
                  const cwi_gltf_array *array, size_t i, unsigned char *to);

/* Returns the number that the accessor of positions holds for a coordinate, with filters
 * undone. */
double cwi_gltf_stored(const cwi_gltf_plan *plan, float coordinate, int axis);

#endif
