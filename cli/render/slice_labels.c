/* Draws labels over slices, component by component, and reads volumes of labels for that. */
#include "cli/render/slice_labels.h"

#include "core/base/status.h"

#include <cubewright/overlay.h>

/* Labels are seen, and the scan through them. */
static const double OVERLAY_OPACITY = 0.4;

static cw_status draw_values(const cli_slice_labels *labels, const cw_scene *scene,
                             cw_picture *picture, cw_error *err)
{
    cw_value_slices values = labels->values;
    values.values = &labels->field;
    const cw_status st = cw_value_slices_draw(&values, scene, picture, err);
    return st == CW_OK || st == CW_ERR_CANCELLED ? st
                                                 : cwi_fail_in(err, st, labels->volume->path);
}

cw_status cli_draw_slice_labels(const cli_slice_labels *labels, const cw_scene *scene,
                                cw_picture *picture, cw_error *err)
{
    size_t first, end;
    cw_status st = CW_OK;
    if (!labels->volume || labels->opacity <= 0)
        return CW_OK;
    if (labels->has_values)
        return draw_values(labels, scene, picture, err);
    cli_label_layers(labels->volume, labels->input, &first, &end);
    for (size_t c = first; c < end && st == CW_OK; c++) {
        cw_volume view;
        const cw_label_slices layer = {&view, labels->shown, (uint32_t)c,
                                       (float)labels->opacity};
        st = cw_volume_select(&labels->volume->voxels, c, labels->step, &view, err);
        if (st == CW_OK)
            st = cw_label_slices_draw(&layer, scene, picture, err);
    }
    return st == CW_OK || labels->is_base || st == CW_ERR_CANCELLED
               ? st
               : cwi_fail_in(err, st, labels->volume->path);
}

cw_transfer cli_black_transfer(void)
{
    return (cw_transfer){.color_count = 1,
                         .colors = {{0, {0, 0, 0}}},
                         .opacity_count = 1,
                         .opacities = {{0, 1}}};
}

cw_status cli_read_overlay(const char *path, const cli_input *input, cli_volume *volume,
                           cw_error *err)
{
    cli_input plain = {.threads = input->threads,
                       .memory = input->memory,
                       .max_voxels = input->max_voxels,
                       .timeout_s = input->timeout_s,
                       .no_sandbox = input->no_sandbox,
                       .gaps = input->gaps,
                       .tilt = input->tilt,
                       .skip_damaged = input->skip_damaged,
                       .allow_external = input->allow_external,
                       .step_chosen = true};
    plain.array.component.given = true; /* all are read */
    return cli_read_volume(path, &plain, false, volume, err);
}

cw_status cli_overlay_opacity(const cli_number *given, double *opacity, cw_error *err)
{
    *opacity = given->given ? given->value : OVERLAY_OPACITY;
    return *opacity >= 0 && *opacity <= 1
               ? CW_OK
               : cwi_fail(err, CW_ERR_ARGUMENT, "--overlay-opacity %g: 0 to 1 was expected",
                          *opacity);
}
