/* Cells as convex solids in eye space: tetrahedra with a linear field, and boxes with a
 * trilinear one. */
#ifndef VIEWER_PROJECTION_PROJECTED_SOLIDS_H
#define VIEWER_PROJECTION_PROJECTED_SOLIDS_H

#include "viewer/rays/cell_map.h"
#include "viewer/rays/cell_tree.h"
#include "viewer/scene/frame_setup.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A convex solid: all plane[0..2] . p + plane[3] >= 0. The planes of a tetrahedron are the
 * weights of its corners; the first three of a box run from 0 to 1 across it. */
typedef struct cwi_solid {
    bool is_box;
    int plane_count, corner_count;
    double planes[6][4];
    double values[8], gradients[8][3]; /* at the corners; gradients in eye space */
    double low[2], high[2]; /* samples of the picture that it may cover, from and to */
} cwi_solid;

/* The cells of a frame's grid, by number. */
typedef struct cwi_solids {
    const cwi_frame *frame;
    const cwi_cell_tree *tree; /* of an irregular grid */
    size_t count;              /* of cells */
    bool has_gradients;
    double gradient_to_eye[3][3];
} cwi_solids;

/* tree: as for cwi_projection_draw() */
void cwi_solids_init(cwi_solids *solids, const cwi_frame *frame, const cwi_cell_tree *tree);

enum { CWI_SOLIDS_OF_CELL = 6 };

/* Finds the values of a cell, the samples that it covers, and the depth of its middle. Returns
 * false for an empty cell. */
bool cwi_solids_measure(const cwi_solids *solids, size_t cell, double range[2], double low[2],
                        double high[2], double *depth);

/* Makes the solids of a cell: one box, or tetrahedra. Faces of four corners are halved from
 * their sample of the least number, so that neighbours fit. Returns their number. */
int cwi_solids_of(const cwi_solids *solids, size_t cell, cwi_solid out[CWI_SOLIDS_OF_CELL]);

/* Computes the value, and the gradient if the grid has them, at a point of a solid. */
double cwi_solid_sample(const cwi_solid *solid, const double point[3], double gradient[3]);

#ifdef __cplusplus
}
#endif

#endif
