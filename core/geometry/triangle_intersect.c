/* Tests pairs of triangles by signs of determinants [Guigue2003]; neighbours are treated
 * separately. */
#include "core/geometry/triangle_intersect.h"

#include "core/geometry/exact_predicates.h"

bool cwi_has_area(const float *points, const uint32_t v[3])
{
    const float *a = points + 3 * (size_t)v[0], *b = points + 3 * (size_t)v[1],
                *c = points + 3 * (size_t)v[2];
    for (int axis = 0; axis < 3; axis++)
        if (cwi_sure_orient2d(a, b, c, axis))
            return true;
    return cwi_seen_along(a, b, c) >= 0;
}

/* A triangle by its corners. */
typedef struct corners {
    const float *p[3];
} corners;

/* Tests a closed segment and a closed triangle in one plane, seen along the axis. They are
 * apart if the line of one of their edges has all of the other on its far side. */
static bool segment_meets_flat(const float *p, const float *q, const corners *t, int axis)
{
    const int turn = cwi_orient2d(t->p[0], t->p[1], t->p[2], axis);
    for (int n = 0; n < 3; n++) {
        const float *r = t->p[n], *s = t->p[(n + 1) % 3];
        if (cwi_orient2d(r, s, p, axis) == -turn && cwi_orient2d(r, s, q, axis) == -turn)
            return false;
    }
    const int first = cwi_orient2d(p, q, t->p[0], axis);
    return !first || cwi_orient2d(p, q, t->p[1], axis) != first ||
           cwi_orient2d(p, q, t->p[2], axis) != first;
}

static int find_side(const corners *t, const float *p)
{
    return cwi_orient3d(t->p[0], t->p[1], t->p[2], p);
}

/* Returns true if the closed segment meets the closed triangle; sp and sq are the sides of its
 * ends. */
static bool segment_meets(const float *p, const float *q, int sp, int sq, const corners *t)
{
    if (sp * sq > 0)
        return false;
    if (!sp && !sq)
        return segment_meets_flat(p, q, t, cwi_seen_along(t->p[0], t->p[1], t->p[2]));
    const int s0 = cwi_orient3d(p, q, t->p[0], t->p[1]);
    const int s1 = cwi_orient3d(p, q, t->p[1], t->p[2]);
    if (s0 * s1 < 0)
        return false;
    const int s2 = cwi_orient3d(p, q, t->p[2], t->p[0]);
    return s0 * s2 >= 0 && s1 * s2 >= 0;
}

static void find_sides(const corners *t, const corners *of, int s[3])
{
    for (int n = 0; n < 3; n++)
        s[n] = find_side(t, of->p[n]);
}

static bool are_apart(const int s[3])
{
    return s[0] * s[1] > 0 && s[0] * s[2] > 0;
}

static bool strangers_meet(const corners *a, const corners *b)
{
    int sa[3], sb[3];
    find_sides(b, a, sa);
    if (are_apart(sa))
        return false;
    find_sides(a, b, sb);
    if (are_apart(sb))
        return false;
    for (int n = 0; n < 3; n++) {
        const int m = (n + 1) % 3;
        if (segment_meets(a->p[n], a->p[m], sa[n], sa[m], b) ||
            segment_meets(b->p[n], b->p[m], sb[n], sb[m], a))
            return true;
    }
    return false;
}

/* Tests triangles with corner 0 in common: they meet elsewhere only if the side across from it
 * does. */
static bool around_vertex_meet(const corners *a, const corners *b)
{
    const int a1 = find_side(b, a->p[1]), a2 = find_side(b, a->p[2]);
    if (a1 * a2 > 0)
        return false;
    if (segment_meets(a->p[1], a->p[2], a1, a2, b))
        return true;
    return segment_meets(b->p[1], b->p[2], find_side(a, b->p[1]), find_side(a, b->p[2]), a);
}

/* Tests triangles with the edge from corner 0 to 1 in common: they meet elsewhere only if
 * folded flat. */
static bool around_edge_meet(const corners *a, const corners *b)
{
    if (find_side(a, b->p[2]) != 0)
        return false;
    const int axis = cwi_seen_along(a->p[0], a->p[1], a->p[2]);
    return cwi_orient2d(a->p[0], a->p[1], a->p[2], axis) ==
           cwi_orient2d(a->p[0], a->p[1], b->p[2], axis);
}

/* Puts the common vertices first in both triangles, in the same order; returns their number. */
static int align_common_corners(const uint32_t a[3], const uint32_t b[3], uint32_t x[3],
                                uint32_t y[3])
{
    int shared = 0, last_a = 3, last_b = 3;
    bool taken[3] = {false};
    for (int i = 0; i < 3; i++) {
        int j = 0;
        while (j < 3 && (taken[j] || a[i] != b[j]))
            j++;
        if (j == 3) {
            x[--last_a] = a[i];
            continue;
        }
        taken[j] = true;
        x[shared] = y[shared] = a[i];
        shared++;
    }
    for (int j = 0; j < 3; j++)
        if (!taken[j])
            y[--last_b] = b[j];
    return shared;
}

bool cwi_triangles_meet(const float *points, const uint32_t a[3], const uint32_t b[3])
{
    uint32_t x[3], y[3];
    corners s, t;
    const int shared = align_common_corners(a, b, x, y);
    for (int n = 0; n < 3; n++) {
        s.p[n] = points + 3 * (size_t)x[n];
        t.p[n] = points + 3 * (size_t)y[n];
    }
    if (shared == 0)
        return strangers_meet(&s, &t);
    if (shared == 1)
        return around_vertex_meet(&s, &t);
    return shared == 3 || around_edge_meet(&s, &t);
}
