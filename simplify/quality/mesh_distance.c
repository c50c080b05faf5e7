/* How far a mesh lies from another.
 *
 * The largest distance is bounded after [Tang2009]: the distance from one triangle R of the
 * reference is a convex function, so over a triangle T it is largest in a corner of T; and
 * whatever the distance from R is, the distance from the whole reference is not larger. The
 * same holds for the two parts into which a line cuts T, one with R and one with its neighbour.
 * It does not grow faster than the way gone either. A triangle is cut up along the sides of the
 * reference below it first; one that this does not clear is divided into four. */
#include <cubewright/distance.h>

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/box.h"
#include "core/geometry/bvh.h"
#include "core/geometry/point_triangle.h"
#include "core/geometry/triangle_cover.h"
#include "core/geometry/vec3.h"
#include "core/mesh/triangle_boxes.h"
#include "simplify/quality/mesh_within.h"
#include "simplify/quality/surface_sampling.h"

#include <math.h>
#include <string.h>

enum { CHUNK = 512, DEEPEST = 40 };

/* The corners of a triangle of the reference, relative to its origin. */
typedef struct facet {
    float a[3], b[3], c[3];
} facet;

typedef struct reference {
    cwi_boxes tree;
    facet *facets;   /* in the tree's order, which may name one more than once */
    double shift[3]; /* from the mesh's origin to the reference's */
    double diagonal, side;
} reference;

/* Point of a query and the nearest facet that it found. */
typedef struct query {
    const reference *r;
    double point[3];
    size_t slot; /* of the nearest facet found */
} query;

static double facet_distance_sq(const facet *f, const double p[3])
{
    return cwi_facet_distance_sq(f->a, f->b, f->c, p);
}

static void measure_facet(void *context, size_t slot, double *found_sq)
{
    query *q = context;
    const double s = facet_distance_sq(q->r->facets + slot, q->point);
    if (s < *found_sq) {
        *found_sq = s;
        q->slot = slot;
    }
}

/* The square of a distance from the whole reference, in its own frame; *hint is the slot of a
 * facet to begin with, then of the nearest. */
static double seek_nearest(const reference *r, const double p[3], uint32_t *hint)
{
    query q = {.r = r, .slot = *hint == UINT32_MAX ? r->tree.count / 2 : *hint};
    memcpy(q.point, p, sizeof q.point);
    double found_sq = facet_distance_sq(r->facets + q.slot, p);
    cwi_boxes_nearest(&r->tree, p, measure_facet, &q, &found_sq);
    *hint = (uint32_t)q.slot;
    return found_sq;
}

/* From the whole reference; *hint as in seek(). */
static double measure_point(const void *context, const double p[3], uint32_t *hint,
                            bool *missed)
{
    const reference *r = context;
    double x[3];
    cwi_sub(p, r->shift, x);
    *missed = false;
    return sqrt(seek_nearest(r, x, hint));
}

/* A point of the mesh, its distance, and the nearest facet. */
typedef struct corner {
    double p[3], distance;
    uint32_t slot;
} corner;

/* Largest distance and bound that a chunk of triangles adds. */
typedef struct extreme {
    double max, bound, where[3];
    size_t triangle;
} extreme;

typedef struct search {
    const reference *r;
    const cw_mesh *mesh;
    const uint32_t *slots;      /* of the facets nearest to vertices */
    double floor;               /* a distance in mm that is known to be met */
    double tolerance, fraction; /* allowed for bound - max: mm, and a fraction of max */
    extreme *extremes;          /* one a chunk */
} search;

/* Facets that points of a triangle are nearest to, and the corners' squared distances. */
typedef struct choice {
    int count;
    uint32_t slots[4];
    double distances_sq[4][3];
} choice;

static double distance_sq_from(const search *s, const double p[3], uint32_t slot)
{
    double x[3];
    cwi_sub(p, s->r->shift, x);
    return facet_distance_sq(s->r->facets + slot, x);
}

static void choose_triangles(const search *s, const corner c[3], uint32_t slot, choice *choices)
{
    const int n = choices->count;
    for (int k = 0; k < n; k++)
        if (choices->slots[k] == slot)
            return;
    choices->slots[n] = slot;
    for (int k = 0; k < 3; k++)
        choices->distances_sq[n][k] = distance_sq_from(s, c[k].p, slot);
    choices->count++;
}

/* Cuts the side from a, nearer to one facet, to b, nearer to the other, about where both are
 * equally near; returns the square that is certain for the cut point. */
static double cut_side(const search *s, const double a[3], const double b[3],
                       const uint32_t slots[2], double at_a, double at_b)
{
    double low = 0, high = 1, best = INFINITY;
    for (int n = 0; n < 4; n++) {
        const double fraction = at_a / (at_a - at_b), t = low + (high - low) * fraction;
        const double p[3] = {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]),
                             a[2] + t * (b[2] - a[2])};
        const double first = distance_sq_from(s, p, slots[0]),
                     second = distance_sq_from(s, p, slots[1]);
        best = cwi_lesser(best, cwi_greater(first, second));
        if (first < second) {
            low = t;
            at_a = first - second;
        } else {
            high = t;
            at_b = first - second;
        }
        if (!(at_a < 0 && at_b > 0))
            break;
    }
    return best;
}

/* A bound by two facets: the corners nearer to the first one are cut off from the others.
 * Infinite where it exceeds the limit: what was found by then is no bound. */
static double bound_by_two(const search *s, const corner c[3], const choice *h, int i, int j,
                           double limit)
{
    const uint32_t slots[2] = {h->slots[i], h->slots[j]};
    const double *first = h->distances_sq[i], *second = h->distances_sq[j];
    double found_sq = 0;
    for (int k = 0; k < 3; k++)
        found_sq = cwi_greater(found_sq, cwi_lesser(first[k], second[k]));
    for (int k = 0; k < 3 && found_sq <= limit * limit; k++) {
        const int a = first[k] < second[k] ? k : (k + 1) % 3, b = a == k ? (k + 1) % 3 : k;
        if (first[a] < second[a] && first[b] > second[b])
            found_sq =
                cwi_greater(found_sq, cut_side(s, c[a].p, c[b].p, slots, first[a] - second[a],
                                               first[b] - second[b]));
    }
    return found_sq <= limit * limit ? sqrt(found_sq) : INFINITY;
}

/* The least of the bounds by one or two of the chosen facets; what is below the limit
 * will do. */
static double bound_by(const search *s, const corner c[3], const choice *h, double limit)
{
    double bound = INFINITY;
    for (int i = 0; i < h->count; i++)
        bound = cwi_lesser(
            bound, sqrt(cwi_greater(cwi_greater(h->distances_sq[i][0], h->distances_sq[i][1]),
                                    h->distances_sq[i][2])));
    for (int i = 0; i < h->count; i++)
        for (int j = 0; j < i && bound > limit; j++)
            bound = cwi_lesser(bound, bound_by_two(s, c, h, i, j, limit));
    return bound;
}

/* No point of a triangle is farther than its corner by more than its sides are long. */
static double bound_by_way(const corner c[3])
{
    double bound = INFINITY;
    for (int n = 0; n < 3; n++) {
        const double side_length = cwi_greater(cwi_distance(c[n].p, c[(n + 1) % 3].p),
                                               cwi_distance(c[n].p, c[(n + 2) % 3].p));
        bound = cwi_lesser(bound, c[n].distance + side_length);
    }
    return bound;
}

static corner measure_at(const search *s, const double p[3], uint32_t hint, size_t t,
                         extreme *e)
{
    corner m = {.p = {p[0], p[1], p[2]}, .slot = hint};
    bool missed;
    m.distance = measure_point(s->r, m.p, &m.slot, &missed);
    if (m.distance > e->max) {
        e->max = m.distance;
        e->triangle = t;
        memcpy(e->where, m.p, sizeof m.p);
    }
    return m;
}

static corner middle_corner(const search *s, const corner *a, const corner *b, size_t t,
                            extreme *e)
{
    const double p[3] = {(a->p[0] + b->p[0]) / 2, (a->p[1] + b->p[1]) / 2,
                         (a->p[2] + b->p[2]) / 2};
    return measure_at(s, p, a->slot, t, e);
}

static double limit_of(const search *s, const extreme *e)
{
    return e->max + cwi_greater(s->tolerance, s->fraction * e->max);
}

/* Bounds the distance without dividing the triangle; looks at its middle if need be. */
static double bound_of(const search *s, const corner c[3], size_t t, extreme *e)
{
    choice choices = {0};
    double bound = bound_by_way(c), p[3];
    if (bound <= limit_of(s, e))
        return bound;
    for (int n = 0; n < 3; n++)
        choose_triangles(s, c, c[n].slot, &choices);
    bound = cwi_lesser(bound, bound_by(s, c, &choices, limit_of(s, e)));
    if (bound <= limit_of(s, e))
        return bound;
    cwi_triangle_centroid(c[0].p, c[1].p, c[2].p, p);
    choose_triangles(s, c, measure_at(s, p, c[0].slot, t, e).slot, &choices);
    return cwi_lesser(bound, bound_by(s, c, &choices, limit_of(s, e)));
}

static void search_triangle(const search *s, const corner c[3], size_t t, int depth, extreme *e)
{
    const double bound = bound_of(s, c, t, e);
    if (bound <= limit_of(s, e) || depth == DEEPEST) {
        e->bound = cwi_greater(e->bound, bound);
        return;
    }
    const corner ab = middle_corner(s, c, c + 1, t, e),
                 bc = middle_corner(s, c + 1, c + 2, t, e),
                 ca = middle_corner(s, c + 2, c, t, e);
    search_triangle(s, (corner[]){ab, bc, ca}, t, depth + 1, e);
    search_triangle(s, (corner[]){c[0], ab, ca}, t, depth + 1, e);
    search_triangle(s, (corner[]){ab, c[1], bc}, t, depth + 1, e);
    search_triangle(s, (corner[]){ca, bc, c[2]}, t, depth + 1, e);
}

/* Where facets of a reference are looked for: from the one found before. */
typedef struct covering {
    const reference *r;
    uint32_t slot;
} covering;

static double nearest_facet(void *context, const double p[3], const float *corners[3])
{
    covering *c = context;
    const double found_sq = seek_nearest(c->r, p, &c->slot);
    const facet *f = c->r->facets + c->slot;
    corners[0] = f->a;
    corners[1] = f->b;
    corners[2] = f->c;
    return found_sq;
}

static bool is_near_facet(const search *s, const corner c[3], uint32_t slot, double found_sq)
{
    return distance_sq_from(s, c[0].p, slot) <= found_sq &&
           distance_sq_from(s, c[1].p, slot) <= found_sq &&
           distance_sq_from(s, c[2].p, slot) <= found_sq;
}

static bool is_within(const search *s, const corner c[3], double limit)
{
    covering facets = {s->r, c[0].slot};
    cwi_cover cover = {
        .nearest = nearest_facet, .context = &facets, .distance_sq = limit * limit};
    double p[3][3];
    for (int n = 0; n < 3; n++) {
        if (c[n].distance > limit)
            return false;
        cwi_sub(c[n].p, s->r->shift, p[n]);
    }
    for (int n = 0; n < 3; n++)
        if (is_near_facet(s, c, c[n].slot, limit * limit))
            return true;
    return cwi_is_covered(&cover, (const double(*)[3])p);
}

static void begin_triangle(const search *s, size_t t, corner c[3])
{
    double p[3][3];
    cwi_mesh_corners(s->mesh, t, p);
    for (size_t n = 0; n < 3; n++) {
        const size_t v = s->mesh->triangles[3 * t + n];
        memcpy(c[n].p, p[n], sizeof c[n].p);
        c[n].slot = s->slots[v];
        c[n].distance = sqrt(distance_sq_from(s, p[n], c[n].slot));
    }
}

/* A chunk begins with the largest distance of all points measured before, and sees its own only
 * from there on: what others find meanwhile would make it depend on chance. */
static void search_chunk(void *context, size_t chunk)
{
    const search *s = context;
    extreme *e = s->extremes + chunk;
    *e = (extreme){.max = s->floor, .triangle = SIZE_MAX};
    for (size_t t = CHUNK * chunk; t < CHUNK * (chunk + 1) && t < s->mesh->triangle_count;
         t++) {
        corner c[3];
        begin_triangle(s, t, c);
        if (is_within(s, c, limit_of(s, e)))
            e->bound = cwi_greater(e->bound, limit_of(s, e));
        else
            search_triangle(s, c, t, 0, e);
    }
}

static void join_results(const search *s, size_t chunks, cw_distance *out)
{
    out->bound_mm = out->max_mm;
    for (size_t n = 0; n < chunks; n++) {
        const extreme *e = s->extremes + n;
        out->bound_mm = cwi_greater(out->bound_mm, cwi_greater(e->bound, e->max));
        if (e->max > out->max_mm) {
            out->max_mm = e->max;
            out->triangle = e->triangle;
            for (int k = 0; k < 3; k++)
                out->where[k] = s->mesh->origin[k] + e->where[k];
        }
    }
}

static cw_status find_bound(search *s, const cw_mesh_distance_desc *d, cw_distance *out,
                            cw_error *err)
{
    const size_t chunks = (s->mesh->triangle_count + CHUNK - 1) / CHUNK;
    s->extremes = cwi_alloc_array(chunks, sizeof *s->extremes);
    s->floor = out->max_mm;
    cw_status st = CW_OK;
    if (!s->extremes)
        st = cwi_fail_memory(err);
    if (st == CW_OK)
        st = cwi_parallel_for(chunks, CHUNK * CHUNK, d->threads, &d->progress,
                              "largest distance", search_chunk, s, err);
    if (st == CW_OK)
        join_results(s, chunks, out);
    cwi_free(s->extremes);
    return st;
}

static void measure_extent(reference *r, const cw_mesh *mesh)
{
    double low[3], high[3];
    cwi_box_clear(low, high);
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        double p[3][3];
        cwi_mesh_corners(mesh, t, p);
        for (int c = 0; c < 3; c++) {
            r->side += cwi_distance(p[c], p[(c + 1) % 3]);
            cwi_box_add(low, high, p[c]);
        }
    }
    if (mesh->triangle_count)
        r->diagonal = cwi_box_diagonal(low, high);
    r->side /= 3 * (double)mesh->triangle_count;
}

static void set_facets(reference *r, const cw_mesh *mesh)
{
    for (size_t s = 0; s < r->tree.count; s++) {
        const size_t t = r->tree.order[s];
        memcpy(r->facets[s].a, cwi_mesh_point(mesh, t, 0), sizeof r->facets[s].a);
        memcpy(r->facets[s].b, cwi_mesh_point(mesh, t, 1), sizeof r->facets[s].b);
        memcpy(r->facets[s].c, cwi_mesh_point(mesh, t, 2), sizeof r->facets[s].c);
    }
}

static cw_status make_reference(reference *r, const cw_mesh *mesh, const double origin[3],
                                cw_error *err)
{
    cwi_sub(mesh->origin, origin, r->shift);
    measure_extent(r, mesh);
    cw_status st = cwi_triangle_boxes_build(&r->tree, mesh->positions, mesh->vertex_count,
                                            mesh->triangles, mesh->triangle_count, err);
    if (st != CW_OK)
        return st;
    r->facets = cwi_alloc_array(r->tree.count, sizeof *r->facets);
    if (!r->facets)
        return cwi_fail_memory(err);
    set_facets(r, mesh);
    return CW_OK;
}

static cw_status check_reference(const cw_mesh *mesh, cw_error *err)
{
    const cw_status st = cw_mesh_check(mesh, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, "reference");
    if (mesh->triangle_count == 0)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "the reference has no triangles; at least one was expected");
    if (mesh->triangle_count > INT32_MAX)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "the reference has %zu triangles; up to 2^31 - 1 were expected",
                        mesh->triangle_count);
    return CW_OK;
}

static cw_status check_desc(const cw_mesh_distance_desc *d, cw_error *err)
{
    if (!(d->tolerance_mm >= 0) || !isfinite(d->tolerance_mm))
        return cwi_fail(err, CW_ERR_ARGUMENT, "tolerance_mm is %g; 0 or a length was expected",
                        d->tolerance_mm);
    if (!(d->step_mm >= 0) || !isfinite(d->step_mm))
        return cwi_fail(err, CW_ERR_ARGUMENT, "step_mm is %g; 0 or a length was expected",
                        d->step_mm);
    return CW_OK;
}

/* Means first: the largest distance among their points is where the search for
 * bounds begins. */
static cw_status measure_mesh(const cw_mesh *mesh, const reference *r,
                              const cw_mesh_distance_desc *d, cw_distance *out,
                              float *per_vertex, cw_error *err)
{
    uint32_t *slots = cwi_alloc_array(mesh->vertex_count, sizeof *slots);
    const double step = d->step_mm > 0 ? d->step_mm : r->side > 0 ? r->side : 1;
    const cwi_sampling sampling = {
        .mesh = mesh,
        .step = {{1 / step, 0, 0}, {0, 1 / step, 0}, {0, 0, 1 / step}},
        .measure = measure_point,
        .context = r,
        .hints = slots,
        .vertices_only = d->vertices_only,
        .worst = d->worst,
        .name = "distances",
        .threads = d->threads,
        .progress = &d->progress};
    search s = {.r = r,
                .mesh = mesh,
                .slots = slots,
                .tolerance = d->tolerance_mm > 0 ? d->tolerance_mm : 0.01 * r->side,
                .fraction = d->tolerance_mm > 0 ? 0 : 0.05};
    cw_status st = CW_OK;
    if (!slots)
        st = cwi_fail_memory(err);
    if (st == CW_OK)
        st = cwi_sample_mesh(&sampling, out, per_vertex, err);
    if (st == CW_OK)
        st = d->vertices_only ? CW_OK : find_bound(&s, d, out, err);
    cwi_free(slots);
    return st;
}

cw_status cw_distance_to_mesh(const cw_mesh *mesh, const cw_mesh *reference_mesh,
                              const cw_mesh_distance_desc *desc, cw_distance *out,
                              float *per_vertex, cw_error *err)
{
    CWI_REQUIRE(err, mesh, reference_mesh, out);
    CWI_REQUIRE_VERSION(err, desc, 0);
    const cw_mesh_distance_desc none = {0}, *d = desc ? desc : &none;
    reference r = {0};
    memset(out, 0, sizeof *out);
    cw_status st = cw_mesh_check(mesh, err);
    if (st == CW_OK)
        st = check_reference(reference_mesh, err);
    if (st == CW_OK)
        st = check_desc(d, err);
    if (st == CW_OK)
        st = make_reference(&r, reference_mesh, mesh->origin, err);
    if (st == CW_OK)
        st = measure_mesh(mesh, &r, d, out, per_vertex, err);
    if (st != CW_OK)
        memset(out, 0, sizeof *out);
    cwi_free(r.facets);
    cwi_boxes_free(&r.tree);
    return st;
}

typedef struct judgement {
    search search;
    uint32_t *slots; /* the search's, to be written */
    const double *limits;
    uint8_t *beyond;
} judgement;

static void find_chunk(void *context, size_t chunk)
{
    const judgement *j = context;
    const cw_mesh *m = j->search.mesh;
    uint32_t hint = UINT32_MAX;
    bool missed;
    for (size_t v = CHUNK * chunk; v < CHUNK * (chunk + 1) && v < m->vertex_count; v++) {
        const float *x = m->positions + 3 * v;
        const double p[3] = {(double)x[0], (double)x[1], (double)x[2]};
        measure_point(j->search.r, p, &hint, &missed);
        j->slots[v] = hint;
    }
}

static void judge_chunk(void *context, size_t chunk)
{
    const judgement *j = context;
    const search *s = &j->search;
    for (size_t t = CHUNK * chunk; t < CHUNK * (chunk + 1) && t < s->mesh->triangle_count;
         t++) {
        corner c[3];
        begin_triangle(s, t, c);
        j->beyond[t] = !is_within(s, c, j->limits ? j->limits[t] : s->floor);
    }
}

cw_status cwi_mesh_within(const cw_mesh *mesh, const cw_mesh *mesh_reference, double limit_mm,
                          const double *limits, int threads, const cw_progress *progress,
                          uint8_t *beyond, cw_error *err)
{
    reference r = {0};
    uint32_t *slots = cwi_alloc_array(mesh->vertex_count, sizeof *slots);
    judgement j = {.search = {.r = &r, .mesh = mesh, .slots = slots, .floor = limit_mm},
                   .slots = slots,
                   .limits = limits,
                   .beyond = beyond};
    cw_status st =
        slots ? make_reference(&r, mesh_reference, mesh->origin, err) : cwi_fail_memory(err);
    if (st == CW_OK)
        st = cwi_parallel_for((mesh->vertex_count + CHUNK - 1) / CHUNK, CHUNK * CHUNK, threads,
                              progress, "keeping the error", find_chunk, &j, err);
    if (st == CW_OK)
        st = cwi_parallel_for((mesh->triangle_count + CHUNK - 1) / CHUNK, CHUNK * CHUNK,
                              threads, progress, "keeping the error", judge_chunk, &j, err);
    cwi_boxes_free(&r.tree);
    cwi_free(r.facets);
    cwi_free(slots);
    return st;
}
