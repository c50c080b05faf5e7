/* What can be said about a mesh: is it closed, a manifold, how large is it? */
#ifndef CUBEWRIGHT_QUALITY_H
#define CUBEWRIGHT_QUALITY_H

#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Facts of one mesh, counted from its triangles as indexed (coincident vertices are not merged
 * unless asked). Edges are unordered vertex pairs of triangles. */
typedef struct cw_quality {
    size_t vertices, triangles, edges;
    size_t components;           /* sets of triangles joined by vertices */
    size_t unused_vertices;      /* in no triangle */
    size_t open_edges;           /* in one triangle */
    size_t nonmanifold_edges;    /* in more than two */
    size_t misoriented_edges;    /* in two triangles that run through it the same way */
    size_t nonmanifold_vertices; /* whose triangles form more than one fan */
    size_t degenerate;           /* triangles of zero area in double precision */
    int64_t euler;               /* used vertices - edges + triangles */
    double area_mm2;
    double volume_mm3;     /* signed; positive when triangles wind outward. Of closed meshes */
    double min[3], max[3]; /* world box, mm */
} cw_quality;

/* Which vertices count as one. */
typedef enum cw_weld {
    CW_WELD_NONE,  /* those with the same index */
    CW_WELD_WORLD, /* those with equal single-precision world points, as readers of STL see */
    CW_WELD_LOCAL, /* those with equal positions */
} cw_weld;

typedef struct cw_quality_desc {
    cw_weld weld; /* default: as indexed */
} cw_quality_desc;

/* Measures a mesh in time proportional to its triangles.
 * Returns CW_ERR_ARGUMENT as cw_mesh_check(); CW_ERR_NO_MEMORY. */
CW_API cw_status cw_quality_measure(const cw_mesh *mesh, const cw_quality_desc *desc,
                                    cw_quality *out, cw_error *err);

/* No open, no non-manifold and no misoriented edge, no non-manifold vertex. */
CW_API bool cw_quality_is_closed_manifold(const cw_quality *quality);

#ifdef __cplusplus
}
#endif

#endif
