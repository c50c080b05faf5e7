/* Labels that are drawn over slices, of the volume itself or of another one, or its values. */
#ifndef CLI_RENDER_SLICE_LABELS_H
#define CLI_RENDER_SLICE_LABELS_H

#include "cli/inputs/label_scene.h"

#include <cubewright/overlay.h>

/* Zeroed, there are none. */
typedef struct cli_slice_labels {
    const cli_volume *volume; /* whose labels; NULL: none */
    const cli_input *input;   /* that it was read by: says which components hold labels */
    size_t step;
    const cw_label_table *shown;
    double opacity;  /* factor of their opacities */
    bool is_base;    /* the slices are those of the label map: under the labels is black */
    bool has_values; /* it is not labels that are drawn, but values: */
    cw_volume field; /* the only component of the volume's voxels */
    cw_value_slices values; /* how; its volume is field */
    cli_number isoline;     /* of the slices' volume, drawn after them; not given: none */
} cli_slice_labels;

/* Draws the labels over the picture of a scene of slices.
 * Returns  as cw_label_slices_draw(), naming the file of labels over another volume */
CW_NODISCARD cw_status cli_draw_slice_labels(const cli_slice_labels *labels,
                                             const cw_scene *scene, cw_picture *picture,
                                             cw_error *err);

/* Makes a transfer function that shows all values black. */
cw_transfer cli_black_transfer(void);

/* Reads the volume of --overlay. Free it with cli_free_volume(). */
CW_NODISCARD cw_status cli_read_overlay(const char *path, const cli_input *input,
                                        cli_volume *volume, cw_error *err);

/* Returns the factor for labels over another volume. CW_ERR_ARGUMENT */
CW_NODISCARD cw_status cli_overlay_opacity(const cli_number *given, double *opacity,
                                           cw_error *err);

#endif
