/* What can be known of an output before the work is done. */
#ifndef CLI_OUTPUT_H
#define CLI_OUTPUT_H

#include <cubewright/core.h>

/* Fails when the output is one of the inputs, by any name. */
cw_status cli_check_output(const char *output, const char *const *inputs, size_t input_count,
                           cw_error *err);

#endif
