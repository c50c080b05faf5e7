/* Fills strokes: a field of distances on a grid, whose cells are cut to triangles where it is below zero. Cells that
 * share an edge share the point on it, so that the region is a manifold with a border. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "simplify/engrave/engrave_state.h"

#include <string.h>

/* Cells across a stroke. */
static const double CELLS = 6;

/* Maximum of the cells. */
static const double MAX_CELLS = 1 << 26;

/* Points of the border keep this fraction of a cell from the grid's points. */
static const double APART = 0.03;

typedef struct field_grid {
    size_t columns, rows; /* of points */
    double low[2], cell;
    float *field; /* points: distance to the strokes' outline, negative inside */
    uint32_t *
        point; /* points x 3: numbers in the region of the point, and of those on the edges to the next column and
                        row; UINT32_MAX: none yet */
} field_grid;

static double stroke_distance(const cwi_stroke *s, double x, double y)
{
    const double d[2] = {s->to[0] - s->from[0], s->to[1] - s->from[1]};
    const double p[2] = {x - s->from[0], y - s->from[1]};
    const double length_sq = d[0] * d[0] + d[1] * d[1];
    double t = length_sq > 0 ? (p[0] * d[0] + p[1] * d[1]) / length_sq : 0;
    t = cwi_lesser(cwi_greater(t, 0), 1);
    return hypot(p[0] - t * d[0], p[1] - t * d[1]);
}

/* Lowers the field around a stroke. */
static void draw_stroke(field_grid *g, const cwi_stroke *s, double radius)
{
    const double reach = radius + 2 * g->cell;
    size_t span[2][2];
    const size_t size[2] = {g->columns, g->rows};
    for (int a = 0; a < 2; a++) {
        const double low = floor((fmin(s->from[a], s->to[a]) - reach - g->low[a]) / g->cell);
        const double high = ceil((fmax(s->from[a], s->to[a]) + reach - g->low[a]) / g->cell);
        span[a][0] = (size_t)cwi_greater(low, 0);
        span[a][1] = (size_t)cwi_lesser(high + 1, (double)size[a]);
    }
    for (size_t row = span[1][0]; row < span[1][1]; row++)
        for (size_t column = span[0][0]; column < span[0][1]; column++) {
            const double x = g->low[0] + (double)column * g->cell;
            const double y = g->low[1] + (double)row * g->cell;
            float *at = &g->field[row * g->columns + column];
            *at = fminf(*at, (float)(stroke_distance(s, x, y) - radius));
        }
}

/* Returns the number of a point of the grid (kind 0), or of the border's point on its edge to the next column (1) or row
 * (2). UINT32_MAX when memory is out. */
static uint32_t find_point(field_grid *g, cwi_stroke_region *r, size_t node, int kind)
{
    uint32_t *number = &g->point[3 * node + (size_t)kind];
    if (*number != UINT32_MAX)
        return *number;
    void *grown =
        cwi_grow_array(r->points, r->point_count, &r->point_capacity, sizeof *r->points);
    if (!grown)
        return UINT32_MAX;
    r->points = grown;
    double p[2] = {(double)(node % g->columns), (double)(node / g->columns)};
    if (kind > 0) {
        const double from = (double)g->field[node];
        const double to = (double)g->field[node + (kind == 1 ? 1 : g->columns)];
        const double t = from / (from - to);
        p[kind - 1] += cwi_lesser(cwi_greater(t, APART), 1 - APART);
    }
    for (int a = 0; a < 2; a++)
        r->points[r->point_count][a] = g->low[a] + p[a] * g->cell;
    return *number = (uint32_t)r->point_count++;
}

/* Adds a convex polygon. is_cut: of its points, those on the border */
static bool add_polygon(cwi_stroke_region *r, const uint32_t *points, const bool *is_cut,
                        size_t count)
{
    for (size_t n = 0; n < count; n++) {
        const size_t next = (n + 1) % count;
        if (!is_cut[n] || !is_cut[next])
            continue;
        void *grown =
            cwi_grow_array(r->border, r->border_count, &r->border_capacity, sizeof *r->border);
        if (!grown)
            return false;
        r->border = grown;
        r->border[r->border_count][0] = points[n];
        r->border[r->border_count++][1] = points[next];
    }
    for (size_t n = 1; n + 1 < count; n++) {
        void *grown = cwi_grow_array(r->triangles, r->triangle_count, &r->triangle_capacity,
                                     sizeof *r->triangles);
        if (!grown)
            return false;
        r->triangles = grown;
        const uint32_t t[3] = {points[0], points[n], points[n + 1]};
        memcpy(r->triangles[r->triangle_count++], t, sizeof t);
    }
    return true;
}

/* Cuts a cell. Opposite corners that alone are inside stay apart. */
static bool cut_cell(field_grid *g, cwi_stroke_region *r, size_t node)
{
    const size_t corner[4] = {node, node + 1, node + 1 + g->columns, node + g->columns};
    const size_t edge[4] = {node, node + 1, node + g->columns, node};
    static const int kind[4] = {1, 2, 1, 2};
    bool inside[4], is_cut[8];
    uint32_t points[8];
    size_t count = 0;
    for (int c = 0; c < 4; c++)
        inside[c] = g->field[corner[c]] < 0;
    const bool is_apart =
        inside[0] == inside[2] && inside[1] == inside[3] && inside[0] != inside[1];
    for (int c = 0; c < 4; c++) {
        const int next = (c + 1) % 4, before = (c + 3) % 4;
        if (is_apart) {
            const uint32_t t[3] = {inside[c] ? find_point(g, r, edge[before], kind[before]) : 0,
                                   inside[c] ? find_point(g, r, corner[c], 0) : 0,
                                   inside[c] ? find_point(g, r, edge[c], kind[c]) : 0};
            if (inside[c] && (t[0] == UINT32_MAX || t[1] == UINT32_MAX || t[2] == UINT32_MAX ||
                              !add_polygon(r, t, (const bool[3]){true, false, true}, 3)))
                return false;
            continue;
        }
        if (inside[c]) {
            is_cut[count] = false;
            points[count++] = find_point(g, r, corner[c], 0);
        }
        if (inside[c] != inside[next]) {
            is_cut[count] = true;
            points[count++] = find_point(g, r, edge[c], kind[c]);
        }
    }
    for (size_t n = 0; n < count; n++)
        if (points[n] == UINT32_MAX)
            return false;
    return count == 0 || add_polygon(r, points, is_cut, count);
}

/* Makes the grid around the text, and its field. */
static cw_status draw_field(field_grid *g, const cwi_text_lines *l, double unit, double stroke,
                            cw_error *err)
{
    const double size[2] = {unit * l->width + stroke, unit * l->height + stroke};
    g->cell = stroke / CELLS;
    const double columns = ceil(size[0] / g->cell) + 5, rows = ceil(size[1] / g->cell) + 5;
    if (!(columns * rows < MAX_CELLS))
        return cwi_fail(err, CW_ERR_LIMIT,
                        "strokes of %.3g mm are too fine for a text of %.3g x %.3g mm", stroke,
                        size[0], size[1]);
    g->columns = (size_t)columns;
    g->rows = (size_t)rows;
    g->low[0] = -g->cell * (columns - 1) / 2;
    g->low[1] = -g->cell * (rows - 1) / 2;
    const size_t count = g->columns * g->rows;
    g->field = cwi_alloc_array(count, sizeof *g->field);
    g->point = cwi_alloc_array(3 * count, sizeof *g->point);
    if (!g->field || !g->point)
        return cwi_fail_memory(err);
    memset(g->point, 0xff, 3 * count * sizeof *g->point);
    for (size_t n = 0; n < count; n++)
        g->field[n] = (float)stroke;
    for (size_t n = 0; n < l->count; n++) {
        cwi_stroke s = l->strokes[n];
        for (int a = 0; a < 2; a++) {
            s.from[a] *= unit;
            s.to[a] *= unit;
        }
        draw_stroke(g, &s, stroke / 2);
    }
    return CW_OK;
}

cw_status cwi_fill_strokes(const cwi_text_lines *l, double unit, double stroke_mm,
                           cwi_stroke_region *r, cw_error *err)
{
    field_grid g = {0};
    *r = (cwi_stroke_region){0};
    cw_status st = draw_field(&g, l, unit, stroke_mm, err);
    r->cell = g.cell;
    for (size_t row = 0; row + 1 < g.rows && st == CW_OK; row++)
        for (size_t column = 0; column + 1 < g.columns && st == CW_OK; column++)
            if (!cut_cell(&g, r, row * g.columns + column))
                st = cwi_fail_memory(err);
    cwi_free(g.field);
    cwi_free(g.point);
    return st;
}

void cwi_free_stroke_region(cwi_stroke_region *r)
{
    cwi_free(r->points);
    cwi_free(r->triangles);
    cwi_free(r->border);
    *r = (cwi_stroke_region){0};
}
