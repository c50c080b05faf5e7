/* Gathers the samples of a block from its leaves and tiles, and their inside bits. */
#include "extract/sparse/block_gather.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <string.h>

static const uint32_t shape[3] = {CWI_BLOCK_X, CWI_BLOCK_Y, CWI_BLOCK_Z};

cw_status cwi_gathering_init(cwi_gathering *g, const cwi_leaf_blocks *blocks,
                             const cwi_engine *engine, bool cubic, cw_error *err)
{
    memset(g, 0, sizeof *g);
    g->blocks = blocks;
    g->engine = engine;
    g->halo = cubic ? 2 : 1;
    for (int a = 0; a < 3; a++)
        g->sample[a] = CWI_LEAF * (size_t)shape[a] + 2 * g->halo + 2;
    g->voxels = cwi_alloc_zeroed(CWI_PITCH * g->sample[1] * g->sample[2],
                                 cw_type_size(blocks->volume->type));
    return g->voxels ? CW_OK : cwi_fail_memory(err);
}

void cwi_gathering_free(cwi_gathering *g)
{
    cwi_free(g->voxels);
    g->voxels = NULL;
}

/* --- regions by slot ---------------------------------------------------------------------- */

/* Finds the slots of a block that a region is in, along an axis: begin to end. */
static void find_slots(const cwi_leaf_block *b, const cwi_region *r, int a, size_t slot[2])
{
    const int64_t first = ((int64_t)b->at[a] - 1) * shape[a] - 1; /* the leaf in slot 0 */
    const int64_t low = (int64_t)r->at[a] - first, high = low + r->size[a], n = shape[a] + 2;
    slot[0] = (size_t)(low > 0 ? low : 0);
    slot[1] = (size_t)(high < n ? high : n);
}

static void place_region(cwi_gathering *g, const cwi_leaf_block *b, uint32_t number)
{
    const cwi_region r = cwi_region_at(g->blocks->volume, number);
    size_t x[2], y[2], z[2];
    find_slots(b, &r, 0, x);
    find_slots(b, &r, 1, y);
    find_slots(b, &r, 2, z);
    for (size_t k = z[0]; k < z[1]; k++)
        for (size_t j = y[0]; j < y[1]; j++)
            for (size_t i = x[0]; i < x[1]; i++) {
                g->region[k][j][i] = number;
                g->sides[k][j][i] = g->blocks->sides[number];
            }
}

static void place_regions(cwi_gathering *g, const cwi_leaf_block *b)
{
    memset(g->region, 0xff, sizeof g->region); /* CWI_BACKGROUND */
    memset(g->sides, g->blocks->background, sizeof g->sides);
    for (size_t n = b->first; n < b->first + b->count; n++)
        place_region(g, b, g->blocks->region[n]);
    for (size_t k = 0; k < CWI_SLOTS_Z; k++)
        for (size_t j = 0; j < CWI_SLOTS_Y; j++) {
            g->column[k][j] = 0;
            for (size_t i = 0; i < CWI_SLOTS_X; i++)
                g->column[k][j] |= g->sides[k][j][i];
        }
}

/* Returns true if the surface does not touch a column: it and those around it are on one
 * side. */
static bool is_idle(const cwi_gathering *g, size_t j, size_t k)
{
    uint8_t sides = 0;
    for (size_t z = k ? k - 1 : 0; z <= k + 1 && z < CWI_SLOTS_Z; z++)
        for (size_t y = j ? j - 1 : 0; y <= j + 1 && y < CWI_SLOTS_Y; y++)
            sides |= g->column[z][y];
    return sides != CWI_BOTH;
}

/* --- samples ------------------------------------------------------------------------------ */

/* The part of the block's samples along an axis that is in a slot, and the first of them in its
 * leaf. */
typedef struct span {
    size_t begin, end, in_leaf;
} span;

static span span_of(const cwi_gathering *g, int a, size_t slot)
{
    const size_t end = g->halo + slot * CWI_LEAF, n = g->sample[a];
    return (span){.begin = slot ? end - CWI_LEAF : 0,
                  .end = end < n ? end : n,
                  .in_leaf = slot ? 0 : CWI_LEAF - g->halo};
}

/* Copies `count` runs of `bytes` bytes. Successive runs are from_step and to_step bytes apart;
 * most are those of whole leaves. */
static inline void copy_runs(char *to, size_t to_step, const char *from, size_t from_step,
                             size_t bytes, size_t count)
{
    if (bytes == CWI_LEAF * sizeof(float))
        for (; count--; to += to_step, from += from_step)
            memcpy(to, from, CWI_LEAF * sizeof(float));
    else
        for (; count--; to += to_step, from += from_step)
            memcpy(to, from, bytes);
}

/* Copies the samples of one slot: those of a leaf, or all with one value. */
static void copy_slot(const cwi_gathering *g, uint32_t number, span x, span y, span z)
{
    const cw_volume *v = g->blocks->volume;
    const size_t size = cw_type_size(v->type), run = (x.end - x.begin) * size;
    const size_t row = CWI_PITCH * size, line = CWI_LEAF * size;
    double same[CWI_LEAF]; /* of any type */
    const cwi_region r = number != CWI_BACKGROUND
                             ? cwi_region_at(v, number)
                             : (cwi_region){.value = v->sparse->background};
    for (size_t n = 0; n < CWI_LEAF && !r.voxels; n++)
        cwi_voxel_put(v->type, (char *)same + n * size, r.value);
    for (size_t k = z.begin; k < z.end; k++) {
        const size_t in_leaf = ((k - z.begin + z.in_leaf) * CWI_LEAF + y.in_leaf) * line;
        char *to = g->voxels + (k * g->sample[1] + y.begin) * row + x.begin * size;
        if (r.voxels)
            copy_runs(to, row, (const char *)r.voxels + in_leaf + x.in_leaf * size, line, run,
                      y.end - y.begin);
        else
            copy_runs(to, row, (const char *)same, 0, run, y.end - y.begin);
    }
}

/* Fills the bits of rows whose samples, between the padding, are all on one side. */
static void fill_bits(const cwi_gathering *g, bool inside, span y, span z, cwi_bit_grid *grid)
{
    const uint64_t bits = inside ? ((UINT64_C(1) << g->sample[0]) - 1) << 1 : 0;
    for (size_t k = z.begin; k < z.end; k++)
        for (size_t j = y.begin; j < y.end; j++)
            grid->inside[(k + 1) * grid->rows_y + j + 1] = bits;
}

static void gather_column(const cwi_gathering *g, size_t j, size_t k, cwi_bit_grid *grid)
{
    const span y = span_of(g, 1, j), z = span_of(g, 2, k);
    bool in = false, out = false;
    if (is_idle(g, j, k)) {
        fill_bits(g, g->column[k][j] == CWI_INSIDE, y, z, grid);
        return;
    }
    for (size_t i = 0; i < CWI_SLOTS_X; i++)
        copy_slot(g, g->region[k][j][i], span_of(g, 0, i), y, z);
    for (size_t layer = z.begin; layer < z.end; layer++)
        g->engine->classify_rows(grid, y.begin + 1, layer + 1, y.end - y.begin, &in, &out);
}

void cwi_gather(cwi_gathering *g, const cwi_leaf_block *block, cwi_bit_grid *grid)
{
    place_regions(g, block);
    for (size_t k = 0; k < CWI_SLOTS_Z; k++)
        for (size_t j = 0; j < CWI_SLOTS_Y; j++)
            gather_column(g, j, k, grid);
}
