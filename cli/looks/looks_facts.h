/* How alike two surfaces look, as people and programs read it; and limits of that. */
#ifndef CLI_LOOKS_LOOKS_FACTS_H
#define CLI_LOOKS_LOOKS_FACTS_H

#include "cli/framework/json_writer.h"

#include <cubewright/appearance.h>

/* Limits of how different surfaces may look; 0: none. */
typedef struct cli_looks_limit {
    double max_delta_e; /* mean CIEDE2000 */
    double min_psnr_db;
} cli_looks_limit;

/* Parses "none", or a list of limits: 2 is the largest mean CIEDE2000, 25dB the lowest PSNR.
 * Returns CW_ERR_ARGUMENT for other texts. */
CW_NODISCARD cw_status cli_looks_parse(const char *text, cli_looks_limit *limit, cw_error *err);

/* Fails with CW_ERR_CHECK for looks that differ more than the limit allows, and says by how much. */
CW_NODISCARD cw_status cli_looks_hold(const cli_looks_limit *limit, const cw_appearance *looks,
                                      cw_error *err);

enum { CLI_LOOKS_TEXT = 120 };

/* Prints the figures in words.
 * without  as below */
void cli_looks_text(const cw_appearance *with, const cw_appearance *without,
                    char text[CLI_LOOKS_TEXT]);

/* Prints a table: a line with maps, one without them if there are some, and the worst view.
 * without  NULL: there are no maps */
void cli_looks_print(const cw_appearance *with, const cw_appearance *without);

enum { CLI_LOOKS_NAME = 24 };

/* Returns a text such as "az105_el-39", in `name`. */
const char *cli_looks_view_name(const cw_appearance_view *view, char name[CLI_LOOKS_NAME]);

/* Writes "looks": `all`, `without_maps` if there are some, the `worst` view, and `views`. */
void cli_looks_json(cli_json *j, const cw_appearance *with, const cw_appearance *without);

#endif
