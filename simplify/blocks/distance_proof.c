/* Proves distances between a part of a surface and what became of it. Lists say where on one
 * surface a triangle of the other lies: from there short walks find the triangles it is near. What
 * they do not prove is searched for in a tree of boxes. */
#include "simplify/blocks/distance_proof.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/bvh.h"
#include "core/geometry/triangle_cover.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_triangle.h"
#include "core/mesh/surface_walk.h"
#include "simplify/blocks/partition.h"
#include "simplify/blocks/proof_record.h"
#include "simplify/quality/mesh_within.h"

#include <math.h>
#include <string.h>

enum { CHUNK = 512 };

static const uint32_t NOT_KNOWN = UINT32_MAX;

/* Triangles of a mesh, a surface, and where walks to them begin there. */
typedef struct walks {
    const cw_mesh *mesh;
    const cwi_fans *surface;
    const uint32_t *begin; /* triangles: one of the surface, or NOT_KNOWN */
    double limit;
    const double *limits;  /* triangles; or NULL */
    const uint8_t *known;  /* triangles: 1 where no proof is needed; or NULL */
    cwi_near_facets *near; /* triangles: what they are near; or NULL */
    uint8_t *beyond;
} walks;

/* A walk, and the facets that it led to. */
typedef struct recorded_walk {
    cwi_surface_walk walk;
    cwi_near_facets near;
} recorded_walk;

static double find_facet(void *context, const double p[3], const float *facet[3])
{
    recorded_walk *r = context;
    const double distance_sq = cwi_walk_to(&r->walk, p);
    cwi_walk_facet(&r->walk, r->walk.at, facet);
    cwi_near_facets_add(&r->near, r->walk.at);
    return distance_sq;
}

static bool is_within(const walks *w, size_t t)
{
    const double limit = w->limits ? w->limits[t] : w->limit;
    recorded_walk r = {
        .walk = {.fans = w->surface, .enough = limit * limit, .at = w->begin[t]}};
    cwi_cover cover = {.nearest = find_facet, .context = &r, .distance_sq = limit * limit};
    const float *first[3];
    double corners[3][3];
    if (r.walk.at == NOT_KNOWN)
        return false;
    cwi_walk_facet(&r.walk, r.walk.at, first);
    cwi_near_facets_add(&r.near, r.walk.at);
    cwi_mesh_corners(w->mesh, t, corners);
    if (!cwi_is_covered_from(&cover, (const double(*)[3])corners, first))
        return false;
    if (w->near)
        w->near[t] = r.near;
    return true;
}

static void walk_chunk(void *context, size_t chunk)
{
    const walks *w = context;
    for (size_t t = CHUNK * chunk; t < CHUNK * (chunk + 1) && t < w->mesh->triangle_count; t++)
        w->beyond[t] = !(w->known && w->known[t]) && !is_within(w, t);
}

/* --- what walks leave ---------------------------------------------------------------------- */

/* Copies some triangles of a mesh, each with corners of its own. */
static cw_status copy_triangles(const cw_mesh *from, const uint32_t *chosen, size_t count,
                                cw_mesh *out, cw_error *err)
{
    const cw_status st = cwi_mesh_alloc(out, 3 * count, count, false, err);
    for (size_t c = 0; c < 3 * count && st == CW_OK; c++) {
        const uint32_t v = from->triangles[3 * (size_t)chosen[c / 3] + c % 3];
        memcpy(out->positions + 3 * c, from->positions + 3 * (size_t)v, 3 * sizeof(float));
        out->triangles[c] = (uint32_t)c;
    }
    return st;
}

static size_t list_unproven(const walks *w, uint32_t *unproven)
{
    size_t count = 0;
    for (size_t t = 0; t < w->mesh->triangle_count; t++)
        if (w->beyond[t])
            unproven[count++] = (uint32_t)t;
    return count;
}

/* Boxes as wide as the distance around triangles. */
static cw_status make_boxes(const walks *w, const cw_mesh *mesh, cwi_boxes *tree, cw_error *err)
{
    float(*boxes)[6] = cwi_alloc_array(mesh->triangle_count, sizeof *boxes);
    if (!boxes)
        return cwi_fail_memory(err);
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        cwi_boxes_triangle(mesh->positions, mesh->triangles + 3 * t, boxes[t]);
        for (int a = 0; a < 3; a++) {
            boxes[t][a] -= (float)(1.001 * w->limit);
            boxes[t][a + 3] += (float)(1.001 * w->limit);
        }
    }
    const cw_status st =
        cwi_boxes_build(tree, (const float(*)[6])boxes, mesh->triangle_count, err);
    cwi_free(boxes);
    return st;
}

static bool find_any(void *context, size_t node)
{
    (void)node;
    *(bool *)context = true;
    return false;
}

/* Takes what is near a mesh of a reference. */
static cw_status take_near(const walks *w, const cw_mesh *mesh, const cw_mesh *reference,
                           cw_mesh *near, cw_error *err)
{
    cwi_boxes tree = {0};
    uint32_t *chosen = cwi_alloc_array(reference->triangle_count, sizeof *chosen);
    size_t count = 0;
    cw_status st = chosen ? make_boxes(w, mesh, &tree, err) : cwi_fail_memory(err);
    for (size_t t = 0; t < reference->triangle_count && st == CW_OK; t++) {
        float box[6];
        bool found = false;
        cwi_boxes_triangle(reference->positions, reference->triangles + 3 * t, box);
        cwi_boxes_visit(&tree, box, 0, find_any, &found);
        if (found)
            chosen[count++] = (uint32_t)t;
    }
    if (st == CW_OK)
        st = copy_triangles(reference, chosen, count, near, err);
    cwi_boxes_free(&tree);
    cwi_free(chosen);
    return st;
}

static cw_status search_near(const cwi_passes *p, const walks *w, const uint32_t *unproven,
                             size_t count, const cw_mesh *reference, int threads, cw_error *err)
{
    cw_mesh mesh = {0}, near = {0};
    double *limits = w->limits ? cwi_alloc_array(count, sizeof *limits) : NULL;
    uint8_t *beyond = cwi_alloc_array(count, 1);
    cw_status st = beyond && !limits == !w->limits ? CW_OK : cwi_fail_memory(err);
    for (size_t n = 0; n < count && limits; n++)
        limits[n] = w->limits[unproven[n]];
    if (st == CW_OK)
        st = copy_triangles(w->mesh, unproven, count, &mesh, err);
    if (st == CW_OK)
        st = take_near(w, &mesh, reference, &near, err);
    if (st == CW_OK && near.triangle_count)
        st = cwi_mesh_within(&mesh, &near, w->limit, limits, threads, &p->poll, beyond, err);
    for (size_t n = 0; n < count && st == CW_OK && near.triangle_count; n++)
        w->beyond[unproven[n]] = beyond[n];
    cw_mesh_free(&mesh);
    cw_mesh_free(&near);
    cwi_free(limits);
    cwi_free(beyond);
    return st;
}

static cw_status search_unproven(const cwi_passes *p, const walks *w, const cw_mesh *reference,
                                 int threads, cw_error *err)
{
    uint32_t *unproven = cwi_alloc_array(w->mesh->triangle_count, sizeof *unproven);
    if (!unproven)
        return cwi_fail_memory(err);
    const size_t count = list_unproven(w, unproven);
    const cw_status st =
        count ? search_near(p, w, unproven, count, reference, threads, err) : CW_OK;
    cwi_free(unproven);
    return st;
}

/* Finds the distances that triangles of a mesh must keep; NULL where one holds for all. */
static cw_status find_limits(const cwi_passes *p, const cw_mesh *m, double **limits,
                             cw_error *err)
{
    *limits = NULL;
    if (!p->views.count)
        return CW_OK;
    *limits = cwi_alloc_array(m->triangle_count, sizeof **limits);
    if (!*limits)
        return cwi_fail_memory(err);
    for (size_t t = 0; t < m->triangle_count; t++)
        (*limits)[t] = fmin(p->error, cwi_views_limit(&p->views, m, t, p->error, 0));
    return CW_OK;
}

/* Sets beyond for the triangles of a mesh. The reference is all of the surface that is known to
 * be near, and some of it is in fans. */
static cw_status find_beyond(const cwi_passes *p, const cw_mesh *mesh, const cwi_fans *fans,
                             const uint32_t *begin, const cw_mesh *reference, int threads,
                             const uint8_t *known, cwi_near_facets *near, uint8_t *beyond,
                             cw_error *err)
{
    double *limits = NULL;
    cw_status st = find_limits(p, mesh, &limits, err);
    const walks w = {mesh, fans, begin, p->error, limits, known, near, beyond};
    if (st == CW_OK)
        st =
            cwi_parallel_for((mesh->triangle_count + CHUNK - 1) / CHUNK, CHUNK * CHUNK, threads,
                             &p->poll, "keeping the error", walk_chunk, (void *)&w, err);
    if (st == CW_OK)
        st = search_unproven(p, &w, reference, threads, err);
    cwi_free(limits);
    return st;
}

/* --- both ways ----------------------------------------------------------------------------- */

/* The result, and with it what is in the way: it is part of the surface, too. */
static cw_status add_obstacles(const cwi_block_part *x, cw_mesh *mesh, cw_error *err)
{
    const cwi_mesh_block *from = x->from, *left = x->left;
    const size_t more = from->triangles - from->interior_count;
    cw_status st = cwi_mesh_alloc(mesh, left->vertices + 3 * more, left->interior_count + more,
                                  false, err);
    if (st != CW_OK)
        return st;
    memcpy(mesh->positions, left->points, 3 * left->vertices * sizeof *left->points);
    memcpy(mesh->triangles, left->corners, 3 * left->interior_count * sizeof *left->corners);
    for (size_t c = 0; c < 3 * more; c++) {
        const size_t v = left->vertices + c;
        memcpy(mesh->positions + 3 * v,
               from->points + 3 * (size_t)from->corners[3 * from->interior_count + c],
               3 * sizeof(float));
        mesh->triangles[3 * left->interior_count + c] = (uint32_t)v;
    }
    return CW_OK;
}

/* Begins at the triangle of the result that lists a corner. */
static cw_status begin_at_result(const cwi_passes *p, const cwi_block_part *x, uint32_t *begin,
                                 cw_error *err)
{
    uint32_t *nearest_triangle =
        cwi_alloc_zeroed(p->input.vertex_count, sizeof *nearest_triangle);
    if (!nearest_triangle)
        return cwi_fail_memory(err);
    for (size_t t = 0; t < x->left->interior_count; t++)
        for (uint32_t v = x->left->nearest_points[t]; v != UINT32_MAX; v = p->next[v])
            nearest_triangle[v] = (uint32_t)t + 1;
    for (size_t t = 0; t < x->input.triangle_count; t++) {
        begin[t] = NOT_KNOWN;
        for (size_t k = 0; k < 6 && begin[t] == NOT_KNOWN; k++) {
            const uint32_t local = x->input.triangles[3 * t + k % 3],
                           v = x->global_ids ? x->global_ids[local] : local;
            if (k >= 3 || !cwi_fan_is_wide(&p->original.fans, v))
                begin[t] = nearest_triangle[v] - 1;
        }
    }
    cwi_free(nearest_triangle);
    return CW_OK;
}

/* Begins at a triangle of the input around a point that is listed. */
static void begin_at_input(const cwi_passes *p, const cwi_mesh_block *left, uint32_t *begin)
{
    for (size_t t = 0; t < left->interior_count; t++) {
        const uint32_t v = left->nearest_points[t];
        begin[t] = v != UINT32_MAX ? p->around[p->first[v]] : NOT_KNOWN;
    }
}

/* Begins elsewhere as triangles at a corner do, at best one whose fan is not wide. */
static cw_status begin_as_neighbours(const cw_mesh *mesh, uint32_t *begin, cw_error *err)
{
    uint32_t *at = cwi_alloc_array(mesh->vertex_count, sizeof *at);
    uint32_t *count = cwi_alloc_zeroed(mesh->vertex_count, sizeof *count);
    const bool ok = at && count;
    for (size_t v = 0; v < mesh->vertex_count && ok; v++)
        at[v] = NOT_KNOWN;
    for (size_t c = 0; c < 3 * mesh->triangle_count && ok; c++) {
        count[mesh->triangles[c]]++;
        if (begin[c / 3] != NOT_KNOWN)
            at[mesh->triangles[c]] = begin[c / 3];
    }
    for (int wide = 0; wide < 2 && ok; wide++)
        for (size_t c = 0; c < 3 * mesh->triangle_count; c++)
            if (begin[c / 3] == NOT_KNOWN &&
                (wide || count[mesh->triangles[c]] <= CWI_WIDE_FAN))
                begin[c / 3] = at[mesh->triangles[c]];
    cwi_free(at);
    cwi_free(count);
    return ok ? CW_OK : cwi_fail_memory(err);
}

static cw_status prove_input(const cwi_passes *p, const cwi_block_part *x, const uint8_t *known,
                             cwi_near_facets *near, uint8_t *beyond, cw_error *err)
{
    const cwi_mesh_block *left = x->left;
    cw_mesh all = {0};
    uint32_t *begin = cwi_alloc_array(x->input.triangle_count, sizeof *begin);
    uint32_t *first = cwi_alloc_array(left->vertices + 2, sizeof *first);
    uint32_t *around = cwi_alloc_array(3 * left->interior_count, sizeof *around);
    const cwi_fans fans = {left->points, left->corners, first, around};
    cw_status st =
        begin && first && around ? add_obstacles(x, &all, err) : cwi_fail_memory(err);
    if (st == CW_OK)
        st = begin_at_result(p, x, begin, err);
    if (st == CW_OK)
        st = begin_as_neighbours(&x->input, begin, err);
    if (st == CW_OK) {
        cwi_fans_sort(left->corners, left->interior_count, left->vertices, first, around);
        st =
            find_beyond(p, &x->input, &fans, begin, &all, x->threads, known, near, beyond, err);
    }
    cw_mesh_free(&all);
    cwi_free(begin);
    cwi_free(first);
    cwi_free(around);
    return st;
}

static cw_status prove_result(const cwi_passes *p, const cwi_block_part *x,
                              const uint8_t *known, uint8_t *beyond, cw_error *err)
{
    const cw_mesh result = cwi_block_view(x->left);
    uint32_t *begin = cwi_alloc_array(result.triangle_count, sizeof *begin);
    if (!begin)
        return cwi_fail_memory(err);
    begin_at_input(p, x->left, begin);
    cw_status st = begin_as_neighbours(&result, begin, err);
    if (st == CW_OK)
        st = find_beyond(p, &result, &p->original.fans, begin, &x->input, x->threads, known,
                         NULL, beyond, err);
    cwi_free(begin);
    return st;
}

cw_status cwi_block_part_prove(const cwi_passes *p, const cwi_block_part *x,
                               uint8_t *input_beyond, uint8_t *left_beyond,
                               cwi_near_facets *near, cw_error *err)
{
    const bool has_record = p->record.near && !x->global_ids;
    uint8_t *input_known = has_record ? cwi_alloc_zeroed(x->input.triangle_count, 1) : NULL;
    uint8_t *left_known = has_record ? cwi_alloc_zeroed(x->left->interior_count, 1) : NULL;
    cw_status st = !has_record || (input_known && left_known) ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK && has_record)
        st = cwi_proof_record_compare(&p->record, x, p->input.vertex_count, input_known,
                                      left_known, err);
    if (near)
        cwi_near_facets_clear(near, x->input.triangle_count);
    if (st == CW_OK)
        st = prove_input(p, x, input_known, near, input_beyond, err);
    if (st == CW_OK)
        st = prove_result(p, x, left_known, left_beyond, err);
    cwi_free(input_known);
    cwi_free(left_known);
    return st;
}
