/* Stands in for the VTK renderers in a build without them: reports that there are none. */
#include "render_vtk.h"

bool bench_vtk_render(const cw_scene *scene, bool gpu, int frames, bench_vtk_times *times,
                      unsigned char *bytes)
{
    (void)scene, (void)gpu, (void)frames, (void)times, (void)bytes;
    return false;
}
