/* A triangle mesh with shared vertices. */
#ifndef CUBEWRIGHT_MESH_H
#define CUBEWRIGHT_MESH_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Vertices and triangles. A zeroed struct is a valid empty mesh.
 *
 * The world point of vertex v is  origin + positions[3v .. 3v+2], LPS millimetres: positions
 * are small numbers near zero, so single precision keeps micrometres however far the scan
 * stands from the scanner's zero. Triangles wind counter-clockwise seen from outside. */
typedef struct cw_mesh {
    double origin[3];
    size_t vertex_count;
    size_t triangle_count;
    float *positions;    /* vertex_count x 3 */
    float *normals;      /* vertex_count x 3, unit length, outward; or NULL */
    uint32_t *triangles; /* triangle_count x 3, each below vertex_count */
    float *scalars;      /* vertex_count; or NULL */
    uint8_t *colors;     /* vertex_count x 4, sRGB and linear alpha; or NULL */
    uint32_t *labels;    /* vertex_count; or NULL */
    double affine[3][4]; /* of the volume it came from, see cw_volume; all 0: none */
} cw_mesh;

/* Frees the arrays and zeroes the struct. Harmless on a zeroed or already freed mesh. */
CW_API void cw_mesh_free(cw_mesh *mesh);

/* Checks what code below relies on: arrays present, every index below vertex_count, positions
 * finite. Returns CW_ERR_ARGUMENT naming the first thing that is wrong. */
CW_NODISCARD CW_API cw_status cw_mesh_check(const cw_mesh *mesh, cw_error *err);

/* World box of the vertices; false (and zeros) for a mesh without vertices. */
CW_API bool cw_mesh_bounds(const cw_mesh *mesh, double min[3], double max[3]);

/* Makes one vertex of those at equal positions (0 equals -0): the first of them, with its
 * normal, colour and whatever else it has. Triangles that name a vertex twice are left out, and
 * then vertices that no triangle names.
 *
 * mesh     in place: its arrays stay where they are, and only get shorter; as it was on failure
 * merged   vertices that were at the place of another; may be NULL
 * Returns  CW_ERR_ARGUMENT as cw_mesh_check(); CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_mesh_weld(cw_mesh *mesh, size_t *merged, cw_error *err);

/* Leaves out components (sets of triangles joined by vertices) whose box has a diagonal shorter
 * than so much, and then vertices that no triangle names.
 *
 * mesh     in place, as in cw_mesh_weld()
 * dropped, kept   components; may be NULL
 * Returns  CW_ERR_ARGUMENT  diagonal_mm is negative or NaN, or as cw_mesh_check();
 *          CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_mesh_drop_components(cw_mesh *mesh, double diagonal_mm,
                                                      size_t *dropped, size_t *kept,
                                                      cw_error *err);

/* What became of components. */
typedef struct cw_drop_counts {
    size_t dropped, kept;  /* components */
    size_t triangles;      /* that went */
    double dropped_mm3;    /* what all that went enclose, together */
    double largest_mm3;    /* the most that one of them does; 0: none went */
    double least_kept_mm3; /* the least that one of the others does; 0: none stayed */
} cw_drop_counts;

/* Leaves out components that enclose less than so much, and then vertices that no triangle
 * names.
 *
 * Each component counts by its own surface, whichever way it faces, with what lies in it: a
 * solid with its cavities, a cavity with the islands in it. What lies in a component encloses
 * less than that, so it goes whenever that does: no cavity is left without its solid, and small
 * cavities are filled. An open component encloses what lies between it and the middle of its
 * box, signed by the side that is seen from there: nothing, where it is flat.
 *
 * mesh     in place, as in cw_mesh_weld()
 * counts   may be NULL
 * Returns  CW_ERR_ARGUMENT  least_mm3 is negative or NaN, or as cw_mesh_check();
 *          CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_mesh_drop_volumes(cw_mesh *mesh, double least_mm3,
                                                   cw_drop_counts *counts, cw_error *err);

/* Leaves out components none of whose vertices is within a distance of something else, and then
 * vertices that no triangle names.
 *
 * mesh         in place, as in cw_mesh_weld()
 * distance_mm  vertex_count: how far each vertex is, 0 or more
 * limit_mm     a component stays when one of its vertices is no farther
 * counts       as in cw_mesh_drop_volumes(); may be NULL
 * farthest_mm  the largest distance of a vertex that went; 0: none went; may be NULL
 * Returns      CW_ERR_ARGUMENT  limit_mm is negative or NaN, or as cw_mesh_check();
 *              CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_mesh_drop_distant(cw_mesh *mesh, const float *distance_mm,
                                                   double limit_mm, cw_drop_counts *counts,
                                                   double *farthest_mm, cw_error *err);

/* A part of a surface that is made from one end to the other: what lies between two parallel
 * planes. Slabs that follow each other have the vertices in the plane between them in common:
 * the n-th with seam 2 in one is the n-th with seam 1 in the next, at the same place. */
typedef struct cw_slab {
    const cw_mesh *mesh; /* without normals; some vertices may be in no triangle */
    const uint8_t *seam; /* vertices: 1 in the plane to the slab before, 2 in the plane to the
                            one after, else 0 */
    double along[3];     /* of the mesh's positions x: all vertices that are in neither plane */
    double low, high;    /* have low < along . x < high; infinite at the ends */
    size_t triangles;    /* of the whole surface */
    bool last;
} cw_slab;

/* Who takes slabs, one after the other; what is not CW_OK ends it, and is what the maker then
 * returns. The slab is the maker's, and gone after the call. */
typedef struct cw_slab_sink {
    cw_status (*take)(void *user, const cw_slab *slab, cw_error *err);
    void *user;
} cw_slab_sink;

#ifdef __cplusplus
}
#endif

#endif
