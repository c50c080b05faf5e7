/* Kernels of splatting: the blob that stands for a voxel, and its footprint as triangles. */
#ifndef VIEWER_MODES_SPLAT_KERNEL_H
#define VIEWER_MODES_SPLAT_KERNEL_H

#include "viewer/gl/gl_internal.h"

/* A kernel as shaders/splat.glsl draws it. */
typedef struct cwi_splat_kernel {
    const char *defines;
    bool is_in_plane; /* lies in its sheet, across the lattice; else it is a blob in space */
    double unit;      /* its standard deviation, when steps of the lattice are its own steps */
    double reach;     /* where it ends, in standard deviations */
    size_t corners, triangles;
} cwi_splat_kernel;

const cwi_splat_kernel *cwi_splat_kernel_of(const cw_scene *scene);

/* Makes the texture of the Gaussian's footprint, by the square of the distance, bound to a
 * unit. */
GLuint cwi_splat_footprint(const cwi_splat_kernel *kernel, int unit);

/* Fills in the indices of the triangles of `count` footprints. of: a rectangle for nodes if
 * NULL */
void cwi_splat_indices(const cwi_splat_kernel *of, size_t count, uint32_t *indices);

/* Sets the kernel's uniforms of a program. */
void cwi_splat_kernel_set(const cwi_splat_kernel *kernel, const cw_scene *scene,
                          GLuint program);

#endif
