/* Tests that shapes thin all over come back from a level set whose voxels are divided where
 * that helps. */
#include "support/surface.h"

#include "core/base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The surface of noise: sheets, gaps and specks of any thickness. */
static cw_mesh make_noise(size_t n, uint64_t seed)
{
    cw_volume volume;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&volume, CW_F32, (size_t[]){n, n, n}, 1, 1, &err), err);
    float *voxels = cw_volume_voxels(&volume);
    for (size_t k = 0; k < n * n * n; k++) {
        seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
        voxels[k] = (float)(seed >> 40) / (1 << 24);
    }
    cw_mesh mesh = test_extract(&volume, &(cw_extract_desc){.isovalue = 0.7F}, NULL);
    cw_volume_free(&volume);
    return mesh;
}

static double farthest(const cw_mesh *a, const cw_mesh *b)
{
    cw_distance d;
    cw_error err = {0};
    assert_ok(cw_distance_to_mesh(a, b, NULL, &d, NULL, &err), err);
    return d.max_mm;
}

static size_t more(int64_t now, int64_t before)
{
    return now > before ? (size_t)(now - before) : 0;
}

static int64_t handles(const cw_quality *q)
{
    return (int64_t)q->components - q->euler / 2;
}

static void assert_is_sound(const cw_mesh *mesh)
{
    const cw_quality q = test_measure(mesh);
    assert_true(cw_quality_is_closed_manifold(&q) && q.volume_mm3 > 0);
    assert_int_equal(q.degenerate + q.inside_out, 0);
    assert_int_equal(test_count_crossings(mesh), 0);
    for (size_t v = 0; v < 3 * mesh->vertex_count; v += 3) {
        const float *n = mesh->normals + v;
        assert_near((double)(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]), 1, 1e-5);
    }
}

/* None is off by more than 60 degrees from what the triangles around its vertex say. */
static void assert_normals_lean_on_triangles(const cw_mesh *mesh)
{
    double(*sums)[3] = calloc(mesh->vertex_count, sizeof *sums);
    assert_non_null(sums);
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *c = mesh->triangles + 3 * t;
        double u[3], v[3];
        for (size_t a = 0; a < 3; a++) {
            const double from = (double)mesh->positions[3 * (size_t)c[0] + a];
            u[a] = (double)mesh->positions[3 * (size_t)c[1] + a] - from;
            v[a] = (double)mesh->positions[3 * (size_t)c[2] + a] - from;
        }
        for (size_t k = 0; k < 3; k++)
            for (size_t a = 0; a < 3; a++)
                sums[c[k]][a] +=
                    u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
    }
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        const float *n = mesh->normals + 3 * v;
        const double *s = sums[v], length = sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]);
        const double along = s[0] * (double)n[0] + s[1] * (double)n[1] + s[2] * (double)n[2];
        assert_true(along >= 0.499 * length);
    }
    free(sums);
}

static void noise_comes_back(void **state)
{
    (void)state;
    static const double voxels[] = {1.3, 2.1, 0.7};
    for (size_t n = 0; n < (size_t)test_some(3); n++) {
        cw_mesh mesh = make_noise(6, n + 1), back;
        cw_offset_facts facts;
        cw_error err = {0};
        const double voxel = voxels[n];
        assert_ok(
            cw_mesh_offset(&mesh, &(cw_offset_desc){.voxel_mm = voxel}, &back, &facts, &err),
            err);
        assert_false(facts.is_astray);
        assert_true(facts.voxel_mm == voxel && facts.asked_mm == voxel);
        assert_true(facts.least_mm == voxel / 8);
        assert_true(farthest(&mesh, &back) <= 0.5 * voxel);
        assert_true(farthest(&back, &mesh) <= 0.5 * voxel);
        assert_is_sound(&back);
        assert_normals_lean_on_triangles(&back);
        const cw_quality before = test_measure(&mesh), now = test_measure(&back);
        assert_int_equal(facts.more_components,
                         more((int64_t)now.components, (int64_t)before.components));
        assert_int_equal(facts.more_handles, more(handles(&now), handles(&before)));
        cw_mesh_free(&mesh);
        cw_mesh_free(&back);
    }
}

/* Octahedra far smaller than any cell, wherever they are, and even if they are all there is. */
static void specks_come_back(void **state)
{
    (void)state;
    enum { SPECKS = 40 };
    static const uint32_t faces[8][3] = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                         {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    float positions[SPECKS * 6 * 3];
    uint32_t triangles[SPECKS * 8 * 3];
    for (size_t s = 0; s < SPECKS; s++) {
        const float middle[3] = {(float)(s % 4) * 5.3F, (float)(s / 4 % 4) * 4.7F,
                                 (float)(s / 16) * 5.9F};
        for (size_t v = 0; v < 6; v++)
            for (size_t a = 0; a < 3; a++)
                positions[3 * (6 * s + v) + a] =
                    middle[a] + (v / 2 == a ? (v % 2 ? -0.001F : 0.001F) : 0);
        for (size_t c = 0; c < 24; c++)
            triangles[24 * s + c] = (uint32_t)(6 * s) + faces[c / 3][c % 3];
    }
    cw_mesh back;
    cw_offset_facts facts;
    cw_error err = {0};
    const cw_mesh mesh = {.vertex_count = 6 * SPECKS,
                          .triangle_count = 8 * SPECKS,
                          .positions = positions,
                          .triangles = triangles};
    for (int n = 0; n < test_some(4); n++) {
        const double voxel = 0.9 + 0.13 * n;
        assert_ok(
            cw_mesh_offset(&mesh, &(cw_offset_desc){.voxel_mm = voxel}, &back, &facts, &err),
            err);
        assert_false(facts.is_astray);
        assert_true(farthest(&mesh, &back) <= 0.5 * voxel);
        assert_true(farthest(&back, &mesh) <= 0.5 * voxel);
        assert_true(test_measure(&back).components >= SPECKS);
        assert_is_sound(&back);
        cw_mesh_free(&back);
    }
}

static void threads_change_nothing(void **state)
{
    (void)state;
    cw_mesh mesh = make_noise(test_is_short() ? 4 : 7, 9), one, three;
    cw_error err = {0};
    assert_ok(cw_mesh_offset(&mesh, &(cw_offset_desc){.voxel_mm = 1.3, .threads = 1}, &one,
                             NULL, &err),
              err);
    assert_ok(cw_mesh_offset(&mesh, &(cw_offset_desc){.voxel_mm = 1.3, .threads = 3}, &three,
                             NULL, &err),
              err);
    test_assert_same_mesh(&one, &three);
    cw_mesh_free(&mesh);
    cw_mesh_free(&one);
    cw_mesh_free(&three);
}

/* Losses are reported where memory is limited, or smaller parts are not wanted. */
static void what_is_lost_is_told(void **state)
{
    (void)state;
    cw_mesh mesh = make_noise(6, 4), back;
    cw_offset_facts facts;
    cw_error err = {0};
    int astray = 0;
    assert_ok(cw_mesh_offset(&mesh, &(cw_offset_desc){.voxel_mm = 1.7, .no_refine = true},
                             &back, &facts, &err),
              err);
    assert_true(facts.is_astray && facts.least_mm == 0);
    assert_true(fmax(farthest(&mesh, &back), farthest(&back, &mesh)) > 0.85);
    cw_mesh_free(&back);
    for (size_t bytes = (size_t)1 << 27; bytes > 1 << 16; bytes /= 2) {
        const cw_offset_desc desc = {.voxel_mm = 1.7, .max_bytes = bytes};
        const cw_status st = cw_mesh_offset(&mesh, &desc, &back, &facts, &err);
        assert_true(st == CW_OK || st == CW_ERR_LIMIT);
        if (st != CW_OK)
            break;
        const double most = fmax(farthest(&mesh, &back), farthest(&back, &mesh));
        assert_int_equal(facts.is_astray, most > 0.85);
        astray += facts.is_astray;
        cw_mesh_free(&back);
    }
    assert_true(astray > 0);
    cw_mesh_free(&mesh);
}

static void running_out_of_memory_is_told(void **state)
{
    (void)state;
    cw_mesh mesh = make_noise(test_is_short() ? 3 : 4, 2), back;
    for (long n = 0;; n += 1 + n / (test_is_short() ? 4 : 16)) {
        cw_error err = {0};
        const cw_offset_desc desc = {.voxel_mm = 1.7, .threads = 1};
        cwi_alloc_fail_after(n);
        const cw_status st = cw_mesh_offset(&mesh, &desc, &back, NULL, &err);
        if (!cwi_alloc_fail_after(-1)) {
            assert_ok(st, err);
            cw_mesh_free(&back);
            break;
        }
        if (st == CW_OK) /* what was asked back could stay */
            cw_mesh_free(&back);
        else
            assert_int_equal(st, CW_ERR_NO_MEMORY);
        assert_null(back.positions);
    }
    cw_mesh_free(&mesh);
}

static void it_can_be_stopped(void **state)
{
    (void)state;
    cw_mesh mesh = make_noise(test_is_short() ? 4 : 6, 3), back;
    cw_error err = {0};
    for (int n = 0, st = CW_ERR_CANCELLED; st != CW_OK; n = n + 1 + n / 2) {
        int polls = n;
        const cw_offset_desc desc = {.voxel_mm = 1.7, .progress = {test_stop_after, &polls}};
        st = (int)cw_mesh_offset(&mesh, &desc, &back, NULL, &err);
        assert_true(st == CW_OK || (st == CW_ERR_CANCELLED && !back.positions));
        assert_true(n > 0 || st != CW_OK);
    }
    cw_mesh_free(&back);
    cw_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(noise_comes_back),
        cmocka_unit_test(specks_come_back),
        cmocka_unit_test(threads_change_nothing),
        cmocka_unit_test(what_is_lost_is_told),
        cmocka_unit_test(running_out_of_memory_is_told),
        cmocka_unit_test(it_can_be_stopped),
    };
    return cw_level_set_available() ? cmocka_run_group_tests(tests, NULL, NULL) : 0;
}
