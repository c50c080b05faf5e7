/* The bricks of a volume that changes: which of them have to be given again, and their meshes. */
#ifndef EXTRACT_BRICKS_BRICK_SET_H
#define EXTRACT_BRICKS_BRICK_SET_H

#include "extract/dense/dense_plan.h"

enum { CWI_BRICKS_AT_ONCE = 64 };

/* State of a brick: its surface may differ from what was given; it was given with a surface; and
 * from bit CWI_BRICK_SIDES on, unless it has changed, the sides where its samples are. */
enum { CWI_BRICK_CHANGED = 1, CWI_BRICK_FILLED = 2, CWI_BRICK_SIDES = 2 };

/* A zeroed set is empty. Free it with cwi_bricks_free(). */
typedef struct cwi_brick_set {
    size_t dim[3];        /* bricks along each axis */
    uint8_t *state;       /* of each brick; NULL: none was asked for */
    cw_extract_desc desc; /* settings of the surface that was given */
    bool had_gaps;        /* some voxel had no value then, which matters far away, too */
    bool was_crossed;     /* samples were on both sides; else there is no surface, nor caps */
    cw_mesh mesh[CWI_BRICKS_AT_ONCE]; /* arrays that are used again */
} cwi_brick_set;

void cwi_bricks_free(cwi_brick_set *set);

/* Notes that the voxels in a box have changed; NULL: all. */
void cwi_bricks_touch(cwi_brick_set *set, const cw_box *box);

/* Prepares the set for settings: if they are others than before, all bricks have changed.
 * plan  the whole volume, whose level and live cells are known */
CW_NODISCARD cw_status cwi_bricks_begin(cwi_brick_set *set, const cwi_plan *plan,
                                        const cw_extract_desc *desc, cw_error *err);

/* Extracts the bricks that have changed, and gives away those that have a surface or had one. */
CW_NODISCARD cw_status cwi_bricks_extract(cwi_brick_set *set, const cwi_plan *plan,
                                          cw_brick_sink sink, cw_error *err);

#endif
