/* Sparse grids: the surface of the dense grid, whatever is kept as leaves, tiles or not
 * at all. */
#include "support/sparse.h"
#include "support/surface.h"

#include "core/base/memory.h"
#include "extract/dense/isa_dispatch.h"
#include "extract/extract_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A field of the world with a rim of background, three leaves wide at most. */
typedef double (*field)(double x, double y, double z);

static double ball(double x, double y, double z)
{
    return 19 - sqrt((x - 34) * (x - 34) + (y - 23) * (y - 23) + (z - 26) * (z - 26));
}

static double sponge(double x, double y, double z)
{
    const double s = 0.45;
    return sin(s * x) * cos(s * y) + sin(s * y) * cos(s * z) + sin(s * z) * cos(s * x);
}

static double noise(double x, double y, double z)
{
    uint32_t h =
        (uint32_t)x * 0x9e3779b1u ^ (uint32_t)y * 0x85ebca77u ^ (uint32_t)z * 0xc2b2ae3du;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    h = (h ^ h >> 12) * 0x297a2d39u;
    return (double)((h ^ h >> 15) % 7) - 3; /* many samples at the isovalue */
}

static const size_t dim[3] = {80, 48, 56}; /* several blocks along each axis */

/* Cuts off the field beyond `far` from the surface of the ball, as narrow bands are. */
static cw_volume make_dense(field f, cw_type type, double scale, double far)
{
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&v, type, dim, 1, 1, &err), err);
    for (size_t n = 0; n < dim[0] * dim[1] * dim[2]; n++) {
        const size_t i = n % dim[0], j = n / dim[0] % dim[1], k = n / dim[0] / dim[1];
        const double x = (double)i, y = (double)j, z = (double)k;
        const bool rim = i < 3 || j < 3 || k < 3 || i > 74 || j > 43 || k > 50;
        const double bound = fmin(fmax(ball(x, y, z), -far), far);
        const double value = rim ? -far : f == ball ? bound : bound > -far ? f(x, y, z) : -far;
        const double stored = rint(value * scale);
        switch (type) {
        case CW_F32:
            ((float *)v.owned)[n] = (float)value;
            break;
        case CW_F64:
            ((double *)v.owned)[n] = value;
            break;
        case CW_I16:
            ((int16_t *)v.owned)[n] = (int16_t)stored;
            break;
        default:
            ((uint8_t *)v.owned)[n] = (uint8_t)(stored + 100);
        }
    }
    return v;
}

static double stored_background(cw_type type, double scale, double far)
{
    const double value = -far;
    return type == CW_F32 || type == CW_F64 ? value
           : type == CW_I16                 ? rint(value * scale)
                                            : rint(value * scale) + 100;
}

static void check_like_dense(const cw_volume *dense, const cw_volume *sparse,
                             const cw_extract_desc *d)
{
    cw_extract_counts counts, predicted;
    cw_error err = {0};
    cw_mesh a = test_extract(dense, d, NULL), b = test_extract(sparse, d, &counts);
    assert_true(a.triangle_count > 1000);
    test_assert_same_triangles(&a, &b);
    test_check_promise(&b, false);
    assert_int_equal(counts.triangles, b.triangle_count);
    assert_ok(cw_extract_predict(sparse, d, &predicted, &err), err);
    assert_int_equal(predicted.triangles, b.triangle_count);
    assert_int_equal(predicted.vertices, b.vertex_count);
    cw_mesh_free(&a);
    cw_mesh_free(&b);
}

static void test_fields_and_types(void **state)
{
    static const field fields[] = {ball, sponge, noise};
    static const struct {
        cw_type type;
        double scale;
    } types[] = {{CW_F32, 1}, {CW_F64, 1}, {CW_I16, 100}, {CW_U8, 10}};
    (void)state;
    for (size_t f = 0; f < 3; f++)
        for (size_t t = test_is_short() ? f : 0; t < 4; t += test_is_short() ? 3 : 1) {
            const double scale = f == 2 ? 1 : types[t].scale, far = 3;
            cw_volume dense = make_dense(fields[f], types[t].type, scale, far);
            cw_volume sparse =
                test_sparse_of(&dense, stored_background(types[t].type, scale, far));
            cw_extract_desc d = {.isovalue = types[t].type == CW_U8 ? 100 : 0};
            assert_true(sparse.sparse->leaf_count < dim[0] * dim[1] * dim[2] / 512 / 2);
            check_like_dense(&dense, &sparse, &d);
            cw_volume_free(&dense);
            cw_volume_free(&sparse);
        }
}

/* Level sets are low inside; tables, cubics, no normals; a mirrored and sheared world. */
static void test_settings(void **state)
{
    (void)state;
    for (int round = 0; round < 6; round++) {
        cw_volume dense = make_dense(round % 2 ? sponge : noise, CW_F32, 1, 3);
        if (round == 1)
            for (size_t n = 0; n < dim[0] * dim[1] * dim[2]; n++)
                ((float *)dense.owned)[n] *= -1;
        test_turn(&dense, round);
        cw_volume sparse = test_sparse_of(&dense, round == 1 ? 3 : -3);
        const cw_extract_desc d = {.isovalue = 0.25,
                                   .inside_is_low = round == 1,
                                   .simple_topology = round == 2,
                                   .cubic_placement = round == 3,
                                   .no_normals = round == 4,
                                   .leave_open = round == 5};
        check_like_dense(&dense, &sparse, &d);
        cw_volume_free(&dense);
        cw_volume_free(&sparse);
    }
}

static void test_scaled_values(void **state)
{
    (void)state;
    cw_volume dense = make_dense(sponge, CW_I16, 100, 3);
    dense.slope = -0.01;
    dense.intercept = 5;
    cw_volume sparse = test_sparse_of(&dense, -300);
    check_like_dense(&dense, &sparse,
                     &(cw_extract_desc){.isovalue = 5.1, .inside_is_low = true});
    cw_volume_free(&dense);
    cw_volume_free(&sparse);
}

/* Samples without a value, in leaves and as the background, are outside. */
static void test_missing_values(void **state)
{
    (void)state;
    cw_volume dense = make_dense(ball, CW_F32, 1, 3);
    float *x = cw_volume_voxels(&dense);
    for (size_t n = 0; n < dim[0] * dim[1] * dim[2]; n++)
        x[n] = x[n] == -3 || noise((double)n, 1, 2) > 2 ? NAN : x[n];
    cw_volume sparse = test_sparse_of(&dense, NAN);
    check_like_dense(&dense, &sparse, &(cw_extract_desc){.isovalue = -1});
    cw_volume_free(&dense);
    cw_volume_free(&sparse);

    cw_volume numbers = make_dense(noise, CW_I16, 100, 3);
    numbers.has_nodata = true;
    numbers.nodata = -300; /* the background, too */
    for (size_t n = 0; n < dim[0] * dim[1] * dim[2]; n += 35)
        ((int16_t *)numbers.owned)[n] = -300;
    cw_volume tree = test_sparse_of(&numbers, -300);
    const cw_extract_desc cubic = {.isovalue = -50, .cubic_placement = true};
    check_like_dense(&numbers, &tree, &(cw_extract_desc){.isovalue = -50});
    check_like_dense(&numbers, &tree, &cubic);
    numbers.nodata = tree.nodata = 12345; /* no voxel has it */
    check_like_dense(&numbers, &tree, &cubic);
    cw_volume_free(&numbers);
    cw_volume_free(&tree);
}

static void test_engines_and_threads(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_volume dense = make_dense(noise, CW_F32, 1, 3), sparse = test_sparse_of(&dense, -3);
    cw_mesh first = test_extract(&sparse, &(cw_extract_desc){.threads = 1}, NULL);
    const cwi_engine *engine;
    for (size_t n = 0; (engine = cwi_engine_at(n)); n++)
        for (int threads = 1; threads <= 3; threads += 2) {
            cw_mesh m = {0};
            const cw_extract_desc d = {.threads = threads};
            assert_ok(cwi_extract_with(engine, &sparse, &d, &m, NULL, &err), err);
            test_assert_same_mesh(&first, &m);
            cw_mesh_free(&m);
        }
    cw_mesh_free(&first);
    cw_volume_free(&dense);
    cw_volume_free(&sparse);
}

static cw_status count_slab(void *user, const cw_slab *slab, cw_error *err)
{
    size_t *slabs = user;
    (void)err;
    assert_true(slab->last);
    assert_int_equal(slab->triangles, slab->mesh->triangle_count);
    assert_int_equal(slab->seam[0], 0);
    (*slabs)++;
    return CW_OK;
}

static void test_extractor_and_slabs(void **state)
{
    size_t slabs = 0;
    cw_error err = {0};
    cw_extractor *e;
    cw_extract_counts counts;
    (void)state;
    cw_volume dense = make_dense(ball, CW_F32, 1, 3), sparse = test_sparse_of(&dense, -3);
    assert_ok(cw_extractor_new(&sparse, &e, &err), err);
    for (int n = -2; n <= 2; n++) {
        const cw_extract_desc d = {.isovalue = n};
        cw_mesh whole = test_extract(&sparse, &d, NULL), m = {0};
        assert_ok(cw_extractor_extract(e, &d, &m, NULL, &err), err);
        test_assert_same_mesh(&whole, &m);
        cw_mesh_free(&whole);
        cw_mesh_free(&m);
    }
    cw_extractor_free(e);
    assert_ok(
        cw_extract_slabs(&sparse, NULL, 100, (cw_slab_sink){count_slab, &slabs}, &counts, &err),
        err);
    assert_int_equal(slabs, 1);
    cw_volume_free(&dense);
    cw_volume_free(&sparse);
}

/* Tiles larger than blocks, alone and beside one another, in an index space that no dense grid
 * could have. */
static void test_tiles(void **state)
{
    (void)state;
    const cw_tile tiles[] = {{{1u << 28, 5, 1u << 27}, {16, 16, 16}, 2},
                             {{(1u << 28) + 16, 5, 1u << 27}, {4, 20, 3}, 3},
                             {{0, 0, 0}, {1, 1, 1}, 9}};
    const cw_sparse s = {.tile_count = 3, .tiles = tiles};
    const cw_volume v = {
        .type = CW_F32, .dim = {(size_t)1 << 32, 4096, (size_t)1 << 31}, .sparse = &s};
    cw_mesh m = test_extract(&v, &(cw_extract_desc){.isovalue = 1}, NULL);
    const cw_quality q = test_measure(&m);
    /* the squares of cells around a box of n samples: two a face of n - 1, and its
     * rounding off */
    assert_int_equal(q.components, 2);
    assert_int_equal(q.open_edges, 0);
    assert_int_equal(q.nonmanifold_edges, 0);
    assert_int_equal(q.euler, 4);
    cw_mesh_free(&m);
}

/* A tile whose sides alone are more than memory may hold is refused at once. */
static void test_too_large(void **state)
{
    const cw_tile tile = {{0, 0, 0}, {1u << 29, 1u << 29, 1u << 29}, 2};
    const cw_sparse s = {.tile_count = 1, .tiles = &tile};
    const size_t side = (size_t)1 << 32;
    const cw_volume v = {.type = CW_F32, .dim = {side, side, side}, .sparse = &s};
    cw_error err = {0};
    cw_mesh m = {0};
    (void)state;
    assert_fails(cw_extract(&v, &(cw_extract_desc){.isovalue = 1, .max_bytes = 10000000}, &m,
                            NULL, &err),
                 CW_ERR_LIMIT, "max_bytes", err);
}

static void test_nothing_there(void **state)
{
    const cw_sparse none = {.background = 1};
    const cw_volume v = {.type = CW_F32, .dim = {8, 8, 8}, .sparse = &none};
    (void)state;
    cw_mesh m = test_extract(&v, NULL, NULL);
    assert_int_equal(m.triangle_count, 0);
    cw_mesh_free(&m);
}

static void test_refusals(void **state)
{
    cw_error err = {0};
    cw_mesh m = {0};
    cw_statistics range;
    (void)state;
    cw_volume dense = make_dense(ball, CW_F32, 1, 3), sparse = test_sparse_of(&dense, -3),
              v = sparse;
    assert_fails(cw_extract(&v, &(cw_extract_desc){.snap = 0.3}, &m, NULL, &err),
                 CW_ERR_UNSUPPORTED, "a sparse grid", err);
    assert_fails(cw_extract(&v, &(cw_extract_desc){.max_triangles = 100}, &m, NULL, &err),
                 CW_ERR_LIMIT, "max_triangles", err);
    assert_fails(cw_extract(&v, &(cw_extract_desc){.max_bytes = 100000}, &m, NULL, &err),
                 CW_ERR_LIMIT, "max_bytes", err);
    assert_fails(cw_extract(&v, &(cw_extract_desc){.isovalue = NAN}, &m, NULL, &err),
                 CW_ERR_ARGUMENT, "not finite", err);
    assert_fails(cw_volume_crop(&v, &(cw_box){{0, 0, 0}, {8, 8, 8}}, &v, &err),
                 CW_ERR_UNSUPPORTED, "a crop on a sparse grid", err);
    v.dim[0] = 48;
    assert_fails(cw_extract(&v, NULL, &m, NULL, &err), CW_ERR_ARGUMENT,
                 "is beyond the volume's", err);
    const cw_tile tile = {{0, 0, 0}, {1, 1, 1}, 300};
    const cw_sparse s = {.tile_count = 1, .tiles = &tile};
    v = (cw_volume){.type = CW_U8, .dim = {8, 8, 8}, .sparse = &s};
    assert_fails(cw_extract(&v, NULL, &m, NULL, &err), CW_ERR_ARGUMENT, "u8 cannot hold", err);
    assert_ok(cw_volume_statistics(&sparse, 0, 1, &range, &err), err);
    assert_true(range.min == -3 && range.max == 3);
    assert_int_equal(range.finite, 512 * sparse.sparse->leaf_count);
    cw_volume_free(&dense);
    cw_volume_free(&sparse);
}

/* Overlapping leaves and tiles are refused, or what came last counts: there is a mesh, or a
 * word. */
static void test_overlaps(void **state)
{
    (void)state;
    bool refused = false;
    for (uint32_t round = 0; round < 60; round += test_is_short() ? 5 : 1) {
        cw_tile tiles[40];
        cw_error err = {0};
        cw_mesh m = {0};
        for (uint32_t n = 0; n < 40; n++) {
            tiles[n].value = (n + round) % 3;
            for (int a = 0; a < 3; a++) {
                const double x = fabs(noise(n, round, a)) + fabs(noise(a, n, round + 100));
                tiles[n].at[a] = (uint32_t)(2 * x + fabs(noise(round, a, n)));
                tiles[n].size[a] = 1 + (n + round) % 7;
            }
        }
        const cw_sparse s = {.tile_count = 40, .tiles = tiles, .background = round % 2 ? 0 : 2};
        const cw_volume v = {.type = CW_F32, .dim = {256, 256, 256}, .sparse = &s};
        const cw_status st =
            cw_extract(&v, &(cw_extract_desc){.isovalue = 1.5}, &m, NULL, &err);
        assert_true(st == CW_OK || st == CW_ERR_ARGUMENT);
        refused = refused || st == CW_ERR_ARGUMENT;
        cw_mesh_free(&m);
    }
    assert_true(refused);
}

static void test_no_memory_and_stops(void **state)
{
    cw_error err = {0};
    cw_mesh m = {0};
    (void)state;
    cw_volume dense = make_dense(ball, CW_F32, 1, 3), sparse = test_sparse_of(&dense, -3);
    cw_status st = CW_ERR_NO_MEMORY;
    for (long n = 0; st != CW_OK; n++) {
        cwi_alloc_fail_after(n);
        st = cw_extract(&sparse, &(cw_extract_desc){.threads = 1}, &m, NULL, &err);
        cwi_alloc_fail_after(-1);
        assert_true(st == CW_OK || st == CW_ERR_NO_MEMORY);
    }
    cw_mesh_free(&m);
    st = CW_ERR_CANCELLED;
    for (int polls = 0; st != CW_OK; polls++) {
        int left = polls;
        const cw_extract_desc d = {.threads = 1, .progress = {test_stop_after, &left}};
        st = cw_extract(&sparse, &d, &m, NULL, &err);
        assert_true(st == CW_OK || st == CW_ERR_CANCELLED);
    }
    cw_mesh_free(&m);
    cw_volume_free(&dense);
    cw_volume_free(&sparse);
}

/* Tiles and the background have numbers of the voxels' type, its lowest and highest too. */
static void what_a_type_cannot_hold_is_refused(void **state)
{
    (void)state;
    static const struct {
        cw_type type;
        double value;
        bool fits;
    } rows[] = {
        {CW_U8, 255, true},
        {CW_U8, 256, false},
        {CW_U8, 0, true},
        {CW_U8, -1, false},
        {CW_U8, 0.5, false},
        {CW_I8, -128, true},
        {CW_I8, -129, false},
        {CW_I8, 127, true},
        {CW_I8, 128, false},
        {CW_U16, 65535, true},
        {CW_U16, 65536, false},
        {CW_I16, -32768, true},
        {CW_I16, 32768, false},
        {CW_U32, 4294967295, true},
        {CW_U32, 4294967296, false},
        {CW_I32, -2147483648.0, true},
        {CW_I32, 2147483648, false},
        {CW_F32, 0.5, true},
        {CW_F64, 1e300, true},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++)
        for (int in_background = 0; in_background < 2; in_background++) {
            const cw_tile tile = {{0, 0, 0}, {1, 1, 1}, in_background ? 0 : rows[n].value};
            const cw_sparse s = {.tile_count = 1,
                                 .tiles = &tile,
                                 .background = in_background ? rows[n].value : 0};
            const cw_volume v = {.type = rows[n].type, .dim = {16, 8, 8}, .sparse = &s};
            cw_error err = {0};
            cw_mesh m = {0};
            if (rows[n].fits)
                assert_ok(cw_extract(&v, NULL, &m, NULL, &err), err);
            else
                assert_fails(cw_extract(&v, NULL, &m, NULL, &err), CW_ERR_ARGUMENT,
                             "cannot hold", err);
            cw_mesh_free(&m);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fields_and_types),
        cmocka_unit_test(what_a_type_cannot_hold_is_refused),
        cmocka_unit_test(test_settings),
        cmocka_unit_test(test_scaled_values),
        cmocka_unit_test(test_missing_values),
        cmocka_unit_test(test_engines_and_threads),
        cmocka_unit_test(test_extractor_and_slabs),
        cmocka_unit_test(test_tiles),
        cmocka_unit_test(test_too_large),
        cmocka_unit_test(test_nothing_there),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_overlaps),
        cmocka_unit_test(test_no_memory_and_stops),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
