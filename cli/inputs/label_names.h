/* Finds the names and colours of a volume's labels: in a file that --names states, in the volume
 * itself, or in a file beside it. */
#ifndef CLI_INPUTS_LABEL_NAMES_H
#define CLI_INPUTS_LABEL_NAMES_H

#include "cli/inputs/volume_input.h"

#include <cubewright/label_table.h>

typedef struct cli_label_names {
    cw_label_table table;
    const char *format; /* of the table's file: "freesurfer"; NULL: no names were found, or they
                           are in the volume */
    char *path;         /* of that file; NULL: none */
} cli_label_names;

enum { CLI_LABEL_NAME = 256 };

/* Finds the names, and says which were taken. path: of --names; NULL: as the volume has them.
 * The volume's own table is moved. Free them with cli_free_label_names().
 * Returns as cw_label_table_read() for a file that was stated. A file beside the volume that
 * cannot be read is named and ignored. */
CW_NODISCARD cw_status cli_find_label_names(const char *path, cli_volume *volume,
                                            cli_label_names *names, cw_error *err);
void cli_free_label_names(cli_label_names *names);

/* Completes a label of a volume: its name, which is "label_7" where the table has none, and a
 * colour. The result borrows from the table and from `name`. */
cw_label cli_complete_label(const cw_label_table *table, uint32_t layer, uint32_t value,
                            char name[CLI_LABEL_NAME]);

#endif
