/* Layers for the segments of a segmentation: those that overlap are in different ones. */
#ifndef FORMATS_DICOM_DICOM_OVERLAP_H
#define FORMATS_DICOM_DICOM_OVERLAP_H

#include "formats/volume/slice_stack.h"

enum { CWI_DICOM_MAX_LAYERS = 16, CWI_DICOM_SEGMENTS = 65536 };

/* Puts each segment of a stack into the first layer in which it overlaps none before it. Layers
 * become components of the stack's shape, and its slots go to their planes.
 *
 * layer_of  CWI_DICOM_SEGMENTS, zeroed: filled with the layer of each segment
 * Returns   CW_ERR_LIMIT for more than CWI_DICOM_MAX_LAYERS; as cwi_stack_read_plane();
 *           CW_ERR_NO_MEMORY, CW_ERR_CANCELLED
 * Cost      all planes are read once, unless no two segments have a plane at one place; 2 bytes a
 *           voxel */
CW_NODISCARD cw_status cwi_dicom_find_layers(cwi_stack *stack, const cwi_input *in,
                                             cwi_planes *planes, const cw_read_desc *desc,
                                             uint8_t *layer_of, cw_error *err);

#endif
