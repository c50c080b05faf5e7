/* The values of a volume inside of meshes, as the command info tells them. */
#ifndef CLI_INFO_INFO_WITHIN_H
#define CLI_INFO_INFO_WITHIN_H

#include "cli/voxels/solid_input.h"

/* Values inside of each part of a mesh file. Zeroed: none was asked for. */
typedef struct cli_within {
    cli_solids solids;
    cw_within *values; /* of each solid */
} cli_within;

/* Measures a volume inside of each part of a mesh. Free it with cli_free_within(), also after failure. Returns as
 * cli_read_solids() and cw_volume_within(); errors name the mesh. */
CW_NODISCARD cw_status cli_find_within(const char *path, const cli_input *input,
                                       const cli_volume *volume, cli_within *within,
                                       cw_error *err);
void cli_free_within(cli_within *within);

void cli_print_within(const cli_within *within);
void cli_json_within(cli_json *j, const cli_within *within);

#endif
