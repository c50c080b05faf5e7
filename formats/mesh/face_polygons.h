/* Polygons of files as triangles that do not overlap. */
#ifndef FORMATS_MESH_FACE_POLYGONS_H
#define FORMATS_MESH_FACE_POLYGONS_H

#include <cubewright/mesh.h>

/* A face of more than three corners: the fan of triangles that was made of it. */
typedef struct cwi_face_polygon {
    uint32_t first, count; /* triangles */
} cwi_face_polygon;

/* Replaces fans whose triangles overlap, where a polygon is not convex: by as many triangles that do not,
 * as seen along the axis along which the polygon is largest.
 * crossing  increased by the polygons whose triangles still face both ways, as they cross themselves
 * Returns   CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_cut_polygons(const cwi_face_polygon *polygons, size_t count,
                                        cw_mesh *mesh, size_t *crossing, cw_error *err);

#endif
