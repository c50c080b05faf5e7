#include "extract/grid.h"

#include "core/layers.h"
#include "core/memory.h"
#include "core/status.h"
#include "extract/engine.h"

#include <float.h>
#include <math.h>
#include <string.h>

static cw_status allocate(cwi_grid *g, bool leave_open, cw_error *err)
{
    size_t bits = 0;
    g->words = (g->volume.dim[0] + 2 + 63) / 64;
    g->rows_y = g->volume.dim[1] + 2;
    g->rows_z = g->volume.dim[2] + 2;
    if (cwi_size_mul(g->rows_y, g->rows_z, &g->rows) &&
        cwi_size_mul(g->rows, g->words, &bits)) {
        g->inside = cwi_alloc_large(bits, sizeof *g->inside);
        g->live = leave_open ? cwi_alloc_large(bits, sizeof *g->live) : NULL;
    }
    if (g->inside && (g->live || !leave_open))
        return CW_OK;
    return cw_fail(err, CW_ERR_NO_MEMORY,
                   "no memory for the bit planes of %zu x %zu x %zu voxels", g->volume.dim[0],
                   g->volume.dim[1], g->volume.dim[2]);
}

typedef struct classification {
    cwi_grid *grid;
    const cwi_engine *engine;
    bool in, out; /* there are samples with values inside, and outside */
} classification;

static void classify_layer(void *context, size_t k)
{
    classification *c = context;
    bool in = false, out = false;
    c->engine->classify_layer(c->grid, k, &in, &out);
    if (in) {
#pragma omp atomic write
        c->in = true;
    }
    if (out) {
#pragma omp atomic write
        c->out = true;
    }
}

static cw_status classify(cwi_grid *g, const cwi_engine *engine, const cw_extract_desc *desc,
                          cw_error *err)
{
    classification c = {.grid = g, .engine = engine};
    cw_status st = cwi_each_layer(g->rows_z, g->volume.dim[0] * g->volume.dim[1], desc->threads,
                                  &desc->progress, "classifying", classify_layer, &c, err);
    g->crossed = c.in && c.out;
    return st;
}

/* Turns the plane of samples with values into the plane of cells all of whose samples have
 * values, in place: a cell needs its own row and rows after it, which are still samples. */
static void make_live(cwi_grid *g)
{
    for (size_t r = 0; r < g->rows; r++) {
        const size_t j = r % g->rows_y, k = r / g->rows_y;
        uint64_t *row = g->live + r * g->words;
        const bool last = j + 1 == g->rows_y || k + 1 == g->rows_z;
        for (size_t w = 0; w < g->words; w++) {
            uint64_t cells = last ? 0 : ~UINT64_C(0);
            for (size_t n = 0; n < 4 && !last; n++) {
                const uint64_t *samples = row + ((n & 1) + (n >> 1) * g->rows_y) * g->words;
                cells &= samples[w] & cwi_next_samples(samples, w, g->words);
            }
            row[w] = cells;
        }
    }
}

/* Clears cells of a row: the cells in `cells`, and with `before` each one's neighbour at i - 1.
 */
static void clear_cells(uint64_t *row, size_t w, uint64_t cells, bool before)
{
    row[w] &= ~cells;
    if (!before)
        return;
    row[w] &= ~(cells >> 1);
    if (w > 0)
        row[w - 1] &= ~(cells << 63);
}

/* Drops cells that meet in nothing but a crossed edge: two live ones, diagonal, the other two
 * dead. Both would put triangles at its vertex, in two fans. One sweep; true if any was
 * dropped, which may have left others so. */
static bool drop_pinched(cwi_grid *g)
{
    bool changed = false;
    for (size_t k = 1; k < g->rows_z; k++)
        for (size_t j = 1; j < g->rows_y; j++)
            for (int axis = 0; axis < 3; axis++) {
                uint64_t *here = g->live + (k * g->rows_y + j) * g->words;
                uint64_t *below = here - (axis == 1 ? g->rows_y : 1) * g->words;
                uint64_t *side = here - g->rows_y * g->words, *corner = side - g->words;
                for (size_t w = 0; w < g->words; w++) {
                    const uint64_t a = here[w], b = below[w];
                    uint64_t c, d; /* beside a, beside b */
                    if (axis == 0) {
                        c = side[w];
                        d = corner[w];
                    } else {
                        c = a << 1 | (w ? here[w - 1] >> 63 : 0);
                        d = b << 1 | (w ? below[w - 1] >> 63 : 0);
                    }
                    const uint64_t pinched = ((a & d & ~b & ~c) | (b & c & ~a & ~d)) &
                                             cwi_grid_crossed(g, axis, j, k, w);
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

/* The isovalue in stored numbers, and which side of it is inside. */
static cw_status set_level(cwi_grid *g, const cw_extract_desc *desc, cw_error *err)
{
    const double slope = g->volume.slope;
    g->level = (desc->isovalue - g->volume.intercept) / slope;
    g->strict = slope < 0;
    g->invert = (slope < 0) != desc->inside_is_low;
    g->simple = desc->simple_topology;
    if (!isfinite(desc->isovalue) || !isfinite(g->level))
        return cw_fail(err, CW_ERR_ARGUMENT,
                       "isovalue %g is not finite, or not after slope %g and intercept %g",
                       desc->isovalue, slope, g->volume.intercept);
    return CW_OK;
}

/* Positions are floats: they cannot tell voxels apart that are too small, and cannot reach the
 * ends of volumes that are too large. */
static cw_status check_range(const cw_volume *v, cw_error *err)
{
    double spacing[3];
    cw_volume_spacing(v, spacing);
    for (int a = 0; a < 3; a++)
        if (spacing[a] < (double)FLT_MIN ||
            spacing[a] * (double)v->dim[a] > 0.5 * (double)FLT_MAX)
            return cw_fail(err, CW_ERR_ARGUMENT,
                           "%zu voxels of %g mm along %c are beyond what positions can hold",
                           v->dim[a], spacing[a], "xyz"[a]);
    return CW_OK;
}

cw_status cwi_grid_build(cwi_grid *g, const cwi_engine *engine, const cw_volume *volume,
                         const cw_extract_desc *desc, cw_error *err)
{
    memset(g, 0, sizeof *g);
    cw_status st = cw_volume_select(volume, 0, 0, &g->volume, err);
    if (st == CW_OK)
        st = set_level(g, desc, err);
    for (int a = 0; a < 3 && st == CW_OK; a++)
        if (g->volume.dim[a] < 2)
            st = cw_fail(err, CW_ERR_ARGUMENT,
                         "the volume has %zu voxel along %c; a surface needs 2",
                         g->volume.dim[a], "xyz"[a]);
    if (st == CW_OK)
        st = check_range(&g->volume, err);
    if (st == CW_OK)
        st = allocate(g, desc->leave_open, err);
    if (st == CW_OK)
        st = classify(g, engine, desc, err);
    if (st == CW_OK && g->live) {
        make_live(g);
        while (drop_pinched(g))
            ;
    }
    return st;
}

void cwi_grid_free(cwi_grid *g)
{
    cwi_free(g->inside);
    cwi_free(g->live);
    memset(g, 0, sizeof *g);
}

size_t cwi_grid_bytes(const cwi_grid *g)
{
    return g->rows * g->words * sizeof *g->inside * (g->live ? 2 : 1) +
           g->rows * sizeof(cwi_row);
}
