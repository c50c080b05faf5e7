/* Passes over all triangles: long edges are split, short ones collapsed, others flipped, and small
 * angles made larger. */
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "simplify/remesh/remesh_state.h"

/* Lengths, in units of the wanted one, beyond which edges are split, and below which they are
 * collapsed: 4/3 and 4/5 [Botsch2004] times 1.06, so that the mean length is the wanted one. */
static const double LONG = 1.06 * 4 / 3, SHORT = 1.06 * 4 / 5;

/* Collapses that remove a small angle may make edges this long. */
static const double LONGEST = 1.6;

enum { COLLAPSE_ROUNDS = 8, FLIP_ROUNDS = 3, ANGLE_ROUNDS = 12 };

/* Polls the progress once for this many triangles. */
enum { POLL = 1 << 14 };

/* Returns the corner before the longest or the shortest edge of a triangle, in units of the wanted
 * length, and that length. */
static uint32_t extreme_edge(const cwi_remesh *r, size_t t, bool longest, double *length)
{
    uint32_t best = (uint32_t)(3 * t);
    for (uint32_t k = 0; k < 3; k++) {
        const uint32_t c = (uint32_t)(3 * t + k);
        const double here =
            cwi_relative_length(r, r->triangles[c], r->triangles[cwi_corner_next(c)]);
        if (k == 0 || (longest ? here > *length : here < *length)) {
            *length = here;
            best = c;
        }
    }
    return best;
}

static cw_status poll_progress(const cwi_remesh *r, size_t t, cw_error *err)
{
    return t % POLL ? CW_OK : cwi_progress(&r->desc.progress, "remesh", r->done, err);
}

cw_status cwi_split_long(cwi_remesh *r, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t t = 0; t < r->triangle_count && st == CW_OK; t++) {
        st = poll_progress(r, t, err);
        bool is_done = !cwi_is_dead(r, t);
        while (is_done && st == CW_OK) {
            double length = 0;
            const uint32_t c = extreme_edge(r, t, true, &length);
            is_done = false;
            if (length > LONG)
                st = cwi_split_edge(r, c, &is_done, err);
        }
    }
    return st;
}

/* Collapses the edge of a corner to one of its ends; to the one that is less free first. */
static bool collapse_corner(cwi_remesh *r, uint32_t corner, double longest, double cosine)
{
    const uint32_t a = r->triangles[corner], b = r->triangles[cwi_corner_next(corner)];
    const bool to_b = r->freedom[b] >= r->freedom[a];
    return cwi_collapse_edge(r, to_b ? a : b, to_b ? b : a, longest, cosine) ||
           cwi_collapse_edge(r, to_b ? b : a, to_b ? a : b, longest, cosine);
}

cw_status cwi_collapse_short(cwi_remesh *r, cw_error *err)
{
    cw_status st = CW_OK;
    const size_t limit = r->triangle_count / 2000;
    size_t collapsed = limit + 1;
    for (int round = 0; round < COLLAPSE_ROUNDS && collapsed > limit && st == CW_OK; round++) {
        /* The shortest edges go first: early rounds take very short ones alone. */
        const double below = round == 0 ? SHORT / 4 : round == 1 ? SHORT / 2 : SHORT;
        collapsed = round < 2 ? limit + 1 : 0;
        for (size_t t = 0; t < r->triangle_count && st == CW_OK; t++) {
            double length = 0;
            st = poll_progress(r, t, err);
            if (cwi_is_dead(r, t))
                continue;
            const uint32_t c = extreme_edge(r, t, false, &length);
            if (length < below && collapse_corner(r, c, LONG, 2))
                collapsed++;
        }
    }
    return st;
}

static size_t flip_all(cwi_remesh *r, bool by_angle)
{
    size_t flipped = 0;
    for (uint32_t c = 0; c < 3 * r->triangle_count; c++)
        if (!cwi_is_dead(r, c / 3) && r->twin[c] != CWI_NONE && r->twin[c] > c)
            flipped += cwi_flip_edge(r, c, by_angle);
    return flipped;
}

void cwi_flip_edges(cwi_remesh *r, bool by_angle)
{
    for (int round = 0; round < FLIP_ROUNDS; round++)
        if (!flip_all(r, by_angle))
            return;
}

/* --- angles ------------------------------------------------------------------------------- */

static double cosine_of(const cwi_remesh *r, size_t t)
{
    const uint32_t *v = r->triangles + 3 * t;
    return cwi_largest_cosine(r->positions + 3 * (size_t)v[0], r->positions + 3 * (size_t)v[1],
                              r->positions + 3 * (size_t)v[2], NULL);
}

/* Returns the largest cosine around a vertex; 2 if there are too many triangles. */
static double cosine_around(const cwi_remesh *r, uint32_t v)
{
    uint32_t corners[CWI_MAX_ONE_RING];
    bool is_border;
    const size_t count = cwi_list_one_ring(r, v, corners, &is_border);
    double largest = count ? -1 : 2;
    for (size_t n = 0; n < count; n++)
        largest = cwi_greater(largest, cosine_of(r, corners[n] / 3));
    return largest;
}

/* Collapses an edge of a triangle where that makes the smallest angle around larger. */
static bool collapse_for_angle(cwi_remesh *r, size_t t)
{
    double length = 0;
    const uint32_t c = extreme_edge(r, t, false, &length);
    const double goal = cosine_of(r, t);
    if (collapse_corner(r, c, LONGEST, goal - 1e-3))
        return true;
    for (uint32_t k = 0; k < 3; k++)
        if (3 * t + k != c && collapse_corner(r, (uint32_t)(3 * t + k), LONGEST, goal - 1e-3))
            return true;
    return false;
}

static bool flip_for_angle(cwi_remesh *r, size_t t)
{
    for (uint32_t k = 0; k < 3; k++)
        if (cwi_flip_edge(r, (uint32_t)(3 * t + k), true))
            return true;
    return false;
}

/* Tries places for a vertex: ever smaller steps along its edges, projected to what it may move on. */
static bool move_for_angle(cwi_remesh *r, uint32_t v)
{
    uint32_t corners[CWI_MAX_ONE_RING];
    bool is_border, has_moved = false;
    if (r->freedom[v] == CWI_FIXED)
        return false;
    const size_t count = cwi_list_one_ring(r, v, corners, &is_border);
    const cwi_target *target = r->freedom[v] == CWI_FREE ? &r->surface : &r->curves;
    for (double step = 0.4; step > 0.05; step /= 2)
        for (size_t n = 0; n < 2 * count; n++) {
            const uint32_t c = corners[n / 2];
            const float *p = r->positions + 3 * (size_t)v,
                        *q = r->positions + 3 * (size_t)r->triangles[cwi_corner_next(c)];
            const double fraction = n % 2 ? -step : step;
            double from[3];
            float to[3], size = r->sizes[v];
            for (int k = 0; k < 3; k++)
                from[k] = (double)p[k] + fraction * ((double)q[k] - (double)p[k]);
            cwi_remesh_project(r, target, from, to,
                               target == &r->surface && r->target_sizes ? &size : NULL);
            has_moved |= cwi_move_vertex(r, v, to, size, cosine_around(r, v) - 1e-3);
        }
    return has_moved;
}

static bool improve_triangle(cwi_remesh *r, size_t t)
{
    if (flip_for_angle(r, t) || collapse_for_angle(r, t))
        return true;
    bool has_moved = false;
    for (size_t k = 0; k < 3; k++)
        has_moved |= move_for_angle(r, r->triangles[3 * t + k]);
    return has_moved;
}

/* Splits the longest edge of a triangle that nothing else helped, so that its vertex can move. */
static cw_status split_for_angle(cwi_remesh *r, size_t t, cw_error *err)
{
    double length = 0;
    bool is_done = false;
    const uint32_t c = extreme_edge(r, t, true, &length);
    return length > 1 ? cwi_split_edge(r, c, &is_done, err) : CW_OK;
}

cw_status cwi_improve_angles(cwi_remesh *r, cw_error *err)
{
    const double goal = cos(r->desc.min_angle_deg * CWI_PI / 180);
    cw_status st = CW_OK;
    bool has_changed = true;
    for (int round = 0; round < ANGLE_ROUNDS && has_changed && st == CW_OK; round++) {
        const size_t count = r->triangle_count;
        has_changed = false;
        for (size_t t = 0; t < count && st == CW_OK; t++) {
            st = poll_progress(r, t, err);
            if (st != CW_OK || cwi_is_dead(r, t) || !(cosine_of(r, t) > goal))
                continue;
            has_changed |= improve_triangle(r, t);
            if (round % 4 == 3 && round + 1 < ANGLE_ROUNDS && !cwi_is_dead(r, t) &&
                cosine_of(r, t) > goal) {
                st = split_for_angle(r, t, err);
                has_changed = true;
            }
        }
    }
    return st;
}
