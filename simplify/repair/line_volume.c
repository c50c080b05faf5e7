/* Lines along x, y and z through a mesh: each is inside between the crossings at which it enters and leaves. A line
 * through a hole, or through a triangle inside out, leaves another number of times than it enters, and is left out. */
#include "simplify/repair/line_volume.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/triangle.h"
#include "core/geometry/vec3.h"
#include "core/mesh/corner_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Lines along each axis, in rows and columns. */
enum { SIDE = 48 };

/* Where lines are in their cells: away from edges that follow a grid or its diagonals. */
static const double OFFSET[2] = {0.38, 0.71};

/* The error of a line's number by rounding. */
static const double SLACK = 1e-6;

typedef struct plane_point {
    double x, y;
} plane_point;

/* A triangle seen along an axis. */
typedef struct projected {
    plane_point p[3];
    double depth[3];
} projected;

static double find_place(double low, double high, int n, int k)
{
    return low + (high - low) * (n + OFFSET[k]) / SIDE;
}

/* Returns on which side of an edge a point is, the same from both triangles at it. */
static double side_of(plane_point a, plane_point b, plane_point p)
{
    const bool turned = a.x != b.x ? a.x > b.x : a.y > b.y;
    const plane_point from = turned ? b : a, to = turned ? a : b;
    double side = (to.x - from.x) * (p.y - from.y) - (to.y - from.y) * (p.x - from.x);
    if (side == 0)
        side = 0x1p-1000;
    return turned ? -side : side;
}

static bool add_crossing(cwi_line_crossings *out, cwi_line_crossing row)
{
    cwi_line_crossing *rows =
        cwi_grow_array(out->rows, out->count, &out->capacity, sizeof *rows);
    if (!rows)
        return false;
    out->rows = rows;
    rows[out->count++] = row;
    return true;
}

/* Finds the first and last line between two places, among columns (k = 0) or rows (k = 1). */
static void find_lines(double from, double to, int k, double low, double high, int range[2])
{
    const double step = (high - low) / SIDE;
    range[0] = (int)ceil(cwi_greater((from - low) / step - OFFSET[k] - SLACK, 0));
    range[1] = (int)floor(cwi_lesser((to - low) / step - OFFSET[k] + SLACK, SIDE - 1));
}

/* Finds the first and last line that may meet a triangle. */
static void find_range(const projected *t, int k, double low, double high, int range[2])
{
    const double x[3] = {k ? t->p[0].y : t->p[0].x, k ? t->p[1].y : t->p[1].x,
                         k ? t->p[2].y : t->p[2].x};
    find_lines(cwi_lesser(cwi_lesser(x[0], x[1]), x[2]),
               cwi_greater(cwi_greater(x[0], x[1]), x[2]), k, low, high, range);
}

/* Adds the crossings of lines along an axis with a triangle. */
static bool cross_triangle(cwi_line_crossings *out, const projected *t, int axis, bool is_patch)
{
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    int columns[2], rows[2];
    if (!(out->high[i] > out->low[i]) || !(out->high[j] > out->low[j]))
        return true;
    find_range(t, 0, out->low[i], out->high[i], columns);
    find_range(t, 1, out->low[j], out->high[j], rows);
    for (int r = rows[0]; r <= rows[1]; r++)
        for (int c = columns[0]; c <= columns[1]; c++) {
            const plane_point p = {find_place(out->low[i], out->high[i], c, 0),
                                   find_place(out->low[j], out->high[j], r, 1)};
            const double side[3] = {side_of(t->p[0], t->p[1], p), side_of(t->p[1], t->p[2], p),
                                    side_of(t->p[2], t->p[0], p)};
            const bool left = side[0] > 0;
            if ((side[1] > 0) != left || (side[2] > 0) != left)
                continue;
            const double sum = side[0] + side[1] + side[2];
            const double at =
                (side[1] * t->depth[0] + side[2] * t->depth[1] + side[0] * t->depth[2]) / sum;
            /* a triangle that faces along the axis is where lines leave */
            if (!add_crossing(out, (cwi_line_crossing){(uint32_t)((axis * SIDE + r) * SIDE + c),
                                                       left ? -1 : 1, is_patch, at}))
                return false;
        }
    return true;
}

static int compare_crossings(const void *x, const void *y)
{
    const cwi_line_crossing *p = x, *q = y;
    if (p->line != q->line)
        return p->line < q->line ? -1 : 1;
    if (p->at != q->at)
        return p->at < q->at ? -1 : 1;
    return q->sign - p->sign;
}

cw_status cwi_find_line_crossings(const cw_mesh *mesh, const uint32_t *sources,
                                  const double low[3], const double high[3],
                                  cwi_line_crossings *out, cw_error *err)
{
    *out = (cwi_line_crossings){0};
    memcpy(out->low, low, sizeof out->low);
    memcpy(out->high, high, sizeof out->high);
    bool ok = true;
    for (size_t n = 0; n < mesh->triangle_count && ok; n++)
        for (int axis = 0; axis < 3 && ok; axis++) {
            projected t;
            for (int k = 0; k < 3; k++) {
                const float *p =
                    mesh->positions + 3 * (size_t)mesh->triangles[3 * n + (size_t)k];
                t.p[k] = (plane_point){(double)p[(axis + 1) % 3], (double)p[(axis + 2) % 3]};
                t.depth[k] = (double)p[axis];
            }
            ok = cross_triangle(out, &t, axis, sources && sources[n] == UINT32_MAX);
        }
    if (!ok)
        return cwi_fail_memory(err);
    if (out->count)
        qsort(out->rows, out->count, sizeof *out->rows, compare_crossings);
    return CW_OK;
}

/* Returns the distance of a point from the segment between two others. */
static double measure_distance(plane_point a, plane_point b, plane_point p)
{
    const double x = b.x - a.x, y = b.y - a.y, length_sq = x * x + y * y;
    const double along = (p.x - a.x) * x + (p.y - a.y) * y;
    const double t = length_sq > 0 ? cwi_lesser(cwi_greater(along / length_sq, 0), 1) : 0;
    return hypot(a.x + t * x - p.x, a.y + t * y - p.y);
}

static bool hide_lines_at(cwi_line_crossings *out, const float *from, const float *to, int axis,
                          double reach_mm)
{
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    const plane_point a = {(double)from[i], (double)from[j]},
                      b = {(double)to[i], (double)to[j]};
    int columns[2], rows[2];
    if (!(out->high[i] > out->low[i]) || !(out->high[j] > out->low[j]))
        return true;
    find_lines(fmin(a.x, b.x) - reach_mm, fmax(a.x, b.x) + reach_mm, 0, out->low[i],
               out->high[i], columns);
    find_lines(fmin(a.y, b.y) - reach_mm, fmax(a.y, b.y) + reach_mm, 1, out->low[j],
               out->high[j], rows);
    for (int r = rows[0]; r <= rows[1]; r++)
        for (int c = columns[0]; c <= columns[1]; c++) {
            const plane_point p = {find_place(out->low[i], out->high[i], c, 0),
                                   find_place(out->low[j], out->high[j], r, 1)};
            const uint32_t line = (uint32_t)((axis * SIDE + r) * SIDE + c);
            if (measure_distance(a, b, p) <= reach_mm &&
                !add_crossing(out, (cwi_line_crossing){line, 0, true, 0}))
                return false;
        }
    return true;
}

cw_status cwi_hide_lines_at_borders(const cw_mesh *mesh, double reach_mm,
                                    cwi_line_crossings *out, cw_error *err)
{
    const size_t corners = 3 * mesh->triangle_count;
    cwi_side *sides = cwi_alloc_array(corners, sizeof *sides);
    bool ok = sides;
    if (sides)
        cwi_sides_list(mesh->triangles, corners, sides);
    for (size_t n = 0, along; n < corners && ok; n += along) {
        along = cwi_sides_along(sides, corners, n);
        const uint32_t *v = mesh->triangles, c = sides[n].corner;
        for (int axis = 0; axis < 3 && along == 1 && ok; axis++)
            ok = hide_lines_at(out, mesh->positions + 3 * (size_t)v[c],
                               mesh->positions + 3 * (size_t)v[cwi_corner_next(c)], axis,
                               reach_mm);
    }
    cwi_free(sides);
    if (!ok)
        return cwi_fail_memory(err);
    if (out->count)
        qsort(out->rows, out->count, sizeof *out->rows, compare_crossings);
    return CW_OK;
}

void cwi_line_crossings_free(cwi_line_crossings *crossings)
{
    cwi_free(crossings->rows);
    *crossings = (cwi_line_crossings){0};
}

/* The crossings of one line. */
typedef struct run {
    const cwi_line_crossing *rows;
    size_t count;
} run;

/* Returns true if a line tells what is inside. turned: the mesh is inside out */
static bool tells_inside(run r, int turned)
{
    int inside = 0;
    for (size_t n = 0; n < r.count; n++) {
        inside += turned * r.rows[n].sign;
        if (inside < 0 || r.rows[n].is_patch)
            return false;
    }
    return inside == 0;
}

/* Returns the lengths inside of the first, of the second, and of one of them alone.
 * by_turns  every other crossing enters the first, whatever its direction: a cavity may face the wrong way */
static void measure_line(run a, run b, int turned, bool by_turns, double length[3])
{
    int inside[2] = {0};
    double last = 0;
    size_t i = 0, j = 0;
    length[0] = length[1] = length[2] = 0;
    while (i < a.count || j < b.count) {
        const bool first = j == b.count || (i < a.count && a.rows[i].at <= b.rows[j].at);
        const double at = first ? a.rows[i].at : b.rows[j].at, step = at - last;
        length[0] += inside[0] > 0 ? step : 0;
        length[1] += inside[1] > 0 ? step : 0;
        length[2] += (inside[0] > 0) != (inside[1] > 0) ? step : 0;
        last = at;
        if (!first)
            inside[1] += b.rows[j++].sign;
        else if (by_turns)
            inside[0] = ++i % 2;
        else
            inside[0] += turned * a.rows[i++].sign;
    }
}

/* Returns the run of a line, and moves on behind it. */
static run next_run(const cwi_line_crossings *c, uint32_t line, size_t *at)
{
    const size_t first = *at;
    while (*at < c->count && c->rows[*at].line == line)
        ++*at;
    return (run){c->rows + first, *at - first};
}

void cwi_keep_outer_crossings(cwi_line_crossings *crossings)
{
    size_t at = 0, kept = 0;
    while (at < crossings->count) {
        const run r = next_run(crossings, crossings->rows[at].line, &at);
        cwi_line_crossing ends[2] = {r.rows[0], r.rows[0]};
        size_t count = 0;
        bool is_patch = false;
        for (size_t n = 0; n < r.count; n++) {
            is_patch = is_patch || r.rows[n].is_patch;
            if (r.rows[n].sign == 0)
                continue;
            ends[count > 0] = r.rows[n];
            count++;
        }
        ends[0].sign = 1;
        ends[1].sign = -1;
        ends[0].is_patch = ends[1].is_patch = is_patch || count % 2 > 0;
        crossings->rows[kept++] = ends[0];
        if (r.count > 1)
            crossings->rows[kept++] = ends[1];
    }
    crossings->count = kept;
}

/* Returns 1, or -1 if more lines tell what is inside when all triangles are turned. */
static int find_turn(const cwi_line_crossings *c)
{
    size_t at = 0, told[2] = {0};
    while (at < c->count) {
        const run r = next_run(c, c->rows[at].line, &at);
        told[0] += tells_inside(r, 1);
        told[1] += tells_inside(r, -1);
    }
    return told[1] > told[0] ? -1 : 1;
}

/* Returns the sum of a row, in which negative numbers are unknown: they are filled in evenly from those beside them.
 * -1: all are unknown */
static double sum_row(double *row)
{
    double sum = 0;
    int last = -1; /* that is known; nothing is inside beyond the ends */
    for (int n = 0; n <= SIDE; n++) {
        if (n < SIDE && row[n] < 0)
            continue;
        if (n == SIDE && last < 0)
            return -1;
        const double low = last < 0 ? 0 : row[last], high = n == SIDE ? 0 : row[n];
        sum += (low + high) / 2 * (n - last - 1) + high;
        last = n;
    }
    return sum;
}

/* Sets the volumes along the three axes. lengths: inside, of each line; negative where it does not tell */
static void find_volumes(double (*lengths)[SIDE], const cwi_line_crossings *c, double v[3])
{
    for (int axis = 0; axis < 3; axis++) {
        const int p = (axis + 1) % 3, q = (axis + 2) % 3;
        double sums[SIDE];
        for (int r = 0; r < SIDE; r++)
            sums[r] = sum_row(lengths[axis * SIDE + r]);
        v[axis] = (c->high[p] - c->low[p]) * (c->high[q] - c->low[q]) * fmax(sum_row(sums), 0) /
                  (SIDE * SIDE);
    }
}

/* Returns the axis whose volume is the median: lines through an open tube meet nothing. */
static int find_median(const double v[3])
{
    for (int a = 0; a < 2; a++) {
        const double low = fmin(v[(a + 1) % 3], v[(a + 2) % 3]),
                     high = fmax(v[(a + 1) % 3], v[(a + 2) % 3]);
        if (v[a] >= low && v[a] <= high)
            return a;
    }
    return 2;
}

/* Returns true if a crossing of the first is gone, and the second has a patch: what was there was replaced. Patches of
 * holes that were there before replace nothing. */
static bool is_replaced(run a, run b, double near_mm)
{
    for (size_t n = 0; n < a.count; n++) {
        bool is_kept = false;
        for (size_t k = 0; k < b.count && !is_kept; k++)
            is_kept = !b.rows[k].is_patch && fabs(b.rows[k].at - a.rows[n].at) <= near_mm;
        if (!is_kept)
            return true;
    }
    return false;
}

cwi_line_volumes cwi_compare_lines(const cwi_line_crossings *before,
                                   const cwi_line_crossings *after, double near_mm)
{
    cwi_line_volumes out = {0};
    const int turned = find_turn(before);
    double lengths[3 * SIDE][SIDE], lengths_after[3 * SIDE][SIDE], volumes[3], volumes_after[3];
    size_t i = 0, j = 0;
    for (uint32_t line = 0; line < 3 * SIDE * SIDE; line++) {
        const run a = next_run(before, line, &i), b = next_run(after, line, &j);
        double length[3], other[3];
        double *at = &lengths[line / SIDE][line % SIDE];
        *at = -1;
        measure_line((run){0}, b, 1, false, length);
        lengths_after[line / SIDE][line % SIDE] = length[1];
        if (!tells_inside(a, turned))
            continue;
        measure_line(a, b, turned, false, length);
        *at = length[0];
        if (!tells_inside(b, 1) && !is_replaced(a, b, near_mm))
            continue;
        measure_line(a, b, turned, true, other);
        const double *best = other[2] < length[2] ? other : length;
        out.lines += a.count > 0;
        out.inside_mm += best[0];
        out.changed_mm += best[2];
    }
    find_volumes(lengths, before, volumes);
    find_volumes(lengths_after, after, volumes_after);
    const int axis = find_median(volumes);
    out.volume_mm3 = volumes[axis];
    out.volume_after_mm3 = volumes_after[axis];
    return out;
}
