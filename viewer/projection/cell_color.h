/* The light that a cell adds to a ray: the transfer function between the values where the ray
 * enters and leaves, pre-integrated [Engel2001], with light and gradient factor. */
#ifndef VIEWER_PROJECTION_CELL_COLOR_H
#define VIEWER_PROJECTION_CELL_COLOR_H

#include "viewer/rays/lanes.h"
#include "viewer/scene/cell_lattice.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Tables of a transfer function, kept for the next picture. Zeroed: nothing is kept. */
typedef struct cwi_cell_tables {
    bool is_made;
    cw_transfer key;
    double opacity_units, length; /* length: of the segments; 0: there are none */
    cwi_table table;
    cwi_visible visible;
    size_t segment_rows;
    float *segments; /* segment_rows x segment_rows x 4: colour times depth, optical depth */
} cwi_cell_tables;

/* Makes the tables that a frame needs, unless they are there. CW_ERR_NO_MEMORY,
 * CW_ERR_CANCELLED. */
CW_NODISCARD cw_status cwi_cell_tables_take(cwi_cell_tables *tables, const cwi_frame *frame,
                                            cw_error *err);
void cwi_cell_tables_free(cwi_cell_tables *tables);

/* A frame's optical model in single precision. */
typedef struct cwi_cell_model {
    const cwi_frame *frame;
    const cwi_cell_tables *tables;
    bool needs_gradients;
    cwi_lanes to_eye[3]; /* columns of the matrix from gradients in index space to eye space, in
                            rows of the table */
    cwi_lanes light_direction[CW_MAX_LIGHTS], light_color[CW_MAX_LIGHTS];
    size_t face_count;                   /* of clip planes that cut the volume */
    cwi_lanes face_normal[CW_MAX_CLIPS]; /* in eye space */
    cwi_lanes face_slope[CW_MAX_CLIPS];  /* distances to the planes, over index space, */
    float face_start[CW_MAX_CLIPS];      /* and at its origin */
} cwi_cell_model;

void cwi_cell_model_make(const cwi_frame *frame, const cwi_cell_tables *tables,
                         cwi_cell_model *model);

/* A sample of the picture and its ray, in index space. Distances t along the ray begin where it
 * enters the volume: so single precision is enough. */
typedef struct cwi_cell_ray {
    cwi_lanes origin, slope, inverse; /* inverse: 1 / slope, finite */
    cwi_lanes falls;                  /* 1 along the axes where slope is below 0, else 0 */
    cwi_lanes color;                  /* so far */
    float light;                      /* fraction that passes */
    int part_count;
    float parts[2][2]; /* the parts of the ray that are drawn */
    float depth[2];    /* from the eye's plane: at t = 0, and per t */
    cwi_lanes background;
    const cwi_lanes *halfway; /* for each light, between it and the eye */
} cwi_cell_ray;

/* Finds the directions of a ray halfway between each light and the eye. direction: the ray's,
 * in eye space. */
void cwi_cell_halfway(const cwi_cell_model *model, const double direction[3],
                      cwi_lanes halfway[CW_MAX_LIGHTS]);

/* A cell, or a node of cells, between two corners of index space. Bit a of a corner's number is
 * its place along axis a. */
typedef struct cwi_projected_cell {
    cwi_lanes low, size, inverse; /* inverse: 1 / size */
    cwi_lanes even, odd;   /* coordinates in the table, of the corners low and high in x */
    cwi_lanes gradient[8]; /* per cell, in rows of the table; unset if not needed */
} cwi_projected_cell;

/* Finds where a ray enters and leaves a cell; returns false if it misses it. Neighbours compute
 * a common face alike, so that every point of a ray is in one cell. */
static inline bool cwi_cell_meets(const cwi_projected_cell *c, const cwi_cell_ray *r,
                                  float t[2])
{
    const cwi_lanes far_side = c->size * r->falls;
    const cwi_lanes in = (c->low + far_side - r->origin) * r->inverse;
    const cwi_lanes out = (c->low + c->size - far_side - r->origin) * r->inverse;
    const float a = in[0] > in[1] ? in[0] : in[1], b = out[0] < out[1] ? out[0] : out[1];
    t[0] = a > in[2] ? a : in[2];
    t[1] = b < out[2] ? b : out[2];
    return t[1] > t[0];
}

/* Adds to a ray what it meets in a cell from t[0] to t[1]. linear: the colour of that part where
 * opacity is linear over polygons, as in 1991, or NULL */
void cwi_cell_pass(const cwi_cell_model *model, const cwi_projected_cell *cell,
                   const float t[2], const cwi_lanes *linear, cwi_cell_ray *ray);

/* Interpolates the coordinate in the table at a place in a cell, each 0 to 1. */
static inline float cwi_cell_value(const cwi_projected_cell *c, cwi_lanes at)
{
    const cwi_lanes edge = c->even + (c->odd - c->even) * at[0];
    const float low = edge[0] + (edge[1] - edge[0]) * at[1];
    const float high = edge[2] + (edge[3] - edge[2]) * at[1];
    return low + (high - low) * at[2];
}

/* Returns the place in a cell of a ray's point, clamped to 0 to 1. */
static inline cwi_lanes cwi_cell_place(const cwi_projected_cell *c, const cwi_cell_ray *r,
                                       float t)
{
    const cwi_lanes at = (r->origin + t * r->slope - c->low) * c->inverse;
    return cwi_lanes_min(cwi_lanes_max(at, cwi_lanes_spread(0)), cwi_lanes_spread(1));
}

/* Returns colour and extinction at a coordinate in the table, clamped. */
cwi_lanes cwi_cell_classify(const cwi_cell_tables *tables, float coordinate);

#ifdef __cplusplus
}
#endif

#endif
