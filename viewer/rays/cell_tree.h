/* The cells of an irregular grid in a bounding volume hierarchy, with the gradients of its
 * samples. It depends on the grid alone, not on the view. */
#ifndef VIEWER_RAYS_CELL_TREE_H
#define VIEWER_RAYS_CELL_TREE_H

#include "core/geometry/bvh_segment.h"
#include "viewer/rays/ray_traversal.h"
#include "viewer/scene/frame_setup.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Zeroed: empty. Boxes are in the frame of the points, from the centre, with the longest side
 * of the grid as unit. */
typedef struct cwi_cell_tree {
    cwi_boxes boxes; /* of the cells that are not empty; order[] has their numbers */
    double centre[3], scale;
    uint8_t *kinds;        /* cwi_map_kind of each cell */
    size_t *starts;        /* where each cell's corners begin in cw_cells.corners */
    float (*gradients)[3]; /* of the samples' values, in the world; NULL: not computed yet */
} cwi_cell_tree;

/* Builds the tree of a frame's irregular grid.
 * only     cells that this ray cannot meet are left out; NULL: none are
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED
 * Cost     37 bytes a cell, and 60 more meanwhile */
CW_NODISCARD cw_status cwi_cell_tree_make(const cwi_frame *frame, const cwi_ray *only,
                                          cwi_cell_tree *tree, cw_error *err);

/* Computes the gradients of the frame's gradient volume, if they are not there. CW_ERR_NO_MEMORY. Cost: 12 bytes a sample,
 * and 96 more meanwhile. */
CW_NODISCARD cw_status cwi_cell_tree_need_gradients(const cwi_frame *frame, cwi_cell_tree *tree,
                                                    cw_error *err);

/* Frees the gradients alone. */
void cwi_cell_tree_drop_gradients(cwi_cell_tree *tree);

/* Prepares the part of a ray that is drawn, from its first to its last place, for the tree's
 * boxes. */
cwi_boxes_segment cwi_cell_tree_segment(const cwi_cell_tree *tree, const cwi_ray *ray);

void cwi_cell_tree_free(cwi_cell_tree *tree);

#ifdef __cplusplus
}
#endif

#endif
