/* Meshes that are copied out of the interfaces of labels: of a label, and of a patch. */
#include "support/support.h"

#include "core/base/memory.h"

#include <stdlib.h>
#include <string.h>

/* A map of four labels in a grid that is scaled and far from zero. */
static void extract_random(cw_label_surfaces *s)
{
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&v, CW_U32, (size_t[]){9, 8, 7}, 1, 1, &err), err);
    uint32_t *to = cw_volume_voxels(&v);
    srand(test_seed(40));
    for (size_t n = 0; n < 9 * 8 * 7; n++)
        to[n] = (uint32_t)(rand() % 5) * 1000000000u;
    v.affine[0][0] = 0.5;
    v.affine[1][1] = 2;
    v.affine[0][3] = 1e4;
    assert_ok(cw_extract_labels(&v, NULL, s, &err), err);
    cw_volume_free(&v);
}

/* Returns true if three points of a mesh are, in this order or turned, those of a triangle. */
static bool is_same(const cw_mesh *a, const uint32_t *corners, const cw_mesh *b,
                    const uint32_t *others)
{
    for (size_t turn = 0; turn < 3; turn++) {
        bool is = true;
        for (size_t c = 0; c < 3; c++)
            is = is && memcmp(a->positions + 3 * (size_t)corners[c],
                              b->positions + 3 * (size_t)others[(c + turn) % 3],
                              3 * sizeof(float)) == 0;
        if (is)
            return true;
    }
    return false;
}

/* The two labels of a patch have its triangles, with opposite winding. */
static void both_labels_have_a_patch(void **state)
{
    (void)state;
    cw_label_surfaces s;
    cw_error err = {0};
    extract_random(&s);
    assert_true(s.patch_count == 10);
    for (size_t p = 0; p < s.patch_count; p++) {
        const cw_label_patch *patch = &s.patches[p];
        cw_mesh mesh, sides[2];
        assert_ok(cw_label_patch_mesh(&s, patch, &mesh, &err), err);
        assert_int_equal(mesh.triangle_count, patch->count);
        assert_ok(cw_mesh_check(&mesh, &err), err);
        assert_memory_equal(mesh.origin, s.mesh.origin, sizeof mesh.origin);
        assert_ok(cw_label_mesh(&s, patch->labels[0], &sides[0], &err), err);
        assert_ok(cw_label_mesh(&s, patch->labels[1], &sides[1], &err), err);
        for (size_t t = 0; t < mesh.triangle_count; t++) {
            const uint32_t *c = mesh.triangles + 3 * t;
            assert_true(is_same(&mesh, c, &s.mesh, s.mesh.triangles + 3 * (patch->first + t)));
            for (int side = 0; side < 2; side++) {
                const uint32_t seen[3] = {c[0], c[side ? 2 : 1], c[side ? 1 : 2]};
                size_t found = 0;
                for (size_t u = 0; u < sides[side].triangle_count; u++)
                    found += is_same(&mesh, seen, &sides[side], sides[side].triangles + 3 * u);
                assert_int_equal(found, 1);
            }
        }
        cw_mesh_free(&mesh);
        cw_mesh_free(&sides[0]);
        cw_mesh_free(&sides[1]);
    }
    cw_label_surfaces_free(&s);
}

static void areas_of_patches_add_up(void **state)
{
    (void)state;
    cw_label_surfaces s;
    cw_error err = {0};
    extract_random(&s);
    for (size_t n = 0; n < s.label_count; n++) {
        cw_mesh mesh;
        cw_quality q;
        double area = 0;
        assert_ok(cw_label_mesh(&s, s.labels[n].label, &mesh, &err), err);
        assert_ok(cw_quality_measure(&mesh, NULL, &q, &err), err);
        for (size_t p = 0; p < s.patch_count; p++)
            if (s.patches[p].labels[0] == s.labels[n].label ||
                s.patches[p].labels[1] == s.labels[n].label)
                area += cw_label_patch_area(&s, &s.patches[p]);
        assert_within(area, q.area_mm2, 1e-9);
        cw_mesh_free(&mesh);
    }
    cw_label_surfaces_free(&s);
}

/* Labels that were scaled or rounded on their way are the whole numbers next to them; others are
 * refused. */
static void labels_within_rounding_are_whole(void **state)
{
    (void)state;
    static int16_t scaled[24];
    static float rounded[24];
    static const double others[] = {2.5, 2.99, 0.02, -1, 4294967296.0};
    cw_volume volumes[] = {
        {.data = scaled, .type = CW_I16, .dim = {4, 3, 2}, .slope = (double)0.001f},
        {.data = scaled, .type = CW_I16, .dim = {4, 3, 2}, .slope = 0.001, .intercept = 1e-9},
        {.data = rounded, .type = CW_F32, .dim = {4, 3, 2}}};
    cw_label_count *counts;
    size_t count;
    cw_labels labels;
    cw_error err = {0};
    for (int i = 0; i < 24; i++) {
        scaled[i] = (int16_t)(i < 5 ? 3000 : i < 7 ? 32000 : i < 20 ? 7000 : 0);
        rounded[i] = i < 5 ? 2.9999998f : i < 7 ? 32.000004f : i < 20 ? 7 : 1e-7f;
    }
    for (size_t n = 0; n < 3; n++) {
        volumes[n].known = CW_KNOWN_LABELS;
        assert_ok(cw_label_counts(&volumes[n], 0, &counts, &count, &err), err);
        assert_int_equal(count, 3);
        assert_true(counts[0].label == 3 && counts[0].voxels == 5);
        assert_true(counts[1].label == 7 && counts[1].voxels == 13);
        assert_true(counts[2].label == 32 && counts[2].voxels == 2);
        cw_label_counts_free(counts);
        assert_ok(cw_volume_labels(&volumes[n], &labels, &err), err);
        assert_int_equal(labels.count, 4);
        assert_true(labels.value[0] == 0 && labels.value[1] == 3 && labels.value[2] == 7 &&
                    labels.value[3] == 32);
    }
    for (size_t n = 0; n < sizeof others / sizeof *others; n++) {
        rounded[9] = (float)others[n];
        assert_fails(cw_label_counts(&volumes[2], 0, &counts, &count, &err), CW_ERR_ARGUMENT,
                     "labels are whole numbers", err);
    }
}

static void voxels_are_counted(void **state)
{
    (void)state;
    static float voxels[5 * 4 * 3] = {0};
    const cw_volume v = {.data = voxels, .type = CW_F32, .dim = {5, 4, 3}};
    cw_label_count *counts;
    size_t count;
    cw_error err = {0};
    voxels[0] = voxels[1] = voxels[59] =
        4294967040.0f; /* the largest label that a float holds */
    voxels[7] = 2;
    voxels[8] = 1;
    assert_ok(cw_label_counts(&v, 0, &counts, &count, &err), err);
    assert_int_equal(count, 3);
    assert_true(counts[0].label == 1 && counts[0].voxels == 1);
    assert_true(counts[1].label == 2 && counts[1].voxels == 1);
    assert_true(counts[2].label == 4294967040u && counts[2].voxels == 3);
    cw_label_counts_free(counts);
    assert_ok(cw_label_counts(&v, 2, &counts, &count, &err), err);
    assert_int_equal(counts[0].label, 0);
    assert_int_equal(counts[0].voxels, 55);
    cw_label_counts_free(counts);
    voxels[6] = 0.5f;
    assert_fails(cw_label_counts(&v, 0, &counts, &count, &err), CW_ERR_ARGUMENT,
                 "voxel 1, 1, 0 is 0.5: labels are whole numbers", err);
    assert_null(counts);
    voxels[6] = 0;
    bool failed = true;
    for (long n = 0; failed; n++) {
        cwi_alloc_fail_after(n);
        const cw_status st = cw_label_counts(&v, 0, &counts, &count, &err);
        failed = cwi_alloc_fail_after(-1);
        assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
        cw_label_counts_free(counts);
    }
}

/* Each interface is there once, as the more opaque of its labels has it, in that one's colour. */
static void a_picture_has_each_interface_once(void **state)
{
    (void)state;
    static const uint8_t colors[4][4] = {
        {1, 2, 3, 255}, {4, 5, 6, 128}, {7, 8, 9, 0}, {10, 11, 12, 255}};
    cw_label_surfaces s;
    cw_error err = {0};
    cw_mesh mesh, alone[4];
    size_t expected = 0, found[4] = {0};
    extract_random(&s);
    assert_int_equal(s.label_count, 4);
    assert_ok(cw_label_colored_mesh(&s, colors, &mesh, &err), err);
    assert_ok(cw_mesh_check(&mesh, &err), err);
    assert_memory_equal(mesh.origin, s.mesh.origin, sizeof mesh.origin);
    assert_non_null(mesh.normals);
    for (size_t l = 0; l < 4; l++)
        assert_ok(cw_label_mesh(&s, s.labels[l].label, &alone[l], &err), err);
    for (size_t p = 0; p < s.patch_count; p++) /* only label 3 by the background is left out */
        expected += s.patches[p].labels[0] == 3000000000u && s.patches[p].labels[1] == 0
                        ? 0
                        : s.patches[p].count;
    assert_int_equal(mesh.triangle_count, expected);
    for (size_t t = 0; t < mesh.triangle_count; t++) {
        const uint32_t *c = mesh.triangles + 3 * t;
        const size_t owner = mesh.labels[c[0]] / 1000000000u - 1;
        size_t same = 0;
        for (size_t n = 0; n < 3; n++) {
            assert_int_equal(mesh.labels[c[n]], s.labels[owner].label);
            assert_memory_equal(mesh.colors + 4 * (size_t)c[n], colors[owner], 4);
        }
        for (size_t u = 0; u < alone[owner].triangle_count; u++)
            same += is_same(&mesh, c, &alone[owner], alone[owner].triangles + 3 * u);
        assert_int_equal(same, 1);
        found[owner]++;
    }
    assert_int_equal(found[0],
                     alone[0].triangle_count); /* it is the first of the opaque ones */
    assert_true(found[1] > 0 && found[1] < alone[1].triangle_count);
    assert_int_equal(found[2], 0);
    assert_true(found[3] > 0 && found[3] < alone[3].triangle_count);
    for (size_t l = 0; l < 4; l++)
        cw_mesh_free(&alone[l]);
    cw_mesh_free(&mesh);
    cw_label_surfaces_free(&s);
}

static void memory_that_is_out_is_an_error(void **state)
{
    (void)state;
    static const uint8_t colors[4][4] = {{1, 2, 3, 4}};
    cw_label_surfaces s;
    extract_random(&s);
    for (int painted = 0; painted < 2; painted++) {
        bool failed = true;
        for (long n = 0; failed; n++) {
            cw_mesh mesh;
            cw_error err = {0};
            cwi_alloc_fail_after(n);
            const cw_status st = painted ? cw_label_colored_mesh(&s, colors, &mesh, &err)
                                         : cw_label_patch_mesh(&s, &s.patches[0], &mesh, &err);
            failed = cwi_alloc_fail_after(-1);
            assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
            assert_true(!failed || !mesh.positions);
            cw_mesh_free(&mesh);
        }
    }
    cw_label_surfaces_free(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(both_labels_have_a_patch),
        cmocka_unit_test(areas_of_patches_add_up),
        cmocka_unit_test(voxels_are_counted),
        cmocka_unit_test(labels_within_rounding_are_whole),
        cmocka_unit_test(a_picture_has_each_interface_once),
        cmocka_unit_test(memory_that_is_out_is_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
