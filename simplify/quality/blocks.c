#include "simplify/quality/blocks.h"

#include "core/memory.h"

#include <math.h>
#include <string.h>

/* Along each axis the curve tells 2^14 places apart: 42 bits, sorted in four passes of 11. */
enum { AXIS_BITS = 14, DIGIT_BITS = 11, DIGITS = 4, BUCKETS = 1 << DIGIT_BITS };

typedef struct key {
    uint64_t place;
    uint32_t box;
} key;

/* Two zeros behind each of the lowest 16 bits. */
static uint64_t spread(uint64_t x)
{
    x = (x | x << 16) & 0x0000ff0000ffu;
    x = (x | x << 8) & 0x00f00f00f00fu;
    x = (x | x << 4) & 0x0c30c30c30c3u;
    return (x | x << 2) & 0x249249249249u;
}

static cwi_box hull_of(const cwi_box *boxes, size_t count)
{
    cwi_box hull = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (size_t n = 0; n < count; n++)
        for (int a = 0; a < 3; a++) {
            hull.low[a] = fminf(hull.low[a], boxes[n].low[a]);
            hull.high[a] = fmaxf(hull.high[a], boxes[n].high[a]);
        }
    return hull;
}

static uint64_t place_of(const cwi_box *box, const cwi_box *hull)
{
    uint64_t place = 0;
    for (int a = 0; a < 3; a++) {
        const double extent = 2 * ((double)hull->high[a] - (double)hull->low[a]);
        const double at = (double)box->low[a] + (double)box->high[a] - 2 * (double)hull->low[a];
        const double share = extent > 0 ? at / extent : 0;
        place |= spread((uint64_t)(share * ((1 << AXIS_BITS) - 1))) << a;
    }
    return place;
}

static void sort_digit(const key *from, key *to, size_t count, int shift)
{
    size_t begin[BUCKETS + 1] = {0};
    for (size_t n = 0; n < count; n++)
        begin[(from[n].place >> shift) % BUCKETS + 1]++;
    for (int b = 0; b < BUCKETS; b++)
        begin[b + 1] += begin[b];
    for (size_t n = 0; n < count; n++)
        to[begin[(from[n].place >> shift) % BUCKETS]++] = from[n];
}

static bool sort_boxes(cwi_blocks *blocks, const cwi_box *boxes)
{
    const size_t count = blocks->count;
    const cwi_box hull = hull_of(boxes, count);
    key *keys = cwi_alloc_array(count, sizeof *keys);
    key *spare = cwi_alloc_array(count, sizeof *spare);
    const bool ok = keys && spare;
    for (size_t n = 0; n < count && ok; n++)
        keys[n] = (key){place_of(&boxes[n], &hull), (uint32_t)n};
    for (int d = 0; d < DIGITS && ok; d += 2) {
        sort_digit(keys, spare, count, d * DIGIT_BITS);
        sort_digit(spare, keys, count, (d + 1) * DIGIT_BITS);
    }
    for (size_t n = 0; n < count && ok; n++)
        blocks->order[n] = keys[n].box;
    cwi_free(keys);
    cwi_free(spare);
    return ok;
}

static void put_box(cwi_block *block, int n, const cwi_box *box)
{
    for (int a = 0; a < 3; a++) {
        block->low[a][n] = box->low[a];
        block->high[a][n] = box->high[a];
    }
}

cwi_box cwi_block_hull(const cwi_block *block)
{
    cwi_box hull;
    for (int a = 0; a < 3; a++) {
        hull.low[a] = block->low[a][0];
        hull.high[a] = block->high[a][0];
        for (int n = 1; n < CWI_BLOCK; n++) {
            hull.low[a] = fminf(hull.low[a], block->low[a][n]);
            hull.high[a] = fmaxf(hull.high[a], block->high[a][n]);
        }
    }
    return hull;
}

static bool add_level(cwi_blocks *blocks, size_t boxes)
{
    const cwi_box nowhere = hull_of(NULL, 0);
    const size_t count = boxes ? (boxes + CWI_BLOCK - 1) / CWI_BLOCK : 1;
    cwi_block *level = cwi_alloc_large(count, sizeof *level);
    blocks->block_count[blocks->levels] = count;
    blocks->level[blocks->levels++] = level;
    for (size_t n = boxes; n < count * CWI_BLOCK && level; n++)
        put_box(&level[n / CWI_BLOCK], (int)(n % CWI_BLOCK), &nowhere);
    return level;
}

bool cwi_blocks_build(cwi_blocks *blocks, const cwi_box *boxes, size_t count)
{
    *blocks = (cwi_blocks){.count = count};
    blocks->order = cwi_alloc_array(count, sizeof *blocks->order);
    if (!blocks->order || !sort_boxes(blocks, boxes) || !add_level(blocks, count))
        return false;
    for (size_t n = 0; n < count; n++)
        put_box(&blocks->level[0][n / CWI_BLOCK], (int)(n % CWI_BLOCK),
                &boxes[blocks->order[n]]);
    while (blocks->block_count[blocks->levels - 1] > 1) {
        const cwi_block *below = blocks->level[blocks->levels - 1];
        const size_t parts = blocks->block_count[blocks->levels - 1];
        if (!add_level(blocks, parts))
            return false;
        cwi_block *level = blocks->level[blocks->levels - 1];
        for (size_t n = 0; n < parts; n++) {
            const cwi_box hull = cwi_block_hull(&below[n]);
            put_box(&level[n / CWI_BLOCK], (int)(n % CWI_BLOCK), &hull);
        }
    }
    return true;
}

void cwi_blocks_free(cwi_blocks *blocks)
{
    cwi_free(blocks->order);
    for (int n = 0; n < blocks->levels; n++)
        cwi_free(blocks->level[n]);
    *blocks = (cwi_blocks){0};
}

void cwi_blocks_visit(const cwi_blocks *blocks, const cwi_box *box, size_t first,
                      bool (*visit)(void *context, size_t block), void *context)
{
    struct {
        size_t block;
        int level;
    } stack[CWI_BLOCK * CWI_BLOCK_LEVELS];
    int top = 0;
    stack[top].block = 0;
    stack[top++].level = blocks->levels - 1;
    while (top) {
        const size_t block = stack[--top].block;
        const int level = stack[top].level;
        if (level == 0) {
            if (!visit(context, block))
                return;
            continue;
        }
        const unsigned meets = cwi_block_meets(&blocks->level[level][block], box);
        const size_t reach = first >> 3 * (level - 1); /* parts before it end before first */
        for (int n = CWI_BLOCK - 1; n >= 0; n--)
            if (meets >> n & 1 && block * CWI_BLOCK + (size_t)n >= reach) {
                stack[top].block = block * CWI_BLOCK + (size_t)n;
                stack[top++].level = level - 1;
            }
    }
}
