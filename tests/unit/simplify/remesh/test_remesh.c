/* Remeshing: edges of the wanted length, the same surface, features and borders, and honest facts. */
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/mesh/mesh.h"

#include <cubewright/distance.h>
#include <cubewright/remesh.h>

#include <math.h>
#include <string.h>

static cw_mesh extract_field(cw_field field, size_t n, bool open)
{
    cw_volume volume = test_sample(field, n, CW_F32);
    cw_mesh mesh = test_extract(&volume, &(cw_extract_desc){.leave_open = open}, NULL);
    cw_volume_free(&volume);
    return mesh;
}

/* Holds a result to everything that is promised of it, but for the length of edges. */
static void check_result(const cw_mesh *in, const cw_mesh *out, const cw_remesh_facts *f)
{
    cw_error err = {0};
    cw_quality before = test_measure(in), after = test_measure(out);
    cw_distance to, from;
    assert_ok(cw_quality_compare(&before, &after, &err), err);
    assert_int_equal(after.degenerate, 0);
    assert_int_equal(test_count_crossings(out), f->crossings_after);
    assert_true(f->crossings_after <= f->crossings_before);
    assert_int_equal(f->beyond, 0);
    assert_ok(cw_distance_to_mesh(out, in, NULL, &to, NULL, &err), err);
    assert_ok(cw_distance_to_mesh(in, out, NULL, &from, NULL, &err), err);
    assert_true(to.max_mm <= f->error_mm * (1 + 1e-6));
    assert_true(from.max_mm <= f->error_mm * (1 + 1e-6));
    assert_int_equal(f->triangles_before, in->triangle_count);
    assert_int_equal(f->triangles_after, out->triangle_count);
    assert_true(f->min_edge_mm <= f->mean_edge_mm && f->mean_edge_mm <= f->max_edge_mm);
}

static cw_mesh remesh_mesh(const cw_mesh *in, const cw_remesh_desc *desc, cw_remesh_facts *f)
{
    cw_mesh out = {0};
    cw_error err = {0};
    assert_ok(cw_mesh_remesh(in, desc, &out, f, &err), err);
    check_result(in, &out, f);
    return out;
}

/* Smooth surfaces with the needles of marching cubes, from a third to three times their edges. */
static void edges_get_the_wanted_length(void **state)
{
    (void)state;
    static const cw_field fields[] = {CW_FIELD_SPHERE, CW_FIELD_TORUS};
    static const double edges[] = {1.5, 2.5, 4};
    for (size_t n = 0; n < 6; n++) {
        cw_mesh in = extract_field(fields[n / 3], 24, false);
        cw_remesh_facts f;
        cw_mesh out = remesh_mesh(&in, &(cw_remesh_desc){.edge_mm = edges[n % 3]}, &f);
        assert_true(f.fitting_edges > 0.9);
        assert_near(f.mean_edge_mm / edges[n % 3], 1, 0.05);
        assert_true(f.smallest_deg > 25);
        assert_int_equal(f.features_after, 0);
        assert_true(f.attempts <= 3);
        cw_mesh_free(&in);
        cw_mesh_free(&out);
    }
}

/* All twelve edges of the cube are straight lines of vertices, and its corners are vertices. */
static void features_of_a_cube_are_exact(void **state)
{
    (void)state;
    cw_mesh in = {0};
    cw_remesh_facts f;
    test_make_cube(&in);
    double low[3], high[3];
    assert_true(cw_mesh_bounds(&in, low, high));
    const double side = high[0] - low[0];
    cw_mesh out =
        remesh_mesh(&in, &(cw_remesh_desc){.edge_mm = side / 8, .min_angle_deg = 25}, &f);
    assert_int_equal(f.features_before, 12);
    assert_int_equal(f.below, 0);
    size_t corners = 0, on_edges = 0;
    for (size_t v = 0; v < out.vertex_count; v++) {
        int ends = 0;
        for (size_t a = 0; a < 3; a++) {
            const double x = out.origin[a] + (double)out.positions[3 * v + a];
            ends += x == low[a] || x == high[a];
        }
        assert_true(ends > 0);
        corners += ends == 3;
        on_edges += ends == 2;
    }
    assert_int_equal(corners, 8);
    assert_int_equal(on_edges + 12, f.features_after);
    assert_true(f.features_after >= 72 && f.features_after <= 132);
    assert_within(test_measure(&out).volume_mm3, side * side * side, 1e-6);
    cw_mesh_free(&in);
    cw_mesh_free(&out);
}

/* A wavy sheet of n x n squares of a given side. */
static cw_mesh make_sheet(size_t n, double side)
{
    cw_mesh m = {0};
    assert_int_equal(cwi_mesh_alloc(&m, (n + 1) * (n + 1), 2 * n * n, false, NULL), CW_OK);
    for (size_t v = 0; v < m.vertex_count; v++) {
        const double x = (double)(v % (n + 1)), y = (double)(v / (n + 1));
        m.positions[3 * v] = (float)(side * x);
        m.positions[3 * v + 1] = (float)(side * y);
        m.positions[3 * v + 2] = (float)(2 * side * sin(x / 6) * cos(y / 8));
    }
    for (size_t q = 0; q < n * n; q++) {
        const uint32_t a = (uint32_t)(q / n * (n + 1) + q % n), b = a + 1,
                       c = (uint32_t)(a + n + 1), d = c + 1;
        memcpy(m.triangles + 6 * q, (uint32_t[]){a, b, d, a, d, c}, 6 * sizeof(uint32_t));
    }
    return m;
}

static void borders_stay_in_place(void **state)
{
    (void)state;
    cw_mesh in = make_sheet(32, 1);
    cw_remesh_facts f;
    cw_mesh out = remesh_mesh(&in, &(cw_remesh_desc){.edge_mm = 2}, &f);
    assert_int_equal(f.border_before, 128);
    assert_true(f.border_after > 50 && f.border_after < 90);
    assert_int_equal(f.features_after, 0);
    double low[2][3], high[2][3];
    assert_true(cw_mesh_bounds(&in, low[0], high[0]) && cw_mesh_bounds(&out, low[1], high[1]));
    for (int a = 0; a < 2; a++)
        assert_true(low[0][a] == low[1][a] && high[0][a] == high[1][a]);
    cw_mesh_free(&in);
    cw_mesh_free(&out);
    in = extract_field(CW_FIELD_GYROID, 24, true);
    out = remesh_mesh(&in, &(cw_remesh_desc){.edge_mm = 3}, &f);
    assert_true(f.border_after > 0 && f.border_after < f.border_before);
    cw_mesh_free(&in);
    cw_mesh_free(&out);
}

/* Caps beside the border of the volume have needles a thousandth of a voxel wide. */
static void small_angles_go_or_are_told(void **state)
{
    (void)state;
    cw_mesh in = extract_field(CW_FIELD_GYROID, 24, false);
    cw_remesh_facts fem;
    cw_mesh out = remesh_mesh(
        &in, &(cw_remesh_desc){.edge_mm = 2.5, .error_mm = 0.4, .min_angle_deg = 25}, &fem);
    assert_true(fem.below * 100 < out.triangle_count);
    double low[3], high[3];
    assert_true(cw_mesh_bounds(&out, low, high));
    for (int a = 0; a < 3; a++)
        assert_true(fem.where[a] >= low[a] - 1e-3 && fem.where[a] <= high[a] + 1e-3);
    cw_mesh_free(&in);
    cw_mesh_free(&out);
}

/* The torus is curved most around its tube, so edges there are shorter than wanted elsewhere. */
static void adaptive_edges_follow_curvature(void **state)
{
    (void)state;
    cw_mesh in = extract_field(CW_FIELD_TORUS, 32, false);
    cw_remesh_facts fine, coarse;
    cw_remesh_desc desc = {.edge_mm = 20, .error_mm = 0.1, .is_adaptive = true};
    cw_mesh out = remesh_mesh(&in, &desc, &fine);
    cw_mesh_free(&out);
    desc.error_mm = 0.4;
    out = remesh_mesh(&in, &desc, &coarse);
    assert_within(coarse.mean_edge_mm / fine.mean_edge_mm, 2, 0.15); /* the root of 4 */
    assert_true(fine.max_edge_mm < 10 && fine.shortest_mm == 2);
    cw_mesh_free(&in);
    cw_mesh_free(&out);
}

static void scale_mesh(cw_mesh *m, float scale)
{
    for (size_t n = 0; n < 3 * m->vertex_count; n++)
        m->positions[n] *= scale;
    for (int a = 0; a < 3; a++)
        m->origin[a] *= (double)scale;
}

/* Powers of two change no digit, so that the same triangles must come out. */
static void units_do_not_matter(void **state)
{
    (void)state;
    cw_mesh in = extract_field(CW_FIELD_TORUS, 24, false), out[3];
    const double scales[] = {1, 0x1p-14, 0x1p14};
    cw_remesh_facts f;
    for (int n = 0; n < 3; n++) {
        scale_mesh(&in, (float)scales[n]);
        out[n] = remesh_mesh(&in, &(cw_remesh_desc){.edge_mm = 3 * scales[n]}, &f);
        scale_mesh(&in, (float)(1 / scales[n]));
        scale_mesh(&out[n], (float)(1 / scales[n]));
    }
    for (int n = 1; n < 3; n++) {
        test_assert_same_triangles(&out[0], &out[n]);
        cw_mesh_free(&out[n]);
    }
    cw_mesh_free(&out[0]);
    cw_mesh_free(&in);
}

static void threads_do_not_matter(void **state)
{
    (void)state;
    cw_mesh in = extract_field(CW_FIELD_GYROID, 16, false), out[2] = {0};
    cw_error err = {0};
    for (int n = 0; n < 2; n++) {
        const cw_remesh_desc desc = {
            .edge_mm = 4, .min_angle_deg = 25, .threads = 1 + 2 * n, .is_adaptive = true};
        assert_ok(cw_mesh_remesh(&in, &desc, &out[n], NULL, &err), err);
    }
    test_assert_same_mesh(&out[0], &out[1]);
    cw_mesh_free(&in);
    cw_mesh_free(&out[0]);
    cw_mesh_free(&out[1]);
}

/* The height is linear on each triangle of a flat sheet, so interpolation keeps it exactly. */
static void attributes_are_interpolated(void **state)
{
    (void)state;
    cw_mesh in = make_sheet(16, 1), out = {0};
    cw_error err = {0};
    for (size_t v = 0; v < in.vertex_count; v++)
        in.positions[3 * v + 2] = 0;
    in.scalars = cwi_alloc_array(in.vertex_count, sizeof *in.scalars);
    in.labels = cwi_alloc_array(in.vertex_count, sizeof *in.labels);
    assert_true(in.scalars && in.labels);
    for (size_t v = 0; v < in.vertex_count; v++) {
        in.scalars[v] = in.positions[3 * v] - 2 * in.positions[3 * v + 1];
        in.labels[v] = in.positions[3 * v] < 8 ? 7 : 9;
    }
    assert_ok(cw_mesh_normals(&in, &err), err);
    cw_remesh_facts f;
    out = remesh_mesh(&in, &(cw_remesh_desc){.edge_mm = 1.5}, &f);
    assert_true(out.normals && out.scalars && out.labels && !out.colors);
    for (size_t v = 0; v < out.vertex_count; v++) {
        const double x = (double)out.positions[3 * v], y = (double)out.positions[3 * v + 1];
        assert_near((double)out.scalars[v], x - 2 * y, 1e-4);
        assert_true(out.labels[v] == 7 || out.labels[v] == 9);
        assert_true(x > 8 || x < 7 ? out.labels[v] == (x < 7 ? 7 : 9) : true);
        assert_near((double)out.normals[3 * v + 2], 1, 1e-6);
    }
    cw_mesh_free(&in);
    cw_mesh_free(&out);
}

static void bad_arguments_are_named(void **state)
{
    (void)state;
    static const struct {
        cw_remesh_desc desc;
        cw_status status;
        const char *words;
    } rows[] = {
        {{0}, CW_ERR_ARGUMENT, "edge_mm is 0; it must be finite, and above 0"},
        {{.edge_mm = INFINITY}, CW_ERR_ARGUMENT, "edge_mm is inf"},
        {{.edge_mm = 1, .error_mm = -1}, CW_ERR_ARGUMENT, "error_mm is -1"},
        {{.edge_mm = 1, .feature_deg = 181},
         CW_ERR_ARGUMENT,
         "feature_deg is 181; it must be 0"},
        {{.edge_mm = 1, .min_angle_deg = 50}, CW_ERR_ARGUMENT, "min_angle_deg is 50"},
        {{.edge_mm = 1, .shortest_mm = 2}, CW_ERR_ARGUMENT, "shortest_mm is 2"},
        {{.edge_mm = 1, .shortest_mm = 0.5}, CW_ERR_ARGUMENT, "is for is_adaptive"},
        {{.edge_mm = 1, .iterations = 101}, CW_ERR_ARGUMENT, "iterations is 101"},
        {{.edge_mm = 1e-9}, CW_ERR_LIMIT, "too short for positions"},
        {{.edge_mm = 1e-3}, CW_ERR_LIMIT, "need about"},
    };
    cw_mesh in = make_sheet(32, 1), out = {0};
    cw_error err = {0};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        cw_status st = cw_mesh_remesh(&in, &rows[n].desc, &out, NULL, &err);
        assert_fails(st, rows[n].status, rows[n].words, err);
    }
    const cw_remesh_desc desc = {.edge_mm = 2};
    assert_fails(cw_mesh_remesh(&in, NULL, &out, NULL, &err), CW_ERR_ARGUMENT, "NULL", err);
    in.triangles[4] = in.triangles[3];
    assert_fails(cw_mesh_remesh(&in, &desc, &out, NULL, &err), CW_ERR_FORMAT,
                 "names a vertex twice", err);
    memcpy(in.triangles + 3, (uint32_t[]){0, 1, 34}, 12);
    assert_fails(cw_mesh_remesh(&in, &desc, &out, NULL, &err), CW_ERR_FORMAT, "repair it first",
                 err);
    in.triangle_count = 0;
    assert_fails(cw_mesh_remesh(&in, &desc, &out, NULL, &err), CW_ERR_EMPTY, "no triangles",
                 err);
    cw_mesh_free(&in);
}

typedef struct stopper {
    int calls, stop_at;
    double last;
    bool fell;
} stopper;

static bool count_calls(void *user, const char *step, double done)
{
    (void)step;
    stopper *s = user;
    s->fell = s->fell || done < s->last;
    s->last = done;
    return ++s->calls != s->stop_at;
}

static void failures_and_cancelling_leave_nothing(void **state)
{
    (void)state;
    cw_mesh in = make_sheet(5, 1), out = {0};
    cw_error err = {0};
    stopper s = {0};
    cw_remesh_desc desc = {.edge_mm = 0.7,
                           .min_angle_deg = 25,
                           .is_adaptive = true,
                           .threads = 1,
                           .iterations = 2,
                           .progress = {count_calls, &s}};
    for (int stop = 1;; stop++) {
        s = (stopper){.stop_at = stop};
        const cw_status st = cw_mesh_remesh(&in, &desc, &out, NULL, &err);
        if (st == CW_OK)
            break;
        assert_int_equal(st, CW_ERR_CANCELLED);
        assert_true(!out.positions && !out.triangles);
    }
    assert_true(s.calls > 5 && !s.fell && s.last == 1);
    desc.progress = (cw_progress){0};
    for (long n = 0;; n++) {
        cw_mesh_free(&out);
        cwi_alloc_fail_after(n);
        const cw_status st = cw_mesh_remesh(&in, &desc, &out, NULL, &err);
        if (!cwi_alloc_fail_after(-1)) {
            assert_ok(st, err);
            assert_true(n > 40);
            break;
        }
        assert_fails(st, CW_ERR_NO_MEMORY, "no memory", err);
        assert_true(!out.positions && !out.triangles);
    }
    cw_mesh_free(&out);
    cw_mesh_free(&in);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(edges_get_the_wanted_length),
        cmocka_unit_test(features_of_a_cube_are_exact),
        cmocka_unit_test(borders_stay_in_place),
        cmocka_unit_test(small_angles_go_or_are_told),
        cmocka_unit_test(adaptive_edges_follow_curvature),
        cmocka_unit_test(units_do_not_matter),
        cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(attributes_are_interpolated),
        cmocka_unit_test(bad_arguments_are_named),
        cmocka_unit_test(failures_and_cancelling_leave_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
