/* Makes samples of label interfaces, and measures how far a collapse takes the surface from
 * them. Distances are measured in each patch by itself. */
#include "simplify/interfaces/label_samples.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/point_triangle.h"

#include <string.h>

/* ---- building --------------------------------------------------------------------------- */

/* Returns the next corner in a vertex's list, from `at` on, whose triangle is of a patch that no
 * corner before it is of. */
static uint32_t find_new_patch(const cwi_complex *c, uint32_t vertex, uint32_t at)
{
    for (; at != CWI_NO_INDEX; at = c->next[at]) {
        uint32_t before = c->heads[vertex];
        while (before != at && c->patches[before / 3] != c->patches[at / 3])
            before = c->next[before];
        if (before == at)
            return at;
    }
    return CWI_NO_INDEX;
}

static void count_samples(cwi_label_samples *s, const cwi_complex *c)
{
    for (size_t v = 0; v < c->vertex_count; v++) {
        s->first_sample[v] = (uint32_t)s->count;
        for (uint32_t at = find_new_patch(c, (uint32_t)v, c->heads[v]); at != CWI_NO_INDEX;
             at = find_new_patch(c, (uint32_t)v, c->next[at]))
            s->count++;
    }
    s->first_sample[c->vertex_count] = (uint32_t)s->count;
}

static void fill_samples(cwi_label_samples *s, const cwi_complex *c)
{
    size_t sample = 0, filled = 0;
    for (size_t v = 0; v < c->vertex_count; v++)
        for (uint32_t at = find_new_patch(c, (uint32_t)v, c->heads[v]); at != CWI_NO_INDEX;
             at = find_new_patch(c, (uint32_t)v, c->next[at])) {
            s->vertices[sample] = (uint32_t)v;
            s->patches[sample] = c->patches[at / 3];
            s->first_triangle[sample++] = (uint32_t)filled;
            for (uint32_t other = at; other != CWI_NO_INDEX; other = c->next[other])
                if (c->patches[other / 3] == c->patches[at / 3])
                    s->triangles[filled++] = other / 3;
        }
    s->first_triangle[sample] = (uint32_t)filled;
}

static bool alloc_samples(cwi_label_samples *s, const cwi_complex *c)
{
    s->vertices = cwi_alloc_array(s->count, sizeof *s->vertices);
    s->patches = cwi_alloc_array(s->count, sizeof *s->patches);
    s->first_triangle = cwi_alloc_array(s->count + 1, sizeof *s->first_triangle);
    s->triangles = cwi_alloc_array(3 * c->triangle_count, sizeof *s->triangles);
    s->cares = cwi_alloc_zeroed(s->count, sizeof *s->cares);
    s->next = cwi_alloc_array(s->count, sizeof *s->next);
    s->heads = cwi_alloc_array(c->triangle_count, sizeof *s->heads);
    s->collected = cwi_alloc_array(s->count, sizeof *s->collected);
    s->nearest = cwi_alloc_array(s->count, sizeof *s->nearest);
    s->originals = cwi_alloc_array(3 * c->vertex_count, sizeof *s->originals);
    return s->vertices && s->patches && s->first_triangle && s->triangles && s->cares &&
           s->next && s->heads && s->collected && s->nearest && s->originals;
}

cw_status cwi_label_samples_build(cwi_label_samples *s, const cwi_complex *c,
                                  const uint32_t *corners, double error, cw_error *err)
{
    memset(s, 0, sizeof *s);
    s->error = error;
    s->corners = corners;
    s->first_sample = cwi_alloc_array(c->vertex_count + 1, sizeof *s->first_sample);
    if (s->first_sample)
        count_samples(s, c);
    if (!s->first_sample || !alloc_samples(s, c))
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory to keep the error of %zu triangles",
                        c->triangle_count);
    memcpy(s->originals, c->points, 3 * c->vertex_count * sizeof *s->originals);
    fill_samples(s, c);
    return CW_OK;
}

void cwi_label_samples_free(cwi_label_samples *s)
{
    cwi_free(s->originals);
    cwi_free(s->first_sample);
    cwi_free(s->vertices);
    cwi_free(s->patches);
    cwi_free(s->first_triangle);
    cwi_free(s->triangles);
    cwi_free(s->cares);
    cwi_free(s->next);
    cwi_free(s->heads);
    cwi_free(s->collected);
    cwi_free(s->nearest);
    memset(s, 0, sizeof *s);
}

static void list_sample(cwi_label_samples *s, uint32_t sample, uint32_t triangle)
{
    s->next[sample] = s->heads[triangle];
    s->heads[triangle] = sample;
}

void cwi_label_samples_restart(cwi_label_samples *s, cwi_complex *c)
{
    memset(s->heads, 0xff, c->triangle_count * sizeof *s->heads);
    for (size_t n = 0; n < s->count; n++) {
        list_sample(s, (uint32_t)n, s->triangles[s->first_triangle[n]]);
        if (s->cares[n] >= CWI_LABEL_MAX_CARE)
            c->orders[s->vertices[n]] = CWI_ORDER_HELD;
    }
}

/* ---- measuring -------------------------------------------------------------------------- */

static void collect_samples(cwi_label_samples *s, uint32_t triangle)
{
    for (uint32_t n = s->heads[triangle]; n != CWI_NO_INDEX; n = s->next[n])
        s->collected[s->collected_count++] = n;
}

/* Returns the distance that is allowed at all samples of a star; 0: it must not change. */
static double find_allowed(const cwi_label_samples *s)
{
    uint8_t care = 0;
    for (size_t n = 0; n < s->collected_count; n++) {
        const uint8_t its_care = s->cares[s->collected[n]];
        care = its_care > care ? its_care : care;
    }
    return care < CWI_LABEL_MAX_CARE ? ldexp(s->error, -care) : 0;
}

static void get_original(const cwi_label_samples *s, uint32_t sample, double p[3])
{
    for (size_t k = 0; k < 3; k++)
        p[k] = (double)s->originals[3 * (size_t)s->vertices[sample] + k];
}

/* Finds the spoke nearest to each sample. Returns false if one is too far. */
static bool find_nearest_spokes(cwi_label_samples *s, const cwi_complex *c,
                                const cwi_star *star, double square)
{
    for (size_t n = 0; n < s->collected_count; n++) {
        const uint32_t sample = s->collected[n];
        double p[3], least = INFINITY;
        get_original(s, sample, p);
        for (size_t i = 0; i < star->spoke_count; i++) {
            const cwi_star_spoke *spoke = &star->spokes[i];
            if (spoke->patch != s->patches[sample])
                continue;
            const double distance =
                cwi_facet_square(star->move.place, c->points + 3 * (size_t)spoke->a,
                                 c->points + 3 * (size_t)spoke->b, p);
            if (distance < least) {
                least = distance;
                s->nearest[n] = (uint32_t)i;
            }
        }
        if (!(least <= square))
            return false;
    }
    return true;
}

/* Returns true if a point is near the input's triangles around the nearest sample of a patch.
 * Others may be nearer still. */
static bool is_near_input(const cwi_label_samples *s, uint32_t patch, const double p[3],
                          double square)
{
    uint32_t start = CWI_NO_INDEX;
    double least = INFINITY;
    for (size_t n = 0; n < s->collected_count; n++) {
        double q[3];
        if (s->patches[s->collected[n]] != patch)
            continue;
        get_original(s, s->collected[n], q);
        for (int k = 0; k < 3; k++)
            q[k] -= p[k];
        const double distance = cwi_dot(q, q);
        if (distance < least) {
            least = distance;
            start = s->collected[n];
        }
    }
    if (start == CWI_NO_INDEX)
        return false;
    for (uint32_t i = s->first_triangle[start]; i < s->first_triangle[start + 1]; i++) {
        const uint32_t *v = s->corners + 3 * (size_t)s->triangles[i];
        if (cwi_facet_square(s->originals + 3 * (size_t)v[0], s->originals + 3 * (size_t)v[1],
                             s->originals + 3 * (size_t)v[2], p) <= square)
            return true;
    }
    return false;
}

/* Returns true if the new vertex, and the middles of new sides and triangles, are near the
 * input. */
static bool is_star_near_input(const cwi_label_samples *s, const cwi_complex *c,
                               const cwi_star *star, double square)
{
    double place[3];
    for (int k = 0; k < 3; k++)
        place[k] = (double)star->move.place[k];
    for (size_t i = 0; i < star->spoke_count; i++) {
        const cwi_star_spoke *spoke = &star->spokes[i];
        double side[3], middle[3];
        for (size_t k = 0; k < 3; k++) {
            const double a = (double)c->points[3 * (size_t)spoke->a + k],
                         b = (double)c->points[3 * (size_t)spoke->b + k];
            side[k] = (place[k] + a) / 2;
            middle[k] = (place[k] + a + b) / 3;
        }
        const bool is_first = i == 0 || star->spokes[i - 1].patch != spoke->patch;
        if ((is_first && !is_near_input(s, spoke->patch, place, square)) ||
            !is_near_input(s, spoke->patch, side, square) ||
            !is_near_input(s, spoke->patch, middle, square))
            return false;
    }
    return true;
}

bool cwi_label_samples_allow(cwi_label_samples *s, const cwi_complex *c, const cwi_star *star)
{
    s->collected_count = 0;
    for (size_t i = 0; i < star->spoke_count; i++)
        collect_samples(s, star->spokes[i].triangle);
    for (size_t i = 0; i < star->gone_count; i++)
        collect_samples(s, star->gone[i]);
    const double allowed = find_allowed(s);
    return allowed > 0 && find_nearest_spokes(s, c, star, allowed * allowed) &&
           is_star_near_input(s, c, star, allowed * allowed);
}

void cwi_label_samples_move(cwi_label_samples *s, const cwi_star *star)
{
    for (size_t i = 0; i < star->spoke_count; i++)
        s->heads[star->spokes[i].triangle] = CWI_NO_INDEX;
    for (size_t i = 0; i < star->gone_count; i++)
        s->heads[star->gone[i]] = CWI_NO_INDEX;
    for (size_t n = 0; n < s->collected_count; n++)
        list_sample(s, s->collected[n], star->spokes[s->nearest[n]].triangle);
}
