/* Builds the octree of value ranges [Wilhelms1992] upward from its leaves, and marks with it
 * the leaves that the isovalue crosses. */
#include "extract/dense/minmax_octree.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <math.h>
#include <string.h>

static size_t halve_count(size_t n)
{
    return (n + 1) / 2;
}

static size_t bricks_at(const cwi_octree *t, int level)
{
    return t->dim[level][0] * t->dim[level][1] * t->dim[level][2];
}

cw_status cwi_octree_init(cwi_octree *t, const cwi_bit_grid *g, cw_error *err)
{
    memset(t, 0, sizeof *t);
    for (int a = 0; a < 3; a++)
        t->dim[0][a] = (g->volume.dim[a] + 1 + CWI_BRICK - 1) / CWI_BRICK;
    for (int l = 0;; l++) {
        t->level[l] = cwi_alloc_array(bricks_at(t, l), sizeof **t->level);
        t->levels = l + 1;
        if (!t->level[l])
            return cwi_fail_memory(err);
        if (bricks_at(t, l) == 1)
            return CW_OK;
        for (int a = 0; a < 3; a++)
            t->dim[l + 1][a] = halve_count(t->dim[l][a]);
    }
}

void cwi_octree_free(cwi_octree *t)
{
    for (int l = 0; l < t->levels; l++)
        cwi_free(t->level[l]);
    memset(t, 0, sizeof *t);
}

size_t cwi_octree_bytes(const cwi_octree *t)
{
    size_t bricks = 0;
    for (int l = 0; l < t->levels; l++)
        bricks += bricks_at(t, l);
    return bricks * sizeof(cwi_range);
}

static cwi_range *node_at(const cwi_octree *t, int level, size_t x, size_t y, size_t z)
{
    return t->level[level] + (z * t->dim[level][1] + y) * t->dim[level][0] + x;
}

/* Iterates over the up to eight children of a node: their places a level below. */
#define EACH_CHILD(t, l, at, x, y, z)                                                          \
    for (size_t z = 2 * at[2]; z < 2 * at[2] + 2 && z < t->dim[l - 1][2]; z++)                 \
        for (size_t y = 2 * at[1]; y < 2 * at[1] + 2 && y < t->dim[l - 1][1]; y++)             \
            for (size_t x = 2 * at[0]; x < 2 * at[0] + 2 && x < t->dim[l - 1][0]; x++)

static cwi_range join_children(const cwi_octree *t, int l, const size_t at[3])
{
    cwi_range r = {INFINITY, -INFINITY, false};
    EACH_CHILD(t, l, at, x, y, z)
    {
        const cwi_range *child = node_at(t, l - 1, x, y, z);
        r.low = fmin(r.low, child->low);
        r.high = fmax(r.high, child->high);
        r.gap = r.gap || child->gap;
    }
    return r;
}

void cwi_octree_update(cwi_octree *t, const cwi_leaf_box *leaves)
{
    cwi_leaf_box box = *leaves;
    for (int l = 1; l < t->levels; l++) {
        size_t at[3];
        for (int a = 0; a < 3; a++) {
            box.first[a] /= 2;
            box.end[a] = halve_count(box.end[a]);
        }
        for (at[2] = box.first[2]; at[2] < box.end[2]; at[2]++)
            for (at[1] = box.first[1]; at[1] < box.end[1]; at[1]++)
                for (at[0] = box.first[0]; at[0] < box.end[0]; at[0]++)
                    *node_at(t, l, at[0], at[1], at[2]) = join_children(t, l, at);
    }
}

void cwi_octree_grow(cwi_octree *t)
{
    cwi_leaf_box all = {.first = {0}};
    memcpy(all.end, t->dim[0], sizeof all.end);
    cwi_octree_update(t, &all);
    t->grown = true;
}

/* Finds the sides of the grid's level on which the numbers of a brick are. */
static void find_sides(const cwi_range *r, const cwi_bit_grid *g, bool *in, bool *out)
{
    const bool any_above = g->strict ? r->high > g->level : r->high >= g->level;
    const bool any_below = g->strict ? r->low <= g->level : r->low < g->level;
    *in = g->invert ? any_below : any_above;
    *out = g->invert ? any_above : any_below;
}

bool cwi_octree_crossed(const cwi_octree *t, const cwi_bit_grid *g)
{
    bool in, out;
    find_sides(t->level[t->levels - 1], g, &in, &out);
    return in && out;
}

/* Returns true if some cell of the brick may have corners on both sides; samples without value
 * are outside. */
static bool straddles_level(const cwi_range *r, const cwi_bit_grid *g)
{
    bool in, out;
    find_sides(r, g, &in, &out);
    return in && (out || r->gap);
}

unsigned cwi_octree_sides(const cwi_octree *t, const cwi_bit_grid *g,
                          const cwi_leaf_box *leaves, bool *straddles)
{
    unsigned sides = 0;
    *straddles = false;
    for (size_t z = leaves->first[2]; z < leaves->end[2]; z++)
        for (size_t y = leaves->first[1]; y < leaves->end[1]; y++)
            for (size_t x = leaves->first[0]; x < leaves->end[0]; x++) {
                const cwi_range *range = node_at(t, 0, x, y, z);
                bool in, out;
                find_sides(range, g, &in, &out);
                sides |= (in ? CWI_INSIDE : 0) | (out ? CWI_OUTSIDE : 0);
                *straddles = *straddles || straddles_level(range, g);
            }
    return sides;
}

static size_t mark_below(const cwi_octree *t, int l, const size_t at[3], cwi_bit_grid *g)
{
    size_t leaves = 0;
    if (!straddles_level(node_at(t, l, at[0], at[1], at[2]), g))
        return 0;
    if (l == 0) {
        const size_t word = at[0] * CWI_BRICK / 64;
        uint64_t *mask = g->active + (at[2] * g->bricks_y + at[1]) * g->masks;
        mask[word / 64] |= UINT64_C(1) << word % 64;
        return 1;
    }
    EACH_CHILD(t, l, at, x, y, z)
    leaves += mark_below(t, l - 1, (const size_t[3]){x, y, z}, g);
    return leaves;
}

/* Returns, from the ranges, the bits of the eight leaves in a word of a row of bricks. */
static cwi_leaf_bits leaf_bits(const cwi_octree *t, const cwi_bit_grid *g, size_t row, size_t w)
{
    const cwi_range *leaves = t->level[0] + row * t->dim[0][0];
    cwi_leaf_bits bits = {0, 0};
    for (size_t b = 0; b < 8 && 8 * w + b < t->dim[0][0]; b++) {
        bool in, out;
        find_sides(leaves + 8 * w + b, g, &in, &out);
        const bool active = straddles_level(leaves + 8 * w + b, g);
        bits.active |= (uint8_t)(active << b);
        bits.solid |= (uint8_t)((in && !active) << b);
    }
    return bits;
}

size_t cwi_octree_leaves(const cwi_octree *t)
{
    return bricks_at(t, 0);
}

size_t cwi_octree_mark(const cwi_octree *t, cwi_bit_grid *g)
{
    const size_t rows = g->bricks_z * g->bricks_y;
    memset(g->active, 0, rows * g->masks * sizeof *g->active);
    memset(g->leaves, 0, rows * g->words * sizeof *g->leaves);
    const size_t leaves = mark_below(t, t->levels - 1, (const size_t[3]){0, 0, 0}, g);
    for (size_t row = 0; row < rows; row++) {
        const uint64_t *mask = g->active + row * g->masks;
        for (size_t w = cwi_next_marked_word(mask, 0, g->words); w < g->words;
             w = cwi_next_marked_word(mask, w + 1, g->words))
            for (size_t x = w; x < w + 2 && x < g->words; x++)
                g->leaves[row * g->words + x] = leaf_bits(t, g, row, x);
    }
    return leaves;
}
