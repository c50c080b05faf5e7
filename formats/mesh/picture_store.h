/* The pictures of a mesh file while it is read: each is read once, by its name. */
#ifndef FORMATS_MESH_PICTURE_STORE_H
#define FORMATS_MESH_PICTURE_STORE_H

#include "formats/mesh/mesh_reader.h"

/* Finds a picture by its name. Returns NULL where it was not read yet. */
const cw_texture *cwi_picture_find(const cwi_pictures *pictures, const char *name);

/* Adds a picture.
 * bytes    from cwi_alloc_array(); taken, and freed on failure
 * Returns  as cwi_mesh_grow() */
CW_NODISCARD cw_status cwi_picture_add(cwi_mesh_input *in, const char *name, uint8_t *bytes,
                                       size_t size, cw_texture *picture, cw_error *err);

/* Reads the picture of a file beside the mesh, or finds it. One that is missing, empty or outside of the
 * folder is passed over, since shapes do not depend on it: in->pictures.is_missing is set.
 * picture  unchanged where there is none
 * Returns  CW_ERR_LIMIT, CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_picture_read(cwi_mesh_input *in, const char *name,
                                        cw_texture *picture, cw_error *err);

/* Returns true if a set has a picture. */
bool cwi_textures_any(const cw_textures *set);

/* Adds a set of pictures. number: set to its number, from 1 on; 0 where the set has none */
CW_NODISCARD cw_status cwi_textures_add(cwi_mesh_input *in, const cw_textures *set,
                                        uint32_t *number, cw_error *err);

void cwi_pictures_free(cwi_pictures *pictures);

#endif
