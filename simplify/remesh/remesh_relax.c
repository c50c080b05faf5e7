/* Moves vertices along the surface toward the centre of the triangles around them. The targets are found
 * at once, from where all vertices are; then vertices move one after the other. */
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/closest_point.h"
#include "core/geometry/vec3.h"
#include "simplify/remesh/remesh_state.h"

#include <string.h>

enum { CHUNK = 1024 };

/* Moves shorter than this fraction of the wanted length are not made. */
static const double MIN_MOVE = 1e-3;

/* A move may make angles smaller down to 30 degrees; below that, not at all. */
static const double MOVE_COSINE = 0.866;

typedef struct relaxation {
    const cwi_remesh *r;
    float *targets, *sizes;
} relaxation;

void cwi_remesh_project(const cwi_remesh *r, const cwi_target *target, const double from[3],
                        float to[3], float *size)
{
    const cwi_closest near = cwi_closest_find(&target->mesh, &target->tree, from);
    for (int k = 0; k < 3; k++)
        to[k] = (float)near.point[k];
    if (!size)
        return;
    const uint32_t *v = target->mesh.triangles + 3 * near.triangle;
    double sum = 0;
    for (int k = 0; k < 3; k++)
        sum += near.weights[k] * (double)r->target_sizes[v[k]];
    *size = (float)sum;
}

/* Computes the centre of the triangles at a vertex, each weighted by its area in units of the wanted
 * one, and moves the vertex there in the plane of their mean normal. */
static bool find_centre(const cwi_remesh *r, uint32_t v, double centre[3])
{
    uint32_t corners[CWI_MAX_ONE_RING];
    bool is_border;
    const size_t count = cwi_list_one_ring(r, v, corners, &is_border);
    double sum[3] = {0}, normal[3] = {0}, weights = 0;
    const float *p = r->positions + 3 * (size_t)v;
    for (size_t n = 0; n < count; n++) {
        const uint32_t b = r->triangles[cwi_corner_next(corners[n])],
                       c = r->triangles[cwi_corner_prev(corners[n])];
        const float *q = r->positions + 3 * (size_t)b, *o = r->positions + 3 * (size_t)c;
        double cross[3];
        const double size = (double)r->sizes[v] + (double)r->sizes[b] + (double)r->sizes[c];
        if (cwi_largest_cosine(p, q, o, cross) > 1)
            continue;
        const double weight = cwi_length(cross) / (size * size);
        for (int k = 0; k < 3; k++) {
            sum[k] += weight * ((double)q[k] + (double)o[k] - 2 * (double)p[k]) / 3;
            normal[k] += cross[k];
        }
        weights += weight;
    }
    if (!(weights > 0) || !cwi_normalise(normal))
        return false;
    const double out = cwi_dot(sum, normal);
    for (int k = 0; k < 3; k++)
        centre[k] = (double)p[k] + (sum[k] - out * normal[k]) / weights;
    return true;
}

/* Computes the middle between the neighbours along a curve. */
static bool find_middle(const cwi_remesh *r, uint32_t v, double middle[3])
{
    uint32_t corners[CWI_MAX_ONE_RING];
    bool is_border;
    const size_t count = cwi_list_one_ring(r, v, corners, &is_border);
    int found = 0;
    memset(middle, 0, 3 * sizeof *middle);
    for (size_t n = 0; n < count; n++) {
        const uint32_t c = corners[n], d = cwi_corner_prev(c);
        const uint32_t ends[2] = {r->triangles[cwi_corner_next(c)], r->triangles[d]};
        const bool is_last = n + 1 == count && is_border;
        for (int e = 0; e < 2; e++) {
            if (e == 0 ? !cwi_is_sharp(r, c) : !(is_last && cwi_is_sharp(r, d)))
                continue;
            found++;
            for (size_t k = 0; k < 3; k++)
                middle[k] += (double)r->positions[3 * (size_t)ends[e] + k] / 2;
        }
    }
    return found == 2;
}

static void find_place(const relaxation *x, uint32_t v)
{
    const cwi_remesh *r = x->r;
    float *target = x->targets + 3 * (size_t)v;
    double from[3];
    memcpy(target, r->positions + 3 * (size_t)v, 3 * sizeof *target);
    x->sizes[v] = r->sizes[v];
    if (r->corner[v] == CWI_NONE || r->freedom[v] == CWI_FIXED)
        return;
    if (r->freedom[v] == CWI_FREE && find_centre(r, v, from))
        cwi_remesh_project(r, &r->surface, from, target, r->target_sizes ? &x->sizes[v] : NULL);
    else if (r->freedom[v] == CWI_CURVE && find_middle(r, v, from))
        cwi_remesh_project(r, &r->curves, from, target, NULL);
}

static void find_chunk(void *context, size_t chunk)
{
    const relaxation *x = context;
    for (size_t v = chunk * CHUNK; v < (chunk + 1) * CHUNK && v < x->r->vertex_count; v++)
        find_place(x, (uint32_t)v);
}

/* Returns the largest cosine at a vertex, or that of 30 degrees if it is less. */
static double allowed_cosine(const cwi_remesh *r, uint32_t v)
{
    uint32_t corners[CWI_MAX_ONE_RING];
    bool is_border;
    const size_t count = cwi_list_one_ring(r, v, corners, &is_border);
    double largest = MOVE_COSINE;
    for (size_t n = 0; n < count; n++) {
        const uint32_t *t = r->triangles + 3 * (size_t)(corners[n] / 3);
        largest =
            cwi_greater(largest, cwi_largest_cosine(r->positions + 3 * (size_t)t[0],
                                                    r->positions + 3 * (size_t)t[1],
                                                    r->positions + 3 * (size_t)t[2], NULL));
    }
    return largest;
}

/* Moves a vertex to its target, or half of the way if that is refused. */
static void move_to_target(cwi_remesh *r, const relaxation *x, uint32_t v)
{
    const float *p = r->positions + 3 * (size_t)v, *target = x->targets + 3 * (size_t)v;
    const double min_move = MIN_MOVE * (double)r->sizes[v];
    if (!(cwi_point_distance_sq(p, target) > min_move * min_move))
        return;
    const double cosine = allowed_cosine(r, v);
    if (cwi_move_vertex(r, v, target, x->sizes[v], cosine))
        return;
    double half[3];
    float to[3];
    for (int k = 0; k < 3; k++)
        half[k] = ((double)p[k] + (double)target[k]) / 2;
    cwi_remesh_project(r, r->freedom[v] == CWI_FREE ? &r->surface : &r->curves, half, to, NULL);
    cwi_move_vertex(r, v, to, (r->sizes[v] + x->sizes[v]) / 2, cosine);
}

cw_status cwi_relax_vertices(cwi_remesh *r, cw_error *err)
{
    relaxation x = {.r = r};
    x.targets = cwi_alloc_array(r->vertex_count, 3 * sizeof *x.targets);
    x.sizes = cwi_alloc_array(r->vertex_count, sizeof *x.sizes);
    cw_status st = x.targets && x.sizes ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK)
        st =
            cwi_parallel_for((r->vertex_count + CHUNK - 1) / CHUNK, CHUNK * 64, r->desc.threads,
                             &(cw_progress){0}, "remesh", find_chunk, &x, err);
    for (uint32_t v = 0; v < r->vertex_count && st == CW_OK; v++) {
        if (v % (16 * CHUNK) == 0)
            st = cwi_progress(&r->desc.progress, "remesh", r->done, err);
        move_to_target(r, &x, v);
    }
    cwi_free(x.targets);
    cwi_free(x.sizes);
    return st;
}
