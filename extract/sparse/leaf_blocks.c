/* Sorts the leaves and tiles of a sparse grid into blocks, and keeps the blocks that the
 * surface may cross. */
#include "extract/sparse/leaf_blocks.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/volume/volume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const uint32_t shape[3] = {CWI_BLOCK_X, CWI_BLOCK_Y, CWI_BLOCK_Z};

/* Number of leaves that have samples of a block's cells. */
enum { TOUCHED = (CWI_BLOCK_X + 1) * (CWI_BLOCK_Y + 1) * (CWI_BLOCK_Z + 1) };

static size_t region_count(const cw_sparse *s)
{
    return s->leaf_count + s->tile_count;
}

cwi_region cwi_region_at(const cw_volume *v, size_t n)
{
    const cw_sparse *s = v->sparse;
    if (n >= s->leaf_count) {
        const cw_tile *t = &s->tiles[n - s->leaf_count];
        return (cwi_region){{t->at[0], t->at[1], t->at[2]},
                            {t->size[0], t->size[1], t->size[2]},
                            NULL,
                            t->value};
    }
    const uint32_t *at = s->leaves[n];
    const size_t bytes = CWI_LEAF_VOXELS * cw_type_size(v->type);
    return (cwi_region){{at[0], at[1], at[2]}, {1, 1, 1}, (const char *)v->data + n * bytes, 0};
}

/* --- what can be wrong -------------------------------------------------------------------- */

static cw_status check_region(const cw_volume *v, size_t n, cw_error *err)
{
    const cwi_region r = cwi_region_at(v, n);
    const bool leaf = n < v->sparse->leaf_count;
    for (int a = 0; a < 3; a++)
        if (r.size[a] == 0 || ((uint64_t)r.at[a] + r.size[a]) * CWI_LEAF > v->dim[a])
            return cwi_fail(
                err, CW_ERR_ARGUMENT,
                "%s %zu, of size %u at %u along %c, is beyond the volume's %zu voxels",
                leaf ? "leaf" : "tile", leaf ? n : n - v->sparse->leaf_count, r.size[a],
                r.at[a], "xyz"[a], v -> dim[a]);
    return CW_OK;
}

static bool type_holds(cw_type type, double value)
{
    static const double lowest[CW_TYPE_COUNT] = {0, INT8_MIN,  0,         INT16_MIN,
                                                 0, INT32_MIN, -INFINITY, -INFINITY};
    static const double highest[CW_TYPE_COUNT] = {UINT8_MAX,  INT8_MAX,  UINT16_MAX, INT16_MAX,
                                                  UINT32_MAX, INT32_MAX, INFINITY,   INFINITY};
    const bool whole = type != CW_F32 && type != CW_F64;
    return !whole || (value >= lowest[type] && value <= highest[type] && value == rint(value));
}

static cw_status check_values(const cw_volume *v, cw_error *err)
{
    const cw_sparse *s = v->sparse;
    bool fits = type_holds(v->type, s->background);
    for (size_t n = 0; n < s->tile_count; n++)
        fits = fits && type_holds(v->type, s->tiles[n].value);
    return fits ? CW_OK
                : cwi_fail(err, CW_ERR_ARGUMENT,
                           "the background or a tile has a value that %s cannot hold",
                           cw_type_name(v->type));
}

static cw_status check_volume(const cw_volume *v, cw_error *err)
{
    cw_status st = check_values(v, err);
    for (int a = 0; a < 3 && st == CW_OK; a++)
        if (v->dim[a] > (size_t)UINT32_MAX + 1)
            st = cwi_fail(err, CW_ERR_ARGUMENT,
                          "the sparse volume is %zu voxels wide; at most 2^32 were expected",
                          v->dim[a]);
    if (st == CW_OK && region_count(v->sparse) > UINT32_MAX)
        st = cwi_fail(err, CW_ERR_LIMIT,
                      "the sparse volume has %zu leaves and tiles; at most "
                      "2^32 - 1 were expected",
                      region_count(v->sparse));
    for (size_t n = 0; n < region_count(v->sparse) && st == CW_OK; n++)
        st = check_region(v, n, err);
    return st;
}

/* --- which sides of the isovalue a region is on ------------------------------------------- */

enum { TOGETHER = 512 }; /* leaves that a thread looks at in a row */

/* A region and a block that it touches. */
typedef struct touch {
    uint32_t block, region;
} touch;

typedef struct sorting {
    cwi_leaf_blocks *blocks;
    const cwi_engine *engine;
    const cwi_bit_grid *grid;
    size_t max_bytes;
    touch *touches;
    size_t touch_count, touch_capacity;
} sorting;

static uint8_t sides_of(const sorting *s, const void *voxels, size_t count)
{
    bool in = false, out = false;
    s->engine->find_sides(s->grid, voxels, count, &in, &out);
    return (uint8_t)((in ? CWI_INSIDE : 0) | (out ? CWI_OUTSIDE : 0));
}

static uint8_t sides_of_value(const sorting *s, double value)
{
    const cw_type type = s->grid->volume.type;
    double storage[64]; /* of any type */
    for (size_t n = 0; n < 64; n++)
        cwi_voxel_put(type, (char *)storage + n * cw_type_size(type), value);
    return sides_of(s, storage, 64);
}

static void find_sides(void *context, size_t part)
{
    const sorting *s = context;
    const cw_volume *v = s->blocks->volume;
    const size_t count = region_count(v->sparse);
    for (size_t n = part * TOGETHER; n < (part + 1) * TOGETHER && n < count; n++) {
        const cwi_region r = cwi_region_at(v, n);
        s->blocks->sides[n] =
            r.voxels ? sides_of(s, r.voxels, CWI_LEAF_VOXELS) : sides_of_value(s, r.value);
    }
}

/* --- the table of blocks ------------------------------------------------------------------ */

static size_t slot_of(const cwi_leaf_blocks *b, const uint32_t at[3])
{
    uint64_t h = at[0] * UINT64_C(0x9e3779b97f4a7c15);
    h = (h ^ at[1]) * UINT64_C(0xbf58476d1ce4e5b9);
    h = (h ^ h >> 29 ^ at[2]) * UINT64_C(0x94d049bb133111eb);
    size_t slot = (size_t)(h ^ h >> 32) & (b->slots - 1);
    while (b->table[slot] && memcmp(b->block[b->table[slot] - 1].at, at, 3 * sizeof *at) != 0)
        slot = (slot + 1) & (b->slots - 1);
    return slot;
}

/* Returns a block's number plus 1; 0: there is none. */
static uint32_t find_number(const cwi_leaf_blocks *b, const uint32_t at[3])
{
    return b->slots ? b->table[slot_of(b, at)] : 0;
}

const cwi_leaf_block *cwi_blocks_find(const cwi_leaf_blocks *b, const uint32_t at[3])
{
    const uint32_t number = find_number(b, at);
    return number ? &b->block[number - 1] : NULL;
}

/* Makes a table of the blocks, at most half full. */
static bool make_table(cwi_leaf_blocks *b, size_t slots)
{
    cwi_free(b->table);
    b->slots = slots;
    b->table = cwi_alloc_zeroed(slots, sizeof *b->table);
    for (size_t n = 0; b->table && n < b->count; n++)
        b->table[slot_of(b, b->block[n].at)] = (uint32_t)n + 1;
    b->slots = b->table ? slots : 0;
    return b->table != NULL;
}

static cw_status grow_blocks(cwi_leaf_blocks *b, size_t max_bytes, cw_error *err)
{
    const size_t capacity = b->capacity ? 2 * b->capacity : 1024,
                 bytes = capacity * sizeof *b->block;
    if (capacity > UINT32_MAX / 2 || (max_bytes && bytes > max_bytes)) {
        char needed[CWI_MEMORY_TEXT], left[CWI_MEMORY_TEXT];
        cwi_print_memory(bytes, needed);
        cwi_print_memory(max_bytes ? max_bytes : UINT32_MAX / 2 * sizeof *b->block, left);
        return cwi_fail(
            err, CW_ERR_LIMIT,
            "blocks around leaves and tiles need %s and more; %s are left (desc->max_bytes)",
            needed, left);
    }
    cwi_leaf_block *more = cwi_realloc_array(b->block, capacity, sizeof *more);
    if (!more)
        return cwi_fail_memory(err);
    b->block = more;
    b->capacity = capacity;
    return make_table(b, 2 * capacity) ? CW_OK : cwi_fail_memory(err);
}

static cw_status find_or_add(cwi_leaf_blocks *b, const uint32_t at[3], size_t max_bytes,
                             cwi_leaf_block **found, cw_error *err)
{
    cw_status st = b->count == b->capacity ? grow_blocks(b, max_bytes, err) : CW_OK;
    if (st != CW_OK)
        return st;
    uint32_t *number = &b->table[slot_of(b, at)];
    if (!*number) {
        b->block[b->count] = (cwi_leaf_block){.at = {at[0], at[1], at[2]}};
        *number = (uint32_t)++b->count;
    }
    *found = &b->block[*number - 1];
    return CW_OK;
}

/* --- blocks and regions ------------------------------------------------------------------- */

/* Reach of a region along an axis, in leaves counted from a block before the first. */
typedef struct reach {
    uint64_t low, high;           /* the region's first and last leaf */
    uint32_t first, last;         /* blocks that touch it */
    uint32_t buried, buried_last; /* those all of whose leaves, and one around, it has */
} reach;

/* Computes a reach. around: 1 also counts the leaf before those that the block's cells
 * touch. */
static reach reach_along(const cwi_region *r, int a, uint32_t around)
{
    const uint32_t side = shape[a];
    const uint64_t low = (uint64_t)r->at[a] + side, high = low + r->size[a] - 1;
    return (reach){.low = low,
                   .high = high,
                   .first = (uint32_t)((low + side - 1) / side - 1),
                   .last = (uint32_t)((high + around) / side),
                   .buried = (uint32_t)((low + 1 + side - 1) / side),
                   .buried_last = (uint32_t)(high / side - 1)};
}

/* Returns the number of leaves along an axis that both a region and the cells of block b
 * touch. */
static uint32_t measure_overlap(const reach *r, uint32_t b, uint32_t side)
{
    const uint64_t first = (uint64_t)b * side, last = first + side;
    return (uint32_t)((r->high < last ? r->high : last) - (r->low > first ? r->low : first) +
                      1);
}

static bool is_buried(const reach *r, uint32_t b)
{
    return b >= r->buried && b <= r->buried_last;
}

typedef cw_status (*visitor)(sorting *s, size_t region, const reach along[3],
                             const uint32_t at[3], cw_error *err);

/* Visits all blocks that touch a region, except those deep inside it, where there is no
 * surface. */
static cw_status visit_region(sorting *s, size_t n, uint32_t around, visitor visit,
                              cw_error *err)
{
    const cwi_region r = cwi_region_at(s->blocks->volume, n);
    reach along[3];
    uint32_t at[3];
    cw_status st = CW_OK;
    for (int a = 0; a < 3; a++)
        along[a] = reach_along(&r, a, around);
    for (at[2] = along[2].first; at[2] <= along[2].last && st == CW_OK; at[2]++)
        for (at[1] = along[1].first; at[1] <= along[1].last && st == CW_OK; at[1]++) {
            const bool deep = is_buried(&along[1], at[1]) && is_buried(&along[2], at[2]);
            for (at[0] = along[0].first; at[0] <= along[0].last && st == CW_OK; at[0]++)
                if (deep && is_buried(&along[0], at[0]))
                    at[0] = along[0].buried_last;
                else
                    st = visit(s, n, along, at, err);
        }
    return st;
}

static cw_status visit_all(sorting *s, uint32_t around, visitor visit, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t n = 0; n < region_count(s->blocks->volume->sparse) && st == CW_OK; n++)
        st = visit_region(s, n, around, visit, err);
    return st;
}

static cw_status note_sides(sorting *s, size_t n, const reach along[3], const uint32_t at[3],
                            cw_error *err)
{
    cwi_leaf_block *b;
    cw_status st = find_or_add(s->blocks, at, s->max_bytes, &b, err);
    if (st != CW_OK)
        return st;
    b->sides |= s->blocks->sides[n];
    b->covered += measure_overlap(&along[0], at[0], shape[0]) *
                  measure_overlap(&along[1], at[1], shape[1]) *
                  measure_overlap(&along[2], at[2], shape[2]);
    return CW_OK;
}

static int by_position(const void *a, const void *b)
{
    const cwi_leaf_block *p = a, *q = b;
    for (int n = 2; n >= 0; n--)
        if (p->at[n] != q->at[n])
            return p->at[n] < q->at[n] ? -1 : 1;
    return 0;
}

/* Keeps the blocks that may be crossed, in their order. */
static cw_status keep_crossed(sorting *s, cw_error *err)
{
    cwi_leaf_blocks *b = s->blocks;
    size_t kept = 0;
    b->background = sides_of_value(s, b->volume->sparse->background);
    for (size_t n = 0; n < b->count; n++) {
        cwi_leaf_block *at = &b->block[n];
        at->sides |= at->covered < TOUCHED ? b->background : 0;
        if (at->sides == CWI_BOTH)
            b->block[kept++] = *at;
    }
    b->count = kept;
    if (kept)
        qsort(b->block, kept, sizeof *b->block, by_position);
    return make_table(b, b->slots ? b->slots : 2) ? CW_OK : cwi_fail_memory(err);
}

static cw_status note_touch(sorting *s, size_t n, const reach along[3], const uint32_t at[3],
                            cw_error *err)
{
    (void)along;
    const uint32_t block = find_number(s->blocks, at);
    if (!block)
        return CW_OK;
    if (s->touch_count == s->touch_capacity) {
        s->touch_capacity = s->touch_capacity ? 2 * s->touch_capacity
                                              : 4 * region_count(s->blocks->volume->sparse);
        touch *more = cwi_realloc_array(s->touches, s->touch_capacity, sizeof *more);
        if (!more)
            return cwi_fail_memory(err);
        s->touches = more;
    }
    s->touches[s->touch_count++] = (touch){block - 1, (uint32_t)n};
    s->blocks->block[block - 1].count++;
    return CW_OK;
}

/* Gives each block the list of its regions. */
static cw_status list_regions(sorting *s, cw_error *err)
{
    cwi_leaf_blocks *b = s->blocks;
    size_t total = 0;
    cw_status st = visit_all(s, 1, note_touch, err);
    if (st != CW_OK)
        return st;
    b->region = cwi_alloc_array(s->touch_count, sizeof *b->region);
    if (!b->region)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < b->count; n++) {
        b->block[n].first = total;
        total += b->block[n].count;
        b->block[n].count = 0;
    }
    for (size_t n = 0; n < s->touch_count; n++) {
        cwi_leaf_block *block = &b->block[s->touches[n].block];
        b->region[block->first + block->count++] = s->touches[n].region;
    }
    return CW_OK;
}

cw_status cwi_blocks_init(cwi_leaf_blocks *b, const cwi_engine *engine,
                          const cwi_bit_grid *grid, const cw_extract_desc *desc, cw_error *err)
{
    const size_t count = region_count(grid->volume.sparse);
    sorting s = {.blocks = b, .engine = engine, .grid = grid, .max_bytes = desc->max_bytes};
    *b = (cwi_leaf_blocks){.volume = &grid->volume};
    cw_status st = check_volume(&grid->volume, err);
    if (st != CW_OK)
        return st;
    b->sides = cwi_alloc_array(count, 1);
    st = b->sides ? cwi_parallel_for((count + TOGETHER - 1) / TOGETHER,
                                     TOGETHER * CWI_LEAF_VOXELS, desc->threads, &desc->progress,
                                     "classifying", find_sides, &s, err)
                  : cwi_fail_memory(err);
    if (st == CW_OK)
        st = visit_all(&s, 0, note_sides, err);
    if (st == CW_OK)
        st = keep_crossed(&s, err);
    if (st == CW_OK)
        st = list_regions(&s, err);
    cwi_free(s.touches);
    return st;
}

void cwi_blocks_free(cwi_leaf_blocks *b)
{
    for (size_t n = 0; n < b->count && b->block; n++) {
        cwi_free(b->block[n].seam);
        cwi_free(b->block[n].piece.memory);
    }
    cwi_free(b->block);
    cwi_free(b->table);
    cwi_free(b->region);
    cwi_free(b->sides);
    *b = (cwi_leaf_blocks){0};
}
