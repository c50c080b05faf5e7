/* The attributes of a mesh as one table: normals, scalars, colors and labels, then those of
 * mesh->attributes. What moves, copies or mixes elements of a mesh does so by this table. */
#ifndef CORE_MESH_MESH_ATTRIBUTES_H
#define CORE_MESH_MESH_ATTRIBUTES_H

#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Returns the number of rows, and a row; its data is NULL where the mesh lacks a fixed array. */
size_t cwi_attribute_count(const cw_mesh *mesh);
cw_attribute cwi_attribute_at(const cw_mesh *mesh, size_t n);

/* Returns the bytes of one element, and the number of elements in a mesh. */
size_t cwi_attribute_bytes(const cw_attribute *attribute);
size_t cwi_attribute_elements(const cw_mesh *mesh, cw_on on);

/* Returns true if the mesh has an attribute on one of the kinds: bits 1 << cw_on. */
bool cwi_attributes_any(const cw_mesh *mesh, unsigned on);

/* Returns true if all vertices have the same colour, which is then copied. */
bool cwi_mesh_one_color(const cw_mesh *mesh, uint8_t color[4]);

/* Gives a mesh the attributes of another, for its own numbers of vertices and triangles: all zero, but
 * those of parts are copied. The mesh has none before, and is emptied on failure. */
CW_NODISCARD cw_status cwi_attributes_alloc(const cw_mesh *like, cw_mesh *mesh, cw_error *err);

/* Copies the attributes of a mesh to one that has the same elements and no attributes. */
CW_NODISCARD cw_status cwi_attributes_copy(const cw_mesh *from, cw_mesh *to, cw_error *err);

/* The next four write to meshes that cwi_attributes_alloc() made like `from`. */

/* Gives vertex n of `to` the attributes of vertex v. */
void cwi_attributes_put(const cw_mesh *from, size_t v, cw_mesh *to, size_t n);

/* Gives vertex n of `to` the attributes of some vertices, mixed by weights that add up to 1. */
void cwi_attributes_mix(const cw_mesh *from, const uint32_t *vertices, const double *weights,
                        size_t count, cw_mesh *to, size_t n);

/* Gives triangle n of `to` and its corners the attributes of triangle t. same: as below, of its corners */
void cwi_attributes_put_triangle(const cw_mesh *from, size_t t, const uint32_t same[3],
                                 cw_mesh *to, size_t n);

/* Gives corner c of `to` the attributes that triangle t has there: those of a corner, or else a mixture for
 * the point of t that is closest.
 * same  the vertex of `from` that the corner is; UINT32_MAX: none */
void cwi_attributes_put_corner(const cw_mesh *from, size_t t, uint32_t same, cw_mesh *to,
                               size_t c);

/* --- in place ----------------------------------------------------------------------------- */

/* Moves vertices with positions and attributes to rising numbers; UINT32_MAX drops one. */
void cwi_mesh_move_vertices(cw_mesh *mesh, const uint32_t *number, size_t count);

/* Moves a triangle, with its attributes and those of its corners, over another. */
void cwi_mesh_move_triangle(cw_mesh *mesh, size_t from, size_t to);

/* Swaps two corners of a triangle with their attributes, and so turns its winding. */
void cwi_mesh_swap_corners(cw_mesh *mesh, size_t t, size_t i, size_t j);

/* Appends a copy of another mesh. Attributes that one of both lacks are dropped; parts keep those of
 * the first.
 * Returns  CW_ERR_LIMIT: more than 2^32 - 1 vertices; CW_ERR_NO_MEMORY, and the mesh is emptied */
CW_NODISCARD cw_status cwi_mesh_append(cw_mesh *mesh, const cw_mesh *other, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
