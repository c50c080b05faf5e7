/* Isovalues that are named, such as otsu or bone: their numbers for a volume. */
#ifndef CLI_INPUTS_LEVEL_CHOICE_H
#define CLI_INPUTS_LEVEL_CHOICE_H

#include "cli/inputs/volume_input.h"

/* Turns the names of isovalues into numbers, and says them. Values are those of the view: the voxels
 * that are read, all in memory or slice by slice. Numbers stay as they are.
 * input    how the volume was read
 * Returns  CW_ERR_ARGUMENT for bone, skin, soft, lung or metal without Hounsfield units;
 *          CW_ERR_EMPTY when no isovalue parts the values; or why they cannot be read */
CW_NODISCARD cw_status cli_choose_levels(const cli_volume *volume, const cli_input *input,
                                         cli_numbers *levels, cw_error *err);
CW_NODISCARD cw_status cli_choose_level(const cli_volume *volume, const cli_input *input,
                                        cli_number *level, cw_error *err);

/* Chooses the isovalue where none was given: of level sets 0, else by Otsu.
 * how  set to a word for it
 * Returns as cli_choose_level() */
CW_NODISCARD cw_status cli_find_level(const cli_volume *volume, const cli_input *input,
                                      double *iso, const char **how, cw_error *err);

#endif
