/* Gathers the samples of a block, from leaves and tiles, into rows that an engine reads. */
#ifndef EXTRACT_SPARSE_BLOCK_GATHER_H
#define EXTRACT_SPARSE_BLOCK_GATHER_H

#include "extract/sparse/leaf_blocks.h"

enum {
    CWI_PITCH = 64, /* voxels from row to row: whole words are compared */
    CWI_SLOTS_X = CWI_BLOCK_X + 2,
    CWI_SLOTS_Y = CWI_BLOCK_Y + 2,
    CWI_SLOTS_Z = CWI_BLOCK_Z + 2
};

/* A block as slots for leaves: its own, one layer before them for the halo, and one behind
 * them, where its last cells end. */
typedef struct cwi_gathering {
    const cwi_leaf_blocks *blocks;
    const cwi_engine *engine;
    size_t halo;      /* samples before the first cell */
    size_t sample[3]; /* of the block: `halo` before its cells, and halo + 1 after them */
    char *voxels;     /* sample[2] x sample[1] rows */
    uint32_t region[CWI_SLOTS_Z][CWI_SLOTS_Y][CWI_SLOTS_X]; /* number of the region in a slot */
    uint8_t sides[CWI_SLOTS_Z][CWI_SLOTS_Y][CWI_SLOTS_X];
    uint8_t column[CWI_SLOTS_Z][CWI_SLOTS_Y]; /* of all slots along x */
} cwi_gathering;

/* Allocates the samples. Free with cwi_gathering_free(), also after an error.
 * cubic  the halo is wide enough for cubics */
CW_NODISCARD cw_status cwi_gathering_init(cwi_gathering *g, const cwi_leaf_blocks *blocks,
                                          const cwi_engine *engine, bool cubic, cw_error *err);
void cwi_gathering_free(cwi_gathering *g);

/* Gathers samples and inside bits of a block into g->voxels and the planes of a grid over them.
 * Where no vertex needs them, samples are stale; bits are right everywhere. */
void cwi_gather(cwi_gathering *g, const cwi_leaf_block *block, cwi_bit_grid *grid);

/* Returns the index in the volume of a block's first sample. */
static inline ptrdiff_t cwi_first_sample(const cwi_gathering *g, const cwi_leaf_block *block,
                                         int a)
{
    static const int leaves[3] = {CWI_BLOCK_X, CWI_BLOCK_Y, CWI_BLOCK_Z};
    return ((ptrdiff_t)block->at[a] - 1) * leaves[a] * 8 - (ptrdiff_t)g->halo;
}

#endif
