/* Changes what is inside a volume by a mask and by balls, and crops it to that. */
#include "cli/inputs/volume_prepare.h"

#include "cli/framework/console.h"
#include "core/base/status.h"

#include <math.h>

static cw_status mask_view(const cli_input *input, cli_volume *volume, const cw_inside *inside,
                           cw_error *err)
{
    const cw_filter_desc desc = cli_describe_filter(input, volume);
    const cli_input plain = {.threads = input->threads,
                             .memory = volume->memory_left,
                             .max_voxels = input->max_voxels,
                             .timeout_s = input->timeout_s,
                             .no_sandbox = input->no_sandbox,
                             .allow_external = input->allow_external};
    cli_volume mask;
    cw_volume made;
    cw_status st = cli_read_volume(input->mask, &plain, false, &mask, err);
    if (st != CW_OK)
        return st;
    st = cw_volume_mask(&volume->view, &mask.view, inside, &desc, &made, err);
    cli_free_volume(&mask);
    if (st != CW_OK)
        return cwi_fail_in(err, st, "--mask");
    cli_note_volume(volume, "masked by %s", cli_shown_path(input->mask));
    cli_take_filtered(volume, &made);
    return CW_OK;
}

static cw_status change_view(const cli_input *input, cli_volume *volume, bool closes,
                             const cw_inside *inside, cw_error *err)
{
    const cw_filter_desc desc = cli_describe_filter(input, volume);
    double radius[3];
    cw_volume made;
    cli_width_in_voxels(closes ? &input->mask_close : &input->mask_open, &volume->view, radius);
    cw_status st = closes ? cw_volume_close(&volume->view, radius, inside, &desc, &made, err)
                          : cw_volume_open(&volume->view, radius, inside, &desc, &made, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, closes ? "--mask-close" : "--mask-open");
    cli_note_volume(volume, "%s by a ball of %.3g x %.3g x %.3g voxels",
                    closes ? "closed" : "opened", radius[0], radius[1], radius[2]);
    cli_take_filtered(volume, &made);
    return CW_OK;
}

static double voxel_count(const cw_volume *v)
{
    return (double)v->dim[0] * (double)v->dim[1] * (double)v->dim[2];
}

static cw_status crop_view(const cli_input *input, cli_volume *volume, const cw_inside *inside,
                           cw_error *err)
{
    const cw_volume whole = volume->view;
    cw_box box;
    cw_status st = cw_volume_inside_box(&whole, inside, input->crop.margin, (int)input->threads,
                                        &box, err);
    if (st == CW_ERR_EMPTY) /* extraction says so, with the range of the values */
        return CW_OK;
    if (st == CW_OK)
        st = cw_volume_crop(&whole, &box, &volume->view, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, "--crop auto");
    cli_note_volume(volume, "cropped to voxels %zu:%zu,%zu:%zu,%zu:%zu, %.3g %% of all",
                    box.first[0], box.first[0] + box.count[0] - 1, box.first[1],
                    box.first[1] + box.count[1] - 1, box.first[2],
                    box.first[2] + box.count[2] - 1,
                    100 * voxel_count(&volume->view) / voxel_count(&whole));
    return CW_OK;
}

cw_status cli_prepare_inside(const cli_input *input, cli_volume *volume, const double *levels,
                             size_t count, bool inside_is_low, cw_error *err)
{
    cw_inside inside = {.level = levels[0], .inside_is_low = inside_is_low};
    for (size_t n = 1; n < count; n++) /* the level that has most inside */
        inside.level =
            inside_is_low ? fmax(inside.level, levels[n]) : fmin(inside.level, levels[n]);
    if (count > 1 && (input->mask_open.given || input->mask_close.given))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--mask-%s takes one isovalue; there are %zu",
                        input->mask_open.given ? "open" : "close", count);
    const double start = cli_seconds();
    cw_status st = CW_OK;
    if (input->mask)
        st = mask_view(input, volume, &inside, err);
    if (st == CW_OK && input->mask_open.given)
        st = change_view(input, volume, false, &inside, err);
    if (st == CW_OK && input->mask_close.given)
        st = change_view(input, volume, true, &inside, err);
    if (st == CW_OK && input->crop.is_auto)
        st = crop_view(input, volume, &inside, err);
    if (input->mask || input->mask_open.given || input->mask_close.given || input->crop.is_auto)
        cli_note_change(volume, "mask", start);
    return st == CW_OK ? st : cwi_fail_in(err, st, volume->path);
}
