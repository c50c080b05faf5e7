/* Layers of a label map as 32-bit labels, with a border of one voxel around. */
#ifndef EXTRACT_LABELS_LABEL_LAYERS_H
#define EXTRACT_LABELS_LABEL_LAYERS_H

#include "core/volume/key_counts.h"

#include <cubewright/labels.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cwi_label_layers {
    const cw_volume *volume; /* resolved */
    size_t first_slice;      /* at the volume's data; those below are not in memory */
    uint32_t background;
    bool copies_border;        /* the border has the labels beside it, not the background */
    size_t width, height;      /* of a layer with its border */
    size_t count;              /* of layers with the border's */
    size_t requested_count;    /* 0: all labels */
    const uint32_t *requested; /* rising */
} cwi_label_layers;

/* Loads layer k, counted with the border, into width x height labels. Returns false when a value
 * is no label: the index of its voxel is then in `bad`. */
bool cwi_label_layer_load(const cwi_label_layers *layers, size_t k, uint32_t *out,
                          size_t bad[3]);

/* Loads a row of voxels that begins at `from` into as many labels, all of them wanted. Returns the number
 * of the first value that is no label, or of all. */
size_t cwi_label_row_load(const cwi_label_layers *layers, const char *from, uint32_t *out);

/* Fails with CW_ERR_ARGUMENT for a voxel whose value is no label. */
cw_status cwi_label_fail_voxel(const cwi_label_layers *layers, const size_t bad[3],
                               cw_error *err);

/* Returns the slice of voxels that stands at layer k, or beside it. */
size_t cwi_label_layer_slice(const cwi_label_layers *layers, size_t k);

/* Counts the voxels of a layer without its border, by labels plus 1, except the background.
 * Returns false when memory is out. */
bool cwi_label_layer_count(const cwi_label_layers *layers, const uint32_t *labels,
                           cwi_key_counts *counts);

#ifdef __cplusplus
}
#endif

#endif
