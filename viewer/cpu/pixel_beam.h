/* Beams: rays as wide as the area of the picture they stand for, through mean cells. */
#ifndef VIEWER_CPU_PIXEL_BEAM_H
#define VIEWER_CPU_PIXEL_BEAM_H

#include "viewer/rays/cell_corners.h"
#include "viewer/rays/ray_traversal.h"
#include "viewer/scene/mean_cells.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { CWI_BEAM_PLANES = 6 + CW_MAX_CLIPS };

/* The beams of a frame. A zeroed struct has no beams. */
typedef struct cwi_beams {
    const cwi_frame *frame;
    const cwi_ranges *ranges;
    const uint8_t *distances; /* of blocks to visible ones */
    const cwi_cell_corners *corners;
    cwi_cell_corners gradient_corners; /* of the frame's gradient volume */
    const cwi_mean_cells *cells;
    const cwi_table *table;
    size_t sides;    /* a pixel has sides x sides beams */
    double width[2]; /* a beam's, in units of eye space: at the eye, and its rise
                                   with depth */
    double step;     /* of a beam, in widths */
    double start;    /* the depth from which on a pixel covers more than a cell */
    double planes[CWI_BEAM_PLANES][4]; /* n . p >= d is kept: the volume's box, the clips */
    size_t plane_count;
    bool has_gradients;
    double value_scale;        /* a row of the table, in values */
    double to_eye[3][3];       /* gradients per voxel */
    float row_scale, row_bias; /* from a stored mean to its row of the table */
    size_t level_count;
    double (*integrals[CWI_MEAN_LEVELS])[4]; /* of the table, for a step of each level */
} cwi_beams;

/* Returns true if a pixel of the frame is wider than a cell at some depth. */
bool cwi_beams_are_wide(const cwi_frame *frame);

/* Returns true if beams of the frame take mean cells at some depth. */
bool cwi_beams_need_means(const cwi_frame *frame);

/* Prepares the beams of a frame; all pointers stay borrowed. cells: NULL unless they need
 * means. CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_beams_make(const cwi_frame *frame, const cwi_ranges *ranges,
                                      const uint8_t *distances, const cwi_cell_corners *corners,
                                      const cwi_mean_cells *cells, const cwi_table *table,
                                      cwi_beams *beams, cw_error *err);
void cwi_beams_free(cwi_beams *beams);

/* Lights a sample: changes colour and extinction in `glow`. at: distance along the ray;
 * gradient: in eye space, 0 if the volume has none */
typedef void cwi_beam_shade(void *context, double at, const double gradient[3],
                            cwi_lanes *glow);

/* Follows a beam from where the pixel covers more than a cell. depth: nothing of it is drawn
 * beyond; offset: the length of its first step, 0 to 1 steps; color, light: what it has
 * gathered, and the fraction of light that is left */
void cwi_beam_pass(const cwi_beams *beams, const cwi_ray *ray, double depth, double offset,
                   cwi_beam_shade *shade, void *context, cwi_lanes *color, float *light);

#ifdef __cplusplus
}
#endif

#endif
