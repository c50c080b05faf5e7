/* Four cells of a ray at once: their glow, light and optical depth, a cell in each lane. */
#ifndef VIEWER_CPU_CELL_BATCH_H
#define VIEWER_CPU_CELL_BATCH_H

#include "viewer/rays/lanes.h"
#include "viewer/scene/frame_setup.h"
#include "viewer/scene/lighting.h"
#include "viewer/scene/transfer_table.h"

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { CWI_BATCH_CELLS = 4 };

/* Gauss's two points of 0..1, both of weight 1/2. */
#define CWI_FIRST_POINT  0.21132486540518713
#define CWI_SECOND_POINT 0.78867513459481287

/* Cells that a ray has gone through and whose light is not yet added. */
typedef struct cwi_cell_batch {
    int count;
    struct {
        int64_t at[4];   /* as the walk's */
        double from, to; /* the part of the ray in it */
        bool is_cut;     /* two points do not represent it */
    } cells[CWI_BATCH_CELLS];
    cwi_lanes rows[CWI_BATCH_CELLS];        /* at the start, the two points and the end */
    cwi_lanes gradient_xy[CWI_BATCH_CELLS]; /* in rows per voxel, at the two points: x and x,
                                               y and y; */
    cwi_lanes gradient_z_shadow[CWI_BATCH_CELLS]; /* z and z; and the shadows there */
} cwi_cell_batch;

/* All that the cells of a ray share. */
typedef struct cwi_batch_scene {
    const cwi_frame *frame;
    const cwi_table *table;
    const cwi_lighting *lighting;
    const float (*to_eye)[3]; /* gradients, per unit of eye space */
    float unit;               /* of a gradient's length: the value of a row */
    const float *background;
    double deepening; /* of the ray, along the line of sight */
    bool has_gradients;
} cwi_batch_scene;

/* A cell in each lane: the colour it sends, the fraction of light it lets through, its optical
 * depth, and the maximum difference of its two points. Cells deeper than 1/2 have wrong
 * colours. */
typedef struct cwi_batch_light {
    cwi_lanes color[3], left, depth, difference;
} cwi_batch_light;

cwi_batch_light cwi_cell_batch_light(const cwi_batch_scene *scene, const cwi_cell_batch *batch);

#ifdef __cplusplus
}
#endif

#endif
