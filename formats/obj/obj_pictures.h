/* The pictures of textures that are written beside an OBJ file. */
#ifndef FORMATS_OBJ_OBJ_PICTURES_H
#define FORMATS_OBJ_OBJ_PICTURES_H

#include "formats/mesh/mesh_writer.h"

/* Returns the number of a part's textures among those of all parts, from 1 on. */
size_t cwi_obj_textures(const cwi_parts *parts, const cwi_part *part);

/* Writes a material for each set of textures, and the files of their pictures. A file is named by the
 * mesh's stem and its use, with a number where a file of that name has other bytes: none is written over.
 * stem     path of the mesh without its extension; its part behind `name` is what materials say
 * Returns  CW_ERR_OUTPUT, CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_obj_write_textures(const cwi_parts *parts, cwi_mesh_output *out,
                                              const char *stem, cw_error *err);

#endif
