/* Chooses the coarsest quantization grid that keeps the tolerance and the shape. */
#include "formats/codec/quantization_grid.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/codec/settle_points.h"

#include <math.h>

/* FLOAT_BITS: as many as floats have digits. Draco's memory doubles with each bit: 64 MiB at these. */
enum { SHORT_BITS = 16, FLOAT_BITS = 24 };

/* Places for points that fall onto others are sought if these are fewer than this part of all. */
enum { MOST_MERGED = 4 };

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

static bool is_harmless(const cwi_grid_harm *harm)
{
    return !harm->merged && !harm->flat;
}

/* A grid that is sought. */
typedef struct grid_search {
    cwi_quantization_grid *grid;
    cwi_parts *parts;
    const cw_mesh *given; /* the meshes of the parts as they came */
    cwi_settler settler;
    cwi_grid_harm harm;
    cw_compressed *facts;
    float *settled; /* positions of all parts; NULL: they are as they came */
} grid_search;

/* Gives parts the positions of an array, or those that they came with. */
static void set_positions(grid_search *s, float *positions)
{
    for (size_t p = 0, point = 0; p < s->parts->count; p++) {
        s->parts->items[p].mesh.positions =
            positions ? positions + 3 * point : s->given[p].positions;
        point += s->given[p].vertex_count;
    }
}

/* Returns true if few enough points share their places for others to be found. */
static bool may_settle(const grid_search *s)
{
    size_t points = 0;
    for (size_t p = 0; p < s->parts->count; p++)
        points += s->parts->items[p].mesh.vertex_count;
    return s->harm.merged < points / MOST_MERGED;
}

/* Moves points to places of their own, if there are some within most_mm. */
static cw_status settle_points(grid_search *s, double most_mm, cw_error *err)
{
    cw_compressed *f = s->facts;
    cwi_grid_harm harm;
    cw_status st = s->settler.points ? CW_OK : cwi_settler_init(&s->settler, s->parts, err);
    if (st != CW_OK || !cwi_settle_points(&s->settler, s->grid, most_mm, &f->settled)) {
        f->settled = 0;
        return st;
    }
    cwi_settler_move(&s->settler, s->grid, &f->error_mm);
    set_positions(s, s->settler.points);
    st = cwi_grid_measure(s->grid, s->parts, &harm, err);
    if (st == CW_OK && is_harmless(&harm)) {
        s->harm = harm;
        s->settled = s->settler.points;
        s->settler.points = NULL;
    } else { /* decoders' single precision joins them */
        set_positions(s, NULL);
        f->settled = 0;
    }
    cwi_settler_free(&s->settler);
    return st;
}

/* Measures a grid, and makes it harmless if that can be. */
static cw_status try_grid(grid_search *s, double most_mm, cw_error *err)
{
    cw_status st = cwi_grid_measure(s->grid, s->parts, &s->harm, err);
    return st == CW_OK && !is_harmless(&s->harm) && may_settle(s)
               ? settle_points(s, most_mm, err)
               : st;
}

/* Finds the coarsest grid that keeps tolerance and shape; *found is false when none does. */
static cw_status find_grid(grid_search *s, cw_compression kind, double tolerance, bool *found,
                           cw_error *err)
{
    const int max = kinds[kind].max_chosen;
    cw_status st = CW_OK;
    *found = false;
    for (int bits = 1; bits <= max && st == CW_OK && !*found; bits++) {
        lay_grid(s->grid, kind, bits);
        const bool fine = cwi_grid_error(s->grid) <= tolerance &&
                          measure_error(s->grid, s->parts) <= tolerance;
        if (fine)
            st = try_grid(s, tolerance, err);
        else if (bits == max)
            st = cwi_grid_measure(s->grid, s->parts, &s->harm, err);
        *found = fine && is_harmless(&s->harm);
    }
    return st;
}

static cw_status search_grid(grid_search *s, const cw_write_desc *desc, cw_error *err)
{
    const double tolerance =
        desc->tolerance_mm > 0 ? desc->tolerance_mm : default_tolerance(s->parts, s->grid);
    cw_compressed *f = s->facts;
    bool found = true;
    cw_status st;
    if (desc->bits) {
        lay_grid(s->grid, desc->compression, desc->bits);
        st = try_grid(s, INFINITY, err);
    } else {
        st = find_grid(s, desc->compression, tolerance, &found, err);
    }
    if (st == CW_OK && !found && desc->compression != CW_COMPRESS_QUANTIZE)
        s->grid->bits = 0; /* positions then stay unchanged */
    else if (st == CW_OK && !found)
        return fail_shape(s->grid, &s->harm, tolerance, err);
    if (st == CW_OK && found) {
        f->merged = s->harm.merged;
        f->flat = s->harm.flat;
        f->step_mm = s->grid->step;
        f->error_mm = s->settled ? f->error_mm : measure_error(s->grid, s->parts);
    }
    f->bits = s->grid->bits;
    return st;
}

cw_status cwi_grid_choose(cwi_quantization_grid *grid, cwi_parts *parts,
                          const cw_write_desc *desc, float **settled, cw_compressed *facts,
                          cw_error *err)
{
    cw_mesh *given = cwi_alloc_array(parts->count, sizeof *given);
    grid_search s = {.grid = grid, .parts = parts, .given = given, .facts = facts};
    *settled = NULL;
    *grid = cwi_grid_around(parts);
    if (!given)
        return cwi_fail_memory(err);
    for (size_t p = 0; p < parts->count; p++)
        given[p] = parts->items[p].mesh;
    cw_status st =
        isfinite(grid->range)
            ? search_grid(&s, desc, err)
            : cwi_fail(err, CW_ERR_LIMIT, "the box is too large to be divided into steps");
    *settled = s.settled;
    cwi_settler_free(&s.settler);
    cwi_free(given);
    return st;
}
