/* Measures how far a collapse takes the interfaces from the input, in each patch by itself.
 * Bounds hold for whole triangles [Tang2009]. */
#include "simplify/interfaces/label_samples.h"

#include "core/geometry/point_triangle.h"
#include "core/geometry/triangle_cover.h"

#include <string.h>

/* The part of the error that is allowed at each tightening level. */
static const double ALLOWED_FRACTIONS[CWI_LABEL_MAX_TIGHTENING + 1] = {1, 0.75, 0.4, 0};

/* The part of the squared error at which no nearer triangle is looked for. */
#define NEAR_ENOUGH (1.0 / 16)

/* The most triangles beside a ring that are looked at. */
enum { MAX_FACETS = 1024 };

/* A triangle that may be near the input's, and its box. */
typedef struct near_facet {
    const float *corners[3];
    uint32_t patch;
    float low[3], high[3];
} near_facet;

/* ---- samples ---------------------------------------------------------------------------- */

/* Collects the samples of a triangle. moved: its number in the ring; CWI_NO_INDEX: it goes */
static void collect_samples(cwi_label_samples *s, uint32_t triangle, uint32_t moved)
{
    for (uint32_t n = s->heads[triangle]; n != CWI_NO_INDEX; n = s->next[n]) {
        s->collected[s->collected_count++] = n;
        s->sample_marks[n] = s->mark;
        s->nearest[n] = moved;
    }
}

/* Returns the distance that is allowed at all samples of a ring; 0: it must not change. */
static double find_allowed(const cwi_label_samples *s)
{
    uint8_t level = 0;
    for (size_t n = 0; n < s->collected_count; n++) {
        const uint8_t other_level = s->tighten_levels[s->collected[n]];
        level = other_level > level ? other_level : level;
    }
    return s->error * ALLOWED_FRACTIONS[level];
}

static const float *get_original(const cwi_label_samples *s, uint32_t vertex)
{
    return s->originals + 3 * (size_t)vertex;
}

static void widen_point(const float *from, double p[3])
{
    for (int k = 0; k < 3; k++)
        p[k] = (double)from[k];
}

static double measure_triangle(const cwi_complex *c, const cwi_collapse_ring *ring, size_t n,
                               const double p[3])
{
    const cwi_moved_triangle *moved = &ring->triangles[n];
    return cwi_facet_distance_sq(ring->move.position, c->points + 3 * (size_t)moved->a,
                                 c->points + 3 * (size_t)moved->b, p);
}

/* Finds the ring triangle nearest to a sample. One that it had before stays if it is near enough. */
static double find_nearest_moved(cwi_label_samples *s, const cwi_complex *c,
                                 const cwi_collapse_ring *ring, uint32_t sample,
                                 double near_enough)
{
    const uint32_t before = s->nearest[sample];
    double p[3], min_sq = INFINITY;
    widen_point(get_original(s, s->vertices[sample]), p);
    if (before != CWI_NO_INDEX)
        min_sq = measure_triangle(c, ring, before, p);
    if (min_sq <= near_enough)
        return min_sq;
    for (size_t i = 0; i < ring->triangle_count; i++) {
        if (ring->triangles[i].patch != s->patches[sample] || i == before)
            continue;
        const double distance = measure_triangle(c, ring, i, p);
        if (distance < min_sq) {
            min_sq = distance;
            s->nearest[sample] = (uint32_t)i;
        }
    }
    return min_sq;
}

/* Finds the ring triangles near all samples. Returns false if one is too far. */
static bool find_nearest_moveds(cwi_label_samples *s, const cwi_complex *c,
                                const cwi_collapse_ring *ring, double distance_sq)
{
    for (size_t n = 0; n < s->collected_count; n++)
        if (!(find_nearest_moved(s, c, ring, s->collected[n], NEAR_ENOUGH * distance_sq) <=
              distance_sq))
            return false;
    return true;
}

/* ---- from the ring to the input --------------------------------------------------------- */

/* A walk over the input's triangles of a patch, to the one nearest to a point. */
typedef struct input_walk {
    cwi_label_samples *s;
    uint32_t patch, at;
    double distance_sq; /* distances up to its root are near enough */
} input_walk;

static void find_input_facet(const cwi_label_samples *s, uint32_t triangle,
                             const float *facet[3])
{
    for (size_t k = 0; k < 3; k++)
        facet[k] = get_original(s, s->corners[3 * (size_t)triangle + k]);
}

static double measure_input(const cwi_label_samples *s, uint32_t triangle, const double p[3])
{
    const float *facet[3];
    find_input_facet(s, triangle, facet);
    return cwi_facet_distance_sq(facet[0], facet[1], facet[2], p);
}

/* Goes to a triangle if it is nearer than the least distance so far. */
static bool go_if_nearer(input_walk *w, uint32_t triangle, const double p[3], double *min_sq)
{
    const double distance_sq = measure_input(w->s, triangle, p);
    if (!(distance_sq < *min_sq))
        return false;
    *min_sq = distance_sq;
    w->at = triangle;
    return true;
}

/* Goes over the side of a triangle to its neighbour in the patch if that is nearer. */
static bool cross_side(input_walk *w, uint32_t a, uint32_t b, const double p[3], double *min_sq)
{
    const cwi_label_samples *s = w->s;
    const uint32_t sample = cwi_label_samples_find(s, a, w->patch);
    for (uint32_t i = s->first_triangle[sample]; i < s->first_triangle[sample + 1]; i++) {
        const uint32_t t = s->triangles[i], *v = s->corners + 3 * (size_t)t;
        if (t != w->at && (v[0] == b || v[1] == b || v[2] == b))
            return go_if_nearer(w, t, p, min_sq);
    }
    return false;
}

/* Goes over a side that the point is beyond. Returns false if that does not help. */
static bool step_nearer(input_walk *w, const double p[3], double *min_sq)
{
    const uint32_t *v = w->s->corners + 3 * (size_t)w->at;
    const float *f[3];
    find_input_facet(w->s, w->at, f);
    const cwi_facet_view view = cwi_facet_look(f[0], f[1], f[2], p);
    return (view.in_a < 0 && cross_side(w, v[1], v[2], p, min_sq)) ||
           (view.in_b < 0 && cross_side(w, v[2], v[0], p, min_sq)) ||
           (view.in_c < 0 && cross_side(w, v[0], v[1], p, min_sq));
}

/* Goes to the nearest of the triangles around the corners. Returns false if none is nearer. */
static bool jump_nearer(input_walk *w, const double p[3], double *min_sq)
{
    const cwi_label_samples *s = w->s;
    const uint32_t start = w->at;
    for (size_t k = 0; k < 3; k++) {
        const uint32_t sample =
            cwi_label_samples_find(s, s->corners[3 * (size_t)start + k], w->patch);
        for (uint32_t i = s->first_triangle[sample]; i < s->first_triangle[sample + 1]; i++)
            go_if_nearer(w, s->triangles[i], p, min_sq);
    }
    return w->at != start;
}

/* Walks over sides as long as that helps. Where the end is too far, folds may hide a nearer
 * triangle, and those around corners are looked at, too. */
static double walk_nearest(void *context, const double p[3], const float *facet[3])
{
    input_walk *w = context;
    cwi_label_samples *s = w->s;
    double min_sq = measure_input(s, w->at, p);
    do {
        while (step_nearer(w, p, &min_sq)) {
        }
    } while (min_sq > w->distance_sq && jump_nearer(w, p, &min_sq));
    if (s->triangle_marks[w->at] != s->mark) {
        s->triangle_marks[w->at] = s->mark;
        s->met[s->met_count++] = w->at;
    }
    find_input_facet(s, w->at, facet);
    return min_sq;
}

/* Returns a triangle around the sample of a patch that is nearest to a point. */
static uint32_t find_start(const cwi_label_samples *s, uint32_t patch, const double p[3])
{
    uint32_t start = CWI_NO_INDEX;
    double min_sq = INFINITY;
    for (size_t n = 0; n < s->collected_count; n++) {
        const uint32_t sample = s->collected[n];
        double q[3];
        if (s->patches[sample] != patch)
            continue;
        widen_point(get_original(s, s->vertices[sample]), q);
        for (int k = 0; k < 3; k++)
            q[k] -= p[k];
        const double distance_sq = cwi_dot(q, q);
        if (distance_sq < min_sq) {
            min_sq = distance_sq;
            start = s->triangles[s->first_triangle[sample]];
        }
    }
    return start;
}

/* Returns true if all points of the new triangles are near the input. */
static bool is_star_near(cwi_label_samples *s, const cwi_complex *c,
                         const cwi_collapse_ring *ring, double distance_sq)
{
    input_walk walk = {.s = s, .patch = CWI_NO_INDEX, .distance_sq = distance_sq};
    cwi_cover cover = {.nearest = walk_nearest, .context = &walk, .distance_sq = distance_sq};
    double p[3][3];
    widen_point(ring->move.position, p[0]);
    for (size_t i = 0; i < ring->triangle_count; i++) {
        const cwi_moved_triangle *moved = &ring->triangles[i];
        if (moved->patch != walk.patch) {
            walk.patch = moved->patch;
            walk.at = find_start(s, walk.patch, p[0]);
            if (walk.at == CWI_NO_INDEX)
                return false;
        }
        widen_point(c->points + 3 * (size_t)moved->a, p[1]);
        widen_point(c->points + 3 * (size_t)moved->b, p[2]);
        if (!cwi_is_covered(&cover, (const double(*)[3])p))
            return false;
    }
    return true;
}

/* ---- from the input to the ring --------------------------------------------------------- */

/* The triangles of the ring and around it. */
typedef struct facet_list {
    size_t count;
    uint32_t patch; /* that is looked for */
    near_facet items[MAX_FACETS];
} facet_list;

static void add_facet(facet_list *list, const float *p, const float *a, const float *b,
                      uint32_t patch)
{
    if (list->count == MAX_FACETS)
        return;
    near_facet *f = &list->items[list->count++];
    *f = (near_facet){{p, a, b}, patch, {0}, {0}};
    for (int k = 0; k < 3; k++) {
        f->low[k] = fminf(p[k], fminf(a[k], b[k]));
        f->high[k] = fmaxf(p[k], fmaxf(a[k], b[k]));
    }
}

/* Computes the square of a point's distance from a facet's box. */
static double measure_box(const near_facet *f, const double p[3])
{
    double distance_sq = 0;
    for (int k = 0; k < 3; k++) {
        const double below = (double)f->low[k] - p[k], above = p[k] - (double)f->high[k];
        const double d = cwi_greater(cwi_greater(below, above), 0);
        distance_sq += d * d;
    }
    return distance_sq;
}

static bool has_ring_triangle(const cwi_collapse_ring *ring, uint32_t triangle)
{
    for (size_t i = 0; i < ring->triangle_count; i++)
        if (ring->triangles[i].triangle == triangle)
            return true;
    for (size_t i = 0; i < ring->gone_count; i++)
        if (ring->gone[i] == triangle)
            return true;
    return false;
}

/* Lists the ring's new triangles, and those around its outer vertices, of which some come
 * twice. */
static void list_facets(facet_list *list, const cwi_complex *c, const cwi_collapse_ring *ring)
{
    list->count = 0;
    for (size_t i = 0; i < ring->triangle_count; i++) {
        const cwi_moved_triangle *s = &ring->triangles[i];
        add_facet(list, ring->move.position, c->points + 3 * (size_t)s->a,
                  c->points + 3 * (size_t)s->b, s->patch);
    }
    for (size_t i = 0; i < ring->triangle_count; i++)
        for (uint32_t at = c->heads[ring->triangles[i].a]; at != CWI_NO_INDEX;
             at = c->next[at]) {
            const uint32_t *v = c->corners + 3 * (size_t)(at / 3);
            if (!has_ring_triangle(ring, at / 3))
                add_facet(list, c->points + 3 * (size_t)v[0], c->points + 3 * (size_t)v[1],
                          c->points + 3 * (size_t)v[2], c->patches[at / 3]);
        }
}

static double list_nearest(void *context, const double p[3], const float *facet[3])
{
    const facet_list *list = context;
    double min_sq = INFINITY;
    for (size_t n = 0; n < list->count; n++) {
        const near_facet *f = &list->items[n];
        if (f->patch != list->patch || measure_box(f, p) >= min_sq)
            continue;
        const double distance_sq =
            cwi_facet_distance_sq(f->corners[0], f->corners[1], f->corners[2], p);
        if (distance_sq < min_sq) {
            min_sq = distance_sq;
            memcpy(facet, f->corners, sizeof f->corners);
        }
    }
    return min_sq;
}

/* Returns true if one ring triangle is near all corners of a triangle of the input: one that is nearest
 * to a corner. */
static bool has_near_moved(const cwi_label_samples *s, const cwi_complex *c,
                           const cwi_collapse_ring *ring, const uint32_t v[3], uint32_t patch,
                           const double p[3][3], double distance_sq)
{
    for (int n = 0; n < 3; n++) {
        const uint32_t sample = cwi_label_samples_find(s, v[n], patch);
        if (s->sample_marks[sample] != s->mark)
            continue;
        const uint32_t moved = s->nearest[sample];
        if (measure_triangle(c, ring, moved, p[(n + 1) % 3]) <= distance_sq &&
            measure_triangle(c, ring, moved, p[(n + 2) % 3]) <= distance_sq)
            return true;
    }
    return false;
}

static void meet_around(cwi_label_samples *s)
{
    for (size_t n = 0; n < s->collected_count; n++) {
        const uint32_t sample = s->collected[n];
        for (uint32_t i = s->first_triangle[sample]; i < s->first_triangle[sample + 1]; i++) {
            const uint32_t t = s->triangles[i];
            if (s->triangle_marks[t] != s->mark) {
                s->triangle_marks[t] = s->mark;
                s->met[s->met_count++] = t;
            }
        }
    }
}

/* Returns true if the input's triangles around samples of the ring, and those that the ring lies
 * over, are near it or what is beside it. */
static bool is_input_near(cwi_label_samples *s, const cwi_complex *c,
                          const cwi_collapse_ring *ring, double distance_sq)
{
    facet_list list;
    list.count = 0;
    cwi_cover cover = {.nearest = list_nearest, .context = &list, .distance_sq = distance_sq};
    meet_around(s);
    for (size_t n = 0; n < s->met_count; n++) {
        const uint32_t *v = s->corners + 3 * (size_t)s->met[n];
        const uint32_t patch = c->patches[s->met[n]];
        double p[3][3];
        for (int k = 0; k < 3; k++)
            widen_point(get_original(s, v[k]), p[k]);
        if (has_near_moved(s, c, ring, v, patch, (const double(*)[3])p, distance_sq))
            continue;
        if (list.count == 0)
            list_facets(&list, c, ring);
        list.patch = patch;
        if (!cwi_is_covered(&cover, (const double(*)[3])p))
            return false;
    }
    return true;
}

bool cwi_label_samples_allow(cwi_label_samples *s, const cwi_complex *c,
                             const cwi_collapse_ring *ring)
{
    s->collected_count = s->met_count = 0;
    s->mark++;
    for (size_t i = 0; i < ring->triangle_count; i++)
        collect_samples(s, ring->triangles[i].triangle, (uint32_t)i);
    for (size_t i = 0; i < ring->gone_count; i++)
        collect_samples(s, ring->gone[i], CWI_NO_INDEX);
    const double allowed = find_allowed(s), distance_sq = allowed * allowed;
    return allowed > 0 && find_nearest_moveds(s, c, ring, distance_sq) &&
           is_star_near(s, c, ring, distance_sq) && is_input_near(s, c, ring, distance_sq);
}
