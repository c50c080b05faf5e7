/* Ambiguous cells: the topology of the trilinear interpolant, from its eight corner values.
 *
 * A cell's signs leave two questions. On each ambiguous face, are the inside corners joined?
 * The asymptotic decider [Nielson1991] answers with the sign of a product difference, exact and
 * the same from both cells. And inside, do two patches of a kind meet through a tunnel? Slices
 * z = t are bilinear; where their corners are alternately inside and outside, the same product
 * difference is a quadratic in t, and there is a tunnel just when it changes sign and changes
 * back between two events that already settle it (corners changing sign, or the end faces). */
#ifndef CORE_CASES_CELL_TOPOLOGY_H
#define CORE_CASES_CELL_TOPOLOGY_H

#include "core/cases/case_tables.h"

#include <stddef.h>

enum { CWI_CELL_MAX_TRIANGLES = 18, CWI_CELL_MAX_VERTICES = 4, CWI_CELL_INNER = 12 };

/* Returns true if a face whose corners alternate joins its two inside corners through the
 * middle. Values as below. */
bool cwi_face_joins(const double inside[2], const double outside[2], bool zero_inside);

/* The plan of an ambiguous cell's surface, known from the cell's values alone. */
typedef struct cwi_cell_plan {
    const cwi_config *config;
    int tunnel[2];        /* loops that a tunnel joins; both -1: none */
    int tunnel_corner[2]; /* a corner of the patch that each of them encloses */
    int triangle_count, vertex_count;
} cwi_cell_plan;

/* Plans a cell. values: of the corners, minus the isovalue, positive inside; NaN: no value.
 * cube: their signs. zero_inside: the sign that a zero has. */
void cwi_cell_plan_make(unsigned cube, const double values[8], bool zero_inside,
                        cwi_cell_plan *plan);

/* Convert a plan to 32 bits, and back. */
uint32_t cwi_cell_plan_pack(const cwi_cell_plan *plan);
void cwi_cell_plan_unpack(uint32_t code, cwi_cell_plan *plan);

/* The surface of a cell. Triangles name edges 0 to 11, or 12 + n for the n-th vertex inside. */
typedef struct cwi_cell {
    uint8_t triangles[3 * CWI_CELL_MAX_TRIANGLES];
    double vertices[CWI_CELL_MAX_VERTICES][3]; /* cell coordinates, 0 to 1 */
} cwi_cell;

/* Builds a cell's surface. crossings: the fraction of each crossed edge, from its low corner,
 * where its vertex stands. */
void cwi_cell_build(const cwi_cell_plan *plan, const double crossings[12], cwi_cell *cell);

#endif
