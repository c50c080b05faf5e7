/* Simplified while it is extracted: as good as afterwards. */
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/base/sandbox.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static cw_volume noisy_column(size_t n, size_t deep, double noise)
{
    const cw_field_desc field = {
        .field = CW_FIELD_GYROID, .dim = {n, n, deep}, .type = CW_F32, .noise = noise};
    cw_volume volume;
    cw_error err = {0};
    assert_ok(cw_field_sample(&field, &volume, &err), err);
    return volume;
}

static cw_volume noisy_gyroid(size_t n, double noise)
{
    return noisy_column(n, n, noise);
}

typedef struct tandem {
    cw_simplifier *simplifier;
    size_t slabs;
} tandem;

static cw_status take(void *user, const cw_slab *slab, cw_error *err)
{
    tandem *t = user;
    t->slabs++;
    return cw_simplifier_take(t->simplifier, slab, err);
}

static cw_mesh run(const cw_volume *volume, const cw_extract_desc *extract,
                   const cw_simplify_desc *desc, size_t triangles)
{
    tandem t = {0};
    cw_mesh out;
    cw_simplify_facts facts;
    cw_error err = {0};
    assert_ok(cw_simplifier_new(desc, &t.simplifier, &err), err);
    assert_ok(
        cw_extract_slabs(volume, extract, triangles, (cw_slab_sink){take, &t}, NULL, &err),
        err);
    assert_true(t.slabs >= 2);
    assert_ok(cw_simplifier_finish(t.simplifier, &out, &facts, &err), err);
    assert_int_equal(facts.triangles, out.triangle_count);
    assert_int_equal(facts.vertices, out.vertex_count);
    cw_simplifier_free(t.simplifier);
    return out;
}

static double rms(const cw_mesh *mesh, const cw_mesh *reference)
{
    cw_distance distance;
    cw_error err = {0};
    assert_ok(cw_distance_to_mesh(mesh, reference, NULL, &distance, NULL, &err), err);
    return distance.rms_mm;
}

/* Two slabs and four, closed and open, in frames that shear and mirror. */
static void a_number_of_triangles_is_met(void **state)
{
    (void)state;
    test_seed(11);
    for (int round = test_is_short() ? 3 : 0; round < 4; round++) {
        cw_volume v = noisy_gyroid(32, 0.05);
        const cw_extract_desc extract = {.leave_open = round & 1};
        const cw_simplify_desc desc = {.ratio = 0.1};
        test_turn(&v, round);
        cw_mesh whole = test_extract(&v, &extract, NULL), after;
        cw_error err = {0};
        cw_mesh out = run(&v, &extract, &desc, whole.triangle_count / (round & 2 ? 4 : 2));
        test_assert_sound(&whole, &out);
        assert_in_range(out.triangle_count, whole.triangle_count / 10 - 2,
                        whole.triangle_count / 10);
        assert_memory_equal(out.origin, whole.origin, sizeof out.origin);
        assert_memory_equal(out.affine, whole.affine, sizeof out.affine);
        assert_ok(cw_simplify(&whole, &desc, &after, NULL, &err), err);
        assert_true(rms(&out, &whole) < 1.05 * rms(&after, &whole));
        cw_mesh_free(&after);
        cw_mesh_free(&whole);
        cw_mesh_free(&out);
        cw_volume_free(&v);
    }
}

/* The seam is as good as the inside: about as many triangles as from the whole. */
/* Sharp edges and flat faces, whole and by slabs: hardly a triangle is needed. */
static void a_box_needs_few_triangles(void **state)
{
    (void)state;
    enum { MOST = 48, Z = 30 };
    static float values[Z * MOST * MOST];
    const size_t x = test_is_short() ? 28 : MOST;
    for (size_t k = 0; k < Z; k++)
        for (size_t j = 0; j < x; j++)
            for (size_t i = 0; i < x; i++)
                values[(k * x + j) * x + i] =
                    i >= 4 && i < x - 4 && j >= 4 && j < x - 4 && k >= 4 && k < Z - 5;
    const cw_volume volume = {.data = values, .type = CW_F32, .dim = {x, x, Z}};
    const cw_extract_desc extract = {.isovalue = 0.5, .no_normals = true};
    const cw_mesh full = test_extract(&volume, &extract, NULL);
    const size_t target = full.triangle_count / 50;
    const cw_simplify_desc desc = {.triangles = target};
    cw_mesh meshes[2];
    cw_error err = {0};
    assert_ok(cw_simplify(&full, &desc, meshes, NULL, &err), err);
    meshes[1] = run(&volume, &extract, &desc, 2000);
    for (int n = 0; n < 2; n++) {
        assert_in_range(meshes[n].triangle_count, 12, target);
        assert_true(rms(meshes + n, &full) < 0.02 && rms(&full, meshes + n) < 0.02);
        cw_mesh_free(meshes + n);
    }
    cw_mesh mesh = full;
    cw_mesh_free(&mesh);
}

static void an_error_is_kept(void **state)
{
    (void)state;
    test_seed(12);
    for (int round = test_is_short() ? 3 : 0; round < 4; round++) {
        cw_volume v = noisy_column(16, 22, round ? 0.02 : 0);
        const cw_extract_desc extract = {.leave_open = round & 1};
        const cw_simplify_desc desc = {.error_mm = round & 2 ? 0.8 : 0.3};
        if (round & 2)
            test_turn(&v, round);
        cw_mesh whole = test_extract(&v, &extract, NULL), after;
        cw_error err = {0};
        cw_mesh out = run(&v, &extract, &desc, whole.triangle_count / 2);
        test_assert_sound(&whole, &out);
        test_bound_is_kept(&whole, &out, desc.error_mm);
        test_bound_is_kept(&out, &whole, desc.error_mm);
        assert_ok(cw_simplify(&whole, &desc, &after, NULL, &err), err);
        if ((double)out.triangle_count > 1.1 * (double)after.triangle_count)
            fail_msg("round %d: %zu triangles, and %zu afterwards", round, out.triangle_count,
                     after.triangle_count);
        cw_mesh_free(&after);
        cw_mesh_free(&whole);
        cw_mesh_free(&out);
        cw_volume_free(&v);
    }
}

/* Slabs that are thin for the error, or have hardly any triangles. */
static void thin_slabs_stay_sound(void **state)
{
    (void)state;
    cw_volume v = noisy_gyroid(18, 0.1);
    static const double errors[] = {0.5, 5, 0};
    cw_mesh whole = test_extract(&v, NULL, NULL);
    for (int n = 0; n < 3; n++) {
        const cw_simplify_desc desc = {.error_mm = errors[n], .triangles = n == 2 ? 500 : 0};
        cw_mesh out = run(&v, NULL, &desc, 1);
        test_assert_sound(&whole, &out);
        if (errors[n] > 0) {
            test_bound_is_kept(&whole, &out, errors[n]);
            test_bound_is_kept(&out, &whole, errors[n]);
        }
        cw_mesh_free(&out);
    }
    cw_mesh_free(&whole);
    cw_volume_free(&v);
}

/* Windows whose seams are cut into blocks once more, with finished triangles in the way. */
static void windows_of_many_blocks_are_sound(void **state)
{
    (void)state;
    cw_volume v = noisy_gyroid(52, 0.05);
    cw_mesh whole = test_extract(&v, NULL, NULL), out[2];
    for (int n = 0; n < (test_is_short() ? 1 : 2); n++) {
        const cw_extract_desc extract = {.threads = n ? 3 : 1};
        const cw_simplify_desc desc = {.error_mm = 0.01, .threads = n ? 3 : 1};
        out[n] = run(&v, &extract, &desc, whole.triangle_count / 2);
    }
    test_assert_sound(&whole, out);
    test_bound_is_measured(&whole, out, 0.01);
    test_bound_is_measured(out, &whole, 0.01);
    if (!test_is_short()) {
        test_assert_same_mesh(out, out + 1);
        cw_mesh_free(out + 1);
    }
    cw_mesh_free(out);
    cw_mesh_free(&whole);
    cw_volume_free(&v);
}

static void threads_change_nothing(void **state)
{
    (void)state;
    cw_volume v = noisy_gyroid(test_is_short() ? 18 : 28, 0.05);
    const size_t slab = test_is_short() ? 1000 : 7000;
    for (int kind = 0; kind < 2; kind++) {
        cw_mesh out[2];
        for (int n = 0; n < 2; n++) {
            const cw_extract_desc extract = {.threads = n ? 3 : 1};
            const cw_simplify_desc desc = {
                .error_mm = kind ? 0.5 : 0, .ratio = kind ? 0 : 0.2, .threads = n ? 3 : 1};
            out[n] = run(&v, &extract, &desc, slab);
        }
        test_assert_same_mesh(out, out + 1);
        cw_mesh_free(out);
        cw_mesh_free(out + 1);
    }
    cw_volume_free(&v);
}

static void wishes_that_make_no_sense_are_refused(void **state)
{
    (void)state;
    cw_simplifier *s;
    cw_mesh out;
    cw_error err = {0};
    assert_fails(cw_simplifier_new(&(cw_simplify_desc){0}, &s, &err), CW_ERR_ARGUMENT,
                 "one of these", err);
    assert_null(s);
    assert_fails(cw_simplifier_new(&(cw_simplify_desc){.error_mm = 1, .ratio = 0.5}, &s, &err),
                 CW_ERR_ARGUMENT, "one of these", err);
    assert_fails(cw_simplifier_new(&(cw_simplify_desc){.error_mm = NAN}, &s, &err),
                 CW_ERR_ARGUMENT, "nan", err);
    assert_fails(
        cw_simplifier_new(&(cw_simplify_desc){.error_mm = 1, .normal_weight = 1}, &s, &err),
        CW_ERR_ARGUMENT, "normals", err);
    cw_simplifier_free(NULL);
    /* nothing came */
    assert_ok(cw_simplifier_new(&(cw_simplify_desc){.error_mm = 1}, &s, &err), err);
    assert_ok(cw_simplifier_finish(s, &out, NULL, &err), err);
    assert_int_equal(out.triangle_count, 0);
    cw_simplifier_free(s);
}

static void slabs_that_are_missing_are_noticed(void **state)
{
    (void)state;
    cw_simplifier *s;
    cw_mesh cube, out;
    cw_error err = {0};
    uint8_t seam[8] = {0};
    test_make_cube(&cube);
    cw_slab slab = {.mesh = &cube,
                    .seam = seam,
                    .along = {0, 0, 1},
                    .low = -INFINITY,
                    .high = INFINITY,
                    .triangles = cube.triangle_count};
    assert_ok(cw_simplifier_new(&(cw_simplify_desc){.ratio = 0.9}, &s, &err), err);
    assert_ok(cw_simplifier_take(s, &slab, &err), err);
    assert_fails(cw_simplifier_finish(s, &out, NULL, &err), CW_ERR_ARGUMENT, "last", err);
    slab.last = true;
    assert_ok(cw_simplifier_take(s, &slab, &err), err);
    assert_fails(cw_simplifier_take(s, &slab, &err), CW_ERR_ARGUMENT, "after the last", err);
    cw_simplifier_free(s);
    cw_mesh_free(&cube);
}

#if !CWI_SANITIZED
/* Whatever allocation fails: the later ones in larger and larger steps, as they are many. */
static void running_out_of_memory_is_told(void **state)
{
    (void)state;
    cw_volume v = noisy_gyroid(8, 0.1);
    for (int kind = 0; kind < 2; kind++)
        for (long n = 0, failed = 1; failed; n += 1 + n / 50) {
            const cw_simplify_desc desc = {
                .error_mm = kind, .ratio = kind ? 0 : 0.3, .threads = 1};
            const cw_extract_desc extract = {.threads = 1};
            tandem t = {0};
            cw_mesh out = {0};
            cw_error err = {0};
            cwi_alloc_fail_after(n);
            cw_status st = cw_simplifier_new(&desc, &t.simplifier, &err);
            if (st == CW_OK)
                st = cw_extract_slabs(&v, &extract, 1, (cw_slab_sink){take, &t}, NULL, &err);
            if (st == CW_OK)
                st = cw_simplifier_finish(t.simplifier, &out, NULL, &err);
            failed = cwi_alloc_fail_after(-1);
            assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
            cw_simplifier_free(t.simplifier);
            cw_mesh_free(&out);
        }
    cw_volume_free(&v);
}
#endif

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_number_of_triangles_is_met),
        cmocka_unit_test(a_box_needs_few_triangles),
        cmocka_unit_test(an_error_is_kept),
        cmocka_unit_test(thin_slabs_stay_sound),
        cmocka_unit_test(windows_of_many_blocks_are_sound),
        cmocka_unit_test(threads_change_nothing),
        cmocka_unit_test(wishes_that_make_no_sense_are_refused),
        cmocka_unit_test(slabs_that_are_missing_are_noticed),
#if !CWI_SANITIZED /* asan in a C program knows of no exceptions */
        cmocka_unit_test(running_out_of_memory_is_told),
#endif
    };
    if (!cw_simplify_available())
        return 0;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
