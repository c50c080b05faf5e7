/* Vertices with one texture coordinate and one normal each. */
#ifndef CORE_TEXTURE_SPLIT_SEAMS_H
#define CORE_TEXTURE_SPLIT_SEAMS_H

#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Places: corners at one vertex with one texture coordinate and one normal have one number. */
typedef struct cwi_texture_seams {
    uint32_t *number; /* corners */
    uint32_t *vertex; /* numbers: the vertex; those below the number of vertices are vertices */
    uint32_t *corner; /* numbers: one of their corners; CWI_NO_CORNER: none */
    size_t count;     /* numbers */
} cwi_texture_seams;

/* Returns the texture coordinates of a mesh: two floats for each corner, or for each vertex; NULL: none. */
const cw_attribute *cwi_texture_of(const cw_mesh *mesh);

/* Returns the normals of the corners of a mesh, three floats each; NULL: none. */
const cw_attribute *cwi_corner_normals_of(const cw_mesh *mesh);

/* Returns true if a vertex may have several texture coordinates or normals. */
bool cwi_has_seams(const cw_mesh *mesh);

/* Gives a mesh texture coordinates, all 0, in place of those that it has.
 * on        CW_ON_CORNERS or CW_ON_VERTICES
 * uv        set to the values
 * Returns   CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_texture_add(cw_mesh *mesh, cw_on on, float (**uv)[2], cw_error *err);

/* Makes a view of a mesh without its texture coordinates. It borrows all but the array of attributes, which
 * is freed with cwi_free().
 * Returns   CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_texture_hide(const cw_mesh *mesh, cw_mesh *view, cw_error *err);

/* Numbers the places of a mesh with seams.
 * Returns  CW_ERR_NO_MEMORY; free with cwi_seams_free() in any case */
CW_NODISCARD cw_status cwi_seams_find(const cw_mesh *mesh, cwi_texture_seams *seams,
                                      cw_error *err);
void cwi_seams_free(cwi_texture_seams *seams);

/* Makes a copy of such a mesh in which each vertex has one texture coordinate and one normal. Triangles keep
 * their order.
 * Returns  CW_ERR_NO_MEMORY; free the copy in any case */
CW_NODISCARD cw_status cwi_split_seams(const cw_mesh *mesh, cw_mesh *copy, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
