/* The parts of extraction that look at voxels, once for every voxel type. */
#ifndef EXTRACT_TYPED_H
#define EXTRACT_TYPED_H

#include "extract/grid.h"

/* Where vertices go. */
typedef struct cwi_vertex_sink {
    float *positions, *normals; /* normals may be NULL */
    double affine[3][3];        /* index to world directions */
    double centre[3];           /* index that stands at the mesh's origin */
    double cofactor[3][3];      /* index gradient to outward world direction */
} cwi_vertex_sink;

/* Stores vertex n: cell coordinates from padded sample at[], and the gradient of the stored
 * numbers there; the normal is zero where the gradient is zero or not finite. */
void cwi_sink_vertex(const cwi_vertex_sink *sink, const size_t at[3], const double p[3],
                     double g[3], size_t n);

typedef struct cwi_typed {
    /* Sets the inside bits of one row of voxels, and where values are missing (may be NULL). */
    void (*classify)(const cwi_grid *grid, size_t j, size_t k, uint64_t *inside,
                     uint64_t *defined);
    /* Computes the vertex numbered v on the edge along axis from padded sample at[]. */
    void (*vertex)(const cwi_grid *grid, const size_t at[3], int axis,
                   const cwi_vertex_sink *sink, size_t v);
} cwi_typed;

const cwi_typed *cwi_typed_of(cw_type type);

#endif
