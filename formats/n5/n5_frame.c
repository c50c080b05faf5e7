/* Makes frames from the attributes of N5: names of axes, units, voxels, factors of levels. */
#include "core/base/status.h"
#include "formats/n5/n5.h"

#include <stdio.h>
#include <string.h>

/* Components at most; more entries along a fourth axis are steps. */
enum { MAX_COMPONENTS = 16, SPACE = 3 };

/* --- axes --------------------------------------------------------------------------------- */

/* Gives roles by place: the first is x. */
static void place_axes(const cwi_zarr_array *array, cwi_zarr_frame *frame)
{
    static const char *const names[] = {"x", "y", "z", "c", "t"};
    for (size_t d = 0; d < array->rank; d++) {
        cwi_role role = d < CWI_ROLE_COUNT ? (cwi_role)d : CWI_ROLE_COUNT;
        if (d == CWI_AXIS_COMPONENT && array->rank == 4 && array->shape[d] > MAX_COMPONENTS)
            role = CWI_AXIS_STEP;
        frame->axes[d].role = role;
        snprintf(frame->axes[d].name, sizeof frame->axes[d].name, "%s",
                 role < CWI_ROLE_COUNT ? names[role] : "?");
    }
}

/* Reads the names of axes. Those of which one is not known are kept, and roles are given by place. */
static cw_status read_axes(const json_t *attrs, const cwi_zarr_array *array,
                           cwi_zarr_frame *frame, cw_error *err)
{
    const json_t *list = json_object_get(attrs, "axes");
    bool known = json_is_array(list);
    if (known && json_array_size(list) != array->rank)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'axes' lists %zu names; %zu were expected, one a dimension",
                        json_array_size(list), array->rank);
    for (size_t d = 0; known && d < array->rank; d++) {
        const char *name = json_string_value(json_array_get(list, d));
        known =
            name && (cwi_zarr_name_role(name, &frame->axes[d].role) || array->shape[d] == 1);
        snprintf(frame->axes[d].name, sizeof frame->axes[d].name, "%s", name ? name : "?");
    }
    if (!known || cwi_zarr_check_roles(frame, array, NULL) != CW_OK)
        place_axes(array, frame);
    return CW_OK;
}

/* --- numbers of dimensions ---------------------------------------------------------------- */

/* Reads a list with a number of each dimension, or of the first three alone: others get 1 in the
 * place of a factor, and 0 in that of an offset. */
static cw_status read_list(const json_t *list, const char *key, const cwi_zarr_array *array,
                           double absent, double out[CWI_ZARR_RANK], cw_error *err)
{
    const size_t count = json_array_size(list);
    const bool is_space = array->rank > SPACE && count == SPACE;
    if (!json_is_array(list) || (count != array->rank && !is_space))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'%s' lists %zu numbers; %zu were expected, one a dimension", key,
                        count, array->rank);
    for (size_t d = 0; d < array->rank; d++) {
        const json_t *item = json_array_get(list, d);
        if (d < count && !json_is_number(item))
            return cwi_fail(err, CW_ERR_FORMAT, "'%s' has no number at %zu; one was expected",
                            key, d);
        out[d] = d < count ? json_number_value(item) : absent;
    }
    return CW_OK;
}

/* Reads the size of voxels of the finest level, and the unit. Its keys are "resolution" and "units",
 * or "pixelResolution", which may be a list alone. */
static cw_status read_resolution(const json_t *attrs, const cwi_zarr_array *array,
                                 cwi_zarr_frame *frame, double size[CWI_ZARR_RANK],
                                 cw_error *err)
{
    const json_t *pixel = json_object_get(attrs, "pixelResolution");
    const json_t *list = json_object_get(attrs, "resolution");
    const json_t *units = json_object_get(attrs, "units");
    const char *key = list ? "resolution" : "pixelResolution";
    const char *unit = cwi_zarr_text(pixel, "unit");
    if (!list)
        list = json_is_object(pixel) ? json_object_get(pixel, "dimensions") : pixel;
    for (size_t d = 0; d < array->rank; d++) {
        const char *text = json_string_value(json_array_get(units, d));
        size[d] = 1;
        cwi_zarr_read_unit(text                                        ? text
                           : unit && frame->axes[d].role <= CWI_AXIS_Z ? unit
                                                                       : NULL,
                           &frame->axes[d]);
    }
    return list || pixel ? read_list(list, key, array, 1, size, err) : CW_OK;
}

/* Reads the factors by which a level is coarser than the finest: its own, or those of its number in
 * the list of its image. Without any they are 1, which is right for level 0 alone. */
static cw_status read_factors(const json_t *attrs, size_t number, const cwi_zarr_array *array,
                              double factors[CWI_ZARR_RANK], cw_error *err)
{
    const char *key = json_object_get(attrs, "scales") ? "scales" : "downsamplingFactors";
    const json_t *list = json_object_get(attrs, key);
    for (size_t d = 0; d < array->rank; d++)
        factors[d] = 1;
    if (json_is_array(json_array_get(list, 0)))
        list = json_array_get(list, number);
    if (!list && number == 0)
        return CW_OK;
    if (!list)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'downsamplingFactors' is missing for level %zu; a list of numbers was "
                        "expected",
                        number);
    cw_status st = read_list(list, key, array, 1, factors, err);
    for (size_t d = 0; st == CW_OK && d < array->rank; d++)
        if (!(factors[d] > 0))
            return cwi_fail(err, CW_ERR_FORMAT,
                            "'%s' has the factor %g; one above 0 was expected", key,
                            factors[d]);
    return st;
}

/* --- transforms --------------------------------------------------------------------------- */

/* Reads a list of numbers of a transform, in the order of its axes. */
static cw_status read_along(const json_t *transform, const char *key, size_t index, double *out,
                            cw_error *err)
{
    const json_t *item = json_array_get(json_object_get(transform, key), index);
    if (!json_is_number(item))
        return cwi_zarr_fail(err, transform, key, "a list of numbers, one an axis,");
    *out = json_number_value(item);
    return CW_OK;
}

/* Applies the "transform" of a level: scales, translations and units by the names of axes. */
static cw_status apply_transform(const json_t *transform, cwi_zarr_frame *frame, cw_error *err)
{
    const json_t *axes = json_object_get(transform, "axes");
    cw_status st = CW_OK;
    if (!json_is_array(axes))
        return cwi_fail_in(err, cwi_zarr_fail(err, transform, "axes", "a list of names"),
                           "transform");
    for (size_t n = 0; st == CW_OK && n < json_array_size(axes); n++) {
        const char *name = json_string_value(json_array_get(axes, n));
        size_t d = 0;
        while (d < frame->rank && !(name && strcmp(frame->axes[d].name, name) == 0))
            d++;
        if (d == frame->rank)
            return cwi_fail(err, CW_ERR_FORMAT,
                            "transform: 'axes' names '%.40s', which is no axis of the array",
                            name ? name : "?");
        st = read_along(transform, "scale", n, &frame->matrix[d][d], err);
        if (st == CW_OK)
            st = read_along(transform, "translate", n, &frame->matrix[d][frame->rank], err);
        cwi_zarr_read_unit(
            json_string_value(json_array_get(json_object_get(transform, "units"), n)),
            &frame->axes[d]);
    }
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, "transform");
}

static cw_status make_frame(const cwi_zarr_node *node, size_t number,
                            const cwi_zarr_array *array, cwi_zarr_frame *frame, cw_error *err)
{
    const json_t *transform = json_object_get(node->meta.root, "transform");
    const json_t *offsets = json_object_get(node->attrs, "offset");
    double size[CWI_ZARR_RANK], factors[CWI_ZARR_RANK], offset[CWI_ZARR_RANK] = {0};
    cwi_zarr_start_frame(array, frame);
    cw_status st = read_axes(node->attrs, array, frame, err);
    if (st == CW_OK && json_is_object(transform))
        return apply_transform(transform, frame, err);
    if (st == CW_OK)
        st = read_resolution(node->attrs, array, frame, size, err);
    if (st == CW_OK)
        st = read_factors(node->attrs, number, array, factors, err);
    if (st == CW_OK && offsets)
        st = read_list(offsets, "offset", array, 0, offset, err);
    for (size_t d = 0; st == CW_OK && d < array->rank; d++) {
        frame->matrix[d][d] = size[d] * factors[d];
        frame->matrix[d][array->rank] = offset[d] + (factors[d] - 1) / 2 * size[d];
    }
    return st;
}

cw_status cwi_n5_array_frame(const cwi_zarr_node *node, const cwi_zarr_array *array,
                             cwi_zarr_frame *frame, cw_error *err)
{
    return make_frame(node, 0, array, frame, err);
}

cw_status cwi_n5_level_frame(const cwi_zarr_node *image, size_t number,
                             const cwi_zarr_node *level, const cwi_zarr_array *array,
                             cwi_zarr_frame *frame, cw_error *err)
{
    (void)image; /* the level has inherited what it tells */
    cw_status st = make_frame(level, number, array, frame, err);
    return st == CW_OK ? CW_OK : cwi_zarr_fail_in(err, st, level, true);
}
