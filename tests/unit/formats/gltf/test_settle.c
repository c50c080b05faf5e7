/* Compressed surfaces whose vertices stand closer than the steps of the grid: they stay apart. */
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/base/module.h"
#include "core/mesh/weld.h"

#include <math.h>
#include <string.h>

static const cw_compression KINDS[] = {CW_COMPRESS_QUANTIZE, CW_COMPRESS_DRACO,
                                       CW_COMPRESS_MESHOPT};
enum { KIND_COUNT = sizeof KINDS / sizeof *KINDS, SIDE = 24 };

static bool is_there(cw_compression kind)
{
    return kind == CW_COMPRESS_QUANTIZE ||
           cwi_module_present(kind == CW_COMPRESS_DRACO ? "draco" : "meshopt");
}

/* A head whose whole numbers often equal the isovalue: up to six vertices then stand within 1/1024 of a voxel
 * around a sample. */
static cw_mesh make_crowded(double scale)
{
    cw_volume v;
    cw_error err = {0};
    const cw_field_desc desc = {.field = CW_FIELD_CT_HEAD,
                                .dim = {SIDE, SIDE, SIDE},
                                .type = CW_F32,
                                .noise = 150,
                                .seed = 5};
    assert_ok(cw_field_sample(&desc, &v, &err), err);
    float *values = cw_volume_voxels(&v);
    for (size_t n = 0; n < SIDE * SIDE * SIDE; n++)
        values[n] = roundf(values[n] / 50); /* few values */
    for (int n = 0; n < 12; n++)
        v.affine[n / 4][n % 4] *= scale;
    cw_mesh mesh = test_extract(&v, &(cw_extract_desc){.isovalue = 6}, NULL);
    cw_volume_free(&v);
    return mesh;
}

static size_t count_places(const cw_mesh *mesh)
{
    uint32_t *map = cwi_alloc_array(mesh->vertex_count, sizeof *map);
    size_t places = 0;
    assert_non_null(map);
    assert_true(cwi_weld(mesh->positions, mesh->vertex_count, map));
    for (size_t v = 0; v < mesh->vertex_count; v++)
        places += map[v] == v;
    cwi_free(map);
    return places;
}

static void vertices_that_would_fall_together_stay_apart(void **state)
{
    (void)state;
    static const double scales[] = {1, 1e-4, 1e4};
    for (size_t s = 0; s < 3; s++) {
        cw_mesh mesh = make_crowded(scales[s]);
        for (size_t k = 0; k < KIND_COUNT; k++)
            for (int bits = 10; bits <= 14 && is_there(KINDS[k]); bits += 2) {
                cw_compressed told = {0};
                cw_error err = {0};
                cw_mesh back;
                const cw_write_desc desc = {
                    .compression = KINDS[k], .bits = bits, .compressed = &told};
                cw_distance d;
                assert_ok(cw_mesh_write(test_path("a.glb"), &mesh, &desc, &err), err);
                assert_true(told.merged == 0 && told.flat == 0 && told.settled > 20);
                assert_true(told.error_mm < 4.4 * told.step_mm); /* two steps and a half */
                assert_ok(cw_mesh_read(test_path("a.glb"), NULL, &back, NULL, &err), err);
                const cw_quality q = test_measure(&back);
                assert_true(q.open_edges == 0 && q.nonmanifold_edges == 0);
                assert_int_equal(count_places(&back), mesh.vertex_count);
                assert_int_equal(back.triangle_count, mesh.triangle_count);
                assert_ok(cw_distance_to_mesh(&back, &mesh, NULL, &d, NULL, &err), err);
                assert_true(d.max_mm <= told.error_mm * 1.0001);
                cw_mesh_free(&back);
            }
        cw_mesh_free(&mesh);
    }
}

/* The coarsest grid within the tolerance is chosen, though rounding alone would need a finer one. */
static void tolerances_hold(void **state)
{
    (void)state;
    cw_mesh mesh = make_crowded(1);
    for (size_t k = 0; k < KIND_COUNT; k++) {
        cw_compressed told = {0};
        cw_error err = {0};
        const cw_write_desc desc = {
            .compression = KINDS[k], .tolerance_mm = 0.02, .compressed = &told};
        if (!is_there(KINDS[k]))
            continue;
        assert_ok(cw_mesh_write(test_path("a.glb"), &mesh, &desc, &err), err);
        assert_true(told.error_mm <= 0.02 && told.settled > 0);
        assert_true(told.bits <= 14); /* 1/1024 of a voxel would take 17 */
    }
    cw_mesh_free(&mesh);
}

/* The same positions in two parts are the same afterwards. */
static void parts_still_meet(void **state)
{
    (void)state;
    cw_mesh mesh = make_crowded(1);
    const cw_part parts[] = {{.mesh = &mesh, .name = "one"}, {.mesh = &mesh, .name = "two"}};
    for (size_t k = 0; k < KIND_COUNT; k++) {
        cw_error err = {0};
        cw_mesh back;
        const cw_write_desc desc = {.compression = KINDS[k], .bits = 12};
        if (!is_there(KINDS[k]))
            continue;
        assert_ok(cw_parts_write(test_path("b.glb"), parts, 2, &desc, &err), err);
        assert_ok(cw_mesh_read(test_path("b.glb"), NULL, &back, NULL, &err), err);
        assert_int_equal(back.triangle_count, 2 * mesh.triangle_count);
        assert_int_equal(count_places(&back), mesh.vertex_count);
        cw_mesh_free(&back);
    }
    cw_mesh_free(&mesh);
}

static void memory_may_run_out(void **state)
{
    (void)state;
    cw_mesh mesh = make_crowded(1);
    const cw_write_desc desc = {.compression = CW_COMPRESS_QUANTIZE, .bits = 12};
    bool failed = true;
    for (long n = 0; failed; n++) {
        cw_error err = {0};
        cwi_alloc_fail_after(n);
        const cw_status st = cw_mesh_write(test_path("c.glb"), &mesh, &desc, &err);
        failed = cwi_alloc_fail_after(-1);
        if (!failed)
            assert_ok(st, err);
    }
    cw_mesh_free(&mesh);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(vertices_that_would_fall_together_stay_apart),
        TEST(tolerances_hold),
        TEST(parts_still_meet),
        TEST(memory_may_run_out),
    };
    return cwi_module_present("gltf") ? cmocka_run_group_tests(tests, NULL, NULL) : 0;
}
