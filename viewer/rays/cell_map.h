/* The isoparametric map of a cell: from reference coordinates u to points, x(u) = sum of
 * w_c(u) p_c over the corners c, and the field f(u) = sum of w_c(u) f_c.
 *
 * Weights are linear in a tetrahedron, trilinear in a hexahedron, and in a wedge linear over the
 * triangle times linear between both. A pyramid is bilinear over its base and shrinks linearly
 * to its tip; u are the sides of the shrunken base, so that the map is regular up to the tip.
 * Faces of four corners are bilinear patches, and neighbours agree on them. */
#ifndef VIEWER_RAYS_CELL_MAP_H
#define VIEWER_RAYS_CELL_MAP_H

#include "core/volume/cell_shapes.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A cell with its points, relative to some origin. */
typedef struct cwi_mapped_cell {
    uint8_t shape;
    int count;           /* of corners */
    uint32_t corners[8]; /* samples */
    double points[8][3];
} cwi_mapped_cell;

/* Loads a cell, from its first corner in a list. */
void cwi_cell_load(const cw_cells *cells, uint8_t shape, const uint32_t *corners,
                   const double origin[3], cwi_mapped_cell *cell);

/* The kinds of maps. */
typedef enum cwi_map_kind {
    CWI_MAP_EMPTY,  /* no volume, or a point that is not finite */
    CWI_MAP_LINEAR, /* x is linear in u, to 1e-9 of the cell's size */
    CWI_MAP_NEARLY, /* to 1e-4 of it */
    CWI_MAP_CURVED, /* x is one to one */
    CWI_MAP_FOLDED  /* corners disagree on the side that is inside: u is not unique */
} cwi_map_kind;

cwi_map_kind cwi_cell_map_of(const cwi_mapped_cell *cell);

/* A folded cell is drawn as tetrahedra between its corners. */
int cwi_cell_part_count(uint8_t shape);
void cwi_cell_part(const cwi_mapped_cell *cell, int number, cwi_mapped_cell *part);

/* Computes the weights of the corners at u. */
void cwi_cell_weights(uint8_t shape, const double u[3], double weights[8]);

/* Finds u of a point by Newton's method, from a first guess in u, until a step is shorter than
 * last_step; the error is then about its square. Returns false where it does not converge. */
bool cwi_cell_invert(const cwi_mapped_cell *cell, const double point[3], double last_step,
                     double u[3]);

/* Returns true if u lies in the cell. */
bool cwi_cell_contains(uint8_t shape, const double u[3]);

/* Clips an interval of the line start + t direction, in u, to the cell. */
void cwi_cell_clip(uint8_t shape, const double start[3], const double direction[3],
                   double t[2]);

/* Finds the line in u that a line of points is, in a cell that is linear or nearly so. Returns
 * false where the cell is too flat to tell. */
bool cwi_cell_line(const cwi_mapped_cell *cell, const double origin[3],
                   const double direction[3], double start[3], double slope[3]);

enum { CWI_CELL_CROSSINGS = 32 };

/* Finds all places where a ray may cross the faces of a curved cell; returns their number. Some
 * of them may lie a little beside a face. */
int cwi_cell_crossings(const cwi_mapped_cell *cell, const double origin[3],
                       const double direction[3], double t[CWI_CELL_CROSSINGS]);

#ifdef __cplusplus
}
#endif

#endif
