/* Splatting, sheet by sheet [Westover1990]: the parts shared by the flat and the hierarchical
 * mode. */
#ifndef VIEWER_MODES_SPLAT_SHEETS_H
#define VIEWER_MODES_SPLAT_SHEETS_H

#include "viewer/modes/splat_kernel.h"
#include "viewer/scene/cell_lattice.h"

/* A voxel's blob, or the part of a node's voxels that is in a sheet, as one. As
 * shaders/splat.glsl reads it from a buffer. */
typedef struct cwi_splat {
    float at[3];       /* index space */
    float value;       /* coordinate in the table */
    float gradient[3]; /* per voxel */
    float mass;    /* cells a voxel stands for; of a node those it has in the sheet, over its
                      area there */
    float size[3]; /* of a node in the sheet, in voxels; else 0 */
    float is_node; /* 1: it is one */
} cwi_splat;

/* Splats of one kind, drawn by one program: voxels, or nodes. */
typedef struct cwi_splat_batch {
    GLuint program, array, indices;
    size_t triangles; /* of a splat */
    cwi_splat *chunk;
    size_t count;
} cwi_splat_batch;

/* A picture being made of splats. Zeroed, then cwi_splats_open(), harmless to close twice. */
typedef struct cwi_splats {
    cwi_gl *gl;
    const cwi_frame *frame;
    cw_status status; /* once it is not CW_OK nothing more is drawn */
    cw_error *err;
    cwi_visible visible;
    double eye[3]; /* index space */
    int axis;      /* sheets are across this axis of index space */
    bool has_gaps; /* some voxels may have no value */
    bool needs_gradients;
    double radius; /* of a footprint, eye space */
    const cwi_splat_kernel *kernel;
    cwi_splat_batch batches[2]; /* voxels; nodes, of which there may be none */
    GLuint composite, buffer, splats, footprint, sheet, framebuffer;
    double bounds[4]; /* of the sheet's splats, on the picture from -1 to 1: low, high x; y */
} cwi_splats;

/* has_nodes: there are not only voxels */
CW_NODISCARD cw_status cwi_splats_open(cwi_splats *s, cwi_gl *gl, bool has_nodes,
                                       cw_error *err);
void cwi_splats_close(cwi_splats *s);

/* Returns true if clips, and a place in front of the eye, keep a splat at a point of index
 * space. */
bool cwi_splats_keep(const cwi_splats *s, const double at[3], double eye[3]);

/* Adds a splat, that was kept at a point of eye space, to the sheet. */
void cwi_splats_add(cwi_splats *s, const cwi_splat *splat, const double eye[3]);

/* Splats a voxel, unless it shows nothing, has no value or is clipped. */
void cwi_splats_voxel(cwi_splats *s, const size_t at[3]);

/* Splats all voxels, each by itself. */
CW_NODISCARD cw_status cwi_splats_flat(cwi_splats *s, cw_error *err);

/* Orders the sheets, along the axis they are across, from the farthest to the nearest; free
 * with cwi_free(). */
size_t *cwi_splats_order(const cwi_splats *s, cw_error *err);

/* Ends a sheet, the n-th of all, and asks whether to go on: CW_ERR_CANCELLED. */
CW_NODISCARD cw_status cwi_splats_end_sheet(cwi_splats *s, size_t n, cw_error *err);

#endif
