/* The row of the command voxelize. */
#ifndef CLI_VOXELS_CMD_VOXELIZE_H
#define CLI_VOXELS_CMD_VOXELIZE_H

#include "cli/framework/commands.h"

extern const cli_command cli_voxelize;

#endif
