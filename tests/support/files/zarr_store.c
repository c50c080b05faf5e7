/* Writes stores of Zarr for tests, chunk by chunk, in the plainest way. */
#include "support/files/zarr_store.h"

#include "formats/bytes/stored_numbers.h"
#include "support/files/reading.h"

#include <errno.h>
#include <sys/stat.h>
#if CW_TEST_ZSTD
#include <zstd.h>
#endif
#if CW_TEST_LZ4
#include <lz4.h>
#endif
#if CW_TEST_BLOSC
#include <blosc.h>
#endif

void zarr_put(const char *path, const void *bytes, size_t size)
{
    char whole[4096];
    snprintf(whole, sizeof whole, "%s", test_path(path));
    for (char *s = whole + strlen(whole) - strlen(path); (s = strchr(s, '/')); s++) {
        *s = '\0';
        assert_true(mkdir(whole, 0777) == 0 || errno == EEXIST);
        *s = '/';
    }
    test_file_write(whole, bytes, size);
}

void zarr_put_text(const char *path, const char *text)
{
    zarr_put(path, text, strlen(text));
}

bool zarr_can_write(const char *codec)
{
    return !codec || strcmp(codec, "zlib") == 0 || strcmp(codec, "gzip") == 0 ||
           (CW_TEST_ZSTD && strcmp(codec, "zstd") == 0) ||
           (CW_TEST_LZ4 && strcmp(codec, "lz4") == 0) ||
           (CW_TEST_BLOSC && strcmp(codec, "blosc") == 0);
}

void *zarr_pack(const char *codec, const void *bytes, size_t size, size_t number,
                size_t *packed)
{
    const size_t room = 2 * size + 1000;
    unsigned char *out = malloc(room);
    assert_non_null(out);
    *packed = size;
    (void)number;
    if (!codec) {
        memcpy(out, bytes, size);
    } else if (strcmp(codec, "zlib") == 0 || strcmp(codec, "gzip") == 0) {
        free(out);
        return pack_bytes(bytes, size, codec[0] == 'g', packed);
#if CW_TEST_ZSTD
    } else if (strcmp(codec, "zstd") == 0) {
        *packed = ZSTD_compress(out, room, bytes, size, 3);
        assert_false(ZSTD_isError(*packed));
#endif
#if CW_TEST_LZ4
    } else if (strcmp(codec, "lz4") == 0) {
        for (int b = 0; b < 4; b++)
            out[b] = (unsigned char)(size >> 8 * b);
        *packed =
            4 + (size_t)LZ4_compress_default(bytes, (char *)out + 4, (int)size, (int)room - 4);
#endif
#if CW_TEST_BLOSC
    } else if (strcmp(codec, "blosc") == 0) {
        const int got =
            blosc_compress_ctx(5, BLOSC_SHUFFLE, number, size, bytes, out, room, "lz4", 0, 1);
        assert_true(got > 0);
        *packed = (size_t)got;
#endif
    } else {
        fail_msg("no codec %s", codec);
    }
    return out;
}

/* Computes CRC-32C bit by bit, to check the fast one. */
static uint32_t find_crc32c(const unsigned char *bytes, size_t size)
{
    uint32_t value = UINT32_MAX;
    for (size_t n = 0; n < size; n++) {
        value ^= bytes[n];
        for (int bit = 0; bit < 8; bit++)
            value = value & 1 ? value >> 1 ^ 0x82f63b78U : value >> 1;
    }
    return ~value;
}

static unsigned char *add_crc(unsigned char *bytes, size_t *size)
{
    const uint32_t sum = find_crc32c(bytes, *size);
    bytes = realloc(bytes, *size + 4);
    assert_non_null(bytes);
    for (int b = 0; b < 4; b++)
        bytes[*size + (size_t)b] = (unsigned char)(sum >> 8 * b);
    *size += 4;
    return bytes;
}

/* --- numbers ------------------------------------------------------------------------------ */

static size_t number_bytes(const zarr_made *m)
{
    return (size_t)(m->kind[1] - '0');
}

/* Stores a number byte by byte. */
static void store_number(const zarr_made *m, double value, unsigned char *to)
{
    const size_t size = number_bytes(m);
    uint64_t bits = (uint64_t)(int64_t)value;
    if (m->kind[0] == 'f' && size == 2) {
        bits = cwi_stored_half(value);
    } else if (m->kind[0] == 'f' && size == 8) {
        memcpy(&bits, &value, 8);
    } else if (m->kind[0] == 'f') {
        const float single = (float)value;
        uint32_t low;
        memcpy(&low, &single, 4);
        bits = low;
    }
    for (size_t b = 0; b < size; b++)
        to[m->big_endian ? size - 1 - b : b] = (unsigned char)(bits >> 8 * b);
}

double zarr_mixed(const zarr_made *m, const size_t at[ZARR_MAX_RANK])
{
    uint64_t hash = 17;
    for (size_t d = 0; d < m->rank; d++)
        hash = (hash + at[d] + 1) * 0x9e3779b97f4a7c15U;
    const double value = (double)(hash >> 57); /* 0 to 127 */
    return m->kind[0] == 'b' ? (double)(hash >> 63) : m->kind[0] == 'f' ? value / 4 : value;
}

/* --- chunks ------------------------------------------------------------------------------- */

static bool is_sharded(const zarr_made *m)
{
    return m->inner[0] > 0;
}

static const size_t *inner_size(const zarr_made *m)
{
    return is_sharded(m) ? m->inner : m->chunk;
}

/* Returns true if the inner chunk at these indices is left out. */
static bool is_left_out(const zarr_made *m, const size_t at[ZARR_MAX_RANK])
{
    size_t sum = 0;
    for (size_t d = 0; d < m->rank; d++)
        sum = 7 * sum + at[d];
    return m->left_out && sum % m->left_out == m->left_out - 1;
}

double zarr_value(const zarr_made *m, const size_t at[ZARR_MAX_RANK])
{
    size_t chunk[ZARR_MAX_RANK] = {0};
    for (size_t d = 0; d < m->rank; d++)
        chunk[d] = at[d] / inner_size(m)[d];
    return is_left_out(m, chunk) ? m->fill_value : m->value(m, at);
}

/* Counts through a box of sizes in an order of dimensions, the last of them fastest; false at the
 * end. */
static bool next_index(size_t rank, const size_t *size, const size_t *order, size_t *at)
{
    for (size_t n = rank; n > 0; n--) {
        const size_t d = order[n - 1];
        if (++at[d] < size[d])
            return true;
        at[d] = 0;
    }
    return false;
}

/* Encodes an inner chunk. Numbers beyond the shape are 99. */
static unsigned char *make_chunk(const zarr_made *m, const size_t index[ZARR_MAX_RANK],
                                 size_t *packed)
{
    size_t count = 1, at[ZARR_MAX_RANK] = {0}, n = 0;
    for (size_t d = 0; d < m->rank; d++)
        count *= inner_size(m)[d];
    unsigned char *numbers = malloc(count * number_bytes(m));
    assert_non_null(numbers);
    do {
        size_t voxel[ZARR_MAX_RANK];
        bool inside = true;
        for (size_t d = 0; d < m->rank; d++) {
            voxel[d] = index[d] * inner_size(m)[d] + at[d];
            inside &= voxel[d] < m->shape[d];
        }
        store_number(m, inside ? m->value(m, voxel) : 99, numbers + n++ * number_bytes(m));
    } while (next_index(m->rank, inner_size(m), m->order, at));
    unsigned char *out =
        zarr_pack(m->codec, numbers, count * number_bytes(m), number_bytes(m), packed);
    free(numbers);
    return m->has_crc && m->version == 3 ? add_crc(out, packed) : out;
}

static void name_chunk(const zarr_made *m, const size_t at[ZARR_MAX_RANK], char name[512])
{
    size_t used = (size_t)snprintf(name, 512, "%s/", m->name);
    if (m->version == 3 && !m->keys_of_v2)
        used += (size_t)snprintf(name + used, 512 - used, "c%c", m->separator);
    for (size_t d = 0; d < m->rank; d++)
        used += (size_t)snprintf(name + used, 512 - used, "%s%zu",
                                 d == 0 ? "" : (char[2]){m->separator, 0}, at[d]);
}

static void put_word(unsigned char *to, uint64_t word)
{
    for (int b = 0; b < 8; b++)
        to[b] = (unsigned char)(word >> 8 * b);
}

/* Writes a shard; none where all of its inner chunks are left out. */
static void write_shard(const zarr_made *m, const size_t shard[ZARR_MAX_RANK])
{
    char name[512];
    size_t along[ZARR_MAX_RANK], at[ZARR_MAX_RANK] = {0}, count = 1, n = 0, size = 0;
    unsigned char *body = NULL;
    bool any = false;
    for (size_t d = 0; d < m->rank; d++)
        count *= along[d] = m->chunk[d] / m->inner[d];
    size_t index_size = 16 * count;
    const size_t start = m->index_at_start ? index_size + (m->has_crc ? 4 : 0) : 0;
    unsigned char *index = malloc(index_size);
    do {
        size_t chunk_index[ZARR_MAX_RANK], packed;
        for (size_t d = 0; d < m->rank; d++)
            chunk_index[d] = shard[d] * along[d] + at[d];
        if (is_left_out(m, chunk_index)) {
            memset(index + 16 * n++, 255, 16);
            continue;
        }
        unsigned char *chunk = make_chunk(m, chunk_index, &packed);
        put_word(index + 16 * n, start + size);
        put_word(index + 16 * n++ + 8, packed);
        body = realloc(body, size + packed);
        assert_non_null(body);
        memcpy(body + size, chunk, packed);
        size += packed;
        any = true;
        free(chunk);
    } while (next_index(m->rank, along, m->order, at));
    if (m->has_crc)
        index = add_crc(index, &index_size);
    unsigned char *all = malloc(index_size + size);
    assert_non_null(all);
    memcpy(all + (m->index_at_start ? 0 : size), index, index_size);
    if (size)
        memcpy(all + (m->index_at_start ? index_size : 0), body, size);
    name_chunk(m, shard, name);
    if (any)
        zarr_put(name, all, index_size + size);
    free(index);
    free(body);
    free(all);
}

/* --- metadata ----------------------------------------------------------------------------- */

static const char *list_sizes(const size_t *sizes, size_t count, const size_t *order)
{
    static char texts[4][128];
    static int next;
    char *text = texts[next++ % 4];
    size_t used = 0;
    for (size_t n = 0; n < count; n++)
        used += (size_t)snprintf(text + used, 128 - used, "%s%zu", n ? ", " : "",
                                 sizes[order ? order[n] : n]);
    return text;
}

static void write_v2(const zarr_made *m)
{
    char text[2048], name[256];
    const bool falls = m->rank > 1 && m->order[0] > m->order[1];
    snprintf(
        text, sizeof text,
        "{\"zarr_format\": 2, \"shape\": [%s], \"chunks\": [%s], \"dtype\": \"%s%s\", "
        "\"order\": \"%s\", \"fill_value\": %s, \"filters\": null, \"compressor\": %s%s%s, "
        "\"dimension_separator\": \"%c\"}",
        list_sizes(m->shape, m->rank, NULL), list_sizes(m->chunk, m->rank, NULL),
        m->kind[1] == '1' ? "|"
        : m->big_endian   ? ">"
                          : "<",
        m->kind, falls ? "F" : "C", m->fill ? m->fill : "0", m->codec ? "{\"id\": \"" : "null",
        m->codec ? m->codec : "", m->codec ? "\"}" : "", m->separator);
    snprintf(name, sizeof name, "%s/.zarray", m->name);
    zarr_put_text(name, text);
    if (!m->names)
        return;
    snprintf(text, sizeof text, "{\"_ARRAY_DIMENSIONS\": %s}", m->names);
    snprintf(name, sizeof name, "%s/.zattrs", m->name);
    zarr_put_text(name, text);
}

static const char *type_name(const zarr_made *m)
{
    static char name[40];
    const char *const kind = m->kind[0] == 'u' ? "uint" : m->kind[0] == 'i' ? "int" : "float";
    if (m->kind[0] == 'b')
        return "bool";
    snprintf(name, sizeof name, "%s%zu", kind, 8 * number_bytes(m));
    return name;
}

static void write_v3(const zarr_made *m)
{
    static const char crc[] = ", {\"name\": \"crc32c\"}";
    char text[4096], codecs[1024], name[256];
    const char *const endian = m->big_endian ? "big" : "little";
    snprintf(codecs, sizeof codecs,
             "{\"name\": \"bytes\", \"configuration\": {\"endian\": \"%s\"}}%s%s%s%s", endian,
             m->codec ? ", {\"name\": \"" : "", m->codec ? m->codec : "",
             m->codec ? "\", \"configuration\": {\"level\": 3}}" : "", m->has_crc ? crc : "");
    size_t used = (size_t)snprintf(
        text, sizeof text,
        "{\"zarr_format\": 3, \"node_type\": \"array\", \"shape\": [%s], \"data_type\": \"%s\", "
        "\"chunk_grid\": {\"name\": \"regular\", \"configuration\": {\"chunk_shape\": [%s]}}, "
        "\"chunk_key_encoding\": {\"name\": \"%s\", \"configuration\": {\"separator\": "
        "\"%c\"}}, \"fill_value\": %s, \"attributes\": {}, %s%s%s\"codecs\": [{\"name\": "
        "\"transpose\", \"configuration\": {\"order\": [%s]}}, ",
        list_sizes(m->shape, m->rank, NULL), type_name(m), list_sizes(m->chunk, m->rank, NULL),
        m->keys_of_v2 ? "v2" : "default", m->separator, m->fill ? m->fill : "0",
        m->names ? "\"dimension_names\": " : "", m->names ? m->names : "", m->names ? ", " : "",
        list_sizes(m->order, m->rank, NULL));
    if (is_sharded(m))
        used += (size_t)snprintf(
            text + used, sizeof text - used,
            "{\"name\": \"sharding_indexed\", \"configuration\": {\"chunk_shape\": [%s], "
            "\"index_location\": \"%s\", \"index_codecs\": [{\"name\": \"bytes\", "
            "\"configuration\": {\"endian\": \"little\"}}%s], \"codecs\": [%s]}}",
            list_sizes(m->inner, m->rank, m->order), m->index_at_start ? "start" : "end",
            m->has_crc ? crc : "", codecs);
    else
        used += (size_t)snprintf(text + used, sizeof text - used, "%s", codecs);
    snprintf(text + used, sizeof text - used, "]}");
    snprintf(name, sizeof name, "%s/zarr.json", m->name);
    zarr_put_text(name, text);
}

void zarr_write(const zarr_made *m)
{
    static const size_t plain[ZARR_MAX_RANK] = {0, 1, 2, 3, 4};
    size_t counts[ZARR_MAX_RANK], at[ZARR_MAX_RANK] = {0};
    if (m->version == 2)
        write_v2(m);
    else
        write_v3(m);
    for (size_t d = 0; d < m->rank; d++)
        counts[d] = (m->shape[d] - 1) / m->chunk[d] + 1;
    do {
        char name[512];
        size_t packed;
        if (is_sharded(m)) {
            write_shard(m, at);
            continue;
        }
        if (is_left_out(m, at))
            continue;
        unsigned char *chunk = make_chunk(m, at, &packed);
        name_chunk(m, at, name);
        zarr_put(name, chunk, packed);
        free(chunk);
    } while (next_index(m->rank, counts, plain, at));
}
