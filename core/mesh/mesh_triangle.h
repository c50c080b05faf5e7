/* Points and triangles of a mesh by their numbers. Points are relative to the mesh's origin, unless
 * the name says `world`. */
#ifndef CORE_MESH_MESH_TRIANGLE_H
#define CORE_MESH_MESH_TRIANGLE_H

#include "core/geometry/triangle.h"

#include <cubewright/mesh.h>

static inline void cwi_mesh_world(const cw_mesh *mesh, size_t vertex, double world[3])
{
    for (size_t a = 0; a < 3; a++)
        world[a] = mesh->origin[a] + (double)mesh->positions[3 * vertex + a];
}

/* Returns the position of corner k, 0 to 2, of triangle t. */
static inline const float *cwi_mesh_point(const cw_mesh *mesh, size_t t, size_t k)
{
    return mesh->positions + 3 * (size_t)mesh->triangles[3 * t + k];
}

static inline void cwi_mesh_corner(const cw_mesh *mesh, size_t t, size_t k, double p[3])
{
    const float *from = cwi_mesh_point(mesh, t, k);
    for (int a = 0; a < 3; a++)
        p[a] = (double)from[a];
}

static inline void cwi_mesh_corners(const cw_mesh *mesh, size_t t, double p[3][3])
{
    for (size_t k = 0; k < 3; k++)
        cwi_mesh_corner(mesh, t, k, p[k]);
}

/* Computes a triangle's normal, as long as twice its area. */
static inline void cwi_mesh_normal(const cw_mesh *mesh, size_t t, double normal[3])
{
    cwi_facet_normal(cwi_mesh_point(mesh, t, 0), cwi_mesh_point(mesh, t, 1),
                     cwi_mesh_point(mesh, t, 2), normal);
}

static inline double cwi_mesh_area(const cw_mesh *mesh, size_t t)
{
    double normal[3];
    cwi_mesh_normal(mesh, t, normal);
    return cwi_length(normal) / 2;
}

#endif
