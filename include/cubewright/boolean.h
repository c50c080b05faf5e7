/* Booleans of solids: union, difference, intersection, exact until the result is rounded. */
#ifndef CUBEWRIGHT_BOOLEAN_H
#define CUBEWRIGHT_BOOLEAN_H

#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Operations on solids A (the first mesh) and B (all others together), by what is kept. */
typedef enum cw_boolean_op {
    CW_BOOLEAN_UNION,        /* what is inside of any mesh */
    CW_BOOLEAN_DIFFERENCE,   /* what is inside of A, and of no other */
    CW_BOOLEAN_INTERSECTION, /* what is inside of all */
    CW_BOOLEAN_XOR,          /* what is inside of an odd number of them */
    CW_BOOLEAN_SPLIT, /* two results: the difference, and what is inside of A and of another */
    CW_BOOLEAN_COUNT
} cw_boolean_op;

/* Facts on one of the meshes: flags. */
typedef enum cw_boolean_input {
    CW_BOOLEAN_EMPTY = 1,  /* it has no triangle with an area */
    CW_BOOLEAN_TURNED = 2, /* it enclosed a negative volume as a whole, and was turned */
    CW_BOOLEAN_NEGATIVE =
        4 /* it winds around a region a negative number of times: a shell is inside out */
} cw_boolean_input;

/* Options of a boolean. Zero fields mean the default named beside them. */
typedef struct cw_boolean_desc {
    uint32_t version;     /* 0: the first version of this struct */
    cw_boolean_op op;     /* default: union */
    int threads;          /* default: one per processor; the result does not depend on it */
    cw_progress progress; /* default: none */
    uint8_t
        *inputs; /* of each mesh: its flags of cw_boolean_input are stored; default: none are */
} cw_boolean_desc;

/* Facts on a boolean. */
typedef struct cw_boolean_facts {
    uint32_t version;        /* 0: the first version of this struct */
    size_t split_triangles;  /* triangles of the inputs that others cross or overlap */
    size_t new_points;       /* points of the result that are no vertices of an input */
    size_t contact_edges;    /* edges in which the result touches itself */
    size_t contact_vertices; /* vertices that were doubled, so that it is a manifold there */
    size_t dropped;          /* triangles of the inputs that have no area */
    size_t turned;           /* inputs that were inside out: they enclosed a negative volume */
    size_t open_mesh;        /* the number of a mesh that is open, from 1; 0: none is */
    size_t rounds;   /* how often the result was rounded to floats; 0: nothing was to round */
    double moved_mm; /* the largest movement of a point: up to half a last digit of the largest
                                coordinate, or more where rounding made facets cross */
    double volume_mm3[2]; /* of the results, before rounding */
    size_t
        negative_regions; /* around which a mesh winds a negative number of times: they count as outside */
    double negative_mm3; /* their volume, of which the results have nothing by this mesh */
} cw_boolean_facts;

/* Unites, subtracts or intersects solids.
 *
 * A point is inside of a mesh if the mesh winds around it: a positive number of times. So meshes may touch,
 * overlap and cross themselves, have several shells, shells in shells and equal triangles. They must be
 * closed: at each edge as many triangles run one way as the other. A shell that is inside out and in no other adds
 * nothing: negative_regions counts what is lost, and cw_mesh_orient() turns it. The order of `meshes` matters to the
 * difference and to the split alone.
 *
 * All decisions are exact for the positions given, on a grid of 2^-46 of the largest coordinate. Points in
 * which meshes meet are rounded to floats in the end. Where that makes facets cross, they are
 * resolved again. The result is a closed, oriented manifold that does not cross itself; where it touches
 * itself in edges or points, vertices are doubled. Vertices of the inputs keep their place, and facets that no
 * other meets stay whole.
 *
 * Attributes go through. An attribute that only some of the meshes have is 0 elsewhere, and colours are white.
 * The result has the attribute `input` on triangles: the number of the mesh that each comes from.
 * The origin is that of the first mesh.
 *
 * meshes   count pointers, borrowed
 * count    1 or more. The union of one mesh unites what overlaps in it
 * desc     borrowed; NULL means all defaults
 * out      one mesh, two for CW_BOOLEAN_SPLIT; filled on success, emptied on failure; free each with
 *          cw_mesh_free(). Nothing inside gives an empty mesh
 * facts    may be NULL
 *
 * Returns  CW_ERR_ARGUMENT  count is 0, or as cw_mesh_check()
 *          CW_ERR_CHECK     a mesh is open: the message tells where; see cw_mesh_repair(). Or rounding found no
 *                           result without crossings: 1 of some 8,000 hard cases came near it
 *          CW_ERR_LIMIT     more than 2^31 / 3 triangles or facets
 *          CW_ERR_NO_MEMORY; CW_ERR_CANCELLED
 * Cost     near-linear in triangles and intersections; about 150 bytes a triangle, 1 kB an intersection
 * Threads  reentrant
 * Source   arrangements [Zhou2016; Cherchi2022], points kept as what defines them [Attene2020] */
CW_NODISCARD CW_API cw_status cw_mesh_boolean(const cw_mesh *const *meshes, size_t count,
                                              const cw_boolean_desc *desc, cw_mesh *out,
                                              cw_boolean_facts *facts, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
