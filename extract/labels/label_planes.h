/* Planes of a polygon's triangles, which tell quickly that another polygon is apart. */
#ifndef EXTRACT_LABELS_LABEL_PLANES_H
#define EXTRACT_LABELS_LABEL_PLANES_H

#include "extract/labels/label_net.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A polygon: triangle n, counted from its first, has the corners 0, n + 1 and n + 2. */
typedef struct cwi_label_planes {
    int count; /* of corners */
    uint32_t corners[CWI_POLYGON_CORNERS];
    float low[3], high[3];                 /* its box */
    double points[3][CWI_POLYGON_CORNERS]; /* along each axis; the first fills up to 4 or all */
    bool has_normals;
    double normals[CWI_POLYGON_CORNERS][3]; /* of triangles, as long as twice their area */
    double errors[CWI_POLYGON_CORNERS];     /* bound of a normal's rounding error */
} cwi_label_planes;

/* Loads a polygon, without the normals. */
void cwi_label_planes_load(cwi_label_planes *polygon, const cwi_label_net *net,
                           const cw_mesh *mesh, size_t first);

/* Returns the pairs of triangles that may share a point beyond their common vertices and edges: bit
 * 8 s + t for triangle s of the first polygon and t of the second. Pairs without a bit share none:
 * the one is on one side of the other's plane, by more than the rounding errors of doubles. */
uint64_t cwi_label_planes_pairs(cwi_label_planes *one, cwi_label_planes *other);

/* Returns true if a triangle has an area; false if that is uncertain. */
bool cwi_label_planes_has_area(cwi_label_planes *polygon, int triangle);

#ifdef __cplusplus
}
#endif

#endif
