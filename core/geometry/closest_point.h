/* Queries for the point of a mesh that is closest to another point. */
#ifndef CORE_GEOMETRY_CLOSEST_POINT_H
#define CORE_GEOMETRY_CLOSEST_POINT_H

#include "core/geometry/bvh.h"

#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cwi_closest {
    size_t triangle;
    double weights[3]; /* weights of its corners in the point */
    double point[3];
} cwi_closest;

/* Builds the tree of a mesh's triangles, which are not copied; free it with cwi_boxes_free().
 * Returns  CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_closest_build(const cw_mesh *mesh, cwi_boxes *tree, cw_error *err);

/* Finds the closest point. All points are relative to the mesh's origin; the mesh has
 * triangles. */
cwi_closest cwi_closest_find(const cw_mesh *mesh, const cwi_boxes *tree, const double point[3]);

#ifdef __cplusplus
}
#endif

#endif
