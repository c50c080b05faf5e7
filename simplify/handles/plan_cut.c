/* Plans the cut along a loop: moves both rims apart, closes them by caps of least area, and looks
 * for triangles that meet. */
#include "core/base/memory.h"
#include "core/geometry/closest_point.h"
#include "core/geometry/triangle.h"
#include "core/geometry/triangle_intersect.h"
#include "core/mesh/corner_table.h"
#include "core/mesh/mesh_triangle.h"
#include "simplify/handles/loop_surroundings.h"
#include "simplify/repair/hole_patch.h"

#include <cubewright/quality.h>

#include <math.h>
#include <string.h>

/* How a cut is tried: later ones change less, and cross less. */
typedef struct cut_attempt {
    float step; /* of the vertices of the rims, as a fraction of the way to their neighbours */
    bool is_plain; /* caps have no vertices but those of the rim */
} cut_attempt;

static const cut_attempt ATTEMPTS[] = {
    {0.5F, false}, {0.5F, true}, {0.25F, false}, {0.25F, true}, {0.1F, true}};

/* A cut that is tried. */
typedef struct cut_plan {
    cwi_surroundings near;
    cwi_hole_mesh around; /* the triangles around the loop */
    cwi_hole_patch caps[2];
    uint32_t *vertices, *beside; /* of a rim, as of a cwi_boundary_loop */
} cut_plan;

void cwi_handle_cut_free(cwi_handle_cut *cut)
{
    for (int side = 0; side < 2; side++) {
        cwi_free(cut->rims[side]);
        cwi_free(cut->points[side]);
        cwi_free(cut->caps[side]);
    }
    *cut = (cwi_handle_cut){0};
}

static void free_plan(cut_plan *p)
{
    cwi_surroundings_free(&p->near);
    cwi_free(p->around.edges);
    cwi_free(p->around.first);
    cwi_free(p->around.around);
    cwi_patch_free(&p->caps[0]);
    cwi_patch_free(&p->caps[1]);
    cwi_free(p->vertices);
    cwi_free(p->beside);
}

static bool init_around(cut_plan *p)
{
    const cw_mesh *m = &p->near.mesh;
    cwi_hole_mesh *h = &p->around;
    h->mesh = m;
    h->edge_count = 3 * p->near.around;
    h->edges = cwi_edge_keys(m->triangles, h->edge_count);
    h->first = cwi_alloc_zeroed(m->vertex_count + 2, sizeof *h->first);
    h->around = cwi_alloc_array(h->edge_count, sizeof *h->around);
    p->vertices = cwi_alloc_array(p->near.rim, sizeof *p->vertices);
    p->beside = cwi_alloc_array(p->near.rim, sizeof *p->beside);
    if (!h->edges || !h->first || !h->around || !p->vertices || !p->beside)
        return false;
    cwi_fans_sort(m->triangles, p->near.around, m->vertex_count, h->first, h->around);
    return true;
}

/* --- caps --------------------------------------------------------------------------------- */

/* Returns the third vertex of the triangle around the loop with a side from a to b. */
static uint32_t find_third(const cut_plan *p, uint32_t a, uint32_t b)
{
    const uint32_t *triangles = p->near.mesh.triangles;
    for (uint32_t i = p->around.first[a]; i < p->around.first[a + 1]; i++)
        for (size_t c = 3 * (size_t)p->around.around[i], k = 0; k < 3; k++)
            if (triangles[c + k] == a && triangles[c + (k + 1) % 3] == b)
                return triangles[c + (k + 2) % 3];
    return a;
}

/* Sets the rim of a side in the direction of its cap. */
static void set_rim(cut_plan *p, int side)
{
    const uint32_t count = p->near.rim, base = side ? count : 0;
    for (uint32_t n = 0; n < count; n++)
        p->vertices[n] = base + (side ? n : count - 1 - n);
    for (uint32_t n = 0; n < count; n++)
        p->beside[n] = find_third(p, p->vertices[(n + 1) % count], p->vertices[n]);
}

static bool make_cap(cut_plan *p, int side, bool is_plain)
{
    cwi_hole_patch *cap = &p->caps[side];
    const cwi_boundary_loop loop = {p->vertices, p->beside, p->near.rim};
    bool ok = true;
    cwi_patch_free(cap);
    set_rim(p, side);
    for (size_t n = 0; n < loop.size && ok; n++) {
        double point[3];
        for (size_t a = 0; a < 3; a++)
            point[a] = (double)p->near.mesh.positions[3 * (size_t)loop.vertices[n] + a];
        ok = cwi_patch_add_point(cap, point);
    }
    cap->loop = loop.size;
    ok = ok && cwi_patch_triangulate(cap, &loop, &p->around);
    return ok && (is_plain || cwi_patch_shape(cap, &loop, &p->around, false));
}

/* Returns the vertex of a rim that a vertex of a cap is; new vertices follow the rim. */
static uint32_t cap_vertex(uint32_t rim, int side, uint32_t v)
{
    return v < rim && !side ? rim - 1 - v : v;
}

/* --- the check ---------------------------------------------------------------------------- */

/* Joins the surroundings and the caps. Returns false when memory is out. */
static bool join_caps(const cut_plan *p, cw_mesh *out)
{
    const cw_mesh *m = &p->near.mesh;
    const uint32_t rim = p->near.rim;
    out->vertex_count = m->vertex_count + p->caps[0].count + p->caps[1].count - 2 * (size_t)rim;
    out->triangle_count =
        m->triangle_count + p->caps[0].triangle_count + p->caps[1].triangle_count;
    out->positions = cwi_alloc_array(out->vertex_count, 3 * sizeof *out->positions);
    out->triangles = cwi_alloc_array(out->triangle_count, 3 * sizeof *out->triangles);
    if (!out->positions || !out->triangles)
        return false;
    memcpy(out->positions, m->positions, 3 * m->vertex_count * sizeof *out->positions);
    memcpy(out->triangles, m->triangles, 3 * m->triangle_count * sizeof *out->triangles);
    size_t vertices = m->vertex_count;
    uint32_t *to = out->triangles + 3 * m->triangle_count;
    for (int side = 0; side < 2; side++) {
        const cwi_hole_patch *cap = &p->caps[side];
        for (size_t c = 0; c < 3 * cap->triangle_count; c++) {
            const uint32_t v = cap_vertex(rim, side, cap->triangles[c / 3][c % 3]);
            *to++ = v < rim ? v + (side ? rim : 0) : (uint32_t)vertices + v - rim;
        }
        for (size_t n = rim; n < cap->count; n++, vertices++)
            for (size_t a = 0; a < 3; a++)
                out->positions[3 * vertices + a] = (float)cap->points[n][a];
    }
    return true;
}

/* Returns true if two triangles of the surroundings met before the cut. */
static bool met_before(const cwi_surroundings *s, uint32_t a, uint32_t b)
{
    const cwi_handles *h = s->h;
    if (a >= s->mesh.triangle_count || b >= s->mesh.triangle_count)
        return false;
    const uint32_t *v = h->triangles + 3 * (size_t)s->ids[a],
                   *w = h->triangles + 3 * (size_t)s->ids[b];
    return cwi_has_area(h->positions, v) && cwi_has_area(h->positions, w) &&
           cwi_triangles_meet(h->positions, v, w);
}

static bool is_in_box(const cw_mesh *m, size_t from, const float box[6])
{
    for (size_t n = 3 * from; n < 3 * m->vertex_count; n++)
        if (!(m->positions[n] >= box[n % 3] && m->positions[n] <= box[n % 3 + 3]))
            return false;
    return true;
}

/* Judges a cut. is_clear: no triangle meets another that it did not meet before, or has no area. Returns false
 * when memory is out. */
static bool judge_cut(const cut_plan *p, const cw_mesh *joined, const float box[6],
                      bool *is_clear)
{
    const cwi_surroundings *s = &p->near;
    const cw_crossings_desc desc = {.threads = 1};
    cw_crossings found = {0};
    *is_clear = is_in_box(joined, s->mesh.vertex_count, box);
    for (size_t t = s->mesh.triangle_count; t < joined->triangle_count && *is_clear; t++)
        *is_clear = cwi_has_area(joined->positions, joined->triangles + 3 * t);
    if (!*is_clear)
        return true;
    if (cw_self_intersections(joined, &desc, &found, NULL) != CW_OK)
        return false;
    *is_clear = !found.undecided;
    for (size_t n = 0; n < found.count && *is_clear; n++)
        *is_clear = met_before(s, found.pairs[2 * n], found.pairs[2 * n + 1]);
    cw_crossings_free(&found);
    return true;
}

/* --- the result --------------------------------------------------------------------------- */

/* Returns true if the left cap faces away from the right rim: the caps have material between them. */
static bool is_filling(const cut_plan *p)
{
    const uint32_t rim = p->near.rim;
    double apart[3] = {0}, normal[3] = {0};
    for (uint32_t n = 0; n < rim; n++) {
        const float *left = p->near.mesh.positions + 3 * (size_t)n;
        for (size_t a = 0; a < 3; a++)
            apart[a] += (double)left[a] - (double)left[3 * (size_t)rim + a];
    }
    for (size_t t = 0; t < p->caps[0].triangle_count; t++) {
        const uint32_t *v = p->caps[0].triangles[t];
        double area[3];
        cwi_triangle_normal(p->caps[0].points[v[0]], p->caps[0].points[v[1]],
                            p->caps[0].points[v[2]], area);
        for (int a = 0; a < 3; a++)
            normal[a] += area[a];
    }
    return cwi_dot(apart, normal) > 0;
}

/* Returns the largest distance of the rims and caps from the input. */
static double measure_change(const cut_plan *p, const cw_mesh *joined)
{
    const cwi_handles *h = p->near.h;
    double most = 0, point[3], corners[3][3];
    for (size_t n = 0; n < 2 * (size_t)p->near.rim; n++) {
        for (size_t a = 0; a < 3; a++)
            point[a] = (double)joined->positions[3 * n + a];
        most = cwi_greater(
            most, cwi_distance(point, cwi_closest_find(h->mesh, &h->tree, point).point));
    }
    for (size_t t = p->near.mesh.triangle_count; t < joined->triangle_count; t++) {
        cwi_mesh_corners(joined, t, corners);
        for (int k = 0; k < 4; k++) { /* each corner, then the middle */
            if (k < 3)
                memcpy(point, corners[k], sizeof point);
            else
                cwi_triangle_centroid(corners[0], corners[1], corners[2], point);
            most = cwi_greater(
                most, cwi_distance(point, cwi_closest_find(h->mesh, &h->tree, point).point));
        }
    }
    return most;
}

/* Copies what the cut needs. Returns false when memory is out. */
static bool keep_cut(const cut_plan *p, const cw_mesh *joined, cwi_handle_cut *cut)
{
    const uint32_t rim = p->near.rim;
    const size_t rim_bytes = 3 * (size_t)rim * sizeof(float);
    cut->count = rim;
    cut->is_possible = true;
    cut->is_filling = is_filling(p);
    cut->change_mm = measure_change(p, joined);
    const float *points = joined->positions + 3 * p->near.mesh.vertex_count;
    for (int side = 0; side < 2; side++) {
        const cwi_hole_patch *cap = &p->caps[side];
        const size_t count = cap->count - rim;
        cut->rims[side] = cwi_alloc_array(rim, 3 * sizeof(float));
        cut->points[side] = cwi_alloc_array(count, 3 * sizeof(float));
        cut->caps[side] = cwi_alloc_array(cap->triangle_count, 3 * sizeof(uint32_t));
        if (!cut->rims[side] || !cut->points[side] || !cut->caps[side])
            return false;
        cut->point_count[side] = count;
        cut->cap_count[side] = cap->triangle_count;
        memcpy(cut->rims[side], joined->positions + (side ? 3 * (size_t)rim : 0), rim_bytes);
        memcpy(cut->points[side], points, 3 * count * sizeof(float));
        points += 3 * count;
        for (size_t c = 0; c < 3 * cap->triangle_count; c++)
            cut->caps[side][c] = cap_vertex(rim, side, cap->triangles[c / 3][c % 3]);
    }
    return true;
}

static bool try_cut(cut_plan *p, const cut_attempt *attempt, const float box[6],
                    cwi_handle_cut *cut)
{
    cw_mesh joined = {0};
    bool is_clear = cwi_surroundings_part_rims(&p->near, attempt->step);
    bool ok = true;
    if (is_clear)
        ok = make_cap(p, 0, attempt->is_plain) && make_cap(p, 1, attempt->is_plain) &&
             join_caps(p, &joined) && judge_cut(p, &joined, box, &is_clear);
    if (ok && is_clear)
        ok = keep_cut(p, &joined, cut);
    cw_mesh_free(&joined);
    return ok;
}

bool cwi_handles_plan(const cwi_handles *h, const cwi_loops *loops, const cwi_loop *loop,
                      const cwi_boxes *changed, const uint32_t *ids, const float box[6],
                      cwi_handle_cut *cut)
{
    cut_plan p = {0};
    bool ok =
        cwi_surroundings_gather(&p.near, h, loops, loop, changed, ids, box) && init_around(&p);
    for (size_t n = 0; n < sizeof ATTEMPTS / sizeof *ATTEMPTS && ok && !cut->is_possible; n++)
        ok = try_cut(&p, &ATTEMPTS[n], box, cut);
    free_plan(&p);
    return ok;
}
