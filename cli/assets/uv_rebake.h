/* The option --rebake of the command uv: pictures of a textured mesh, carried over to another texture. */
#ifndef CLI_ASSETS_UV_REBAKE_H
#define CLI_ASSETS_UV_REBAKE_H

#include "cli/inputs/mesh_input.h"

#include <cubewright/bake.h>

/* A textured mesh, and what its pictures became. Zero it. */
typedef struct cli_rebake {
    cli_mesh old;
    uint8_t *png[CW_PICTURE_USES]; /* owned */
    cw_bake_facts facts;
} cli_rebake;

/* Reads the textured mesh.
 * Returns  CW_ERR_ARGUMENT  it has no pictures */
CW_NODISCARD cw_status cli_rebake_read(const char *path, const cli_input *input,
                                       cli_rebake *rebake, cw_error *err);

/* Bakes the pictures into the texture of a mesh, and puts them among its textures. Pictures that cannot be decoded
 * are left out, by name. */
CW_NODISCARD cw_status cli_rebake_run(cli_rebake *rebake, const cw_mesh *mesh,
                                      const cw_bake_desc *desc, cw_textures *textures,
                                      cw_error *err);

void cli_rebake_free(cli_rebake *rebake);

#endif
