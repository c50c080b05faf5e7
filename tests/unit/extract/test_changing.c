/* Surfaces of a volume that changes: each frame is as from scratch, in the same memory. */
#include "support/cells.h"
#include "support/changing.h"
#include "support/surface.h"

#include "core/base/memory.h"
#include "extract/extract_internal.h"

#include <math.h>
#include <stdlib.h>

static void each_frame_is_as_from_scratch(void **state)
{
    (void)state;
    test_seed(17);
    for (int round = 0; round < 60; round += test_is_short() ? 4 : 1) {
        const cwi_engine *engine = test_some_engine(round);
        cw_volume v = test_some_changing_volume(round);
        cw_extractor *e;
        cw_mesh mesh = {0}, once = {0}; /* filled again and again */
        cw_error err = {0};
        const size_t leaf_bytes = round % 3 ? 0 : CWI_LEAF_BYTES;
        assert_ok(cwi_extractor_new_with(engine, leaf_bytes, &v, &e, &err), err);
        for (int frame = 0; frame < 10; frame++) {
            const cw_extract_desc d = test_random_settings(&v);
            cw_extract_counts counts[2] = {{0}, {0}};
            assert_ok(cwi_extract_with(engine, &v, &d, &once, &counts[0], &err), err);
            assert_ok(cw_extractor_extract(e, &d, &mesh, &counts[1], &err), err);
            test_assert_same_mesh(&once, &mesh);
            assert_int_equal(counts[0].border_loops, counts[1].border_loops);
            test_change(&v, e);
        }
        cw_mesh_free(&mesh);
        cw_mesh_free(&once);
        cw_extractor_free(e);
        cw_volume_free(&v);
    }
}

static void a_filled_mesh_is_written_over_or_freed(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_SPHERE, 60, CW_F32);
    const cw_extract_desc some = {.isovalue = 0}, none = {.isovalue = 1e6},
                          bad = {.isovalue = NAN};
    cw_extractor *e;
    cw_mesh mesh = {0}, copy = {0};
    cw_error err = {0};
    const size_t before = cw_memory_used();
    assert_ok(cw_extractor_new(&v, &e, &err), err);
    assert_ok(cw_extractor_extract(e, &some, &mesh, NULL, &err), err);
    const float *positions = mesh.positions;
    for (int frame = 0; frame < 3; frame++) {
        assert_ok(cw_extractor_update(e, NULL, &err), err);
        assert_ok(cw_extractor_extract(e, &some, &mesh, NULL, &err), err);
        assert_ptr_equal(mesh.positions, positions);
    }
    assert_ok(cw_extractor_extract(e, &none, &mesh, NULL, &err), err); /* keeps the arrays */
    assert_null(mesh.positions);
    assert_ok(cw_extractor_extract(e, &some, &mesh, NULL, &err), err);
    assert_ptr_equal(mesh.positions, positions);
    assert_fails(cw_extractor_extract(e, &bad, &mesh, NULL, &err), CW_ERR_ARGUMENT, "finite",
                 err);
    assert_null(mesh.positions);
    cw_extractor_free(e);

    assert_ok(cw_extract(&v, &some, &mesh, NULL, &err), err);
    mesh.colors = cwi_alloc_zeroed(mesh.vertex_count, 4); /* of the old surface: freed */
    assert_ok(cw_extract(&v, &some, &mesh, NULL, &err), err);
    assert_null(mesh.colors);
    assert_ok(cw_extract(&v, &some, &copy, NULL, &err), err);
    test_assert_same_mesh(&mesh, &copy);
    assert_ok(cw_extract(&v, &none, &mesh, NULL, &err), err);
    assert_null(mesh.positions);
    assert_fails(cw_extract(&v, &bad, &copy, NULL, &err), CW_ERR_ARGUMENT, "finite", err);
    assert_null(copy.positions);
    assert_int_equal(cw_memory_used(), before);
    cw_volume_free(&v);
}

static cw_status refuse_brick(void *user, const cw_brick *brick, cw_error *err)
{
    (void)user;
    (void)brick;
    (void)err;
    fail_msg("a brick was given");
    return CW_ERR_ARGUMENT;
}

static void wrong_boxes_and_grids_are_refused(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_SPHERE, 20, CW_F32);
    cw_extractor *e;
    cw_error err = {0};
    const cw_brick_sink sink = {refuse_brick, NULL};
    test_grid g;
    assert_ok(cw_extractor_new(&v, &e, &err), err);
    assert_fails(cw_extractor_update(NULL, NULL, &err), CW_ERR_ARGUMENT, "e", err);
    assert_fails(cw_extractor_update(e, &(cw_box){{0, 0, 0}, {20, 0, 20}}, &err),
                 CW_ERR_ARGUMENT, "box", err);
    assert_fails(cw_extractor_update(e, &(cw_box){{1, 0, 0}, {20, 1, 1}}, &err),
                 CW_ERR_ARGUMENT, "leaves", err);
    assert_fails(cw_extractor_update(e, &(cw_box){{1, 0, 0}, {SIZE_MAX, 1, 1}}, &err),
                 CW_ERR_ARGUMENT, "leaves", err);
    assert_fails(cw_extractor_extract_changed(e, &(cw_extract_desc){.snap = 0.3}, sink, &err),
                 CW_ERR_ARGUMENT, "snap", err);
    assert_fails(
        cw_extractor_extract_changed(e, &(cw_extract_desc){.isovalue = NAN}, sink, &err),
        CW_ERR_ARGUMENT, "finite", err);
    cw_extractor_free(e);
    cw_volume_free(&v);

    test_grid_make(&g, TEST_MIXED, 3, 0);
    assert_ok(cw_extractor_new(&g.volume, &e, &err), err);
    assert_ok(cw_extractor_update(e, NULL, &err), err);
    assert_fails(cw_extractor_update(e, &(cw_box){{0, 0, 0}, {1, 1, 1}}, &err),
                 CW_ERR_UNSUPPORTED, "irregular", err);
    assert_fails(cw_extractor_extract_changed(e, NULL, sink, &err), CW_ERR_UNSUPPORTED,
                 "irregular", err);
    cw_extractor_free(e);
    test_grid_free(&g);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_frame_is_as_from_scratch),
        cmocka_unit_test(a_filled_mesh_is_written_over_or_freed),
        cmocka_unit_test(wrong_boxes_and_grids_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
