#include "cli/results/mesh_comparison.h"

#include "cli/framework/console.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"

#include <math.h>
#include <string.h>

static double area_of(const cw_mesh *m)
{
    double sum = 0;
    for (size_t t = 0; t < m->triangle_count; t++) {
        const uint32_t *c = m->triangles + 3 * t;
        double u[3], v[3];
        for (size_t a = 0; a < 3; a++) {
            const double p = (double)m->positions[3 * (size_t)c[0] + a];
            u[a] = (double)m->positions[3 * (size_t)c[1] + a] - p;
            v[a] = (double)m->positions[3 * (size_t)c[2] + a] - p;
        }
        const double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2],
                     z = u[0] * v[1] - u[1] * v[0];
        sum += 0.5 * sqrt(x * x + y * y + z * z);
    }
    return sum;
}

static double blend_by_area(double a, double area_a, double b, double area_b)
{
    return area_a + area_b > 0 ? (a * area_a + b * area_b) / (area_a + area_b) : 0;
}

/* Means are by area; of the 99th percentile the larger one is a bound for all. */
static void add_distance(cw_distance *sum, double area_sum, const cw_distance *d, double area)
{
    const cw_distance was = *sum;
    if (d->max_mm > was.max_mm || was.samples == 0)
        *sum = *d;
    const double square =
        blend_by_area(was.rms_mm * was.rms_mm, area_sum, d->rms_mm * d->rms_mm, area);
    sum->max_mm = fmax(was.max_mm, d->max_mm);
    sum->rms_mm = sqrt(square);
    sum->mean_mm = blend_by_area(was.mean_mm, area_sum, d->mean_mm, area);
    sum->p99_mm = fmax(was.p99_mm, d->p99_mm);
    sum->bound_mm = fmax(was.bound_mm, d->bound_mm);
    sum->triangles = was.triangles + d->triangles;
    sum->samples = was.samples + d->samples;
    sum->missed = was.missed + d->missed;
}

cw_status cli_compare(const cw_mesh *mesh, const cw_mesh *input, double tolerance_mm,
                      int threads, cli_comparison *sum, double area_mm2[2], cw_error *err)
{
    const cw_mesh_distance_desc desc = {
        .tolerance_mm = tolerance_mm,
        .threads = threads,
        .progress = cli_progress((double)input->triangle_count / 1e6, "Mtriangle")};
    cw_distance to, from;
    cw_status st = cw_distance_to_mesh(mesh, input, &desc, &to, NULL, err);
    if (st == CW_OK)
        st = cw_distance_to_mesh(input, mesh, &desc, &from, NULL, err);
    if (st != CW_OK)
        return st;
    const double area[2] = {area_of(mesh), area_of(input)};
    add_distance(&sum->to_input, area_mm2[0], &to, area[0]);
    add_distance(&sum->from_input, area_mm2[1], &from, area[1]);
    area_mm2[0] += area[0];
    area_mm2[1] += area[1];
    sum->made = true;
    return CW_OK;
}

cw_status cli_compare_with_field(const cw_mesh *mesh, const cli_volume *volume, double iso,
                                 bool inside_is_low, int threads, cli_comparison *c,
                                 cw_error *err)
{
    const cw_field_distance_desc desc = {
        .isovalue = iso,
        .inside_is_low = inside_is_low,
        .threads = threads,
        .progress = cli_progress((double)mesh->triangle_count / 1e6, "Mtriangle")};
    cw_distance d;
    cw_status st = cw_distance_to_field(mesh, &volume->view, &desc, &d, NULL, err);
    if (st == CW_OK && (!c->has_field || d.max_mm > c->to_field.max_mm))
        c->to_field = d;
    c->has_field = st == CW_OK;
    return st;
}

double cli_both_rms(const cli_comparison *c)
{
    const double to = c->to_input.rms_mm, from = c->from_input.rms_mm;
    return sqrt(0.5 * (to * to + from * from));
}

cw_status cli_hold_to_topology(const cw_quality *before, const cw_quality *after, cw_error *err)
{
    const struct {
        const char *what;
        long long before, after;
        bool fewer; /* is as good */
    } facts[] = {
        {"components", (long long)before->components, (long long)after->components, false},
        {"Euler number", before->euler, after->euler, false},
        {"border loops", (long long)before->border_loops, (long long)after->border_loops,
         false},
        {"non-manifold edges", (long long)before->nonmanifold_edges,
         (long long)after->nonmanifold_edges, true},
        {"non-manifold vertices", (long long)before->nonmanifold_vertices,
         (long long)after->nonmanifold_vertices, true},
        {"triangles without area", (long long)before->degenerate, (long long)after->degenerate,
         true},
    };
    for (size_t n = 0; n < sizeof facts / sizeof *facts; n++)
        if (facts[n].after != facts[n].before &&
            !(facts[n].fewer && facts[n].after < facts[n].before))
            return cw_fail(err, CW_ERR_CHECK, "not as promised: %s: %lld before, %lld after",
                           facts[n].what, facts[n].before, facts[n].after);
    return CW_OK;
}

cw_status cli_check_place(const cli_volume *volume, const cw_mesh *mesh, cw_error *err)
{
    const cw_volume *v = &volume->view;
    double low[3], high[3], from[3] = {INFINITY, INFINITY, INFINITY},
                            to[3] = {-INFINITY, -INFINITY, -INFINITY};
    cw_mesh_bounds(mesh, low, high);
    if (v->cells) {
        memcpy(from, volume->grid.low, sizeof from);
        memcpy(to, volume->grid.high, sizeof to);
    }
    for (int corner = 0; corner < 8 && !v->cells; corner++) {
        double index[3], p[3];
        for (int a = 0; a < 3; a++)
            index[a] = corner >> a & 1 ? (double)(v->dim[a] - 1) : 0;
        cw_volume_to_world(v, index, p);
        for (int a = 0; a < 3; a++) {
            from[a] = fmin(from[a], p[a]);
            to[a] = fmax(to[a], p[a]);
        }
    }
    for (int a = 0; a < 3; a++)
        if (low[a] > to[a] || high[a] < from[a])
            return cw_fail(err, CW_ERR_ARGUMENT,
                           "%s: the mesh is not in this volume: along %c it is at %g to %g mm, "
                           "the volume at %g to %g",
                           volume->path, "xyz"[a], low[a], high[a], from[a], to[a]);
    return CW_OK;
}
