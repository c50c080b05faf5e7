/* The surfaces of a file as they are looked at: with the pictures on them. */
#ifndef CLI_LOOKS_LOOKS_INPUT_H
#define CLI_LOOKS_LOOKS_INPUT_H

#include "cli/inputs/mesh_input.h"

#include <cubewright/appearance.h>

enum { CLI_LOOKS_MAPS = 3 };

typedef struct cli_looks {
    cw_surface_look *surfaces; /* count of them; owned */
    size_t count;
    cli_mesh parts;                   /* owned; empty where the merged mesh serves */
    cw_image (*maps)[CLI_LOOKS_MAPS]; /* of each surface; owned */
    bool has_maps;
} cli_looks;

/* Finds the surfaces of a mesh file that was read as one mesh: those of its parts where the file has pictures
 * on them, which are decoded; else the mesh itself, which must live as long. Says which pictures are left out,
 * and that a mesh without normals is flat.
 * is_reference  the file was read by cli_read_reference()
 * Returns       as cli_read_parts(), as cw_texture_decode(); free the looks in any case */
CW_NODISCARD cw_status cli_looks_find(const cli_mesh *mesh, bool is_reference,
                                      const char *reader, const cli_input *input,
                                      cli_looks *looks, cw_error *err);
void cli_looks_free(cli_looks *looks);

#endif
