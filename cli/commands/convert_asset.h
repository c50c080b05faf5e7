/* The profiles game, web and mobile of the command convert. */
#ifndef CLI_COMMANDS_CONVERT_ASSET_H
#define CLI_COMMANDS_CONVERT_ASSET_H

#include "cli/assets/asset_profile.h"
#include "cli/commands/mesh_command.h"

/* Makes the levels of detail of a profile from the mesh that was read as one part, with texture coordinates
 * and maps, and writes them.
 * pivot    as of cli_placing
 * degrees  of creases; 0: normals do not part */
CW_NODISCARD cw_status cli_convert_asset(cli_mesh_run *run, const cli_asset *asset, int pivot,
                                         double degrees, cw_error *err);

#endif
