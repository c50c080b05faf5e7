/* Lays out text by the font of strokes, with round bends. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/geometry/vec3.h"
#include "simplify/engrave/engrave_state.h"

#include <stdio.h>
#include <string.h>

/* Bends up to this angle become round, in this number of steps. */
static const double ROUND_DEG = 60;
enum { ROUND_STEPS = 6 };

/* Width of the gap after a character, and of a space, in units of the font: the strokes are as wide as a unit. */
static const double GAP = 2.4, SPACE = 1;

static bool add_line(cwi_text_lines *l, size_t *capacity, const double from[2],
                     const double to[2])
{
    cwi_stroke *grown = cwi_grow_array(l->strokes, l->count, capacity, sizeof *l->strokes);
    if (!grown)
        return false;
    l->strokes = grown;
    memcpy(grown[l->count].from, from, sizeof grown->from);
    memcpy(grown[l->count++].to, to, sizeof grown->to);
    return true;
}

/* Returns true if the corner at p[1] is a bend that becomes round. */
static bool is_round(double (*p)[2])
{
    const double a[3] = {p[1][0] - p[0][0], p[1][1] - p[0][1], 0};
    const double b[3] = {p[2][0] - p[1][0], p[2][1] - p[1][1], 0};
    const double lengths = cwi_length(a) * cwi_length(b);
    const double cosine = lengths > 0 ? cwi_dot(a, b) / lengths : 1;
    return cosine >= cos(ROUND_DEG * CWI_PI / 180) - 1e-9 && cosine < 1 - 1e-9;
}

/* Adds a parabola from the middle of a corner's first side to that of its second one. */
static bool add_bend(cwi_text_lines *l, size_t *capacity, double (*p)[2])
{
    double last[2] = {(p[0][0] + p[1][0]) / 2, (p[0][1] + p[1][1]) / 2};
    for (int n = 1; n <= ROUND_STEPS; n++) {
        const double t = (double)n / ROUND_STEPS, s = 1 - t;
        double next[2];
        for (int a = 0; a < 2; a++)
            next[a] = s * s * (p[0][a] + p[1][a]) / 2 + 2 * s * t * p[1][a] +
                      t * t * (p[1][a] + p[2][a]) / 2;
        if (!add_line(l, capacity, last, next))
            return false;
        memcpy(last, next, sizeof last);
    }
    return true;
}

/* Adds a path of count points. Each side goes from its middle, or from its end where that is not round. */
static bool add_path(cwi_text_lines *l, size_t *capacity, double (*p)[2], size_t count)
{
    const bool is_closed = count > 3 && memcmp(p[0], p[count - 1], sizeof *p) == 0;
    double wrap[3][2];
    memcpy(wrap[0], p[count > 1 ? count - 2 : 0], sizeof *wrap);
    memcpy(wrap[1], p[0], sizeof *wrap);
    memcpy(wrap[2], p[count > 1 ? 1 : 0], sizeof *wrap);
    const bool wraps = is_closed && is_round(wrap);
    if (wraps && !add_bend(l, capacity, wrap))
        return false;
    for (size_t n = 0; n + 1 < count; n++) {
        const double middle[2] = {(p[n][0] + p[n + 1][0]) / 2, (p[n][1] + p[n + 1][1]) / 2};
        const bool starts_round = n > 0 ? is_round(p + n - 1) : wraps;
        const bool ends_round = n + 2 < count ? is_round(p + n) : wraps;
        if (!starts_round && !add_line(l, capacity, p[n], middle))
            return false;
        if (!ends_round && !add_line(l, capacity, middle, p[n + 1]))
            return false;
        if (ends_round && n + 2 < count && !add_bend(l, capacity, p + n))
            return false;
    }
    return true;
}

/* Adds the strokes of a character at x: those that share points as one path. */
static bool add_character(cwi_text_lines *l, size_t *capacity, const cwi_stroke *strokes,
                          size_t count, double x)
{
    double path[CWI_GLYPH_STROKES + 1][2];
    for (size_t n = 0, points = 0; n < count; n++) {
        if (points == 0) {
            path[0][0] = x + strokes[n].from[0];
            path[0][1] = CWI_GLYPH_HEIGHT - strokes[n].from[1];
            points = 1;
        }
        path[points][0] = x + strokes[n].to[0];
        path[points++][1] = CWI_GLYPH_HEIGHT - strokes[n].to[1];
        if (n + 1 < count && memcmp(strokes[n].to, strokes[n + 1].from, sizeof(double[2])) == 0)
            continue;
        if (!add_path(l, capacity, path, points))
            return false;
        points = 0;
    }
    return true;
}

/* Moves the middle of the box to 0. Returns false for a text of spaces. */
static bool center_lines(cwi_text_lines *l)
{
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (size_t n = 0; n < l->count; n++)
        for (int a = 0; a < 2; a++) {
            low[a] = fmin(low[a], fmin(l->strokes[n].from[a], l->strokes[n].to[a]));
            high[a] = fmax(high[a], fmax(l->strokes[n].from[a], l->strokes[n].to[a]));
        }
    for (size_t n = 0; n < l->count; n++)
        for (int a = 0; a < 2; a++) {
            l->strokes[n].from[a] -= (low[a] + high[a]) / 2;
            l->strokes[n].to[a] -= (low[a] + high[a]) / 2;
        }
    l->width = high[0] - low[0];
    l->height = high[1] - low[1];
    return l->count > 0;
}

/* Fails for the characters that the font does not have, and names them. */
static cw_status refuse_characters(const char *text, cw_error *err)
{
    cwi_stroke strokes[CWI_GLYPH_STROKES];
    char names[160] = "";
    size_t used = 0;
    for (const char *t = text; *t && used < sizeof names - 32;) {
        const char *start = t;
        double width;
        const uint32_t c = cwi_next_character(&t);
        if (c == ' ' || cwi_glyph(c, strokes, &width))
            continue;
        const bool is_shown = c >= ' ' && c != 0x7f && cwi_utf8_length(start) > 0;
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%.*s%sU+%04X",
                                 used ? ", " : "", is_shown ? (int)(t - start) : 0, start,
                                 is_shown ? " " : "", (unsigned)c);
    }
    return cwi_fail(
        err, CW_ERR_ARGUMENT,
        "the font has no %s; it has letters, digits and signs of ASCII, and some others such "
        "as the degree",
        names);
}

cw_status cwi_lay_out_text(const char *text, cwi_text_lines *l, cw_error *err)
{
    cwi_stroke strokes[CWI_GLYPH_STROKES];
    size_t capacity = 0, length = 0;
    double x = 0;
    *l = (cwi_text_lines){0};
    for (const char *t = text; *t; length++) {
        const uint32_t c = cwi_next_character(&t);
        double width = SPACE;
        const size_t count = c == ' ' ? 0 : cwi_glyph(c, strokes, &width);
        if (c != ' ' && count == 0)
            return refuse_characters(text, err);
        if (length == CW_ENGRAVE_CHARACTERS)
            return cwi_fail(err, CW_ERR_ARGUMENT, "the text has more than %d characters",
                            CW_ENGRAVE_CHARACTERS);
        if (!add_character(l, &capacity, strokes, count, x))
            return cwi_fail_memory(err);
        l->characters += count > 0;
        x += width + GAP;
    }
    return center_lines(l)
               ? CW_OK
               : cwi_fail(err, CW_ERR_ARGUMENT,
                          "the text is empty: a letter, a digit or a sign is needed");
}

void cwi_free_text_lines(cwi_text_lines *l)
{
    cwi_free(l->strokes);
    *l = (cwi_text_lines){0};
}
