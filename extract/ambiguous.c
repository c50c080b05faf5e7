#include "extract/ambiguous.h"

#include "core/volume.h"
#include "extract/crossing.h"
#include "extract/cube.h"

#include <math.h>

/* The number stored for a padded sample; NaN where there is none. */
static double stored_at(const cw_volume *v, size_t i, size_t j, size_t k)
{
    if (i - 1 >= v->dim[0] || j - 1 >= v->dim[1] || k - 1 >= v->dim[2]) /* 0 wraps around */
        return NAN;
    const double x = cwi_voxel_at(v->type, cwi_voxel_address(v, i - 1, j - 1, k - 1));
    return v->has_nodata && x == v->nodata ? NAN : x;
}

static double value_of(const cwi_grid *grid, double stored)
{
    return grid->invert ? grid->level - stored : stored - grid->level;
}

double cwi_value_at(const cwi_grid *grid, size_t i, size_t j, size_t k)
{
    return value_of(grid, stored_at(&grid->volume, i, j, k));
}

void cwi_ambiguous_load(const cwi_grid *grid, const size_t at[3], unsigned cube,
                        cwi_ambiguous *cell)
{
    double values[8];
    for (size_t c = 0; c < 8; c++) {
        const double x =
            stored_at(&grid->volume, at[0] + (c & 1), at[1] + (c >> 1 & 1), at[2] + (c >> 2));
        cell->stored[c] = x;
        values[c] = value_of(grid, x);
    }
    for (int a = 0; a < 3; a++)
        cell->at[a] = at[a];
    cwi_cell_plan_make(cube, values, cwi_zero_is_inside(grid), &cell->plan);
}

/* Central differences at a corner, in halves; NaN where a neighbour is missing. */
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

/* The corners' gradients, interpolated. Near the border and missing values it is NaN: such
 * vertices get their normal from the triangles around them. */
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

void cwi_ambiguous_build(const cwi_grid *grid, const cwi_ambiguous *cell,
                         const cwi_vertex_sink *sink, size_t first, cwi_cell *out)
{
    double crossings[12];
    for (int e = 0; e < 12; e++) {
        const int low = cwi_edge_corner(e), high = low | 1 << cwi_edge_axis(e);
        crossings[e] = cwi_crossing(cell->stored[low], cell->stored[high], grid->level);
    }
    cwi_cell_build(&cell->plan, crossings, out);
    for (int n = 0; n < cell->plan.vertex_count; n++) {
        double g[3] = {0, 0, 0};
        if (sink->normals)
            inner_gradient(&grid->volume, cell->at, out->vertices[n], g);
        cwi_sink_vertex(sink, cell->at, out->vertices[n], g, first + (size_t)n);
    }
}
