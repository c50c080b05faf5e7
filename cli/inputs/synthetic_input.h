/* A field of 'make' as commands use a volume. */
#ifndef CLI_INPUTS_SYNTHETIC_INPUT_H
#define CLI_INPUTS_SYNTHETIC_INPUT_H

#include "cli/inputs/volume_input.h"

#include <cubewright/field.h>

/* Samples it in single precision. input  for its threads and memory; path is left to the
 * caller. Free with cli_free_volume(). Errors as cw_field_sample() */
CW_NODISCARD cw_status cli_make_field(cw_field field, const size_t dim[3],
                                      const cli_input *input, cli_volume *volume,
                                      cw_error *err);

/* The name most like a word; NULL: none is close. */
const char *cli_nearest_field(const char *word);

#endif
