/* Writes text on images by the font of strokes. */
#include "core/font/stroke_font.h"
#include "viewer/image/strokes.h"

#include <math.h>
#include <string.h>

/* Places a character's strokes and returns how far the next one is. */
static double set_glyph(uint32_t character, double x, double y, double unit,
                        cwi_stroke *strokes, size_t *count)
{
    double width;
    *count = 0;
    if (character == ' ')
        return (CWI_GLYPH_SPACE + CWI_GLYPH_GAP) * unit;
    *count = cwi_glyph(character, strokes, &width);
    if (*count == 0)
        *count = cwi_missing_glyph(strokes, &width);
    for (size_t n = 0; n < *count; n++) {
        double *ends[2] = {strokes[n].from, strokes[n].to};
        for (int e = 0; e < 2; e++) {
            ends[e][0] = x + ends[e][0] * unit;
            ends[e][1] = y + (ends[e][1] - 6) * unit;
        }
    }
    return (width + CWI_GLYPH_GAP) * unit;
}

void cwi_pen_text(const cwi_pen *pen, double x, double y, double height, const char *text)
{
    cwi_stroke strokes[CWI_GLYPH_STROKES];
    while (*text) {
        size_t count;
        x += set_glyph(cwi_next_character(&text), x, y, height / 6, strokes, &count);
        if (count > 0)
            cwi_pen_draw(pen, strokes, count);
    }
}

double cwi_text_width(double height, const char *text)
{
    cwi_stroke strokes[CWI_GLYPH_STROKES];
    double width = 0;
    size_t count;
    while (*text)
        width += set_glyph(cwi_next_character(&text), 0, 0, height / 6, strokes, &count);
    return width > 0 ? width - CWI_GLYPH_GAP * height / 6 : 0;
}

void cwi_text_write(cw_image *image, const double at[2], double height, double anchor,
                    const double color[4], const double halo[4], const char *text)
{
    const double left = at[0] - anchor * cwi_text_width(height, text);
    const double width = fmax(height / 7, 1.1);
    cwi_pen pen = {.image = image, .width = 2.6 * width};
    memcpy(pen.color, halo, sizeof pen.color);
    cwi_pen_text(&pen, left, at[1], height, text);
    pen.width = width;
    memcpy(pen.color, color, sizeof pen.color);
    cwi_pen_text(&pen, left, at[1], height, text);
}
