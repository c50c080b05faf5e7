/* Reads the metadata of an array in version 2 of Zarr: .zarray. */
#include "formats/zarr/zarr_array.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/bytes/byte_order.h"
#include "formats/volume/voxel_source.h"

#include <stdio.h>
#include <string.h>

/* Reads a type of NumPy, such as "<u2". */
static cw_status read_dtype(const json_t *meta, cwi_zarr_array *array, cw_error *err)
{
    const char *text = cwi_zarr_text(meta, "dtype");
    const size_t length = text ? strlen(text) : 0;
    if (!text)
        return cwi_zarr_fail(err, meta, "dtype", "a type such as \"<u2\"");
    snprintf(array->type_name, sizeof array->type_name, "%s", text);
    if (length != 3 || !strchr("<>|=", text[0]) || text[2] < '1' || text[2] > '9' ||
        !cwi_zarr_set_type(array, text[1], (size_t)(text[2] - '0')))
        return cwi_fail_type(err, "dtype", text);
    array->chain.big_endian = text[0] == '>' || (text[0] == '=' && cwi_machine_is_big_endian());
    return CW_OK;
}

/* Sets the order of numbers: C varies the last dimension fastest, F the first. */
static cw_status read_order(const json_t *meta, cwi_zarr_array *array, cw_error *err)
{
    const char *text = cwi_zarr_text(meta, "order");
    const bool is_fortran = text && strcmp(text, "F") == 0;
    if (!is_fortran && !(text && strcmp(text, "C") == 0))
        return cwi_zarr_fail(err, meta, "order", "\"C\" or \"F\"");
    for (size_t d = 0; d < array->rank; d++)
        array->order[d] = is_fortran ? array->rank - 1 - d : d;
    return CW_OK;
}

static cw_status read_filters(const json_t *meta, cw_error *err)
{
    const json_t *filters = json_object_get(meta, "filters");
    return json_array_size(filters) == 0 &&
                   (json_is_array(filters) || cwi_zarr_is_absent(meta, "filters"))
               ? CW_OK
               : cwi_zarr_fail(err, meta, "filters", "null, as filters are not read,");
}

static cw_status read_compressor(const json_t *meta, cwi_zarr_array *array, cw_error *err)
{
    const json_t *compressor = json_object_get(meta, "compressor");
    const char *id = cwi_zarr_text(compressor, "id");
    if (cwi_zarr_is_absent(meta, "compressor"))
        return CW_OK;
    if (!id)
        return cwi_zarr_fail(err, meta, "compressor", "null or an object with an 'id'");
    return cwi_zarr_add_codec(&array->chain, "compressor", id, err);
}

static cw_status read_separator(const json_t *meta, cwi_zarr_array *array, cw_error *err)
{
    const char *text = cwi_zarr_text(meta, "dimension_separator");
    array->separator = '.';
    if (cwi_zarr_is_absent(meta, "dimension_separator"))
        return CW_OK;
    if (!text || (strcmp(text, ".") != 0 && strcmp(text, "/") != 0))
        return cwi_zarr_fail(err, meta, "dimension_separator", "\".\" or \"/\"");
    array->separator = text[0];
    return CW_OK;
}

cw_status cwi_zarr_parse_v2(const json_t *meta, const json_t *attributes, cwi_zarr_array *array,
                            cw_error *err)
{
    if (json_number_value(json_object_get(meta, "zarr_format")) != 2)
        return cwi_zarr_fail(err, meta, "zarr_format", "2");
    cw_status st = cwi_zarr_set_shape(meta, array, err);
    if (st == CW_OK)
        st = read_dtype(meta, array, err);
    if (st == CW_OK)
        st = cwi_zarr_sizes(meta, "chunks", array->rank, array->chunk, err);
    if (st == CW_OK)
        st = read_order(meta, array, err);
    if (st == CW_OK)
        st = read_filters(meta, err);
    if (st == CW_OK)
        st = read_compressor(meta, array, err);
    if (st == CW_OK)
        st = read_separator(meta, array, err);
    if (st == CW_OK)
        st = cwi_zarr_set_fill(meta, array, err);
    memcpy(array->inner, array->chunk, sizeof array->inner);
    cwi_zarr_set_names(array, json_object_get(attributes, "_ARRAY_DIMENSIONS"));
    return st == CW_OK ? cwi_zarr_set_chunk_bytes(array, "chunks", err) : st;
}
