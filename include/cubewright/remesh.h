/* Remeshing: triangles of a wanted size and shape, on the same surface. */
#ifndef CUBEWRIGHT_REMESH_H
#define CUBEWRIGHT_REMESH_H

#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Settings of a remeshing. Zero-initialise the struct and set what you need; a zero field means
 * the default named beside it. */
typedef struct cw_remesh_desc {
    uint32_t version;   /* 0: the first version of this struct */
    double edge_mm;     /* wanted length of edges; required. With is_adaptive the longest one */
    double shortest_mm; /* with is_adaptive, the shortest wanted length; default: a tenth of
                             edge_mm */
    double error_mm;    /* how far the surfaces may be apart, both ways; default: a tenth of
                             edge_mm */
    double feature_deg; /* edges are kept where normals turn by more, up to 180; default: 40 */
    double
        min_angle_deg; /* wanted smallest angle, up to 40: extra passes work on triangles below
                             it; default: none */
    size_t iterations; /* at most CW_REMESH_MAX_ITERATIONS; default: 5 */
    int threads;       /* default: one per processor */
    cw_progress progress; /* default: none */
    bool is_adaptive;     /* shorter edges where the surface is curved, so that they leave it by
                             half of error_mm; default: one length everywhere */
} cw_remesh_desc;

/* Maximum of cw_remesh_desc.iterations. */
#define CW_REMESH_MAX_ITERATIONS ((size_t)100)

/* Facts on a finished remeshing. */
typedef struct cw_remesh_facts {
    double edge_mm, shortest_mm, error_mm; /* as resolved; shortest_mm is 0 unless adaptive */
    double feature_deg, min_angle_deg;     /* as resolved */
    size_t iterations;                     /* those that were made */
    size_t triangles_before, triangles_after;      /* number of triangles */
    double min_edge_mm, mean_edge_mm, max_edge_mm; /* edges of the result */
    double fitting_edges; /* fraction of edges of 0.8 to 1.33 times the wanted length */
    double smallest_deg;  /* the smallest angle of the result */
    double where[3];      /* the corner with that angle, in the world */
    size_t below;         /* triangles with an angle below min_angle_deg */
    size_t features_before, features_after;   /* edges that are kept, borders not counted */
    size_t border_before, border_after;       /* edges at borders */
    size_t crossings_before, crossings_after; /* pairs of triangles that meet */
    size_t beyond;     /* triangles of both meshes that may be farther than error_mm from
                                 the other; 0: the distance is proven */
    size_t attempts;   /* how often it was done: again with less freedom around triangles
                                 that meet or are too far */
    bool is_undecided; /* see cw_crossings */
} cw_remesh_facts;

/* Remeshes a surface: edges become about as long as wanted, and triangles regular.
 *
 * Long edges are split, short ones are collapsed, edges are flipped toward vertices of six
 * neighbours and larger angles, and vertices move along the surface. Every step is refused that
 * would leave the distance error_mm, turn a triangle by more than 60 degrees from the input
 * there, or change the topology: components, handles and border loops stay. Edges sharper than
 * feature_deg stay, and so do borders: vertices on them move along them only, and their ends and
 * bends stay at their place. Where error_mm is small against the mesh's detail, edges stay shorter
 * than wanted.
 *
 * Afterwards the distance is proven both ways, and triangles that meet are looked for. If there
 * are any that did not meet before, it is all done again, with half of the freedom around
 * them, up to 4 times. What is left is in the facts.
 *
 * Attributes of vertices and corners are interpolated at the closest point of the input, labels are
 * those of the nearest corner there, and triangles take those of the triangle closest to their middle.
 * Normals are computed again by cw_mesh_normals(), if there are any.
 *
 * mesh     borrowed; an oriented manifold, open or closed. Vertices at equal positions count as
 *          different ones: weld them first
 * desc     borrowed
 * out      filled on success, emptied on failure; free it with cw_mesh_free()
 * facts    may be NULL
 *
 * Returns  CW_ERR_ARGUMENT  edge_mm is not positive, another number is out of range, or as
 *                           cw_mesh_check()
 *          CW_ERR_FORMAT    the mesh is no oriented manifold; cw_mesh_repair() makes it one
 *          CW_ERR_EMPTY     the mesh has no triangles
 *          CW_ERR_LIMIT     beyond 2^32 / 3 triangles, in the mesh or expected; edge_mm is too
 *                           short for single precision
 *          CW_ERR_NO_MEMORY; CW_ERR_CANCELLED
 * Cost     about 30 us for each triangle of the larger mesh, 25 s for a million; each attempt
 *          takes as long again
 * Threads  reentrant; the same to the bit for any number of threads
 * Source   [Botsch2004], sizes by curvature [Dunyach2013], curvature [CohenSteiner2003]; see
 *          simplify/remesh.md */
CW_NODISCARD CW_API cw_status cw_mesh_remesh(const cw_mesh *mesh, const cw_remesh_desc *desc,
                                             cw_mesh *out, cw_remesh_facts *facts,
                                             cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
