/* The labels that an option such as --labels chooses: all, numbers, ranges of numbers, and
 * names; and the limit of their smoothing. */
#ifndef CLI_INPUTS_LABEL_CHOICE_H
#define CLI_INPUTS_LABEL_CHOICE_H

#include "cli/inputs/label_names.h"

/* A label that was chosen, by a number for every layer or by its name in one. */
typedef struct cli_chosen_label {
    uint32_t value, layer; /* value: of voxels; UINT32_MAX: none has the label */
    uint64_t id;           /* as in cw_label */
    bool is_negative;
    bool of_all_layers;
    bool is_found; /* it has voxels */
} cli_chosen_label;

typedef struct cli_label_choice {
    bool all;
    size_t count, capacity;
    cli_chosen_label *labels;
} cli_label_choice;

/* Resolves the text: "all", or a list such as "1,5,7-9,Liver,left-*". Names are those of the
 * table, as patterns of the shell and in lower or upper case.
 * option   begins the messages: "--labels"
 * table    may be empty; then no name is known
 * ids      numbers of the volume's labels, which the text states
 * choice   free it with cli_free_label_choice(), also after failure
 * Returns  CW_ERR_ARGUMENT  an item is neither, or is the background, 0; a name is not in the
 *          table, with the nearest; a range is too long; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cli_choose_labels(const char *option, const char *text,
                                         const cw_label_table *table, const cw_label_ids *ids,
                                         cli_label_choice *choice, cw_error *err);
void cli_free_label_choice(cli_label_choice *choice);

/* Lists the values that were chosen in a layer: count of them, to be freed with free(). Returns
 * CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cli_labels_of_layer(const cli_label_choice *choice, uint32_t layer,
                                           uint32_t **values, size_t *count, cw_error *err);

/* Marks a label as found. */
void cli_mark_found(cli_label_choice *choice, uint32_t layer, uint32_t value);

/* Lists the labels that were chosen and not found, as "7 (Liver), 9 (label_9)", as far as there
 * is room. Returns their number. */
size_t cli_list_missing(const cli_label_choice *choice, const cw_label_table *table, char *list,
                        size_t size);

/* Converts --smooth-labels to the bound of the library, in voxels: 0 for "off", the default if it was
 * not given. A length bounds the displacement along each axis of the grid. CW_ERR_ARGUMENT */
CW_NODISCARD cw_status cli_find_label_move(const cli_length *length, const double spacing[3],
                                           double *max_move, cw_error *err);

#endif
