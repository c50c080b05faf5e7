/* The field's usual extractors, to be measured beside ours: vtkFlyingEdges3D, normals on, and of
 * labels vtkDiscreteFlyingEdges3D and vtkDiscreteMarchingCubes, which make a surface a label,
 * unsmoothed. */
#ifndef BENCH_VTK_WRAP_H
#define BENCH_VTK_WRAP_H

#include <cubewright/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Milliseconds of one extraction of a packed u8, u16 or f32 volume; negative: there is no VTK
 * in this build, or it failed. Freeing its mesh is not timed. */
double bench_vtk(const cw_volume *volume, double isovalue, int threads, size_t *triangles);

/* The same of labels 1 to `labels`. */
double bench_vtk_labels(const cw_volume *volume, size_t labels, bool marching_cubes,
                        int threads, size_t *triangles);

#ifdef __cplusplus
}
#endif

#endif
