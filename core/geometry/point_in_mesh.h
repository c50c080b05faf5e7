/* Test for a point inside a closed, oriented mesh. */
#ifndef CORE_GEOMETRY_POINT_IN_MESH_H
#define CORE_GEOMETRY_POINT_IN_MESH_H

#include "core/geometry/bvh.h"

#include <cubewright/mesh.h>

/* Returns true if the mesh winds around a point at least once. Counts the crossings of a ray
 * along x.
 * tree     of cwi_closest_build()
 * normals  of the mesh's triangles
 * point    relative to the mesh's origin; on the surface the answer may be either */
bool cwi_is_inside(const cw_mesh *mesh, const cwi_boxes *tree, const double (*normals)[3],
                   const double point[3]);

#endif
