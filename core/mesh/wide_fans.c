/* Finds vertices with very many triangles, and bounds the directions in which triangles are seen. */
#include "core/mesh/wide_fans.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/mesh/surface_walk.h"

#include <string.h>

/* --- fans --------------------------------------------------------------------------------- */

typedef struct fan_search {
    size_t vertices, triangles;
    const uint32_t *corners;
    bool (*left_out)(const void *context, size_t triangle);
    const void *context;
    uint32_t *around; /* vertices: their triangles; then the fan of each */
} fan_search;

/* Returns the corner with most triangles; of equal ones the vertex with the smallest number. */
static uint32_t widest_corner(const fan_search *s, size_t triangle)
{
    const uint32_t *c = s->corners + 3 * triangle;
    uint32_t widest = c[0];
    for (int k = 1; k < 3; k++)
        if (s->around[c[k]] > s->around[widest] ||
            (s->around[c[k]] == s->around[widest] && c[k] < widest))
            widest = c[k];
    return widest;
}

/* Sets the hub of each triangle that has one; returns whether there is any. */
static bool choose_hubs(const fan_search *s, uint32_t *hub_of)
{
    bool any = false;
    for (size_t t = 0; t < s->triangles; t++) {
        const uint32_t hub = widest_corner(s, t);
        const bool wide =
            s->around[hub] > CWI_WIDE_FAN && !(s->left_out && s->left_out(s->context, t));
        hub_of[t] = wide ? hub : CWI_NO_FAN;
        any |= wide;
    }
    return any;
}

/* Numbers the hubs that have triangles, and puts numbers in place of hubs. */
static bool number_fans(fan_search *s, cwi_wide_fans *fans)
{
    for (size_t v = 0; v < s->vertices; v++)
        s->around[v] = 0;
    for (size_t t = 0; t < s->triangles; t++)
        if (fans->fan_of[t] != CWI_NO_FAN)
            s->around[fans->fan_of[t]]++;
    for (size_t v = 0; v < s->vertices; v++)
        fans->count += s->around[v] > 0;
    fans->hubs = cwi_alloc_array(fans->count, sizeof *fans->hubs);
    fans->first = cwi_alloc_zeroed(fans->count + 1, sizeof *fans->first);
    if (!fans->hubs || !fans->first)
        return false;
    size_t fan = 0;
    for (uint32_t v = 0; v < s->vertices; v++)
        if (s->around[v]) {
            fans->hubs[fan] = v;
            fans->first[fan + 1] = fans->first[fan] + s->around[v];
            s->around[v] = (uint32_t)fan++;
        }
    fans->triangles = cwi_alloc_array(fans->first[fans->count], sizeof *fans->triangles);
    size_t *next = cwi_alloc_array(fans->count, sizeof *next);
    const bool ok = fans->triangles && next;
    for (size_t f = 0; f < fans->count && ok; f++)
        next[f] = fans->first[f];
    for (uint32_t t = 0; t < s->triangles && ok; t++)
        if (fans->fan_of[t] != CWI_NO_FAN) {
            const uint32_t f = fans->fan_of[t] = s->around[fans->fan_of[t]];
            fans->triangles[next[f]++] = t;
        }
    cwi_free(next);
    return ok;
}

cw_status cwi_wide_fans_find(cwi_wide_fans *fans, size_t vertices, const uint32_t *corners,
                             size_t triangles,
                             bool (*left_out)(const void *context, size_t triangle),
                             const void *context, cw_error *err)
{
    *fans = (cwi_wide_fans){0};
    fan_search s = {vertices, triangles, corners, left_out, context, NULL};
    uint32_t widest = 0;
    s.around = cwi_alloc_zeroed(vertices, sizeof *s.around);
    if (!s.around)
        return cwi_fail_memory(err);
    for (size_t c = 0; c < 3 * triangles; c++) {
        const uint32_t around = ++s.around[corners[c]];
        widest = around > widest ? around : widest;
    }
    bool ok = true;
    if (widest > CWI_WIDE_FAN) {
        fans->fan_of = cwi_alloc_array(triangles, sizeof *fans->fan_of);
        ok = fans->fan_of && (!choose_hubs(&s, fans->fan_of) || number_fans(&s, fans));
    }
    cwi_free(s.around);
    return ok ? CW_OK : cwi_fail_memory(err);
}

void cwi_wide_fans_free(cwi_wide_fans *fans)
{
    cwi_free(fans->hubs);
    cwi_free(fans->first);
    cwi_free(fans->triangles);
    cwi_free(fans->fan_of);
    *fans = (cwi_wide_fans){0};
}

/* --- directions --------------------------------------------------------------------------- */

/* Rounding of the arithmetic, and of single precision. */
static const double DIRECTION_MARGIN = 4e-7;

/* Directions whose mean is shorter than this may go all around the point. */
static const double MIN_MEAN = 0.2;

static void take_all_directions(float box[6])
{
    for (int a = 0; a < 3; a++) {
        box[a] = -1;
        box[a + 3] = 1;
    }
}

/* Widens a box by the turning points of the shorter great arc between two unit vectors, if it passes
 * one: there a coordinate is largest or smallest on it. */
static void add_arc(double low[3], double high[3], const double u[3], const double v[3])
{
    double across[3]; /* the direction in which the arc leaves u */
    const double cosine = cwi_dot(u, v);
    for (int a = 0; a < 3; a++)
        across[a] = v[a] - cosine * u[a];
    const double sine = cwi_length(across);
    if (sine < 1e-12)
        return;
    for (int a = 0; a < 3; a++) {
        const double begin = across[a] / sine, end = cosine * begin - sine * u[a];
        if ((begin > 0) == (end > 0))
            continue;
        const double turning = hypot(u[a], begin);
        high[a] = begin > 0 ? fmax(high[a], turning) : high[a];
        low[a] = begin < 0 ? fmin(low[a], -turning) : low[a];
    }
}

/* Widens a box where an axis itself lies within three directions. Then it is no farther from one of
 * them than they are from each other. */
static void add_axes(double low[3], double high[3], double u[3][3])
{
    double sides[3][3], widest_sq = 0;
    for (int k = 0; k < 3; k++) {
        cwi_cross(u[k], u[(k + 1) % 3], sides[k]);
        widest_sq = fmax(widest_sq, cwi_distance_sq(u[k], u[(k + 1) % 3]));
    }
    const double turn = cwi_dot(sides[0], u[2]) < 0 ? -1 : 1,
                 near = widest_sq < 1 ? 1 - 0.5 * widest_sq - 1e-9 : -1;
    for (int a = 0; a < 3; a++) {
        bool ahead = u[0][a] > near, behind = u[0][a] < -near;
        for (int k = 0; k < 3; k++) {
            ahead &= turn * sides[k][a] >= -1e-12;
            behind &= turn * sides[k][a] <= 1e-12;
        }
        high[a] = ahead && u[0][a] + u[1][a] + u[2][a] > 0 ? 1 : high[a];
        low[a] = behind && u[0][a] + u[1][a] + u[2][a] < 0 ? -1 : low[a];
    }
}

/* A triangle seen from a point is the hull of three directions on the sphere:
 * coordinates are extreme at corners, at turning points of its sides, or at an axis inside. */
void cwi_direction_box(const float hub[3], const float *const corners[3], bool has_hub,
                       float box[6])
{
    double u[3][3], mean[3] = {0, 0, 0}, low[3] = {1, 1, 1}, high[3] = {-1, -1, -1};
    int count = 0;
    for (int k = 0; k < 3; k++) {
        cwi_sub_points(corners[k], hub, u[count]);
        const double length = cwi_length(u[count]);
        if (!(length > 0))
            continue;
        for (int a = 0; a < 3; a++) {
            u[count][a] /= length;
            mean[a] += u[count][a];
            low[a] = fmin(low[a], u[count][a]);
            high[a] = fmax(high[a], u[count][a]);
        }
        count++;
    }
    if (count < 3 - has_hub || cwi_length(mean) < MIN_MEAN * count) {
        take_all_directions(box);
        return;
    }
    for (int k = 0; k < count; k++)
        if (cwi_dot(u[k], mean) < MIN_MEAN * MIN_MEAN) {
            take_all_directions(box);
            return;
        }
    for (int k = 1; k < count; k++)
        for (int n = 0; n < k; n++)
            add_arc(low, high, u[n], u[k]);
    if (count == 3)
        add_axes(low, high, u);
    for (int a = 0; a < 3; a++) {
        box[a] = (float)(low[a] - DIRECTION_MARGIN);
        box[a + 3] = (float)(high[a] + DIRECTION_MARGIN);
    }
}
