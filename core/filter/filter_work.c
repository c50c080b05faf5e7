/* Loads and stores the values of filters, and makes their results. */
#include "core/filter/filter_work.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <math.h>

cw_status cwi_filter_input(const cw_volume *volume, const char *what, cw_volume *in,
                           cw_error *err)
{
    cw_status st = cw_volume_select(volume, 0, 0, in, err);
    return st == CW_OK ? cwi_volume_expect_even(in, what, err) : st;
}

cw_type cw_filter_type(const cw_volume *volume)
{
    if (!volume || volume->known & CW_KNOWN_LABELS)
        return volume ? volume->type : CW_F32;
    const bool needs_double = cw_type_size(volume->type) > 2 && volume->type != CW_F32;
    return needs_double ? CW_F64 : CW_F32;
}

cw_status cwi_filter_check_size(cw_type type, const size_t dim[3], const cw_filter_desc *desc,
                                size_t work, cw_error *err)
{
    const size_t limit = desc->max_bytes;
    size_t bytes = cw_type_size(type);
    bool fits = true;
    for (int a = 0; a < 3; a++)
        fits = fits && cwi_size_mul(bytes, dim[a], &bytes);
    fits = fits && cwi_size_add(bytes, work, &bytes);
    if (!limit || (fits && bytes <= limit))
        return CW_OK;
    if (!fits)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "%zu x %zu x %zu voxels and the work on them exceed the limit of %zu "
                        "bytes",
                        dim[0], dim[1], dim[2], limit);
    return cwi_fail(err, CW_ERR_LIMIT,
                    "%zu x %zu x %zu voxels of %s and the work on them take %zu bytes, which "
                    "exceed the limit of %zu bytes",
                    dim[0], dim[1], dim[2], cw_type_name(type), bytes, limit);
}

cw_status cwi_filter_result(const cw_volume *in, cw_type type, const size_t dim[3],
                            const cw_filter_desc *desc, size_t work, cw_volume *out,
                            cw_error *err)
{
    cw_status st = cwi_filter_check_size(type, dim, desc, work, err);
    if (st == CW_OK)
        st = cw_volume_alloc(out, type, dim, 1, 1, err);
    if (st != CW_OK)
        return st;
    for (int a = 0; a < 3; a++)
        for (int c = 0; c < 4; c++)
            out->affine[a][c] = in->affine[a][c];
    out->slope = in->slope;
    out->intercept = in->intercept;
    out->has_nodata = in->has_nodata;
    out->nodata = in->nodata;
    out->known = in->known;
    out->said_unit_mm = in->said_unit_mm;
    out->said_ras = in->said_ras;
    return CW_OK;
}

/* Returns true if a stored number is a value. */
static bool is_value(const cw_volume *v, double x)
{
    return isfinite(x) && !(v->has_nodata && x == v->nodata);
}

typedef struct gap_search {
    const cw_volume *in;
    bool found;
} gap_search;

static void search_slice(void *context, size_t k)
{
    gap_search *search = context;
    const cw_volume *in = search->in;
    for (size_t j = 0; j < in->dim[1]; j++) {
        const char *p = cwi_voxel_address(in, 0, j, k);
        for (size_t i = 0; i < in->dim[0]; i++)
            if (!is_value(in, cwi_voxel_at(in->type, p + (ptrdiff_t)i * in->stride[0]))) {
                cwi_set_flag(&search->found);
                return;
            }
    }
}

bool cwi_filter_has_gaps(const cw_volume *in, int threads)
{
    gap_search search = {.in = in};
    if (in->has_nodata || in->type == CW_F32 || in->type == CW_F64)
        cwi_parallel_for_all(in->dim[2], in->dim[0] * in->dim[1], threads, search_slice,
                             &search);
    return search.found;
}

void cwi_filter_load(const cw_volume *in, size_t j, size_t k, double *values, double *valid)
{
    const char *p = cwi_voxel_address(in, 0, j, k);
    switch (in->type) {
#define CASE(name, ctype, text)                                                                \
    case name:                                                                                 \
        for (size_t i = 0; i < in->dim[0]; i++)                                                \
            values[i] = (double)*(const ctype *)(p + (ptrdiff_t)i * in->stride[0]);            \
        break;
        CW_TYPE_TABLE(CASE)
#undef CASE
    default:
        break;
    }
    for (size_t i = 0; i < in->dim[0] && valid; i++) {
        valid[i] = is_value(in, values[i]) ? 1 : 0;
        values[i] = valid[i] > 0 ? values[i] : 0;
    }
}

/* The least and the greatest number of each integer type. */
static const double limits[CW_TYPE_COUNT][2] = {
    [CW_U8] = {0, UINT8_MAX},           [CW_I8] = {INT8_MIN, INT8_MAX},
    [CW_U16] = {0, UINT16_MAX},         [CW_I16] = {INT16_MIN, INT16_MAX},
    [CW_U32] = {0, (double)UINT32_MAX}, [CW_I32] = {INT32_MIN, INT32_MAX},
};

void cwi_filter_store(const cw_volume *out, void *voxel, double value)
{
    if (out->type != CW_F32 && out->type != CW_F64) {
        const double low = limits[out->type][0], high = limits[out->type][1], exact = value;
        value = fmin(fmax(rint(value), low), high);
        if (out->has_nodata && value == out->nodata)
            value += (exact >= value && value < high) || value <= low ? 1 : -1;
    } else if (out->has_nodata) {
        value = out->type == CW_F32 ? (double)(float)value : value;
        if (value == out->nodata)
            value = out->type == CW_F32 ? (double)nextafterf((float)value, INFINITY)
                                        : nextafter(value, INFINITY);
    }
    cwi_voxel_put(out->type, voxel, value);
}

void cwi_filter_store_gap(const cw_volume *out, void *voxel)
{
    cwi_voxel_put(out->type, voxel, out->has_nodata ? out->nodata : (double)NAN);
}
