/* Without VTK its filters are not measured. */
#include "vtk_labels.h"

double bench_vtk_labels(const cw_volume *volume, size_t labels, bool marching_cubes,
                        int threads, size_t *triangles)
{
    (void)volume;
    (void)labels;
    (void)marching_cubes;
    (void)threads;
    *triangles = 0;
    return -1;
}
