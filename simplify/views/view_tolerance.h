/* How far a surface may move where pictures are taken of it. */
#ifndef SIMPLIFY_VIEWS_VIEW_TOLERANCE_H
#define SIMPLIFY_VIEWS_VIEW_TOLERANCE_H

#include <cubewright/simplify.h>

/* A camera in the frame of the points. At a depth z it sees what is not farther from its axis,
 * along its picture's sides, than half + slope z, and allows a distance of even + rate z:
 * linear in space, so that what it allows on a triangle is least in a corner. */
typedef struct cwi_view_tolerance {
    double eye[3], axes[3][3]; /* right, up, forward */
    double half[2], slope[2];
    double even, rate;
    double size[2], pixel; /* of the picture; a pixel is so wide at a depth of 1, or anywhere */
    const float *depth;    /* of the nearest surface, times unit; NULL: nothing is hidden */
    double unit, pixels;
    double nearest; /* less depth counts as this much; -infinity without a perspective */
} cwi_view_tolerance;

typedef struct cwi_views {
    cwi_view_tolerance *view;
    size_t count;
} cwi_views;

enum { CWI_VIEW_WIDTH = 1280, CWI_VIEW_HEIGHT = 720, CWI_VIEW_HULL = 8 };

/* Sets up a view, in the world's frame. Returns CW_ERR_ARGUMENT for a camera or a number of
 * pixels that is invalid. */
CW_NODISCARD cw_status cwi_view_init(cwi_view_tolerance *view, const cw_simplify_view *from,
                                     double pixels, cw_error *err);

/* Where a picture shows a point, in pixels, y down; false for what is not before the eye. */
bool cwi_view_project(const cwi_view_tolerance *view, const double point[3], double *x,
                      double *y, double *depth);

/* Free with cwi_views_free(), also after an error. In the world's frame.
 * Returns  CW_ERR_ARGUMENT for a camera or a number of pixels that is none, and views without
 *          an error_mm; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_views_init(cwi_views *views, const cw_simplify_desc *desc,
                                      cw_error *err);
void cwi_views_free(cwi_views *views);

/* Into a frame around an origin, with a unit of 1 / scale. */
void cwi_views_place(cwi_views *views, const double origin[3], double scale);

/* The least of what views allow anywhere on triangle t; infinite where none sees it. What a
 * view sees is wider and deeper by `margin` than it is; surfaces move by `max_error` at most. */
double cwi_views_limit(const cwi_views *views, const cw_mesh *mesh, size_t t, double max_error,
                       double margin);

#endif
