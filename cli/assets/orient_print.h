/* Turning a mesh to the orientation that prints with the least support. */
#ifndef CLI_ASSETS_ORIENT_PRINT_H
#define CLI_ASSETS_ORIENT_PRINT_H

#include "cli/framework/options.h"
#include "cli/inputs/mesh_input.h"

#include <cubewright/print.h>

/* Row of a command whose struct has a cli_number at `row`. */
#define CLI_ORIENT_PRINT_OPTION(row)                                                                          \
    {                                                                                                         \
        "orient-print", 0, CLI_NUMBER, "auto/DEG",                                                            \
            "Turn to the pose that prints with the least support: overhangs beyond 45 degrees, or DEG (off)", \
            row                                                                                               \
    }

/* Refuses an angle out of range. */
CW_NODISCARD cw_status cli_check_orient(const cli_number *angle, cw_error *err);

/* Turns all parts of a mesh together, and says how it stands then and how it stood.
 * angle   auto, or the degrees from the vertical beyond which surfaces need support
 * facts   filled
 * Returns  as cw_orient_print(); errors name the file */
CW_NODISCARD cw_status cli_orient_for_print(const cli_number *angle, int threads,
                                            cli_mesh *mesh, cw_orient_facts *facts,
                                            cw_error *err);

/* Writes the object "orient_print". */
void cli_json_orient(cli_json *j, const cw_orient_facts *facts);

#endif
