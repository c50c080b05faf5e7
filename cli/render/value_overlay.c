/* Prepares the values of another volume to be drawn over slices: their range and colours. */
#include "cli/render/value_overlay.h"

#include "core/base/status.h"

#include <math.h>
#include <string.h>

enum { BINS = 4096 };

static const double LOW_SHARE = 0.8, HIGH_SHARE = 0.999; /* most of a scan is background */
static const double OPACITY = 0.6;

cw_status cli_check_values(const cli_value_look *look, const cli_label_look *labels,
                           cw_error *err)
{
    const cli_numbers *r = &look->range;
    const char *given = r->count ? "overlay-range" : look->map ? "overlay-map" : NULL;
    if (r->count && (r->count != 2 || !(r->value[0] < r->value[1])))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--overlay-range takes two rising numbers, such as 2,10");
    if (given && labels->labels)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--%s is for an overlay of values, --labels for one of labels", given);
    return CW_OK;
}

bool cli_overlay_is_labels(bool looks_like_labels, const cli_value_look *look,
                           const cli_label_look *labels)
{
    if (labels->labels || labels->names || labels->opacity)
        return true;
    return looks_like_labels && !look->map && look->range.count == 0;
}

/* Returns the value below which a share of all values is. */
static double find_percentile(const cw_statistics *s, double fraction)
{
    double below = 0;
    const double target = fraction * (double)s->finite;
    for (size_t b = 0; b < s->bin_count; b++) {
        const double count = (double)s->bins[b];
        if (count > 0 && below + count >= target)
            return s->min + s->bin_width * ((double)b + (target - below) / count);
        below += count;
    }
    return s->max;
}

static cw_status select_field(const cli_volume *overlay, cw_volume *field, cw_error *err)
{
    const size_t components = overlay->voxels.components;
    cw_status st =
        components > 1
            ? cwi_fail(err, CW_ERR_ARGUMENT,
                       "an overlay of values has one in each voxel, and this has %zu",
                       components)
            : cw_volume_select(&overlay->voxels, 0, 0, field, err);
    return st == CW_OK ? st : cwi_fail_in(err, st, overlay->path);
}

cw_status cli_overlay_range(const cli_volume *overlay, int threads, double range[2],
                            cw_error *err)
{
    cw_volume field;
    cw_statistics s = {0};
    cw_status st = select_field(overlay, &field, err);
    if (st != CW_OK)
        return st;
    st = cw_volume_statistics(&field, BINS, threads, &s, err);
    if (st == CW_OK) {
        range[0] = find_percentile(&s, LOW_SHARE);
        range[1] = find_percentile(&s, HIGH_SHARE);
    }
    if (st == CW_OK && !(range[1] - range[0] > s.bin_width)) {
        range[0] = s.min;
        range[1] = s.max;
    }
    cw_statistics_free(&s);
    if (st == CW_OK && !(range[0] < range[1]))
        st = cwi_fail(err, CW_ERR_EMPTY, "all values are %g: there is nothing to colour",
                      range[0]);
    return st == CW_OK ? st : cwi_fail_in(err, st, overlay->path);
}

cw_status cli_make_values(const cli_volume *overlay, const cli_value_look *look,
                          const double range[2], const cli_number *opacity,
                          cli_slice_labels *values, cw_error *err)
{
    const double *r = look->range.count ? look->range.value : range;
    *values = (cli_slice_labels){.volume = overlay,
                                 .opacity = opacity->given ? opacity->value : OPACITY,
                                 .has_values = true};
    cw_status st = select_field(overlay, &values->field, err);
    values->values =
        (cw_value_slices){.map = look->map ? (cw_colormap)(look->map - 1) : CW_COLORMAP_VIRIDIS,
                          .low = r[0],
                          .high = r[1],
                          .opacity = (float)values->opacity};
    return st;
}
