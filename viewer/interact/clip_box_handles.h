/* A box of the world as a person sees and drags it: a handle in the middle of each face. */
#ifndef VIEWER_INTERACT_CLIP_BOX_HANDLES_H
#define VIEWER_INTERACT_CLIP_BOX_HANDLES_H

#include <cubewright/camera.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A picture of the box: its camera and size. */
typedef struct cwi_handle_view {
    cw_camera camera;
    size_t width, height; /* pixels */
} cwi_handle_view;

typedef struct cwi_world_box {
    double low[3], high[3];
} cwi_world_box;

/* Handle 2 a is that of the low face of axis a, 2 a + 1 that of the high one. */
enum { CWI_HANDLES = 6, CWI_HANDLE_NONE = -1, CWI_BOX_EDGES = 12 };

typedef struct cwi_handle {
    bool shown;      /* in front of the eye; else the rest is 0 */
    double pixel[2]; /* from the upper left corner, y down; may be beyond the picture */
    double depth_mm; /* from the eye's plane */
    bool faces_away; /* its face is seen from inside */
} cwi_handle;

/* The part of an edge that is in front of the eye. */
typedef struct cwi_box_edge {
    bool shown;
    double pixels[2][2];
    bool is_behind; /* both its faces face away: the box hides it */
} cwi_box_edge;

void cwi_handles_place(const cwi_handle_view *view, const cwi_world_box *box,
                       cwi_handle handles[CWI_HANDLES]);

/* Returns the handle at most radius_px away, or CWI_HANDLE_NONE; of several, the one nearest to
 * the eye. */
int cwi_handles_hit(const cwi_handle handles[CWI_HANDLES], const double pixel[2],
                    double radius_px);

/* Drags a handle's face along its axis to where that comes closest to the line of sight through
 * a pixel. A mouse that took a handle beside its middle keeps that distance if the caller adds
 * it to the pixel.
 *
 * bounds  limits of faces; where there is room, the box stays at least thickness_mm thick
 *
 * Returns false, and leaves the box unchanged, where the line of sight decides nothing: it is
 * within 3 degrees of the axis, or comes closest to it behind the eye. */
bool cwi_handles_drag(const cwi_handle_view *view, const cwi_world_box *bounds,
                      double thickness_mm, int handle, const double pixel[2],
                      cwi_world_box *box);

void cwi_handles_edges(const cwi_handle_view *view, const cwi_world_box *box,
                       cwi_box_edge edges[CWI_BOX_EDGES]);

#ifdef __cplusplus
}
#endif

#endif
