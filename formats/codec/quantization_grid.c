/* Builds quantization grids, and counts the vertices and triangles that rounding to them merges
 * or flattens. */
#include "formats/codec/quantization_grid.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/box.h"
#include "core/geometry/triangle_intersect.h"
#include "core/mesh/weld.h"

#include <math.h>
#include <string.h>

enum { MIN_EXPONENT = -126 }; /* decoders make the power in single precision */

cwi_quantization_grid cwi_grid_around(const cwi_parts *parts)
{
    double low[3], high[3];
    cwi_quantization_grid grid = {0};
    cwi_box_clear(low, high);
    for (size_t p = 0; p < parts->count; p++)
        cwi_box_add_points(low, high, parts->items[p].mesh.positions,
                           parts->items[p].mesh.vertex_count);
    for (int a = 0; a < 3; a++) {
        grid.low[a] = (float)low[a];
        grid.range = fmaxf(grid.range, (float)high[a] - (float)low[a]);
    }
    if (!(grid.range > 0)) /* a single point */
        grid.range = 1;
    return grid;
}

/* Divides the box by a dyadic step. The box ends between multiples of the step, and range is
 * itself rounded; that takes up to three positions. */
static void lay_dyadic(cwi_quantization_grid *grid)
{
    frexp((double)grid->range / (double)((1u << grid->bits) - 4), &grid->exponent);
    if (grid->exponent < MIN_EXPONENT)
        grid->exponent = MIN_EXPONENT;
    grid->step = ldexp(1, grid->exponent);
    for (int a = 0; a < 3; a++)
        grid->origin[a] = (float)(floor((double)grid->low[a] / grid->step) * grid->step);
}

void cwi_grid_refine(cwi_quantization_grid *grid, int bits, bool dyadic)
{
    grid->bits = bits;
    grid->dyadic = dyadic;
    grid->step = (double)grid->range / (double)((1u << bits) - 1);
    memcpy(grid->origin, grid->low, sizeof grid->origin);
    if (dyadic)
        lay_dyadic(grid);
}

double cwi_grid_error(const cwi_quantization_grid *grid)
{
    return grid->step * sqrt(3) / 2;
}

/* --- harm --------------------------------------------------------------------------------- */

/* Rounds points to positions, and to the decoded positions. Places of exact grids are below 2^24
 * and serve as both. */
static void round_points(const cwi_quantization_grid *grid, const cw_mesh *mesh,
                         uint32_t *grid_points, float *found)
{
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++) {
        grid_points[i] = cwi_grid_round(grid, mesh->positions[i], (int)(i % 3));
        found[i] = grid->single ? (float)cwi_grid_decode(grid, grid_points[i], (int)(i % 3))
                                : (float)grid_points[i];
    }
}

/* Returns true if two corners' differences from the third are not parallel: exact, below
 * 2^62. */
static bool spans_area(const uint32_t *points, const uint32_t *t)
{
    const uint32_t *p = points + 3 * (size_t)t[0], *q = points + 3 * (size_t)t[1],
                   *r = points + 3 * (size_t)t[2];
    int64_t u[3], v[3];
    for (int a = 0; a < 3; a++) {
        u[a] = (int64_t)q[a] - p[a];
        v[a] = (int64_t)r[a] - p[a];
    }
    return u[0] * v[1] != u[1] * v[0] || u[1] * v[2] != u[2] * v[1] ||
           u[2] * v[0] != u[0] * v[2];
}

static bool is_elsewhere(const float *points, size_t v, size_t u)
{
    const float *p = points + 3 * v, *q = points + 3 * u;
    return p[0] != q[0] || p[1] != q[1] || p[2] != q[2];
}

static void count_harm(const cw_mesh *mesh, const uint32_t *grid_points, const float *found,
                       const uint32_t *map, cwi_grid_harm *harm)
{
    for (size_t v = 0; v < mesh->vertex_count; v++)
        harm->merged += map[v] != v && is_elsewhere(mesh->positions, v, map[v]);
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *triangle = mesh->triangles + 3 * t;
        harm->flat += !(spans_area(grid_points, triangle) && cwi_has_area(found, triangle)) &&
                      cwi_has_area(mesh->positions, triangle);
    }
}

static cw_status measure_part(const cwi_quantization_grid *grid, const cw_mesh *mesh,
                              cwi_grid_harm *harm, cw_error *err)
{
    const size_t count = mesh->vertex_count;
    uint32_t *grid_points = cwi_alloc_array(count, 3 * sizeof *grid_points);
    float *found = cwi_alloc_array(count, 3 * sizeof *found);
    uint32_t *map = cwi_alloc_array(count, sizeof *map);
    bool ok = grid_points && found && map;
    if (ok) {
        round_points(grid, mesh, grid_points, found);
        ok = cwi_weld(found, count, map);
    }
    if (ok)
        count_harm(mesh, grid_points, found, map, harm);
    cwi_free(grid_points);
    cwi_free(found);
    cwi_free(map);
    return ok ? CW_OK : cwi_fail_memory(err);
}

cw_status cwi_grid_measure(const cwi_quantization_grid *grid, const cwi_parts *parts,
                           cwi_grid_harm *harm, cw_error *err)
{
    cw_status st = CW_OK;
    *harm = (cwi_grid_harm){0};
    for (size_t p = 0; st == CW_OK && p < parts->count; p++)
        st = measure_part(grid, &parts->items[p].mesh, harm, err);
    return st;
}
