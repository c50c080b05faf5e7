/* The field's usual volume renderers, to be measured beside ours: vtkGPUVolumeRayCastMapper and
 * vtkFixedPointVolumeRayCastMapper. They need an X server; xvfb-run gives one. */
#ifndef BENCH_RENDER_VTK_H
#define BENCH_RENDER_VTK_H

#include <cubewright/render.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct bench_vtk_times {
    double first_ms; /* processor time of all threads: of the first picture, upload included */
    double next_ms;  /* median of those after it */
} bench_vtk_times;

/* Draws a scene of a packed f32 volume with an even, unmirrored affine along the axes:
 * composite (lit or not) or mip, in steps of step_vox (0: 1) spacings. bytes: height x width x 3, rows going up;
 * or NULL. False: there is no VTK in this build, no X server, or it failed. */
bool bench_vtk_render(const cw_scene *scene, bool gpu, int frames, bench_vtk_times *times,
                      unsigned char *bytes);

#ifdef __cplusplus
}
#endif

#endif
