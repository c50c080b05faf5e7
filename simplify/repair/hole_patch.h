/* Patches: the triangles that fill a hole. */
#ifndef SIMPLIFY_REPAIR_HOLE_PATCH_H
#define SIMPLIFY_REPAIR_HOLE_PATCH_H

#include "simplify/repair/repair_state.h"

#define CWI_NO_NEIGHBOUR UINT32_MAX

/* The rim of a hole, and the mesh beside it. Arrays of `size` elements. */
typedef struct cwi_boundary_loop {
    const uint32_t *vertices; /* of the mesh, in the direction of the patch's triangles */
    const uint32_t *beside;   /* third vertex of the triangle at the edge to the next vertex */
    size_t size;
} cwi_boundary_loop;

#define CWI_NO_RIM UINT32_MAX

/* Rims of holes, one after the other. */
typedef struct cwi_rims {
    uint32_t *vertices, *beside; /* as of a cwi_boundary_loop */
    size_t *end;                 /* of each rim, in vertices */
    size_t count;
} cwi_rims;

/* Returns where a rim begins, in vertices. */
static inline size_t cwi_rim_start(const cwi_rims *rims, size_t rim)
{
    return rim ? rims->end[rim - 1] : 0;
}

/* The mesh for all holes: its edges, and the triangles around vertices. */
typedef struct cwi_hole_mesh {
    const cw_mesh *mesh;
    uint64_t *edges; /* see cwi_edge_keys() */
    size_t edge_count;
    uint32_t *first, *around; /* see cwi_fans_sort() */
} cwi_hole_mesh;

/* Points and triangles. The first points are those of the rim, in its order. A zeroed struct is valid
 * and empty. */
typedef struct cwi_hole_patch {
    double (*points)[3];
    double *sizes; /* of points: mean length of the edges of the mesh there; 0: not known */
    uint32_t (*triangles)[3];
    uint32_t (*neighbours)[3]; /* across the edge from each corner to the next */
    size_t count, triangle_count, loop;
    size_t capacity, triangle_capacity;
} cwi_hole_patch;

void cwi_patch_free(cwi_hole_patch *patch);

/* All below return false when memory is out. */

/* Adds a triangle, or a point. */
bool cwi_patch_add_triangle(cwi_hole_patch *patch, uint32_t a, uint32_t b, uint32_t c);
bool cwi_patch_add_point(cwi_hole_patch *patch, const double point[3]);

/* Triangulates a rim whose points are in the patch. It has the smallest maximum angle between
 * neighbours, and then the smallest area, if the rim is short. A point in the middle is added where no
 * triangulation would do without an edge that the mesh has. */
bool cwi_patch_triangulate(cwi_hole_patch *patch, const cwi_boundary_loop *loop,
                           const cwi_hole_mesh *around);

/* Finds rims in each other, in one plane within 5 % of the outer one's diagonal, that face opposite ways: what is
 * missing is between them. The rim of an island in a hole has none around it.
 * outer    of each rim: the one around it; CWI_NO_RIM: none
 * Returns  CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_find_nested_rims(const cw_mesh *mesh, const cwi_rims *rims,
                                            uint32_t *outer, cw_error *err);

/* Returns true if the first rim lies in a plane, but for 1/1000 of its diagonal. */
bool cwi_is_rim_flat(const cw_mesh *mesh, const cwi_rims *rims);

/* Triangulates what is between the first rim and the others, whose points are in the patch.
 * is_made  false: rims cross, as the first one's normal shows them, or edges of the mesh are in the way
 * Returns  CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_patch_between_rims(cwi_hole_patch *patch, const cwi_rims *rims,
                                              const cwi_hole_mesh *around, bool *is_made,
                                              cw_error *err);

/* Adds points until triangles are as large as those around the rim, times a factor. */
bool cwi_patch_refine(cwi_hole_patch *patch, const cwi_boundary_loop *loop,
                      const cwi_hole_mesh *around, double times);

/* Moves the points inside: to the surface of least area, about; or if fair, to one that goes on smoothly
 * from the triangles around.
 * is_later  a coarser patch was moved before, and this one begins there */
bool cwi_patch_fair(cwi_hole_patch *patch, const cwi_boundary_loop *loop,
                    const cwi_hole_mesh *around, bool is_fair, bool is_later);

/* Divides the triangles of a patch, and moves its new points: does both of the above, for large rims
 * from coarse to fine. */
bool cwi_patch_shape(cwi_hole_patch *patch, const cwi_boundary_loop *loop,
                     const cwi_hole_mesh *around, bool is_fair);

#endif
