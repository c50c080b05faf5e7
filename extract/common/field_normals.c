/* Computes the normals of vertices from the field's gradient, and from triangles where it
 * vanishes. */
#include "extract/common/field_normals.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/geometry/vec3.h"
#include "core/volume/volume.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* --- from triangles ---------------------------------------------------------------------- */

void cwi_add_facet_normal(const float *const corner[3], double scale, float normal[3])
{
    double u[3], v[3], across[3];
    for (size_t a = 0; a < 3; a++) {
        u[a] = scale * ((double)corner[1][a] - (double)corner[0][a]);
        v[a] = scale * ((double)corner[2][a] - (double)corner[0][a]);
    }
    cwi_cross(u, v, across);
    for (int a = 0; a < 3; a++)
        normal[a] += (float)across[a];
}

void cwi_finish_normal(float n[3])
{
    const double length = sqrt((double)n[0] * n[0] + (double)n[1] * n[1] + (double)n[2] * n[2]);
    for (int a = 0; a < 3; a++)
        n[a] = length > 0 ? (float)(n[a] / length) : a == 2;
}

/* Runs in one thread, in the order of triangles: sums do not depend on the number of
 * threads. */
cw_status cwi_repair_normals(cw_mesh *mesh, double scale, cw_error *err)
{
    size_t count = 0;
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        const float *n = mesh->normals + 3 * v;
        count += n[0] == 0 && n[1] == 0 && n[2] == 0;
    }
    if (!count)
        return CW_OK;
    bool *missing = cwi_alloc_zeroed(mesh->vertex_count, sizeof *missing);
    if (!missing)
        return cwi_fail_memory(err);
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        const float *n = mesh->normals + 3 * v;
        missing[v] = n[0] == 0 && n[1] == 0 && n[2] == 0;
    }
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *triangle = mesh->triangles + 3 * t;
        const float *corner[3];
        for (int c = 0; c < 3; c++)
            corner[c] = mesh->positions + 3 * (size_t)triangle[c];
        for (int c = 0; c < 3; c++)
            if (missing[triangle[c]])
                cwi_add_facet_normal(corner, scale, mesh->normals + 3 * (size_t)triangle[c]);
    }
    for (size_t v = 0; v < mesh->vertex_count; v++)
        if (missing[v])
            cwi_finish_normal(mesh->normals + 3 * v);
    cwi_free(missing);
    return CW_OK;
}

/* --- from the field ---------------------------------------------------------------------- */

enum { CHUNK = 4096 };

/* Rounding may have put a point beyond the last sample by this fraction of a voxel. The
 * vertices of a cap are four times as far out. */
#define REACH (1.0 / 4096)

static bool fetch_sample(const cwi_shading *s, const size_t at[3], int axis, int step,
                         double *value)
{
    const cw_volume *v = &s->volume;
    size_t i[3] = {at[0], at[1], at[2]};
    i[axis] += (size_t)step; /* -1 from 0 is beyond any dim, too */
    if (i[axis] >= v->dim[axis])
        return false;
    *value = cwi_voxel_at(v->type, cwi_voxel_address(v, i[0], i[1], i[2] - s->first));
    return !isnan(*value) && !(v->has_nodata && *value == v->nodata);
}

/* Computes the derivative along an axis where distances differ: the slopes on both sides, each
 * weighted by the distance on the other side, which is exact for parabolas. Values are halves;
 * NaN: none. */
static double difference_unevenly(const cw_volume *v, int axis, size_t i, double before,
                                  double centre, double after)
{
    const double *x = v->coordinates[axis];
    const double low = i > 0 ? x[i] - x[i - 1] : 1,
                 high = i + 1 < v->dim[axis] ? x[i + 1] - x[i] : 1;
    const double below = 2 * (centre - before) / low, above = 2 * (after - centre) / high;
    if (!isfinite(centre) || (isnan(before) && isnan(after)))
        return 0;
    if (isnan(before) || isnan(after))
        return isnan(before) ? above : below;
    return (below * high + above * low) / (low + high);
}

/* Computes the gradient as extraction does at a sample: central differences of the stored
 * numbers, one-sided where a neighbour is missing or infinite. Returns false at a sample
 * without value. */
static bool sample_gradient(const cwi_shading *s, const size_t at[3], double g[3])
{
    const cw_volume *v = &s->volume;
    double centre;
    if (!fetch_sample(s, at, 0, 0, &centre))
        return false;
    for (int a = 0; a < 3; a++) {
        double before = 0, after = 0;
        const bool has_before = fetch_sample(s, at, a, -1, &before) && isfinite(before);
        const bool has_after = fetch_sample(s, at, a, 1, &after) && isfinite(after);
        before *= 0.5; /* halves first, so that differences of huge doubles stay finite */
        after *= 0.5;
        if (cwi_is_rectilinear(v))
            g[a] = difference_unevenly(v, a, at[a], has_before ? before : NAN, centre * 0.5,
                                       has_after ? after : NAN);
        else if (has_before && has_after)
            g[a] = after - before;
        else if (isfinite(centre) && (has_before || has_after))
            g[a] = has_after ? 2 * (after - centre * 0.5) : 2 * (centre * 0.5 - before);
        else
            g[a] = 0;
    }
    return true;
}

/* Finds the cell of a vertex, and the place in it; returns false outside the volume. */
static bool find_cell(const cwi_shading *s, size_t vertex, size_t cell[3],
                      double cell_fraction[3])
{
    const cw_volume *v = &s->volume;
    double p[3];
    for (size_t r = 0; r < 3; r++)
        p[r] =
            s->mesh->origin[r] - v->affine[r][3] + (double)s->mesh->positions[3 * vertex + r];
    for (int a = 0; a < 3; a++) {
        const double last = (double)(v->dim[a] - 1);
        double x = cwi_coordinate_index(v, a, cwi_dot(s->inverse[a], p));
        if (!(x >= -REACH && x <= last + REACH))
            return false;
        x = x < 0 ? 0 : x > last ? last : x;
        cell[a] = x < last ? (size_t)x : v->dim[a] - 2;
        cell_fraction[a] = x - (double)cell[a];
    }
    return true;
}

/* Interpolates the gradient at a vertex, in index space. Returns false outside the domain:
 * where a sample without value has more weight than rounding gives it. */
static bool interpolate_gradient(const cwi_shading *s, size_t vertex, double sum[3])
{
    size_t cell[3];
    double cell_fraction[3], total = 0;
    if (!find_cell(s, vertex, cell, cell_fraction))
        return false;
    for (size_t corner = 0; corner < 8; corner++) {
        size_t at[3];
        double weight = 1, g[3];
        for (int a = 0; a < 3; a++) {
            const bool high = corner >> a & 1;
            at[a] = cell[a] + high;
            weight *= high ? cell_fraction[a] : 1 - cell_fraction[a];
        }
        if (!(weight > 0) || !sample_gradient(s, at, g))
            continue;
        total += weight;
        for (int a = 0; a < 3; a++)
            sum[a] += weight * g[a];
    }
    return total > 1 - REACH;
}

bool cwi_shading_slice(const cwi_shading *s, size_t vertex, size_t *slice)
{
    size_t cell[3];
    double fraction[3];
    const bool found = find_cell(s, vertex, cell, fraction);
    *slice = found ? cell[2] : 0;
    return found;
}

void cwi_shade_vertex(const cwi_shading *s, size_t vertex)
{
    double g[3] = {0, 0, 0}, n[3] = {0, 0, 0};
    if (!interpolate_gradient(s, vertex, g) || !cwi_normalise(g))
        return;
    for (int r = 0; r < 3; r++)
        n[r] = cwi_dot(s->outward[r], g);
    for (size_t r = 0; r < 3 && cwi_normalise(n); r++)
        s->normals[3 * vertex + r] = (float)n[r];
}

static void shade_chunk(void *context, size_t chunk)
{
    const cwi_shading *s = context;
    const size_t last = s->mesh->vertex_count, end = (chunk + 1) * CHUNK;
    for (size_t v = chunk * CHUNK; v < (end < last ? end : last); v++)
        cwi_shade_vertex(s, v);
}

void cwi_shading_set_field(cwi_shading *s, const cw_volume *volume, bool invert)
{
    s->volume = *volume;
    cwi_outward(volume, invert, s->outward);
    cwi_affine_invert(volume->affine[0], s->inverse);
}

/* Bounds the error of a z coordinate that find_cell() finds. Positions are floats, relative to the
 * middle of the volume; the middle and the sums are doubles. Each has twice its rounding error. */
static double bound_rounding(const cw_volume *v)
{
    double inverse[3][3], bound = 0;
    cwi_affine_invert(v->affine[0], inverse);
    for (int r = 0; r < 3; r++) {
        double half = 0, centre = fabs(v->affine[r][3]);
        for (int a = 0; a < 3; a++) {
            const double low = cwi_grid_coordinate(v, a, -1, 0),
                         high = cwi_grid_coordinate(v, a, (ptrdiff_t)v->dim[a] - 1, 1);
            half += fabs(v->affine[r][a]) * fabs(high - low);
            centre += fabs(v->affine[r][a]) * fmax(fabs(low), fabs(high));
        }
        bound += fabs(inverse[2][r]) * (half * FLT_EPSILON + 16 * centre * DBL_EPSILON);
    }
    return bound;
}

size_t cwi_shading_drift(const cw_volume *v)
{
    const double *z = v->coordinates[2];
    const double bound = z ? bound_rounding(v) : 0;
    size_t drift = 0;
    for (size_t k = 0; z && k < v->dim[2]; k++)
        while (k + drift + 1 < v->dim[2] && z[k + drift + 1] - z[k] <= bound)
            drift++;
    return drift;
}

cw_status cwi_shading_init(cwi_shading *s, const cw_volume *volume, const cw_normals_desc *d,
                           cw_mesh *mesh, cw_error *err)
{
    cw_status st = cw_volume_select(volume, 0, 0, &s->volume, err);
    const cw_volume *v = &s->volume;
    if (st == CW_OK)
        st = cwi_volume_expect_dense(v, "shading by the field", err);
    for (int a = 0; a < 3 && st == CW_OK; a++)
        if (v->dim[a] < 2)
            st = cwi_fail(err, CW_ERR_ARGUMENT,
                          "the volume has %zu voxel along %c; a gradient needs 2", v->dim[a],
                          "xyz"[a]);
    if (st == CW_OK)
        st = cw_mesh_check(mesh, err);
    if (st != CW_OK)
        return st;
    s->mesh = mesh;
    cwi_shading_set_field(s, v, (v->slope < 0) != d->inside_is_low);
    const size_t bytes = mesh->vertex_count * 3 * sizeof *s->normals;
    s->normals = cwi_alloc_zeroed(mesh->vertex_count, 3 * sizeof *s->normals);
    if (!s->normals)
        return cwi_fail_memory(err);
    if (mesh->normals)
        memcpy(s->normals, mesh->normals, bytes);
    return CW_OK;
}

void cwi_shading_free(cwi_shading *s)
{
    cwi_free(s->normals);
    s->normals = NULL;
}

cw_status cwi_shading_finish(cwi_shading *s, cw_error *err)
{
    cw_mesh shaded = *s->mesh; /* so that a failure leaves the mesh as it was */
    shaded.normals = s->normals;
    cw_status st = cwi_repair_normals(&shaded, cwi_voxel_scale(&s->volume), err);
    if (st == CW_OK) {
        s->normals = s->mesh->normals;
        s->mesh->normals = shaded.normals;
    }
    return st;
}

cw_status cw_extract_normals(const cw_volume *volume, const cw_normals_desc *desc,
                             cw_mesh *mesh, cw_error *err)
{
    CWI_REQUIRE(err, volume, mesh);
    CWI_REQUIRE_VERSION(err, desc, 0);
    const cw_normals_desc d = desc ? *desc : (cw_normals_desc){0};
    cwi_shading s = {0};
    cw_status st = cwi_shading_init(&s, volume, &d, mesh, err);
    if (st == CW_OK)
        st = cwi_parallel_for((mesh->vertex_count + CHUNK - 1) / CHUNK, CHUNK, d.threads,
                              &d.progress, "shading", shade_chunk, &s, err);
    if (st == CW_OK)
        st = cwi_shading_finish(&s, err);
    cwi_shading_free(&s);
    return st;
}
