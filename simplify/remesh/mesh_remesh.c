/* Remeshes a surface: checks what is asked for, repeats the passes, proves the result, and counts. */
#include "core/mesh/mesh.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/mesh/attribute_transfer.h"
#include "simplify/remesh/remesh_state.h"

#include <cubewright/quality.h>

#include <float.h>
#include <string.h>

enum { DEFAULT_ITERATIONS = 5, ATTEMPTS = 8 };

static const double ERRORS = 10,
                    SHORTEST = 10; /* the edge is divided by these for the defaults */
static const double DEFAULT_FEATURE = 40, LARGEST_ANGLE = 40; /* degrees */

/* Lengths of edges, in wanted ones, that count as fitting. */
static const double MIN_FIT = 0.8, MAX_FIT = 1.33;

/* --- what is asked for -------------------------------------------------------------------- */

static cw_status check_number(double value, double max_value, const char *name, cw_error *err)
{
    if (value >= 0 && value <= max_value)
        return CW_OK;
    return max_value < DBL_MAX
               ? cwi_fail(err, CW_ERR_ARGUMENT, "%s is %g; it must be 0 to %g", name, value,
                          max_value)
               : cwi_fail(err, CW_ERR_ARGUMENT, "%s is %g; it must be finite, and 0 or more",
                          name, value);
}

static cw_status check_desc(const cw_remesh_desc *d, cw_error *err)
{
    cw_status st = CW_OK;
    if (!(d->edge_mm > 0) || !(d->edge_mm <= DBL_MAX))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "edge_mm is %g; it must be finite, and above 0",
                      d->edge_mm);
    if (st == CW_OK)
        st = check_number(d->shortest_mm, d->edge_mm, "shortest_mm", err);
    if (st == CW_OK)
        st = check_number(d->error_mm, DBL_MAX, "error_mm", err);
    if (st == CW_OK)
        st = check_number(d->feature_deg, 180, "feature_deg", err);
    if (st == CW_OK)
        st = check_number(d->min_angle_deg, LARGEST_ANGLE, "min_angle_deg", err);
    if (st == CW_OK && d->shortest_mm > 0 && !d->is_adaptive)
        st = cwi_fail(err, CW_ERR_ARGUMENT, "shortest_mm is for is_adaptive");
    if (st == CW_OK && d->iterations > CW_REMESH_MAX_ITERATIONS)
        st = cwi_fail(err, CW_ERR_ARGUMENT, "iterations is %zu; it must be at most %zu",
                      d->iterations, CW_REMESH_MAX_ITERATIONS);
    return st;
}

static double measure_area(const cw_mesh *m)
{
    double sum = 0;
    for (size_t t = 0; t < m->triangle_count; t++) {
        double normal[3];
        const uint32_t *v = m->triangles + 3 * t;
        cwi_largest_cosine(m->positions + 3 * (size_t)v[0], m->positions + 3 * (size_t)v[1],
                           m->positions + 3 * (size_t)v[2], normal);
        sum += cwi_length(normal) / 2;
    }
    return sum;
}

/* Refuses what would need too many triangles, or finer positions than single precision has. */
static cw_status check_size(const cw_mesh *m, const cw_remesh_desc *d, cw_error *err)
{
    double largest = 0;
    for (size_t n = 0; n < 3 * m->vertex_count; n++)
        largest = cwi_greater(largest, fabs((double)m->positions[n]));
    const double shortest = d->is_adaptive ? d->shortest_mm : d->edge_mm;
    if (!(shortest > largest * 0x1p-16))
        return cwi_fail(err, CW_ERR_LIMIT,
                        "edges of %g mm are too short for positions up to %g mm in single "
                        "precision; expected %g mm or more",
                        shortest, largest, largest * 0x1p-16);
    const double expected = measure_area(m) / (sqrt(0.1875) * d->edge_mm * d->edge_mm);
    return expected > (double)CWI_MAX_TRIANGLES
               ? cwi_fail(err, CW_ERR_LIMIT,
                          "edges of %g mm need about %.3g triangles; at most %zu are made",
                          d->edge_mm, expected, CWI_MAX_TRIANGLES)
               : CW_OK;
}

static cw_status resolve_desc(const cw_mesh *mesh, const cw_remesh_desc *desc,
                              cw_remesh_desc *d, cw_error *err)
{
    *d = *desc;
    cw_status st = check_desc(d, err);
    if (st == CW_OK)
        st = cwi_mesh_check_size(mesh, "remeshed", err);
    if (st != CW_OK)
        return st;
    if (!mesh->triangle_count)
        return cwi_fail(err, CW_ERR_EMPTY, "the mesh has no triangles to remesh");
    d->error_mm = d->error_mm > 0 ? d->error_mm : d->edge_mm / ERRORS;
    d->feature_deg = d->feature_deg > 0 ? d->feature_deg : DEFAULT_FEATURE;
    d->iterations = d->iterations ? d->iterations : DEFAULT_ITERATIONS;
    if (d->is_adaptive && !(d->shortest_mm > 0))
        d->shortest_mm = d->edge_mm / SHORTEST;
    return check_size(mesh, d, err);
}

/* --- facts -------------------------------------------------------------------------------- */

static void count_sharp(const cwi_remesh *r, size_t *features, size_t *border)
{
    *features = *border = 0;
    for (uint32_t c = 0; c < 3 * r->triangle_count; c++) {
        if (cwi_is_dead(r, c / 3) || !cwi_is_sharp(r, c))
            continue;
        *border += r->twin[c] == CWI_NONE;
        *features += r->twin[c] != CWI_NONE && r->twin[c] > c;
    }
}

static void measure_edges(const cwi_remesh *r, cw_remesh_facts *f)
{
    size_t count = 0, fitting = 0;
    double sum = 0;
    f->min_edge_mm = INFINITY;
    f->max_edge_mm = 0;
    for (uint32_t c = 0; c < 3 * r->triangle_count; c++) {
        if (cwi_is_dead(r, c / 3) || (r->twin[c] != CWI_NONE && r->twin[c] < c))
            continue;
        const uint32_t a = r->triangles[c], b = r->triangles[cwi_corner_next(c)];
        const double length = sqrt(cwi_point_distance_sq(r->positions + 3 * (size_t)a,
                                                         r->positions + 3 * (size_t)b)),
                     relative = cwi_relative_length(r, a, b);
        f->min_edge_mm = cwi_lesser(f->min_edge_mm, length);
        f->max_edge_mm = cwi_greater(f->max_edge_mm, length);
        sum += length;
        count++;
        fitting += relative >= MIN_FIT && relative <= MAX_FIT;
    }
    f->mean_edge_mm = sum / (double)count;
    f->fitting_edges = (double)fitting / (double)count;
}

/* Returns the angle at a corner in degrees. */
static double angle_at(const cw_mesh *m, size_t t, size_t corner)
{
    double to[2][3], cross[3];
    for (size_t k = 0; k < 2; k++)
        cwi_sub_points(cwi_mesh_point(m, t, (corner + 1 + k) % 3), cwi_mesh_point(m, t, corner),
                       to[k]);
    cwi_cross(to[0], to[1], cross);
    return atan2(cwi_length(cross), cwi_dot(to[0], to[1])) * 180 / CWI_PI;
}

static void measure_angles(const cw_mesh *m, cw_remesh_facts *f)
{
    f->smallest_deg = 180;
    f->below = 0;
    for (size_t t = 0; t < m->triangle_count; t++) {
        double smallest = 180;
        for (size_t c = 0; c < 3; c++) {
            const double angle = angle_at(m, t, c);
            smallest = cwi_lesser(smallest, angle);
            if (!(angle < f->smallest_deg))
                continue;
            f->smallest_deg = angle;
            cwi_mesh_world(m, m->triangles[3 * t + c], f->where);
        }
        f->below += smallest < f->min_angle_deg;
    }
}

/* --- work --------------------------------------------------------------------------------- */

static cw_status run_passes(cwi_remesh *r, double from, double fraction, cw_error *err)
{
    cw_status st = CW_OK;
    cwi_remesh_restart(r);
    const size_t steps = r->desc.iterations + 1;
    for (size_t n = 0; n < r->desc.iterations && st == CW_OK; n++) {
        r->done = from + fraction * (double)n / (double)steps;
        st = cwi_split_long(r, err);
        if (st == CW_OK)
            st = cwi_collapse_short(r, err);
        if (st != CW_OK)
            break;
        cwi_flip_edges(r, false);
        st = cwi_relax_vertices(r, err);
    }
    if (st != CW_OK)
        return st;
    r->done = from + fraction * (double)r->desc.iterations / (double)steps;
    cwi_flip_edges(r, true);
    st = cwi_relax_vertices(r, err);
    if (st == CW_OK)
        cwi_flip_edges(r, true);
    if (st == CW_OK && r->desc.min_angle_deg > 0)
        st = cwi_improve_angles(r, err);
    return st;
}

/* Copies the mesh at work without what is dead. */
static cw_status make_result(const cwi_remesh *r, cw_mesh *out, cw_error *err)
{
    size_t vertices = 0, triangles = 0;
    for (size_t v = 0; v < r->vertex_count; v++)
        vertices += r->corner[v] != CWI_NONE;
    for (size_t t = 0; t < r->triangle_count; t++)
        triangles += !cwi_is_dead(r, t);
    cw_mesh_free(out);
    uint32_t *numbers = cwi_alloc_array(r->vertex_count, sizeof *numbers);
    cw_status st =
        numbers ? cwi_mesh_alloc(out, vertices, triangles, false, err) : cwi_fail_memory(err);
    size_t n = 0;
    for (size_t v = 0; v < r->vertex_count && st == CW_OK; v++) {
        if (r->corner[v] == CWI_NONE)
            continue;
        numbers[v] = (uint32_t)n;
        memcpy(out->positions + 3 * n++, r->positions + 3 * v, 3 * sizeof *out->positions);
    }
    n = 0;
    for (size_t t = 0; t < r->triangle_count && st == CW_OK; t++)
        for (size_t k = 0; k < 3 && !cwi_is_dead(r, t); k++)
            out->triangles[n++] = numbers[r->triangles[3 * t + k]];
    memcpy(out->origin, r->input->origin, sizeof out->origin);
    memcpy(out->affine, r->input->affine, sizeof out->affine);
    cwi_free(numbers);
    return st;
}

static cw_status count_input(cwi_remesh *r, cw_remesh_facts *f, cw_error *err)
{
    const cw_crossings_desc desc = {.threads = r->desc.threads};
    cw_crossings found = {0};
    *f = (cw_remesh_facts){.edge_mm = r->desc.edge_mm,
                           .shortest_mm = r->desc.shortest_mm,
                           .error_mm = r->desc.error_mm,
                           .feature_deg = r->desc.feature_deg,
                           .min_angle_deg = r->desc.min_angle_deg,
                           .iterations = r->desc.iterations,
                           .triangles_before = r->input->triangle_count};
    count_sharp(r, &f->features_before, &f->border_before);
    cw_status st = cw_self_intersections(r->input, &desc, &found, err);
    f->crossings_before = found.count;
    f->is_undecided = found.undecided;
    cw_crossings_free(&found);
    return st;
}

static cw_status make_attempts(cwi_remesh *r, cw_mesh *out, cw_remesh_facts *f, cw_error *err)
{
    bool is_good = false, is_stuck = false;
    double from = 0.1, fraction = 0.45;
    cw_status st = CW_OK;
    for (int n = 0; n < ATTEMPTS && !is_good && !is_stuck && st == CW_OK; n++) {
        const size_t crossings = f->crossings_after;
        st = run_passes(r, from, fraction, err);
        if (st == CW_OK)
            st = make_result(r, out, err);
        if (st == CW_OK)
            st = cwi_remesh_prove(r, out, f, &is_good, err);
        f->attempts++;
        /* triangles that met before are smaller now, and meet more of the others, whatever stays in place */
        is_stuck = f->crossings_before && n > 0 && f->crossings_after >= crossings;
        from += fraction;
        fraction /= 2;
    }
    return st;
}

/* Copies the attributes of the closest points, and computes normals. */
static cw_status finish_result(const cwi_remesh *r, const cw_mesh *mesh, cw_mesh *out,
                               cw_error *err)
{
    cw_mesh from = *r->input;
    from.normals = NULL;
    const cw_progress none = {0};
    cw_status st = cwi_carry(&from, NULL, r->desc.threads, &none, out, err);
    return st == CW_OK && mesh->normals ? cw_mesh_normals(out, err) : st;
}

/* Copies the mesh if it has vertices without triangles, which are left out. */
static cw_status drop_loose_vertices(const cw_mesh *mesh, cw_mesh *copy, cw_error *err)
{
    bool *marked = cwi_alloc_zeroed(mesh->vertex_count + mesh->triangle_count, sizeof *marked);
    if (!marked)
        return cwi_fail_memory(err);
    size_t used = 0;
    for (size_t n = 0; n < 3 * mesh->triangle_count; n++) {
        used += !marked[mesh->triangles[n]];
        marked[mesh->triangles[n]] = true;
    }
    cw_status st = CW_OK;
    if (used < mesh->vertex_count) {
        memset(marked, 0, mesh->triangle_count * sizeof *marked);
        st = cwi_mesh_copy(mesh, copy, err);
        if (st == CW_OK)
            st = cwi_mesh_drop_marked(copy, marked, err);
    }
    cwi_free(marked);
    return st;
}

static cw_status remesh_input(cwi_remesh *r, const cw_mesh *mesh, cw_mesh *out,
                              cw_remesh_facts *f, cw_error *err)
{
    cw_mesh compact = {0};
    cw_status st = cwi_progress(&r->desc.progress, "remesh", 0, err);
    if (st == CW_OK)
        st = drop_loose_vertices(mesh, &compact, err);
    r->input = compact.vertex_count ? &compact : mesh;
    if (st == CW_OK)
        st = cwi_remesh_begin(r, err);
    if (st == CW_OK && r->desc.is_adaptive)
        st = cwi_remesh_size(r, err);
    if (st == CW_OK)
        st = count_input(r, f, err);
    if (st == CW_OK)
        st = make_attempts(r, out, f, err);
    if (st == CW_OK) {
        f->triangles_after = out->triangle_count;
        count_sharp(r, &f->features_after, &f->border_after);
        measure_edges(r, f);
        measure_angles(out, f);
        st = finish_result(r, mesh, out, err);
    }
    cw_mesh_free(&compact);
    return st == CW_OK ? cwi_progress(&r->desc.progress, "remesh", 1, err) : st;
}

cw_status cw_mesh_remesh(const cw_mesh *mesh, const cw_remesh_desc *desc, cw_mesh *out,
                         cw_remesh_facts *facts, cw_error *err)
{
    CWI_REQUIRE(err, mesh, desc, out);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cwi_remesh r = {.input = mesh};
    cw_remesh_facts found = {0};
    *out = (cw_mesh){0};
    cw_status st = resolve_desc(mesh, desc, &r.desc, err);
    if (st == CW_OK)
        st = remesh_input(&r, mesh, out, &found, err);
    if (facts)
        *facts = st == CW_OK ? found : (cw_remesh_facts){0};
    if (st != CW_OK)
        cw_mesh_free(out);
    cwi_remesh_free(&r);
    return st;
}
