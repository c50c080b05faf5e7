/* Tests transfer functions: values between points, files and texts, errors, and presets. */
#include "support/support.h"

#include "viewer/settings/transfer_json.h"

#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static cw_transfer full_transfer(void)
{
    cw_transfer t = {
        .color_count = 2, .opacity_count = 4, .gradient_count = 2, .unit_mm = 0.1 + 0.2};
    t.colors[0] = (cw_color_point){-1.0 / 3, {0, 51 / 255.0f, 1}};
    t.colors[1] = (cw_color_point){1e-300, {1, 254 / 255.0f, 0}};
    t.opacities[0] = (cw_opacity_point){-0.0, 0};
    t.opacities[1] = (cw_opacity_point){5, 0.1f};
    t.opacities[2] = (cw_opacity_point){5, 1 / 3.0f};
    t.opacities[3] = (cw_opacity_point){1.7976931348623157e308, 1};
    t.gradients[0] = (cw_opacity_point){0, 0};
    t.gradients[1] = (cw_opacity_point){40.123456789012345, 1e-38f};
    return t;
}

/* Linear between points, constant beyond them; a jump belongs to the side above. */
static void values_between_points_are_linear(void **state)
{
    (void)state;
    cw_transfer t = {.color_count = 2, .opacity_count = 4};
    t.colors[0] = (cw_color_point){10, {0, 1, 0.5f}};
    t.colors[1] = (cw_color_point){20, {1, 0, 0.5f}};
    const cw_opacity_point points[] = {{0, 0.25f}, {10, 0.5f}, {10, 0}, {30, 1}};
    memcpy(t.opacities, points, sizeof points);
    const double rows[][3] = {
        /* value, red, opacity */
        {-5, 0, 0.25}, {0, 0, 0.25},    {4, 0, 0.35}, {nextafter(10, 0), 0, 0.5},
        {10, 0, 0},    {15, 0.5, 0.25}, {20, 1, 0.5}, {31, 1, 1}};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        double color[3], opacity;
        cw_transfer_at(&t, rows[n][0], color, &opacity);
        assert_near(color[0], rows[n][1], 1e-12);
        assert_near(color[1], 1 - rows[n][1], 1e-12);
        assert_near(color[2], 0.5, 1e-12);
        assert_near(opacity, rows[n][2], 1e-12);
    }
}

static void nothing_said_is_white_and_transparent(void **state)
{
    (void)state;
    const cw_transfer none = {0};
    double color[3], opacity;
    cw_transfer_at(&none, 3, color, &opacity);
    assert_true(color[0] == 1 && color[1] == 1 && color[2] == 1 && opacity == 0);
    assert_true(cw_transfer_gradient_factor(&none, 7) == 1);
}

static void unusable_points_are_named(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_transfer good = full_transfer(), t = good;
    assert_ok(cw_transfer_check(&t, &err), err);
    t.opacities[2].value = 4;
    assert_fails(cw_transfer_check(&t, &err), CW_ERR_ARGUMENT,
                 "point 2 of 'opacities' stands at 4, the one before at 5", err);
    t = good;
    t.colors[0].value = NAN;
    assert_fails(cw_transfer_check(&t, &err), CW_ERR_ARGUMENT,
                 "has a position that is not a number", err);
    t = good;
    t.colors[1].color[2] = 1.5f;
    assert_fails(cw_transfer_check(&t, &err), CW_ERR_ARGUMENT, "1.5, not 0 to 1", err);
    t = good;
    t.gradients[1].opacity = NAN;
    assert_fails(cw_transfer_check(&t, &err), CW_ERR_ARGUMENT, "point 1 of 'gradients'", err);
    t = good;
    t.color_count = CW_TRANSFER_POINTS + 1;
    assert_fails(cw_transfer_check(&t, &err), CW_ERR_ARGUMENT, "at most 64 points", err);
    t = good;
    t.unit_mm = -1;
    assert_fails(cw_transfer_check(&t, &err), CW_ERR_ARGUMENT, "'unit_mm' is -1", err);
}

static void assert_same(const cw_transfer *a, const cw_transfer *b)
{
    assert_memory_equal(&a->unit_mm, &b->unit_mm, sizeof a->unit_mm);
    assert_int_equal(a->color_count, b->color_count);
    assert_int_equal(a->opacity_count, b->opacity_count);
    assert_int_equal(a->gradient_count, b->gradient_count);
    for (size_t n = 0; n < a->color_count; n++) {
        assert_memory_equal(&a->colors[n].value, &b->colors[n].value, sizeof(double));
        for (int c = 0; c < 3; c++)
            assert_near((double)a->colors[n].color[c], (double)b->colors[n].color[c],
                        0.5 / 255 + 1e-7);
    }
    for (size_t n = 0; n < a->opacity_count; n++) {
        assert_memory_equal(&a->opacities[n].value, &b->opacities[n].value, sizeof(double));
        assert_memory_equal(&a->opacities[n].opacity, &b->opacities[n].opacity, sizeof(float));
    }
    for (size_t n = 0; n < a->gradient_count; n++)
        assert_memory_equal(&a->gradients[n].opacity, &b->gradients[n].opacity, sizeof(float));
}

static void files_are_read_back_to_the_bit(void **state)
{
    (void)state;
    cw_error err = {0};
    const cw_transfer none = {0}, full = full_transfer();
    cw_transfer many = {.opacity_count = CW_TRANSFER_POINTS}, back;
    for (size_t n = 0; n < CW_TRANSFER_POINTS; n++)
        many.opacities[n] = (cw_opacity_point){sqrt((double)n), (float)n / 63};
    const cw_transfer *all[] = {&none, &full, &many};
    for (size_t n = 0; n < 3; n++) {
        assert_ok(cw_transfer_write(test_path("t.json"), all[n], &err), err);
        assert_ok(cw_transfer_read(test_path("t.json"), &back, &err), err);
        assert_same(all[n], &back);
        assert_int_equal(test_folder_entries(), 1);
    }
}

/* As many points as there can be, with numbers as long as they can be, fit. */
static void texts_are_what_files_hold(void **state)
{
    (void)state;
    cw_error err = {0};
    const cw_transfer none = {0}, full = full_transfer();
    cw_transfer most = {.color_count = CW_TRANSFER_POINTS,
                        .opacity_count = CW_TRANSFER_POINTS,
                        .gradient_count = CW_TRANSFER_POINTS};
    for (size_t n = 0; n < CW_TRANSFER_POINTS; n++) {
        const double value = -1.2345678901234567e-300 / (double)(n + 1);
        most.colors[n] = (cw_color_point){value, {1, 0.2f, 0}};
        most.opacities[n] = (cw_opacity_point){value, 1.2345678e-30f};
        most.gradients[n] = most.opacities[n];
    }
    const cw_transfer *all[] = {&none, &full, &most};
    for (size_t n = 0; n < 3; n++) {
        static char text[CW_TRANSFER_TEXT];
        cw_transfer back;
        size_t size;
        assert_ok(cw_transfer_format(all[n], text, &err), err);
        assert_ok(cw_transfer_parse(text, &back, &err), err);
        assert_same(all[n], &back);
        assert_ok(cw_transfer_write(test_path("t.json"), all[n], &err), err);
        char *file = test_file_read(test_path("t.json"), &size);
        assert_int_equal(size, strlen(text));
        assert_memory_equal(file, text, size);
        free(file);
    }
    static char text[CW_TRANSFER_TEXT];
    cw_transfer back;
    most.unit_mm = -1;
    assert_fails(cw_transfer_format(&most, text, &err), CW_ERR_ARGUMENT, "unit_mm", err);
    assert_fails(cw_transfer_parse("{", &back, &err), CW_ERR_FORMAT, "line 1", err);
}

/* In a locale with decimal commas files have points all the same. */
static void locales_change_nothing(void **state)
{
    (void)state;
    cw_error err = {0};
    const cw_transfer full = full_transfer();
    cw_transfer back;
    if (!setlocale(LC_NUMERIC, "de_DE.UTF-8"))
        skip();
    const cw_status wrote = cw_transfer_write(test_path("t.json"), &full, &err);
    const cw_status read = cw_transfer_read(test_path("t.json"), &back, &err);
    setlocale(LC_NUMERIC, "C");
    assert_int_equal(wrote, CW_OK);
    assert_int_equal(read, CW_OK);
    assert_same(&full, &back);
}

#define FILE_OF(rest) "{\"schema\": \"cubewright-transfer-1\"" rest "}"

static const struct {
    const char *text, *words;
} bad[] = {
    {"", "line 1, column 0: "},
    {"{\n\n  \"schema\" 3}", "line 3, column "},
    {"[]", "an object, {...}, was expected"},
    {"{}", "'schema' was expected to be \"cubewright-transfer-1\""},
    {"{\"schema\": 1}", "'schema' was expected"},
    {"{\"schema\": \"cubewright-camera-1\"}", "'schema' is \"cubewright-camera-1\""},
    {FILE_OF(", \"colours\": []"), "'colours' is no key; there are schema, unit_mm, colors"},
    {FILE_OF(", \"unit_mm\": 1, \"unit_mm\": 2"), "duplicate"},
    {FILE_OF(", \"unit_mm\": \"1\""), "'unit_mm' was expected to be a number"},
    {FILE_OF(", \"unit_mm\": 0"), "'unit_mm' is 0: a length was expected"},
    {FILE_OF(", \"unit_mm\": -2.5"), "'unit_mm' is -2.5"},
    {FILE_OF(", \"colors\": {}"), "'colors' was expected to be a list"},
    {FILE_OF(", \"colors\": [[1, \"#ffffff\"], [2]]"),
     "point 1 of 'colors': [value, \"#rrggbb\"] was expected"},
    {FILE_OF(", \"colors\": [[1, \"red\"]]"), "point 0 of 'colors': a colour such as"},
    {FILE_OF(", \"colors\": [[1, \"#12345g\"]]"), "point 0 of 'colors': a colour such as"},
    {FILE_OF(", \"colors\": [[1, 3]]"), "point 0 of 'colors': a colour such as"},
    {FILE_OF(", \"colors\": [[2, \"#000000\"], [1, \"#000000\"]]"),
     "point 1 of 'colors' stands at 1, the one before at 2"},
    {FILE_OF(", \"opacities\": [[0, 1.01]]"), "point 0 of 'opacities': 0 to 1 was expected"},
    {FILE_OF(", \"opacities\": [[0, -1e-9]]"), "point 0 of 'opacities': 0 to 1 was expected"},
    {FILE_OF(", \"opacities\": [[\"0\", 1]]"), "point 0 of 'opacities': [value, 0 to 1]"},
    {FILE_OF(", \"opacities\": [[0, 1, 2]]"), "point 0 of 'opacities': [value, 0 to 1]"},
    {FILE_OF(", \"opacities\": [[0, null]]"), "point 0 of 'opacities': 0 to 1 was expected"},
    {FILE_OF(", \"gradients\": [[1e999, 0]]"), "line 1, column "},
    {FILE_OF(", \"gradients\": [[3, 0], [2, 1]]"), "point 1 of 'gradients' stands at 2"},
    {FILE_OF(") trailing"), "line 1, column "},
};

static void bad_files_are_told_apart(void **state)
{
    (void)state;
    const cw_transfer before = full_transfer();
    for (size_t n = 0; n < sizeof bad / sizeof *bad; n++) {
        cw_error err = {0};
        cw_transfer t = before;
        test_file_write(test_path("bad.json"), bad[n].text, strlen(bad[n].text));
        assert_fails(cw_transfer_read(test_path("bad.json"), &t, &err), CW_ERR_FORMAT,
                     bad[n].words, err);
        assert_true(strstr(err.message, "bad.json: ") != NULL);
        assert_int_equal(err.status, CW_ERR_FORMAT);
        assert_memory_equal(&t, &before, sizeof t);
    }
}

static void files_that_are_no_settings_are_refused(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_transfer t;
    enum { SIZE = (1 << 20) + 1 };
    char *blanks = malloc(SIZE);
    assert_non_null(blanks);
    memset(blanks, ' ', SIZE);
    test_file_write(test_path("large.json"), blanks, SIZE);
    free(blanks);
    assert_fails(cw_transfer_read(test_path("large.json"), &t, &err), CW_ERR_FORMAT,
                 "at most 1 MiB", err);
    assert_fails(cw_transfer_read(test_path("none.json"), &t, &err), CW_ERR_IO,
                 "cannot be opened", err);
    assert_fails(cw_transfer_read(test_path("."), &t, &err), CW_ERR_IO, "cannot be read", err);
    t = full_transfer();
    assert_fails(cw_transfer_write(test_path("no/t.json"), &t, &err), CW_ERR_OUTPUT,
                 "no/t.json", err);
    t.unit_mm = NAN;
    assert_fails(cw_transfer_write(test_path("t.json"), &t, &err), CW_ERR_ARGUMENT, "unit_mm",
                 err);
}

static void too_many_points_are_refused(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_transfer t;
    char text[2048] = "{\"schema\": \"cubewright-transfer-1\", \"opacities\": [[0, 0]";
    for (int n = 0; n < CW_TRANSFER_POINTS; n++)
        strcat(text, ", [1, 1]");
    strcat(text, "]}");
    assert_fails(cwi_transfer_parse(text, strlen(text), &t, &err), CW_ERR_FORMAT,
                 "'opacities' has 65 points; at most 64", err);
}

static cw_statistics count(cw_type type, size_t n, double (*value)(size_t))
{
    cw_error err = {0};
    cw_volume v;
    cw_statistics s;
    assert_ok(cw_volume_alloc(&v, type, (size_t[3]){n, 1, 1}, 1, 1, &err), err);
    for (size_t i = 0; i < n; i++)
        if (type == CW_F32)
            ((float *)cw_volume_voxels(&v))[i] = (float)value(i);
        else
            ((uint8_t *)cw_volume_voxels(&v))[i] = (uint8_t)value(i);
    assert_ok(cw_volume_statistics(&v, 1024, 1, &s, &err), err);
    cw_volume_free(&v);
    return s;
}

static double zero(size_t i)
{
    (void)i;
    return 0;
}
static double nan_only(size_t i)
{
    (void)i;
    return NAN;
}
static double mask(size_t i)
{
    return i % 7 == 0;
}
static double outlier(size_t i)
{
    return i == 5 ? 3e38 : (double)(i % 3);
}
static double tiny(size_t i)
{
    return 1e-38 * (double)(i % 17);
}
static double wide(size_t i)
{
    return i % 2 ? -3.4e38 : 3.4e38;
}
static double saturated(size_t i)
{
    return i % 5 ? 255 : (double)(i % 200);
}
/* A peak of noise about 0 with things of either sign in it. */
static double both_signs(size_t i)
{
    return i % 10 ? 0.01 * sin((double)i) : (i % 20 ? 1 : -1) * (double)(i % 97) / 97;
}
/* Air about 0, something about 100, a little at 200. */
static double three_humps(size_t i)
{
    const double noise = 8 * sin(12.9898 * (double)i);
    return i % 100 < 60 ? fabs(noise) : i % 100 < 95 ? 100 + noise : 200 + noise;
}

/* Whatever the values are, a preset can be used, and shows something where there
 * is something. */
static void presets_fit_odd_values(void **state)
{
    (void)state;
    double (*const fields[])(size_t) = {zero, nan_only,  mask,       outlier,    tiny,
                                        wide, saturated, both_signs, three_humps};
    const char *name;
    for (size_t f = 0; f < sizeof fields / sizeof *fields; f++)
        for (int u8 = 0; u8 < 2; u8++) {
            if (u8 && (fields[f] == nan_only || fields[f] == outlier || fields[f] == wide ||
                       fields[f] == both_signs))
                continue;
            cw_statistics s = count(u8 ? CW_U8 : CW_F32, 5000, fields[f]);
            for (size_t n = 0; (name = cw_transfer_preset_name(n)); n++) {
                cw_error err = {0};
                cw_transfer t;
                assert_ok(cw_transfer_preset(name, &s, &t, &err), err);
                assert_ok(cw_transfer_check(&t, &err), err);
                assert_true(t.color_count > 0 && t.opacity_count > 0);
                assert_true(strlen(cw_transfer_preset_about(n)) > 0);
            }
            cw_statistics_free(&s);
        }
}

static double opacity_of(const cw_transfer *t, double value)
{
    double color[3], opacity;
    cw_transfer_at(t, value, color, &opacity);
    return opacity;
}

static void auto_leaves_out_what_is_around_things(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_transfer t;
    cw_statistics s = count(CW_F32, 50000, three_humps);
    assert_ok(cw_transfer_preset("auto", &s, &t, &err), err);
    assert_true(opacity_of(&t, 8) == 0);
    assert_true(opacity_of(&t, 100) > 0.02);
    assert_true(opacity_of(&t, 200) > 2 * opacity_of(&t, 100));
    cw_statistics_free(&s);
    s = count(CW_F32, 50000, both_signs);
    assert_ok(cw_transfer_preset("auto", &s, &t, &err), err);
    assert_true(opacity_of(&t, 0.01) == 0 && opacity_of(&t, -0.01) == 0);
    assert_true(opacity_of(&t, 0.9) > 0.1 && opacity_of(&t, -0.9) > 0.1);
    cw_statistics_free(&s);
    s = count(CW_U8, 50000, saturated);
    assert_ok(cw_transfer_preset("auto", &s, &t, &err), err);
    assert_true(opacity_of(&t, 255) == 0 && opacity_of(&t, 20) > 0.1);
    cw_statistics_free(&s);
}

/* Presets at Hounsfield units stay there whatever the values. */
static void ct_presets_stand_still(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_transfer a, b;
    cw_statistics s = count(CW_F32, 5000, three_humps);
    for (int n = 0; n < 3; n++) {
        const char *name = (const char *const[]){"ct-bone", "ct-soft", "ct-skin"}[n];
        assert_ok(cw_transfer_preset(name, &s, &a, &err), err);
        assert_ok(cw_transfer_preset(name, NULL, &b, &err), err);
        assert_memory_equal(&a, &b, sizeof a);
        assert_true(a.unit_mm == 1);
        assert_true(opacity_of(&a, -1000) == 0 && opacity_of(&a, 1500) > 0.5);
    }
    assert_true(opacity_of(&a, 0) > 0.5); /* skin */
    assert_fails(cw_transfer_preset("auto", NULL, &a, &err), CW_ERR_ARGUMENT,
                 "is fitted to a volume's values", err);
    assert_fails(cw_transfer_preset("bones", &s, &a, &err), CW_ERR_ARGUMENT,
                 "no transfer function is named 'bones'; there are auto ct-bone", err);
    assert_null(cw_transfer_preset_name(1000));
    assert_null(cw_transfer_preset_about(1000));
    cw_statistics_free(&s);
}

/* A head: air, tissue and bone; then the same with air at 0, as some files store it. */
static double head(size_t i)
{
    const double u = (double)(i % 1000) / 1000;
    return u < 0.5   ? -1000 + 60 * (u - 0.25)
           : u < 0.9 ? 40 + 100 * (u - 0.7)
                     : 300 + 9000 * (u - 0.9);
}

static double shifted_head(size_t i)
{
    return head(i) + 1024;
}

static void ct_is_told_by_its_air(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_transfer t, soft;
    cw_statistics s = count(CW_F32, 50000, head);
    assert_ok(cw_transfer_preset("ct-soft", &s, &soft, &err), err);
    assert_ok(cw_transfer_preset("auto", &s, &t, &err), err);
    assert_memory_equal(&t, &soft, sizeof t);
    assert_ok(cw_transfer_preset("window", &s, &t, &err), err);
    assert_true(t.colors[0].value == -160 && t.colors[1].value == 240);
    cw_statistics_free(&s);
    s = count(CW_F32, 50000, shifted_head);
    assert_ok(cw_transfer_preset("auto", &s, &t, &err), err);
    assert_true(memcmp(&t, &soft, sizeof t) != 0);
    cw_statistics_free(&s);
}

/* Slices leave half a percent of the values black, and as many white. */
static void windows_leave_out_rare_values(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_transfer t;
    cw_statistics s = count(CW_F32, 50000, three_humps);
    assert_ok(cw_transfer_preset("window", &s, &t, &err), err);
    assert_true(t.colors[0].value > s.min && t.colors[1].value < s.max);
    cw_statistics_free(&s);
}

/* The maps of fields rise in brightness, but cool-warm, whose middle is the brightest; of a
 * signed quantity that is at 0. */
static void maps_have_the_opacities_of_auto(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_transfer t, plain;
    cw_statistics s = count(CW_F32, 50000, three_humps);
    assert_ok(cw_transfer_preset("auto", &s, &plain, &err), err);
    for (int n = 0; n < 3; n++) {
        const char *name = (const char *const[]){"viridis", "inferno", "cool-warm"}[n];
        assert_ok(cw_transfer_preset(name, &s, &t, &err), err);
        assert_memory_equal(t.opacities, plain.opacities, sizeof t.opacities);
        float before = -1;
        for (size_t c = 0; c < t.color_count && n < 2; c++) {
            const float *rgb = t.colors[c].color,
                        light = 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2];
            assert_true(light > before);
            before = light;
        }
    }
    cw_statistics_free(&s);
    s = count(CW_F32, 50000, both_signs);
    assert_ok(cw_transfer_preset("cool-warm", &s, &t, &err), err);
    assert_near(t.colors[3].value, 0, 1e-9);
    assert_near(t.colors[0].value, -t.colors[6].value, 1e-9);
    cw_statistics_free(&s);
}

/* A block of voxels in a large, tilted volume, and a speck far from it, which is not framed. */
static void boxes_are_around_what_is_visible(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_volume v;
    double low[3], high[3], one[3], corner[3];
    const cw_transfer t = {.opacity_count = 2, .opacities = {{99, 0}, {100, 0.5f}}};
    assert_ok(cw_volume_alloc(&v, CW_U8, (size_t[3]){60, 50, 40}, 1, 1, &err), err);
    const double affine[3][4] = {{0, -2, 0, 10}, {1, 0, 0, 20}, {0, 0, 3, -5}};
    memcpy(v.affine, affine, sizeof affine);
    uint8_t *voxels = cw_volume_voxels(&v);
    for (size_t k = 10; k < 20; k++)
        for (size_t j = 30; j < 45; j++)
            for (size_t i = 5; i < 25; i++)
                voxels[(k * 50 + j) * 60 + i] = 200;
    voxels[(39 * 50 + 1) * 60 + 58] = 255;
    assert_ok(cw_transfer_box(&v, &t, 0, low, high, &err), err);
    assert_ok(cw_transfer_box(&v, &t, 1, one, corner, &err), err);
    assert_memory_equal(low, one, sizeof low);
    assert_memory_equal(high, corner, sizeof high);
    const double expected[2][3] = {{10 - 2 * 45, 20 + 4, -5 + 3 * 9},
                                   {10 - 2 * 29, 20 + 25, -5 + 3 * 20}};
    for (int a = 0; a < 3; a++) {
        assert_near(low[a], expected[0][a], 1e-9);
        assert_near(high[a], expected[1][a], 1e-9);
    }
    const cw_transfer nothing = {.opacity_count = 1, .opacities = {{0, 0}}};
    assert_ok(cw_transfer_box(&v, &nothing, 0, low, high, &err), err);
    assert_near(high[1], 20 + 59, 1e-9);
    assert_near(low[0], 10 - 2 * 49, 1e-9);
    cw_volume_free(&v);

    const cw_volume points = {.data = voxels, .dim = {4, 1, 1}, .cells = &(cw_cells){0}};
    assert_true(cw_transfer_box(&points, &t, 0, low, high, &err) != CW_OK);
}

#define CASE(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)

int main(void)
{
    const struct CMUnitTest tests[] = {
        CASE(values_between_points_are_linear), CASE(nothing_said_is_white_and_transparent),
        CASE(unusable_points_are_named),        CASE(files_are_read_back_to_the_bit),
        CASE(texts_are_what_files_hold),        CASE(locales_change_nothing),
        CASE(bad_files_are_told_apart),         CASE(files_that_are_no_settings_are_refused),
        CASE(too_many_points_are_refused),      CASE(ct_is_told_by_its_air),
        CASE(windows_leave_out_rare_values),    CASE(maps_have_the_opacities_of_auto),
        CASE(presets_fit_odd_values),           CASE(auto_leaves_out_what_is_around_things),
        CASE(ct_presets_stand_still),           CASE(boxes_are_around_what_is_visible),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
