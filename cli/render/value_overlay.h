/* Values of another volume over slices, in colours. */
#ifndef CLI_RENDER_VALUE_OVERLAY_H
#define CLI_RENDER_VALUE_OVERLAY_H

#include "cli/render/slice_labels.h"

/* Options of an overlay that is no label map. Zeroed, none is given. */
typedef struct cli_value_look {
    int map; /* 0: viridis; else 1 + a cw_colormap */
    cli_numbers range;
} cli_value_look;

#define CLI_OVERLAY_MAPS "auto/viridis/inferno/cool-warm/gray"

/* Checks the options for themselves. CW_ERR_ARGUMENT */
CW_NODISCARD cw_status cli_check_values(const cli_value_look *look,
                                        const cli_label_look *labels, cw_error *err);

/* Returns true if an overlay is drawn as labels: where labels are chosen, or it looks like a label
 * map and nothing asks for colours of values. */
bool cli_overlay_is_labels(bool looks_like_labels, const cli_value_look *look,
                           const cli_label_look *labels);

/* Finds the 80th and 99.9th percentiles of an overlay, between which its colours are where none are
 * given; where these are equal, all values.
 * Returns  CW_ERR_EMPTY  all values are the same; CW_ERR_ARGUMENT  several in a voxel */
CW_NODISCARD cw_status cli_overlay_range(const cli_volume *overlay, int threads,
                                         double range[2], cw_error *err);

/* Makes what is drawn over slices.
 * overlay  borrowed by values
 * range    used where the options give none
 * opacity  of --overlay-opacity, already checked */
CW_NODISCARD cw_status cli_make_values(const cli_volume *overlay, const cli_value_look *look,
                                       const double range[2], const cli_number *opacity,
                                       cli_slice_labels *values, cw_error *err);

#endif
