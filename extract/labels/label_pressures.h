/* Pressures that give labels the volumes of their voxels. */
#ifndef EXTRACT_LABELS_LABEL_PRESSURES_H
#define EXTRACT_LABELS_LABEL_PRESSURES_H

#include "extract/labels/label_net.h"

#include <cubewright/labels.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Moves vertices, counted in voxels, until labels have the volumes of their voxels: each interface
 * along its normal, by the difference of its two labels' pressures. No vertex moves farther than
 * desc->max_move from its first place along an axis.
 * net        finished; its neighbours are no longer needed, and give their memory
 * originals  the places before; dim: of the volume
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_labels_keep_volumes(cwi_label_net *net, const float *originals,
                                               cw_label_surfaces *surfaces,
                                               const cw_labels_desc *desc, const size_t dim[3],
                                               cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
