/* Tests the comparison of pictures: colour differences, similarity, percentiles, and pictures
 * of differences. */
#include "support/support.h"

#include "viewer/image/color_difference.h"

#include <cubewright/picture.h>

#include <math.h>
#include <string.h>

/* The 34 pairs of [Sharma2005], which reach every branch: hues across 0, greys, the turn in the blues. */
static void color_differences_are_those_published(void **state)
{
    (void)state;
    static const double pairs[][7] = {
        {50, 2.6772, -79.7751, 50, 0, -82.7485, 2.0425},
        {50, 3.1571, -77.2803, 50, 0, -82.7485, 2.8615},
        {50, 2.8361, -74.0200, 50, 0, -82.7485, 3.4412},
        {50, -1.3802, -84.2814, 50, 0, -82.7485, 1.0000},
        {50, -1.1848, -84.8006, 50, 0, -82.7485, 1.0000},
        {50, -0.9009, -85.5211, 50, 0, -82.7485, 1.0000},
        {50, 0, 0, 50, -1, 2, 2.3669},
        {50, -1, 2, 50, 0, 0, 2.3669},
        {50, 2.4900, -0.0010, 50, -2.4900, 0.0009, 7.1792},
        {50, 2.4900, -0.0010, 50, -2.4900, 0.0010, 7.1792},
        {50, 2.4900, -0.0010, 50, -2.4900, 0.0011, 7.2195},
        {50, 2.4900, -0.0010, 50, -2.4900, 0.0012, 7.2195},
        {50, -0.0010, 2.4900, 50, 0.0009, -2.4900, 4.8045},
        {50, -0.0010, 2.4900, 50, 0.0010, -2.4900, 4.8045},
        {50, -0.0010, 2.4900, 50, 0.0011, -2.4900, 4.7461},
        {50, 2.5, 0, 50, 0, -2.5, 4.3065},
        {50, 2.5, 0, 73, 25, -18, 27.1492},
        {50, 2.5, 0, 61, -5, 29, 22.8977},
        {50, 2.5, 0, 56, -27, -3, 31.9030},
        {50, 2.5, 0, 58, 24, 15, 19.4535},
        {50, 2.5, 0, 50, 3.1736, 0.5854, 1.0000},
        {50, 2.5, 0, 50, 3.2972, 0, 1.0000},
        {50, 2.5, 0, 50, 1.8634, 0.5757, 1.0000},
        {50, 2.5, 0, 50, 3.2592, 0.3350, 1.0000},
        {60.2574, -34.0099, 36.2677, 60.4626, -34.1751, 39.4387, 1.2644},
        {63.0109, -31.0961, -5.8663, 62.8187, -29.7946, -4.0864, 1.2630},
        {61.2901, 3.7196, -5.3901, 61.4292, 2.2480, -4.9620, 1.8731},
        {35.0831, -44.1164, 3.7933, 35.0232, -40.0716, 1.5901, 1.8645},
        {22.7233, 20.0904, -46.6940, 23.0331, 14.9730, -42.5619, 2.0373},
        {36.4612, 47.8580, 18.3852, 36.2715, 50.5065, 21.2231, 1.4146},
        {90.8027, -2.0831, 1.4410, 91.1528, -1.6435, 0.0447, 1.4441},
        {90.9257, -0.5406, -0.9208, 88.6381, -0.8985, -0.7239, 1.5381},
        {6.7747, -0.2908, -2.4247, 5.8714, -0.0985, -2.2286, 0.6377},
        {2.0776, 0.0795, -1.1350, 0.9033, -0.0636, -0.5514, 0.9082},
    };
    for (size_t n = 0; n < sizeof pairs / sizeof *pairs; n++) {
        assert_near(cwi_delta_e(pairs[n], pairs[n] + 3), pairs[n][6], 5.1e-5);
        assert_near(cwi_delta_e(pairs[n] + 3, pairs[n]), pairs[n][6], 5.1e-5);
    }
}

static void lab_of_known_colors(void **state)
{
    (void)state;
    static const double known[][6] = {{0, 0, 0, 0, 0, 0},
                                      {1, 1, 1, 100, 0, 0},
                                      {1, 0, 0, 53.2408, 80.0925, 67.2032},
                                      {0, 1, 0, 87.7347, -86.1827, 83.1793},
                                      {0, 0, 1, 32.2970, 79.1875, -107.8602}};
    for (size_t n = 0; n < 5; n++) {
        double lab[3];
        cwi_lab_of(known[n], lab);
        for (int c = 0; c < 3; c++)
            assert_near(lab[c], known[n][3 + c], 0.01);
    }
}

static cw_picture picture_of(size_t width, size_t height)
{
    cw_error err = {0};
    cw_picture p;
    assert_ok(cw_picture_alloc(&p, width, height, &err), err);
    for (size_t n = 0; n < width * height; n++) {
        const float alpha = n % width < width / 2 ? 0 : 0.75f;
        for (size_t c = 0; c < 3; c++)
            p.pixels[4 * n + c] = alpha * (float)(n * (c + 3) % 17) / 32;
        p.pixels[4 * n + 3] = alpha;
    }
    return p;
}

/* Only what the reference covers counts, over the background. */
static void errors_are_counted_where_the_reference_is(void **state)
{
    (void)state;
    static const float white[2][3] = {{1, 1, 1}, {1, 1, 1}};
    cw_error err = {0};
    cw_comparison gap;
    cw_picture a = picture_of(40, 30), b = picture_of(40, 30);
    assert_ok(cw_picture_compare(&a, &b, white, &gap, &err), err);
    assert_int_equal(gap.pixels, 600);
    assert_true(gap.rmse == 0 && gap.max == 0 && gap.bias == 0 && gap.delta_e_max == 0);
    assert_near(gap.ssim, 1, 1e-12);
    for (size_t n = 0; n < 40 * 30; n++) { /* darker by 2/255; one by 10 more in red */
        for (size_t c = 0; c < 3; c++)
            a.pixels[4 * n + c] -= 2.0f / 255;
        if (n == 35)
            a.pixels[4 * n] -= 10.0f / 255;
    }
    assert_ok(cw_picture_compare(&a, &b, white, &gap, &err), err);
    assert_near(gap.bias, -(2 + 10.0 / 1800), 1e-4);
    assert_near(gap.max, 12, 1e-4);
    assert_near(gap.rmse, sqrt((1799 * 4 + 144) / 1800.0), 1e-4);
    assert_true(gap.delta_e_mean > 0.3 && gap.delta_e_mean < 1.5);
    assert_true(gap.delta_e_p99 < gap.delta_e_max && gap.delta_e_max > 2);
    assert_true(gap.ssim > 0.98 && gap.ssim < 1 - 1e-6);
    memset(b.pixels, 0, 40 * 30 * 4 * sizeof(float));
    assert_ok(cw_picture_compare(&a, &b, white, &gap, &err), err);
    assert_int_equal(gap.pixels, 0);
    cw_picture_free(&b);
    assert_fails(cw_picture_compare(&a, &b, white, &gap, &err), CW_ERR_ARGUMENT,
                 "empty picture", err);
    b = picture_of(30, 40);
    assert_fails(cw_picture_compare(&a, &b, white, &gap, &err), CW_ERR_ARGUMENT, "40 x 30",
                 err);
    cw_picture_free(&a);
    cw_picture_free(&b);
}

/* The nearest rank: of 100 pixels the 99th is not the worst one, of 101 pixels the 100th is. */
static void one_pixel_of_a_hundred_may_be_off(void **state)
{
    (void)state;
    static const float black[2][3];
    for (size_t count = 99; count <= 101; count++) {
        cw_error err = {0};
        cw_comparison gap;
        cw_picture p[2];
        for (int i = 0; i < 2; i++) {
            assert_ok(cw_picture_alloc(&p[i], count, 1, &err), err);
            for (size_t n = 0; n < 4 * count; n++)
                p[i].pixels[n] = n % 4 == 3 ? 1 : 0.5f;
        }
        p[0].pixels[4 * 7] = 1;
        assert_ok(cw_picture_compare(&p[0], &p[1], black, &gap, &err), err);
        assert_true(gap.delta_e_max > 5);
        assert_true(gap.delta_e_p99 == (count < 100 ? gap.delta_e_max : 0));
        cw_picture_free(&p[0]);
        cw_picture_free(&p[1]);
    }
}

/* A pixel, and one more for every 1024 of the width. */
static void the_line_between_halves_grows_with_the_picture(void **state)
{
    (void)state;
    static const size_t widths[] = {40, 1023, 1024, 2047, 2048};
    for (size_t n = 0; n < sizeof widths / sizeof *widths; n++) {
        cw_error err = {0};
        cw_picture p, both;
        size_t line = 0;
        assert_ok(cw_picture_alloc(&p, widths[n], 1, &err), err);
        assert_ok(cw_picture_split(&p, &p, 0.5, &both, &err), err);
        for (size_t x = 0; x < widths[n]; x++)
            line += both.pixels[4 * x] == 1;
        assert_int_equal(line, 1 + widths[n] / 1024);
        cw_picture_free(&p);
        cw_picture_free(&both);
    }
}

/* On a plain picture structural similarity is known on paper: only the means differ. */
static void similarity_of_plain_pictures(void **state)
{
    (void)state;
    static const float black[2][3];
    cw_error err = {0};
    cw_comparison gap;
    cw_picture p[2];
    const double grey[2] = {0.5, 0.25};
    for (int i = 0; i < 2; i++) {
        assert_ok(cw_picture_alloc(&p[i], 20, 4, &err), err);
        for (size_t n = 0; n < 80 * 4; n++)
            p[i].pixels[n] = n % 4 == 3 ? 1 : (float)grey[i];
    }
    assert_ok(cw_picture_compare(&p[0], &p[1], black, &gap, &err), err);
    assert_near(gap.ssim, (2 * 0.5 * 0.25 + 1e-4) / (0.25 + 0.0625 + 1e-4), 1e-7);
    cw_picture_free(&p[0]);
    cw_picture_free(&p[1]);
}

static void differences_and_splits_are_pictures(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_picture a = picture_of(40, 30), b = picture_of(40, 30), out;
    for (size_t n = 0; n < 40 * 30; n++) {
        b.pixels[4 * n] += 0.01f;
        if (n == 3)
            b.pixels[4 * n + 3] = 0.5f; /* black in place of nothing: seen over white */
    }
    assert_ok(cw_picture_difference(&a, &b, 20, &out, &err), err);
    for (size_t n = 0; n < 40 * 30; n++) {
        assert_near((double)out.pixels[4 * n], n == 3 ? 1 : 0.2, 1e-5);
        assert_near((double)out.pixels[4 * n + 1], n == 3 ? 1 : 0, 1e-5);
        assert_true(out.pixels[4 * n + 3] == 1);
    }
    cw_picture_free(&out);
    assert_fails(cw_picture_difference(&a, &b, 0, &out, &err), CW_ERR_ARGUMENT, "times 0", err);
    for (int i = 0; i <= 2; i++) {
        assert_ok(cw_picture_split(&a, &b, i / 2.0, &out, &err), err);
        size_t left = 0, right = 0, line = 0;
        for (size_t x = 0; x < 40; x++) {
            const float *p = out.pixels + 4 * (5 * 40 + x);
            if (p[0] == 1 && p[3] == 1)
                line++;
            else if (memcmp(p, a.pixels + 4 * (5 * 40 + x), 16) == 0)
                left++;
            else if (memcmp(p, b.pixels + 4 * (5 * 40 + x), 16) == 0)
                right++;
        }
        assert_int_equal(line, i == 1);
        assert_int_equal(left + right + line, 40);
        assert_true(i == 0 ? left == 0 : i == 2 ? right == 0 : left >= 19 && right >= 19);
        cw_picture_free(&out);
    }
    assert_fails(cw_picture_split(&a, &b, 1.5, &out, &err), CW_ERR_ARGUMENT, "1.5", err);
    cw_picture_free(&a);
    cw_picture_free(&b);
}

static void pixels_that_differ_are_counted(void **state)
{
    (void)state;
    uint8_t p[3][4] = {{10, 20, 30, 255}, {10, 20, 30, 255}, {10, 20, 30, 255}};
    uint8_t q[3][4] = {{12, 20, 30, 255}, {10, 20, 27, 255}, {10, 20, 30, 0}};
    const cw_image a = {.width = 3, .height = 1, .pixels = p[0]},
                   b = {.width = 3, .height = 1, .pixels = q[0]},
                   tall = {.width = 1, .height = 3, .pixels = q[0]};
    size_t differ;
    cw_error err = {0};
    for (int tolerance = 0; tolerance < 4; tolerance++) {
        assert_ok(cw_image_compare(&a, &b, tolerance, &differ, &err), err);
        assert_int_equal(differ, tolerance < 2 ? 2 : tolerance < 3 ? 1 : 0);
    }
    assert_fails(cw_image_compare(&a, &tall, 0, &differ, &err), CW_ERR_ARGUMENT,
                 "3 x 1 and 1 x 3", err);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(color_differences_are_those_published),
        cmocka_unit_test(lab_of_known_colors),
        cmocka_unit_test(errors_are_counted_where_the_reference_is),
        cmocka_unit_test(one_pixel_of_a_hundred_may_be_off),
        cmocka_unit_test(the_line_between_halves_grows_with_the_picture),
        cmocka_unit_test(similarity_of_plain_pictures),
        cmocka_unit_test(pixels_that_differ_are_counted),
        cmocka_unit_test(differences_and_splits_are_pictures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
