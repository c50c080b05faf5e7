/* Reads the metadata that versions 2 and 3 of Zarr share: shapes, types, fill values. */
#include "formats/zarr/zarr_array.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/zarr/zarr_decode.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

cw_status cwi_zarr_set_shape(const json_t *meta, cwi_zarr_array *array, cw_error *err)
{
    const json_t *shape = json_object_get(meta, "shape");
    const size_t rank = json_array_size(shape);
    if (!json_is_array(shape))
        return cwi_zarr_fail(err, meta, "shape", "a list of sizes");
    if (rank < 1 || rank > CWI_ZARR_RANK)
        return cwi_fail(err, CW_ERR_FORMAT, "'shape' has %zu dimensions; 1 to %d are read",
                        rank, CWI_ZARR_RANK);
    array->rank = rank;
    return cwi_zarr_sizes(meta, "shape", rank, array->shape, err);
}

bool cwi_zarr_set_type(cwi_zarr_array *array, char kind, size_t bytes)
{
    static const struct {
        char kind;
        size_t bytes;
        cw_type type;
    } types[] = {
        {'b', 1, CW_U8},  {'u', 1, CW_U8},  {'i', 1, CW_I8},  {'u', 2, CW_U16},
        {'i', 2, CW_I16}, {'u', 4, CW_U32}, {'i', 4, CW_I32}, {'f', 4, CW_F32},
        {'f', 8, CW_F64}, {'u', 8, CW_U32}, {'i', 8, CW_I32}, {'f', 2, CW_F32},
    };
    for (size_t n = 0; n < sizeof types / sizeof *types; n++)
        if (types[n].kind == kind && types[n].bytes == bytes) {
            array->type = types[n].type;
            array->stored_bytes = bytes;
            array->is_bool = kind == 'b';
            array->is_signed = kind == 'i';
            array->stored = bytes == cw_type_size(array->type) ? CWI_STORED_PLAIN
                            : kind == 'f'                      ? CWI_STORED_F16
                            : kind == 'i'                      ? CWI_STORED_I64
                                                               : CWI_STORED_U64;
            return true;
        }
    return false;
}

/* Stores the bits of a number, of which the low bytes count. */
static void store_bits(cwi_zarr_array *array, uint64_t bits)
{
    const uint8_t u8 = (uint8_t)bits;
    const uint16_t u16 = (uint16_t)bits;
    const uint32_t u32 = (uint32_t)bits;
    const void *from = array->stored_bytes == 1   ? (const void *)&u8
                       : array->stored_bytes == 2 ? (const void *)&u16
                       : array->stored_bytes == 4 ? (const void *)&u32
                                                  : (const void *)&bits;
    memcpy(&array->fill, from, array->stored_bytes);
}

static bool is_real(const cwi_zarr_array *array)
{
    return array->type == CW_F32 || array->type == CW_F64;
}

/* Stores a number of a float type. */
static void store_real(cwi_zarr_array *array, double value)
{
    const float single = (float)value;
    const uint16_t half = cwi_stored_half(value);
    if (array->stored)
        memcpy(&array->fill, &half, sizeof half);
    else if (array->type == CW_F32)
        memcpy(&array->fill, &single, sizeof single);
    else
        memcpy(&array->fill, &value, sizeof value);
}

/* Returns true if an integer type can hold a number; sets its bits. */
static bool find_bits(const cwi_zarr_array *array, double value, uint64_t *bits)
{
    const bool has_sign = array->is_signed;
    const int width = (int)(8 * array->stored_bytes) - (has_sign ? 1 : 0);
    const double low = has_sign ? -ldexp(1, width) : 0;
    const double end = array->is_bool ? 2 : ldexp(1, width);
    if (!(value >= low && value <= end) || value != floor(value))
        return false;
    if (value == end) { /* a number of 64 bits that was rounded up; else beyond the last */
        *bits = UINT64_MAX >> (has_sign ? 1 : 0);
        return array->stored_bytes == 8;
    }
    *bits = value < 0 ? (uint64_t)(int64_t)value : (uint64_t)value;
    return true;
}

/* Reads "NaN", "Infinity", "-Infinity", or the bits of a number as "0x7fc00000". */
static bool read_special(cwi_zarr_array *array, const char *text)
{
    char *end;
    if (strcmp(text, "NaN") == 0)
        return store_real(array, (double)NAN), true;
    if (strcmp(text, "Infinity") == 0)
        return store_real(array, (double)INFINITY), true;
    if (strcmp(text, "-Infinity") == 0)
        return store_real(array, -(double)INFINITY), true;
    if (strncmp(text, "0x", 2) != 0 || strlen(text) != 2 + 2 * array->stored_bytes ||
        strspn(text + 2, "0123456789abcdefABCDEF") != strlen(text + 2))
        return false;
    store_bits(array, strtoull(text + 2, &end, 16));
    return true;
}

cw_status cwi_zarr_set_fill(const json_t *meta, cwi_zarr_array *array, cw_error *err)
{
    const json_t *fill = json_object_get(meta, "fill_value");
    const char *text = json_string_value(fill);
    uint64_t bits = 0;
    array->fill = 0;
    if (!fill || json_is_null(fill))
        return CW_OK;
    if (is_real(array)) {
        if (json_is_number(fill))
            store_real(array, json_number_value(fill));
        else if (!text || !read_special(array, text))
            return cwi_zarr_fail(err, meta, "fill_value",
                                 "a number, \"NaN\", \"Infinity\", \"-Infinity\" or the bits "
                                 "of a number as \"0x...\"");
        return CW_OK;
    }
    const double value = json_is_boolean(fill)  ? (json_is_true(fill) ? 1 : 0)
                         : json_is_number(fill) ? json_number_value(fill)
                                                : (double)NAN;
    if (!find_bits(array, value, &bits))
        return cwi_zarr_fail(err, meta, "fill_value", "a number that the type can hold");
    store_bits(array, bits);
    return CW_OK;
}

cw_status cwi_zarr_set_chunk_bytes(cwi_zarr_array *array, const char *key, cw_error *err)
{
    size_t bytes = array->stored_bytes;
    for (size_t d = 0; d < array->rank; d++)
        if (!cwi_size_mul(bytes, array->inner[d], &bytes) || bytes > PTRDIFF_MAX / 2)
            return cwi_fail(err, CW_ERR_LIMIT,
                            "'%s' asks for chunks that an address space cannot hold", key);
    if (array->chain.count && bytes > INT32_MAX)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "'%s' asks for chunks of %zu bytes; compressed ones have 2 GiB at most",
                        key, bytes);
    array->chunk_bytes = bytes;
    return CW_OK;
}

void cwi_zarr_set_names(cwi_zarr_array *array, const json_t *list)
{
    array->has_names = json_array_size(list) == array->rank;
    for (size_t d = 0; array->has_names && d < array->rank; d++) {
        const char *name = json_string_value(json_array_get(list, d));
        snprintf(array->names[d], sizeof array->names[d], "%s", name ? name : "");
    }
}

cw_status cwi_zarr_add_codec(cwi_zarr_chain *chain, const char *key, const char *name,
                             cw_error *err)
{
    static const char *const names[CWI_ZARR_CODEC_COUNT] = {
#define ROW(constant, text) [constant] = text,
        CWI_ZARR_CODEC_TABLE(ROW)
#undef ROW
    };
    const char *bare = strncmp(name, "numcodecs.", 10) == 0 ? name + 10 : name;
    for (int c = 0; c < CWI_ZARR_CODEC_COUNT; c++) {
        if (c == CWI_ZARR_LZ4_FRAMES || strcmp(bare, names[c]) != 0)
            continue; /* those frames are of N5 alone */
        if (chain->count == CWI_ZARR_CODECS)
            return cwi_fail(err, CW_ERR_LIMIT, "'%s' lists more than %d codecs", key,
                            CWI_ZARR_CODECS);
        chain->codecs[chain->count++] = (cwi_zarr_codec)c;
        return cwi_zarr_codec_check((cwi_zarr_codec)c, err);
    }
    return cwi_fail(err, CW_ERR_FORMAT,
                    "'%s' names the codec '%.40s'; those that are read are zlib, gzip, zstd, "
                    "lz4, blosc, crc32c, bz2",
                    key, name);
}
