/* The field's usual extractors of labels, to be measured beside ours: vtkDiscreteFlyingEdges3D and
 * vtkDiscreteMarchingCubes, which make a surface a label, unsmoothed. */
#ifndef BENCH_VTK_LABELS_H
#define BENCH_VTK_LABELS_H

#include <cubewright/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Milliseconds of one extraction of labels 1 to `labels` of a packed u8 or u16 volume; negative:
 * there is no VTK in this build, or it failed. Freeing its mesh is not timed. */
double bench_vtk_labels(const cw_volume *volume, size_t labels, bool marching_cubes,
                        int threads, size_t *triangles);

#ifdef __cplusplus
}
#endif

#endif
