/* Places of a label map's vertices between fields. */
#ifndef EXTRACT_LABEL_SCORES_FIELD_PLACES_H
#define EXTRACT_LABEL_SCORES_FIELD_PLACES_H

#include "extract/label_scores/largest_field.h"
#include "extract/labels/extract_labels.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A cwi_label_move. context: the cwi_label_scores */
CW_NODISCARD cw_status cwi_label_scores_place(void *context, cwi_label_net *net,
                                              const float *originals, float *spare,
                                              cw_label_surfaces *surfaces,
                                              const cw_labels_desc *desc, const size_t dim[3],
                                              cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
