/* The volume rendering integral of a scene, in double precision and to an estimated error: the
 * reference for faster modes. */
#ifndef VIEWER_CPU_REFERENCE_VOLUME_H
#define VIEWER_CPU_REFERENCE_VOLUME_H

#include "viewer/rays/ray_spans.h"
#include "viewer/scene/transfer_segments.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { CWI_NODES = 4 };

/* Quadrature by a polynomial through Gauss's points of 0..1: weights for the whole, and for
 * from 0 to each point, which absorption up to there needs. */
typedef struct cwi_rule {
    double at[CWI_NODES], weight[CWI_NODES], inner[CWI_NODES][CWI_NODES];
} cwi_rule;

typedef struct cwi_reference {
    const cwi_frame *frame;
    cwi_knots knots;
    cwi_rule rule;
    double to_eye[3][3]; /* gradients */
    bool has_gradients;  /* they are needed */
    cwi_field field;     /* of a rectilinear or irregular grid */
} cwi_reference;

/* tree: of an irregular grid, else NULL. The result must stay where it is. */
void cwi_reference_make(const cwi_frame *frame, const cwi_cell_tree *tree,
                        cwi_reference *reference);

/* Integrates the ray through a point of the picture up to a depth (INFINITY: all of it):
 * colour, premultiplied, and opacity.
 * spans    scratch for grids that are not evenly spaced, else NULL; is_starved is then true if
 *          memory was out
 * Returns  an estimate of their largest error, but for that of the field in curved cells */
double cwi_reference_ray(const cwi_reference *reference, cwi_spans *spans, double x, double y,
                         double depth, double out[4]);

/* Draws a frame.
 * tree      of an irregular grid, with gradients if the frame needs them; else NULL
 * depths    one per sample, of the mesh that the volume is in front of; NULL: there is
 * none
 * estimate  the largest error of a sample, but for rounding to floats; may be NULL
 * Returns   CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_reference_draw(const cwi_frame *frame, const cwi_cell_tree *tree,
                                          const double *depths, cw_picture *picture,
                                          double *estimate, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
