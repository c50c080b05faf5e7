/* Tests the surfaces of labels' fields: manifolds for any fields, the largest field, rules for the
 * background, border, and what is refused. */
#include "support/label_surfaces.h"

#include "core/base/memory.h"
#include "core/volume/volume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 5 };

/* Kinds of fields. */
enum { NOISE, SMOOTH, TIES, QUANTISED, ONE_IS_0, ONE_VOXEL, KINDS };

/* Fills `count` fields of a kind. */
static void fill_fields(cw_volume fields[MOST], int count, const size_t dim[3], int kind)
{
    cw_error err = {0};
    const cw_type type = kind == QUANTISED ? CW_U8 : CW_F32;
    double waves[MOST][4];
    for (int n = 0; n < count; n++) {
        assert_ok(cw_volume_alloc(&fields[n], type, dim, 1, 1, &err), err);
        for (int a = 0; a < 4; a++)
            waves[n][a] = 0.3 + 0.6 * rand() / RAND_MAX;
    }
    for (size_t i = 0; i < dim[0] * dim[1] * dim[2]; i++)
        for (int n = 0; n < count; n++) {
            const double x = (double)(i % dim[0]), y = (double)(i / dim[0] % dim[1]),
                         z = (double)(i / dim[0] / dim[1]), noise = rand() / (double)RAND_MAX;
            const double wave = 0.5 + 0.5 * sin(waves[n][0] * x + waves[n][3] * 10) *
                                          cos(waves[n][1] * y) * cos(waves[n][2] * z + n);
            double value = kind == NOISE || kind == QUANTISED ? noise : wave;
            if (kind == TIES)
                value = n < 2 ? 0.75 : rint(2 * wave) / 2;
            if (kind == ONE_IS_0)
                value = n == 1 ? 0 : 0.8 * wave + 0.2 * noise;
            if (kind == ONE_VOXEL && n == 2)
                value = i == dim[0] * dim[1] + dim[0] + 1 ? 1 : 0;
            cwi_voxel_put(type, (char *)cw_volume_voxels(&fields[n]) + i * cw_type_size(type),
                          type == CW_U8 ? 6 * value : value);
        }
}

static void free_fields(cw_volume fields[MOST])
{
    for (int n = 0; n < MOST; n++)
        cw_volume_free(&fields[n]);
}

/* Makes the grid of fields skewed and mirrored, uneven, or leaves it. */
static void bend_grid(cw_volume fields[MOST], int n)
{
    static double uneven[3][32];
    for (int a = 0; a < 9 && n % 4 == 1; a++)
        fields[0].affine[a / 3][a % 3] = (a % 4 ? 0.4
                                          : a   ? 1
                                                : -2) *
                                         (0.2 + rand() / (double)RAND_MAX);
    for (int a = 0; a < 3 && n % 4 == 2; a++) {
        for (size_t i = 0; i < 32; i++)
            uneven[a][i] = (i > 0 ? uneven[a][i - 1] : 0) + 0.5 + rand() / (double)RAND_MAX;
        fields[0].coordinates[a] = uneven[a];
    }
    for (int f = 1; f < MOST; f++) {
        memcpy(fields[f].affine, fields[0].affine, sizeof fields[0].affine);
        memcpy(fields[f].coordinates, fields[0].coordinates, sizeof fields[0].coordinates);
    }
}

/* Checks the surfaces of fields, with the bytes of 1 and 3 threads, and topology as of the map. */
static void check_fields(const cw_label_scores *scores, const cw_labels_desc *desc)
{
    cw_label_surfaces one, three, plain;
    cw_volume map;
    cw_error err = {0};
    cw_labels_desc d = *desc;
    d.threads = 1;
    assert_ok(cw_extract_label_scores(scores, &d, &one, &err), err);
    if (!desc->leave_open)
        test_check_label_surfaces(&one);
    d.threads = 3;
    assert_ok(cw_extract_label_scores(scores, &d, &three, &err), err);
    test_assert_same_labels(&one, &three);
    cw_label_surfaces_free(&three);
    assert_ok(cw_label_scores_largest(scores, d.background, 2, &map, &err), err);
    d.no_smoothing = true;
    assert_ok(cw_extract_labels(&map, &d, &plain, &err), err);
    assert_int_equal(plain.mesh.vertex_count, one.mesh.vertex_count);
    assert_int_equal(plain.mesh.triangle_count, one.mesh.triangle_count);
    assert_int_equal(plain.label_count, one.label_count);
    const bool is_plain = map.affine[0][0] == 1 && !map.coordinates[0];
    for (size_t n = 0; n < 3 * one.mesh.vertex_count && is_plain; n++)
        assert_true(fabs((double)one.mesh.positions[n] - (double)plain.mesh.positions[n]) <=
                    (desc->max_move > 0 ? desc->max_move : 0.5) + 1e-5);
    cw_label_surfaces_free(&plain);
    cw_label_surfaces_free(&one);
    cw_volume_free(&map);
}

static void any_fields_give_manifolds(void **state)
{
    (void)state;
    static const size_t dims[][3] = {{9, 8, 10}, {12, 1, 7}, {5, 17, 2}};
    static const uint32_t wanted[] = {1, 3};
    test_seed(17);
    for (int n = 0; n < test_some(10 * KINDS * 3); n++) {
        cw_volume fields[MOST] = {0};
        const int kind = n % KINDS, rule = n / KINDS % 3;
        fill_fields(fields, MOST, dims[n / 7 % 3], kind);
        bend_grid(fields, n);
        const cw_label_scores scores = {.fields = fields,
                                        .count = MOST,
                                        .rule = (cw_background_rule)rule,
                                        .value = kind == 3 ? 3 : 0.6,
                                        .has_value = n % 2};
        const cw_labels_desc desc = {.leave_open = n % 5 == 4,
                                     .max_move = n % 4 == 3 ? 0.2 : 0,
                                     .labels = n % 3 == 2 ? wanted : NULL,
                                     .label_count = n % 3 == 2 ? 2 : 0};
        check_fields(&scores, &desc);
        free_fields(fields);
    }
}

/* Fields p and 1 - p, and p against a value, have the isosurface of p. */
static void two_fields_agree_with_the_isosurface(void **state)
{
    (void)state;
    enum { SIDE = 24 };
    for (int kind = 0; kind < 3; kind++) {
        cw_volume fields[2] = {0};
        cw_label_surfaces s;
        cw_mesh surface = {0};
        cw_error err = {0};
        for (int n = 0; n < 2; n++)
            assert_ok(
                cw_volume_alloc(&fields[n], CW_F32, (size_t[]){SIDE, SIDE, SIDE}, 1, 1, &err),
                err);
        float *p = cw_volume_voxels(&fields[0]), *q = cw_volume_voxels(&fields[1]);
        for (size_t i = 0; i < (size_t)SIDE * SIDE * SIDE; i++) {
            const double x = (double)(i % SIDE) - 11.3, y = (double)(i / SIDE % SIDE) - 11.6,
                         z = (double)(i / SIDE / SIDE) - 11.9;
            const double d = kind == 0   ? 7.2 - sqrt(x * x + y * y + z * z)
                             : kind == 1 ? 2.6 - hypot(hypot(x, y) - 6, z)
                                         : 7.4 - hypot(hypot(x, y), z) +
                                               sin(0.4 * x) * cos(0.3 * y - 0.2 * z);
            p[i] = (float)(1 / (1 + exp(-d)));
            q[i] = 1 - p[i];
        }
        assert_ok(
            cw_extract(&fields[0], &(cw_extract_desc){.isovalue = 0.5f}, &surface, NULL, &err),
            err);
        for (int rule = 0; rule < 3; rule++) {
            cw_mesh_comparison c = {0};
            const uint32_t labels[] = {1, 0};
            const cw_label_scores scores = {.fields = fields,
                                            .count = rule == CW_BACKGROUND_FIELD ? 2 : 1,
                                            .labels = labels,
                                            .rule = (cw_background_rule)rule};
            assert_ok(cw_extract_label_scores(&scores, NULL, &s, &err), err);
            assert_ok(cw_mesh_compare(&s.mesh, &surface, NULL, &c, &err), err);
            assert_true(cw_mesh_comparison_rms(&c) < 0.05);
            assert_true(cw_mesh_comparison_max(&c) < 0.25);
            cw_label_surfaces_free(&s);
        }
        cw_mesh_free(&surface);
        cw_volume_free(&fields[0]);
        cw_volume_free(&fields[1]);
    }
}

/* Interfaces of planes between corners reach the border where fields go on. */
static void caps_are_in_their_planes(void **state)
{
    (void)state;
    const size_t dim[3] = {8, 9, 7};
    cw_volume fields[MOST] = {0};
    cw_label_surfaces s;
    cw_error err = {0};
    size_t planes = 0;
    test_seed(8);
    fill_fields(fields, MOST, dim, 1);
    assert_ok(
        cw_extract_label_scores(
            &(cw_label_scores){.fields = fields, .count = MOST, .has_value = true, .value = -1},
            NULL, &s, &err),
        err);
    for (size_t v = 0; v < s.mesh.vertex_count; v++)
        for (size_t a = 0; a < 3; a++) {
            const double x = (double)s.mesh.positions[3 * v + a] + s.mesh.origin[a],
                         high = (double)dim[a] - 1;
            planes += x < 0 || x > high;
            if (x < 0 || x > high)
                assert_near(x, x < 0 ? -0.5 : high + 0.5, 1e-6);
        }
    assert_true(planes > 200);
    cw_label_surfaces_free(&s);
    free_fields(fields);
}

/* Sets one voxel of each of three fields, and finds its label. */
static uint32_t find_label(const double values[3], cw_background_rule rule, double nodata)
{
    cw_volume fields[3] = {0}, map;
    cw_error err = {0};
    for (int n = 0; n < 3; n++) {
        assert_ok(cw_volume_alloc(&fields[n], n == 1 ? CW_F64 : CW_F32, (size_t[]){1, 1, 1}, 1,
                                  1, &err),
                  err);
        cwi_voxel_put(fields[n].type, cw_volume_voxels(&fields[n]), values[n]);
        fields[n].has_nodata = true;
        fields[n].nodata = nodata;
    }
    assert_ok(
        cw_label_scores_largest(&(cw_label_scores){.fields = fields, .count = 3, .rule = rule},
                                0, 1, &map, &err),
        err);
    const uint32_t label = (uint32_t)cw_volume_value(&map, 0, 0, 0);
    cw_volume_free(&map);
    for (int n = 0; n < 3; n++)
        cw_volume_free(&fields[n]);
    return label;
}

static void the_largest_field_has_the_voxel(void **state)
{
    (void)state;
    static const struct {
        double values[3];
        uint32_t by_value, by_field, by_rest;
    } rows[] = {
        {{0.25, 0.625, 0.125}, 2, 1, 2},   {{0.5, 0.5, 0.5}, 0, 0, 1},
        {{0.25, 0.25, 0.25}, 0, 0, 0},     {{0.375, 0.375, 0}, 0, 0, 1},
        {{NAN, 0.75, 0.875}, 3, 2, 3},     {{NAN, NAN, NAN}, 0, 0, 0},
        {{-7, 0.75, -7}, 2, 1, 2},         {{INFINITY, 1, INFINITY}, 1, 0, 1},
        {{-INFINITY, NAN, 0.75}, 3, 2, 0}, {{0.0625, 0.0625, 0.9375}, 3, 2, 3},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        assert_int_equal(find_label(rows[n].values, CW_BACKGROUND_VALUE, -7), rows[n].by_value);
        assert_int_equal(find_label(rows[n].values, CW_BACKGROUND_FIELD, -7), rows[n].by_field);
        assert_int_equal(find_label(rows[n].values, CW_BACKGROUND_REST, -7), rows[n].by_rest);
    }
}

/* Fields without values at some voxels, or infinite ones, still give manifolds. */
static void missing_values_are_left_out(void **state)
{
    (void)state;
    const size_t dim[3] = {9, 10, 8};
    test_seed(4);
    for (int n = 0; n < 9; n++) {
        cw_volume fields[MOST] = {0};
        fill_fields(fields, MOST, dim, n % 2);
        for (int f = 0; f < MOST; f++) {
            float *to = cw_volume_voxels(&fields[f]);
            for (size_t i = 0; i < 720; i++)
                if (rand() % 6 == 0)
                    to[i] = rand() % 2 ? NAN : rand() % 2 ? INFINITY : -INFINITY;
        }
        check_fields(&(cw_label_scores){.fields = fields,
                                        .count = MOST,
                                        .rule = (cw_background_rule)(n / 3)},
                     &(cw_labels_desc){0});
        free_fields(fields);
    }
}

static void what_cannot_be_is_refused(void **state)
{
    (void)state;
    cw_volume fields[3] = {0}, map;
    cw_label_surfaces s;
    cw_error err = {0};
    static const char *const names[] = {"a.nrrd", "b.nrrd", NULL};
    for (int n = 0; n < 3; n++)
        assert_ok(
            cw_volume_alloc(&fields[n], CW_F32, (size_t[]){4, 5, 6 + (n == 2)}, 1, 1, &err),
            err);
    cw_label_scores scores = {.fields = fields, .count = 3, .names = names};
    assert_fails(cw_extract_label_scores(&scores, NULL, &s, &err), CW_ERR_ARGUMENT,
                 "field 2 has 4 x 5 x 7 voxels, and a.nrrd 4 x 5 x 6", err);
    assert_null(s.mesh.triangles);
    fields[1].affine[0][0] = fields[1].affine[1][1] = fields[1].affine[2][2] = 1;
    fields[1].affine[2][3] = 3;
    scores.count = 2;
    assert_fails(cw_label_scores_largest(&scores, 0, 1, &map, &err), CW_ERR_ARGUMENT,
                 "b.nrrd lies elsewhere than a.nrrd, by up to 3 mm", err);
    fields[1].affine[2][3] = 1e-4;
    assert_ok(cw_label_scores_largest(&scores, 0, 1, &map, &err), err);
    cw_volume_free(&map);
    const uint32_t twice[] = {4, 4}, zero[] = {0, 1};
    scores.labels = twice;
    assert_fails(cw_label_scores_largest(&scores, 0, 1, &map, &err), CW_ERR_ARGUMENT,
                 "both have label 4", err);
    scores.labels = zero;
    assert_fails(cw_label_scores_largest(&scores, 0, 1, &map, &err), CW_ERR_ARGUMENT,
                 "a.nrrd has label 0, which is the background's", err);
    scores.rule = CW_BACKGROUND_FIELD;
    assert_ok(cw_label_scores_largest(&scores, 0, 1, &map, &err), err);
    cw_volume_free(&map);
    assert_fails(cw_label_scores_largest(&scores, 7, 1, &map, &err), CW_ERR_ARGUMENT,
                 "none of the 2 fields is that of the background, 7", err);
    scores.rule = CW_BACKGROUND_RULE_COUNT;
    assert_fails(cw_label_scores_largest(&scores, 0, 1, &map, &err), CW_ERR_ARGUMENT,
                 "3 is no rule for the background", err);
    scores.rule = CW_BACKGROUND_REST;
    scores.has_value = true;
    scores.value = NAN;
    assert_fails(cw_label_scores_largest(&scores, 9, 1, &map, &err), CW_ERR_ARGUMENT,
                 "the background's value is nan", err);
    scores.count = 0;
    assert_fails(cw_label_scores_largest(&scores, 0, 1, &map, &err), CW_ERR_ARGUMENT,
                 "there are 0 fields", err);
    assert_fails(cw_extract_label_scores(NULL, NULL, &s, &err), CW_ERR_ARGUMENT, "NULL", err);
    for (int n = 0; n < 3; n++)
        cw_volume_free(&fields[n]);
}

static void memory_that_is_out_is_an_error(void **state)
{
    (void)state;
    cw_volume fields[MOST] = {0};
    cw_label_surfaces s;
    cw_error err = {0};
    bool failed = true;
    fill_fields(fields, MOST, (size_t[]){6, 5, 4}, 1);
    for (long n = 0; failed; n++) {
        cwi_alloc_fail_after(n);
        const cw_status st = cw_extract_label_scores(
            &(cw_label_scores){.fields = fields, .count = MOST, .rule = CW_BACKGROUND_REST},
            &(cw_labels_desc){.threads = 1}, &s, &err);
        failed = cwi_alloc_fail_after(-1);
        assert_true(st == (failed ? CW_ERR_NO_MEMORY : CW_OK));
        cw_label_surfaces_free(&s);
    }
    free_fields(fields);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_fields_give_manifolds),
        cmocka_unit_test(two_fields_agree_with_the_isosurface),
        cmocka_unit_test(caps_are_in_their_planes),
        cmocka_unit_test(the_largest_field_has_the_voxel),
        cmocka_unit_test(missing_values_are_left_out),
        cmocka_unit_test(what_cannot_be_is_refused),
        cmocka_unit_test(memory_that_is_out_is_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
