/* Flat sides on which a piece can lie. */
#ifndef SIMPLIFY_PIECES_FLAT_SIDES_H
#define SIMPLIFY_PIECES_FLAT_SIDES_H

#include <cubewright/pieces.h>

enum { CWI_MAX_SIDES = 24 };

typedef struct cwi_flat_side {
    double normal[3]; /* outward, of length 1 */
    double area_mm2;
    bool is_section;
} cwi_flat_side;

/* Lists the flat sides on which a piece can lie: nothing of it is beyond them. Sections come first, then others;
 * the largest of each first.
 * Returns  CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_find_flat_sides(const cw_mesh *mesh,
                                           cwi_flat_side sides[CWI_MAX_SIDES], size_t *count,
                                           cw_error *err);

#endif
