/* Tests that surfaces of labels whose arrays overflow into files have the bytes of those in memory. */
#include "support/label_surfaces.h"

#include "core/base/memory.h"

#include <cubewright/field.h>

#include <stdlib.h>
#include <string.h>

enum { MAPS = 3, MB = 1 << 20 };

/* Makes cells, noise of five labels, or blocks that touch in edges and corners alone. */
static void make_map(cw_volume *v, int kind)
{
    static const size_t sides[MAPS] = {88, 44, 72};
    const size_t side = sides[kind], dim[3] = {side, side, side};
    cw_error err = {0};
    if (kind == 0) {
        const cw_label_field_desc desc = {
            .field = CW_LABEL_CELLS, .dim = {side, side, side}, .type = CW_U32, .labels = 400};
        assert_ok(cw_label_field_sample(&desc, v, &err), err);
        return;
    }
    assert_ok(cw_volume_alloc(v, CW_U32, dim, 1, 1, &err), err);
    uint32_t *to = cw_volume_voxels(v);
    for (size_t n = 0; n < side * side * side; n++) {
        const size_t x = n % side / 2, y = n / side % side / 2, z = n / side / side / 2;
        to[n] = kind == 1 ? (uint32_t)rand() % 6 : (x + y + z) % 2 ? 1 + (uint32_t)(x / 4) : 0;
    }
}

static void begin_overflow(size_t limit)
{
    cw_error err = {0};
    cw_memory_limit(cw_memory_used() + limit);
    assert_ok(cw_memory_overflow(&(cw_overflow_desc){.path = test_path("x.ply")}, &err), err);
}

static void end_overflow(void)
{
    assert_int_equal(cw_memory_overflow(NULL, NULL), CW_OK);
    cw_memory_limit(0);
}

/* Compares the mesh of each label, too. */
static void compare_labels(const cw_label_surfaces *a, const cw_label_surfaces *b)
{
    for (size_t n = 0; n < a->label_count; n += 1 + a->label_count / 8) {
        cw_mesh one, other;
        cw_error err = {0};
        assert_ok(cw_label_mesh(a, a->labels[n].label, &one, &err), err);
        assert_ok(cw_label_mesh(b, a->labels[n].label, &other, &err), err);
        assert_int_equal(one.triangle_count, other.triangle_count);
        assert_memory_equal(one.triangles, other.triangles, 12 * one.triangle_count);
        assert_memory_equal(one.positions, other.positions, 12 * one.vertex_count);
        cw_mesh_free(&one);
        cw_mesh_free(&other);
    }
}

static void surfaces_in_files_are_the_same(void **state)
{
    (void)state;
    test_seed(3);
    for (int kind = 0; kind < MAPS; kind++) {
        cw_volume v;
        make_map(&v, kind);
        for (int round = 0; round < 3; round++) {
            const cw_labels_desc desc = {.no_smoothing = round == 2, .threads = 1 + round % 2};
            cw_label_surfaces whole, got;
            cw_error err = {0};
            assert_ok(cw_extract_labels(&v, &desc, &whole, &err), err);
            begin_overflow(desc.no_smoothing ? 2 * MB : 6 * MB);
            assert_ok(cw_extract_labels(&v, &desc, &got, &err), err);
            assert_true(cwi_memory_is_in_file(got.mesh.triangles));
            end_overflow();
            test_assert_same_labels(&got, &whole);
            compare_labels(&got, &whole);
            cw_label_surfaces_free(&got);
            assert_int_equal(cw_memory_overflowed(), 0);
            cw_label_surfaces_free(&whole);
        }
        cw_volume_free(&v);
    }
    assert_int_equal(test_folder_entries(), 0);
}

/* Cancels at the n-th report. */
static bool count_down(void *user, const char *step, double done)
{
    size_t *left = user;
    (void)step, (void)done;
    return (*left)-- > 0;
}

static void a_cancelled_extraction_leaves_nothing(void **state)
{
    (void)state;
    cw_volume v;
    make_map(&v, 0);
    bool is_cancelled = true;
    for (size_t n = 0; is_cancelled; n += 1 + n / 4) {
        size_t left = n;
        cw_error err = {0};
        cw_label_surfaces s;
        const cw_labels_desc desc = {.threads = 1, .progress = {count_down, &left}};
        begin_overflow(6 * MB);
        const cw_status st = cw_extract_labels(&v, &desc, &s, &err);
        is_cancelled = st == CW_ERR_CANCELLED;
        assert_true(is_cancelled || st == CW_OK);
        cw_label_surfaces_free(&s);
        end_overflow();
        assert_int_equal(cw_memory_overflowed(), 0);
        assert_int_equal(test_folder_entries(), 0);
    }
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(surfaces_in_files_are_the_same, test_folder_make,
                                        test_folder_remove),
        cmocka_unit_test_setup_teardown(a_cancelled_extraction_leaves_nothing, test_folder_make,
                                        test_folder_remove),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
