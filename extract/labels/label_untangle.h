/* Puts vertices back where smoothing made triangles cross, and keeps volumes meanwhile. */
#ifndef EXTRACT_LABELS_LABEL_UNTANGLE_H
#define EXTRACT_LABELS_LABEL_UNTANGLE_H

#include "extract/labels/label_crossings.h"
#include "extract/labels/label_pressures.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Puts vertices of triangles that cross others, or that have no area, back to their positions before
 * smoothing, until there are none: those positions make none. Labels that lose volume by that get it
 * back from vertices that were not put back.
 * crossings  its first block is set; free it also after an error
 * mesh       that of `crossings`, in the world
 * pressures  that smoothed the mesh; NULL: volumes are not kept
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_labels_untangle(cwi_label_crossings *crossings, cw_mesh *mesh,
                                           cwi_label_pressures *pressures,
                                           const cw_labels_desc *desc, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
