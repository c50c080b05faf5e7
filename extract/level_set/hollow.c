/* Hollows a solid: offsets its surface inward by the wall's thickness, and drills drains from
 * the cavity outward. */
#include "core/mesh/mesh_attributes.h"
#include "core/mesh/mesh_triangle.h"
#include "extract/level_set/infill.h"
#include "extract/level_set/level_set.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "core/volume/volume.h"

#include <cubewright/boolean.h>
#include <cubewright/distance.h>
#include <cubewright/extract.h>

#include <math.h>
#include <string.h>

/* Corners of a drain's rings, a multiple of 4: sides are 0.1 % of the radius inside of the circle. */
enum { DRAIN_SIDES = 64 };

/* How often drains are drilled with other corners, and the angle between tries. */
enum { DRAIN_TRIES = 3 };
static const double DRAIN_TURN = 0.03;

/* A drain: all points within a radius of a ray. */
typedef struct ray {
    double from[3], along[3], radius; /* along: of length 1 */
    size_t drain;                     /* of the options */
} ray;

/* Part of a drain's radius within which a vertex of a cavity must be, so that the drain meets it: surely,
 * and so well that it needs no other. */
static const double SURELY_MET = 0.9, CLEARLY_MET = 0.5;

/* Part of the largest channel's volume from which on a channel of a lattice gets drains. */
static const double LARGE_CHANNEL = 0.25;

typedef struct hollowing {
    const cw_mesh *mesh;
    const cw_hollow_desc *desc;
    cw_quality before;
    double voxel_mm;
    cw_volume volume;
    cw_mesh inner;  /* surfaces of the cavities, facing outward */
    cw_mesh *voids; /* the cavities one by one, with drains only: the largest comes first */
    size_t void_count;
    ray *rays;
    size_t ray_count;
    cwi_infill infill; /* with desc->infill */
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
    return d->infill ? cwi_infill_check(d->infill, d->voxel_mm, err) : CW_OK;
}

static double choose_voxel(const cw_hollow_desc *d, const cw_quality *q)
{
    const double infill =
        d->infill ? cwi_infill_thinnest(d->infill) / CWI_INFILL_VOXELS : INFINITY;
    const double finest = fmin(find_narrowest(d) / 4, infill),
                 coarsest = fmin(find_narrowest(d) / 2, infill);
    double voxel = finest;
    while (!cwi_level_set_fits(q, voxel, d->wall_mm, d->max_bytes) && voxel < coarsest)
        voxel = fmin(1.05 * voxel, coarsest);
    return voxel;
}

/* Returns the bytes for a lattice with walls that are thicker by a factor, as its voxels are. */
static double count_infill_bytes(const hollowing *h, double factor)
{
    const double voxel = factor * h->voxel_mm;
    return cwi_level_set_bytes(&h->before, voxel,
                               h->desc->wall_mm + h->desc->infill->depth_mm) +
           cwi_infill_bytes(h->desc->infill, &h->before, voxel, h->desc->drain_count > 0);
}

/* Predicts the memory for a lattice. Fails with CW_ERR_LIMIT, and names the scale that would do. */
static cw_status check_infill_fits(const hollowing *h, cw_error *err)
{
    const cw_hollow_desc *d = h->desc;
    const double bytes = count_infill_bytes(h, 1);
    double factor = 1;
    if (!d->max_bytes || bytes <= (double)d->max_bytes)
        return CW_OK;
    while (count_infill_bytes(h, factor) > (double)d->max_bytes && factor < 1e30)
        factor *= 1.05;
    return cwi_fail(
        err, CW_ERR_LIMIT,
        "a lattice with walls of %.3g mm has voxels of %.3g mm, which need some %.3g MB; the "
        "limit is %.3g MB; walls and cells %.2g times as large would do",
        cwi_infill_thinnest(d->infill), h->voxel_mm, bytes / 1e6, (double)d->max_bytes / 1e6,
        1.05 * factor);
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
    *out = (cw_mesh){0};
    const cw_status st = cw_extract(&h->volume, &desc, out, NULL, err);
    if (st == CW_OK)
        cwi_level_set_round(out, h->mesh->origin);
    return st;
}

/* Returns the signed volume under a triangle; the mesh's origin is the tip. */
static double volume_under(const cw_mesh *m, size_t t)
{
    double p[3][3], normal[3];
    cwi_mesh_corners(m, t, p);
    cwi_cross(p[1], p[2], normal);
    return cwi_dot(p[0], normal) / 6;
}

static double enclosed_volume(const cw_mesh *m)
{
    double sum = 0;
    for (size_t n = 0; n < m->triangle_count; n++)
        sum += volume_under(m, n);
    return sum;
}

/* Makes the surfaces of the cavities. Those smaller than a ball as wide as the wall is thick are
 * filled: they save nothing, and no drain empties them. */
static cw_status make_cavities(hollowing *h, cw_error *err)
{
    const double wall = h->desc->wall_mm;
    cw_drop_counts dust = {0};
    const double level = h->desc->infill ? 0 : -wall;
    cw_status st = take_surface(h, level, h->mesh->normals, &h->inner, err);
    if (st == CW_OK)
        st = cw_mesh_drop_volumes(&h->inner, CWI_PI / 6 * wall * wall * wall, &dust, err);
    h->facts.filled = dust.dropped;
    h->facts.filled_mm3 = dust.dropped_mm3;
    if (st != CW_OK || h->inner.triangle_count)
        return st;
    return dust.dropped
               ? cwi_fail(err, CW_ERR_EMPTY,
                          "a wall of %g mm leaves no cavity larger than a ball of that width: "
                          "%zu smaller ones, %.3g mm3 together, would save nothing",
                          wall, dust.dropped, dust.dropped_mm3)
               : cwi_fail(err, CW_ERR_EMPTY,
                          "a wall of %g mm leaves no cavity: no point is that deep inside",
                          wall);
}

/* --- drains ------------------------------------------------------------------------------- */

/* Returns how far a vertex is along a ray. */
static double measure_depth(const cw_mesh *m, const ray *r, size_t vertex, double p[3])
{
    cwi_mesh_world(m, vertex, p);
    return cwi_dot(p, r->along);
}

/* Starts a ray at a cavity's farthest point. Of several, as on a flat floor, it takes the one nearest
 * to their middle. */
static void place_ray(const hollowing *h, const cw_drain *drain, const cw_mesh *cavity, ray *r)
{
    const double length = cwi_length(drain->direction);
    double p[3], middle[3] = {0}, farthest = -INFINITY, nearest = INFINITY, count = 0;
    r->radius = drain->diameter_mm / 2;
    for (int a = 0; a < 3; a++)
        r->along[a] = drain->direction[a] / length;
    for (size_t v = 0; v < cavity->vertex_count; v++)
        farthest = fmax(farthest, measure_depth(cavity, r, v, p));
    farthest -= h->voxel_mm;
    for (size_t v = 0; v < cavity->vertex_count; v++)
        if (measure_depth(cavity, r, v, p) >= farthest) {
            count++;
            for (int a = 0; a < 3; a++)
                middle[a] += (p[a] - middle[a]) / count;
        }
    for (size_t v = 0; v < cavity->vertex_count; v++)
        if (measure_depth(cavity, r, v, p) >= farthest) {
            const double distance_sq = cwi_distance_sq(p, middle);
            if (distance_sq < nearest) {
                nearest = distance_sq;
                memcpy(r->from, p, sizeof p);
            }
        }
}

/* Returns true if a drain surely meets a cavity: a vertex is well within it.
 * share  of the radius that counts */
static bool meets_cavity(const ray *r, const cw_mesh *cavity, double share)
{
    const double limit = share * r->radius;
    for (size_t v = 0; v < cavity->vertex_count; v++) {
        double p[3], to[3];
        cwi_mesh_world(cavity, v, p);
        cwi_sub(p, r->from, to);
        const double along = cwi_dot(to, r->along);
        cwi_add_scaled(to, -fmax(along, 0), r->along, to);
        if (cwi_dot(to, to) < limit * limit)
            return true;
    }
    return false;
}

/* Appends a ray for each drain to a cavity that none in the same direction meets yet. */
static cw_status reach_cavity(hollowing *h, const cw_mesh *cavity, cw_error *err)
{
    const size_t count = h->desc->drain_count;
    ray *rays = cwi_realloc_array(h->rays, h->ray_count + count, sizeof *rays);
    if (!rays)
        return cwi_fail_memory(err);
    h->rays = rays;
    const size_t before = h->ray_count;
    for (size_t n = 0; n < count; n++) {
        bool is_met = false;
        for (size_t k = 0; k < before && !is_met; k++)
            is_met = rays[k].drain == n && meets_cavity(&rays[k], cavity, CLEARLY_MET);
        if (is_met)
            continue;
        place_ray(h, &h->desc->drains[n], cavity, &rays[h->ray_count]);
        rays[h->ray_count++].drain = n;
    }
    return CW_OK;
}

/* Fills the channels of a lattice that no drain meets. */
static cw_status fill_closed(hollowing *h, cw_error *err)
{
    cw_mesh kept = {0};
    size_t closed = 0;
    cw_status st = CW_OK;
    for (size_t n = 0; n < h->void_count && st == CW_OK; n++) {
        bool is_met = false;
        for (size_t k = 0; k < h->ray_count && !is_met; k++)
            is_met = meets_cavity(&h->rays[k], &h->voids[n], SURELY_MET);
        if (is_met) {
            st = cwi_mesh_append(&kept, &h->voids[n], err);
            continue;
        }
        closed++;
        h->facts.filled++;
        h->facts.filled_mm3 += enclosed_volume(&h->voids[n]);
    }
    if (st == CW_OK && closed) {
        cw_mesh_free(&h->inner);
        h->inner = kept;
        kept = (cw_mesh){0};
    }
    cw_mesh_free(&kept);
    return st;
}

/* Places drains: to the largest cavity, or to all large channels of a lattice. */
static cw_status place_rays(hollowing *h, cw_error *err)
{
    cw_status st = cw_mesh_split(&h->inner, &h->voids, &h->void_count, err);
    const double largest = st == CW_OK ? enclosed_volume(&h->voids[0]) : 0;
    const size_t most = h->desc->infill ? h->void_count : 1;
    for (size_t n = 0; n < most && st == CW_OK; n++)
        if (!n || enclosed_volume(&h->voids[n]) >= LARGE_CHANNEL * largest)
            st = reach_cavity(h, &h->voids[n], err);
    h->facts.drains = h->ray_count;
    return st == CW_OK && h->desc->infill ? fill_closed(h, err) : st;
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

/* Returns true if a vertex is of the cavity's own surface, not of a wall of the lattice in it. */
static bool is_of_cavity(const hollowing *h, size_t vertex, double depth_mm)
{
    double p[3], foot[3], normal[3];
    cwi_mesh_world(&h->inner, vertex, p);
    const double wall = cwi_infill_wall(&h->infill, p, depth_mm - h->desc->wall_mm);
    return cwi_infill_distance(&h->infill, p, foot, normal) > wall / 2 + h->voxel_mm / 2;
}

static cw_status measure_wall(hollowing *h, cw_error *err)
{
    const cw_mesh_distance_desc desc = {.threads = h->desc->threads,
                                        .progress = h->desc->progress};
    cw_distance d;
    float *each = cwi_alloc_array(h->inner.vertex_count, sizeof *each);
    cw_status st = each ? cw_distance_to_mesh(&h->inner, h->mesh, &desc, &d, each, err)
                        : cwi_fail_memory(err);
    if (st == CW_OK) {
        const bool all = !h->desc->infill;
        h->facts.wall_max_mm = all ? d.max_mm : 0;
        h->facts.wall_min_mm = d.max_mm;
        for (size_t n = 0; n < h->inner.vertex_count; n++) {
            const double mm = (double)each[n];
            h->facts.wall_min_mm = fmin(h->facts.wall_min_mm, mm);
            if (!all && mm > h->facts.wall_max_mm && is_of_cavity(h, n, mm))
                h->facts.wall_max_mm = mm;
        }
    }
    cwi_free(each);
    if (st == CW_OK && h->desc->infill)
        st = cwi_infill_measure(&h->infill, h->mesh, &h->inner, h->desc->wall_mm,
                                h->desc->threads, &h->desc->progress, &h->facts, err);
    return st;
}

/* --- the holes ---------------------------------------------------------------------------- */

/* Returns how far a ray must go to leave the box of the mesh. */
static double measure_way_out(const hollowing *h, const ray *r)
{
    double length = 2 * r->radius;
    for (int a = 0; a < 3; a++)
        length += fmax((h->before.min[a] - r->from[a]) * r->along[a],
                       (h->before.max[a] - r->from[a]) * r->along[a]);
    return length;
}

/* Sets a vertex of a drain: at a distance along its ray, and at one from it. */
static void set_drain_point(const ray *r, const double across[2][3], double along,
                            double radius, double angle, cw_mesh *out, size_t v)
{
    for (size_t a = 0; a < 3; a++)
        out->positions[3 * v + a] =
            (float)(r->from[a] - out->origin[a] + along * r->along[a] +
                    radius * (cos(angle) * across[0][a] + sin(angle) * across[1][a]));
}

/* Makes the solid of a drain: half a ball, and a cylinder from there out of the mesh. The first and the last
 * vertex are its ends; rings are between them.
 * turn  angle of the first corner of a ring */
static cw_status make_drain(const hollowing *h, const ray *r, double turn, cw_mesh *out,
                            cw_error *err)
{
    const size_t rings = DRAIN_SIDES / 4 + 1, last = rings * DRAIN_SIDES + 1;
    const double end = measure_way_out(h, r);
    double across[2][3], pick[3] = {0};
    cw_status st = cwi_mesh_alloc(out, last + 1, 2 * rings * DRAIN_SIDES, false, err);
    if (st != CW_OK)
        return st;
    memcpy(out->origin, h->mesh->origin, sizeof out->origin);
    pick[fabs(r->along[0]) < 0.6 ? 0 : 1] = 1;
    cwi_cross(r->along, pick, across[0]);
    cwi_normalise(across[0]);
    cwi_cross(r->along, across[0], across[1]);
    set_drain_point(r, (const double(*)[3])across, -r->radius, 0, 0, out, 0);
    set_drain_point(r, (const double(*)[3])across, end, 0, 0, out, last);
    uint32_t *c = out->triangles;
    for (size_t n = 0; n < rings * DRAIN_SIDES; n++) {
        const size_t ring = n / DRAIN_SIDES, side = n % DRAIN_SIDES, up = n + 1,
                     next = ring * DRAIN_SIDES + (side + 1) % DRAIN_SIDES + 1;
        const double angle = turn + 2 * CWI_PI * (double)side / DRAIN_SIDES,
                     rise = CWI_PI / 2 * fmin((double)(ring + 1) / (double)(rings - 1), 1);
        const bool is_last = ring + 1 == rings;
        set_drain_point(r, (const double(*)[3])across, is_last ? end : -r->radius * cos(rise),
                        r->radius * sin(rise), angle, out, up);
        const size_t under = ring ? up - DRAIN_SIDES : 0,
                     under_next = ring ? next - DRAIN_SIDES : 0;
        const size_t made[2][3] = {{under, next, up}, {under, under_next, next}},
                     lid[3] = {up, next, last};
        for (size_t k = 0; k < (ring ? 6 : 3); k++)
            *c++ = (uint32_t)made[k / 3][k % 3];
        for (size_t k = 0; k < (is_last ? 3 : 0); k++)
            *c++ = (uint32_t)lid[k];
    }
    return CW_OK;
}

/* Subtracts the drains, turned by an angle, from a solid. */
static cw_status subtract_drains(const hollowing *h, const cw_mesh *solid, double turn,
                                 cw_mesh *out, cw_error *err)
{
    const size_t count = h->ray_count;
    const cw_boolean_desc desc = {.op = CW_BOOLEAN_DIFFERENCE,
                                  .threads = h->desc->threads,
                                  .progress = h->desc->progress};
    cw_mesh *drains = cwi_alloc_zeroed(count, sizeof *drains);
    const cw_mesh **all = cwi_alloc_array(count + 1, sizeof *all);
    cw_status st = drains && all ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK)
        all[0] = solid;
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        all[n + 1] = &drains[n];
        st = make_drain(h, &h->rays[n], turn, &drains[n], err);
    }
    if (st == CW_OK)
        st = cw_mesh_boolean(all, count + 1, &desc, out, NULL, err);
    if (st == CW_OK)
        cw_mesh_attribute_remove(out, "input");
    for (size_t n = 0; n < count && drains; n++)
        cw_mesh_free(&drains[n]);
    cwi_free(drains);
    cwi_free(all);
    return st;
}

/* Measures a result with its cavities, as checks count them. */
static cw_status measure_cavities(const hollowing *h, const cw_mesh *mesh, cw_quality *q,
                                  cw_error *err)
{
    const cw_quality_desc desc = {
        .shells = true, .threads = h->desc->threads, .progress = h->desc->progress};
    return cw_quality_measure(mesh, &desc, q, err);
}

/* Drills the drains into the mesh with its cavities. Where rounding finds no result, drains whose corners are
 * elsewhere do. */
static cw_status drain_cavity(hollowing *h, cw_mesh *out, cw_error *err)
{
    cw_mesh solid = {0};
    cw_quality sealed = {0};
    cw_status st = join_surfaces(h, &solid, err);
    if (st == CW_OK)
        st = measure_cavities(h, &solid, &sealed, err);
    h->facts.cavities = sealed.cavities;
    for (int n = 0; n < DRAIN_TRIES && (n ? st == CW_ERR_CHECK : st == CW_OK); n++)
        st = subtract_drains(h, &solid, n * DRAIN_TURN, out, err);
    cw_mesh_free(&solid);
    if (st == CW_OK && !out->triangle_count)
        st = cwi_fail(err, CW_ERR_EMPTY, "nothing is left of the wall: the drains take it all");
    return st;
}

/* Finds out if a solid has a vertex near the outer surface. */
static cw_status reaches_outside(const hollowing *h, const cw_mesh *solid, bool *reaches,
                                 cw_error *err)
{
    const cw_mesh_distance_desc desc = {.vertices_only = true, .threads = h->desc->threads};
    cw_distance d;
    float *each = cwi_alloc_array(solid->vertex_count, sizeof *each);
    const cw_status st =
        each ? cw_distance_to_mesh(solid, h->mesh, &desc, &d, each, err) : cwi_fail_memory(err);
    *reaches = false;
    for (size_t v = 0; v < solid->vertex_count && st == CW_OK && !*reaches; v++)
        *reaches = (double)each[v] < h->desc->wall_mm / 2;
    cwi_free(each);
    return st;
}

/* Leaves out pieces of a lattice that drains cut loose. */
static cw_status drop_loose(hollowing *h, cw_mesh *out, cw_error *err)
{
    cw_mesh *solids = NULL, kept = {0};
    size_t count = 0;
    cw_status st = cw_mesh_split(out, &solids, &count, err);
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        bool reaches;
        st = reaches_outside(h, &solids[n], &reaches, err);
        if (st == CW_OK && reaches)
            st = cwi_mesh_append(&kept, &solids[n], err);
        h->facts.loose += !reaches;
    }
    cw_meshes_free(solids, count);
    if (st != CW_OK || !h->facts.loose) {
        cw_mesh_free(&kept);
        return st;
    }
    cw_mesh_free(out);
    *out = kept;
    return CW_OK;
}

/* Makes as many solids of the result as the mesh has, where there is a lattice, and measures it. */
static cw_status count_solids(hollowing *h, cw_mesh *out, cw_quality *after, cw_error *err)
{
    cw_quality input = {0};
    cw_status st = measure_cavities(h, out, after, err);
    if (st != CW_OK || !h->desc->infill)
        return st;
    st = measure_cavities(h, h->mesh, &input, err);
    if (st != CW_OK || after->components - after->cavities <= input.components - input.cavities)
        return st;
    st = drop_loose(h, out, err);
    return st == CW_OK ? measure_cavities(h, out, after, err) : st;
}

static cw_status finish_hollow(hollowing *h, cw_mesh *out, cw_error *err)
{
    cw_quality after = {0};
    cw_status st = h->desc->drain_count ? place_rays(h, err) : CW_OK;
    if (st == CW_OK && !h->desc->no_measure)
        st = measure_wall(h, err);
    if (st == CW_OK)
        st = h->desc->drain_count ? drain_cavity(h, out, err) : join_surfaces(h, out, err);
    if (st == CW_OK)
        st = count_solids(h, out, &after, err);
    h->facts.sealed = after.cavities;
    if (!h->desc->drain_count)
        h->facts.cavities = after.cavities;
    h->facts.removed_mm3 = h->before.volume_mm3 - after.volume_mm3;
    return st;
}

static cw_status make_level_set(hollowing *h, cw_error *err)
{
    const cw_hollow_desc *d = h->desc;
    h->voxel_mm = d->voxel_mm > 0 ? d->voxel_mm : choose_voxel(d, &h->before);
    h->facts.voxel_mm = h->voxel_mm;
    const cw_level_set_desc desc = {.voxel_mm = h->voxel_mm,
                                    .inside_mm =
                                        d->wall_mm + (d->infill ? d->infill->depth_mm : 0),
                                    .threads = d->threads,
                                    .max_bytes = d->max_bytes,
                                    .progress = d->progress};
    const double level = -d->wall_mm;
    cw_status st = d->infill ? check_infill_fits(h, err) : CW_OK;
    if (st == CW_OK)
        st = cwi_level_set_make(h->mesh, &h->before, &desc, &level, &h->volume, err);
    return st == CW_OK && d->infill ? cwi_infill_apply(&h->infill, d->wall_mm, d->threads,
                                                       &d->progress, &h->volume, err)
                                    : st;
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
    if (st == CW_OK && desc->infill)
        st = cwi_infill_init(&h.infill, desc->infill, &h.before, desc->threads, err);
    if (st == CW_OK)
        st = make_level_set(&h, err);
    if (st == CW_OK)
        st = make_cavities(&h, err);
    if (st == CW_OK)
        st = cwi_level_set_prove(&h.inner, desc->threads, &desc->progress, err);
    if (st == CW_OK)
        st = finish_hollow(&h, out, err);
    if (facts)
        *facts = h.facts;
    cw_volume_free(&h.volume);
    cw_mesh_free(&h.inner);
    cw_meshes_free(h.voids, h.void_count);
    cwi_free(h.rays);
    if (st != CW_OK)
        cw_mesh_free(out);
    return st;
}
