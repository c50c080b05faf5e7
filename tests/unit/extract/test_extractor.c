/* Many surfaces of one volume: the same bytes as one at a time, from the bricks they cross. */
#include "support/hostile.h"
#include "support/surface.h"

#include "core/base/memory.h"
#include "extract/dense/isa_dispatch.h"
#include "extract/extract_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double random_number(double limit)
{
    return limit * rand() / ((double)RAND_MAX + 1);
}

/* Boxes of constants and of noise over a constant: most bricks hold one number, and any brick
 * may hold the end of anything. */
static void paint(cw_volume *v, bool specials)
{
    const size_t *n = v->dim;
    char *voxels = cw_volume_voxels(v);
    for (int box = 0; box < 8; box++) {
        size_t low[3], high[3];
        const double value = floor(random_number(100)),
                     noise = rand() % 2 ? random_number(9) : 0;
        const bool nothing = specials && rand() % 4 == 0;
        for (int a = 0; a < 3; a++) {
            low[a] = box ? (size_t)rand() % n[a] : 0;
            high[a] = box ? low[a] + (size_t)rand() % (n[a] - low[a]) + 1 : n[a];
        }
        for (size_t k = low[2]; k < high[2]; k++)
            for (size_t j = low[1]; j < high[1]; j++)
                for (size_t i = low[0]; i < high[0]; i++) {
                    const size_t at = (k * n[1] + j) * n[0] + i;
                    const double x = nothing ? NAN : value + random_number(noise);
                    const bool has_nan = v->type == CW_F32 || v->type == CW_F64;
                    test_store(v->type, voxels, at, isnan(x) && !has_nan ? 7 : x);
                }
    }
}

static void one_after_another_as_each_by_itself(void **state)
{
    (void)state;
    static const size_t sizes[][3] = {{2, 2, 2},    {7, 8, 9},     {62, 15, 17}, {63, 16, 8},
                                      {64, 40, 24}, {130, 33, 31}, {66, 5, 71},  {200, 9, 10}};
    test_seed(91);
    for (int round = 0; round < 96; round += test_is_short() ? 5 : 1) {
        cw_volume v;
        cw_extractor *extractor;
        cw_error err = {0};
        size_t engines = 0;
        while (cwi_engine_at(engines))
            engines++;
        const cwi_engine *engine = cwi_engine_at((size_t)round % engines);
        assert_ok(cw_volume_alloc(&v, (cw_type)(round % CW_TYPE_COUNT), sizes[rand() % 8], 1, 1,
                                  &err),
                  err);
        paint(&v, rand() % 2);
        v.slope = rand() % 4 ? 1 : -1;
        v.has_nodata = rand() % 3 == 0;
        v.nodata = 7;
        /* two of three read single leaves however many are wanted */
        const size_t leaf_bytes = round % 3 ? 0 : CWI_LEAF_BYTES;
        assert_ok(cwi_extractor_new_with(engine, leaf_bytes, &v, &extractor, &err), err);
        for (int n = 0; n < 8; n++) {
            cw_mesh once = {0}, again = {0};
            cw_extract_counts counts[2] = {{0}, {0}};
            const double value = rand() % 2 ? floor(random_number(100)) : random_number(100);
            const cw_extract_desc d = {.isovalue = value * v.slope,
                                       .inside_is_low = rand() % 2,
                                       .leave_open = rand() % 4 == 0,
                                       .no_normals = rand() % 4 == 0,
                                       .threads = 1 + rand() % 2};
            assert_ok(cwi_extract_with(engine, &v, &d, &once, &counts[0], &err), err);
            assert_ok(cw_extractor_extract(extractor, &d, &again, &counts[1], &err), err);
            test_assert_same_mesh(&once, &again);
            assert_int_equal(counts[0].border_loops, counts[1].border_loops);
            cw_mesh_free(&once);
            if (rand() % 2)
                cw_extractor_recycle(extractor, &again);
            cw_mesh_free(&again);
        }
        cw_extractor_free(extractor);
        cw_volume_free(&v);
    }
}

/* Larger and smaller surfaces alternately, with and without normals. */
static void into_the_memory_of_the_surface_before(void **state)
{
    (void)state;
    const cw_field_desc desc = {
        .field = CW_FIELD_SPHERE, .dim = {300, 300, 300}, .type = CW_F32};
    cw_volume v;
    cw_extractor *extractor;
    cw_mesh mesh = {0};
    cw_error err = {0};
    assert_ok(cw_field_sample(&desc, &v, &err), err);
    assert_ok(cw_extractor_new(&v, &extractor, &err), err);
    for (int n = 0; n < 8; n++) {
        const cw_extract_desc d = {.isovalue = n % 2 ? 0 : 3 * n, .no_normals = n % 3 == 2};
        cw_mesh once = {0};
        assert_ok(cw_extract(&v, &d, &once, NULL, &err), err);
        assert_ok(cw_extractor_extract(extractor, &d, &mesh, NULL, &err), err);
        test_assert_same_mesh(&once, &mesh);
        cw_mesh_free(&once);
        cw_extractor_recycle(extractor, &mesh);
        assert_null(mesh.positions);
        cw_extractor_recycle(extractor, &mesh); /* an empty one changes nothing */
    }
    cw_extractor_free(extractor);
    cw_volume_free(&v);
}

/* Bricks that the surface does not cross are spoilt after the first extraction. */
static void spoil_other_bricks(bool leave_open)
{
    const cw_field_desc desc = {
        .field = CW_FIELD_SPHERE, .dim = {200, 200, 200}, .type = CW_F32};
    const cw_extract_desc first = {.isovalue = 0},
                          second = {.isovalue = 20, .leave_open = leave_open};
    cw_volume v;
    cw_extractor *extractor;
    cw_mesh once = {0}, again = {0};
    cw_error err = {0};
    assert_ok(cw_field_sample(&desc, &v, &err), err);
    assert_ok(cw_extract(&v, &second, &once, NULL, &err), err);
    assert_ok(cw_extractor_new(&v, &extractor, &err), err);
    assert_ok(cw_extractor_extract(extractor, &first, &again, NULL, &err), err);
    cw_mesh_free(&again);
    float *voxels = cw_volume_voxels(&v);
    for (size_t n = 0; n < 200 * 200 * 200; n++)
        if (fabs((double)voxels[n] - 20) > 15)
            voxels[n] = NAN;
    assert_ok(cw_extractor_extract(extractor, &second, &again, NULL, &err), err);
    test_assert_same_mesh(&once, &again);
    cw_mesh_free(&once);
    cw_mesh_free(&again);
    cw_extractor_free(extractor);
    cw_volume_free(&v);
}

static void later_surfaces_read_no_other_bricks(void **state)
{
    (void)state;
    spoil_other_bricks(false);
    spoil_other_bricks(true);
}

static void after_a_cancelled_extraction_it_starts_afresh(void **state)
{
    (void)state;
    const cw_field_desc desc = {.field = CW_FIELD_TORUS, .dim = {40, 40, 40}, .type = CW_F32};
    cw_volume v;
    cw_extractor *extractor;
    cw_mesh once = {0}, again = {0};
    cw_error err = {0};
    assert_ok(cw_field_sample(&desc, &v, &err), err);
    assert_ok(cw_extractor_new(&v, &extractor, &err), err);
    for (int polls = 0; polls < 40; polls++) {
        int left = polls;
        cw_extract_desc d = {.leave_open = polls % 3 == 0,
                             .progress = {test_stop_after, &left}};
        const cw_status st = cw_extractor_extract(extractor, &d, &again, NULL, &err);
        assert_true(st == CW_OK || st == CW_ERR_CANCELLED);
        cw_mesh_free(&again);
        d.progress = (cw_progress){0};
        assert_ok(cw_extract(&v, &d, &once, NULL, &err), err);
        assert_ok(cw_extractor_extract(extractor, &d, &again, NULL, &err), err);
        test_assert_same_mesh(&once, &again);
        cw_mesh_free(&once);
        cw_mesh_free(&again);
    }
    cw_extractor_free(extractor);
    cw_volume_free(&v);
}

static void memory_running_out_is_an_error_at_every_allocation(void **state)
{
    (void)state;
    static const float voxels[27] = {[13] = 1};
    const cw_volume v = {.data = voxels, .type = CW_F32, .dim = {3, 3, 3}};
    const cw_extract_desc d = {.isovalue = 0.5f, .leave_open = true};
    bool done = false;
    for (long n = 0; !done; n++) {
        cw_extractor *extractor;
        cw_mesh mesh = {0};
        cw_error err = {0};
        cwi_alloc_fail_after(n);
        cw_status st = cw_extractor_new(&v, &extractor, &err);
        if (st == CW_OK)
            st = cw_extractor_extract(extractor, &d, &mesh, NULL, &err);
        done = !cwi_alloc_fail_after(-1);
        assert_int_equal(st, done ? CW_OK : CW_ERR_NO_MEMORY);
        if (extractor && !done) /* it can be asked again */
            assert_ok(cw_extractor_extract(extractor, &d, &mesh, NULL, &err), err);
        cw_mesh_free(&mesh);
        cw_extractor_free(extractor);
        assert_true(n < 40);
    }
}

static void memory_running_out_leaves_nothing_of_a_recycled_mesh(void **state)
{
    (void)state;
    static const float voxels[27] = {[13] = 1};
    const cw_volume v = {.data = voxels, .type = CW_F32, .dim = {3, 3, 3}};
    const cw_extract_desc d = {.isovalue = 0.5f};
    cw_extractor *extractor;
    cw_mesh mesh = {0};
    cw_error err = {0};
    bool failed = true;
    assert_ok(cw_extractor_new(&v, &extractor, &err), err);
    for (long n = 0; failed; n++) {
        assert_ok(cw_extractor_extract(extractor, &d, &mesh, NULL, &err), err);
        cw_extractor_recycle(extractor, &mesh);
        cwi_alloc_fail_after(n);
        const cw_status st = cw_extractor_extract(extractor, &d, &mesh, NULL, &err);
        failed = cwi_alloc_fail_after(-1);
        assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
        assert_int_equal(!mesh.positions, failed);
        cw_mesh_free(&mesh);
        assert_true(failed || n >= 3); /* it has three arrays */
    }
    cw_extractor_free(extractor);
}

static void it_holds_less_than_an_eighth_of_a_volume_of_floats(void **state)
{
    (void)state;
    const cw_field_desc desc = {
        .field = CW_FIELD_SPHERE, .dim = {256, 256, 256}, .type = CW_F32};
    cw_volume v;
    cw_extractor *extractor;
    cw_extract_counts counts;
    cw_error err = {0};
    assert_ok(cw_field_sample(&desc, &v, &err), err);
    assert_ok(cw_extractor_new(&v, &extractor, &err), err);
    assert_ok(cw_extractor_predict(extractor, NULL, &counts, &err), err);
    assert_true(counts.bytes - 24 * counts.vertices - 12 * counts.triangles <
                (size_t)256 * 256 * 256 * 4 / 8);
    cw_extractor_free(extractor);
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_after_another_as_each_by_itself),
        cmocka_unit_test(into_the_memory_of_the_surface_before),
        cmocka_unit_test(later_surfaces_read_no_other_bricks),
        cmocka_unit_test(after_a_cancelled_extraction_it_starts_afresh),
        cmocka_unit_test(memory_running_out_is_an_error_at_every_allocation),
        cmocka_unit_test(memory_running_out_leaves_nothing_of_a_recycled_mesh),
        cmocka_unit_test(it_holds_less_than_an_eighth_of_a_volume_of_floats),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
