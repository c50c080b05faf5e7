/* Tests classes of materials: their curves against the definition of a mixture, files, errors,
 * and presets. */
#include "support/support.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const cw_material_class tissues[] = {
    {{-INFINITY, -INFINITY, -400, -160}, {0, 0, 0}, 0, 0},
    {{-400, -160, -70, -20}, {0.9f, 0.8f, 0.5f}, 0.03f, 1},
    {{-70, -20, 100, 220}, {0.7f, 0.3f, 0.2f}, 0.06f, 1.5f},
    {{100, 220, INFINITY, INFINITY}, {1, 0.9f, 0.8f}, 0.8f, -2}};

/* Three classes that overlap, with jumps, and a gap between the second and the third. */
static const cw_material_class rough[] = {{{0, 10, 20, 30}, {1, 0, 0}, 0.5f, 1},
                                          {{5, 5, 25, 40}, {0, 1, 0}, 0.25f, 3},
                                          {{50, 60, 60, 60}, {0, 0, 1}, 1, 10}};

/* Returns the fraction of a material at a value, as the documents state it. */
static double find_fraction(const cw_material_class *m, double x)
{
    const double *v = m->values;
    if (x < v[0] || x > v[3])
        return 0;
    if (x < v[1])
        return (x - v[0]) / (v[1] - v[0]);
    return x > v[2] ? (v[3] - x) / (v[3] - v[2]) : 1;
}

/* Compares curves with the mixture at values that are no ends of classes. */
static void check_mixtures(const cw_material_class *materials, size_t count, double low,
                           double high)
{
    cw_transfer t = {.gradient_count = 1, .gradients = {{0, 0.5f}}, .unit_mm = 3};
    cw_error err = {0};
    assert_ok(cw_transfer_set_materials(&t, materials, count, &err), err);
    assert_ok(cw_transfer_check(&t, &err), err);
    assert_true(t.gradient_count == 1 && t.unit_mm == 3);
    for (int n = 0; n < 5000; n++) {
        const double x = low + (high - low) * (n + 0.37) / 5000;
        double sum = 0, opacity = 0, index = 0, premultiplied[3] = {0}, color[3], got;
        for (size_t i = 0; i < count; i++) {
            const double fraction = find_fraction(&materials[i], x);
            sum += fraction;
            opacity += fraction * (double)materials[i].opacity;
            index += fraction * (double)materials[i].index;
            for (int c = 0; c < 3; c++)
                premultiplied[c] +=
                    fraction * (double)materials[i].opacity * (double)materials[i].color[c];
        }
        cw_transfer_at(&t, x, color, &got);
        assert_near(got, opacity / fmax(sum, 1), 0.003);
        assert_near(cw_transfer_index(&t, x), index / fmax(sum, 1), 0.03);
        for (int c = 0; c < 3 && opacity > 0; c++)
            assert_near(color[c], premultiplied[c] / opacity, 0.005);
    }
}

static void curves_are_those_of_mixtures(void **state)
{
    (void)state;
    check_mixtures(tissues, 4, -1000, 1500);
    check_mixtures(rough, 3, -10, 80);
    check_mixtures(rough, 1, -10, 80);
}

/* The curves scale with the unit of the values. */
static void any_unit_of_values_works(void **state)
{
    (void)state;
    for (int n = 0; n < 3; n++) {
        const double scale = (double[]){1e-4, 1e4, 1e-12}[n];
        cw_material_class scaled[3];
        memcpy(scaled, rough, sizeof scaled);
        for (int i = 0; i < 12; i++)
            scaled[i / 4].values[i % 4] *= scale;
        check_mixtures(scaled, 3, -10 * scale, 80 * scale);
    }
}

static void unusable_materials_are_named(void **state)
{
    (void)state;
    static const struct {
        size_t count;
        cw_material_class second;
        const char *words;
    } rows[] = {
        {0, {{0}, {0}, 0, 0}, "0 materials: expected 1 to 8"},
        {9, {{0}, {0}, 0, 0}, "9 materials: expected 1 to 8"},
        {2, {{0, 2, 1, 3}, {0}, 0, 0}, "value 2 of material 1 is 1, below the one before, 2"},
        {2, {{0, NAN, 1, 3}, {0}, 0, 0}, "value 1 of material 1 is not a number"},
        {2, {{INFINITY, INFINITY, INFINITY, INFINITY}, {0}, 0, 0}, "open on the other side"},
        {2, {{-INFINITY, 0, 1, 3}, {0}, 0, 0}, "both values of an open end"},
        {2, {{0, 1, 2, 3}, {0, 2, 0}, 0, 0}, "the colour of material 1 is not 0 to 1"},
        {2, {{0, 1, 2, 3}, {0}, 1.5f, 0}, "the opacity of material 1 is 1.5"},
        {2, {{0, 1, 2, 3}, {0}, 1, NAN}, "the index of material 1"}};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        cw_material_class materials[9] = {{{0, 1, 2, 3}, {1, 1, 1}, 1, 1}, rows[n].second};
        cw_transfer t = {0};
        cw_error err = {0};
        assert_fails(cw_transfer_set_materials(&t, materials, rows[n].count, &err),
                     CW_ERR_ARGUMENT, rows[n].words, err);
        assert_true(t.color_count == 0);
    }
    const cw_material_class everywhere = {
        {-INFINITY, -INFINITY, INFINITY, INFINITY}, {1, 1, 1}, 1, 1};
    cw_transfer t = {0};
    cw_error err = {0};
    assert_fails(cw_transfer_set_materials(&t, &everywhere, 1, &err), CW_ERR_ARGUMENT,
                 "no material has an end", err);
}

/* Materials of a file are the same curves as those of the call, and are kept as curves. */
static void files_have_materials(void **state)
{
    (void)state;
    static const char text[] =
        "{\"schema\": \"cubewright-transfer-1\", \"surface_mm\": 2.5,\n"
        " \"gradients\": [[0, 0.25], [1, 1]],\n"
        " \"materials\": [{\"values\": [null, null, -400, -160], \"color\": \"#000000\"},\n"
        "  {\"name\": \"bone\", \"values\": [100, 220, null, null], \"color\": \"#ff3300\",\n"
        "   \"opacity\": 0.5, \"index\": 2}]}";
    const cw_material_class same[] = {
        {{-INFINITY, -INFINITY, -400, -160}, {0, 0, 0}, 0, 0},
        {{100, 220, INFINITY, INFINITY}, {1, 51 / 255.0f, 0}, 0.5f, 2}};
    cw_transfer t, again, made = {0};
    cw_error err = {0};
    char written[CW_TRANSFER_TEXT];
    assert_ok(cw_transfer_parse(text, &t, &err), err);
    assert_ok(cw_transfer_set_materials(&made, same, 2, &err), err);
    assert_true(t.index_count == made.index_count && t.surface_mm == 2.5);
    assert_memory_equal(t.indices, made.indices, sizeof t.indices);
    assert_memory_equal(t.opacities, made.opacities, sizeof t.opacities);
    assert_ok(cw_transfer_format(&t, written, &err), err);
    assert_ok(cw_transfer_parse(written, &again, &err), err);
    assert_true(again.index_count == t.index_count && again.surface_mm == t.surface_mm);
    assert_memory_equal(again.indices, t.indices, sizeof t.indices);
}

static void unusable_files_are_named(void **state)
{
    (void)state;
    static const char *const rows[][2] = {
        {"\"materials\": []", "a list of 1 to 8"},
        {"\"materials\": [3]", "material 0: an object"},
        {"\"materials\": [{\"values\": [1, 2, 3]}]", "material 0: 'values'"},
        {"\"materials\": [{\"values\": [1, 2, 3, 4]}]", "material 0: 'color'"},
        {"\"materials\": [{\"density\": 1}]", "unknown field 'density'"},
        {"\"materials\": [{\"values\": [4, 2, 3, 4], \"color\": \"#ffffff\"}]", "material 0"},
        {"\"materials\": [{\"values\": [1, 2, 3, 4], \"color\": \"#ffffff\"}], \"colors\": []",
         "'materials' and 'colors'"},
        {"\"indices\": [[1, \"x\"]]", "point 0 of 'indices'"},
        {"\"indices\": [[1, 2], [0, 2]]", "point 1 of 'indices'"},
        {"\"surface_mm\": 0", "'surface_mm' is 0"},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        char text[300];
        cw_transfer t;
        cw_error err = {0};
        snprintf(text, sizeof text, "{\"schema\": \"cubewright-transfer-1\", %s}", rows[n][0]);
        assert_fails(cw_transfer_parse(text, &t, &err), CW_ERR_FORMAT, rows[n][1], err);
    }
}

/* Bone is white and dense, air clear, and what is between them has an index in between. */
static void presets_have_materials(void **state)
{
    (void)state;
    cw_transfer t;
    cw_error err = {0};
    double color[3], opacity;
    assert_ok(cw_transfer_preset("ct-materials", NULL, &t, &err), err);
    cw_transfer_at(&t, -1000, color, &opacity);
    assert_true(opacity == 0 && cw_transfer_index(&t, -1000) == 0);
    cw_transfer_at(&t, 1200, color, &opacity);
    assert_true(opacity > 0.7 && color[2] > 0.8);
    assert_true(cw_transfer_index(&t, 40) > cw_transfer_index(&t, -100));
    assert_true(cw_transfer_index(&t, 1200) > cw_transfer_index(&t, 40));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(curves_are_those_of_mixtures),
                                       cmocka_unit_test(any_unit_of_values_works),
                                       cmocka_unit_test(unusable_materials_are_named),
                                       cmocka_unit_test(files_have_materials),
                                       cmocka_unit_test(unusable_files_are_named),
                                       cmocka_unit_test(presets_have_materials)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
