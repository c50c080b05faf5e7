/* Allocates the bit planes of a dense grid, sets the isovalue, and classifies the samples, in
 * parallel, as inside or outside. */
#include "extract/dense/bit_planes.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/volume/volume.h"
#include "extract/dense/crossed_edges.h"
#include "extract/dense/isa_dispatch.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Words after the last row that loads of several words may reach: 0. */
enum { BEYOND = 8 };

uint64_t *cwi_grid_plane(const cwi_bit_grid *g)
{
    const size_t words = g->rows * g->words;
    uint64_t *plane = cwi_alloc_large(words + BEYOND, sizeof *plane);
    if (plane)
        memset(plane + words, 0, BEYOND * sizeof *plane);
    return plane;
}

static cw_status allocate_planes(cwi_bit_grid *g, cw_error *err)
{
    const size_t *dim = g->volume.dim;
    size_t samples = 0;
    g->words = (dim[0] + 2 + 63) / 64;
    g->masks = (g->words + 63) / 64;
    g->rows_y = dim[1] + 2;
    g->rows_z = dim[2] + 2;
    g->bricks_y = (g->rows_y - 1 + CWI_BRICK - 1) / CWI_BRICK;
    g->bricks_z = (g->rows_z - 1 + CWI_BRICK - 1) / CWI_BRICK;
    if (!cwi_size_mul(g->rows_y, g->rows_z, &g->rows) ||
        !cwi_size_mul(g->rows, 64 * g->words, &samples))
        return cwi_fail_memory(err);
    g->inside = cwi_grid_plane(g);
    g->mixed_words = cwi_alloc_large(g->rows * g->masks, sizeof *g->mixed_words);
    g->filled = cwi_alloc_zeroed(g->rows, sizeof *g->filled);
    g->layers = cwi_alloc_zeroed(g->rows_z, sizeof *g->layers);
    return g->inside && g->mixed_words && g->filled && g->layers ? CW_OK : cwi_fail_memory(err);
}

/* Checks the range of positions. They are floats: they cannot distinguish voxels that are too
 * small, and cannot reach the ends of volumes that are too large. */
cw_status cwi_extract_check_range(const cw_volume *v, cw_error *err)
{
    double spacing[3];
    cw_volume_spacing(v, spacing);
    for (int a = 0; a < 3; a++)
        if (spacing[a] < (double)FLT_MIN ||
            spacing[a] * (double)v->dim[a] > 0.5 * (double)FLT_MAX)
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "%zu voxels of %g mm along %c are beyond what positions can hold",
                            v->dim[a], spacing[a], "xyz"[a]);
    return CW_OK;
}

cw_status cwi_grid_init(cwi_bit_grid *g, const cw_volume *volume, cw_error *err)
{
    memset(g, 0, sizeof *g);
    cw_status st = cw_volume_select(volume, 0, 0, &g->volume, err);
    if (st == CW_OK)
        st = cwi_volume_expect_dense(&g->volume, "extraction", err);
    for (int a = 0; a < 3 && st == CW_OK; a++)
        if (g->volume.dim[a] < 2)
            st = cwi_fail(err, CW_ERR_ARGUMENT,
                          "the volume has %zu voxel along %c; a surface needs 2",
                          g->volume.dim[a], "xyz"[a]);
    if (st == CW_OK)
        st = cwi_extract_check_range(&g->volume, err);
    return st == CW_OK ? allocate_planes(g, err) : st;
}

/* Each cell needs its row of samples and the next. */
void cwi_find_live_layer(const cwi_bit_grid *g, size_t k)
{
    for (size_t j = 0; j < g->rows_y; j++) {
        const size_t r = k * g->rows_y + j;
        const uint64_t *row = g->has + r * g->words;
        const bool last = j + 1 == g->rows_y || k + 1 == g->rows_z;
        for (size_t w = 0; w < g->words; w++) {
            uint64_t cells = last ? 0 : ~UINT64_C(0);
            for (size_t n = 0; n < 4 && !last; n++) {
                const uint64_t *samples = row + ((n & 1) + (n >> 1) * g->rows_y) * g->words;
                cells &= samples[w] & cwi_next_samples(samples, w);
            }
            g->live[r * g->words + w] = cells;
        }
    }
}

void cwi_find_window(const cwi_bit_grid *g, uint64_t *window)
{
    for (size_t row = 0; row < g->rows; row++) {
        uint64_t any = 0;
        for (int axis = 0; axis < 3; axis++) {
            const uint64_t edges = cwi_live_edges(g, axis, row % g->rows_y, row / g->rows_y, 0);
            window[((size_t)axis + 1) * g->rows + row] = edges;
            any |= edges;
        }
        window[row] = any;
    }
}

/* Clears cells of a row: the cells in `cells`, and with `before` each one's neighbour at i
 * - 1. */
static void clear_cells(uint64_t *row, size_t w, uint64_t cells, bool before)
{
    row[w] &= ~cells;
    if (!before)
        return;
    row[w] &= ~(cells >> 1);
    if (w > 0)
        row[w - 1] &= ~(cells << 63);
}

/* Returns true if word w of row (j, k) of cells may have crossings. */
static bool is_wanted(const cwi_bit_grid *g, size_t j, size_t k, size_t w)
{
    if (j + 1 >= g->rows_y || k + 1 >= g->rows_z)
        return false;
    return g->all_classified || cwi_grid_active(g, j, k)[w / 64] >> w % 64 & 1;
}

bool cwi_drop_pinched_layer(const cwi_bit_grid *g, size_t k)
{
    bool changed = false;
    for (size_t j = 1; j < g->rows_y; j++)
        for (int axis = 0; axis < 3; axis++) {
            uint64_t *here = g->live + (k * g->rows_y + j) * g->words;
            uint64_t *below = here - (axis == 1 ? g->rows_y : 1) * g->words;
            uint64_t *side = here - g->rows_y * g->words, *corner = side - g->words;
            for (size_t w = 0; w < g->words; w++) {
                const uint64_t crossed = cwi_grid_crossed(g, axis, j, k, w);
                if (!crossed || !is_wanted(g, j, k, w))
                    continue;
                const uint64_t a = here[w], b = below[w];
                uint64_t c, d; /* beside a, beside b */
                if (axis == 0) {
                    c = side[w];
                    d = corner[w];
                } else {
                    c = a << 1 | (w ? here[w - 1] >> 63 : 0);
                    d = b << 1 | (w ? below[w - 1] >> 63 : 0);
                }
                const uint64_t pinched = ((a & d & ~b & ~c) | (b & c & ~a & ~d)) & crossed;
                if (!pinched)
                    continue;
                changed = true;
                clear_cells(here, w, pinched, axis != 0);
                clear_cells(below, w, pinched, axis != 0);
                if (axis == 0) {
                    clear_cells(side, w, pinched, false);
                    clear_cells(corner, w, pinched, false);
                }
            }
        }
    return changed;
}

/* Makes one sweep over all layers; returns true if any cell was dropped. */
static bool drop_pinched(const cwi_bit_grid *g)
{
    bool changed = false;
    for (size_t k = 1; k < g->rows_z; k++)
        changed |= cwi_drop_pinched_layer(g, k);
    return changed;
}

cw_status cwi_level_find(const cw_volume *v, const cw_extract_desc *desc, cwi_level *level,
                         cw_error *err)
{
    level->at = (desc->isovalue - v->intercept) / v->slope;
    level->strict = v->slope < 0;
    level->invert = (v->slope < 0) != desc->inside_is_low;
    if (!isfinite(desc->isovalue) || !isfinite(level->at))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "isovalue %g is not finite, or not after slope %g and intercept %g",
                        desc->isovalue, v->slope, v->intercept);
    return CW_OK;
}

cw_status cwi_grid_set_level(cwi_bit_grid *g, const cw_extract_desc *desc, cw_error *err)
{
    cwi_level level;
    cw_status st = cwi_level_find(&g->volume, desc, &level, err);
    g->level = level.at;
    g->strict = level.strict;
    g->invert = level.invert;
    g->simple = desc->simple_topology;
    g->cubic = desc->cubic_placement;
    return st;
}

/* Makes a layer of padding, and one for all other layers, which are alike. */
static cw_status set_box(cwi_bit_grid *g, cw_error *err)
{
    const size_t layer = g->rows_y * g->words;
    g->live = cwi_alloc_zeroed(2 * layer + BEYOND, sizeof *g->live);
    if (!g->live)
        return cwi_fail_memory(err);
    for (size_t n = g->words; n < g->volume.dim[1] * g->words; n++)
        g->live[layer + n] = cwi_bits_between(64 * (n % g->words), 1, g->volume.dim[0]);
    return CW_OK;
}

cw_status cwi_grid_set_live(cwi_bit_grid *g, bool leave_open, cw_error *err)
{
    cwi_free(g->live);
    g->live = NULL;
    g->live_is_box = leave_open && !g->has_gaps;
    if (!leave_open)
        return CW_OK;
    if (g->live_is_box)
        return set_box(g, err);
    g->live = cwi_grid_plane(g);
    if (!g->live)
        return cwi_fail_memory(err);
    for (size_t k = 0; k < g->rows_z; k++)
        cwi_find_live_layer(g, k);
    while (drop_pinched(g))
        ;
    return CW_OK;
}

typedef struct classification {
    const cwi_bit_grid *grid;
    const cwi_engine *engine;
    cwi_octree *grow; /* its leaves are to be measured; may be NULL */
    bool in, out;     /* there are samples with values inside, and outside */
} classification;

static void classify_layer(void *context, size_t b)
{
    classification *c = context;
    bool in = false, out = false;
    cwi_range *leaves =
        c->grow ? c->grow->level[0] + b * c->grow->dim[0][1] * c->grow->dim[0][0] : NULL;
    c->engine->classify_layer(c->grid, b, leaves, &in, &out);
    if (in)
        cwi_set_flag(&c->in);
    if (out) {
        cwi_set_flag(&c->out);
    }
}

/* Marks the wanted words, and decides if a tree is grown while everything is read. */
static cw_status plan_classification(classification *c, cwi_bit_grid *g, cwi_octree *tree,
                                     cw_error *err)
{
    const size_t bricks = g->bricks_z * g->bricks_y;
    if (tree && !g->active)
        g->active = cwi_alloc_array(bricks * g->masks, sizeof *g->active);
    if (tree && !g->leaves)
        g->leaves = cwi_alloc_array(bricks * g->words, sizeof *g->leaves);
    if (tree && (!g->active || !g->leaves))
        return cwi_fail_memory(err);
    c->grow = tree && !tree->grown && !tree->waits ? tree : NULL;
    g->all_classified = !tree || !tree->grown;
    if (!g->all_classified)
        g->all_classified = cwi_octree_mark(tree, g) * tree->leaf_bytes >
                            cwi_octree_leaves(tree) * cw_type_size(g->volume.type);
    return CW_OK;
}

static bool any_gap(const cwi_bit_grid *g)
{
    unsigned any = 0;
    for (size_t r = 0; r < g->rows; r++)
        any |= g->filled[r];
    return any & CWI_GAP;
}

/* Compares the wanted samples. Once that was everything, it is known whether there are gaps;
 * without gaps, none are sought later. */
static cw_status compare_samples(classification *c, cwi_bit_grid *g,
                                 const cw_extract_desc *desc, cw_error *err)
{
    const cw_status st =
        cwi_parallel_for(g->bricks_z, CWI_BRICK * g->volume.dim[0] * g->volume.dim[1],
                         desc->threads, &desc->progress, "classifying", classify_layer, c, err);
    if (st == CW_OK && c->grow)
        cwi_octree_grow(c->grow);
    c->grow = NULL;
    if (st == CW_OK && g->all_classified) {
        g->gaps_known = true;
        g->has_gaps = any_gap(g);
        g->volume.has_nodata = g->volume.has_nodata && g->has_gaps;
    }
    return st;
}

static void forget_values(cwi_bit_grid *g)
{
    cwi_free(g->has);
    g->has = NULL;
}

void cwi_grid_forget(cwi_bit_grid *g, bool nodata)
{
    forget_values(g);
    g->gaps_known = g->has_gaps = false;
    g->volume.has_nodata = nodata;
}

/* The planes hold no surface between two extractions, so `inside` may be written over. */
void cwi_grid_update(cwi_bit_grid *g, const cwi_engine *engine, const cw_box *box, bool nodata)
{
    const bool is_float = g->volume.type == CW_F32 || g->volume.type == CW_F64;
    bool in = false, out = false;
    if (!g->gaps_known || (!nodata && !is_float))
        return;
    g->volume.has_nodata = nodata;
    g->find_values = g->has != NULL;
    for (size_t k = box->first[2]; k < box->first[2] + box->count[2]; k++)
        engine->classify_rows(g, box->first[1] + 1, k + 1, box->count[1], &in, &out);
    g->find_values = false;
    g->has_gaps = any_gap(g);
    g->volume.has_nodata = nodata && g->has_gaps;
    if (!g->has_gaps)
        forget_values(g);
}

/* Compares all samples, and finds those that have values. */
static cw_status compare_all(classification *c, cwi_bit_grid *g, const cw_extract_desc *desc,
                             cw_error *err)
{
    g->has = cwi_grid_plane(g);
    if (!g->has)
        return cwi_fail_memory(err);
    g->find_values = g->all_classified = true;
    const cw_status st = compare_samples(c, g, desc, err);
    g->find_values = false;
    if (st != CW_OK || !g->has_gaps) {
        cwi_free(g->has);
        g->has = NULL;
    }
    return st;
}

cw_status cwi_grid_classify(cwi_bit_grid *g, const cwi_engine *engine, cwi_octree *tree,
                            const cw_extract_desc *desc, cw_error *err)
{
    classification c = {.grid = g, .engine = engine};
    cw_status st = cwi_grid_set_level(g, desc, err);
    if (st == CW_OK)
        st = plan_classification(&c, g, tree, err);
    if (tree && st == CW_OK)
        tree->waits = false;
    const bool at_once = g->volume.has_nodata && !g->has;
    if (st == CW_OK && !at_once)
        st = compare_samples(&c, g, desc, err);
    /* few volumes of floats have NaN, and for few of these it matters */
    if (st == CW_OK && (at_once || (desc->leave_open && g->has_gaps && !g->has)))
        st = compare_all(&c, g, desc, err);
    if (st != CW_OK)
        return st;
    g->crossed = g->all_classified ? c.in && c.out : cwi_octree_crossed(tree, g);
    return cwi_grid_set_live(g, desc->leave_open, err);
}

void cwi_grid_free(cwi_bit_grid *g)
{
    for (size_t k = 0; g->layers && k < g->rows_z; k++)
        cwi_free(g->layers[k].plans);
    cwi_free(g->layers);
    cwi_free(g->row_plans);
    cwi_free(g->inside);
    cwi_free(g->has);
    cwi_free(g->live);
    cwi_free(g->window);
    cwi_free(g->mixed_words);
    cwi_free(g->filled);
    cwi_free(g->active);
    cwi_free(g->leaves);
    memset(g, 0, sizeof *g);
}

size_t cwi_grid_bytes(const cwi_bit_grid *g)
{
    const size_t planes = 1 + (g->has != NULL) + (g->live && !g->live_is_box);
    const size_t box = g->live_is_box ? 2 * g->rows_y * g->words : 0;
    const size_t bricks = g->leaves ? g->bricks_z * g->bricks_y : 0;
    size_t plans = 0;
    for (size_t k = 0; k < g->rows_z; k++)
        plans += g->layers[k].plan_capacity;
    return plans * sizeof *g->layers->plans + g->rows_z * sizeof *g->layers +
           (planes * g->rows * g->words + box + (g->rows + bricks) * g->masks) *
               sizeof *g->inside +
           g->rows * (sizeof(cwi_row) + sizeof *g->filled) +
           bricks * g->words * sizeof *g->leaves;
}
