/* Boxes in blocks of eight along a space-filling curve: which ones meet a box? */
#ifndef QUALITY_BLOCKS_H
#define QUALITY_BLOCKS_H

#include <cubewright/core.h>

enum { CWI_BLOCK = 8, CWI_BLOCK_LEVELS = 12 };

/* Low corner, high corner; ends included. */
typedef struct cwi_box {
    float low[3], high[3];
} cwi_box;

/* Eight boxes side by side, so that one is compared with all of them at once. */
typedef struct cwi_block {
    float low[3][CWI_BLOCK], high[3][CWI_BLOCK];
} cwi_block;

/* Block b of level 0 holds the boxes order[8b .. 8b+7]; block b of level n + 1 the hulls of
 * blocks 8b .. 8b+7 of level n. The last level is one block. Missing boxes meet nothing. */
typedef struct cwi_blocks {
    size_t count; /* of boxes */
    uint32_t *order;
    int levels;
    size_t block_count[CWI_BLOCK_LEVELS];
    cwi_block *level[CWI_BLOCK_LEVELS];
} cwi_blocks;

/* Sorts boxes into blocks; free with cwi_blocks_free(), also after a failure. False when memory
 * is out. */
bool cwi_blocks_build(cwi_blocks *blocks, const cwi_box *boxes, size_t count);
void cwi_blocks_free(cwi_blocks *blocks);

/* Bit n: box n of the block meets the box. */
static inline unsigned cwi_block_meets(const cwi_block *block, const cwi_box *box)
{
    unsigned meets = 0;
    for (int n = 0; n < CWI_BLOCK; n++) {
        const unsigned x =
            (block->low[0][n] <= box->high[0]) & (block->high[0][n] >= box->low[0]);
        const unsigned y =
            (block->low[1][n] <= box->high[1]) & (block->high[1][n] >= box->low[1]);
        const unsigned z =
            (block->low[2][n] <= box->high[2]) & (block->high[2][n] >= box->low[2]);
        meets |= (x & y & z) << n;
    }
    return meets;
}

cwi_box cwi_block_hull(const cwi_block *block);

/* Calls visit(context, b) for each block b of level 0, from `first` on and in rising order,
 * that may hold a box meeting this one, until it returns false. */
void cwi_blocks_visit(const cwi_blocks *blocks, const cwi_box *box, size_t first,
                      bool (*visit)(void *context, size_t block), void *context);

#endif
