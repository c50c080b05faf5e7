/* Simplification: what it must not change, and what it promises. */
#include "support/hostile.h"
#include "support/planted.h"
#include "support/surface.h"

#include "core/memory.h"
#include "core/sandbox.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static cw_mesh simplify(const cw_mesh *mesh, const cw_simplify_desc *desc)
{
    cw_mesh out;
    cw_simplify_facts facts;
    cw_error err = {0};
    assert_ok(cw_simplify(mesh, desc, &out, &facts, &err), err);
    assert_int_equal(facts.vertices, out.vertex_count);
    assert_int_equal(facts.triangles, out.triangle_count);
    assert_true(facts.passes >= 1);
    return out;
}

static cw_mesh reduce(const cw_mesh *mesh, double ratio)
{
    return simplify(mesh, &(cw_simplify_desc){.ratio = ratio});
}

static size_t count_crossings(const cw_mesh *mesh)
{
    cw_crossings crossings = {0};
    cw_error err = {0};
    assert_ok(cw_self_intersections(mesh, NULL, &crossings, &err), err);
    assert_false(crossings.undecided);
    const size_t count = crossings.count;
    cw_crossings_free(&crossings);
    return count;
}

static cw_quality measure(const cw_mesh *mesh)
{
    cw_quality quality;
    cw_error err = {0};
    assert_ok(cw_quality_measure(mesh, NULL, &quality, &err), err);
    return quality;
}

/* Of a sound mesh: the same topology, as sound as before. NULL, or what is wrong. */
static const char *fault_of(const cw_mesh *before, const cw_mesh *after)
{
    const cw_quality a = measure(before), b = measure(after);
    if (b.triangles > a.triangles)
        return "has more triangles";
    if (a.components != b.components)
        return "has not as many components";
    if (a.euler != b.euler)
        return "has another Euler number";
    if (a.border_loops != b.border_loops)
        return "has not as many border loops";
    if (b.nonmanifold_edges || b.nonmanifold_vertices || b.misoriented_edges || b.duplicates)
        return "is no manifold";
    if (b.degenerate)
        return "has triangles without area";
    if (b.unused_vertices)
        return "has vertices in no triangle";
    return count_crossings(after) ? "crosses itself" : NULL;
}

static void assert_sound(const cw_mesh *before, const cw_mesh *after)
{
    const char *fault = fault_of(before, after);
    if (fault)
        fail_msg("the result %s", fault);
}

static cw_mesh noisy_gyroid(size_t n, double noise, bool open)
{
    const cw_field_desc field = {
        .field = CW_FIELD_GYROID, .dim = {n, n, n}, .type = CW_F32, .noise = noise};
    cw_volume volume;
    cw_error err = {0};
    assert_ok(cw_field_sample(&field, &volume, &err), err);
    const cw_mesh mesh = test_extract(&volume, &(cw_extract_desc){.leave_open = open}, NULL);
    cw_volume_free(&volume);
    return mesh;
}

/* Large enough for several blocks. */
static void topology_stays(void **state)
{
    (void)state;
    static const double ratios[] = {0.3, 0.02};
    for (int n = 0; n < 2; n++) {
        cw_mesh mesh = noisy_gyroid(42, 0.1, n), out = reduce(&mesh, ratios[n]);
        assert_true(mesh.triangle_count > 1 << 15);
        assert_sound(&mesh, &out);
        if (n == 0)
            assert_within((double)out.triangle_count, 0.3 * (double)mesh.triangle_count, 0.01);
        cw_mesh_free(&out);
        cw_mesh_free(&mesh);
    }
}

/* Surfaces that extractors break on are no easier to simplify. */
static void hostile_surfaces_stay_sound(void **state)
{
    (void)state;
    const test_hostile *h;
    for (size_t n = 0; (h = test_hostile_at(n)); n++) {
        cw_volume volume;
        cw_error err = {0};
        assert_ok(test_hostile_make(h, &volume, &err), err);
        const cw_extract_desc desc = {.isovalue = h->isovalue, .leave_open = n % 2};
        cw_mesh mesh = test_extract(&volume, &desc, NULL), out = reduce(&mesh, 0.1);
        const char *fault = fault_of(&mesh, &out);
        if (fault)
            fail_msg("%s: the result %s", h->name, fault);
        cw_mesh_free(&out);
        cw_mesh_free(&mesh);
        cw_volume_free(&volume);
    }
}

/* Meshes that are broken are not mended, but not made worse. */
static void broken_meshes_become_no_worse(void **state)
{
    (void)state;
    for (size_t n = 0; n < test_planted_count; n++) {
        cw_mesh mesh = test_plant(test_planted_meshes + n), out = reduce(&mesh, 0.01);
        const cw_quality a = measure(&mesh), b = measure(&out);
        if (b.nonmanifold_edges > a.nonmanifold_edges ||
            b.nonmanifold_vertices > a.nonmanifold_vertices || b.degenerate > a.degenerate ||
            b.duplicates > a.duplicates || b.components > a.components ||
            b.border_loops > a.border_loops || count_crossings(&out) > count_crossings(&mesh))
            fail_msg("%s is worse than before", test_planted_meshes[n].name);
        cw_mesh_free(&out);
        cw_mesh_free(&mesh);
    }
}

static void bounds_are_kept(const cw_mesh *a, const cw_mesh *b, double error)
{
    const cw_mesh_distance_desc how = {.tolerance_mm = 0.01 * error};
    cw_distance distance;
    cw_error err = {0};
    assert_ok(cw_distance_to_mesh(a, b, &how, &distance, NULL, &err), err);
    if (distance.max_mm > error)
        fail_msg("%g mm where %g are promised", distance.max_mm, error);
    if (cw_quality_has_cgal()) {
        double by_cgal;
        assert_ok(cw_distance_by_cgal(a, b, 0.05 * error, &by_cgal, &err), err);
        if (by_cgal > 1.05 * error)
            fail_msg("%g mm by CGAL where %g are promised", by_cgal, error);
    }
}

static void no_error_is_exceeded(double noise, bool open)
{
    cw_mesh mesh = noisy_gyroid(16, noise, open);
    double low[3], high[3];
    assert_true(cw_mesh_bounds(&mesh, low, high));
    size_t before = mesh.triangle_count;
    for (double error = 0.001 * (high[0] - low[0]); error < 0.03 * (high[0] - low[0]);
         error *= 5) {
        cw_mesh out = simplify(&mesh, &(cw_simplify_desc){.error_mm = error});
        bounds_are_kept(&mesh, &out, error);
        bounds_are_kept(&out, &mesh, error);
        assert_sound(&mesh, &out);
        assert_true(out.triangle_count < before);
        before = out.triangle_count;
        cw_mesh_free(&out);
    }
    cw_mesh_free(&mesh);
}

static void the_error_is_never_exceeded(void **state)
{
    (void)state;
    no_error_is_exceeded(0.1, false);
    no_error_is_exceeded(0.3, false);
    no_error_is_exceeded(0.1, true);
}

/* An error and a number: what is met first ends it. */
static void what_is_met_first_ends_it(void **state)
{
    (void)state;
    cw_volume volume = test_sample(CW_FIELD_SPHERE, 32, CW_F32);
    cw_mesh mesh = test_extract(&volume, NULL, NULL);
    cw_mesh coarse = simplify(&mesh, &(cw_simplify_desc){.error_mm = 100, .triangles = 1000});
    assert_int_equal(coarse.triangle_count, 1000);
    cw_mesh fine = simplify(&mesh, &(cw_simplify_desc){.error_mm = 1e-5, .triangles = 1000});
    assert_true(fine.triangle_count > 1000);
    cw_mesh_free(&fine);
    cw_mesh_free(&coarse);
    cw_mesh_free(&mesh);
    cw_volume_free(&volume);
}

/* Vertices of a simplified sphere are as near to it as those of a good approximation. */
static void a_sphere_stays_round(void **state)
{
    (void)state;
    cw_volume volume = test_sample(CW_FIELD_SPHERE, 64, CW_F32);
    cw_mesh mesh = test_extract(&volume, NULL, NULL), out = reduce(&mesh, 0.05);
    const double before = measure(&mesh).volume_mm3, after = measure(&out).volume_mm3;
    assert_within(after, before, 5e-3);
    assert_true(test_normals_agree(&out));
    cw_mesh_free(&out);
    cw_mesh_free(&mesh);
    cw_volume_free(&volume);
}

/* A flat square with a grid on it: nothing is lost until two triangles are left. */
static void a_flat_square_becomes_two_triangles(void **state)
{
    (void)state;
    enum { N = 20 };
    cw_mesh mesh = {.vertex_count = (N + 1) * (N + 1), .triangle_count = 2 * N * N};
    mesh.positions = cwi_alloc_array(3 * mesh.vertex_count, sizeof *mesh.positions);
    mesh.triangles = cwi_alloc_array(3 * mesh.triangle_count, sizeof *mesh.triangles);
    assert_true(mesh.positions && mesh.triangles);
    for (uint32_t v = 0; v < mesh.vertex_count; v++) {
        mesh.positions[3 * v] = (float)(v % (N + 1));
        mesh.positions[3 * v + 1] = (float)(v / (N + 1));
        mesh.positions[3 * v + 2] = 0;
    }
    uint32_t *t = mesh.triangles;
    for (uint32_t y = 0; y < N; y++)
        for (uint32_t x = 0; x < N; x++, t += 6) {
            const uint32_t v = y * (N + 1) + x;
            const uint32_t corners[6] = {v, v + 1, v + N + 2, v, v + N + 2, v + N + 1};
            memcpy(t, corners, sizeof corners);
        }
    cw_mesh out = simplify(&mesh, &(cw_simplify_desc){.triangles = 2});
    assert_int_equal(out.triangle_count, 2);
    assert_near(measure(&out).area_mm2, N * N, 0.01 * N * N);
    cw_mesh_free(&out);
    out = simplify(&mesh, &(cw_simplify_desc){.error_mm = 0.01});
    assert_true(out.triangle_count < 20);
    assert_near(measure(&out).area_mm2, N * N, 4 * N * 0.01);
    cw_mesh_free(&out);
    cw_mesh_free(&mesh);
}

/* The least closed surface is a tetrahedron. */
static void nothing_vanishes(void **state)
{
    (void)state;
    cw_mesh cube = {0}, empty = {0};
    test_make_cube(&cube);
    cw_mesh out = simplify(&cube, &(cw_simplify_desc){.triangles = 1});
    assert_true(out.triangle_count >= 4);
    assert_sound(&cube, &out);
    cw_mesh_free(&out);
    cw_mesh_free(&cube);
    out = simplify(&empty, &(cw_simplify_desc){.error_mm = 1});
    assert_int_equal(out.triangle_count, 0);
    cw_mesh_free(&out);
}

static void threads_change_nothing(void **state)
{
    (void)state;
    cw_mesh mesh = noisy_gyroid(42, 0.1, false);
    for (int kind = 0; kind < 2; kind++) {
        cw_simplify_desc desc = {.threads = 1, .ratio = kind ? 0.6 : 0.2};
        desc.error_mm = kind ? 0.5 : 0;
        cw_mesh one = simplify(&mesh, &desc);
        desc.threads = 3;
        cw_mesh three = simplify(&mesh, &desc);
        test_assert_same_mesh(&one, &three);
        cw_mesh_free(&one);
        cw_mesh_free(&three);
    }
    cw_mesh_free(&mesh);
}

static void levels_follow_each_other(void **state)
{
    (void)state;
    static const size_t triangles[] = {20000, 5000, 1000};
    cw_mesh mesh = noisy_gyroid(40, 0.02, false), levels[3];
    cw_simplify_facts facts[3];
    cw_error err = {0};
    assert_ok(
        cw_simplify_levels(&mesh, &(cw_simplify_desc){0}, triangles, 3, levels, facts, &err),
        err);
    for (int n = 0; n < 3; n++) {
        assert_int_equal(facts[n].triangles, levels[n].triangle_count);
        if (n < 2)
            assert_int_equal(levels[n].triangle_count, triangles[n]);
        assert_sound(&mesh, levels + n);
    }
    cw_mesh first = simplify(&mesh, &(cw_simplify_desc){.triangles = triangles[0]});
    test_assert_same_mesh(&first, levels);
    cw_mesh_free(&first);
    for (int n = 0; n < 3; n++)
        cw_mesh_free(levels + n);
    cw_mesh_free(&mesh);
}

/* What vertices carry is a function of place here, so it is known for the result. */
static void what_vertices_carry_comes_along(void **state)
{
    (void)state;
    cw_volume volume = test_sample(CW_FIELD_SPHERE, 32, CW_F32);
    cw_mesh mesh = test_extract(&volume, NULL, NULL);
    const size_t n = mesh.vertex_count;
    mesh.scalars = cwi_alloc_array(n, sizeof *mesh.scalars);
    mesh.colors = cwi_alloc_array(4 * n, sizeof *mesh.colors);
    mesh.labels = cwi_alloc_array(n, sizeof *mesh.labels);
    assert_true(mesh.scalars && mesh.colors && mesh.labels);
    for (size_t v = 0; v < n; v++) {
        const float z = mesh.positions[3 * v + 2];
        mesh.scalars[v] = z;
        mesh.labels[v] = z > 0 ? 7 : 9;
        for (size_t k = 0; k < 4; k++)
            mesh.colors[4 * v + k] = (uint8_t)(128 + z + (float)k);
    }
    cw_mesh out = reduce(&mesh, 0.2);
    const double voxel = volume.affine[0][0];
    assert_true(out.normals && out.scalars && out.colors && out.labels);
    for (size_t v = 0; v < out.vertex_count; v++) {
        const float *p = out.positions + 3 * v, *normal = out.normals + 3 * v, z = p[2];
        const double length = sqrt((double)(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]));
        assert_near((double)out.scalars[v], (double)z, 0.1 * voxel);
        for (int k = 0; k < 4; k++)
            assert_near(out.colors[4 * v + (size_t)k], 128 + (double)z + k, 0.6 + voxel);
        if (fabs((double)z) > voxel)
            assert_int_equal(out.labels[v], z > 0 ? 7 : 9);
        for (int k = 0; k < 3; k++)
            assert_near((double)normal[k], (double)p[k] / length, 0.02);
    }
    cw_mesh_free(&out);
    cw_mesh_free(&mesh);
    cw_volume_free(&volume);
}

static void crossings_may_be_allowed(void **state)
{
    (void)state;
    cw_mesh mesh = noisy_gyroid(40, 0.2, false);
    cw_mesh out = simplify(&mesh, &(cw_simplify_desc){.ratio = 0.05, .allow_crossings = true});
    const cw_quality a = measure(&mesh), b = measure(&out);
    assert_int_equal(a.euler, b.euler);
    assert_int_equal(a.components, b.components);
    assert_int_equal(b.nonmanifold_edges, 0);
    assert_true(count_crossings(&out) > 0);
    cw_mesh_free(&out);
    cw_mesh_free(&mesh);
}

static void wishes_that_make_no_sense_are_refused(void **state)
{
    (void)state;
    static const struct {
        cw_simplify_desc desc;
        const char *words;
    } rows[] = {
        {{0}, "an error, a number of triangles or a ratio"},
        {{.error_mm = -1}, "error_mm is -1; it must be 0 or more"},
        {{.error_mm = INFINITY}, "error_mm is inf"},
        {{.error_mm = NAN}, "error_mm is"},
        {{.ratio = 1}, "ratio is 1; it must be at least 0 and below 1"},
        {{.ratio = -0.5}, "ratio is -0.5"},
    };
    static const size_t rising[] = {10, 20}, none[] = {10, 0}, falling[] = {20, 10};
    cw_mesh mesh = {0}, out[2];
    cw_error err = {0};
    test_make_cube(&mesh);
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++)
        assert_fails(cw_simplify(&mesh, &rows[n].desc, out, NULL, &err), CW_ERR_ARGUMENT,
                     rows[n].words, err);
    const cw_simplify_desc plain = {0}, both = {.ratio = 0.5};
    assert_fails(cw_simplify_levels(&mesh, &plain, rising, 2, out, NULL, &err), CW_ERR_ARGUMENT,
                 "level 1 has 20 triangles", err);
    assert_fails(cw_simplify_levels(&mesh, &plain, none, 2, out, NULL, &err), CW_ERR_ARGUMENT,
                 "level 1 has 0 triangles", err);
    assert_fails(cw_simplify_levels(&mesh, &both, falling, 2, out, NULL, &err), CW_ERR_ARGUMENT,
                 "and nothing else", err);
    mesh.triangles[0] = 1000;
    assert_fails(cw_simplify(&mesh, &both, out, NULL, &err), CW_ERR_ARGUMENT,
                 "names vertex 1000", err);
    cw_mesh_free(&mesh);
}

static bool refuse(void *user, const char *step, double done)
{
    (void)step, (void)done;
    ++*(int *)user;
    return false;
}

static void it_can_be_stopped(void **state)
{
    (void)state;
    int calls = 0;
    cw_mesh mesh = noisy_gyroid(40, 0.1, false), out;
    cw_error err = {0};
    const cw_simplify_desc desc = {.ratio = 0.1, .progress = {refuse, &calls}};
    assert_fails(cw_simplify(&mesh, &desc, &out, NULL, &err), CW_ERR_CANCELLED, "interrupted",
                 err);
    assert_int_equal(calls, 1);
    assert_null(out.positions);
    cw_mesh_free(&mesh);
}

#if !CWI_SANITIZED
/* Sets each allocation in turn to fail. */
static void starve(const cw_mesh *mesh, const cw_simplify_desc *desc)
{
    cw_mesh out;
    bool failed = true;
    for (long n = 0; failed; n++) {
        cw_error err = {0};
        cwi_alloc_fail_after(n);
        const cw_status st = cw_simplify(mesh, desc, &out, NULL, &err);
        failed = cwi_alloc_fail_after(-1);
        if (failed) {
            assert_fails(st, CW_ERR_NO_MEMORY, "memory", err);
            assert_null(out.positions);
        } else {
            assert_ok(st, err);
        }
        cw_mesh_free(&out);
    }
}

static void running_out_of_memory_is_told(void **state)
{
    (void)state;
    cw_mesh several_blocks = noisy_gyroid(40, 0.02, false),
            small = noisy_gyroid(10, 0.1, false);
    assert_true(several_blocks.triangle_count > 40000);
    starve(&several_blocks,
           &(cw_simplify_desc){.ratio = 0.95, .allow_crossings = true, .threads = 1});
    starve(&small, &(cw_simplify_desc){.error_mm = 1, .threads = 1});
    cw_mesh_free(&several_blocks);
    cw_mesh_free(&small);
}
#endif

static void a_build_without_openmesh_says_so(void **state)
{
    (void)state;
    cw_mesh mesh = {0}, out;
    cw_error err = {0};
    test_make_cube(&mesh);
    assert_fails(cw_simplify(&mesh, &(cw_simplify_desc){.ratio = 0.5}, &out, NULL, &err),
                 CW_ERR_UNSUPPORTED, "libopenmesh-dev", err);
    cw_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(topology_stays),
        cmocka_unit_test(hostile_surfaces_stay_sound),
        cmocka_unit_test(broken_meshes_become_no_worse),
        cmocka_unit_test(the_error_is_never_exceeded),
        cmocka_unit_test(what_is_met_first_ends_it),
        cmocka_unit_test(a_sphere_stays_round),
        cmocka_unit_test(a_flat_square_becomes_two_triangles),
        cmocka_unit_test(nothing_vanishes),
        cmocka_unit_test(threads_change_nothing),
        cmocka_unit_test(levels_follow_each_other),
        cmocka_unit_test(what_vertices_carry_comes_along),
        cmocka_unit_test(crossings_may_be_allowed),
        cmocka_unit_test(wishes_that_make_no_sense_are_refused),
        cmocka_unit_test(it_can_be_stopped),
#if !CWI_SANITIZED /* asan in a C program knows of no exceptions */
        cmocka_unit_test(running_out_of_memory_is_told),
#endif
    };
    const struct CMUnitTest without[] = {cmocka_unit_test(a_build_without_openmesh_says_so)};
    return cw_simplify_available() ? cmocka_run_group_tests(tests, NULL, NULL)
                                   : cmocka_run_group_tests(without, NULL, NULL);
}
