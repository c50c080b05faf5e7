/* Tests overlays: strokes, boxes, glyphs, scale bar, colour bar, and histogram. */
#include "support/pictures.h"

#include "viewer/image/strokes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static cw_image make_image(size_t width, size_t height, uint8_t grey)
{
    cw_image image;
    cw_error err = {0};
    assert_ok(cw_image_alloc(&image, width, height, &err), err);
    for (size_t n = 0; n < 4 * width * height; n++)
        image.pixels[n] = n % 4 == 3 ? 255 : grey;
    return image;
}

static const uint8_t *pixel(const cw_image *i, size_t x, size_t y)
{
    return i->pixels + 4 * (y * i->width + x);
}

/* The sum of red, in pixels that are full. */
static double ink_of(const cw_image *i)
{
    double sum = 0;
    for (size_t p = 0; p < i->width * i->height; p++)
        sum += i->pixels[4 * p] / 255.0;
    return sum;
}

/* Of any direction and place, a stroke has the area of its outline. */
static void strokes_have_their_area(void **state)
{
    (void)state;
    for (int n = 0; n < 40; n++) {
        const double angle = 0.16 * n, width = 1 + 0.2 * (n % 10);
        const double x = 40 + 0.37 * n, y = 41 - 0.29 * n;
        cw_image image = make_image(96, 96, 0);
        const cwi_pen pen = {&image, width, {1, 1, 1, 1}};
        const cwi_stroke s = {{x, y}, {x + 30 * cos(angle), y + 30 * sin(angle)}};
        cwi_pen_draw(&pen, &s, 1);
        assert_within(ink_of(&image), 30 * width + PI / 4 * width * width, 0.06);
        cw_image_free(&image);
    }
}

/* Two strokes of a half-clear figure that cross cover their crossing once. */
static void figures_cover_once(void **state)
{
    (void)state;
    cw_image image = make_image(32, 32, 0);
    const cwi_pen pen = {&image, 4, {1, 1, 1, 0.5}};
    const cwi_stroke cross[2] = {{{4, 16}, {28, 16}}, {{16, 4}, {16, 28}}};
    cwi_pen_draw(&pen, cross, 2);
    assert_int_equal(pixel(&image, 16, 16)[0], 128);
    assert_int_equal(pixel(&image, 8, 16)[0], 128);
    assert_int_equal(pixel(&image, 8, 8)[0], 0);
    cw_image_free(&image);
}

/* A box between pixels covers their shares; on a clear image opacity adds up. */
static void boxes_cover_shares_of_pixels(void **state)
{
    (void)state;
    cw_image image = make_image(8, 8, 0);
    cwi_pen pen = {&image, 1, {1, 1, 1, 1}};
    cwi_pen_fill(&pen, 1.25, 2, 4.5, 3);
    assert_near(pixel(&image, 1, 2)[0], 0.75 * 255, 1);
    assert_int_equal(pixel(&image, 2, 2)[0], 255);
    assert_near(pixel(&image, 4, 2)[0], 0.5 * 255, 1);
    assert_int_equal(pixel(&image, 2, 3)[0], 0);
    memset(image.pixels, 0, 4 * 64);
    pen.color[3] = 0.5;
    cwi_pen_fill(&pen, 0, 0, 2, 1);
    cwi_pen_fill(&pen, 1, 0, 2, 1);
    assert_int_equal(pixel(&image, 0, 0)[0], 255);
    assert_int_equal(pixel(&image, 0, 0)[3], 128);
    assert_near(pixel(&image, 1, 0)[3], 0.75 * 255, 1);
    cwi_pen_fill(&pen, -50, -50, 50, 50); /* outside there is nothing */
    cw_image_free(&image);
}

/* Every sign leaves ink, and no two the same. */
static void glyphs_are_all_different(void **state)
{
    (void)state;
    enum { MAXIMUM = 160 };
    static const uint32_t beyond[] = {0xb0, 0xb5, 0xb7, 0xd7, 0x2212, 0x394, 0xfffd};
    static uint8_t seen[MAXIMUM][32 * 24 * 4];
    size_t count = 0;
    for (size_t n = 33; n < 127 + sizeof beyond / sizeof *beyond; n++) {
        const uint32_t c = n < 127 ? (uint32_t)n : beyond[n - 127];
        cwi_stroke strokes[CWI_GLYPH_STROKES];
        double width;
        const size_t used = cwi_glyph(c, strokes, &width);
        assert_true(used <= CWI_GLYPH_STROKES);
        assert_true((used == 0) == (c == 0xfffd || (c < 128 && strchr("$&@^`{}", (int)c))));
        if (used == 0)
            continue;
        cw_image image = make_image(24, 32, 0);
        const cwi_pen pen = {&image, 1.5, {1, 1, 1, 1}};
        for (size_t s = 0; s < used; s++) {
            double *ends[2] = {strokes[s].from, strokes[s].to};
            for (int e = 0; e < 2; e++) {
                assert_true(ends[e][0] >= 0 && ends[e][0] <= width && width <= 5);
                assert_true(ends[e][1] >= 0 && ends[e][1] <= 8);
                ends[e][0] = 2 + 3 * ends[e][0];
                ends[e][1] = 2 + 3 * ends[e][1];
            }
        }
        cwi_pen_draw(&pen, strokes, used);
        assert_true(ink_of(&image) > 1);
        memcpy(seen[count], image.pixels, sizeof seen[count]);
        for (size_t k = 0; k < count; k++)
            assert_memory_not_equal(seen[k], seen[count], sizeof seen[count]);
        count++;
        cw_image_free(&image);
    }
    assert_true(count >= 26 + 26 + 10 + 20);
}

/* Text takes the width it says, whatever bytes it is of. */
static void text_is_as_wide_as_said(void **state)
{
    (void)state;
    static const char *const texts[] = {"12.5 mm",
                                        "\xc2\xb5m",
                                        ("\xe2\x88\x92"
                                         "40"),
                                        "Wq\x80z",
                                        "cut \xe2\x88",
                                        "\xf0\x9f\x98\x80"};
    for (size_t n = 0; n < sizeof texts / sizeof *texts; n++) {
        cw_image image = make_image(200, 40, 0);
        const cwi_pen pen = {&image, 1, {1, 1, 1, 1}};
        size_t first = 200, last = 0;
        cwi_pen_text(&pen, 20, 25, 12, texts[n]);
        for (size_t p = 0; p < 200 * 40; p++)
            if (image.pixels[4 * p] > 100) {
                first = p % 200 < first ? p % 200 : first;
                last = p % 200 > last ? p % 200 : last;
            }
        assert_true(first >= 19 && first <= 22);
        assert_near((double)last + 1, 20 + cwi_text_width(12, texts[n]), 2.1);
        cw_image_free(&image);
    }
    assert_near(cwi_text_width(6, "\xc2\xb5"), cwi_text_width(6, "u"), 1e-9);
    assert_near(cwi_text_width(6, ""), 0, 0);
}

static cw_volume make_volume(void)
{
    cw_volume v = {0};
    test_field(&v, 33, 33, 33, (const double[3]){2, 1, 1}, test_ramp);
    return v;
}

/* The bar's ends are at its length's distance, by the camera, at the target. */
static void scale_bar_is_true(void **state)
{
    (void)state;
    cw_volume v = make_volume();
    const cw_transfer t = test_soft_transfer();
    cw_error err = {0};
    for (int n = 0; n < 12; n++) {
        const double size = pow(10, n / 4.0 - 1);
        const cw_scene scene = {.mode = CW_MODE_SLICES,
                                .volume = &v,
                                .transfer = &t,
                                .width = 640,
                                .height = 400,
                                .camera = {.eye = {0, -100, 0},
                                           .target = {0, 20, 0},
                                           .up = {0, 0, 1},
                                           .fov_deg = n % 2 ? 0 : 360 / PI * atan(size / 240),
                                           .height_mm = size}};
        const cw_overlay o = {.scale_bar = true, .color = {255, 255, 0, 255}};
        cw_image image = make_image(320, 200, 0);
        double mm, px;
        assert_ok(cw_scale_bar(&scene, &image, &mm, &px, &err), err);
        assert_within(px, mm * 200 / size, 1e-9);
        assert_true(px <= 80 && px > 80 / 2.51);
        const double digits = mm / pow(10, floor(log10(mm) + 1e-9));
        assert_true(fabs(digits - 1) < 1e-9 || fabs(digits - 2) < 1e-9 ||
                    fabs(digits - 5) < 1e-9);
        assert_ok(cw_overlay_draw(&o, &scene, &image, &err), err);
        size_t longest = 0;
        for (size_t y = 0; y < 200; y++) {
            size_t run = 0;
            for (size_t x = 0; x < 320; x++) {
                run = pixel(&image, x, y)[0] > 128 ? run + 1 : 0;
                longest = run > longest ? run : longest;
            }
        }
        assert_near((double)longest, px + 1.2, 1); /* half its width stands out at each end */
        cw_image_free(&image);
    }
    cw_volume_free(&v);
}

static bool has_ink(const cw_image *i, size_t left, size_t top, size_t right, size_t bottom)
{
    for (size_t y = top; y < bottom; y++)
        for (size_t x = left; x < right; x++)
            if (pixel(i, x, y)[0] > 60)
                return true;
    return false;
}

/* Each part draws where it says, and only when asked; twice the same. */
static void parts_are_drawn_where_they_say(void **state)
{
    (void)state;
    enum { W = 400, H = 300 };
    cw_volume v = make_volume();
    cw_statistics s;
    cw_error err = {0};
    const cw_transfer t = test_soft_transfer();
    assert_ok(cw_volume_statistics(&v, 64, 1, &s, &err), err);
    const cw_scene scene = {
        .mode = CW_MODE_SLICES, .volume = &v, .transfer = &t, .width = W, .height = H};
    const struct {
        cw_overlay o;
        size_t at[4];
    } rows[] = {{{.axes = true}, {0, 220, 100, 300}},
                {{.axes = true}, {150, 20, 250, 290}},
                {{.scale_bar = true}, {150, 260, 250, 300}},
                {{.letters = true}, {0, 140, 20, 160}},
                {{.letters = true}, {380, 140, 400, 160}},
                {{.letters = true}, {190, 0, 210, 20}},
                {{.letters = true}, {190, 280, 210, 300}},
                {{.color_bar = true}, {340, 20, 400, 140}},
                {{.histogram = true, .statistics = &s}, {280, 200, 400, 300}},
                {{.caption = "caption"}, {0, 0, 100, 20}},
                {{.caption = "\nline"}, {0, 18, 100, 36}}};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        cw_image image = make_image(W, H, 0), again = make_image(W, H, 0);
        const size_t *at = rows[n].at;
        const cw_overlay nothing = {0};
        assert_ok(cw_overlay_draw(&nothing, &scene, &image, &err), err);
        assert_memory_equal(image.pixels, again.pixels, (size_t)4 * W * H);
        assert_ok(cw_overlay_draw(&rows[n].o, &scene, &image, &err), err);
        assert_ok(cw_overlay_draw(&rows[n].o, &scene, &again, &err), err);
        assert_memory_equal(image.pixels, again.pixels, (size_t)4 * W * H);
        assert_true(has_ink(&image, at[0], at[1], at[2], at[3]));
        cw_image_free(&image);
        cw_image_free(&again);
    }
    cw_statistics_free(&s);
    cw_volume_free(&v);
}

/* Counts pixels of a colour in a box. */
static size_t count_color(const cw_image *i, const uint8_t color[3], size_t left, size_t top,
                          size_t right, size_t bottom)
{
    size_t count = 0;
    for (size_t y = top; y < bottom; y++)
        for (size_t x = left; x < right; x++)
            count += memcmp(pixel(i, x, y), color, 3) == 0;
    return count;
}

/* Each item has its colour in a line of its own, as far as there is room; names are cut at 0.4 of
 * the width, and letters move aside. */
static void legends_have_a_line_an_item(void **state)
{
    (void)state;
    enum { W = 400, H = 300, TEXT_PX = 10, LINE = 17 };
    char long_name[400];
    static const char accents[] =
        "\xc3\xa4\xc3\xa4\xc3\xa4\xc3\xa4\xc3\xa4\xc3\xa4\xc3\xa4\xc3\xa4"
        "\xc3\xa4\xc3\xa4\xc3\xa4\xc3\xa4\xc3\xa4\xc3\xa4\xc3\xa4\xc3\xa4\xc3\xa4";
    cw_legend_item items[40];
    cw_volume v = make_volume();
    cw_error err = {0};
    const cw_transfer t = test_soft_transfer();
    const cw_scene scene = {
        .mode = CW_MODE_SLICES, .volume = &v, .transfer = &t, .width = W, .height = H};
    memset(long_name, 'm', sizeof long_name - 1);
    long_name[sizeof long_name - 1] = '\0';
    for (size_t n = 0; n < 40; n++)
        items[n] = (cw_legend_item){"name", {(uint8_t)(20 + n), 100, 50}};
    for (size_t count = 1; count <= 40; count += 13) { /* 27 and 40 do not fit */
        const size_t lines = 15, shown = count <= lines ? count : lines - 1;
        cw_image image = make_image(W, H, 0);
        const cw_overlay o = {.legend = items, .legend_count = count, .text_px = TEXT_PX};
        assert_ok(cw_overlay_draw(&o, &scene, &image, &err), err);
        for (size_t n = 0; n < 40; n++) {
            const size_t top = n < shown ? 12 + n * 35 / 2 : 0;
            const size_t found =
                count_color(&image, items[n].color, 0, top, W, n < shown ? top + 2 * LINE : H);
            assert_int_equal(found > 80, n < shown);
            assert_true(n < shown || found == 0);
        }
        assert_int_equal(has_ink(&image, 300, 12 + shown * 35 / 2, W, 12 + shown * 35 / 2 + 14),
                         count > shown);
        cw_image_free(&image);
    }
    items[0].name = long_name;
    items[1].name = accents;
    items[2].name = "";
    cw_image image = make_image(W, H, 0);
    const cw_overlay o = {
        .legend = items, .legend_count = 3, .text_px = TEXT_PX, .letters = true};
    assert_ok(cw_overlay_draw(&o, &scene, &image, &err), err);
    assert_true(!has_ink(&image, 100, 0, 180, 100));
    assert_true(has_ink(&image, 215, 12, 260, 60));
    assert_true(has_ink(&image, 180, 140, 215, 160)); /* the letter */
    assert_true(!has_ink(&image, 370, 140, 400, 160));
    cw_image_free(&image);
    cw_volume_free(&v);
}

/* The bar's colours are the transfer function's, from its lowest to its highest value. */
static void color_bar_has_the_colours(void **state)
{
    (void)state;
    cw_volume v = make_volume();
    cw_error err = {0};
    const cw_transfer t = {.color_count = 2, .colors = {{-5, {1, 0, 0}}, {5, {0, 0, 1}}}};
    const cw_scene scene = {
        .mode = CW_MODE_SLICES, .volume = &v, .transfer = &t, .width = 400, .height = 400};
    const cw_overlay o = {.color_bar = true, .text_px = 10};
    cw_image image = make_image(400, 400, 0);
    assert_ok(cw_overlay_draw(&o, &scene, &image, &err), err);
    const double top = 3.2 * 12, bottom = 0.44 * 400;
    for (size_t y = 42; y < 174; y++) {
        const double share = (bottom - (double)y - 0.5) / (bottom - top);
        assert_near(pixel(&image, 380, y)[0], 255 * (1 - share), 1.01);
        assert_near(pixel(&image, 380, y)[2], 255 * share, 1.01);
    }
    cw_image_free(&image);
    cw_volume_free(&v);
}

/* Values that are equally frequent have bars of one height; the curve goes through
 * its points. */
static void histogram_has_bars_and_the_curve(void **state)
{
    (void)state;
    enum { W = 400, H = 300 };
    cw_volume v = make_volume();
    cw_statistics s;
    cw_error err = {0};
    const cw_transfer t = {.opacity_count = 3, .opacities = {{0, 0}, {0.5, 0.2f}, {1, 0}}};
    const cw_scene scene = {
        .mode = CW_MODE_SLICES, .volume = &v, .transfer = &t, .width = W, .height = H};
    const double text = 10, bottom = H - 1.2 * text - 1.6 * text;
    const double box[4] = {0.7 * W, bottom - 0.18 * H, W - 1.2 * text, bottom};
    float *voxels = cw_volume_voxels(&v);
    for (int n = 0; n < 2; n++) { /* at last 0 and 1 are all there is */
        for (size_t k = 0; k < (size_t)33 * 33 * 33 && n == 1; k++)
            voxels[k] = roundf(voxels[k]);
        assert_ok(cw_volume_statistics(&v, 33, 1, &s, &err), err);
        cw_image image = make_image(W, H, 0);
        const cw_overlay o = {.histogram = true, .statistics = &s, .text_px = text};
        assert_ok(cw_overlay_draw(&o, &scene, &image, &err), err);
        for (size_t x = (size_t)box[0] + 6; x < (size_t)box[2] - 3; x++) {
            const double share = ((double)x + 0.5 - box[0]) / (box[2] - box[0]);
            const double high = box[3] - (1 - fabs(2 * share - 1)) * (box[3] - box[1]);
            const uint8_t *low = pixel(&image, x, (size_t)box[3] - 3);
            if (high < box[3] - 8) /* clear of the curve */
                assert_true((low[0] > 120) == (n == 0));
            if (n == 0 && high > box[1] + 4 && high < box[3] - 4) {
                const uint8_t *at = pixel(&image, x, (size_t)high);
                assert_true(at[0] > 240 && at[1] > 150 && at[2] < 80);
            }
        }
        cw_image_free(&image);
        cw_statistics_free(&s);
    }
    cw_volume_free(&v);
}

/* Ink is dark on a bright picture. */
static void ink_stands_out(void **state)
{
    (void)state;
    cw_volume v = make_volume();
    cw_error err = {0};
    const cw_transfer t = test_soft_transfer();
    const cw_scene scene = {
        .mode = CW_MODE_SLICES, .volume = &v, .transfer = &t, .width = 200, .height = 200};
    for (int bright = 0; bright < 2; bright++) {
        cw_image image = make_image(200, 200, bright ? 250 : 5);
        int low = 255, high = 0;
        assert_ok(cw_overlay_draw(&(cw_overlay){.caption = "X"}, &scene, &image, &err), err);
        for (size_t p = 0; p < 200 * 200; p++) {
            low = image.pixels[4 * p] < low ? image.pixels[4 * p] : low;
            high = image.pixels[4 * p] > high ? image.pixels[4 * p] : high;
        }
        assert_true(bright ? low < 60 && high >= 250 : high > 195 && low <= 5);
        cw_image_free(&image);
    }
    cw_volume_free(&v);
}

static void what_cannot_be_drawn_is_refused(void **state)
{
    (void)state;
    cw_volume v = make_volume();
    cw_error err = {0};
    const cw_transfer t = test_soft_transfer();
    cw_scene scene = {
        .mode = CW_MODE_SLICES, .volume = &v, .transfer = &t, .width = 200, .height = 100};
    cw_image image = make_image(100, 100, 0);
    assert_fails(cw_overlay_draw(&(cw_overlay){0}, &scene, &image, &err), CW_ERR_ARGUMENT,
                 "100 x 100", err);
    scene.width = 100;
    assert_fails(cw_overlay_draw(&(cw_overlay){.histogram = true}, &scene, &image, &err),
                 CW_ERR_ARGUMENT, "statistics", err);
    assert_fails(cw_overlay_draw(&(cw_overlay){.text_px = -1}, &scene, &image, &err),
                 CW_ERR_ARGUMENT, "-1", err);
    cw_mesh cube;
    test_make_cube(&cube);
    scene.mode = CW_MODE_MESH;
    scene.mesh = &cube;
    assert_fails(cw_overlay_draw(&(cw_overlay){.color_bar = true}, &scene, &image, &err),
                 CW_ERR_ARGUMENT, "colour bar", err);
    scene.mesh_look.tint = CW_TINT_QUALITY;
    assert_ok(cw_overlay_draw(&(cw_overlay){.color_bar = true}, &scene, &image, &err), err);
    assert_fails(cw_overlay_draw(&(cw_overlay){0}, &scene, &(cw_image){0}, &err),
                 CW_ERR_ARGUMENT, "empty", err);
    cw_mesh_free(&cube);
    cw_image_free(&image);
    cw_volume_free(&v);
}

/* Images stand in the middles of their cells; what is outside of a sheet is left out. */
static void images_are_tiled(void **state)
{
    (void)state;
    static const uint8_t back[4] = {7, 8, 9, 255};
    cw_error err = {0};
    cw_image images[5], sheet;
    for (int n = 0; n < 5; n++)
        images[n] = make_image(n == 2 ? 6 : 10, n == 2 ? 4 : 8, (uint8_t)(50 + n));
    assert_ok(cw_image_tile(images, 5, 2, 3, back, &sheet, &err), err);
    assert_int_equal(sheet.width, 23);
    assert_int_equal(sheet.height, 30);
    for (size_t n = 0; n < 5; n++)
        assert_int_equal(pixel(&sheet, n % 2 * 13 + 5, n / 2 * 11 + 4)[0], 50 + n);
    assert_int_equal(pixel(&sheet, 1, 11 + 4)[0], 7); /* left of the small one */
    assert_int_equal(pixel(&sheet, 2, 11 + 4)[0], 52);
    assert_int_equal(pixel(&sheet, 7, 11 + 4)[0], 52);
    assert_int_equal(pixel(&sheet, 8, 11 + 4)[0], 7);
    assert_int_equal(pixel(&sheet, 10, 4)[0], 7);  /* a gap */
    assert_int_equal(pixel(&sheet, 18, 26)[2], 9); /* no sixth */
    cw_image_place(&sheet, &images[0], -4, -6);
    cw_image_place(&sheet, &images[1], 20, 28);
    cw_image_place(&sheet, &images[1], 500, -500);
    assert_int_equal(pixel(&sheet, 5, 1)[0], 50);
    assert_int_equal(pixel(&sheet, 22, 29)[0], 51);
    cw_image_free(&sheet);
    assert_ok(cw_image_tile(images, 5, 0, 0, back, &sheet, &err), err);
    assert_int_equal(sheet.width, 30); /* two columns would be higher than wide */
    cw_image_free(&sheet);
    assert_fails(cw_image_tile(images, 0, 2, 3, back, &sheet, &err), CW_ERR_ARGUMENT,
                 "at least one image", err);
    assert_fails(cw_image_tile(images, 5, 5, 9999, back, &sheet, &err), CW_ERR_LIMIT, "16384",
                 err);
    for (int n = 0; n < 5; n++)
        cw_image_free(&images[n]);
    assert_fails(cw_image_tile(images, 5, 5, 0, back, &sheet, &err), CW_ERR_ARGUMENT, "image 0",
                 err);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(strokes_have_their_area),
        cmocka_unit_test(figures_cover_once),
        cmocka_unit_test(boxes_cover_shares_of_pixels),
        cmocka_unit_test(glyphs_are_all_different),
        cmocka_unit_test(text_is_as_wide_as_said),
        cmocka_unit_test(scale_bar_is_true),
        cmocka_unit_test(parts_are_drawn_where_they_say),
        cmocka_unit_test(legends_have_a_line_an_item),
        cmocka_unit_test(color_bar_has_the_colours),
        cmocka_unit_test(histogram_has_bars_and_the_curve),
        cmocka_unit_test(ink_stands_out),
        cmocka_unit_test(what_cannot_be_drawn_is_refused),
        cmocka_unit_test(images_are_tiled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
