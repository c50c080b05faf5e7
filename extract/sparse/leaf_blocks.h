/* The leaves and tiles of a sparse grid, sorted into blocks of cells that an engine can work
 * on.
 *
 * A block has the cells in CWI_BLOCK_X x _Y x _Z leaves. Cell (i, j, k) has the samples (i, j,
 * k) to (i+1, j+1, k+1). Blocks are counted from one before the first leaf, as the cells before
 * it have samples of it. */
#ifndef EXTRACT_SPARSE_LEAF_BLOCKS_H
#define EXTRACT_SPARSE_LEAF_BLOCKS_H

#include "extract/dense/isa_dispatch.h"

/* The size of a block in leaves. Along x a row of samples, with its surroundings, just fits a
 * word of bits. */
enum { CWI_BLOCK_X = 7, CWI_BLOCK_Y = 4, CWI_BLOCK_Z = 4 };

/* Number of the space outside all regions. */
#define CWI_BACKGROUND UINT32_MAX

/* A leaf or a tile: samples 8 * at to 8 * (at + size) - 1 along each axis. */
typedef struct cwi_region {
    uint32_t at[3], size[3];
    const void *voxels; /* of a leaf; NULL: a tile */
    double value;       /* of a tile */
} cwi_region;

/* A vertex on the low sides of its block: its edge, and its number. */
typedef struct cwi_seam {
    uint32_t key, number;
} cwi_seam;

/* A vertex on the high sides of a block, which belongs to one beyond them. */
typedef struct cwi_stranger {
    uint32_t vertex; /* as the engine numbers */
    uint32_t key;    /* in its own block */
    uint32_t beyond; /* bit a: its block is the next along axis a */
} cwi_stranger;

/* The mesh that the engine made from a block. */
typedef struct cwi_block_mesh {
    void *memory; /* of all that follows */
    float *positions, *normals;
    uint32_t *triangles;
    cwi_stranger *strangers; /* by rising vertex */
    size_t vertex_count, triangle_count, stranger_count;
} cwi_block_mesh;

typedef struct cwi_leaf_block {
    uint32_t at[3];
    uint32_t covered;    /* leaves whose samples its cells touch, of those that are kept */
    uint8_t sides;       /* CWI_OUTSIDE and CWI_INSIDE: of those, as far as they are kept */
    size_t first, count; /* of its regions, in cwi_leaf_blocks.region */
    size_t vertices, triangles; /* of its own; later, of the blocks before it */
    cwi_seam *seam;             /* by rising keys */
    size_t seam_count;
    cwi_block_mesh piece;
} cwi_leaf_block;

typedef struct cwi_leaf_blocks {
    const cw_volume *volume;
    cwi_leaf_block *block; /* those that the surface may cross, by rising z, then y, then x */
    size_t count, capacity;
    uint32_t *table; /* of `slots` places: a block's number and 1, by a hash of its place */
    size_t slots;
    uint32_t *region;   /* numbers of regions: leaves, then tiles */
    uint8_t *sides;     /* of every region */
    uint8_t background; /* the side of the background */
} cwi_leaf_blocks;

/* Finds the blocks that the surface may cross, and what lies in them and one leaf around them.
 * grid  its level is set, its volume is sparse
 * Returns CW_ERR_ARGUMENT for a leaf or tile beyond the volume's size; CW_ERR_LIMIT,
 * CW_ERR_NO_MEMORY. Free with cwi_blocks_free(), also after an error. */
CW_NODISCARD cw_status cwi_blocks_init(cwi_leaf_blocks *blocks, const cwi_engine *engine,
                                       const cwi_bit_grid *grid, const cw_extract_desc *desc,
                                       cw_error *err);
void cwi_blocks_free(cwi_leaf_blocks *blocks);

/* Returns the block at a place; NULL when the surface does not cross it. */
const cwi_leaf_block *cwi_blocks_find(const cwi_leaf_blocks *blocks, const uint32_t at[3]);

cwi_region cwi_region_at(const cw_volume *volume, size_t number);

#endif
