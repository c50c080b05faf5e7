/* Plans the ambiguous cells of a dense grid from the values of their eight corners, and writes
 * their triangles and inner vertices. */
#include "extract/dense/ambiguous_cells.h"

#include "core/base/memory.h"
#include "core/cases/cube_numbering.h"
#include "core/volume/volume.h"
#include "extract/dense/cubic_crossing.h"
#include "extract/dense/vertex_writer.h"

#include <math.h>

/* Returns the number stored for a padded sample; NaN where there is none. */
static double stored_at(const cw_volume *v, size_t i, size_t j, size_t k)
{
    if (i - 1 >= v->dim[0] || j - 1 >= v->dim[1] || k - 1 >= v->dim[2]) /* 0 wraps around */
        return NAN;
    const double x = cwi_voxel_at(v->type, cwi_voxel_address(v, i - 1, j - 1, k - 1));
    return v->has_nodata && x == v->nodata ? NAN : x;
}

/* Returns 1 or -1: the factor of numbers for the decisions, after the level is subtracted. */
static double toward_inside(const cwi_bit_grid *grid)
{
    return grid->invert ? -1 : 1;
}

double cwi_value_at(const cwi_bit_grid *grid, size_t i, size_t j, size_t k)
{
    return toward_inside(grid) * (stored_at(&grid->volume, i, j, k) - grid->level);
}

/* Loads the numbers of a cell's eight corners, minus the level, times a factor. Most cells are
 * within the volume. */
static void load_corners(const cw_volume *v, const size_t at[3], double level, double factor,
                         double values[8])
{
    bool within = !v->has_nodata;
    for (int a = 0; a < 3; a++)
        within = within && at[a] >= 1 && at[a] < v->dim[a];
    if (!within) {
        for (size_t c = 0; c < 8; c++)
            values[c] =
                factor *
                (stored_at(v, at[0] + (c & 1), at[1] + (c >> 1 & 1), at[2] + (c >> 2)) - level);
        return;
    }
    const char *p = cwi_voxel_address(v, at[0] - 1, at[1] - 1, at[2] - 1);
    switch (v->type) {
#define CASE(name, ctype, text)                                                                \
    case name:                                                                                 \
        for (size_t c = 0; c < 8; c++)                                                         \
            values[c] = factor * ((double)*(const ctype *)(p + (c & 1 ? v->stride[0] : 0) +    \
                                                           (c & 2 ? v->stride[1] : 0) +        \
                                                           (c & 4 ? v->stride[2] : 0)) -       \
                                  level);                                                      \
        break;
        CW_TYPE_TABLE(CASE)
#undef CASE
    default:
        break;
    }
}

void cwi_corner_values(const cwi_bit_grid *grid, const size_t at[3], double values[8])
{
    load_corners(&grid->volume, at, grid->level, toward_inside(grid), values);
}

/* Appends a cell's plan to its layer's list, and doubles the capacity when the list is full.
 * Without memory for it, or beyond a limit, there is no list: the layer's cells are planned
 * twice. */
static void note_cell(cwi_layer *layer, size_t max_plans, uint32_t code)
{
    if (layer->plan_count == layer->plan_capacity && !layer->plans_lost) {
        const size_t capacity = layer->plan_capacity ? 2 * layer->plan_capacity : 64;
        const bool fits = !max_plans || capacity <= max_plans;
        uint32_t *more = fits ? cwi_realloc_array(layer->plans, capacity, sizeof *more) : NULL;
        layer->plans_lost = !more;
        layer->plan_capacity = more ? capacity : 0;
        if (!more)
            cwi_free(layer->plans);
        layer->plans = more;
    }
    if (!layer->plans_lost)
        layer->plans[layer->plan_count++] = code;
}

static void make_plan(const cwi_bit_grid *grid, const size_t at[3], unsigned cube,
                      cwi_cell_plan *plan)
{
    double values[8];
    cwi_corner_values(grid, at, values);
    cwi_cell_plan_make(cube, values, cwi_zero_is_inside(grid), plan);
}

void cwi_ambiguous_plan(const cwi_bit_grid *grid, const size_t at[3], unsigned cube,
                        cwi_cell_plan *plan)
{
    make_plan(grid, at, cube, plan);
    note_cell(&grid->layers[at[2]], grid->max_plans, cwi_cell_plan_pack(plan));
}

/* Computes central differences at a corner, in halves; NaN where a neighbour is missing. */
static void corner_gradient(const cw_volume *v, const size_t at[3], size_t corner, double g[3])
{
    const size_t p[3] = {at[0] + (corner & 1), at[1] + (corner >> 1 & 1),
                         at[2] + (corner >> 2)};
    for (int a = 0; a < 3; a++) {
        const size_t s[3] = {a == 0, a == 1, a == 2};
        g[a] = 0.5 * stored_at(v, p[0] + s[0], p[1] + s[1], p[2] + s[2]) -
               0.5 * stored_at(v, p[0] - s[0], p[1] - s[1], p[2] - s[2]);
    }
}

/* Interpolates the corners' gradients. Near the border and missing values the result is NaN:
 * such vertices get their normal from the triangles around them. */
static void inner_gradient(const cw_volume *v, const size_t at[3], const double p[3],
                           double g[3])
{
    g[0] = g[1] = g[2] = 0;
    for (size_t c = 0; c < 8; c++) {
        const double weight =
            (c & 1 ? p[0] : 1 - p[0]) * (c & 2 ? p[1] : 1 - p[1]) * (c & 4 ? p[2] : 1 - p[2]);
        double h[3];
        corner_gradient(v, at, c, h);
        for (int a = 0; a < 3; a++)
            g[a] += weight * h[a];
    }
}

/* Returns where an edge of the cell is crossed, the same as its vertex. */
static double crossing_of(const cwi_bit_grid *grid, const size_t cell[3],
                          const double stored[8], int edge)
{
    const cw_volume *v = &grid->volume;
    const size_t low = (size_t)cwi_edge_corner(edge), axis = (size_t)cwi_edge_axis(edge);
    const size_t step[3] = {axis == 0, axis == 1, axis == 2};
    const size_t at[3] = {cell[0] + (low & 1), cell[1] + (low >> 1 & 1), cell[2] + (low >> 2)};
    double x[4] = {NAN, stored[low], stored[low | (size_t)1 << axis], NAN}, t;
    if (grid->cubic) {
        x[0] = stored_at(v, at[0] - step[0], at[1] - step[1], at[2] - step[2]);
        x[3] = stored_at(v, at[0] + 2 * step[0], at[1] + 2 * step[1], at[2] + 2 * step[2]);
        if (cwi_cubic_crossing(x, grid->level, &t))
            return t;
    }
    return cwi_edge_crossing(x[1], x[2], grid->level);
}

void cwi_ambiguous_build(const cwi_bit_grid *grid, const size_t at[3], unsigned cube, size_t n,
                         cwi_vertex_sink *sink, size_t first, cwi_cell_plan *plan,
                         cwi_cell *out)
{
    const cwi_layer *layer = &grid->layers[at[2]];
    double crossings[12] = {0}, stored[8];
    if (layer->plans_lost)
        make_plan(grid, at, cube, plan);
    else
        cwi_cell_plan_unpack(layer->plans[n], plan);
    if (plan->vertex_count) { /* only inner vertices need them */
        load_corners(&grid->volume, at, 0, 1, stored);
        for (int e = 0; e < 12; e++)
            crossings[e] = crossing_of(grid, at, stored, e);
    }
    cwi_cell_build(plan, crossings, out);
    for (int v = 0; v < plan->vertex_count; v++) {
        double g[3];
        cwi_store_position(sink, at, out->vertices[v], first + (size_t)v);
        if (!sink->normals)
            continue;
        inner_gradient(&grid->volume, at, out->vertices[v], g);
        cwi_store_normal(sink, g, first + (size_t)v);
    }
}
