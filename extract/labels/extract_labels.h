/* The extraction of labels with any smoothing. */
#ifndef EXTRACT_LABELS_EXTRACT_LABELS_H
#define EXTRACT_LABELS_EXTRACT_LABELS_H

#include "extract/labels/label_net.h"

#include <cubewright/labels.h>
#include <cubewright/stream.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Moves vertices, as cwi_labels_smooth(). */
typedef cw_status cwi_label_move(void *context, cwi_label_net *net, const float *originals,
                                 float *spare, cw_label_surfaces *surfaces,
                                 const cw_labels_desc *desc, const size_t dim[3],
                                 cw_error *err);

/* A function that moves vertices, and what it is given. */
typedef struct cwi_label_smoother {
    cwi_label_move *move;
    void *context;
} cwi_label_smoother;

/* Extracts labels as cw_extract_labels(), but moves vertices by the given function. Then volumes of
 * voxels are not kept. Vertices of triangles that cross go back as ever. A vertex that shares its cube
 * stays inside of its tetrahedra, of which proofs make use. */
CW_NODISCARD cw_status cwi_extract_labels_with(const cw_volume *volume,
                                               const cw_labels_desc *desc,
                                               const cwi_label_smoother *smooth,
                                               cw_label_surfaces *surfaces, cw_error *err);

/* Extracts labels as cw_extract_labels_stream(). chunks: of its window; 0: as many as fit */
CW_NODISCARD cw_status cwi_extract_labels_windowed(const cw_slice_source *source, size_t chunks,
                                                   const cw_labels_desc *desc,
                                                   cw_label_surfaces *surfaces, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
