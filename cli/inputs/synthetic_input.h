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

/* A field of 'make': the fields come first, then the label maps and the hard cases. */
typedef struct cli_made_field {
    const char *name, *about;
    double isovalue;
    bool hard, is_label_map;
    size_t number; /* of the field, the label map or the hard case */
} cli_made_field;

/* Fills in the n-th of all that 'make' makes; false after the last. */
bool cli_made_field_at(size_t n, cli_made_field *s);

/* The name most like a word; NULL: none is close. */
const char *cli_nearest_field(const char *word);

#endif
