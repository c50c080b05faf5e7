/* Smoothing of the interfaces of a label map, all at once. */
#ifndef EXTRACT_LABELS_LABEL_SMOOTH_H
#define EXTRACT_LABELS_LABEL_SMOOTH_H

#include <cubewright/labels.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Flags of a vertex's kind. */
enum {
    CWI_NET_FIXED = 0x40, /* in a cube with more than one vertex: it stays */
    CWI_NET_BACK = 0x80   /* put back to where it was before smoothing */
};

/* The vertices that a vertex is smoothed with: those of the cubes beside its own. */
typedef struct cwi_label_net {
    uint32_t (*neighbours)[6]; /* below and above along each axis: x-, y-, z-, x+, y+, z+;
                                  UINT32_MAX: none */
    uint8_t *kinds;            /* bit n: three labels or more meet on the way to neighbour n;
                                  and flags */
} cwi_label_net;

/* Smooths places, counted in voxels, of the vertices of surfaces->mesh. Volumes of labels become
 * those of their voxels, unless borders are open; no vertex moves farther than desc->max_move
 * along an axis.
 * originals  the places before; dim: of the volume
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_labels_smooth(const cwi_label_net *net, const float *originals,
                                         cw_label_surfaces *surfaces,
                                         const cw_labels_desc *desc, const size_t dim[3],
                                         cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
