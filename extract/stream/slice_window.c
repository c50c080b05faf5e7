/* Moves a window of slices up through a volume: reads, classifies and counts each slice once. */
#include "extract/stream/slice_window.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/volume/volume.h"
#include "extract/common/field_normals.h"
#include "extract/dense/crossed_edges.h"

#include <assert.h>
#include <string.h>

/* Plans of ambiguous cells, 4 bytes each, that all layers in memory keep. */
enum { PLANS = 1 << 18 };

/* Finds the layers that vertices need below and above. Those are the samples at the ends of an
 * edge, and beside them. On a rectilinear grid normals are found at rounded positions, which may be
 * in another layer of cells. Edges need the live cells below them, and cells all sweeps. */
static void find_neighbours(const cw_volume *whole, const cw_extract_desc *d, size_t sweeps,
                            size_t *below, size_t *above)
{
    const bool by_position = cwi_is_rectilinear(whole) && !d->no_normals;
    const size_t more = by_position ? 1 + cwi_shading_drift(whole) : 0;
    *below = (d->cubic_placement ? 2 : 1) + more + (sweeps ? 1 : 0);
    *above = 2 + (sweeps > more ? sweeps : more);
}

static size_t slices_for(const cw_volume *whole, const cw_extract_desc *d, size_t sweeps,
                         size_t layers)
{
    size_t below, above;
    find_neighbours(whole, d, sweeps, &below, &above);
    const size_t needed = layers + below + above;
    return needed < whole->dim[2] ? needed : whole->dim[2];
}

size_t cwi_slice_window_bytes(const cw_volume *whole, const cw_extract_desc *d, size_t sweeps,
                              size_t layers)
{
    const size_t words = (whole->dim[0] + 2 + 63) / 64, masks = (words + 63) / 64;
    const size_t planes = sweeps ? 3 : whole->has_nodata ? 2 : 1;
    const size_t row = (planes * words + masks) * sizeof(uint64_t) + sizeof(cwi_row) +
                       sizeof(uint32_t) + sizeof(uint8_t);
    const size_t slice = (size_t)whole->stride[2];
    return slices_for(whole, d, sweeps, layers) * (slice + (whole->dim[1] + 2) * row);
}

/* Gives the grid the size of the slices in memory. */
static void fit_grid(cwi_slice_window *w)
{
    cwi_bit_grid *g = &w->plan.grid;
    g->volume.dim[2] = w->count;
    g->rows_z = w->count + 2;
    g->rows = g->rows_y * g->rows_z;
    g->bricks_z = (g->rows_z - 1 + CWI_BRICK - 1) / CWI_BRICK;
    if (w->whole.coordinates[2])
        g->volume.coordinates[2] = w->whole.coordinates[2] + w->first;
}

static void clear_rows(const cwi_bit_grid *g, uint64_t *plane, size_t layer, size_t row,
                       size_t rows)
{
    if (plane)
        memset(plane + (layer * g->rows_y + row) * g->words, 0,
               rows * g->words * sizeof *plane);
}

cw_status cwi_slice_window_init(cwi_slice_window *w, const cwi_engine *engine,
                                const cw_slice_source *source, const cw_extract_desc *desc,
                                size_t layers, cw_error *err)
{
    cwi_bit_grid *g = &w->plan.grid;
    w->source = source;
    w->desc = *desc;
    find_neighbours(&w->whole, desc, w->sweeps, &w->below, &w->above);
    w->plan.engine = engine;
    w->capacity = slices_for(&w->whole, desc, w->sweeps, layers);
    w->slices = cwi_alloc_large(w->capacity, (size_t)w->whole.stride[2]);
    if (!w->slices)
        return cwi_fail_memory(err);
    w->whole.data = w->slices;
    cw_volume part = w->whole;
    part.dim[2] = w->capacity;
    cw_status st = cwi_extract_check_range(&w->whole, err);
    if (st == CW_OK)
        st = cwi_grid_init(g, &part, err);
    if (st == CW_OK)
        st = cwi_grid_set_level(g, desc, err);
    if (st != CW_OK)
        return st;
    g->all_classified = true;
    g->max_plans = PLANS / w->capacity;
    w->plan.rows = cwi_alloc_zeroed(g->rows, sizeof *w->plan.rows);
    g->row_plans = cwi_alloc_zeroed(g->rows, sizeof *g->row_plans);
    const bool finds_values = w->whole.has_nodata || w->sweeps;
    g->has = finds_values ? cwi_grid_plane(g) : NULL;
    g->live = w->sweeps ? cwi_grid_plane(g) : NULL;
    if (!w->plan.rows || !g->row_plans || (finds_values && !g->has) || (w->sweeps && !g->live))
        return cwi_fail_memory(err);
    /* the row after the last layer is read too: its padding has to be outside */
    clear_rows(g, g->inside, 0, 0, g->rows);
    clear_rows(g, g->has, 0, 0, g->rows);
    clear_rows(g, g->live, 0, 0, g->rows);
    g->find_values = g->has != NULL;
    g->has_gaps = w->sweeps > 0;
    return w->sweeps ? CW_OK : cwi_grid_set_live(g, desc->leave_open, err);
}

void cwi_slice_window_free(cwi_slice_window *w)
{
    if (w->plan.grid.layers) /* also those of layers beyond the present size */
        w->plan.grid.rows_z = w->capacity + 2;
    cwi_plan_free(&w->plan);
    cwi_free(w->slices);
    memset(w, 0, sizeof *w);
}

/* --- reading and classifying ---------------------------------------------------------------- */

typedef struct slab_work {
    cwi_slice_window *window;
    size_t begin; /* in the grid */
} slab_work;

static void classify_slice(void *context, size_t n)
{
    slab_work *work = context;
    cwi_slice_window *w = work->window;
    const cwi_bit_grid *g = &w->plan.grid;
    const size_t layer = work->begin + n;
    bool in = false, out = false;
    for (int end = 0; end < 2; end++) {
        clear_rows(g, g->inside, layer, end ? g->rows_y - 1 : 0, 1);
        clear_rows(g, g->has, layer, end ? g->rows_y - 1 : 0, 1);
    }
    w->plan.engine->classify_rows(g, 1, layer, g->rows_y - 2, &in, &out);
    if (in)
        cwi_set_flag(&w->in);
    if (out) {
        cwi_set_flag(&w->out);
    }
}

/* Moves the arrays of layers down by a number of layers. */
static void shift_layers(cwi_slice_window *w, size_t by, size_t slices)
{
    cwi_bit_grid *g = &w->plan.grid;
    const size_t rows = g->rows_y, from = (1 + by) * rows, count = slices * rows;
    memmove(w->slices, w->slices + by * (size_t)w->whole.stride[2],
            slices * (size_t)w->whole.stride[2]);
#define SHIFT(array, each)                                                                     \
    memmove((array) + rows * (each), (array) + from * (each), count * (each) * sizeof *(array))
    SHIFT(g->inside, g->words);
    if (g->has)
        SHIFT(g->has, g->words);
    if (w->sweeps)
        SHIFT(g->live, g->words);
    SHIFT(g->mixed_words, g->masks);
    SHIFT(g->filled, 1);
    SHIFT(w->plan.rows, 1);
    SHIFT(g->row_plans, 1);
#undef SHIFT
    for (size_t k = 1; k <= slices; k++) { /* their lists keep their memory */
        const cwi_layer layer = g->layers[k];
        g->layers[k] = g->layers[k + by];
        g->layers[k + by] = layer;
    }
}

/* Brings voxel slices first to end - 1 into memory. */
static cw_status hold_slices(cwi_slice_window *w, size_t first, size_t end, cw_error *err)
{
    cwi_bit_grid *g = &w->plan.grid;
    const size_t last = w->first + w->count, kept = last > first ? last - first : 0;
    if (first > w->first && kept)
        shift_layers(w, first - w->first, kept);
    w->first = first;
    w->count = end - first;
    fit_grid(w);
    cw_status st = kept < w->count
                       ? w->source->read(w->source->user, first + kept, w->count - kept,
                                         w->slices + kept * (size_t)w->whole.stride[2], err)
                       : CW_OK;
    if (st != CW_OK)
        return st;
    clear_rows(g, g->inside, 0, 0, g->rows_y);
    clear_rows(g, g->inside, g->rows_z - 1, 0, g->rows_y);
    clear_rows(g, g->has, 0, 0, g->rows_y);
    clear_rows(g, g->has, g->rows_z - 1, 0, g->rows_y);
    slab_work work = {.window = w, .begin = 1 + kept};
    return cwi_parallel_for(w->count - kept, g->volume.dim[0] * g->volume.dim[1],
                            w->desc.threads, &(cw_progress){0}, "classifying", classify_slice,
                            &work, err);
}

static bool has_gap(const cwi_slice_window *w)
{
    const cwi_bit_grid *g = &w->plan.grid;
    unsigned any = 0;
    for (size_t r = g->rows_y; r < g->rows - g->rows_y; r++)
        any |= g->filled[r];
    return any & CWI_GAP;
}

cw_status cwi_slice_window_scan(cwi_slice_window *w, bool all, cw_error *err)
{
    cwi_bit_grid *g = &w->plan.grid;
    const size_t slices = w->whole.dim[2];
    cw_status st = CW_OK;
    for (size_t first = 0; first < slices && st == CW_OK; first += w->capacity) {
        const size_t left = slices - first;
        if (!all && w->in && w->out)
            break;
        st = cwi_progress(&w->desc.progress, "scanning", (double)first / (double)slices, err);
        w->count = 0; /* slices of two steps have nothing in common */
        if (st == CW_OK)
            st = hold_slices(w, first, first + (left < w->capacity ? left : w->capacity), err);
        g->has_gaps = g->has_gaps || (st == CW_OK && has_gap(w));
    }
    return st;
}

/* --- live cells ------------------------------------------------------------------------------ */

/* Makes the n-th sweep over layer swept - n, if it is one of those with a layer below. */
static void sweep_layers(cwi_slice_window *w)
{
    const cwi_bit_grid *g = &w->plan.grid;
    for (size_t n = 0; n < w->sweeps && n < w->swept; n++) {
        const size_t layer = w->swept - n;
        const bool any =
            layer <= w->whole.dim[2] && cwi_drop_pinched_layer(g, layer - w->first);
        w->unsettled = w->unsettled || (any && n + 1 == w->sweeps);
    }
}

/* Finds the live cells of layers whose samples came into memory, and makes the sweeps that they
 * allow. Above the last layer of cells the later sweeps go on. */
static cw_status find_live(cwi_slice_window *w, cw_error *err)
{
    const size_t slices = w->whole.dim[2], last = w->first + w->count,
                 end = !w->sweeps       ? w->swept
                       : last == slices ? slices + w->sweeps
                                        : last;
    for (; w->swept < end; w->swept++) {
        if (w->swept <= slices)
            cwi_find_live_layer(&w->plan.grid, w->swept - w->first);
        sweep_layers(w);
    }
    return w->unsettled
               ? cwi_fail(err, CW_ERR_UNSUPPORTED,
                          "around voxels without a value (NaN, no-data) the border of the "
                          "open surface depends on more than %d slices; it is found in memory",
                          CWI_SWEEPS)
               : CW_OK;
}

/* --- counting ------------------------------------------------------------------------------- */

/* Makes sums of the number of ambiguous cells in each row, from those of rows that have some. */
static void sum_plans(cwi_bit_grid *g, size_t layer)
{
    uint32_t *plans = g->row_plans + layer * g->rows_y, sum = 0;
    for (size_t j = 0; j < g->rows_y; j++) {
        const uint32_t through = plans[j];
        plans[j] = sum; /* before the row */
        sum = through > sum ? through : sum;
    }
}

static void count_layer(void *context, size_t n)
{
    slab_work *work = context;
    cwi_slice_window *w = work->window;
    cwi_bit_grid *g = &w->plan.grid;
    const size_t layer = work->begin + n;
    memset(g->row_plans + layer * g->rows_y, 0, g->rows_y * sizeof *g->row_plans);
    w->plan.engine->count_layer(g, layer, w->plan.rows);
    sum_plans(g, layer);
}

/* Turns first numbers within a layer into those within the surface. */
static void number_layer(cwi_slice_window *w, size_t layer)
{
    const cwi_bit_grid *g = &w->plan.grid;
    cwi_row *row = w->plan.rows + layer * g->rows_y;
    for (size_t j = 0; j < g->rows_y; j++, row++) {
        for (int kind = 0; kind < 4; kind++)
            row->first[kind] += (uint32_t)w->vertices;
        row->triangle += w->triangles;
    }
    w->vertices += g->layers[layer].vertices;
    w->triangles += g->layers[layer].triangles;
}

/* Counts layers up to and with `last`, as far as they have no numbers yet. */
static cw_status count_layers(cwi_slice_window *w, size_t last, cw_error *err)
{
    const cwi_bit_grid *g = &w->plan.grid;
    const size_t count = last + 1 - w->counted;
    slab_work work = {.window = w, .begin = w->counted - w->first};
    cw_status st = cwi_parallel_for(count, g->rows_y * g->words * 64, w->desc.threads,
                                    &(cw_progress){0}, "counting", count_layer, &work, err);
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        number_layer(w, work.begin + n);
        if (w->vertices > UINT32_MAX)
            st = cwi_fail(err, CW_ERR_LIMIT,
                          "the surface has more than %u vertices, which is what a mesh holds; "
                          "layer %zu of %zu was reached",
                          UINT32_MAX, w->counted + n, w->whole.dim[2] + 1);
    }
    w->counted = last + 1;
    return st;
}

/* The layer below is counted too: normals are repaired from its triangles. */
void cwi_slice_window_start(cwi_slice_window *w, size_t layer)
{
    w->first = w->count = w->swept = 0; /* slices of two passes have nothing in common */
    w->start = layer;
    w->counted = layer ? layer - 1 : 0;
    w->vertices = w->triangles = w->first_vertex = w->first_triangle = 0;
}

cw_status cwi_slice_window_pass(cwi_slice_window *w, size_t begin, size_t end, cw_error *err)
{
    const size_t slices = w->whole.dim[2];
    const size_t first = begin > w->below + 1 ? begin - w->below - 1 : 0;
    const size_t last = end + w->above - 1 < slices ? end + w->above - 1 : slices;
    cw_status st = hold_slices(w, first, last, err);
    return st == CW_OK ? find_live(w, err) : st;
}

cw_status cwi_slice_window_move(cwi_slice_window *w, size_t begin, size_t end, cw_error *err)
{
    cw_status st = cwi_slice_window_pass(w, begin, end, err);
    if (st == CW_OK)
        st = count_layers(w, end, err);
    if (st == CW_OK && begin == w->start) {
        w->first_vertex = cwi_slice_window_layer(w, begin)->first[0];
        w->first_triangle = cwi_slice_window_layer(w, begin)->triangle;
    }
    return st;
}

void cwi_slice_window_add_border(const cwi_slice_window *w, cwi_border_loops *loops)
{
    assert(loops->next == 0 || loops->next > w->first);
    while (loops->next < w->first + w->count)
        cwi_border_loops_add(loops, &w->plan.grid, loops->next - w->first + 1);
}
