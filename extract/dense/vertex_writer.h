/* Stores one vertex: converts index space to the mesh's positions and normals. */
#ifndef EXTRACT_DENSE_VERTEX_WRITER_H
#define EXTRACT_DENSE_VERTEX_WRITER_H

#include "core/base/parallel.h"
#include "core/geometry/vec3.h"
#include "core/volume/volume.h"
#include "extract/dense/isa_dispatch.h"

/* Computes a position. x: cell coordinates from padded sample at[]. */
static inline void cwi_world_position(const cwi_vertex_sink *sink, const size_t at[3],
                                      const double x[3], float position[3])
{
    double p[3];
    for (int a = 0; a < 3; a++)
        p[a] = cwi_is_rectilinear(sink->grid)
                   ? cwi_grid_coordinate(sink->grid, a, (ptrdiff_t)at[a] - 1, x[a]) -
                         sink->centre[a]
                   : (double)at[a] - 1 - sink->centre[a] + x[a];
    for (int r = 0; r < 3; r++)
        position[r] = (float)(sink->affine[r][0] * p[0] + sink->affine[r][1] * p[1] +
                              sink->affine[r][2] * p[2] + 0.0); /* no negative zeros */
}

static inline void cwi_store_position(const cwi_vertex_sink *sink, const size_t at[3],
                                      const double x[3], size_t n)
{
    cwi_world_position(sink, at, x, sink->positions + 3 * (n - sink->first));
}

/* Writes a vertex's normal. g: the gradient of the stored numbers in index space. Where it
 * vanishes or is not finite the normal is zero: the caller repairs it from triangles. */
static inline void cwi_store_normal(cwi_vertex_sink *sink, double g[3], size_t n)
{
    double d[3] = {0, 0, 0};
    if (cwi_normalise(g))
        for (int r = 0; r < 3; r++)
            d[r] = sink->cofactor[r][0] * g[0] + sink->cofactor[r][1] * g[1] +
                   sink->cofactor[r][2] * g[2];
    const bool known = cwi_normalise(d);
    for (int r = 0; r < 3; r++)
        sink->normals[3 * (n - sink->first) + (size_t)r] = known ? (float)d[r] : 0;
    if (!known)
        cwi_set_flag(&sink->missing);
}

#endif
