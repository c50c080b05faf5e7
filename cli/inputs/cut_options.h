/* Describes cuts by a plane: as they are typed, for people, and for the report. */
#ifndef CLI_INPUTS_CUT_OPTIONS_H
#define CLI_INPUTS_CUT_OPTIONS_H

#include "cli/framework/json_writer.h"
#include "cli/framework/options.h"
#include "cli/inputs/filter_options.h"
#include "cli/inputs/mesh_input.h"

#include <cubewright/cut.h>

/* Returns the settings of --cut-plane. */
cw_cut_desc cli_cut_desc(const cli_plane *plane);

/* Cuts all parts of a mesh that was read, by one plane, and says so. Vertices at equal positions are
 * merged first. Parts of which nothing is left stay as empty ones.
 * Returns  CW_ERR_EMPTY also when nothing is left of any */
CW_NODISCARD cw_status cli_cut_parts(const cli_plane *plane, cli_mesh *mesh,
                                     cw_cut_facts *facts, cw_error *err);

/* Says what a cut did to what is at a path. */
void cli_tell_cut(const char *path, const cli_plane *plane, const cw_cut_facts *facts);

/* Writes the object "cut". */
void cli_json_cut(cli_json *j, const cw_cut_facts *facts);

#endif
