/* Rolls bodies on a plate: over the point, then over the edge that they stand on, to the next point, until the
 * centre of mass is above the hull of contacts. The centre sinks in each step, so it ends. */
#include "simplify/printing/rest_pose.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/box.h"
#include "core/geometry/vec3.h"
#include "simplify/printing/outline.h"

#include <math.h>
#include <string.h>

enum { MAX_ROLLS = 64, COLUMNS = 48, GRID = 64 };

/* Points count as touching the plate within this fraction of the body's size. */
static const double TOUCH = 1e-5;

cw_status cwi_rest_body_make(const cw_mesh *mesh, cwi_rest_body *body, cw_error *err)
{
    uint8_t *taken = cwi_alloc_zeroed(mesh->vertex_count, 1);
    body->points = cwi_alloc_array(mesh->vertex_count, sizeof *body->points);
    for (size_t c = 0; taken && body->points && c < 3 * mesh->triangle_count; c++) {
        const uint32_t v = mesh->triangles[c];
        if (taken[v])
            continue;
        taken[v] = 1;
        for (int a = 0; a < 3; a++)
            body->points[body->count][a] = (double)mesh->positions[3 * (size_t)v + (size_t)a];
        body->count++;
    }
    const bool ok = taken && body->points;
    cwi_free(taken);
    return ok ? CW_OK : cwi_fail_memory(err);
}

void cwi_rest_body_free(cwi_rest_body *body)
{
    cwi_free(body->points);
    *body = (cwi_rest_body){0};
}

/* Marks the first and the last point along an axis in each column. */
static void mark_ends(const cwi_rest_body *body, int axis, const double low[3],
                      const double high[3], size_t *ends, uint8_t *marks)
{
    const int u = (axis + 1) % 3, w = (axis + 2) % 3;
    for (size_t n = 0; n < (size_t)COLUMNS * COLUMNS * 2; n++)
        ends[n] = SIZE_MAX;
    for (size_t n = 0; n < body->count; n++) {
        const double *p = body->points[n];
        size_t cell[2];
        for (int k = 0; k < 2; k++) {
            const int a = k ? w : u;
            const double at = (p[a] - low[a]) / (high[a] - low[a]) * COLUMNS;
            cell[k] = at > 0 ? at < COLUMNS ? (size_t)at : COLUMNS - 1 : 0;
        }
        size_t *end = ends + 2 * (cell[1] * COLUMNS + cell[0]);
        if (end[0] == SIZE_MAX || p[axis] < body->points[end[0]][axis])
            end[0] = n;
        if (end[1] == SIZE_MAX || p[axis] > body->points[end[1]][axis])
            end[1] = n;
    }
    for (size_t n = 0; n < (size_t)COLUMNS * COLUMNS * 2; n++)
        if (ends[n] != SIZE_MAX)
            marks[ends[n]] = 1;
}

cw_status cwi_rest_body_thin(const cwi_rest_body *body, cwi_rest_body *few, cw_error *err)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    size_t *ends = cwi_alloc_array((size_t)COLUMNS * COLUMNS * 2, sizeof *ends);
    uint8_t *marks = cwi_alloc_zeroed(body->count, 1);
    few->points = cwi_alloc_array(body->count, sizeof *few->points);
    memcpy(few->center, body->center, sizeof few->center);
    const bool ok = ends && marks && few->points;
    for (size_t n = 0; ok && n < body->count; n++)
        for (int a = 0; a < 3; a++) {
            low[a] = cwi_lesser(low[a], body->points[n][a]);
            high[a] = cwi_greater(high[a], body->points[n][a]);
        }
    for (int axis = 0; ok && axis < 3; axis++)
        mark_ends(body, axis, low, high, ends, marks);
    for (size_t n = 0; ok && n < body->count; n++)
        if (marks[n])
            memcpy(few->points[few->count++], body->points[n], sizeof *few->points);
    cwi_free(ends);
    cwi_free(marks);
    return ok ? CW_OK : cwi_fail_memory(err);
}

/* --- inner points ------------------------------------------------------------------------- */

/* Cells that hold points, or have such a property: bit x of row y of slice z. */
typedef struct cell_bits {
    uint64_t rows[GRID][GRID];
} cell_bits;

static void find_cell(const double p[3], const double low[3], const double high[3],
                      size_t cell[3])
{
    for (int a = 0; a < 3; a++) {
        const double at = (p[a] - low[a]) / (high[a] - low[a]) * GRID;
        cell[a] = at > 0 ? at < GRID ? (size_t)at : GRID - 1 : 0;
    }
}

/* Sets the cells from which some set cell is ahead, or beside them, along all axes.
 * is_up  the direction along x, y and z */
static void spread_back(cell_bits *c, const bool is_up[3])
{
    for (int z = 0; z < GRID; z++)
        for (int y = 0; y < GRID; y++)
            for (int by = 1; by < GRID; by *= 2) {
                uint64_t *row = &c->rows[z][y];
                *row |= is_up[0] ? *row >> by : *row << by;
            }
    for (int z = 0; z < GRID; z++)
        for (int n = 1; n < GRID; n++) {
            const int y = is_up[1] ? GRID - 1 - n : n;
            c->rows[z][y] |= c->rows[z][is_up[1] ? y + 1 : y - 1];
        }
    for (int n = 1; n < GRID; n++) {
        const int z = is_up[2] ? GRID - 1 - n : n;
        for (int y = 0; y < GRID; y++)
            c->rows[z][y] |= c->rows[is_up[2] ? z + 1 : z - 1][y];
    }
}

/* Keeps cells that have a set cell two cells away, or more, along all axes. */
static void keep_two_behind(cell_bits *kept, const cell_bits *spread, const bool is_up[3])
{
    for (int z = 0; z < GRID; z++)
        for (int y = 0; y < GRID; y++) {
            const int y_ahead = is_up[1] ? y + 2 : y - 2, z_ahead = is_up[2] ? z + 2 : z - 2;
            const bool is_in = y_ahead >= 0 && y_ahead < GRID && z_ahead >= 0 && z_ahead < GRID;
            const uint64_t ahead = is_in ? spread->rows[z_ahead][y_ahead] : 0;
            kept->rows[z][y] &= is_up[0] ? ahead >> 2 : ahead << 2;
        }
}

/* Finds cells that are deep inside the convex hull of the points: whichever way one looks from there,
 * one of the eight octants leads that way, and has a point at least a cell away along each axis. */
static void find_inner_cells(const cell_bits *taken, cell_bits *spread, cell_bits *inner)
{
    memset(inner, 0xff, sizeof *inner);
    for (int octant = 0; octant < 8; octant++) {
        const bool is_up[3] = {octant & 1, octant & 2, octant & 4};
        *spread = *taken;
        spread_back(spread, is_up);
        keep_two_behind(inner, spread, is_up);
    }
}

cw_status cwi_rest_body_drop_inner(cwi_rest_body *body, double depth, cw_error *err)
{
    double low[3], high[3];
    size_t kept = 0;
    cwi_box_clear(low, high);
    for (size_t n = 0; n < body->count; n++)
        cwi_box_add(low, high, body->points[n]);
    const double touch = TOUCH * cwi_distance(low, high);
    for (int a = 0; a < 3; a++)
        if (!(high[a] - low[a] > 2 * GRID * cwi_greater(depth, touch)))
            return CW_OK;
    cell_bits *bits = cwi_alloc_zeroed(3, sizeof *bits);
    if (!bits)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < body->count; n++) {
        size_t cell[3];
        find_cell(body->points[n], low, high, cell);
        bits[0].rows[cell[2]][cell[1]] |= UINT64_C(1) << cell[0];
    }
    find_inner_cells(&bits[0], &bits[1], &bits[2]);
    for (size_t n = 0; n < body->count; n++) {
        size_t cell[3];
        find_cell(body->points[n], low, high, cell);
        if (!(bits[2].rows[cell[2]][cell[1]] >> cell[0] & 1))
            memcpy(body->points[kept++], body->points[n], sizeof *body->points);
    }
    body->count = kept;
    cwi_free(bits);
    return CW_OK;
}

/* --- rolling ------------------------------------------------------------------------------ */

typedef struct roll {
    const cwi_rest_body *body;
    double down[3], touch; /* touch: how near the plate points touch it */
    cwi_plan_point *points, *hull;
} roll;

static size_t find_lowest(const roll *r)
{
    size_t lowest = 0;
    double max = -INFINITY;
    for (size_t n = 0; n < r->body->count; n++) {
        const double at = cwi_dot(r->body->points[n], r->down);
        if (at > max) {
            max = at;
            lowest = n;
        }
    }
    return lowest;
}

/* Turns the body about an axis through a point on the plate, so that `side` sinks, until another point touches
 * the plate. The axis is perpendicular to down and side. */
static size_t tip_over(roll *r, const double at[3], const double axis[3], const double side[3],
                       bool is_edge)
{
    double best[2] = {0, 0}; /* ahead and depth, of the smallest angle between them */
    size_t hit = SIZE_MAX;
    for (size_t n = 0; n < r->body->count; n++) {
        double q[3];
        cwi_sub(r->body->points[n], at, q);
        const double depth = cwi_greater(-cwi_dot(q, r->down), 0), ahead = cwi_dot(q, side);
        if (hit != SIZE_MAX && ahead * best[1] <= depth * best[0])
            continue;
        const double along = is_edge ? 0 : cwi_dot(q, axis);
        if (depth * depth + ahead * ahead + along * along <= r->touch * r->touch ||
            (depth == 0 && ahead <= 0))
            continue; /* on the axis, or on the plate behind it */
        best[0] = ahead;
        best[1] = depth;
        hit = n;
    }
    if (hit == SIZE_MAX)
        return SIZE_MAX;
    for (int a = 0; a < 3; a++)
        r->down[a] = best[0] * r->down[a] + best[1] * side[a];
    cwi_to_unit(r->down);
    return hit;
}

/* Makes the part of a vector that is perpendicular to down and, if there is one, to an edge. Returns false if there
 * is none. */
static bool make_side(const roll *r, const double v[3], const double *edge, double side[3])
{
    memcpy(side, v, 3 * sizeof *side);
    cwi_add_scaled(side, -cwi_dot(side, r->down), r->down, side);
    if (edge)
        cwi_add_scaled(side, -cwi_dot(side, edge), edge, side);
    return cwi_length(side) > r->touch && cwi_to_unit(side);
}

static void make_any_side(const double down[3], const double *edge, double side[3])
{
    double other[3] = {0};
    other[fabs(down[0]) < 0.6 ? 0 : 1] = 1;
    cwi_cross(down, edge ? edge : other, side);
    cwi_to_unit(side);
}

/* Finds the edge of the contacts' hull beyond which the centre is. Returns false if it is inside: the body
 * rests. */
static bool find_edge(const roll *r, double at[3], double edge[3], double side[3])
{
    const cwi_rest_body *b = r->body;
    double x[3], y[3], bottom = -INFINITY, worst = 0;
    size_t count = 0;
    make_any_side(r->down, NULL, x);
    cwi_cross(r->down, x, y);
    for (size_t n = 0; n < b->count; n++)
        bottom = cwi_greater(bottom, cwi_dot(b->points[n], r->down));
    for (size_t n = 0; n < b->count; n++)
        if (bottom - cwi_dot(b->points[n], r->down) <= r->touch)
            r->points[count++] =
                (cwi_plan_point){cwi_dot(b->points[n], x), cwi_dot(b->points[n], y)};
    const cwi_plan_point c = {cwi_dot(b->center, x), cwi_dot(b->center, y)};
    const size_t corners = cwi_find_outline(r->points, count, r->hull);
    bool is_beyond = false;
    for (size_t n = 0; n < corners && corners > 2; n++) {
        const cwi_plan_point *p = &r->hull[n], *q = &r->hull[(n + 1) % corners];
        const double length = hypot(q->x - p->x, q->y - p->y);
        const double out =
            ((q->y - p->y) * (c.x - p->x) - (q->x - p->x) * (c.y - p->y)) / length;
        if (!(out > worst + r->touch))
            continue;
        worst = out;
        is_beyond = true;
        for (int a = 0; a < 3; a++) {
            edge[a] = ((q->x - p->x) * x[a] + (q->y - p->y) * y[a]) / length;
            side[a] = ((q->y - p->y) * x[a] - (q->x - p->x) * y[a]) / length;
            at[a] = p->x * x[a] + p->y * y[a] + bottom * r->down[a];
        }
    }
    return is_beyond;
}

/* Rolls to the first three points that touch. */
static bool begin_roll(roll *r)
{
    double side[3], axis[3], lever[3], at[3], edge[3];
    memcpy(at, r->body->points[find_lowest(r)], sizeof at);
    cwi_sub(r->body->center, at, lever);
    if (!make_side(r, lever, NULL, side))
        make_any_side(r->down, NULL, side);
    cwi_cross(r->down, side, axis);
    const size_t second = tip_over(r, at, axis, side, false);
    if (second == SIZE_MAX)
        return false;
    cwi_sub(r->body->points[second], at, edge);
    cwi_add_scaled(edge, -cwi_dot(edge, r->down), r->down, edge);
    if (!cwi_to_unit(edge))
        return false;
    if (!make_side(r, lever, edge, side))
        make_any_side(r->down, edge, side);
    return tip_over(r, at, edge, side, true) != SIZE_MAX;
}

bool cwi_roll_to_rest(const cwi_rest_body *body, double down[3])
{
    double low[3], high[3], at[3], edge[3], side[3];
    roll r = {.body = body,
              .points = cwi_alloc_array(body->count, sizeof *r.points),
              .hull = cwi_alloc_array(2 * body->count + 2, sizeof *r.hull)};
    const bool ok = r.points && r.hull;
    if (ok) {
        memcpy(r.down, down, sizeof r.down);
        for (int a = 0; a < 3; a++) {
            low[a] = INFINITY;
            high[a] = -INFINITY;
        }
        for (size_t n = 0; n < body->count; n++)
            for (int a = 0; a < 3; a++) {
                low[a] = cwi_lesser(low[a], body->points[n][a]);
                high[a] = cwi_greater(high[a], body->points[n][a]);
            }
        r.touch = TOUCH * cwi_distance(low, high);
        if (begin_roll(&r))
            for (int n = 0; n < MAX_ROLLS && find_edge(&r, at, edge, side); n++)
                if (tip_over(&r, at, edge, side, true) == SIZE_MAX)
                    break;
        memcpy(down, r.down, sizeof r.down);
    }
    cwi_free(r.points);
    cwi_free(r.hull);
    return ok;
}

void cwi_turn_down(const double down[3], double m[12])
{
    const double near = 1 - 1e-12;
    double v[3] = {-down[1], down[0], 0}; /* down x (0, 0, -1) */
    memset(m, 0, 12 * sizeof *m);
    for (int a = 0; a < 3; a++)
        if (fabs(down[a]) > near) { /* right angles are exact */
            const double sign = down[a] > 0 ? 1 : -1;
            const int other = a == 0 ? 1 : 0;
            m[4 * 2 + a] = -sign;
            m[4 * other + other] = 1;
            m[4 * (a == 2 ? 1 : a) + (a == 2 ? 1 : 2)] = a == 2 ? -sign : sign;
            return;
        }
    const double c = -down[2], k = 1 / (1 + c);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            m[4 * i + j] = (i == j ? c : 0) + k * v[i] * v[j];
    m[1] -= v[2];
    m[2] += v[1];
    m[4] += v[2];
    m[6] -= v[0];
    m[8] -= v[1];
    m[9] += v[0];
}
