/* Measuring something at points spread evenly over a mesh: means over its area, the largest. */
#ifndef SIMPLIFY_QUALITY_SURFACE_SAMPLING_H
#define SIMPLIFY_QUALITY_SURFACE_SAMPLING_H

#include "core/mesh/mesh_triangle.h"

#include <cubewright/distance.h>

/* The most points at which a mesh is measured: beyond, steps grow. */
#define CWI_MAX_SAMPLES ((size_t)1 << 25)

/* The distance of a point, relative to the mesh's origin; negative inside, where that has a
 * meaning. Called from several threads.
 *
 * hint    left by an earlier call for a point that is likely to be near; UINT32_MAX: none
 * missed  set when there was nothing within reach */
typedef double cwi_measure(const void *context, const double point[3], uint32_t *hint,
                           bool *missed);

typedef struct cwi_sampling {
    const cw_mesh *mesh;
    double step[3][3]; /* takes a side to a vector whose length is its number of steps */
    cwi_measure *measure;
    const void *context;
    bool is_signed;
    bool vertices_only; /* measure at these alone, each counting the same */
    float *worst;       /* vertex_count: the largest distance around each; or NULL */
    uint32_t *hints;    /* vertex_count: what measuring each vertex left; or NULL */
    const char *name;   /* of the work, for progress */
    int threads;
    const cw_progress *progress;
} cwi_sampling;

/* Measures; bound_mm is left 0. per_vertex may be NULL.
 * Returns CW_ERR_NO_MEMORY, CW_ERR_CANCELLED. */
CW_NODISCARD cw_status cwi_sample_mesh(const cwi_sampling *sampling, cw_distance *out,
                                       float *per_vertex, cw_error *err);

#endif
