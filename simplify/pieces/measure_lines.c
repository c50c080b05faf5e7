/* Measures solids along parallel lines: each triangle is met by the lines through it, and between two meetings
 * it is known which solids are there. */
#include "simplify/pieces/measure_lines.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/box.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LINES = 400 }; /* along the longer side of the box across them */

/* The place of a line in its cell: lines are to miss edges and vertices, which are often at even fractions. */
static const double IN_CELL[2] = {0.5477225575, 0.4142135624};

/* A place where a line goes into a solid, or leaves it. */
typedef struct meeting {
    double at;
    uint32_t line, solid;
    int step; /* of the winding number behind it */
} meeting;

typedef struct line_grid {
    int axis, u, v;
    double low[2], cell;
    size_t nu, nv;
    meeting *meetings;
    size_t count, capacity;
} line_grid;

static int compare_meetings(const void *x, const void *y)
{
    const meeting *a = x, *b = y;
    if (a->at != b->at)
        return a->at < b->at ? -1 : 1;
    if (a->solid != b->solid)
        return a->solid < b->solid ? -1 : 1;
    return a->step - b->step;
}

/* Sorts meetings by line, and those of a line by place. starts: lines + 1, zeroed
 * Returns false when memory is out. */
static bool sort_meetings(line_grid *g, size_t *starts)
{
    meeting *sorted = cwi_alloc_array(g->count, sizeof *sorted);
    const size_t lines = g->nu * g->nv;
    if (!sorted)
        return false;
    for (size_t n = 0; n < g->count; n++)
        starts[g->meetings[n].line + 1]++;
    for (size_t n = 0; n < lines; n++)
        starts[n + 1] += starts[n];
    for (size_t n = 0; n < g->count; n++)
        sorted[starts[g->meetings[n].line]++] = g->meetings[n];
    for (size_t n = lines; n > 0; n--)
        starts[n] = starts[n - 1];
    starts[0] = 0;
    for (size_t n = 0; n < lines; n++)
        if (starts[n + 1] > starts[n] + 1)
            qsort(sorted + starts[n], starts[n + 1] - starts[n], sizeof *sorted,
                  compare_meetings);
    cwi_free(g->meetings);
    g->meetings = sorted;
    return true;
}

/* Returns the number of the first line at or behind a coordinate. */
static size_t first_line(const line_grid *g, int k, double x, size_t count)
{
    const double n = ceil((x - g->low[k]) / g->cell - IN_CELL[k]);
    return n <= 0 ? 0 : n >= (double)count ? count : (size_t)n;
}

static double line_at(const line_grid *g, int k, size_t n)
{
    return g->low[k] + g->cell * ((double)n + IN_CELL[k]);
}

/* Returns which side of an edge a point is on; the same, but for the sign, for both triangles of the edge. */
static double edge_side(const float *a, const float *b, const double p[2], int u, int v)
{
    const bool is_swapped = memcmp(a, b, 3 * sizeof *a) > 0;
    const float *from = is_swapped ? b : a, *to = is_swapped ? a : b;
    const double side = ((double)to[u] - (double)from[u]) * (p[1] - (double)from[v]) -
                        ((double)to[v] - (double)from[v]) * (p[0] - (double)from[u]);
    return is_swapped ? -side : side;
}

static bool add_meeting(line_grid *g, const float *p[3], const double at[2], uint32_t line,
                        uint32_t solid)
{
    double w[3];
    for (int k = 0; k < 3; k++)
        w[k] = edge_side(p[(k + 1) % 3], p[(k + 2) % 3], at, g->u, g->v);
    const bool is_up = w[0] > 0 && w[1] > 0 && w[2] > 0;
    if (!is_up && !(w[0] < 0 && w[1] < 0 && w[2] < 0))
        return true;
    if (g->count == g->capacity) {
        const size_t capacity = 2 * g->capacity + 4096;
        meeting *grown = cwi_realloc_array(g->meetings, capacity, sizeof *grown);
        if (!grown)
            return false;
        g->meetings = grown;
        g->capacity = capacity;
    }
    double height = 0;
    for (int k = 0; k < 3; k++)
        height += w[k] / (w[0] + w[1] + w[2]) * (double)p[k][g->axis];
    g->meetings[g->count++] = (meeting){height, line, solid, is_up ? -1 : 1};
    return true;
}

static bool add_solid(line_grid *g, const cw_mesh *m, uint32_t solid)
{
    for (size_t t = 0; t < m->triangle_count; t++) {
        const float *p[3];
        double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
        for (size_t k = 0; k < 3; k++) {
            p[k] = m->positions + 3 * (size_t)m->triangles[3 * t + k];
            const double x[2] = {(double)p[k][g->u], (double)p[k][g->v]};
            for (int a = 0; a < 2; a++) {
                low[a] = cwi_lesser(low[a], x[a]);
                high[a] = cwi_greater(high[a], x[a]);
            }
        }
        const size_t end_u = first_line(g, 0, high[0], g->nu),
                     end_v = first_line(g, 1, high[1], g->nv);
        for (size_t j = first_line(g, 1, low[1], g->nv); j < end_v; j++)
            for (size_t i = first_line(g, 0, low[0], g->nu); i < end_u; i++) {
                const double at[2] = {line_at(g, 0, i), line_at(g, 1, j)};
                if (!add_meeting(g, p, at, (uint32_t)(j * g->nu + i), solid))
                    return false;
            }
    }
    return true;
}

/* Sums up along one line. winding: of each solid, 0 before and after */
static void sum_line(const meeting *list, size_t count, int *winding, double weight,
                     cw_assembled *f)
{
    size_t pieces = 0;
    for (size_t n = 0; n < count; n++) {
        int *w = &winding[list[n].solid];
        const bool was_inside = *w > 0;
        *w += list[n].step;
        if (list[n].solid)
            pieces = pieces + (*w > 0) - was_inside;
        if (n + 1 == count)
            break;
        const double volume = (list[n + 1].at - list[n].at) * weight;
        const bool in_whole = winding[0] > 0;
        f->whole_mm3 += in_whole ? volume : 0;
        f->assembled_mm3 += pieces ? volume : 0;
        f->overlap_mm3 += pieces > 1 ? volume * (double)(pieces - 1) : 0;
        f->missing_mm3 += in_whole && !pieces ? volume : 0;
        f->beyond_mm3 += pieces && !in_whole ? volume : 0;
    }
    f->lines++;
    for (size_t n = 0; n < count; n++)
        winding[list[n].solid] = 0;
}

cw_status cwi_measure_lines(const cw_mesh *meshes, size_t count, int axis, cw_assembled *facts,
                            cw_error *err)
{
    line_grid g = {.axis = axis, .u = (axis + 1) % 3, .v = (axis + 2) % 3};
    double low[3], high[3];
    cwi_box_clear(low, high);
    for (size_t n = 0; n < count; n++)
        cwi_box_add_points(low, high, meshes[n].positions, meshes[n].vertex_count);
    const double size[2] = {high[g.u] - low[g.u], high[g.v] - low[g.v]};
    g.cell = cwi_greater(size[0], size[1]) / LINES;
    g.low[0] = low[g.u];
    g.low[1] = low[g.v];
    g.nu = (size_t)ceil(size[0] / g.cell);
    g.nv = (size_t)ceil(size[1] / g.cell);
    int *winding = cwi_alloc_zeroed(count, sizeof *winding);
    bool is_done = winding;
    for (size_t n = 0; n < count && is_done; n++)
        is_done = add_solid(&g, &meshes[n], (uint32_t)n);
    size_t *starts = is_done ? cwi_alloc_zeroed(g.nu * g.nv + 1, sizeof *starts) : NULL;
    is_done = starts && sort_meetings(&g, starts);
    for (size_t n = 0; n < g.nu * g.nv && is_done; n++)
        if (starts[n + 1] > starts[n])
            sum_line(g.meetings + starts[n], starts[n + 1] - starts[n], winding,
                     g.cell * g.cell / 3, facts);
    cwi_free(starts);
    cwi_free(winding);
    cwi_free(g.meetings);
    return is_done ? CW_OK : cwi_fail_memory(err);
}
