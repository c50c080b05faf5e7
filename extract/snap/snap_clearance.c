/* Decides if the cone over a rim crosses itself, or the triangles around it.
 *
 * It compares shadows: projections along the rim's normal to one of the planes between the
 * axes. Where the shadows of the cone's triangles surround the new vertex once, the cone does
 * not cross itself. If moreover all near triangles face the same way, nothing can lie above or
 * below the cone, and nothing is in the way. That is the case on smooth surfaces.
 *
 * Otherwise every triangle near it is tested. Where a line along a side separates the shadows
 * of two triangles, a plane separates them. The rest, mostly above or below the cone, is
 * compared in space, triangle by triangle. */
#include "core/geometry/triangle.h"
#include "core/geometry/triangle_separation.h"
#include "core/geometry/vec3.h"
#include "extract/snap/snap_cluster.h"

#include <math.h>
#include <string.h>

/* Minimum distance of separate shadows, in voxels. The plane through the line may be slanted:
 * in space the distance is at least CWI_APART. */
#define MARGIN (2 * CWI_APART)

/* Minimum sine of an angle that is not zero. */
#define SLOPE (1.0 / 8192)

/* Minimum of twice the area of a triangle facing up, in square voxels. */
#define FLAT 1e-9

typedef struct point {
    double u, v;
} point;

typedef struct new_fan {
    const cwi_snapping *s;
    const cwi_cluster *c;
    const double *apex;     /* its shadow is the origin */
    double normal[3];       /* of length 1: shadows fall along it, seen from where it points */
    double low[4], high[4]; /* a box around it and the star, and some more: along the axes, and
                               along the normal */
    int up, axis[2];        /* along which axis, and on to which, they fall */
    double lean[2];
    point link[CWI_LINK]; /* shadows */
    bool flat;            /* shadows of its triangles do not cross */
    uint64_t known;       /* bit v % 64 is set for every vertex v of the rim */
} new_fan;

/* A corner of a triangle that may be in the way. */
typedef struct corner {
    const double *x;
    point shadow;
    int on; /* the rim's vertex that it is, or -1 */
} corner;

typedef struct obstacle {
    corner corner[3];
} obstacle;

/* ---- the shadow of the cone ------------------------------------------------------------- */

static const double *link_index(const new_fan *o, int n)
{
    return cwi_index(o->s, o->c->link[n]);
}

/* Finds the rim's normal: the sum of the normals of the triangles of any cone over it. */
static void find_normal(new_fan *o)
{
    double p[3], q[3], across[3], sum[3] = {0, 0, 0};
    for (int n = 0; n < o->c->link_count; n++) {
        for (int a = 0; a < 3; a++) {
            p[a] = link_index(o, n)[a] - o->apex[a];
            q[a] = link_index(o, cwi_link_next(o->c, n))[a] - o->apex[a];
        }
        cwi_cross(p, q, across);
        for (int a = 0; a < 3; a++)
            sum[a] += across[a];
    }
    const double length = cwi_length(sum);
    for (int a = 0; a < 3; a++)
        o->normal[a] = sum[a] / length;
}

static void choose_plane(new_fan *o)
{
    const double x = fabs(o->normal[0]), y = fabs(o->normal[1]), z = fabs(o->normal[2]);
    o->up = x > y ? x > z ? 0 : 2 : y > z ? 1 : 2;
    const int left = o->normal[o->up] < 0;
    for (int n = 0; n < 2; n++) {
        o->axis[n] = (o->up + 1 + (n ^ left)) % 3;
        o->lean[n] = o->normal[o->axis[n]] / o->normal[o->up];
    }
}

static point shadow_of(const new_fan *o, const double x[3])
{
    const double h = x[o->up] - o->apex[o->up];
    const int a = o->axis[0], b = o->axis[1];
    return (point){x[a] - o->apex[a] - o->lean[0] * h, x[b] - o->apex[b] - o->lean[1] * h};
}

/* Returns twice the area to the left of the way from the origin to p to q. */
static double area_of(point p, point q)
{
    return p.u * q.v - p.v * q.u;
}

/* Returns true if the shadows of the new triangles do not cross: each turns left around the
 * origin, and together they turn once. */
static bool surrounds_apex(const new_fan *o)
{
    int turns = 0;
    for (int n = 0; n < o->c->link_count; n++) {
        const point p = o->link[n], q = o->link[cwi_link_next(o->c, n)];
        const double sides = sqrt((p.u * p.u + p.v * p.v) * (q.u * q.u + q.v * q.v));
        if (!(area_of(p, q) > SLOPE * sides))
            return false;
        turns += p.v < 0 && q.v >= 0;
    }
    return turns == 1;
}

static double height_of(const new_fan *o, const double x[3])
{
    return o->normal[0] * (x[0] - o->apex[0]) + o->normal[1] * (x[1] - o->apex[1]) +
           o->normal[2] * (x[2] - o->apex[2]);
}

static void grow_box(new_fan *o, const double x[3])
{
    const double at[4] = {x[0], x[1], x[2], height_of(o, x)};
    for (int a = 0; a < 4; a++) {
        o->low[a] = cwi_lesser(at[a] - CWI_APART, o->low[a]);
        o->high[a] = cwi_greater(at[a] + CWI_APART, o->high[a]);
    }
}

static void make_cone(const cwi_snapping *s, const cwi_cluster *c, const double x[3],
                      new_fan *o)
{
    o->s = s;
    o->c = c;
    o->apex = x;
    find_normal(o);
    choose_plane(o);
    o->known = 0;
    for (int a = 0; a < 4; a++) {
        o->low[a] = INFINITY;
        o->high[a] = -INFINITY;
    }
    grow_box(o, x);
    for (int n = 0; n < c->count; n++)
        grow_box(o, cwi_index(s, c->member[n]));
    for (int n = 0; n < c->link_count; n++) {
        grow_box(o, link_index(o, n));
        o->link[n] = shadow_of(o, link_index(o, n));
        o->known |= UINT64_C(1) << c->link[n] % 64;
    }
    o->flat = surrounds_apex(o);
}

static bool is_outside_box(const new_fan *o, const double *const x[3])
{
    for (int a = 0; a < 3; a++)
        if (cwi_lesser(cwi_lesser(x[0][a], x[1][a]), x[2][a]) > o->high[a] ||
            cwi_greater(cwi_greater(x[0][a], x[1][a]), x[2][a]) < o->low[a])
            return true;
    const double p = height_of(o, x[0]), q = height_of(o, x[1]), r = height_of(o, x[2]);
    return cwi_lesser(cwi_lesser(p, q), r) > o->high[3] ||
           cwi_greater(cwi_greater(p, q), r) < o->low[3];
}

/* ---- one sheet -------------------------------------------------------------------------- */

/* Returns true if a triangle's shadow turns left. */
static bool faces_up(const new_fan *o, const double *const x[3])
{
    double across[3];
    cwi_triangle_normal(x[0], x[1], x[2], across);
    return cwi_dot(o->normal, across) > FLAT;
}

static void find_corners(const cwi_snapping *s, size_t triangle, const double *x[3])
{
    for (int n = 0; n < 3; n++)
        x[n] = cwi_index(s, s->mesh->triangles[3 * triangle + (size_t)n]);
}

/* Returns true if all triangles in the box face up. The star does, so it covers the shadow of
 * the rim once, as the cone does. Suppose that another triangle met the cone, other than in the
 * rim. Then a line upward would go through it and through the star, one after the other, both
 * times from inside to outside, for the surface did not cross itself. As the surface is closed,
 * the line would have come back in between, in the box, through a triangle that faces down. */
static bool is_one_sheet(const new_fan *o, const size_t *near_sample, int count)
{
    if (!o->flat || o->s->grid->live)
        return false;
    for (int n = 0; n < count; n++) {
        const double *x[3];
        find_corners(o->s, near_sample[n], x);
        if (!faces_up(o, x) && !is_outside_box(o, x))
            return false;
    }
    return true;
}

/* ---- lines between shadows -------------------------------------------------------------- */

/* Points beyond a line are to the right of it, and not close. */
typedef struct line {
    double u, v, offset;
} line;

static line line_along(point p, point q)
{
    const double u = q.u - p.u, v = q.v - p.v;
    return (line){v, -u, v * p.u - u * p.v + MARGIN * (fabs(u) + fabs(v))};
}

static bool is_beyond(const line *l, point p)
{
    return l->u * p.u + l->v * p.v > l->offset;
}

/* Returns, bit by bit, the new triangles that are beyond a side of an obstacle's shadow. Ends
 * of the side that are on the rim count as beyond for the triangles that share them. */
static uint64_t beyond_side(const new_fan *o, const corner *from, const corner *to)
{
    const line l = line_along(from->shadow, to->shadow);
    const int count = o->c->link_count;
    uint64_t beyond = 0;
    if (!is_beyond(&l, (point){0, 0}))
        return 0;
    for (int n = 0; n < count; n++)
        beyond |= (uint64_t)is_beyond(&l, o->link[n]) << n;
    beyond |= from->on < 0 ? 0 : UINT64_C(1) << from->on;
    beyond |= to->on < 0 ? 0 : UINT64_C(1) << to->on;
    return beyond & (beyond >> 1 | beyond << (count - 1));
}

/* Returns the new triangles that no side of an obstacle's shadow is known to separate from it.
 * It begins with the side that spans most as seen from the apex. */
static uint64_t not_beyond(const new_fan *o, const obstacle *t)
{
    const corner *c = t->corner;
    const double one = area_of(c[0].shadow, c[1].shadow),
                 two = area_of(c[1].shadow, c[2].shadow),
                 three = area_of(c[2].shadow, c[0].shadow);
    const int sign = one + two + three > 0 ? -1 : 1;
    const int first = sign * one > sign * two     ? sign * one > sign * three ? 0 : 2
                      : sign * two > sign * three ? 1
                                                  : 2;
    uint64_t left = ~UINT64_C(0) >> (64 - o->c->link_count);
    for (int n = first; n < first + 3 && left; n++) {
        const corner *from = &c[n % 3], *to = &c[(n + 1) % 3];
        left &= sign < 0 ? ~beyond_side(o, from, to) : ~beyond_side(o, to, from);
    }
    return left;
}

/* Returns true if an obstacle is beyond a line, except for its corners at the line's ends. */
static bool is_all_beyond(const line *l, const obstacle *t, int from, int to)
{
    for (int n = 0; n < 3; n++)
        if (t->corner[n].on != from && t->corner[n].on != to &&
            !is_beyond(l, t->corner[n].shadow))
            return false;
    return true;
}

/* Returns true if an obstacle is beyond a side of the new triangle from the rim's vertex n to
 * the next. */
static bool is_beyond_new(const new_fan *o, const obstacle *t, int n)
{
    const int next = cwi_link_next(o->c, n);
    const point apex = {0, 0}, p = o->link[n], q = o->link[next];
    const line outer = line_along(p, q), cells_before = line_along(apex, p),
               after = line_along(q, apex);
    return area_of(p, q) > 0 &&
           (is_all_beyond(&outer, t, n, next) || is_all_beyond(&cells_before, t, n, n) ||
            is_all_beyond(&after, t, next, next));
}

/* Returns the new triangles that are not known to be apart from the obstacle's shadow. */
static uint64_t in_the_way(const new_fan *o, const obstacle *t)
{
    uint64_t left = not_beyond(o, t);
    for (uint64_t some = left; some; some &= some - 1) {
        const int n = __builtin_ctzll(some);
        if (is_beyond_new(o, t, n))
            left &= ~(UINT64_C(1) << n);
    }
    return left;
}

/* ---- in space --------------------------------------------------------------------------- */

static bool boxes_are_apart(const cwi_triangle *s, const cwi_triangle *t)
{
    bool apart = false;
    for (int a = 0; a < 3; a++) {
        const double *const x[2] = {&s->p[0][a], &t->p[0][a]};
        double low[2], high[2];
        for (int n = 0; n < 2; n++) {
            low[n] = cwi_lesser(cwi_lesser(x[n][0], x[n][3]), x[n][6]);
            high[n] = cwi_greater(cwi_greater(x[n][0], x[n][3]), x[n][6]);
        }
        apart = apart || low[0] > high[1] + CWI_APART || low[1] > high[0] + CWI_APART;
    }
    return apart;
}

static cwi_triangle triangle_of(const double *p, const double *q, const double *r)
{
    cwi_triangle t;
    memcpy(t.p[0], p, sizeof t.p[0]);
    memcpy(t.p[1], q, sizeof t.p[1]);
    memcpy(t.p[2], r, sizeof t.p[2]);
    return t;
}

/* Returns true if no new triangles cross: neighbours share a side, others the new vertex. */
static bool is_clear_of_itself(const new_fan *o)
{
    const int count = o->c->link_count;
    for (int n = 1; n < count; n++)
        for (int m = 0; m < n; m++) {
            const bool after = n == m + 1, cells_before = m == 0 && n + 1 == count;
            const double *p = link_index(o, m), *q = link_index(o, cwi_link_next(o->c, m)),
                         *r = link_index(o, n), *t = link_index(o, cwi_link_next(o->c, n));
            const cwi_triangle one =
                after ? triangle_of(o->apex, q, p) : triangle_of(o->apex, p, q);
            const cwi_triangle two =
                cells_before ? triangle_of(o->apex, t, r) : triangle_of(o->apex, r, t);
            if (!cwi_triangles_apart(&one, &two, after || cells_before ? 2 : 1))
                return false;
        }
    return true;
}

/* Returns true if an obstacle is clear of the new triangle from the rim's vertex n on. */
static bool is_clear_of(const new_fan *o, const obstacle *t, int n)
{
    const int next = cwi_link_next(o->c, n);
    const double *p = link_index(o, n), *q = link_index(o, next);
    int first = -1, second = -1;
    for (int a = 0; a < 3; a++) {
        first = t->corner[a].on == n ? a : first;
        second = t->corner[a].on == next ? a : second;
    }
    const int at = first >= 0 ? first : second >= 0 ? second : 0;
    const double *x = t->corner[at].x, *y = t->corner[(at + 1) % 3].x,
                 *z = t->corner[(at + 2) % 3].x;
    cwi_triangle old = triangle_of(x, y, z);
    cwi_triangle new = first < 0 ? triangle_of(q, o->apex, p) : triangle_of(p, q, o->apex);
    if (boxes_are_apart(&old, &new))
        return true;
    if (first < 0 || second < 0)
        return cwi_triangles_apart(&new, &old, first >= 0 || second >= 0);
    old = triangle_of(p, q, t->corner[3 - first - second].x);
    return cwi_triangles_apart(&new, &old, 2);
}

/* ---- the whole -------------------------------------------------------------------------- */

static int find_on_link(const new_fan *o, uint32_t v)
{
    if (!(o->known >> v % 64 & 1))
        return -1;
    int n = o->c->link_count - 1;
    while (n >= 0 && o->c->link[n] != v)
        n--;
    return n;
}

static bool is_clear_of_all(const new_fan *o, size_t triangle)
{
    const double *x[3];
    obstacle t;
    find_corners(o->s, triangle, x);
    if (is_outside_box(o, x))
        return true;
    for (size_t n = 0; n < 3; n++) {
        const int on = find_on_link(o, o->s->mesh->triangles[3 * triangle + n]);
        t.corner[n] = (corner){x[n], shadow_of(o, x[n]), on};
    }
    for (uint64_t left = in_the_way(o, &t); left; left &= left - 1)
        if (!is_clear_of(o, &t, __builtin_ctzll(left)))
            return false;
    return true;
}

/* Triangles are listed in order, the star's too. */
bool cwi_fan_is_clear(const cwi_snapping *s, const cwi_cluster *c, const double x[3])
{
    size_t near_sample[CWI_NEARBY];
    new_fan o;
    make_cone(s, c, x, &o);
    const int count = cwi_find_triangles(s, c->at, 2, near_sample);
    if (is_one_sheet(&o, near_sample, count))
        return true;
    if (!o.flat && !is_clear_of_itself(&o))
        return false;
    for (int n = 0, own = 0; n < count; n++)
        if (own < c->fan_count && c->fan[own] == near_sample[n])
            own++;
        else if (!is_clear_of_all(&o, near_sample[n]))
            return false;
    return true;
}
