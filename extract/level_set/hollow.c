/* Hollows a solid: offsets its surface inward by the wall's thickness, and carves drains from
 * the cavity outward. */
#include "core/mesh/mesh_attributes.h"
#include "core/mesh/mesh_triangle.h"
#include "extract/level_set/level_set.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/union_find.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "core/volume/volume.h"

#include <cubewright/distance.h>
#include <cubewright/extract.h>

#include <math.h>
#include <string.h>

/* A drain: all points within a radius of a ray. */
typedef struct ray {
    double from[3], along[3], radius; /* along: of length 1 */
} ray;

typedef struct hollowing {
    const cw_mesh *mesh;
    const cw_hollow_desc *desc;
    cw_quality before;
    double voxel_mm;
    cw_volume volume;
    cw_mesh inner; /* surfaces of the cavities, facing outward */
    uint32_t *set; /* for each of its vertices: the least vertex of its component */
    double *size;  /* of the component that a vertex names, mm3 */
    uint32_t largest;
    ray *rays;
    cw_hollow_facts facts;
} hollowing;

/* --- parameters --------------------------------------------------------------------------- */

static double find_narrowest(const cw_hollow_desc *d)
{
    double min = d->wall_mm;
    for (size_t n = 0; n < d->drain_count; n++)
        min = fmin(min, d->drains[n].diameter_mm);
    return min;
}

static cw_status check_desc(const cw_hollow_desc *d, cw_error *err)
{
    if (!(d->wall_mm > 0 && isfinite(d->wall_mm) && d->voxel_mm >= 0 && isfinite(d->voxel_mm)))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "a wall of %g mm with voxels of %g mm: a wall above 0 was expected, "
                        "voxels not below",
                        d->wall_mm, d->voxel_mm);
    for (size_t n = 0; n < d->drain_count; n++) {
        const double length = cwi_length(d->drains[n].direction),
                     width = d->drains[n].diameter_mm;
        if (!(width > 0 && isfinite(width) && length > 0 && isfinite(length)))
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "drain %zu has a diameter of %g mm and a direction of length %g; "
                            "both above 0 were expected",
                            n + 1, width, length);
    }
    if (d->voxel_mm > 0 && find_narrowest(d) < 2 * d->voxel_mm)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "voxels of %g mm are too large for %s of %g mm: at most half of that",
                        d->voxel_mm, find_narrowest(d) < d->wall_mm ? "a drain" : "a wall",
                        find_narrowest(d));
    return CW_OK;
}

static double choose_voxel(const cw_hollow_desc *d, const cw_quality *q)
{
    const double finest = find_narrowest(d) / 4;
    double voxel = finest;
    while (!cwi_level_set_fits(q, voxel, d->wall_mm, d->max_bytes) && voxel < 2 * finest)
        voxel = fmin(1.05 * voxel, 2 * finest);
    return voxel;
}

/* --- cavities ----------------------------------------------------------------------------- */

static cw_status take_surface(hollowing *h, double isovalue, bool normals, cw_mesh *out,
                              cw_error *err)
{
    const cw_extract_desc desc = {.isovalue = isovalue,
                                  .inside_is_low = true,
                                  .no_normals = !normals,
                                  .threads = h->desc->threads,
                                  .max_bytes = h->desc->max_bytes,
                                  .progress = h->desc->progress};
    return cw_extract(&h->volume, &desc, out, NULL, err);
}

/* Returns the signed volume under a triangle; the mesh's origin is the tip. */
static double volume_under(const cw_mesh *m, size_t t)
{
    double p[3][3], normal[3];
    cwi_mesh_corners(m, t, p);
    cwi_cross(p[1], p[2], normal);
    return cwi_dot(p[0], normal) / 6;
}

/* Finds the cavities. A component that faces outward encloses a cavity; one that faces inward
 * is a part of the wall inside a cavity. */
static cw_status find_cavities(hollowing *h, cw_error *err)
{
    const cw_mesh *m = &h->inner;
    h->set = cwi_sets_alloc(m->vertex_count);
    h->size = cwi_alloc_zeroed(m->vertex_count, sizeof *h->size);
    if (!h->set || !h->size)
        return cwi_fail_memory(err);
    for (const uint32_t *c = m->triangles; c < m->triangles + 3 * m->triangle_count; c += 3) {
        cwi_sets_join(h->set, c[0], c[1]);
        cwi_sets_join(h->set, c[0], c[2]);
    }
    for (size_t t = 0; t < m->triangle_count; t++)
        h->size[cwi_sets_find(h->set, m->triangles[3 * t])] += volume_under(m, t);
    for (uint32_t v = 0; v < m->vertex_count; v++) {
        h->set[v] = cwi_sets_find(h->set, v);
        h->facts.cavities += h->size[v] > 0;
        if (h->size[v] > h->size[h->largest])
            h->largest = v;
    }
    h->facts.sealed = h->facts.cavities;
    return CW_OK;
}

/* --- drains ------------------------------------------------------------------------------- */

static double distance_to_ray(const ray *r, const double p[3])
{
    double to[3], off[3];
    cwi_sub(p, r->from, to);
    const double along = cwi_greater(cwi_dot(to, r->along), 0);
    cwi_add_scaled(to, -along, r->along, off);
    return cwi_length(off) - r->radius;
}

/* Returns how far a vertex of the largest cavity's surface is along a ray; other vertices do
 * not count. */
static double measure_depth(const hollowing *h, const ray *r, size_t vertex, double p[3])
{
    cwi_mesh_world(&h->inner, vertex, p);
    return h->set[vertex] == h->largest ? cwi_dot(p, r->along) : -INFINITY;
}

/* Starts a ray at the largest cavity's farthest point. Of several, as on a flat floor, it takes
 * the one nearest to their middle. */
static void place_ray(const hollowing *h, const cw_drain *drain, ray *r)
{
    const double length = cwi_length(drain->direction);
    double p[3], middle[3] = {0}, farthest = -INFINITY, nearest = INFINITY, count = 0;
    r->radius = drain->diameter_mm / 2;
    for (int a = 0; a < 3; a++)
        r->along[a] = drain->direction[a] / length;
    for (size_t v = 0; v < h->inner.vertex_count; v++)
        farthest = fmax(farthest, measure_depth(h, r, v, p));
    farthest -= h->voxel_mm;
    for (size_t v = 0; v < h->inner.vertex_count; v++)
        if (measure_depth(h, r, v, p) >= farthest) {
            count++;
            for (int a = 0; a < 3; a++)
                middle[a] += (p[a] - middle[a]) / count;
        }
    for (size_t v = 0; v < h->inner.vertex_count; v++)
        if (measure_depth(h, r, v, p) >= farthest) {
            const double distance_sq = cwi_distance_sq(p, middle);
            if (distance_sq < nearest) {
                nearest = distance_sq;
                memcpy(r->from, p, sizeof p);
            }
        }
}

/* Counts the cavities that stay sealed. A drain opens the cavities whose surface it meets. */
static void count_sealed(hollowing *h)
{
    for (size_t v = 0; v < h->inner.vertex_count; v++) {
        double p[3], *size = &h->size[h->set[v]], nearest = INFINITY;
        if (!(*size > 0))
            continue;
        cwi_mesh_world(&h->inner, v, p);
        for (size_t n = 0; n < h->desc->drain_count; n++)
            nearest = fmin(nearest, distance_to_ray(&h->rays[n], p));
        if (nearest < 0) {
            h->facts.sealed--;
            *size = 0;
        }
    }
}

static float carve_sample(const hollowing *h, double distance, const double p[3])
{
    const double limit = h->volume.sparse->background;
    double solid = fmax(distance, -h->desc->wall_mm - distance);
    for (size_t n = 0; n < h->desc->drain_count; n++)
        solid = fmax(solid, -distance_to_ray(&h->rays[n], p));
    return (float)fmin(solid, limit);
}

/* Turns the level set into that of the wall. All of a wall is in leaves: tiles are in cavities,
 * as far from it as the background. */
static void carve_leaf(void *context, size_t leaf)
{
    const hollowing *h = context;
    const cw_volume *v = &h->volume;
    const cw_sparse *sparse = v->owned_grid;
    float *voxels = v->owned;
    for (size_t n = 0; n < CWI_LEAF_VOXELS; n++) {
        const size_t in[3] = {n % CWI_LEAF, n / CWI_LEAF % CWI_LEAF, n / (CWI_LEAF * CWI_LEAF)};
        float *voxel = voxels + leaf * CWI_LEAF_VOXELS + n;
        double p[3];
        for (int a = 0; a < 3; a++)
            p[a] = v->affine[a][3] +
                   v->affine[a][a] * (double)(CWI_LEAF * sparse->leaves[leaf][a] + in[a]);
        *voxel = carve_sample(h, (double)*voxel, p);
    }
}

static void carve_all(hollowing *h)
{
    cw_sparse *sparse = h->volume.owned_grid;
    sparse->tile_count = 0;
    cwi_parallel_for_all(sparse->leaf_count, CWI_LEAF_VOXELS, h->desc->threads, carve_leaf, h);
}

static cw_status place_rays(hollowing *h, cw_error *err)
{
    h->rays = cwi_alloc_array(h->desc->drain_count, sizeof *h->rays);
    if (!h->rays)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < h->desc->drain_count; n++)
        place_ray(h, &h->desc->drains[n], &h->rays[n]);
    count_sealed(h);
    return CW_OK;
}

/* --- the result --------------------------------------------------------------------------- */

/* Appends the cavities' surfaces, turned inside out, to the mesh. */
static cw_status join_surfaces(const hollowing *h, cw_mesh *out, cw_error *err)
{
    const size_t v = h->mesh->vertex_count, t = h->mesh->triangle_count;
    cw_status st = cwi_mesh_copy(h->mesh, out, err);
    if (st == CW_OK)
        st = cwi_mesh_append(out, &h->inner, err);
    if (st != CW_OK)
        return st;
    for (size_t n = t; n < out->triangle_count; n++)
        cwi_mesh_swap_corners(out, n, 0, 2);
    for (size_t n = 3 * v; n < 3 * out->vertex_count && out->normals; n++)
        out->normals[n] = -out->normals[n];
    return CW_OK;
}

static cw_status measure_wall(hollowing *h, const cw_mesh *outer, cw_error *err)
{
    const cw_mesh_distance_desc desc = {.threads = h->desc->threads,
                                        .progress = h->desc->progress};
    cw_distance d;
    float *each = cwi_alloc_array(h->inner.vertex_count, sizeof *each);
    cw_status st = each ? cw_distance_to_mesh(&h->inner, outer, &desc, &d, each, err)
                        : cwi_fail_memory(err);
    if (st == CW_OK) {
        h->facts.wall_max_mm = d.max_mm;
        h->facts.wall_min_mm = d.max_mm;
        for (size_t n = 0; n < h->inner.vertex_count; n++)
            h->facts.wall_min_mm = fmin(h->facts.wall_min_mm, (double)each[n]);
    }
    cwi_free(each);
    return st;
}

/* Makes the surface with drains; the outer surface is then taken from the level set, too. */
static cw_status drain_cavity(hollowing *h, cw_mesh *out, cw_error *err)
{
    cw_mesh outer = {0};
    cw_status st = CW_OK;
    if (!h->desc->no_measure)
        st = take_surface(h, 0, false, &outer, err);
    if (st == CW_OK && !h->desc->no_measure)
        st = measure_wall(h, &outer, err);
    cw_mesh_free(&outer);
    if (st == CW_OK)
        st = place_rays(h, err);
    if (st != CW_OK)
        return st;
    carve_all(h);
    st = take_surface(h, 0, h->mesh->normals, out, err);
    memcpy(out->affine, h->mesh->affine, sizeof out->affine);
    if (st == CW_OK && !out->triangle_count)
        st = cwi_fail(err, CW_ERR_EMPTY, "nothing is left of the wall: the drains take it all");
    return st;
}

static cw_status finish_hollow(hollowing *h, cw_mesh *out, cw_error *err)
{
    cw_quality after;
    cw_status st =
        h->desc->drain_count ? drain_cavity(h, out, err) : join_surfaces(h, out, err);
    if (st == CW_OK && !h->desc->drain_count && !h->desc->no_measure)
        st = measure_wall(h, h->mesh, err);
    if (st == CW_OK)
        st = cw_quality_measure(out, &(cw_quality_desc){.threads = h->desc->threads}, &after,
                                err);
    if (st == CW_OK)
        h->facts.removed_mm3 = h->before.volume_mm3 - after.volume_mm3;
    return st;
}

static cw_status make_level_set(hollowing *h, cw_error *err)
{
    const cw_hollow_desc *d = h->desc;
    h->voxel_mm = d->voxel_mm > 0 ? d->voxel_mm : choose_voxel(d, &h->before);
    h->facts.voxel_mm = h->voxel_mm;
    const cw_level_set_desc desc = {.voxel_mm = h->voxel_mm,
                                    .inside_mm = d->wall_mm,
                                    .threads = d->threads,
                                    .max_bytes = d->max_bytes,
                                    .progress = d->progress};
    const double level = -d->wall_mm;
    return cwi_level_set_make(h->mesh, &h->before, &desc, &level, &h->volume, err);
}

cw_status cw_mesh_hollow(const cw_mesh *mesh, const cw_hollow_desc *desc, cw_mesh *out,
                         cw_hollow_facts *facts, cw_error *err)
{
    CWI_REQUIRE(err, mesh, desc, out);
    CWI_REQUIRE_VERSION(err, desc, 0);
    hollowing h = {.mesh = mesh, .desc = desc};
    *out = (cw_mesh){0};
    cw_status st = check_desc(desc, err);
    if (st == CW_OK)
        st = cwi_level_set_check(mesh, desc->threads, &h.before, err);
    if (st == CW_OK)
        st = make_level_set(&h, err);
    if (st == CW_OK)
        st = take_surface(&h, -desc->wall_mm, mesh->normals, &h.inner, err);
    if (st == CW_OK && !h.inner.triangle_count)
        st = cwi_fail(err, CW_ERR_EMPTY,
                      "a wall of %g mm leaves no cavity: no point is that deep inside",
                      desc->wall_mm);
    if (st == CW_OK)
        st = find_cavities(&h, err);
    if (st == CW_OK)
        st = finish_hollow(&h, out, err);
    if (facts)
        *facts = h.facts;
    cw_volume_free(&h.volume);
    cw_mesh_free(&h.inner);
    cwi_free(h.set);
    cwi_free(h.size);
    cwi_free(h.rays);
    if (st != CW_OK)
        cw_mesh_free(out);
    return st;
}
