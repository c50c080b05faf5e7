/* The labels of a label map, as the command info tells them. */
#ifndef CLI_INFO_INFO_LABELS_H
#define CLI_INFO_INFO_LABELS_H

#include "cli/framework/json_writer.h"
#include "cli/inputs/label_names.h"

#include <cubewright/labels.h>

/* A label of one component of the volume. */
typedef struct cli_counted_label {
    uint32_t value, layer;
    size_t voxels;
} cli_counted_label;

/* Zeroed: no label map. */
typedef struct cli_label_facts {
    bool is_label_map;
    cli_label_names names;
    cli_counted_label *labels; /* rising, by layers */
    size_t count;
} cli_label_facts;

/* Finds if a volume is a label map and, if so, counts its labels and finds their names. Free the
 * facts with cli_free_label_facts(), also after failure. Returns CW_ERR_NO_MEMORY, and as
 * cli_find_label_names(). */
CW_NODISCARD cw_status cli_find_label_facts(const char *names_path, cli_volume *volume,
                                            cli_label_facts *facts, cw_error *err);
void cli_free_label_facts(cli_label_facts *facts);

/* is_sampled: counts are of the rows that were read. */
void cli_print_label_facts(const cli_label_facts *facts, bool is_sampled);
void cli_json_label_facts(cli_json *j, const cli_label_facts *facts);

#endif
