/* The border's faces as the parts that caps are made of. */
#ifndef EXTRACT_IRREGULAR_BOUNDARY_FACES_H
#define EXTRACT_IRREGULAR_BOUNDARY_FACES_H

#include "extract/irregular/cell_surface.h"

#define CWI_NO_VERTEX UINT32_MAX
#define CWI_WANTED    (UINT32_MAX - 1) /* not numbered yet */

/* A corner of a cap: a sample that is inside, or the crossing of the edge from a position in
 * the face to the next. */
typedef struct cwi_cap_corner {
    bool crossing;
    uint8_t at;
} cwi_cap_corner;

enum { CWI_CAP_CORNERS = 6, CWI_CAP_VERTICES = 12 };

/* The part of a face that is inside: one polygon, or two triangles. */
typedef struct cwi_cap {
    int count, size[2];
    cwi_cap_corner corner[2][CWI_CAP_CORNERS];
} cwi_cap;

void cwi_find_cap(const cwi_cells *g, uint32_t face, cwi_cap *c);

/* Return the vertex at a corner; the vertex in the middle of the segment from corner n to the
 * next, if there is one; and all vertices around a polygon, with those in the middle of
 * sides. */
uint32_t cwi_cap_vertex(const cwi_cells *g, const cwi_border_face *face, cwi_cap_corner corner);
uint32_t cwi_cap_segment_middle(const cwi_border_face *face, const cwi_cap *c, int polygon,
                                int n);
int cwi_cap_vertices(const cwi_cells *g, const cwi_border_face *face, const cwi_cap *c,
                     int polygon, uint32_t vertices[CWI_CAP_VERTICES]);

/* Returns the corner that a polygon's triangles share, if the polygon has no vertex inside. */
int cwi_cap_fan(const cwi_cells *g, uint32_t face, const cwi_cap *c, int polygon);

/* Return the vertex on the edge from a position in a face to the next, and the sample at the
 * position. */
uint32_t cwi_crossing_at(const cwi_cells *g, uint32_t face, int position);
uint32_t cwi_sample_at(const cwi_cells *g, uint32_t face, int position);

static inline const cwi_element *cwi_element_of(const cwi_cells *g, uint32_t face)
{
    return &g->elements[face / CWI_CELL_FACES];
}

#endif
