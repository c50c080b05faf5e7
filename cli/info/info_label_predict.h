/* Predictions of the command info for labels: what `extract --labels` makes of a label map, and what
 * that takes. */
#ifndef CLI_INFO_INFO_LABEL_PREDICT_H
#define CLI_INFO_INFO_LABEL_PREDICT_H

#include "cli/inputs/label_names.h"
#include "cli/inputs/volume_input.h"

#include <cubewright/labels.h>

/* The run of `extract --labels LIST -o FILE` without further options. Zeroed: none. */
typedef struct cli_label_prediction {
    const char *list;           /* of --labels; NULL: nothing is predicted */
    cw_label_prediction counts; /* exact, of all components */
    size_t stl_bytes;           /* exact */
    size_t memory_bytes;        /* of the program, about */
    bool is_streamed;           /* voxels are more than --memory allows */
    bool is_beyond;             /* so are the surfaces: they go to temporary files */
    double seconds;             /* about; without waiting for the disk to write */
} cli_label_prediction;

/* Facts about a run of info that has read its volume. */
typedef struct cli_label_predict_desc {
    const char *list; /* of --labels */
    const cli_input *input;
    const cw_label_table *table;
    size_t program_bytes; /* peak of the process before it read the volume */
    double read_seconds;  /* time that reading took */
} cli_label_predict_desc;

/* Predicts the surfaces of labels.
 *
 * volume   as info read it. If that is only a part of it, its voxels are freed, and all are read, or
 *          come slice by slice
 * Returns  CW_ERR_UNSUPPORTED for a sparse or an irregular grid; as cli_choose_labels();
 *          CW_ERR_EMPTY: no voxel has one of the labels */
CW_NODISCARD cw_status cli_predict_labels(const cli_label_predict_desc *desc,
                                          cli_volume *volume, cli_label_prediction *out,
                                          cw_error *err);

void cli_print_label_prediction(const cli_label_prediction *p);
void cli_json_label_prediction(cli_json *j, const cli_label_prediction *p);

#endif
