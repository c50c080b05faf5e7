/* Fields of labels in one grid, and the map of the largest. */
#ifndef EXTRACT_LABEL_SCORES_LARGEST_FIELD_H
#define EXTRACT_LABEL_SCORES_LARGEST_FIELD_H

#include <cubewright/labels.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A label, and the number of its field. */
typedef struct cwi_label_channel {
    uint32_t label, field;
} cwi_label_channel;

/* Fields, checked and with all defaults. */
typedef struct cwi_label_scores {
    size_t count;
    cw_volume *volumes;          /* count, resolved */
    uint32_t *labels;            /* count, of fields */
    cwi_label_channel *by_label; /* count, by rising label */
    cw_background_rule rule;
    double value; /* with CW_BACKGROUND_VALUE */
    uint32_t background;
    cw_volume
        map; /* label of the largest field of each voxel, packed; its coordinates are borrowed */
    float *rest; /* with CW_BACKGROUND_REST: of each voxel */
} cwi_label_scores;

/* Checks fields and makes their map. Close it also after an error.
 * Returns  as cw_extract_label_scores() */
CW_NODISCARD cw_status cwi_label_scores_open(cwi_label_scores *f, const cw_label_scores *fields,
                                             uint32_t background, int threads,
                                             const cw_progress *progress, cw_error *err);
void cwi_label_scores_close(cwi_label_scores *f);

/* The field of a label without one: the background's value, or its rest. */
#define CWI_NO_FIELD UINT32_MAX

/* Finds the field of a label of the map. */
uint32_t cwi_label_score_of(const cwi_label_scores *f, uint32_t label);

/* Returns a label of the map. */
uint32_t cwi_label_scores_label(const cwi_label_scores *f, const size_t at[3]);

/* Returns the value of a field, or of what stands for the background, at a voxel; NaN: none. */
double cwi_label_score_value(const cwi_label_scores *f, uint32_t field, const size_t at[3]);

#ifdef __cplusplus
}
#endif

#endif
