/* Finds the place and the size of a text. */
#ifndef SIMPLIFY_ENGRAVE_FIND_PLACE_H
#define SIMPLIFY_ENGRAVE_FIND_PLACE_H

#include "simplify/engrave/engrave_state.h"

/* A text at a size, in mm. */
typedef struct cwi_text_size {
    double size, depth, stroke, wall;
    double unit;          /* of the font */
    double width, height; /* of the whole text */
} cwi_text_size;

/* A text at its place. */
typedef struct cwi_placed_text {
    cwi_text_size size;
    cwi_text_place place;
    cwi_place_look look;
    cwi_stroke_region region;
    cw_mesh tool; /* the solid of the letters */
} cwi_placed_text;

/* Finds the largest size with a place, or a place for the size that is given, and makes the letters there.
 * Returns  CW_ERR_ARGUMENT; CW_ERR_CHECK when there is none; CW_ERR_LIMIT; CW_ERR_NO_MEMORY; CW_ERR_CANCELLED. Free it
 *          with cwi_free_placed() */
CW_NODISCARD cw_status cwi_place_text(const cwi_ray_target *target, const cwi_text_lines *lines,
                                      const cw_engrave_desc *desc, cwi_placed_text *placed,
                                      cw_error *err);
void cwi_free_placed(cwi_placed_text *placed);

#endif
