/* Removal of crossings that smoothing made. */
#ifndef EXTRACT_LABELS_LABEL_UNTANGLE_H
#define EXTRACT_LABELS_LABEL_UNTANGLE_H

#include "extract/labels/label_crossings.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Puts vertices back to where they were, until no triangles cross and none is without area; none
 * did before smoothing.
 * net        finished; kinds get CWI_NET_BACK
 * originals  positions counted in voxels, which to_point() turns into points of the mesh
 * Returns    CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_labels_untangle(cw_label_surfaces *surfaces, cwi_label_net *net,
                                           const float *originals, cwi_label_to_point *to_point,
                                           const void *context, const cw_labels_desc *desc,
                                           cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
