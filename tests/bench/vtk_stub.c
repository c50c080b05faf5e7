/* Stands in for vtkFlyingEdges3D in a build without VTK: returns -1. */
#include "vtk_wrap.h"

double bench_vtk(const cw_volume *volume, double isovalue, int threads, size_t *triangles)
{
    (void)volume, (void)isovalue, (void)threads;
    *triangles = 0;
    return -1;
}

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
