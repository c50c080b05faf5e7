/* Surfaces whose parts have other textures. */
#ifndef CORE_TEXTURE_SEPARATE_TEXTURES_H
#define CORE_TEXTURE_SEPARATE_TEXTURES_H

#include <cubewright/mesh.h>

/* Gives triangles with different textures vertices of their own.
 * textures  triangles: the number of theirs
 * Returns   CW_ERR_LIMIT, CW_ERR_NO_MEMORY, and the mesh stays as it was */
CW_NODISCARD cw_status cwi_separate_textures(cw_mesh *mesh, const uint32_t *textures,
                                             cw_error *err);

#endif
