/* Chooses the coarsest quantization grid that keeps the tolerance and the shape. */
#include "formats/codec/quantization_grid.h"

#include "core/base/status.h"

#include <math.h>

/* FLOAT_BITS: as many as floats have digits. Draco's memory doubles with each bit: 64 MiB at these. */
enum { SHORT_BITS = 16, FLOAT_BITS = 24 };
static const double DIAGONALS = 20000; /* the default tolerance is the diagonal divided by
                                          this */

static const struct {
    const char *name;
    int max_bits, max_chosen; /* that may be stated; that are chosen */
} kinds[] = {[CW_COMPRESS_QUANTIZE] = {"quantize", SHORT_BITS, SHORT_BITS},
             [CW_COMPRESS_DRACO] = {"Draco", CWI_MAX_GRID_BITS, FLOAT_BITS},
             [CW_COMPRESS_MESHOPT] = {"meshopt", FLOAT_BITS, FLOAT_BITS}};

cw_status cwi_grid_check_bits(const cw_write_desc *desc, cw_error *err)
{
    const cw_compression kind = desc->compression;
    if ((size_t)kind >= sizeof kinds / sizeof *kinds)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%d is not a compression", (int)kind);
    if (desc->bits < 0 || desc->bits > kinds[kind].max_bits)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "%d bits a coordinate; there may be 1 to %d with %s", desc->bits,
                        kinds[kind].max_bits, kinds[kind].name);
    return CW_OK;
}

static double default_tolerance(const cwi_parts *parts, const cwi_quantization_grid *grid)
{
    double diagonal_sq = 0;
    for (int a = 0; a < 3; a++) {
        double high = -INFINITY;
        for (size_t p = 0; p < parts->count; p++)
            for (size_t v = 0; v < parts->items[p].mesh.vertex_count; v++)
                high = fmax(high, (double)parts->items[p].mesh.positions[3 * v + (size_t)a]);
        diagonal_sq += (high - (double)grid->low[a]) * (high - (double)grid->low[a]);
    }
    return sqrt(diagonal_sq) / DIAGONALS;
}

static cw_status fail_shape(const cwi_quantization_grid *grid, const cwi_grid_harm *harm,
                            double tolerance, cw_error *err)
{
    if (cwi_grid_error(grid) > tolerance)
        return cwi_fail(
            err, CW_ERR_CHECK,
            "%d bits a coordinate, the most there are, move vertices by up to %.3g mm; "
            "%.3g mm are allowed",
            grid->bits, cwi_grid_error(grid), tolerance);
    return cwi_fail(
        err, CW_ERR_CHECK,
        "with %d bits a coordinate, the most there are, %zu vertices fall onto others "
        "and %zu triangles lose their area; meshopt and Draco leave positions as they are",
        grid->bits, harm->merged, harm->flat);
}

/* Divides the grid. Beyond integers of 16 bits, meshopt's exponential filter makes multiples of
 * a power of two. */
static void lay_grid(cwi_quantization_grid *grid, cw_compression kind, int bits)
{
    cwi_grid_refine(grid, bits, kind == CW_COMPRESS_MESHOPT && bits > SHORT_BITS);
    grid->single = kind == CW_COMPRESS_DRACO;
}

/* Measures the largest move of a vertex: from its place to where a decoder puts it. */
static double measure_error(const cwi_quantization_grid *grid, const cwi_parts *parts)
{
    double worst = 0;
    for (size_t p = 0; p < parts->count; p++) {
        const cw_mesh *m = &parts->items[p].mesh;
        for (size_t v = 0; v < m->vertex_count; v++) {
            double diagonal_sq = 0;
            for (int a = 0; a < 3; a++) {
                const float x = m->positions[3 * v + (size_t)a];
                const double moved =
                    cwi_grid_decode(grid, cwi_grid_round(grid, x, a), a) - (double)x;
                diagonal_sq += moved * moved;
            }
            worst = diagonal_sq > worst ? diagonal_sq : worst;
        }
    }
    return sqrt(worst);
}

/* Finds the coarsest grid that keeps tolerance and shape; *found is false when none does. */
static cw_status find_grid(cwi_quantization_grid *grid, const cwi_parts *parts,
                           cw_compression kind, double tolerance, bool *found,
                           cwi_grid_harm *harm, cw_error *err)
{
    const int max = kinds[kind].max_chosen;
    cw_status st = CW_OK;
    *found = false;
    for (int bits = 1; bits <= max && st == CW_OK && !*found; bits++) {
        lay_grid(grid, kind, bits);
        const bool fine =
            cwi_grid_error(grid) <= tolerance && measure_error(grid, parts) <= tolerance;
        if (fine || bits == max)
            st = cwi_grid_measure(grid, parts, harm, err);
        *found = fine && harm->merged == 0 && harm->flat == 0;
    }
    return st;
}

cw_status cwi_grid_choose(cwi_quantization_grid *grid, const cwi_parts *parts,
                          const cw_write_desc *desc, cw_compressed *facts, cw_error *err)
{
    cwi_grid_harm harm = {0};
    bool found = true;
    cw_status st;
    *grid = cwi_grid_around(parts);
    if (!isfinite(grid->range))
        return cwi_fail(err, CW_ERR_LIMIT, "the box is too large to be divided into steps");
    const double tolerance =
        desc->tolerance_mm > 0 ? desc->tolerance_mm : default_tolerance(parts, grid);
    if (desc->bits) {
        lay_grid(grid, desc->compression, desc->bits);
        st = cwi_grid_measure(grid, parts, &harm, err);
    } else {
        st = find_grid(grid, parts, desc->compression, tolerance, &found, &harm, err);
    }
    if (st == CW_OK && !found && desc->compression != CW_COMPRESS_QUANTIZE)
        grid->bits = 0; /* positions then stay unchanged */
    else if (st == CW_OK && !found)
        return fail_shape(grid, &harm, tolerance, err);
    if (st == CW_OK && found) {
        facts->merged = harm.merged;
        facts->flat = harm.flat;
        facts->step_mm = grid->step;
        facts->error_mm = measure_error(grid, parts);
    }
    facts->bits = grid->bits;
    return st;
}
