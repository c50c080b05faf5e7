/* A window that nobody sees, used by what is fed to it. */
#include "support/pictures.h"

#include "core/base/memory.h"
#include "core/base/module.h"
#include "viewer/window/ui.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 400, HEIGHT = 300 };

static const cwi_ui_functions *u;
static cwi_ui *ui;

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

static void need_window(void)
{
    if (!ui)
        skip();
}

/* ---- what is fed ---- */

static void feed(cwi_ui_event event)
{
    cw_error err = {0};
    assert_ok(u->feed(ui, &event, &err), err);
}

static void feed_move(double x, double y)
{
    feed((cwi_ui_event){.kind = CWI_UI_MOVE, .x = x, .y = y});
}

static void feed_button(cwi_ui_kind kind, int button)
{
    feed((cwi_ui_event){.kind = kind, .button = button});
}

static void feed_text(cwi_ui_kind kind, const char *text)
{
    feed((cwi_ui_event){.kind = kind, .text = text});
}

static void feed_click(double x, double y)
{
    feed_move(x, y);
    feed_button(CWI_UI_PRESS, CWI_UI_LEFT);
    feed_button(CWI_UI_LIFT, CWI_UI_LEFT);
}

static void click(const char *label)
{
    cwi_ui_rect r = {0};
    if (!u->find(ui, label, &r))
        fail_msg("'%s' was not to be found", label);
    feed_click(r.x + r.width / 2, r.y + r.height / 2);
}

/* ---- a panel with everything ---- */

static struct {
    size_t buttons, choices, enters, changes;
    bool check, is_modal, is_disabled, is_open;
    size_t chosen;
    double slider, number;
    float color[3];
    char text[32];
    cwi_ui_area area;
    size_t items;
} used;

static const cwi_ui_rect panel_rect = {10, 40, 220, 0};

static void lay_out_panel(void)
{
    static const char *const names[] = {"first", "second", "third"};
    used.is_open = u->panel_begin(ui, "Panel", &panel_rect, 0, NULL);
    if (used.is_open) {
        if (used.is_disabled)
            u->disable(ui, true);
        used.buttons += u->button(ui, "Push##1");
        if (used.is_disabled)
            u->disable(ui, false);
        u->check(ui, "Check", &used.check);
        used.changes += u->changed(ui);
        used.choices += u->choice(ui, "Choice", names, 3, &used.chosen);
        u->slider(ui, "Slide", &used.slider, 0, 10, "%.1f");
        used.changes += u->changed(ui);
        u->number(ui, "Number", &used.number, 0.5, "%.1f");
        used.enters += u->input(ui, "Text", used.text, sizeof used.text);
        u->area(ui, "##area", 0, 40, &used.area);
    }
    u->panel_end(ui);
}

static void lay_out_modal(void)
{
    const cwi_ui_rect small = {0, 0, 100, 0};
    if (!used.is_modal)
        return;
    if (u->panel_begin(ui, "Ask", &small, CWI_UI_MODAL, &used.is_modal))
        if (u->button(ui, "Enough"))
            used.is_modal = false;
    u->panel_end(ui);
}

static void lay_out_bar(void)
{
    assert_true(u->bar_begin(ui) > 10);
    if (u->menu_begin(ui, "Menu")) {
        used.items += u->item(ui, "Item", "Ctrl+I", false, true);
        u->menu_end(ui);
    }
    u->bar_end(ui);
}

/* One frame; a copy of its input, whose drops are valid until the next. */
static cwi_ui_input frame(void)
{
    cw_error err = {0};
    const cwi_ui_input in = *u->begin(ui, 0);
    lay_out_bar();
    lay_out_panel();
    lay_out_modal();
    assert_ok(u->end(ui, &err), err);
    return in;
}

/* Until everything fed has been taken and layouts have come to rest. */
static void frames(void)
{
    for (int n = 0; u->pending(ui); n++) {
        assert_true(n < 1000);
        frame();
    }
    for (int n = 0; n < 3; n++)
        frame();
}

static int fresh(void **state)
{
    (void)state;
    memset(&used, 0, sizeof used);
    used.slider = 5;
    strcpy(used.text, "old");
    if (ui) {
        feed_move(WIDTH - 5, HEIGHT - 5);
        frames();
    }
    return 0;
}

/* ---- widgets ---- */

static void buttons_are_pushed_where_they_are_found(void **state)
{
    (void)state;
    need_window();
    click("Push");
    frames();
    assert_int_equal(used.buttons, 1);
    click("Panel/Push");
    frames();
    assert_int_equal(used.buttons, 2);
    cwi_ui_rect r;
    assert_false(u->find(ui, "Other/Push", &r));
    assert_false(u->find(ui, "Push##1", &r));
}

static void disabled_buttons_are_not_pushed(void **state)
{
    (void)state;
    need_window();
    used.is_disabled = true;
    frames();
    click("Push");
    frames();
    assert_int_equal(used.buttons, 0);
}

static void sliders_follow_the_mouse_and_say_when_it_ends(void **state)
{
    (void)state;
    need_window();
    cwi_ui_rect r;
    assert_true(u->find(ui, "Slide", &r));
    feed_move(r.x + r.width / 2, r.y + r.height / 2);
    feed_button(CWI_UI_PRESS, CWI_UI_LEFT);
    for (int n = 1; n <= 10; n++)
        feed_move(r.x + r.width / 2 + n * r.width / 10, r.y + r.height / 2);
    frames();
    assert_near(used.slider, 10, 1e-9);
    assert_int_equal(used.changes, 0);
    feed_button(CWI_UI_LIFT, CWI_UI_LEFT);
    frames();
    assert_int_equal(used.changes, 1);
}

static void numbers_change_by_the_pixel(void **state)
{
    (void)state;
    need_window();
    cwi_ui_rect r;
    assert_true(u->find(ui, "Number", &r));
    feed_move(r.x + 20, r.y + r.height / 2);
    feed_button(CWI_UI_PRESS, CWI_UI_LEFT);
    feed_move(r.x + 40, r.y + r.height / 2);
    feed_button(CWI_UI_LIFT, CWI_UI_LEFT);
    frames();
    assert_near(used.number, 10, 2);
}

static void checks_turn_over(void **state)
{
    (void)state;
    need_window();
    click("Check");
    frames();
    assert_true(used.check);
    assert_int_equal(used.changes, 1);
    click("Check");
    frames();
    assert_false(used.check);
}

static void choices_open_and_are_chosen(void **state)
{
    (void)state;
    need_window();
    cwi_ui_rect r;
    assert_false(u->find(ui, "third", &r));
    click("Choice");
    frames();
    click("Choice/third");
    frames();
    assert_int_equal(used.choices, 1);
    assert_int_equal(used.chosen, 2);
    assert_false(u->find(ui, "third", &r));
}

static void escape_shuts_a_choice_and_is_no_key_then(void **state)
{
    (void)state;
    need_window();
    cwi_ui_rect r;
    click("Choice");
    frames();
    assert_true(u->find(ui, "second", &r));
    feed_text(CWI_UI_KEY, "Escape");
    assert_int_equal(frame().key_count, 0);
    frames();
    assert_false(u->find(ui, "second", &r));
    feed_text(CWI_UI_KEY, "Escape");
    assert_int_equal(frame().key_count, 1);
}

static void menus_open_and_their_items_are_used(void **state)
{
    (void)state;
    need_window();
    click("Menu");
    frames();
    click("Menu/Item");
    frames();
    assert_int_equal(used.items, 1);
}

static void text_is_typed_edited_and_entered(void **state)
{
    (void)state;
    need_window();
    click("Text");
    frames();
    assert_true(frame().typing);
    feed_text(CWI_UI_KEY, "Ctrl+A");
    feed_text(CWI_UI_WRITE, "new \xc2\xb5m");
    feed_text(CWI_UI_KEY, "Home");
    feed_text(CWI_UI_KEY, "Delete");
    feed_text(CWI_UI_WRITE, "N");
    feed_text(CWI_UI_KEY, "Q"); /* no shortcut while one types */
    feed_text(CWI_UI_KEY, "Enter");
    feed_text(CWI_UI_KEY, "Q");
    size_t keys = 0;
    while (u->pending(ui))
        keys += frame().key_count;
    assert_int_equal(keys, 1);
    assert_string_equal(used.text, "New \xc2\xb5m");
    assert_int_equal(used.enters, 1);
    assert_false(frame().typing);
}

static void text_is_copied_and_pasted(void **state)
{
    (void)state;
    need_window();
    u->set_clipboard(ui, "pasted ");
    click("Text");
    frames();
    feed_text(CWI_UI_KEY, "Home");
    feed_text(CWI_UI_KEY, "Ctrl+V");
    feed_text(CWI_UI_KEY, "Ctrl+A");
    feed_text(CWI_UI_KEY, "Ctrl+C");
    feed_text(CWI_UI_KEY, "End");
    feed_text(CWI_UI_KEY, "Ctrl+V");
    feed_text(CWI_UI_KEY, "Enter");
    frames();
    assert_string_equal(used.text, "pasted oldpasted old");
}

static void what_was_typed_in_another_text_is_not_undone(void **state)
{
    (void)state;
    need_window();
    click("Text");
    frames();
    feed_text(CWI_UI_KEY, "End");
    feed_text(CWI_UI_WRITE, "er");
    feed_text(CWI_UI_WRITE, " and older");
    feed_text(CWI_UI_KEY, "Enter");
    frames();
    assert_string_equal(used.text, "older and older");
    strcpy(used.text, "n");
    frames();
    click("Text");
    frames();
    feed_text(CWI_UI_KEY, "Ctrl+Z");
    feed_text(CWI_UI_KEY, "Ctrl+Z");
    feed_text(CWI_UI_WRITE, "o");
    feed_text(CWI_UI_KEY, "Enter");
    frames();
    assert_string_equal(used.text, "no");
}

static void areas_say_what_the_mouse_does_to_them(void **state)
{
    (void)state;
    need_window();
    const cwi_ui_rect r = used.area.rect;
    feed_move(r.x + 7, r.y + 9);
    frame();
    assert_true(used.area.over);
    assert_near(used.area.x, 7, 1e-6);
    assert_near(used.area.y, 9, 1e-6);
    feed_button(CWI_UI_PRESS, CWI_UI_LEFT);
    assert_true(frame().over_widget);
    assert_true(used.area.pressed && used.area.is_down && !used.area.twice);
    feed_move(WIDTH - 1, HEIGHT - 1); /* what began there goes on */
    assert_true(frame().over_widget);
    assert_true(used.area.is_down && !used.area.pressed && !used.area.over);
    feed_button(CWI_UI_LIFT, CWI_UI_LEFT);
    frame();
    assert_true(used.area.lifted && !used.area.is_down);
    feed_move(r.x + 7, r.y + 9);
    frame();
    feed_button(CWI_UI_PRESS, CWI_UI_RIGHT);
    frame();
    assert_true(used.area.right);
    feed_button(CWI_UI_LIFT, CWI_UI_RIGHT);
    frames();
}

static void second_presses_at_one_place_are_told(void **state)
{
    (void)state;
    need_window();
    const cwi_ui_rect r = used.area.rect;
    const bool expected[] = {false, true, false};
    for (int n = 0; n < 3; n++) {
        feed_click(r.x + 100, r.y + 20);
        frame(); /* the way there */
        const cwi_ui_input in = frame();
        assert_true(in.pressed[CWI_UI_LEFT]);
        assert_int_equal(in.twice[CWI_UI_LEFT], expected[n]);
        assert_int_equal(used.area.twice, expected[n]);
        frame();
    }
    feed_click(r.x + 130, r.y + 20);
    frame();
    const cwi_ui_input in = frame();
    assert_true(in.pressed[CWI_UI_LEFT] && !in.twice[CWI_UI_LEFT]);
    frames();
}

static void modal_panels_block_what_is_behind_them(void **state)
{
    (void)state;
    need_window();
    used.is_modal = true;
    frames();
    click("Push");
    frames();
    assert_int_equal(used.buttons, 0);
    assert_true(frame().over_widget);
    click("Ask/Enough");
    frames();
    assert_false(used.is_modal);
    click("Push");
    frames();
    assert_int_equal(used.buttons, 1);
}

static void modal_panels_have_a_closing_button(void **state)
{
    (void)state;
    need_window();
    used.is_modal = true;
    frames();
    click("Ask/close");
    frames();
    assert_false(used.is_modal);
    assert_false(frame().over_widget);
}

/* ---- input ---- */

static void keys_have_names(void **state)
{
    static const char *const names[] = {"A", "9",   "Ctrl+S", "Shift+Left",       "?",
                                        "[", "F12", "Space",  "Ctrl+Alt+Shift+Z", "\xc3\xa9"};
    (void)state;
    need_window();
    for (size_t n = 0; n < sizeof names / sizeof *names; n++)
        feed_text(CWI_UI_KEY, names[n]);
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        const cwi_ui_input in = frame();
        assert_int_equal(in.key_count, 1);
        assert_string_equal(in.keys[0], names[n]);
        assert_int_equal((in.modifiers & CWI_UI_CTRL) != 0, strstr(names[n], "Ctrl+") != NULL);
    }
    assert_int_equal(frame().key_count, 0);
}

static void keys_of_no_name_are_refused(void **state)
{
    static const char *const names[] = {"",
                                        "a",
                                        "Enter ",
                                        "Hyper+A",
                                        "AB",
                                        "Ctrl+",
                                        "Shift+Ctrl+A",
                                        "\xc3",
                                        "\xc3"
                                        "A",
                                        "F13",
                                        " ",
                                        NULL};
    (void)state;
    need_window();
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        cw_error err = {0};
        const cwi_ui_event event = {.kind = CWI_UI_KEY, .text = names[n]};
        assert_int_equal(u->feed(ui, &event, &err), CW_ERR_ARGUMENT);
        assert_true(strlen(err.message) > 0);
    }
    assert_false(u->pending(ui));
}

static void input_that_cannot_be_is_refused(void **state)
{
    const cwi_ui_event events[] = {{.kind = CWI_UI_PRESS, .button = CWI_UI_BUTTONS},
                                   {.kind = CWI_UI_LIFT, .button = -1},
                                   {.kind = CWI_UI_MOVE, .x = NAN},
                                   {.kind = CWI_UI_RESIZE, .x = 0, .y = 10},
                                   {.kind = CWI_UI_RESIZE, .x = 10, .y = 1e9},
                                   {.kind = CWI_UI_DROP},
                                   {.kind = (cwi_ui_kind)77}};
    (void)state;
    need_window();
    for (size_t n = 0; n < sizeof events / sizeof *events; n++) {
        cw_error err = {0};
        assert_int_equal(u->feed(ui, &events[n], &err), CW_ERR_ARGUMENT);
    }
}

static void presses_and_lifts_fall_into_frames_of_their_own(void **state)
{
    (void)state;
    need_window();
    feed_move(300, 200);
    feed_button(CWI_UI_PRESS, CWI_UI_RIGHT);
    feed_button(CWI_UI_LIFT, CWI_UI_RIGHT);
    cwi_ui_input in = frame();
    assert_near(in.x, 300, 0);
    assert_true(u->pending(ui));
    in = frame();
    assert_true(in.pressed[CWI_UI_RIGHT] && in.down[CWI_UI_RIGHT] && !in.lifted[CWI_UI_RIGHT]);
    assert_false(in.over_widget);
    in = frame();
    assert_true(in.lifted[CWI_UI_RIGHT] && !in.down[CWI_UI_RIGHT] && !in.pressed[CWI_UI_RIGHT]);
    assert_false(u->pending(ui));
}

static void presses_stay_where_they_were(void **state)
{
    (void)state;
    need_window();
    feed_move(300, 200);
    feed_button(CWI_UI_PRESS, CWI_UI_MIDDLE);
    feed_move(310, 190);
    feed_move(320, 180);
    feed_button(CWI_UI_LIFT, CWI_UI_MIDDLE);
    frame();
    cwi_ui_input in = frame();
    assert_true(in.pressed[CWI_UI_MIDDLE]);
    assert_near(in.x, 300, 0);
    assert_near(in.dx, 0, 0); /* the way there was not dragged */
    in = frame(); /* moves are joined, and what is dragged gets there before it is let go */
    assert_true(in.down[CWI_UI_MIDDLE]);
    assert_near(in.dx, 20, 0);
    assert_near(in.dy, -20, 0);
    in = frame();
    assert_true(in.lifted[CWI_UI_MIDDLE]);
    assert_near(in.dx, 0, 0);
}

static void wheels_and_drops_arrive(void **state)
{
    (void)state;
    need_window();
    feed((cwi_ui_event){.kind = CWI_UI_WHEEL, .y = 1, .modifiers = CWI_UI_SHIFT});
    feed((cwi_ui_event){.kind = CWI_UI_WHEEL, .y = 2, .modifiers = CWI_UI_SHIFT});
    feed_text(CWI_UI_DROP, "/a b");
    feed_text(CWI_UI_DROP, "/c");
    feed((cwi_ui_event){.kind = CWI_UI_CLOSE});
    const cwi_ui_input in = frame();
    assert_near(in.wheel, 3, 0);
    assert_int_equal(in.modifiers, CWI_UI_SHIFT);
    assert_int_equal(in.drop_count, 2);
    assert_string_equal(in.drops[0], "/a b");
    assert_string_equal(in.drops[1], "/c");
    assert_true(in.close);
    const cwi_ui_input after = frame();
    assert_int_equal(after.drop_count, 0);
    assert_false(after.close);
}

/* ---- pictures ---- */

static cw_image grab(void)
{
    cw_error err = {0};
    cw_image image = {0};
    assert_ok(u->grab(ui, &image, &err), err);
    return image;
}

static const uint8_t *pixel(const cw_image *image, size_t x, size_t y)
{
    return image->pixels + 4 * (y * image->width + x);
}

static void resizing_changes_the_framebuffer(void **state)
{
    (void)state;
    need_window();
    feed((cwi_ui_event){.kind = CWI_UI_RESIZE, .x = 333, .y = 211});
    const cwi_ui_input in = frame();
    assert_int_equal(in.width, 333);
    assert_int_equal(in.height, 211);
    cw_image image = grab();
    assert_int_equal(image.width, 333);
    assert_int_equal(image.height, 211);
    cw_image_free(&image);
    feed((cwi_ui_event){.kind = CWI_UI_RESIZE, .x = WIDTH, .y = HEIGHT});
    frames();
}

static cw_image make_picture(size_t width, size_t height, uint8_t seed)
{
    cw_error err = {0};
    cw_image image;
    assert_ok(cw_image_alloc(&image, width, height, &err), err);
    for (size_t n = 0; n < width * height * 4; n++)
        image.pixels[n] = n % 4 == 3 ? 255 : (uint8_t)(n * 37 + n / 7 + seed);
    return image;
}

static void show_at(int slot, double x, double y, const cw_image *image)
{
    const cwi_ui_rect r = {x, y, (double)image->width, (double)image->height};
    cw_error err = {0};
    u->begin(ui, 0);
    u->show(ui, slot, &r);
    assert_ok(u->end(ui, &err), err);
}

static void assert_shown(const cw_image *shown, size_t x, size_t y, const cw_image *image)
{
    for (size_t row = 0; row < image->height; row++)
        assert_memory_equal(pixel(shown, x, y + row), pixel(image, 0, row), 4 * image->width);
}

static void pictures_are_shown_pixel_for_pixel(void **state)
{
    (void)state;
    need_window();
    cw_error err = {0};
    for (int slot = 0; slot < CWI_UI_SLOTS; slot += CWI_UI_SLOTS - 1)
        for (uint8_t turn = 0; turn < 3; turn++) { /* the last of another size */
            cw_image image = make_picture(turn < 2 ? 61 : 40, 45, turn);
            assert_ok(u->keep(ui, slot, &image, &err), err);
            show_at(slot, 120, 77, &image);
            cw_image shown = grab();
            assert_shown(&shown, 120, 77, &image);
            assert_memory_not_equal(pixel(&shown, 119, 77), pixel(&image, 0, 0), 3);
            cw_image_free(&shown);
            cw_image_free(&image);
        }
    assert_ok(u->keep(ui, 0, NULL, &err), err);
    assert_int_equal(u->keep(ui, CWI_UI_SLOTS, NULL, &err), CW_ERR_ARGUMENT);
    assert_int_equal(u->keep(ui, -1, NULL, &err), CW_ERR_ARGUMENT);
}

static void assert_color(const cw_image *image, size_t x, size_t y, int r, int g, int b)
{
    const uint8_t *p = pixel(image, x, y);
    if (abs(p[0] - r) > 1 || abs(p[1] - g) > 1 || abs(p[2] - b) > 1)
        fail_msg("at %zu, %zu: %d %d %d, not %d %d %d", x, y, p[0], p[1], p[2], r, g, b);
}

static void drawing_lands_where_it_should(void **state)
{
    static const cwi_ui_color red = {1, 0, 0, 1}, green = {0, 1, 0, 1}, blue = {0, 0, 1, 1};
    static const cwi_ui_rect whole = {0, 0, WIDTH, HEIGHT}, left = {100, 50, 20, 10},
                             ramp = {200, 50, 100, 10}, clip = {0, 200, 55, 100};
    static const double triangle[] = {300, 200, 340, 200, 300, 240};
    (void)state;
    need_window();
    cw_error err = {0};
    u->begin(ui, 0);
    u->box(ui, CWI_UI_BEHIND, &whole, blue, true);
    u->box(ui, CWI_UI_BEHIND, &left, red, true);
    u->blend(ui, CWI_UI_BEHIND, &ramp, red, green);
    u->line(ui, CWI_UI_FRONT, 20, 100.5, 60, 100.5, green, 1);
    u->polygon(ui, CWI_UI_FRONT, triangle, 3, red, true);
    u->disc(ui, CWI_UI_FRONT, 200, 200, 10, green, true);
    u->clip_begin(ui, CWI_UI_FRONT, &clip);
    u->disc(ui, CWI_UI_FRONT, 50, 250, 10, red, true);
    u->clip_end(ui, CWI_UI_FRONT);
    assert_ok(u->end(ui, &err), err);
    cw_image image = grab();
    assert_color(&image, 100, 50, 255, 0, 0);
    assert_color(&image, 119, 59, 255, 0, 0);
    assert_color(&image, 99, 50, 0, 0, 255);
    assert_color(&image, 120, 59, 0, 0, 255);
    assert_color(&image, 100, 60, 0, 0, 255);
    assert_color(&image, 250, 55, 127, 128, 0);
    assert_color(&image, 40, 100, 0, 255, 0);
    assert_color(&image, 40, 98, 0, 0, 255);
    assert_color(&image, 40, 102, 0, 0, 255);
    assert_color(&image, 305, 205, 255, 0, 0);
    assert_color(&image, 335, 235, 0, 0, 255);
    assert_color(&image, 200, 200, 0, 255, 0);
    assert_color(&image, 200, 212, 0, 0, 255);
    assert_color(&image, 53, 250, 255, 0, 0);
    assert_color(&image, 56, 250, 0, 0, 255);
    cw_image_free(&image);
}

static void text_is_as_large_as_it_says(void **state)
{
    static const cwi_ui_color white = {1, 1, 1, 1};
    (void)state;
    need_window();
    cw_error err = {0};
    double size[2];
    size_t inside = 0, outside = 0;
    u->begin(ui, 0);
    u->text_size(ui, "Hamburg", size);
    u->write(ui, CWI_UI_FRONT, 50, 60, white, "Hamburg");
    assert_ok(u->end(ui, &err), err);
    cw_image image = grab();
    for (size_t y = 0; y < HEIGHT; y++)
        for (size_t x = 0; x < WIDTH; x++)
            if (pixel(&image, x, y)[0] > 128) {
                const bool in =
                    x >= 50 && (double)x < 50 + size[0] && y >= 60 && (double)y < 60 + size[1];
                inside += in;
                outside += !in;
            }
    assert_true(inside > 50);
    assert_int_equal(outside, 0);
    cw_image_free(&image);
}

/* ---- beside what draws volumes ---- */

static cw_picture draw_volume(cw_renderer *r, const cw_volume *volume)
{
    const cw_transfer soft = test_soft_transfer();
    const cw_scene scene = {.mode = CW_MODE_COMPOSITE,
                            .volume = volume,
                            .transfer = &soft,
                            .camera = {.eye = {0, -100, 0}, .up = {0, 0, 1}, .height_mm = 20},
                            .width = 64,
                            .height = 64};
    return test_draw(r, &scene);
}

static void renderers_and_windows_do_not_disturb_each_other(void **state)
{
    static const double cube[3] = {1, 1, 1};
    (void)state;
    need_window();
    cw_renderer *r = test_renderer();
    cw_error err = {0};
    cw_volume volume = {0};
    test_field(&volume, 16, 16, 16, cube, test_blobs);
    cw_image image = make_picture(50, 50, 3);
    cw_picture alone = draw_volume(r, &volume);
    assert_ok(u->keep(ui, 2, &image, &err), err);
    for (int n = 0; n < 3; n++) {
        const cwi_ui_rect where = {300, 100, 50, 50};
        u->begin(ui, 0);
        u->show(ui, 2, &where);
        cw_picture within = draw_volume(r, &volume);
        assert_ok(u->end(ui, &err), err);
        assert_near(test_compare(&within, &alone).max, 0, 0);
        cw_picture between = draw_volume(r, &volume);
        assert_near(test_compare(&between, &alone).max, 0, 0);
        cw_image shown = grab();
        assert_shown(&shown, 300, 100, &image);
        cw_image_free(&shown);
        cw_picture_free(&within);
        cw_picture_free(&between);
    }
    cw_picture_free(&alone);
    cw_image_free(&image);
    cw_volume_free(&volume);
}

static void windows_of_impossible_sizes_are_refused(void **state)
{
    const cwi_ui_desc descs[] = {{.title = "", .width = 0, .height = 10, .hidden = true},
                                 {.title = "", .width = 10, .height = 99999, .hidden = true},
                                 {.title = "", .width = 10, .height = 10, .scale = -1}};
    (void)state;
    need_window();
    for (size_t n = 0; n < sizeof descs / sizeof *descs; n++) {
        cw_error err = {0};
        cwi_ui *other = NULL;
        assert_int_equal(u->open(&descs[n], &other, &err), CW_ERR_ARGUMENT);
        assert_null(other);
    }
}

static void a_second_window_leaves_the_first_alone(void **state)
{
    (void)state;
    need_window();
    cw_error err = {0};
    cwi_ui *other = NULL;
    const cwi_ui_desc desc = {
        .title = "", .width = 50, .height = 40, .hidden = true, .scale = 2};
    assert_ok(u->open(&desc, &other, &err), err);
    assert_near(u->scale(other), 2, 0);
    cw_image image = {0};
    assert_int_equal(u->grab(other, &image, &err), CW_ERR_ARGUMENT);
    u->begin(other, 0);
    assert_ok(u->end(other, &err), err);
    u->close(other);
    click("Push");
    frames();
    assert_int_equal(used.buttons, 1);
    assert_non_null(strstr(u->name(ui), "OpenGL"));
}

static void windows_without_memory_are_refused(void **state)
{
    const cwi_ui_desc desc = {.title = "", .width = 50, .height = 40, .hidden = true};
    (void)state;
    need_window();
    cwi_ui *other = NULL;
    cw_status st = CW_ERR_NO_MEMORY;
    for (long n = 0; st != CW_OK; n++) {
        cw_error err = {0};
        cwi_alloc_fail_after(n);
        st = u->open(&desc, &other, &err);
        const bool failed = cwi_alloc_fail_after(-1);
        assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
    }
    u->close(other);
}

static void input_without_memory_is_refused(void **state)
{
    const cwi_ui_event event = {.kind = CWI_UI_WRITE, .text = "a"};
    (void)state;
    need_window();
    cw_error err = {0};
    cwi_alloc_fail_after(0);
    const cw_status st = u->feed(ui, &event, &err);
    cwi_alloc_fail_after(-1);
    assert_int_equal(st, CW_ERR_NO_MEMORY);
    assert_false(u->pending(ui));
}

static int close_all(void **state)
{
    close_window(state);
    return test_renderer_close(state);
}

int main(void)
{
#define CASE(name) cmocka_unit_test_setup(name, fresh)
    const struct CMUnitTest tests[] = {
        CASE(buttons_are_pushed_where_they_are_found),
        CASE(disabled_buttons_are_not_pushed),
        CASE(sliders_follow_the_mouse_and_say_when_it_ends),
        CASE(numbers_change_by_the_pixel),
        CASE(checks_turn_over),
        CASE(choices_open_and_are_chosen),
        CASE(escape_shuts_a_choice_and_is_no_key_then),
        CASE(menus_open_and_their_items_are_used),
        CASE(text_is_typed_edited_and_entered),
        CASE(text_is_copied_and_pasted),
        CASE(what_was_typed_in_another_text_is_not_undone),
        CASE(areas_say_what_the_mouse_does_to_them),
        CASE(second_presses_at_one_place_are_told),
        CASE(modal_panels_block_what_is_behind_them),
        CASE(modal_panels_have_a_closing_button),
        CASE(keys_have_names),
        CASE(keys_of_no_name_are_refused),
        CASE(input_that_cannot_be_is_refused),
        CASE(presses_and_lifts_fall_into_frames_of_their_own),
        CASE(presses_stay_where_they_were),
        CASE(wheels_and_drops_arrive),
        CASE(resizing_changes_the_framebuffer),
        CASE(pictures_are_shown_pixel_for_pixel),
        CASE(drawing_lands_where_it_should),
        CASE(text_is_as_large_as_it_says),
        CASE(renderers_and_windows_do_not_disturb_each_other),
        CASE(windows_of_impossible_sizes_are_refused),
        CASE(a_second_window_leaves_the_first_alone),
        CASE(windows_without_memory_are_refused),
        CASE(input_without_memory_is_refused),
    };
#undef CASE
    return cmocka_run_group_tests(tests, open_window, close_all);
}
