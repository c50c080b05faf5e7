/* Parts of a mesh: out of a file, and on their way into one, where they are named, placed and
 * stripped of what it cannot hold. */
#ifndef FORMATS_MESH_PLACE_PARTS_H
#define FORMATS_MESH_PLACE_PARTS_H

#include "formats/mesh/mesh_reader.h"
#include "formats/mesh/mesh_writer.h"

/* Fills in the parts with triangles, and the origin that all of them count from, as the file
 * counts it (zeros unless desc->local). Unless each may have arrays of its own, those that one
 * of them lacks are left out. Free them with cwi_parts_free(). Returns CW_ERR_ARGUMENT as
 * cw_mesh_check(), and when no part has triangles, and for parts that no
 * animation can show; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_parts_place(const cw_part *parts, size_t count,
                                       const cw_write_desc *desc, unsigned keeps,
                                       const char *name, cwi_parts *placed, double origin[3],
                                       cw_error *err);
void cwi_parts_free(cwi_parts *parts);

/* The name that desc gives to all parts together, or that of the only one, or the path's last
 * part without its extension. */
void cwi_choose_name(const char *path, const cw_part *parts, size_t count,
                     const cw_write_desc *desc, char name[CWI_NAME_BYTES]);

/* What a mesh has of arrays, and whether an affine: cw_keeps flags. */
unsigned cwi_arrays_of(const cw_mesh *mesh);

/* Copies size bytes of text; what is not a printable character of UTF-8 becomes '_', so that no
 * name can break a line of OBJ, the JSON of glTF, or a terminal. */
void cwi_clean_name(const char *text, size_t size, char name[CWI_NAME_BYTES]);

/* Takes a mesh that was read apart where its marks say. Parts that share vertices are one. A
 * mesh of one part is emptied. Returns CW_ERR_NO_MEMORY, CW_ERR_LIMIT */
CW_NODISCARD cw_status cwi_parts_split(const cwi_mesh_input *in, cw_mesh *mesh, cw_part **parts,
                                       size_t *count, cw_error *err);

#endif
