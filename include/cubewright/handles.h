/* Handles and tunnels of a mesh: closing the small ones, which noise makes in a scan. */
#ifndef CUBEWRIGHT_HANDLES_H
#define CUBEWRIGHT_HANDLES_H

#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Settings of cw_mesh_close_handles(). Zero-initialise the struct and set what you need; a zero
 * field means the default named beside it. */
typedef struct cw_close_handles_desc {
    uint32_t version;     /* 0: the first version of this struct */
    double length_mm;     /* the longest loop to close, measured along edges; default:
                             CW_HANDLE_FRACTION of the diagonal of the mesh's box */
    int threads;          /* default: one per processor */
    cw_progress progress; /* default: none */
} cw_close_handles_desc;

/* The default of cw_close_handles_desc.length_mm, as a fraction of the diagonal of the mesh's box. */
#define CW_HANDLE_FRACTION 0.03

/* Facts on the handles that were closed, and on those that are left. */
typedef struct cw_close_handles_facts {
    double length_mm;    /* length_mm of the settings, or its default for this mesh */
    size_t genus_before; /* handles of all components; borders count as filled */
    size_t genus_after;  /* the same, of the result */
    size_t cut;          /* handles that were cut: their caps are inside of the old solid */
    size_t filled;       /* tunnels that were filled: their caps are outside of it */
    size_t left_long;    /* handles left: no loop around them or through them is short enough */
    size_t left_crossing; /* handles left: caps of their short loops would cross the surface */
    double change_mm; /* the largest distance of new and moved triangles from the old surface */
    size_t triangles_before;  /* number of triangles */
    size_t triangles_after;   /* the same, of the result */
    size_t components_before; /* sets of triangles that are joined by edges */
    size_t
        components_after; /* the same, of the result: as many, since no cut separates anything */
} cw_close_handles_facts;

/* Makes a mesh without the small handles and tunnels of another: changes the topology, which simplification keeps.
 *
 * A loop of edges that does not separate the surface runs around a handle or through a tunnel. Loops
 * are found as the shortest ones within length_mm. The surface is cut along each, shorter ones first,
 * and both rims get smooth caps: a thin handle is cut, and a narrow tunnel is filled. The vertices of both rims
 * move apart by up to half of the way to their neighbours. A cut whose caps would meet the surface is not made.
 *
 * Closed manifolds stay closed manifolds, no triangles meet that did not meet before, and no component
 * falls apart. A mesh without a short loop is copied, to the bit. Loops neither touch open edges nor
 * vertices and edges that are no manifold. The result does not depend on the unit.
 *
 * mesh     borrowed. Vertices at equal positions count as different ones, and their edges as open: weld
 *          them first
 * desc     borrowed; NULL means all defaults
 * out      filled on success, emptied on failure; free it with cw_mesh_free(). Vertices and triangles that
 *          stay keep their numbers and attributes; new ones follow them, with attributes of the vertex that
 *          they are a copy of, or of the closest point. Normals around cuts are those of cw_mesh_normals()
 * facts    may be NULL
 *
 * Returns  CW_ERR_ARGUMENT  length_mm is negative or not finite, or as cw_mesh_check()
 *          CW_ERR_LIMIT     beyond 2^32 / 3 triangles or vertices
 *          CW_ERR_NO_MEMORY; CW_ERR_CANCELLED
 * Cost     about 4 us for each triangle, and 2 ms for each handle; about 130 bytes for each triangle
 * Threads  reentrant; the same to the bit for any number of threads
 * Source   loops after [Guskov2001], found by a tree and a cotree [Eppstein2003]; caps [Liepa2003] */
CW_NODISCARD CW_API cw_status cw_mesh_close_handles(const cw_mesh *mesh,
                                                    const cw_close_handles_desc *desc,
                                                    cw_mesh *out, cw_close_handles_facts *facts,
                                                    cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
