/* The parts of a ray in the cells of rectilinear and irregular grids, in order, and the field
 * along each: a cubic.
 *
 * It is exact in a rectilinear grid's boxes, in tetrahedra, and in wedges and hexahedra whose
 * map is linear. In other cells spans are halved until the cubic through four values keeps to a
 * tolerance where it is checked. Rays are shifted by 1e-11 of the grid's size, so that none
 * runs in the faces between two cells. */
#ifndef VIEWER_RAYS_RAY_SPANS_H
#define VIEWER_RAYS_RAY_SPANS_H

#include "viewer/rays/cell_map.h"
#include "viewer/rays/cell_tree.h"
#include "viewer/rays/ray_traversal.h"
#include "viewer/scene/transfer_segments.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The field that rays of a frame go through. */
typedef struct cwi_field {
    const cwi_frame *frame;
    const cwi_cell_tree *tree; /* of an irregular grid */
    const cwi_knots *knots;    /* cells without a visible value are left out; NULL: none are */
    bool has_gradients;        /* spans have gradients */
    double tolerance;          /* of values in curved cells, in parts of the cell's range */
    double gradient_to_eye[9]; /* rows */
} cwi_field;

/* Makes the field of a frame, with its members as above. is_exact: for the reference, to 1e-8, else to 1e-4 */
void cwi_field_make(const cwi_frame *frame, const cwi_cell_tree *tree, const cwi_knots *knots,
                    bool is_exact, cwi_field *field);

/* A part of a ray, in units of eye space along it; x goes from 0 to 1. */
typedef struct cwi_span {
    double from, to;
    double value[4], gradient[3][4]; /* cubics; gradients in eye space, if the field has them */
    bool follows;                    /* it begins where the span before ends */
} cwi_span;

/* A cell on a ray, from its entry to its exit. */
typedef struct cwi_cell_hit {
    double from, to; /* from the ray's start at the grid */
    uint32_t cell;
    int part; /* of a folded cell, a tetrahedron; else -1 */
} cwi_cell_hit;

/* A walk along rays. Zeroed: none is under way; free it with cwi_spans_free(). */
typedef struct cwi_spans {
    const cwi_field *field;
    const cwi_ray *ray;
    int part; /* of the ray */
    double last;

    /* rectilinear */
    cwi_walk walk;
    double next[3];
    ptrdiff_t cell[3];

    /* irregular */
    cwi_cell_hit *hits;
    size_t hit_count, hit_capacity, hit;
    bool is_starved;
    double start, origin[3], slope[3]; /* the ray from where it meets the grid's box */
    cwi_mapped_cell mapped;
    bool is_linear;
    double values[8], tolerance,
        line[2][3];       /* the cell's; u along the ray, where it is linear */
    double pieces[32][2]; /* to go through next, the last first */
    int piece_count;
} cwi_spans;

/* Starts a ray; the ray stays borrowed. Returns false when memory for its cells is out. */
bool cwi_spans_start(cwi_spans *spans, const cwi_field *field, const cwi_ray *ray);

/* Goes to the next span; returns false after the last. */
bool cwi_spans_next(cwi_spans *spans, cwi_span *span);

void cwi_spans_free(cwi_spans *spans);

#ifdef __cplusplus
}
#endif

#endif
