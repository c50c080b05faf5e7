/* Draws a legend: a column of colour patches with names, cut where they are too wide. */
#include "viewer/image/legend.h"

#include "viewer/image/strokes.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NAME = 256 };

/* Heights of capitals from a line to the next, and from a patch's left end to its name. */
static const double LINE = 1.75, INDENT = 1.9;

/* Copies a name, cut at the end of a character where it is wider than a limit. */
static void fit_name(const char *name, double text, double max_width, char fitted[NAME])
{
    size_t length = strlen(name);
    length = length < NAME - 4 ? length : NAME - 4;
    snprintf(fitted, NAME, "%.*s", (int)length, name);
    if (!name[length] && cwi_text_width(text, fitted) <= max_width)
        return;
    do {
        while (length > 0 && ((unsigned char)name[length] & 0xc0) == 0x80)
            length--;
        snprintf(fitted, NAME, "%.*s...", (int)length, name);
    } while (cwi_text_width(text, fitted) > max_width && length-- > 0);
}

/* The column: its items, and the line that counts the others. */
typedef struct column {
    size_t shown, lines;
    char more[32]; /* "": none are left out */
    double left;
} column;

static column plan_column(const cwi_legend *l)
{
    const double lines = floor((l->bottom - l->top) / (LINE * l->text));
    const size_t capacity = lines > 0 ? (size_t)lines : 0;
    double widest = 0;
    char name[NAME];
    column c = {.shown = l->count <= capacity ? l->count
                         : capacity           ? capacity - 1
                                              : 0,
                .left = l->right};
    c.lines = l->count <= capacity ? l->count : capacity;
    if (c.shown < l->count)
        snprintf(c.more, sizeof c.more, "and %zu more", l->count - c.shown);
    if (c.shown < c.lines)
        widest = cwi_text_width(l->text, c.more);
    for (size_t n = 0; n < c.shown; n++) {
        fit_name(l->items[n].name, l->text, l->max_width - INDENT * l->text, name);
        widest = fmax(widest, cwi_text_width(l->text, name));
    }
    if (c.lines > 0)
        c.left = l->right - widest - INDENT * l->text;
    return c;
}

/* Draws a patch in a thin frame of the halo's colour. */
static void draw_patch(const cwi_legend *l, const uint8_t color[3], double x, double y,
                       cw_image *image)
{
    const double outline = fmax(l->text / 8, 1);
    cwi_pen pen = {.image = image};
    memcpy(pen.color, l->halo, sizeof pen.color);
    cwi_pen_fill(&pen, x - outline, y - l->text - outline, x + 1.2 * l->text + outline,
                 y + outline);
    for (int c = 0; c < 3; c++)
        pen.color[c] = color[c] / 255.0;
    pen.color[3] = 1;
    cwi_pen_fill(&pen, x, y - l->text, x + 1.2 * l->text, y);
}

double cwi_legend_draw(const cwi_legend *l, cw_image *image)
{
    const column c = plan_column(l);
    const double left = c.left + INDENT * l->text;
    for (size_t n = 0; n < c.lines; n++) {
        const double at[2] = {left, l->top + l->text + (double)n * LINE * l->text};
        char name[NAME];
        snprintf(name, sizeof name, "%s", c.more);
        if (n < c.shown) {
            fit_name(l->items[n].name, l->text, l->max_width - INDENT * l->text, name);
            draw_patch(l, l->items[n].color, c.left, at[1], image);
        }
        cwi_text_write(image, at, l->text, 0, l->ink, l->halo, name);
    }
    return c.left;
}
