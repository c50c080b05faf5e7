/* Smoothing of the interfaces of a label map, all at once. */
#ifndef EXTRACT_LABELS_LABEL_SMOOTH_H
#define EXTRACT_LABELS_LABEL_SMOOTH_H

#include "extract/labels/label_net.h"

#include <cubewright/labels.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Places that arrays of originals and of the mesh have beyond those of its vertices. */
enum { CWI_SPARE_POSITIONS = 2 };

/* Smooths places, counted in voxels, of the vertices of surfaces->mesh. No vertex moves farther than
 * desc->max_move along an axis.
 * context    the pressures (cwi_label_pressures) of the surfaces, whose moves have the positions of
 *            surfaces->mesh as places; NULL: volumes are not kept
 * net        finished; its neighbours are changed
 * originals  the places before; dim: of the volume; desc->max_move: the bound itself
 * spare      memory for as many places
 * Returns  CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_labels_smooth(void *context, cwi_label_net *net,
                                         const float *originals, float *spare,
                                         cw_label_surfaces *surfaces,
                                         const cw_labels_desc *desc, const size_t dim[3],
                                         cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
