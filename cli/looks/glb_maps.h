/* Normal maps of binary glTF files. */
#ifndef CLI_LOOKS_GLB_MAPS_H
#define CLI_LOOKS_GLB_MAPS_H

#include "cli/inputs/mesh_input.h"

/* The normal map of a file, which its parts share. */
typedef struct cli_glb_maps {
    cw_textures textures; /* bytes in `file` */
    uint8_t *file;        /* owned */
} cli_glb_maps;

/* Gives the parts of a file their texture coordinates and its normal map, where it is a GLB with one normal
 * map, in PNG or JPEG, and with a primitive of uncompressed texture coordinates for each part. Other files stay
 * without.
 * Returns CW_ERR_IO, CW_ERR_NO_MEMORY; free the maps in any case */
CW_NODISCARD cw_status cli_glb_maps_read(cli_mesh *parts, cli_glb_maps *maps, cw_error *err);
void cli_glb_maps_free(cli_glb_maps *maps);

#endif
