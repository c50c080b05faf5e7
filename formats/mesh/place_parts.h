/* Parts of a mesh: splitting a mesh into its parts, and preparing parts for a file, where they
 * are named, placed and stripped of arrays that it cannot hold. */
#ifndef FORMATS_MESH_PLACE_PARTS_H
#define FORMATS_MESH_PLACE_PARTS_H

#include "formats/mesh/mesh_reader.h"
#include "formats/mesh/mesh_writer.h"

/* Fills in the parts with triangles, and their common origin in the file's axes (zeros unless
 * desc->local). Arrays that one part lacks are left out, unless each part may have its own.
 * Free them with cwi_parts_free(). Returns CW_ERR_ARGUMENT as cw_mesh_check(), when no part has
 * triangles, and for parts that no animation can show; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_parts_place(const cw_part *parts, size_t count,
                                       const cw_write_desc *desc, unsigned keeps,
                                       const char *name, cwi_parts *placed, double origin[3],
                                       cw_error *err);
void cwi_parts_free(cwi_parts *parts);

/* Chooses the name of all parts together: that of desc, or that of the only part, or the path's
 * last component without its extension. */
void cwi_choose_name(const char *path, const cw_part *parts, size_t count,
                     const cw_write_desc *desc, char name[CWI_NAME_BYTES]);

/* Returns the arrays that a mesh has, and if it has an affine: cw_keeps flags. */
unsigned cwi_arrays_of(const cw_mesh *mesh);

/* Copies size bytes of text. Everything but printable characters of UTF-8 becomes '_', so that
 * no name can break a line of OBJ, the JSON of glTF, or a terminal. */
void cwi_clean_name(const char *text, size_t size, char name[CWI_NAME_BYTES]);

/* Gives the vertices of a whole mesh the labels of its parts, if each part has one.
 * Returns CW_ERR_NO_MEMORY, and the mesh is emptied */
CW_NODISCARD cw_status cwi_parts_label(const cwi_mesh_input *in, cw_mesh *mesh, cw_error *err);

/* Splits a mesh at its marks. Parts that share vertices are one. A mesh of one part is emptied. The
 * labels of the input move to the parts.
 * Returns CW_ERR_NO_MEMORY, CW_ERR_LIMIT */
CW_NODISCARD cw_status cwi_parts_split(cwi_mesh_input *in, cw_mesh *mesh, cw_part **parts,
                                       size_t *count, cw_error *err);

#endif
