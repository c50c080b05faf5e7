/* Converts voxels of any type to labels: whole numbers are checked, and labels that are not
 * wanted become the background. */
#include "extract/labels/label_layers.h"

#include "core/base/status.h"
#include "core/volume/volume.h"

#include <math.h>
#include <string.h>

/* Returns true if a volume's stored numbers are its values. */
static bool is_plain(const cw_volume *v)
{
    return v->slope == 1 && v->intercept == 0 && !v->has_nodata;
}

#define LOAD(name, ctype)                                                                      \
    static void load_##name(const char *from, ptrdiff_t stride, size_t count, uint32_t *out)   \
    {                                                                                          \
        if (stride == (ptrdiff_t)sizeof(ctype))                                                \
            for (size_t i = 0; i < count; i++)                                                 \
                out[i] = ((const ctype *)from)[i];                                             \
        else                                                                                   \
            for (size_t i = 0; i < count; i++)                                                 \
                out[i] = *(const ctype *)(from + (ptrdiff_t)i * stride);                       \
    }
LOAD(u8, uint8_t)
LOAD(u16, uint16_t)
LOAD(u32, uint32_t)
#undef LOAD

/* Loads a row of any type. Returns the number of the first value that is no label, or count. */
static size_t load_checked(const cwi_label_layers *l, const char *from, size_t count,
                           uint32_t *out)
{
    const cw_volume *v = l->volume;
    for (size_t i = 0; i < count; i++, from += v->stride[0]) {
        const double stored = cwi_voxel_at(v->type, from);
        const double value = cwi_whole_value(v->slope * stored + v->intercept);
        out[i] = l->background;
        if ((v->has_nodata && stored == v->nodata) || isnan(value))
            continue;
        if (!(value >= 0 && value <= UINT32_MAX && value == floor(value)))
            return i;
        out[i] = (uint32_t)value;
    }
    return count;
}

size_t cwi_label_row_load(const cwi_label_layers *l, const char *from, uint32_t *out)
{
    const cw_volume *v = l->volume;
    const size_t count = v->dim[0];
    if (is_plain(v) && v->type == CW_U8)
        load_u8(from, v->stride[0], count, out);
    else if (is_plain(v) && v->type == CW_U16)
        load_u16(from, v->stride[0], count, out);
    else if (is_plain(v) && v->type == CW_U32)
        load_u32(from, v->stride[0], count, out);
    else
        return load_checked(l, from, count, out);
    return count;
}

static bool is_requested(const cwi_label_layers *l, uint32_t label)
{
    size_t low = 0, high = l->requested_count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (l->requested[middle] < label)
            low = middle + 1;
        else
            high = middle;
    }
    return low < l->requested_count && l->requested[low] == label;
}

/* Replaces labels that are not wanted; runs of one label are looked up once. */
static void choose_labels(const cwi_label_layers *l, uint32_t *row, size_t count)
{
    uint32_t last = l->background, becomes = l->background;
    for (size_t i = 0; i < count; i++) {
        if (row[i] != last) {
            last = row[i];
            becomes = is_requested(l, last) ? last : l->background;
        }
        row[i] = becomes;
    }
}

static void fill_row(uint32_t *row, size_t count, uint32_t label)
{
    for (size_t i = 0; i < count; i++)
        row[i] = label;
}

/* Returns the voxel that stands at a position counted with the border, or beside it. */
static size_t voxel_at(size_t position, size_t dim)
{
    return position == 0 ? 0 : position > dim ? dim - 1 : position - 1;
}

bool cwi_label_layer_load(const cwi_label_layers *l, size_t k, uint32_t *out, size_t bad[3])
{
    const cw_volume *v = l->volume;
    const size_t nx = v->dim[0], ny = v->dim[1];
    const size_t at = voxel_at(k, v->dim[2]);
    const char *slice = (const char *)v->data + (ptrdiff_t)(at - l->first_slice) * v->stride[2];
    if (!l->copies_border && (k == 0 || k + 1 == l->count)) {
        fill_row(out, l->width * l->height, l->background);
        return true;
    }
    for (size_t j = 0; j < ny; j++) {
        uint32_t *row = out + (j + 1) * l->width;
        const size_t good = cwi_label_row_load(l, slice + (ptrdiff_t)j * v->stride[1], row + 1);
        if (good < nx) {
            bad[0] = good, bad[1] = j, bad[2] = at;
            return false;
        }
        if (l->requested_count > 0)
            choose_labels(l, row + 1, nx);
        row[0] = l->copies_border ? row[1] : l->background;
        row[nx + 1] = l->copies_border ? row[nx] : l->background;
    }
    if (l->copies_border) {
        memcpy(out, out + l->width, l->width * sizeof *out);
        memcpy(out + (ny + 1) * l->width, out + ny * l->width, l->width * sizeof *out);
    } else {
        fill_row(out, l->width, l->background);
        fill_row(out + (ny + 1) * l->width, l->width, l->background);
    }
    return true;
}

size_t cwi_label_layer_slice(const cwi_label_layers *l, size_t k)
{
    return voxel_at(k, l->volume->dim[2]);
}

cw_status cwi_label_fail_voxel(const cwi_label_layers *l, const size_t bad[3], cw_error *err)
{
    const double value = cw_volume_value(l->volume, bad[0], bad[1], bad[2] - l->first_slice);
    return cwi_fail(
        err, CW_ERR_ARGUMENT,
        "voxel %zu, %zu, %zu is %.10g: labels are whole numbers, 0 to 4294967295%s", bad[0],
        bad[1], bad[2], value,
        value != floor(value)
            ? "; desc->round_labels takes the nearest; cw_extract_label_scores() is for probabilities"
            : "");
}

bool cwi_label_layer_count(const cwi_label_layers *l, const uint32_t *labels,
                           cwi_key_counts *counts)
{
    for (size_t y = 1; y + 1 < l->height; y++) {
        const uint32_t *row = labels + y * l->width + 1;
        const size_t count = l->width - 2;
        for (size_t x = 0, end; x < count; x = end) {
            for (end = x + 1; end < count && row[end] == row[x];)
                end++;
            if (row[x] == l->background)
                continue;
            cwi_key_count *e = cwi_key_counts_need(counts, (uint64_t)row[x] + 1);
            if (!e)
                return false;
            e->count += end - x;
        }
    }
    return true;
}
