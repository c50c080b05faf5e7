/* A mesh as the checks see it: equal points may be one vertex. */
#ifndef SIMPLIFY_QUALITY_WELDED_MESH_H
#define SIMPLIFY_QUALITY_WELDED_MESH_H

#include "core/geometry/triangle.h"
#include "core/geometry/triangle_intersect.h"

#include <cubewright/quality.h>

struct cwi_boxes;

typedef struct cwi_welded {
    const cw_mesh *mesh;
    const float *points;    /* vertex_count x 3: single-precision world points, or positions */
    float *own_points;      /* those of the world; or NULL */
    const uint32_t *vertex; /* of each corner, 3 x triangle_count: the first of equal ones */
    uint32_t *own_vertex;   /* those, where they are not the mesh's; or NULL */
} cwi_welded;

/* Checks the mesh first. Free with cwi_welded_free(), also after a failure.
 * Returns as cw_mesh_check(); CW_ERR_LIMIT beyond 2^32 / 3 triangles; CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_welded_init(cwi_welded *welded, const cw_mesh *mesh, cw_weld how,
                                       cw_error *err);
void cwi_welded_free(cwi_welded *welded);

/* Sorts the triangles by place: the tree's order holds triangles. Those without area stay out, and
 * those of a fan. Free the tree; false when memory is out.
 * fan_of   triangles: their fan, or CWI_NO_FAN; NULL: none has one
 * threads  0: the default number */
bool cwi_welded_sort(const cwi_welded *welded, const uint32_t *fan_of, int threads,
                     struct cwi_boxes *tree);

/* A triangle that names a vertex twice has no edges to speak of. */
static inline bool cwi_is_collapsed(const cwi_welded *welded, size_t triangle)
{
    return cwi_triangle_is_collapsed(welded->vertex + 3 * triangle);
}

/* A triangle without area meets nothing. */
static inline bool cwi_is_flat(const cwi_welded *welded, size_t triangle)
{
    return cwi_is_collapsed(welded, triangle) ||
           !cwi_has_area(welded->points, welded->vertex + 3 * triangle);
}

#endif
