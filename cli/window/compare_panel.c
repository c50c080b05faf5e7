/* The comparison of two modes: the panel's section that chooses its sides, and the badges on
 * the halves of the picture. */
#define _GNU_SOURCE /* asprintf */
#include "cli/window/panels.h"

#include "core/base/status.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE_TEXT = 512 };

/* One side of --compare, in two parts: "texture" and "step-length=2,no-lit". */
typedef struct side_text {
    char mode[64], options[SIDE_TEXT];
} side_text;

static bool is_mode(const view *v, const char *word)
{
    const char *names[VIEW_MODE_NAMES];
    const size_t count = view_list_modes(v, false, names);
    for (size_t n = 0; n < count; n++)
        if (strcmp(names[n], word) == 0)
            return true;
    return false;
}

static side_text split_side(const view *v, const char *text, size_t length)
{
    side_text side = {.mode = "composite"};
    char word[sizeof side.mode];
    const size_t first = strcspn(text, ",|") < length ? strcspn(text, ",|") : length;
    snprintf(word, sizeof word, "%.*s", (int)(first < sizeof word ? first : sizeof word - 1),
             text);
    const bool has_mode = is_mode(v, word);
    if (has_mode)
        snprintf(side.mode, sizeof side.mode, "%s", word);
    const size_t from = has_mode ? first + (first < length) : 0;
    snprintf(side.options, sizeof side.options, "%.*s", (int)(length - from), text + from);
    return side;
}

/* Both sides of the comparison at hand. */
static void split_text(const view *v, side_text sides[2])
{
    const char *text = v->state.args.compare, *bar = strchr(text, '|');
    const size_t length = bar ? (size_t)(bar - text) : strlen(text);
    sides[0] = split_side(v, text, length);
    sides[1] =
        split_side(v, bar ? bar + 1 : "reference", bar ? strlen(bar + 1) : strlen("reference"));
}

static void ask_sides(view *v, const side_text sides[2])
{
    char text[2 * (SIDE_TEXT + 80)];
    snprintf(text, sizeof text, "%s%s%s|%s%s%s", sides[0].mode, *sides[0].options ? "," : "",
             sides[0].options, sides[1].mode, *sides[1].options ? "," : "", sides[1].options);
    if (!strchr(text, '\''))
        view_ask(v, "compare '%s'", text);
}

/* Shows the widgets of one side. Returns true if another mode or options were chosen. */
static bool show_side_choice(view *v, const char *name, side_text *side)
{
    const char *names[VIEW_MODE_NAMES];
    char label[64];
    const size_t count = view_list_modes(v, false, names);
    size_t chosen = 0;
    for (size_t n = 0; n < count; n++)
        chosen = strcmp(names[n], side->mode) == 0 ? n : chosen;
    const bool is_other = v->ui->choice(v->window, name, names, count, &chosen);
    if (is_other)
        snprintf(side->mode, sizeof side->mode, "%s", names[chosen]);
    snprintf(label, sizeof label, "Options##%s", name);
    const bool has_options =
        v->ui->input(v->window, label, side->options, sizeof side->options);
    v->ui->tip(v->window, "Settings of this side, such as step-length=2,no-lit; press Enter");
    return is_other || has_options;
}

static void describe_numbers(const view *v, char *text, size_t size)
{
    const cw_comparison *m = &v->picture.measured;
    snprintf(
        text, size, "%s%srmse %.3g, max %.3g of 255\ndelta-E %.3g, 99 %% below %.3g\nSSIM %.5f",
        v->picture.is_preliminary ? "PRELIMINARY: the pictures are not finished\n" : "Final\n",
        v->picture.is_alike ? "" : "Different modes: this is not an error\n", m->rmse, m->max,
        m->delta_e_mean, m->delta_e_p99, m->ssim);
}

static void copy_numbers(view *v)
{
    char *text;
    char numbers[512];
    describe_numbers(v, numbers, sizeof numbers);
    if (asprintf(&text, "%s\n%s\n%s\n", cli_shown_path(v->document.path), v->state.args.compare,
                 numbers) < 0)
        return;
    v->ui->set_clipboard(v->window, text);
    free(text);
    view_say(v, false, "The numbers are in the clipboard");
}

static void show_difference(view *v)
{
    const cli_number *now = &v->state.args.difference;
    bool on = now->given;
    double factor = on ? now->value : 20;
    if (v->ui->check(v->window, "Show the difference", &on))
        view_ask(v, on ? "difference 20" : "difference off");
    if (!now->given)
        return;
    if (v->ui->log_slider(v->window, "Amplified", &factor, 1, 500, "%.3g times"))
        view_ask(v, "difference %.4g", factor);
}

/* A mode's own exact picture is that of the same projection. */
static void show_start(view *v)
{
    if (v->ui->button(v->window, "Compare with the exact picture"))
        view_ask(v, "compare '%s|reference'",
                 v->picture.mode == CW_MODE_REFERENCE || v->picture.mode == CW_MODE_SLICES
                     ? "composite"
                     : cw_mode_name(v->picture.mode));
    v->ui->tip(v->window, "Draw this mode on the left and its reference on the right");
}

void view_show_compare(view *v)
{
    side_text sides[2];
    char text[512];
    if (!view_draws_volume(v) ||
        !v->ui->section(v->window, "Compare", v->state.args.compare != NULL))
        return;
    if (!v->state.args.compare) {
        show_start(v);
        return;
    }
    split_text(v, sides);
    const bool left = show_side_choice(v, "Left", &sides[0]);
    if (show_side_choice(v, "Right", &sides[1]) || left)
        ask_sides(v, sides);
    show_difference(v);
    describe_numbers(v, text, sizeof text);
    v->ui->text(v->window,
                v->picture.is_measured ? text : "The difference is measured soon ...");
    if (v->picture.is_measured) {
        if (v->ui->button(v->window, "Copy the numbers"))
            copy_numbers(v);
        v->ui->same_line(v->window);
    }
    if (v->ui->button(v->window, "End"))
        view_ask(v, "compare off; difference off");
}

/* --- badges ------------------------------------------------------------------------------- */

/* Writes on a dark plate, which is readable over any picture. */
static void show_badge(view *v, double x, double y, bool is_right, const char *text)
{
    static const cwi_ui_color plate = {0.05f, 0.06f, 0.08f, 0.8f}, white = {1, 1, 1, 1};
    const double pad = 5 * v->ui->scale(v->window);
    double size[2];
    v->ui->text_size(v->window, text, size);
    const double left = is_right ? x - size[0] - 2 * pad : x;
    const cwi_ui_rect rect = {left, y, size[0] + 2 * pad, size[1] + 2 * pad};
    v->ui->box(v->window, CWI_UI_BEHIND, &rect, plate, true);
    v->ui->write(v->window, CWI_UI_BEHIND, left + pad, y + pad, white, text);
}

static void show_side_badge(view *v, const side_text *side, double x, double y, bool is_right)
{
    char text[SIDE_TEXT + 80];
    snprintf(text, sizeof text, "%s%s%s", side->mode, *side->options ? "  " : "",
             side->options);
    show_badge(v, x, y, is_right, text);
}

void view_show_badges(view *v)
{
    const cwi_ui_rect *r = &v->picture.parts[VIEW_SPACE].rect;
    const double gap = 8 * v->ui->scale(v->window);
    const double right = r->x + r->width - gap, top = r->y + gap;
    side_text sides[2];
    char text[96];
    split_text(v, sides);
    show_side_badge(v, &sides[0], r->x + gap, top, false);
    show_side_badge(v, &sides[1], right, top, true);
    if (!v->picture.is_measured)
        return;
    snprintf(text, sizeof text, "rmse %.3g of 255%s%s", v->picture.measured.rmse,
             v->picture.is_preliminary ? ", preliminary" : "",
             v->picture.is_alike ? "" : ", of different things");
    show_badge(v, r->x + gap, r->y + r->height - 40 * v->ui->scale(v->window), false, text);
    if (!v->state.args.difference.given)
        return;
    snprintf(text, sizeof text, "difference, %.3g times", v->state.args.difference.value);
    show_badge(v, right, r->y + r->height - 40 * v->ui->scale(v->window), true, text);
}
