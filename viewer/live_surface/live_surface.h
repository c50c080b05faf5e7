/* A volume's surface at an isovalue, extracted by OpenGL's compute shaders and kept where it is
 * drawn from. The surface is that of cw_extract(): the same vertices and triangles, in another
 * order. viewer/live-surfaces.md tells how, and which volumes it takes. */
#ifndef VIEWER_LIVE_SURFACE_LIVE_SURFACE_H
#define VIEWER_LIVE_SURFACE_LIVE_SURFACE_H

#include "viewer/gl/gl_internal.h"

/* Everything on the GPU for one volume: its voxels, programs for their type, and the surface. */
typedef struct cwi_live cwi_live;

/* A surface in buffers: its vertex array has the positions and normals, as floats, and the
 * triangles. */
typedef struct cwi_live_mesh {
    GLuint array;
    size_t vertex_count, triangle_count;
} cwi_live_mesh;

/* Extracts the surface, in the current context. *live is made at the first call, and again for
 * another volume; a surface that is there stays.
 *
 * limits  lower ones than the driver's; zeros: its own
 * times   filled, unless NULL; then the call waits for the GPU
 * Returns CW_ERR_UNSUPPORTED  this OpenGL cannot, or not for such a volume: the CPU can
 *         CW_ERR_LIMIT        volume or surface is larger than this OpenGL holds: the CPU can
 *         CW_ERR_NO_MEMORY; CW_ERR_BACKEND */
CW_NODISCARD cw_status cwi_live_take(cwi_live **live, const cw_live_surface *desc,
                                     const cwi_live_limits *limits, cwi_live_times *times,
                                     cwi_live_mesh *mesh, cw_error *err);

/* Begins what cwi_live_take() needs, as cw_renderer_prepare(). */
CW_NODISCARD cw_status cwi_live_prepare(cwi_live **live, const cw_live_surface *desc,
                                        bool *ready, cw_error *err);

/* Copies the surface that was taken last to a mesh, as cw_extract() makes it. */
CW_NODISCARD cw_status cwi_live_read(const cwi_live *live, cw_mesh *mesh, cw_error *err);

/* Frees what is of a volume; its programs stay. Harmless on NULL. */
void cwi_live_forget(cwi_live *live);
void cwi_live_drop(cwi_live *live);

#endif
