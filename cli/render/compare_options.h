/* A compare split: two modes or settings of one scene, and how far they are apart. */
#ifndef CLI_RENDER_COMPARE_OPTIONS_H
#define CLI_RENDER_COMPARE_OPTIONS_H

#include "cli/render/render_run.h"

/* The arguments of the left and the right picture: those of the run, and then each side's own
 * of
 * --compare 'A|B', which are options by comma without their dashes; the first may be a mode.
 * Returns CW_ERR_ARGUMENT for what is no setting of a picture, does nothing in its mode, or (of
 * the run's) in neither; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cli_parse_split(const cli_command *command, const render_args *args,
                                       cli_split *split, cw_error *err);
void cli_free_split(cli_split *split);

/* Returns true if the difference of the sides is an error: both draw the same thing, or one is
 * its reference. Else it is between two ways to show a volume. */
bool cli_compares_alike(const cli_split *split);

/* The split of two pictures, or both and their difference, and what is measured. */
CW_NODISCARD cw_status cli_draw_split(const cw_picture sides[2], const render_args *args,
                                      const uint8_t background[2][4], cw_comparison *measured,
                                      cw_picture *out, cw_error *err);

#endif
