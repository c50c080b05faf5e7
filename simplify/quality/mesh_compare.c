/* Meshes compared both ways, part by part. */
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh_triangle.h"

#include <cubewright/distance.h>

#include <math.h>

static double area_of(const cw_mesh *m)
{
    double sum = 0;
    for (size_t t = 0; t < m->triangle_count; t++)
        sum += cwi_mesh_area(m, t);
    return sum;
}

static double blend_by_area(double a, double area_a, double b, double area_b)
{
    return area_a + area_b > 0 ? (a * area_a + b * area_b) / (area_a + area_b) : 0;
}

/* Adds the distances of one more part. Means are by area; the larger 99th percentile bounds
 * that of both. */
static void add_distance(cw_distance *sum, double area_sum, const cw_distance *d, double area)
{
    const cw_distance was = *sum;
    if (d->max_mm > was.max_mm || was.samples == 0)
        *sum = *d;
    const double mean_sq =
        blend_by_area(was.rms_mm * was.rms_mm, area_sum, d->rms_mm * d->rms_mm, area);
    sum->max_mm = fmax(was.max_mm, d->max_mm);
    sum->rms_mm = sqrt(mean_sq);
    sum->mean_mm = blend_by_area(was.mean_mm, area_sum, d->mean_mm, area);
    sum->p99_mm = fmax(was.p99_mm, d->p99_mm);
    sum->bound_mm = fmax(was.bound_mm, d->bound_mm);
    sum->triangles = was.triangles + d->triangles;
    sum->samples = was.samples + d->samples;
    sum->missed = was.missed + d->missed;
}

cw_status cw_mesh_compare(const cw_mesh *mesh, const cw_mesh *reference,
                          const cw_mesh_distance_desc *desc, cw_mesh_comparison *comparison,
                          cw_error *err)
{
    CWI_REQUIRE(err, mesh, reference, comparison);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cw_distance to, from;
    if (desc && desc->worst)
        return cwi_fail(err, CW_ERR_ARGUMENT, "'worst' is of one mesh; two are measured");
    cw_status st = cw_distance_to_mesh(mesh, reference, desc, &to, NULL, err);
    if (st == CW_OK)
        st = cw_distance_to_mesh(reference, mesh, desc, &from, NULL, err);
    if (st != CW_OK)
        return st;
    const double area = area_of(mesh), reference_area = area_of(reference);
    add_distance(&comparison->to_reference, comparison->area_mm2, &to, area);
    add_distance(&comparison->from_reference, comparison->reference_area_mm2, &from,
                 reference_area);
    comparison->area_mm2 += area;
    comparison->reference_area_mm2 += reference_area;
    return CW_OK;
}

double cw_mesh_comparison_rms(const cw_mesh_comparison *comparison)
{
    if (!comparison)
        return NAN;
    const double to = comparison->to_reference.rms_mm, from = comparison->from_reference.rms_mm;
    return sqrt(0.5 * (to * to + from * from));
}

double cw_mesh_comparison_max(const cw_mesh_comparison *comparison)
{
    if (!comparison)
        return NAN;
    return fmax(comparison->to_reference.max_mm, comparison->from_reference.max_mm);
}
