/* A picture of a mesh made on the CPU in double precision: what faster renderers are measured
 * against, and what draws where there is no display and no GPU. */
#ifndef VIEWER_CPU_REFERENCE_MESH_H
#define VIEWER_CPU_REFERENCE_MESH_H

#include <cubewright/mesh.h>

#include <cubewright/camera.h>
#include <cubewright/picture.h>

#ifdef __cplusplus
extern "C" {
#endif

/* How to draw. Zero-initialise it; a zero field means the default named beside it. */
typedef struct cwi_render_desc {
    cw_camera camera;         /* default (up all 0): front view of the whole mesh, 30 degrees */
    size_t width, height;     /* pixels, at most 16384; default 1280 x 720 */
    int samples;              /* a side: 1 to 4 squared samples a pixel; default 2 */
    uint8_t color[4];         /* sRGB of a mesh without colours; default a bone white */
    uint8_t background[2][4]; /* top and bottom, sRGB and alpha; all 0: a light gradient. For a
                               * transparent one give any colour and alpha 0 */
    double *depth_mm; /* not NULL: filled with height x width depths, along the line of sight,
                         of what is seen; INFINITY: nothing is. One sample a pixel only */
    int threads;      /* default: all that OpenMP offers */
    cw_progress progress; /* default: none */
} cwi_render_desc;

/* Draws a mesh: nearest surface first, lit on both sides; back faces are tinted red, so that an
 * open or inside-out surface shows. A mesh without normals is drawn with its triangles' own.
 *
 * image    filled on success, emptied on failure; free it with cw_image_free()
 * Returns  CW_ERR_ARGUMENT  as cw_mesh_check() and cw_camera_axes(); sizes out of range
 *          CW_ERR_NO_MEMORY; CW_ERR_CANCELLED
 * Cost     in proportion to the triangles and to the samples they cover
 * Threads  reentrant; the same bytes for any number of threads */
CW_API cw_status cwi_render_mesh(const cw_mesh *mesh, const cwi_render_desc *desc,
                                 cw_image *image, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
