/* How far a mesh lies from the surface of a volume's trilinear field.
 *
 * The cells around a point are looked at shell by shell, nearest first, until none is left that
 * could hold anything nearer. The volume is thought to go on, beyond its border and in missing
 * voxels, with samples far outside: so the end of the data is surface where it is inside, and
 * closes it without cases of its own. */
#include <cubewright/distance.h>

#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/geometry/vec3.h"
#include "core/volume/volume.h"
#include "simplify/quality/surface_sampling.h"
#include "simplify/quality/trilinear_patch.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* How far outside a missing sample is, in the largest difference from the level around it. */
#define BEYOND 1e6

typedef struct field {
    cw_volume volume; /* resolved */
    cwi_metric metric;
    double to_index[12]; /* from points of the mesh, relative to its origin */
    double level, sign;  /* value - isovalue has the sign of sign * (voxel - level) */
    double missing;      /* 1 or -1: the side of missing samples */
    bool open;
    long first, last[3]; /* cells: from first along each axis */
    double reach;
} field;

/* The cells that are still worth looking at. */
typedef struct range {
    long low[3], high[3];
} range;

/* A sample less the level; NaN where there is none. */
static double sample_voxel(const field *f, const void *voxel)
{
    const cw_volume *v = &f->volume;
    const double x = cwi_voxel_at(v->type, voxel);
    return v->has_nodata && x == v->nodata ? NAN : f->sign * (x - f->level);
}

static void read_corners(const field *f, const long at[3], double d[8])
{
    const cw_volume *v = &f->volume;
    for (int n = 0; n < 8; n++) {
        const size_t i = (size_t)(at[0] + (n & 1)), j = (size_t)(at[1] + (n >> 1 & 1)),
                     k = (size_t)(at[2] + (n >> 2)); /* before the first: very large */
        const bool there = i < v->dim[0] && j < v->dim[1] && k < v->dim[2];
        d[n] = there ? sample_voxel(f, cwi_voxel_address(v, i, j, k)) : NAN;
    }
}

/* Whether there is surface between the corners of a cell. */
static bool is_crossed(const field *f, const double d[8])
{
    bool inside = false, outside = false, missing = false;
    for (int n = 0; n < 8; n++) {
        const bool in = isnan(d[n]) ? f->missing > 0 : d[n] >= 0;
        inside |= in;
        outside |= !in;
        missing |= isnan(d[n]);
    }
    return inside && outside && !(missing && f->open);
}

/* Scales the corners; missing and infinite ones become large finite numbers. */
static void make_patch(const field *f, double d[8], cwi_patch *patch)
{
    double max_distance = 0;
    bool wild = false;
    for (int n = 0; n < 8; n++)
        if (isfinite(d[n]))
            max_distance = cwi_greater(max_distance, fabs(d[n]));
        else
            wild = true;
    const double scale = (max_distance > 0 ? 1 / max_distance : 1) / (wild ? BEYOND : 1);
    for (int n = 0; n < 8; n++)
        d[n] = isfinite(d[n]) ? d[n] * scale : isnan(d[n]) ? f->missing : copysign(1, d[n]);
    cwi_patch_init(patch, d);
}

/* Looks for something nearer in a cell, unless all of the cell is farther. */
static void visit_cell(const field *f, const double u[3], const long at[3], double *distance)
{
    double d[8], local[3];
    for (int a = 0; a < 3; a++) {
        const double width = *distance * f->metric.width[a];
        local[a] = u[a] - (double)at[a];
        if (local[a] < -width || local[a] > 1 + width)
            return;
    }
    read_corners(f, at, d);
    if (!is_crossed(f, d))
        return;
    cwi_patch patch;
    make_patch(f, d, &patch);
    cwi_patch_nearest(&patch, &f->metric, local, distance);
}

static long clamp_long(double x, long low, long high)
{
    return x < (double)low ? low : x > (double)high ? high : (long)floor(x);
}

/* The cells that a ball of this radius, less the slack, meets; false when there are none. */
static bool find_range(const field *f, const double u[3], double distance, range *r)
{
    distance -= cwi_slack(&f->metric, distance);
    for (int a = 0; a < 3; a++) {
        const double low = u[a] - distance * f->metric.width[a],
                     high = u[a] + distance * f->metric.width[a];
        if (!(high > low) || low > (double)f->last[a] + 1 || high < (double)f->first)
            return false;
        r->low[a] = clamp_long(low, f->first, f->last[a]);
        r->high[a] = clamp_long(high, f->first, f->last[a]);
    }
    return true;
}

static long farthest_shell(const range *r, const long home[3])
{
    long max_distance = 0;
    for (int a = 0; a < 3; a++) {
        const long low = home[a] - r->low[a], high = r->high[a] - home[a];
        max_distance = low > max_distance ? low : max_distance;
        max_distance = high > max_distance ? high : max_distance;
    }
    return max_distance;
}

/* The cells at index distance n >= 1 from home, inside the range. */
static void visit_shell(const field *f, const double u[3], const long home[3], long n,
                        const range *r, double *distance)
{
    long at[3];
    for (at[2] = r->low[2]; at[2] <= r->high[2]; at[2]++) {
        const bool end_z = labs(at[2] - home[2]) == n;
        if (labs(at[2] - home[2]) > n)
            continue;
        for (at[1] = r->low[1]; at[1] <= r->high[1]; at[1]++) {
            if (labs(at[1] - home[1]) > n)
                continue;
            const bool whole = end_z || labs(at[1] - home[1]) == n;
            for (long i = -n; i <= n; i += whole ? 1 : 2 * n) {
                at[0] = home[0] + i;
                if (at[0] >= r->low[0] && at[0] <= r->high[0])
                    visit_cell(f, u, at, distance);
            }
        }
    }
}

/* The cell a point is in: looks for surface there, and tells whether the point is outside the
 * solid; so is whatever is beyond the data. */
static bool visit_home(const field *f, const double u[3], const long home[3], double *distance)
{
    double d[8], local[3];
    bool missing = false, beyond = false;
    cwi_patch patch;
    read_corners(f, home, d);
    for (int n = 0; n < 8; n++)
        missing |= isnan(d[n]);
    for (int a = 0; a < 3; a++) {
        local[a] = u[a] - (double)home[a];
        beyond |= u[a] < 0 || u[a] > (double)f->volume.dim[a] - 1;
    }
    const bool crossed = is_crossed(f, d);
    make_patch(f, d, &patch);
    if (crossed)
        cwi_patch_nearest(&patch, &f->metric, local, distance);
    const double value = cwi_patch_value(&patch, local);
    return beyond || (missing && f->open) || (f->missing < 0 ? value < 0 : value >= 0);
}

static double measure_point(const void *context, const double point[3], uint32_t *hint,
                            bool *missed)
{
    (void)hint;
    const field *f = context;
    double u[3], distance = f->reach;
    long home[3];
    range r;
    cwi_affine_apply(f->to_index, point, u);
    for (int a = 0; a < 3; a++)
        home[a] = clamp_long(u[a], f->first, f->last[a]);
    const bool outside = visit_home(f, u, home, &distance);
    for (long n = 1; find_range(f, u, distance, &r) && n <= farthest_shell(&r, home); n++)
        visit_shell(f, u, home, n, &r, &distance);
    *missed = distance == f->reach;
    return outside ? distance : -distance;
}

static cw_status check_desc(const cw_field_distance_desc *d, cw_error *err)
{
    if (!isfinite(d->isovalue))
        return cwi_fail(err, CW_ERR_ARGUMENT, "isovalue is %g; a finite number was expected",
                        d->isovalue);
    if (!(d->reach_mm >= 0) || !isfinite(d->reach_mm))
        return cwi_fail(err, CW_ERR_ARGUMENT, "reach_mm is %g; 0 or a length was expected",
                        d->reach_mm);
    if (!(d->step_voxels >= 0) || !isfinite(d->step_voxels))
        return cwi_fail(err, CW_ERR_ARGUMENT, "step_voxels is %g; 0 or a length was expected",
                        d->step_voxels);
    return CW_OK;
}

/* The map from points of the mesh to indices; and what takes its sides to steps. */
static void set_frame(field *f, const double origin[3], double step, double to_steps[3][3])
{
    const double *a = f->volume.affine[0];
    const double determinant = cwi_affine_determinant(a);
    double c[3][3];
    cwi_affine_cofactor(a, c);
    for (int r = 0; r < 3; r++) {
        f->to_index[4 * r + 3] = 0;
        for (int s = 0; s < 3; s++) {
            f->to_index[4 * r + s] = c[s][r] / determinant;
            to_steps[r][s] = f->to_index[4 * r + s] / step;
            f->to_index[4 * r + 3] += f->to_index[4 * r + s] * (origin[s] - a[4 * s + 3]);
        }
    }
    cwi_metric_init(&f->metric, a);
}

static cw_status make_field(field *f, const cw_volume *volume, const cw_field_distance_desc *d,
                            cw_error *err)
{
    cw_status st = cw_volume_resolve(volume, &f->volume, err);
    if (st == CW_OK)
        st = cwi_volume_expect_even(&f->volume, "the distance to a field", err);
    for (int a = 0; a < 3 && st == CW_OK; a++)
        if (f->volume.dim[a] < 2)
            st =
                cwi_fail(err, CW_ERR_ARGUMENT,
                         "the volume has one voxel along axis %d; at least 2 were expected", a);
    if (st != CW_OK)
        return st;
    f->level = (d->isovalue - f->volume.intercept) / f->volume.slope;
    if (!isfinite(f->level))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "isovalue %g is not finite after slope %g and intercept %g",
                        d->isovalue, f->volume.slope, f->volume.intercept);
    f->sign = f->volume.slope < 0 ? -1 : 1;
    f->missing = d->inside_is_low ? 1 : -1;
    f->open = d->leave_open;
    f->first = d->leave_open ? 0 : -1;
    for (int a = 0; a < 3; a++)
        f->last[a] = (long)f->volume.dim[a] - (d->leave_open ? 2 : 1);
    return CW_OK;
}

cw_status cw_distance_to_field(const cw_mesh *mesh, const cw_volume *volume,
                               const cw_field_distance_desc *desc, cw_distance *out,
                               float *per_vertex, cw_error *err)
{
    CWI_REQUIRE(err, mesh, volume, out);
    CWI_REQUIRE_VERSION(err, desc, 0);
    const cw_field_distance_desc none = {0}, *d = desc ? desc : &none;
    field f = {0};
    cwi_sampling sampling = {.mesh = mesh,
                             .measure = measure_point,
                             .context = &f,
                             .is_signed = true,
                             .worst = d->worst,
                             .name = "distances",
                             .threads = d->threads,
                             .progress = &d->progress};
    memset(out, 0, sizeof *out);
    cw_status st = cw_mesh_check(mesh, err);
    if (st == CW_OK)
        st = check_desc(d, err);
    if (st == CW_OK)
        st = make_field(&f, volume, d, err);
    if (st != CW_OK)
        return st;
    set_frame(&f, mesh->origin, d->step_voxels > 0 ? d->step_voxels : 1, sampling.step);
    f.reach = d->reach_mm > 0 ? d->reach_mm : 4 * f.metric.voxel;
    return cwi_sample_mesh(&sampling, out, per_vertex, err);
}
