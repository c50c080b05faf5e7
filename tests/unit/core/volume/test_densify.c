/* Dense copies of sparse grids, and the corners of volumes of every kind. */
#include "support/cells.h"
#include "support/sparse.h"
#include "support/surface.h"

#include "core/base/memory.h"

#include <math.h>
#include <string.h>

/* Voxels in bricks of one value and of noise, so that tiles, leaves and background all occur. */
static cw_volume make_bricks(cw_type type)
{
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&v, type, (size_t[3]){24, 16, 32}, 1, 1, &err), err);
    unsigned char *bytes = cw_volume_voxels(&v);
    const size_t width = cw_type_size(type);
    memset(bytes, 0, 24 * 16 * 32 * width);
    for (size_t n = 0; n < 24 * 16 * 32; n++) {
        const size_t brick = n % 24 / 8 + n / 24 % 16 / 8 * 3 + n / (24 * 16) / 8 * 6;
        bytes[n * width] = (unsigned char)(brick % 3 == 0 ? 7 : brick % 3 == 1 ? 50 : n * 7);
    }
    v.affine[0][0] = 0.5;
    v.affine[1][1] = v.affine[2][2] = 2;
    v.affine[2][3] = -9;
    v.slope = 3;
    v.has_nodata = true;
    v.nodata = 50;
    v.known = CW_KNOWN_UNIT;
    return v;
}

static void dense_again_every_voxel_is_what_it_was(void **state)
{
    (void)state;
    for (int type = 0; type < CW_TYPE_COUNT; type++) {
        cw_volume dense = make_bricks((cw_type)type), again;
        cw_volume sparse = test_sparse_of(&dense, 7);
        cw_error err = {0};
        assert_true(sparse.sparse->leaf_count && sparse.sparse->tile_count);
        assert_ok(cw_volume_densify(&sparse, 24 * 16 * 32, &again, &err), err);
        assert_int_equal(again.type, type);
        assert_memory_equal(again.dim, sparse.dim, sizeof again.dim);
        assert_memory_equal(again.affine, sparse.affine, sizeof again.affine);
        assert_true(again.slope == sparse.slope && again.nodata == sparse.nodata);
        assert_int_equal(again.has_nodata, sparse.has_nodata);
        assert_int_equal(again.known, sparse.known);
        assert_null(again.sparse);
        assert_memory_equal(again.data, dense.data, 24 * 16 * 32 * cw_type_size((cw_type)type));
        cw_volume_free(&again);
        cw_volume_free(&sparse);
        cw_volume_free(&dense);
    }
}

/* Leaves and tiles may reach beyond the box: only what is inside counts. */
static void leaves_and_tiles_are_cut_at_the_box(void **state)
{
    (void)state;
    cw_volume dense = make_bricks(CW_I16), cut;
    cw_volume sparse = test_sparse_of(&dense, 7);
    cw_error err = {0};
    sparse.dim[0] = 21;
    sparse.dim[1] = 11;
    sparse.dim[2] = 30;
    assert_ok(cw_volume_densify(&sparse, SIZE_MAX, &cut, &err), err);
    for (size_t k = 0; k < 30; k++)
        for (size_t j = 0; j < 11; j++)
            assert_memory_equal((const int16_t *)cut.data + (k * 11 + j) * 21,
                                (const int16_t *)dense.data + (k * 16 + j) * 24, 21 * 2);
    cw_volume_free(&cut);
    cw_volume_free(&sparse);
    cw_volume_free(&dense);
}

static void what_cannot_be_dense_is_refused(void **state)
{
    (void)state;
    cw_volume dense = make_bricks(CW_U8), out;
    cw_volume sparse = test_sparse_of(&dense, 7);
    cw_error err = {0};
    assert_fails(cw_volume_densify(&sparse, 24 * 16 * 32 - 1, &out, &err), CW_ERR_LIMIT,
                 "24 x 16 x 32 voxels; the limit is 12287", err);
    assert_null(out.data);
    assert_fails(cw_volume_densify(&dense, SIZE_MAX, &out, &err), CW_ERR_ARGUMENT, "sparse",
                 err);
    assert_null(out.data);
    cwi_alloc_fail_after(0);
    const cw_status st = cw_volume_densify(&sparse, SIZE_MAX, &out, &err);
    cwi_alloc_fail_after(-1);
    assert_int_equal(st, CW_ERR_NO_MEMORY);
    assert_null(out.data);
    cw_volume_free(&sparse);
    cw_volume_free(&dense);
}

static void corners_are_the_outermost_samples(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_SPHERE, 5, CW_F32);
    double corners[8][3];
    for (int round = 0; round < 20; round++) {
        test_turn(&v, round);
        cw_volume_corners(&v, corners);
        for (int n = 0; n < 8; n++) {
            double index[3];
            cw_error err = {0};
            assert_ok(cw_volume_to_index(&v, corners[n], index, &err), err);
            for (int a = 0; a < 3; a++)
                assert_near(index[a], n >> a & 1 ? 4 : 0, 1e-6);
        }
    }
    cw_volume_free(&v);
    const double x[3] = {1, 2, 10}, y[2] = {-4, 4}, z[2] = {0, 0.5};
    const cw_volume uneven = {.dim = {3, 2, 2}, .coordinates = {x, y, z}};
    cw_volume_corners(&uneven, corners);
    assert_true(corners[0][0] == 1 && corners[0][1] == -4 && corners[0][2] == 0);
    assert_true(corners[7][0] == 10 && corners[7][1] == 4 && corners[7][2] == 0.5);
}

/* An irregular grid has no corners of its own: those of its box, in the world. */
static void corners_of_cells_are_those_of_their_box(void **state)
{
    (void)state;
    test_grid g = {0};
    double corners[8][3];
    test_grid_make(&g, TEST_MIXED, 3, 0);
    const double affine[3][4] = {{0, -2, 0, 5}, {3, 0, 0, 0}, {0, 0, 1, 0}};
    memcpy(g.volume.affine, affine, sizeof affine);
    cw_volume_corners(&g.volume, corners);
    for (int n = 0; n < 8; n++) {
        assert_near(corners[n][0], n & 1 ? 7 : 3, 1e-12);
        assert_near(corners[n][1], n & 2 ? 3 : -3, 1e-12);
        assert_near(corners[n][2], n & 4 ? 1 : -1, 1e-12);
    }
    test_grid_free(&g);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(dense_again_every_voxel_is_what_it_was),
        cmocka_unit_test(leaves_and_tiles_are_cut_at_the_box),
        cmocka_unit_test(what_cannot_be_dense_is_refused),
        cmocka_unit_test(corners_are_the_outermost_samples),
        cmocka_unit_test(corners_of_cells_are_those_of_their_box),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
