/* Smooths parts that share vertices, as one surface. */
#ifndef CLI_COMMANDS_SMOOTH_TOGETHER_H
#define CLI_COMMANDS_SMOOTH_TOGETHER_H

#include "cli/results/mesh_parts.h"

#include <cubewright/smooth.h>

/* Returns true if vertices of several pieces are at the same place. CW_ERR_NO_MEMORY counts as none;
 * smoothing then fails for the same reason. */
bool cli_share_vertices(const cli_pieces *pieces);

/* Smooths all pieces as one mesh, with triangles of several once, and takes the places over. Their
 * `out` are copies of the input.
 * facts    of the one mesh
 * Returns  as cw_mesh_smooth() */
CW_NODISCARD cw_status cli_smooth_together(cli_pieces *pieces, const cw_smooth_desc *desc,
                                           cw_smooth_facts *facts, cw_error *err);

#endif
