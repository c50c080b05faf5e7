/* The distance of a mesh from the exact surface of an analytic field, which is not the surface
 * of the voxels that were sampled from it. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh_triangle.h"

#include <cubewright/field.h>

#include <math.h>

enum {
    NEWTON_STEPS = 12,
    BINS = 4096 /* of the histogram of distances, for the percentile */
};

static const double HISTOGRAM_VOXELS = 4; /* the distance that the last bin begins at */
static const double DEGREES = 180 / CWI_PI;

static double field_gradient(cw_field field, const double p[3], double h, double g[3])
{
    double gradient_sq = 0;
    for (int a = 0; a < 3; a++) {
        double low[3] = {p[0], p[1], p[2]}, high[3] = {p[0], p[1], p[2]};
        low[a] -= h;
        high[a] += h;
        g[a] = (cw_field_value(field, high) - cw_field_value(field, low)) / (2 * h);
        gradient_sq += g[a] * g[a];
    }
    return gradient_sq;
}

/* Walks to the surface by Newton's steps, none longer than a voxel, and leaves the last
 * gradient in g; NaN: it is not reached. */
static double walk_to_surface(cw_field field, double iso, double voxel_mm, const double from[3],
                              double g[3])
{
    double p[3] = {from[0], from[1], from[2]}, length = INFINITY;
    for (int n = 0; n < NEWTON_STEPS && length > 1e-7 * voxel_mm; n++) {
        const double off = iso - cw_field_value(field, p);
        const double gradient_sq = field_gradient(field, p, 1e-4 * voxel_mm, g);
        if (!(gradient_sq > 0))
            return NAN;
        length = fabs(off) / sqrt(gradient_sq);
        const double by = off / gradient_sq * (length > voxel_mm ? voxel_mm / length : 1);
        for (int a = 0; a < 3; a++)
            p[a] += by * g[a];
    }
    if (length > 1e-3 * voxel_mm)
        return NAN;
    return hypot(hypot(p[0] - from[0], p[1] - from[1]), p[2] - from[2]);
}

typedef struct sum {
    double max, gradient_sq, area;
    size_t samples, missed;
    double bins[BINS]; /* area by distance */
} sum;

static void add_distance(sum *s, double mm, double area, double voxel_mm)
{
    if (!isfinite(mm)) {
        s->missed++;
        return;
    }
    const double bin = mm / (HISTOGRAM_VOXELS * voxel_mm) * BINS;
    s->samples++;
    s->max = fmax(s->max, mm);
    s->gradient_sq += mm * mm * area;
    s->area += area;
    s->bins[bin < BINS - 1 ? (size_t)bin : BINS - 1] += area;
}

/* Adds the corners of a triangle and its middle, with the weights that integrate quadratic
 * functions exactly: 1/12 and 3/4. */
static void add_triangle(sum *s, cw_field field, double iso, double voxel_mm, const cw_mesh *m,
                         size_t t)
{
    double c[3][3], middle[3], normal[3], g[3];
    for (size_t n = 0; n < 3; n++)
        cwi_mesh_world(m, m->triangles[3 * t + n], c[n]);
    cwi_triangle_centroid(c[0], c[1], c[2], middle);
    cwi_triangle_normal(c[0], c[1], c[2], normal);
    const double area = 0.5 * hypot(hypot(normal[0], normal[1]), normal[2]);
    for (int n = 0; n < 3; n++)
        add_distance(s, walk_to_surface(field, iso, voxel_mm, c[n], g), area / 12, voxel_mm);
    add_distance(s, walk_to_surface(field, iso, voxel_mm, middle, g), area * 3 / 4, voxel_mm);
}

static double find_p99(const sum *s, double voxel_mm)
{
    double below = 0;
    size_t n = 0;
    while (n < BINS && (below += s->bins[n]) < 0.99 * s->area)
        n++;
    return fmin((double)(n + 1) / BINS * HISTOGRAM_VOXELS * voxel_mm, s->max);
}

static cw_status check_arguments(cw_field field, double isovalue, double voxel_mm,
                                 const cw_mesh *mesh, cw_error *err)
{
    if ((unsigned)field >= CW_FIELD_COUNT)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%d is not a field", (int)field);
    if (!isfinite(isovalue))
        return cwi_fail(err, CW_ERR_ARGUMENT, "isovalue %g; a finite one was expected",
                        isovalue);
    if (!(voxel_mm > 0 && isfinite(voxel_mm)))
        return cwi_fail(err, CW_ERR_ARGUMENT, "voxel_mm is %g; it must be above 0", voxel_mm);
    return cw_mesh_check(mesh, err);
}

cw_status cw_field_measure(cw_field field, double isovalue, double voxel_mm,
                           const cw_mesh *mesh, cw_field_error *out, cw_error *err)
{
    CWI_REQUIRE(err, mesh, out);
    *out = (cw_field_error){0};
    cw_status st = check_arguments(field, isovalue, voxel_mm, mesh, err);
    if (st != CW_OK)
        return st;
    sum *s = cwi_alloc_zeroed(1, sizeof *s);
    if (!s)
        return cwi_fail_memory(err);
    for (size_t t = 0; t < mesh->triangle_count; t++)
        add_triangle(s, field, isovalue, voxel_mm, mesh, t);
    out->samples = s->samples;
    out->missed = s->missed;
    if (s->area > 0) {
        out->max_mm = s->max;
        out->rms_mm = sqrt(s->gradient_sq / s->area);
        out->p99_mm = find_p99(s, voxel_mm);
    }
    cwi_free(s);
    return CW_OK;
}

/* The angle between two lines: which side normals point to is a convention. */
static double angle_deg(const float n[3], const double g[3])
{
    const double normal[3] = {(double)n[0], (double)n[1], (double)n[2]};
    double cross[3];
    cwi_cross(normal, g, cross);
    return atan2(cwi_length(cross), fabs(cwi_dot(normal, g))) * DEGREES;
}

cw_status cw_field_measure_vertices(cw_field field, double isovalue, double voxel_mm,
                                    const cw_mesh *mesh, size_t every,
                                    cw_field_vertex_error *out, cw_error *err)
{
    CWI_REQUIRE(err, mesh, out);
    cw_field_vertex_error e = {0};
    *out = e;
    cw_status st = check_arguments(field, isovalue, voxel_mm, mesh, err);
    if (st == CW_OK && every == 0)
        st = cwi_fail(err, CW_ERR_ARGUMENT, "every 0th vertex; 1 or more was expected");
    for (size_t v = 0; v < mesh->vertex_count && st == CW_OK; v += every) {
        double p[3], g[3];
        cwi_mesh_world(mesh, v, p);
        const double mm = walk_to_surface(field, isovalue, voxel_mm, p, g);
        if (isnan(mm)) {
            e.missed++;
            continue;
        }
        const double deg = mesh->normals ? angle_deg(mesh->normals + 3 * v, g) : 0;
        e.count++;
        e.mean_mm += (mm - e.mean_mm) / (double)e.count;
        e.max_mm = fmax(e.max_mm, mm);
        e.mean_deg += (deg - e.mean_deg) / (double)e.count;
        e.max_deg = fmax(e.max_deg, deg);
    }
    e.has_normals = mesh->normals && e.count;
    *out = e;
    return st;
}
