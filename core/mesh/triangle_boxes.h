/* Builds the tree of a mesh's triangles for nearest-point queries, also around wide fans. */
#ifndef CORE_MESH_TRIANGLE_BOXES_H
#define CORE_MESH_TRIANGLE_BOXES_H

#include "core/geometry/bvh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Sorts the boxes of triangles into a tree. Boxes of needles around one vertex all overlap, so that
 * each query would look at all of them. Such triangles have boxes for several parts along their
 * longest side: then the tree's order names a triangle more than once.
 * points   vertices x 3
 * corners  triangles x 3
 * Returns  CW_ERR_NO_MEMORY; free with cwi_boxes_free()
 * Source   early split clipping [Ernst2007] */
CW_NODISCARD cw_status cwi_triangle_boxes_build(cwi_boxes *tree, const float *points,
                                                size_t vertices, const uint32_t *corners,
                                                size_t triangles, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
