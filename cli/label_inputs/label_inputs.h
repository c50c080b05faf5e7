/* The fields of --probabilities: one a label, in the components and time steps of one input or in several. */
#ifndef CLI_LABEL_INPUTS_LABEL_INPUTS_H
#define CLI_LABEL_INPUTS_LABEL_INPUTS_H

#include "cli/inputs/volume_input.h"

#include <cubewright/label_table.h>
#include <cubewright/labels.h>

/* Fields as the library takes them, in the order of inputs, then of time steps, then of components. */
typedef struct cli_label_fields {
    cli_volume *more; /* the inputs behind the first */
    size_t more_count;
    cw_volume *views; /* of fields, as many as `scores` has */
    const char **names;
    cw_label_scores scores;
} cli_label_fields;

/* Parses the text of --probabilities: sets the rule for the background. Returns CW_ERR_ARGUMENT */
CW_NODISCARD cw_status cli_parse_probabilities(const char *text, cw_label_scores *scores,
                                               cw_error *err);

/* Reads the inputs into memory, and says what they are.
 * first    filled with the first input; free it with cli_free_volume()
 * fields   free them with cli_free_label_fields(), also after an error
 * Returns  CW_ERR_ARGUMENT: the text, or the only field is the background's; as cli_read_volume() */
CW_NODISCARD cw_status cli_read_label_fields(const char *text, const cli_common *common,
                                             const cli_input *options, cli_volume *first,
                                             cli_label_fields *fields, cw_error *err);
void cli_free_label_fields(cli_label_fields *fields);

/* Adds the names of files to a table, where each of several inputs has one field. */
CW_NODISCARD cw_status cli_name_label_fields(const cli_label_fields *fields,
                                             cw_label_table *table, cw_error *err);

#endif
