/* Tests that letters can be read in both themes, and that keys alone reach widgets. */
#include "support/pictures.h"

#include "core/base/module.h"
#include "viewer/window/ui.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 400, HEIGHT = 400 };

static const cwi_ui_functions *u;
static cwi_ui *ui;

static struct {
    size_t pushed, items, keys;
    bool check;
    double slider, log_slider;
    size_t chosen;
    char text[16];
} used;

static int open_window(void **state)
{
    const void *functions;
    cw_error err = {0};
    const cwi_ui_desc desc = {
        .title = "test", .width = WIDTH, .height = HEIGHT, .hidden = true};
    (void)state;
    if (!cwi_module_present("window"))
        return 0;
    assert_ok(cwi_module_load("window", &functions, &err), err);
    u = functions;
    assert_ok(u->open(&desc, &ui, &err), err);
    return 0;
}

static int close_window(void **state)
{
    (void)state;
    if (ui)
        u->close(ui);
    ui = NULL;
    return 0;
}

static void frame(void)
{
    static const cwi_ui_rect panel_rect = {20, 40, 300, 0};
    static const char *const names[] = {CWI_UI_HEADING "Group", "first", "second"};
    cw_error err = {0};
    used.keys += u->begin(ui, 0)->key_count;
    u->bar_begin(ui);
    if (u->menu_begin(ui, "Menu")) {
        used.items += u->item(ui, "Item", "Ctrl+I", true, true);
        u->menu_end(ui);
    }
    u->bar_end(ui);
    if (u->panel_begin(ui, "Panel", &panel_rect, 0, NULL)) {
        used.pushed += u->button(ui, "Push it");
        u->check(ui, "Check it", &used.check);
        u->slider(ui, "Slide", &used.slider, 0, 10, "%.1f");
        u->log_slider(ui, "Factor", &used.log_slider, 0.01, 100, "%.3g");
        u->choice(ui, "Choice", names, 3, &used.chosen);
        u->input(ui, "Text", used.text, sizeof used.text);
        u->section(ui, "Section", true);
        u->text(ui, "plain words");
        u->progress(ui, 0.5, "progress");
    }
    u->panel_end(ui);
    assert_ok(u->end(ui, &err), err);
}

static void frames(void)
{
    for (int n = 0; n < 6; n++)
        frame();
}

static void feed_key(const char *key)
{
    cw_error err = {0};
    assert_ok(u->feed(ui, &(cwi_ui_event){.kind = CWI_UI_KEY, .text = key}, &err), err);
    frames();
}

static int fresh(void **state)
{
    (void)state;
    if (!ui)
        return 0;
    memset(&used, 0, sizeof used);
    used.slider = 5;
    used.log_slider = 1;
    used.chosen = 1;
    memcpy(used.text, "typed", 6);
    u->focus(ui, NULL);
    u->set_theme(ui, CWI_UI_DARK);
    frames();
    return 0;
}

/* --- contrast ----------------------------------------------------------------------------- */

/* Relative luminance and contrast as WCAG 2.1 defines them. */
static double luminance(const uint8_t *rgb)
{
    double linear[3];
    for (int c = 0; c < 3; c++) {
        const double v = rgb[c] / 255.0;
        linear[c] = v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
    }
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
}

static double contrast(double a, double b)
{
    return (fmax(a, b) + 0.05) / (fmin(a, b) + 0.05);
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The contrast of the letters in a rectangle: of its median, the background, with the pixel
 * that differs most from it. */
static double measure_contrast(const cw_image *image, const cwi_ui_rect *r)
{
    double *values = calloc((size_t)(r->width * r->height) + 1, sizeof *values), most = 1;
    size_t count = 0;
    for (size_t y = (size_t)r->y + 2; y + 2 < (size_t)(r->y + r->height); y++)
        for (size_t x = (size_t)r->x + 2; x + 2 < (size_t)(r->x + r->width); x++)
            values[count++] = luminance(image->pixels + 4 * (y * image->width + x));
    assert_true(values && count > 0);
    qsort(values, count, sizeof *values, by_value);
    const double middle = values[count / 2];
    for (size_t y = (size_t)r->y + 2; y + 2 < (size_t)(r->y + r->height); y++)
        for (size_t x = (size_t)r->x + 2; x + 2 < (size_t)(r->x + r->width); x++)
            most = fmax(
                most, contrast(middle, luminance(image->pixels + 4 * (y * image->width + x))));
    free(values);
    return most;
}

static void expect_readable(const char *label, const char *when)
{
    cw_error err = {0};
    cw_image image = {0};
    cwi_ui_rect r;
    assert_true(u->find(ui, label, &r));
    assert_ok(u->grab(ui, &image, &err), err);
    const double found = measure_contrast(&image, &r);
    if (found < 4.5)
        fail_msg("'%s', %s: its letters have a contrast of %.2f; at least 4.5 was expected",
                 label, when, found);
    cw_image_free(&image);
}

static void letters_have_contrast_in_both_themes(void **state)
{
    static const char *const labels[] = {"Push it", "Slide",       "Factor",   "Choice",
                                         "Text",    "plain words", "progress", "Section"};
    (void)state;
    if (!ui)
        skip();
    for (int theme = CWI_UI_DARK; theme <= CWI_UI_LIGHT; theme++) {
        u->set_theme(ui, (cwi_ui_theme)theme);
        frames();
        for (size_t n = 0; n < sizeof labels / sizeof *labels; n++) {
            cw_error err = {0};
            cwi_ui_rect r;
            expect_readable(labels[n], theme ? "light" : "dark");
            assert_true(u->find(ui, labels[n], &r));
            cwi_ui_event event = {
                .kind = CWI_UI_MOVE, .x = r.x + r.width / 2, .y = r.y + r.height / 2};
            assert_ok(u->feed(ui, &event, &err), err);
            frames();
            expect_readable(labels[n],
                            theme ? "light, under the mouse" : "dark, under the mouse");
            event.x = event.y = 390;
            assert_ok(u->feed(ui, &event, &err), err);
            frames();
        }
    }
}

static void themes_differ(void **state)
{
    (void)state;
    if (!ui)
        skip();
    cw_error err = {0};
    cw_image dark = {0}, light = {0};
    cwi_ui_rect r;
    assert_ok(u->grab(ui, &dark, &err), err);
    u->set_theme(ui, CWI_UI_LIGHT);
    frames();
    assert_ok(u->grab(ui, &light, &err), err);
    assert_true(u->find(ui, "plain words", &r));
    const size_t at = 4 * ((size_t)(r.y + r.height) * WIDTH + (size_t)(r.x + r.width - 2));
    assert_true(luminance(light.pixels + at) > 0.6);
    assert_true(luminance(dark.pixels + at) < 0.1);
    cw_image_free(&dark);
    cw_image_free(&light);
}

/* --- keys --------------------------------------------------------------------------------- */

static void keys_alone_use_widgets(void **state)
{
    (void)state;
    if (!ui)
        skip();
    feed_key("Space");
    assert_int_equal(used.keys, 1); /* a key of the program */
    assert_int_equal(used.pushed, 0);
    u->focus(ui, "Panel");
    frames();
    assert_true(u->focused(ui));
    feed_key("Space");
    assert_int_equal(used.pushed, 1);
    feed_key("Down");
    feed_key("Space");
    assert_true(used.check);
    assert_int_equal(used.keys, 1); /* the program has seen none of these */
    feed_key("Escape");
    assert_false(u->focused(ui));
    feed_key("Space");
    assert_int_equal(used.pushed, 1);
    assert_int_equal(used.keys, 2);
}

static void the_widget_with_the_keys_is_framed(void **state)
{
    (void)state;
    if (!ui)
        skip();
    cw_error err = {0};
    cw_image before = {0}, after = {0};
    cwi_ui_rect r;
    size_t changed = 0;
    assert_ok(u->grab(ui, &before, &err), err);
    u->focus(ui, "Panel");
    frames();
    assert_ok(u->grab(ui, &after, &err), err);
    assert_true(u->find(ui, "Push it", &r));
    for (size_t x = (size_t)r.x; x < (size_t)(r.x + r.width); x++)
        for (size_t y = (size_t)r.y - 4; y < (size_t)r.y + 4; y++)
            changed += memcmp(before.pixels + 4 * (y * WIDTH + x),
                              after.pixels + 4 * (y * WIDTH + x), 3) != 0;
    assert_true(changed >= (size_t)r.width / 2);
    cw_image_free(&before);
    cw_image_free(&after);
}

static void keys_reach_menus(void **state)
{
    (void)state;
    if (!ui)
        skip();
    u->focus(ui, "");
    frames();
    feed_key("Down");
    feed_key("Down");
    feed_key("Enter");
    assert_int_equal(used.items, 1);
}

static void panels_that_are_not_there_take_no_keys(void **state)
{
    (void)state;
    if (!ui)
        skip();
    u->focus(ui, "Nothing");
    assert_false(u->focused(ui));
    u->focus(ui, "Panel");
    u->focus(ui, NULL);
    assert_false(u->focused(ui));
}

/* --- logarithmic sliders ------------------------------------------------------------------- */

static void logarithmic_sliders_have_factors_of_equal_length(void **state)
{
    (void)state;
    if (!ui)
        skip();
    cw_error err = {0};
    cwi_ui_rect r;
    assert_true(u->find(ui, "Factor", &r));
    cwi_ui_event event = {.kind = CWI_UI_MOVE, .x = r.x + r.width / 2, .y = r.y + r.height / 2};
    assert_ok(u->feed(ui, &event, &err), err);
    assert_ok(u->feed(ui, &(cwi_ui_event){.kind = CWI_UI_PRESS}, &err), err);
    event.x = r.x + 0.75 * r.width;
    assert_ok(u->feed(ui, &event, &err), err);
    frames();
    assert_ok(u->feed(ui, &(cwi_ui_event){.kind = CWI_UI_LIFT}, &err), err);
    frames();
    assert_true(fabs(log10(used.log_slider) - 1) < 0.15);
}

int main(void)
{
#define CASE(name) cmocka_unit_test_setup(name, fresh)
    const struct CMUnitTest tests[] = {
        CASE(letters_have_contrast_in_both_themes),
        CASE(themes_differ),
        CASE(keys_alone_use_widgets),
        CASE(the_widget_with_the_keys_is_framed),
        CASE(keys_reach_menus),
        CASE(panels_that_are_not_there_take_no_keys),
        CASE(logarithmic_sliders_have_factors_of_equal_length),
    };
#undef CASE
    return cmocka_run_group_tests(tests, open_window, close_window);
}
