/* Triangle meshes with shared vertices: checks, welding, dropping of components, and slabs. */
#ifndef CUBEWRIGHT_MESH_H
#define CUBEWRIGHT_MESH_H

#include <cubewright/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The elements of a mesh that an attribute has values for. Corner 3 t + k is corner k of triangle t. */
typedef enum cw_on {
    CW_ON_VERTICES,
    CW_ON_CORNERS,
    CW_ON_TRIANGLES,
    CW_ON_PARTS, /* one element: a mesh is a part */
    CW_ON_COUNT
} cw_on;

/* How a value between others is made of them, by weights. Whole numbers are rounded. */
typedef enum cw_interpolation {
    CW_INTERPOLATE_LINEAR,    /* the weighted mean */
    CW_INTERPOLATE_DIRECTION, /* the mean, then of length 1 */
    CW_INTERPOLATE_COLOR,     /* the mean of the stored numbers, sRGB as it is */
    CW_INTERPOLATE_NEAREST, /* the value with the largest weight, the first of equal ones: for ids */
    CW_INTERPOLATE_COUNT
} cw_interpolation;

/* Values on the elements of a mesh, under a name. What welds, drops, cuts, repairs, copies and joins
 * meshes carries them. */
typedef struct cw_attribute {
    char name[32];                  /* ends with 0; no two of a mesh have the same */
    cw_on on;                       /* its elements */
    cw_type type;                   /* of each number */
    uint32_t components;            /* numbers of an element: 1 to 4, or 16 */
    cw_interpolation interpolation; /* between elements */
    void *data;                     /* elements x components; the mesh frees it */
} cw_attribute;

/* The name of the attribute with colours of triangles: CW_ON_TRIANGLES, CW_U8, 4 components, sRGB and
 * linear alpha. Readers make it where a file colours triangles and vertices would get two colours; writers
 * know it. */
#define CW_FACE_COLORS "face_colors"

/* The name of the attribute with normals of corners: CW_ON_CORNERS, CW_F32, 3 components, unit length. Where
 * corners at a vertex differ there is a crease; the normals of vertices stay beside them. Made by
 * cw_mesh_crease_normals(). */
#define CW_CORNER_NORMALS "corner_normals"

/* Vertices and triangles. A zeroed struct is a valid empty mesh. Zero it before a call fills it: the
 * version says which members it has.
 *
 * The world point of vertex v is  origin + positions[3v .. 3v+2], LPS millimetres: positions
 * are small numbers near zero, so single precision keeps micrometres however far the scan
 * stands from the scanner's zero. Triangles wind counter-clockwise seen from outside. */
typedef struct cw_mesh {
    uint32_t version;         /* 0: the first version of this struct */
    double origin[3];         /* world point that is added to all positions, LPS millimetres */
    size_t vertex_count;      /* number of vertices */
    size_t triangle_count;    /* number of triangles */
    float *positions;         /* vertex_count x 3 */
    float *normals;           /* vertex_count x 3, unit length, outward; or NULL */
    uint32_t *triangles;      /* triangle_count x 3, each below vertex_count */
    float *scalars;           /* vertex_count; or NULL */
    uint8_t *colors;          /* vertex_count x 4, sRGB and linear alpha; or NULL */
    uint32_t *labels;         /* vertex_count; or NULL */
    double affine[3][4];      /* of the volume it came from, see cw_volume; all 0: none */
    cw_attribute *attributes; /* attribute_count more, see cw_mesh_attribute_add() */
    size_t attribute_count;   /* number of further attributes */
} cw_mesh;

/* Frees the arrays and zeroes the struct. Harmless on a zeroed or already freed mesh. */
CW_API void cw_mesh_free(cw_mesh *mesh);

/* Adds an attribute whose values are all 0, for the vertices and triangles that the mesh has.
 *
 * mesh     gets one attribute more; unchanged on failure
 * like     its name, elements, type, components and interpolation; its data is not read. The names
 *          normals, scalars, colors and labels are those of the mesh's own arrays
 * out      set to the new row of mesh->attributes, until the next is added or removed; may be NULL
 * Returns  CW_ERR_ARGUMENT: the name is empty, too long or in use, or a field has no such value;
 *          CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_mesh_attribute_add(cw_mesh *mesh, const cw_attribute *like,
                                                    cw_attribute **out, cw_error *err);

/* Returns the attribute of this name, or NULL. The mesh's own arrays are not among them. */
CW_API cw_attribute *cw_mesh_attribute_find(const cw_mesh *mesh, const char *name);

/* Removes the attribute of this name, if there is one, and frees its values.
 * mesh  has one attribute less then; NULL is allowed */
CW_API void cw_mesh_attribute_remove(cw_mesh *mesh, const char *name);

/* Checks the properties that other functions rely on: arrays present, every index below
 * vertex_count, positions finite. Returns CW_ERR_ARGUMENT naming the first error. */
CW_NODISCARD CW_API cw_status cw_mesh_check(const cw_mesh *mesh, cw_error *err);

/* Computes the world box of the vertices. Returns false, and zeros, for a mesh without
 * vertices. */
CW_API bool cw_mesh_bounds(const cw_mesh *mesh, double min[3], double max[3]);

/* Gives the vertices normals from the triangles around them, which wind counter-clockwise seen
 * from outside. A vertex without triangles, or of triangles that have no area or cancel out, gets
 * the direction of z.
 *
 * mesh     its normals are replaced, or added; unchanged on failure
 * Returns  CW_ERR_ARGUMENT as cw_mesh_check(); CW_ERR_NO_MEMORY
 * Source   weights of corners [Max1999] */
CW_NODISCARD CW_API cw_status cw_mesh_normals(cw_mesh *mesh, cw_error *err);

/* Gives corners normals of their own where creases part the triangles around a vertex: those of the triangles
 * on their side of the creases. All others keep the normal of their vertex. A crease is an edge between
 * triangles whose directions differ by more than an angle, or that belong to different regions; triangles
 * without area make none.
 *
 * mesh     gets the attribute CW_CORNER_NORMALS in place of the one that it has, or loses it where nothing is
 *          a crease; without normals it gets those of cw_mesh_normals(), too
 * degrees  the angle, 0 to 180; 180: only between regions
 * regions  triangle_count numbers; NULL: all are of one region
 * creases  set to the number of edges that are one; may be NULL
 * Returns  CW_ERR_ARGUMENT  degrees is out of range, or as cw_mesh_check(); CW_ERR_LIMIT; CW_ERR_NO_MEMORY
 * Source   weights of corners [Max1999] */
CW_NODISCARD CW_API cw_status cw_mesh_crease_normals(cw_mesh *mesh, double degrees,
                                                     const uint8_t *regions, size_t *creases,
                                                     cw_error *err);

/* Moves a mesh by an affine map of the world: scales, turns, mirrors and shifts it. Normals stay upright
 * on the surface; other attributes that are directions turn along. A map that mirrors turns the
 * triangles round, so that the outside stays outside.
 *
 * mesh     in place, with its affine, if it has one; unchanged on failure
 * matrix   3 x 4, row by row: y = A x + t, LPS millimetres
 * Returns  CW_ERR_ARGUMENT  a number is not finite, the determinant of A is 0, vertices would leave
 *                           single precision, or as cw_mesh_check() */
CW_NODISCARD CW_API cw_status cw_mesh_transform(cw_mesh *mesh, const double matrix[12],
                                                cw_error *err);

/* Parts a mesh into its solids: the sets of triangles that are joined by vertices at equal positions. A
 * closed set that faces inward is the cavity of the smallest solid around it, and goes with
 * that. Solids within cavities stay solids of their own.
 *
 * mesh     unchanged
 * solids   set to an array of meshes, with the order of vertices and triangles, the origin, affine and
 *          attributes of the mesh; larger enclosed volumes come first, an open set counting as in
 *          cw_mesh_drop_volumes(). Free it with cw_meshes_free()
 * count    set to their number; 0 for a mesh without triangles
 * Returns  CW_ERR_ARGUMENT as cw_mesh_check(); CW_ERR_LIMIT: more than 2^32 / 3 triangles;
 *          CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_mesh_split(const cw_mesh *mesh, cw_mesh **solids,
                                            size_t *count, cw_error *err);

/* Frees an array of meshes with all that they hold. NULL is allowed. */
CW_API void cw_meshes_free(cw_mesh *meshes, size_t count);

/* Merges vertices at equal positions (0 equals -0) into the first of them, with its normal,
 * colour and other attributes. Texture coordinates of vertices become those of corners, so that seams stay.
 * Triangles that name a vertex twice are left out, and then vertices that no triangle names.
 *
 * mesh     in place: its arrays stay where they are, and only get shorter; unchanged on failure
 * merged   number of vertices at the place of another; may be NULL
 * Returns  CW_ERR_ARGUMENT as cw_mesh_check(); CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_mesh_weld(cw_mesh *mesh, size_t *merged, cw_error *err);

/* Leaves out small components (sets of triangles joined by vertices): those whose box has a
 * diagonal shorter than diagonal_mm. Then leaves out vertices that no triangle names.
 *
 * mesh           in place, as in cw_mesh_weld()
 * diagonal_mm    0 or more
 * dropped, kept  components; may be NULL
 * Returns        CW_ERR_ARGUMENT  diagonal_mm is negative or NaN, or as cw_mesh_check();
 *                CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_mesh_drop_components(cw_mesh *mesh, double diagonal_mm,
                                                      size_t *dropped, size_t *kept,
                                                      cw_error *err);

/* Counts and volumes of dropped and kept components. */
typedef struct cw_drop_counts {
    size_t dropped, kept;  /* components */
    size_t triangles;      /* triangles of the dropped components */
    double dropped_mm3;    /* volume enclosed by all dropped components together */
    double largest_mm3;    /* the largest volume of a dropped component; 0: none dropped */
    double least_kept_mm3; /* the smallest volume of a kept component; 0: none kept */
    size_t cavities;       /* dropped components that are closed and face inward: what they left
                              hollow is solid */
} cw_drop_counts;

/* Leaves out components that enclose less than least_mm3, and then vertices that no triangle
 * names.
 *
 * Each component counts by its own surface, whichever way it faces, with everything that lies
 * in it: a solid with its cavities, a cavity with the islands in it. A component inside another
 * encloses less than the outer one, so it is dropped whenever the outer one is. No cavity is
 * left without its solid, and small cavities are filled. An open component encloses the volume
 * between it and the middle of its box, signed by the side that is seen from there. That is
 * zero where the component is flat.
 *
 * mesh       in place, as in cw_mesh_weld()
 * least_mm3  0 or more
 * counts     may be NULL
 * Returns    CW_ERR_ARGUMENT  least_mm3 is negative or NaN, or as cw_mesh_check();
 *            CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_mesh_drop_volumes(cw_mesh *mesh, double least_mm3,
                                                   cw_drop_counts *counts, cw_error *err);

/* Leaves out all components but those that enclose the largest volumes, and then vertices that no
 * triangle names. Components count as in cw_mesh_drop_volumes(): a cavity is smaller than its solid,
 * and by itself. Of equal ones the first in the mesh stays.
 * mesh     in place, as in cw_mesh_weld()
 * count    of components to keep, 1 or more
 * counts   as in cw_mesh_drop_volumes(); may be NULL
 * Returns  CW_ERR_ARGUMENT  count is 0, or as cw_mesh_check(); CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_mesh_keep_largest(cw_mesh *mesh, size_t count,
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

/* A part of a surface that is made from one end to the other: the part between two parallel
 * planes. Slabs that follow each other share the vertices in the plane between them. The n-th
 * vertex with seam 2 in one slab is the n-th with seam 1 in the next, at the same place. */
typedef struct cw_slab {
    const cw_mesh *mesh; /* without normals; some vertices may be in no triangle */
    const uint8_t *seam; /* one per vertex: 1 in the plane to the slab before, 2 in the plane to
                            the slab after, else 0 */
    double along[3];     /* a direction: all vertices x of the mesh that are in neither plane */
    double low, high;    /* have low < along . x < high; infinite at the ends */
    size_t triangles;    /* of the whole surface */
    bool last;           /* no slab follows */
} cw_slab;

/* A receiver of slabs, one after the other. A status other than CW_OK stops the maker, which
 * then returns it. The slab belongs to the maker and is invalid after the call. */
typedef struct cw_slab_sink {
    /* Takes one slab, on the calling thread. */
    cw_status (*take)(void *user, const cw_slab *slab, cw_error *err);
    void *user; /* passed to take */
} cw_slab_sink;

#ifdef __cplusplus
}
#endif

#endif
