/* A font of strokes: letters, digits and signs as lines on a grid. Images draw them, and solids are engraved with
 * them. */
#ifndef CORE_FONT_STROKE_FONT_H
#define CORE_FONT_STROKE_FONT_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A line between two points. */
typedef struct cwi_stroke {
    double from[2], to[2];
} cwi_stroke;

/* Height of capitals, in the units of the grid; width of a space, and of the gap after a character. */
enum { CWI_GLYPH_HEIGHT = 6, CWI_GLYPH_SPACE = 3, CWI_GLYPH_GAP = 2 };

/* Finds the strokes of a character, in sixths of the height of capitals, y down from their top. Strokes
 * that follow one another share a point. Returns their number (at most as many as fit), and the character's
 * width. 0 for a character that the font does not have. */
enum { CWI_GLYPH_STROKES = 24 };
size_t cwi_glyph(uint32_t character, cwi_stroke strokes[CWI_GLYPH_STROKES], double *width);

/* Does the same for the box that stands for such a character. */
size_t cwi_missing_glyph(cwi_stroke strokes[CWI_GLYPH_STROKES], double *width);

/* Decodes the next character of UTF-8, and moves *text behind it. Bytes that are not UTF-8 become U+FFFD, one
 * by one. */
uint32_t cwi_next_character(const char **text);

#ifdef __cplusplus
}
#endif

#endif
