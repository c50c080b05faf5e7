/* The levels of an image in several sizes, as the command info tells them. */
#ifndef CLI_INFO_INFO_SCALES_H
#define CLI_INFO_INFO_SCALES_H

#include "cli/framework/json_writer.h"

#include <cubewright/formats.h>

/* The levels; zeroed: the file holds its volume once. Free them with cw_levels_free(). */
typedef struct cli_scales {
    cw_level *levels;
    size_t count;
    size_t chosen; /* the one that is read */
} cli_scales;

/* Finds the levels of a file. Returns as cw_levels_list(). */
CW_NODISCARD cw_status cli_find_scales(const char *path, const cw_read_desc *desc,
                                       cli_scales *scales, cw_error *err);

void cli_print_scales(const cli_scales *scales);
void cli_json_scales(cli_json *j, const cli_scales *scales);

#endif
