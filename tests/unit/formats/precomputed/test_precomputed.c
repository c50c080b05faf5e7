/* Tests the reader of Neuroglancer's precomputed volumes on folders that the test writes: numbers,
 * places, scales, shards, compressed labels, and names of segments. */
#include "formats/precomputed/precomputed.h"
#include "formats/precomputed/shard_hash.h"
#include "support/files/reading.h"
#include "support/files/regions.h"
#include "support/files/zarr_store.h"

enum { X = 7, Y = 5, Z = 4, CHUNK_X = 4, CHUNK_Y = 5, CHUNK_Z = 3 };

static const char sharding[] =
    ", \"sharding\": {\"@type\": \"neuroglancer_uint64_sharded_v1\", \"preshift_bits\": 0, "
    "\"hash\": \"identity\", \"minishard_bits\": 1, \"shard_bits\": 1}";

/* Writes `info` of one scale, or of two. */
static void put_info(const char *folder, const char *type, const char *data_type, int channels,
                     const char *more)
{
    char path[256], text[2048], scale[1024];
    snprintf(scale, sizeof scale,
             "{\"key\": \"8_8_40\", \"size\": [%d, %d, %d], \"resolution\": [8, 8, 40], "
             "\"voxel_offset\": [-2, 3, 10], \"chunk_sizes\": [[%d, %d, %d]], \"encoding\": "
             "\"raw\"%s}",
             X, Y, Z, CHUNK_X, CHUNK_Y, CHUNK_Z, more);
    snprintf(text, sizeof text,
             "{\"@type\": \"neuroglancer_multiscale_volume\", \"type\": \"%s\", \"data_type\": "
             "\"%s\", \"num_channels\": %d, \"scales\": [%s]}",
             type, data_type, channels, scale);
    snprintf(path, sizeof path, "%s/info", folder);
    zarr_put_text(path, text);
}

static unsigned value_at(int x, int y, int z, int c)
{
    return (unsigned)(1 + x + 10 * y + 50 * z + 100 * c) % 251;
}

static int end_of(int first, int chunk, int size)
{
    return first + chunk < size ? first + chunk : size;
}

/* Fills a chunk of two bytes a number, and returns its size. */
static size_t fill_chunk(int x0, int y0, int z0, int channels, unsigned char *to)
{
    size_t used = 0;
    for (int c = 0; c < channels; c++)
        for (int z = z0; z < end_of(z0, CHUNK_Z, Z); z++)
            for (int y = y0; y < end_of(y0, CHUNK_Y, Y); y++)
                for (int x = x0; x < end_of(x0, CHUNK_X, X); x++) {
                    to[used++] = (unsigned char)value_at(x, y, z, c);
                    to[used++] = 0;
                }
    return used;
}

/* Writes the chunks as files of their own: every second one compressed, as NAME.gz or as NAME. */
static void put_chunks(const char *folder, int channels)
{
    int count = 0;
    for (int z = 0; z < Z; z += CHUNK_Z)
        for (int x = 0; x < X; x += CHUNK_X, count++) {
            unsigned char chunk[1024];
            char path[256];
            size_t size = fill_chunk(x, 0, z, channels, chunk), packed;
            snprintf(path, sizeof path, "%s/8_8_40/%d-%d_%d-%d_%d-%d%s", folder, x - 2,
                     end_of(x, CHUNK_X, X) - 2, 3, 3 + Y, z + 10, end_of(z, CHUNK_Z, Z) + 10,
                     count == 1 ? ".gz" : "");
            unsigned char *bytes = pack_bytes(chunk, size, true, &packed);
            if (count == 1 || count == 2)
                zarr_put(path, bytes, packed);
            else
                zarr_put(path, chunk, size);
            free(bytes);
        }
}

static void check_numbers(const char *folder, int channels)
{
    cw_volume v, one;
    cw_error err = {0};
    assert_ok(read_back(folder, &v, &err), err);
    assert_int_equal(v.dim[0], X);
    assert_int_equal(v.dim[1], Y);
    assert_int_equal(v.dim[2], Z);
    assert_int_equal(v.components, channels);
    for (int c = 0; c < channels; c++) {
        assert_ok(cw_volume_select(&v, (size_t)c, 0, &one, &err), err);
        for (int z = 0; z < Z; z++)
            for (int y = 0; y < Y; y++)
                for (int x = 0; x < X; x++)
                    assert_int_equal(cw_volume_value(&one, (size_t)x, (size_t)y, (size_t)z),
                                     value_at(x, y, z, c));
    }
    assert_int_equal(v.known & CW_KNOWN_UNIT, CW_KNOWN_UNIT);
    assert_place(&v, 0, 0, 0, -1.5 * 8e-6, 3.5 * 8e-6, 10.5 * 40e-6);
    assert_place(&v, 1, 1, 1, -0.5 * 8e-6, 4.5 * 8e-6, 11.5 * 40e-6);
    cw_volume_free(&v);
}

static void every_chunk_is_found_by_its_place(void **state)
{
    (void)state;
    for (int channels = 1; channels <= 3; channels++) {
        put_info("files", "image", "uint16", channels, "");
        put_chunks("files", channels);
        check_numbers("files", channels);
        check_numbers("files/info", channels);
    }
    put_info("files", "image", "uint16", 1, "");
    put_chunks("files", 1);
    check_regions("files", NULL);
}

static void chunks_that_are_missing_are_zero(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    put_info("empty", "image", "float32", 1, "");
    assert_ok(read_back("empty", &v, &err), err);
    for (size_t n = 0; n < X * Y * Z; n++)
        assert_true(((const float *)v.data)[n] == 0);
    cw_volume_free(&v);
    put_info("empty", "image", "float32", 1, sharding);
    assert_ok(read_back("empty", &v, &err), err);
    assert_true(((const float *)v.data)[X * Y * Z - 1] == 0);
    cw_volume_free(&v);
}

/* --- shards ------------------------------------------------------------------------------- */

static void put_words(unsigned char *to, const uint64_t *words, size_t count)
{
    for (size_t n = 0; n < 8 * count; n++)
        to[n] = (unsigned char)(words[n / 8] >> 8 * (n % 8));
}

/* The chunks of a grid of 2 x 1 x 2 have the numbers 0 to 3: two shards of two minishards. Each
 * minishard here has one chunk, but for the last shard's, which is compressed and whose numbers are
 * shifted by a bit, so that it has two. */
static void put_shards(const char *folder, bool is_packed)
{
    for (uint64_t shard = 0; shard < (is_packed ? 1 : 2); shard++) {
        unsigned char file[4096] = {0};
        uint64_t index[4];
        size_t end = sizeof index;
        char path[256];
        for (uint64_t mini = 0; mini < 2; mini++) {
            uint64_t table[6] = {0};
            unsigned char bytes[48], *encoded;
            const size_t entries = is_packed ? 2 : 1;
            size_t packed;
            for (size_t n = 0; n < entries; n++) {
                const uint64_t number = is_packed ? 2 * mini + n : 2 * shard + mini;
                unsigned char chunk[1024];
                const size_t size =
                    fill_chunk(number & 1 ? CHUNK_X : 0, 0, number & 2 ? CHUNK_Z : 0, 1, chunk);
                encoded = is_packed ? pack_bytes(chunk, size, true, &packed)
                                    : zarr_pack(NULL, chunk, size, 2, &packed);
                table[n] = n ? 1 : number;
                table[entries + n] = n ? 0 : end - sizeof index;
                table[2 * entries + n] = packed;
                memcpy(file + end, encoded, packed);
                end += packed;
                free(encoded);
            }
            put_words(bytes, table, 3 * entries);
            encoded = is_packed ? pack_bytes(bytes, 24 * entries, true, &packed)
                                : zarr_pack(NULL, bytes, 24 * entries, 8, &packed);
            memcpy(file + end, encoded, packed);
            index[2 * mini] = end - sizeof index;
            index[2 * mini + 1] = end + packed - sizeof index;
            end += packed;
            free(encoded);
        }
        put_words(file, index, 4);
        snprintf(path, sizeof path, "%s/8_8_40/%llu.shard", folder, (unsigned long long)shard);
        zarr_put(path, file, end);
    }
}

static void chunks_of_shards_are_found_by_their_numbers(void **state)
{
    (void)state;
    put_info("plain", "image", "uint16", 1, sharding);
    put_shards("plain", false);
    check_numbers("plain", 1);
    check_regions("plain", NULL);
    put_info(
        "packed", "image", "uint16", 1,
        ", \"sharding\": {\"@type\": \"neuroglancer_uint64_sharded_v1\", \"preshift_bits\": "
        "1, \"hash\": \"identity\", \"minishard_bits\": 1, \"shard_bits\": 0, "
        "\"minishard_index_encoding\": \"gzip\", \"data_encoding\": \"gzip\"}");
    put_shards("packed", true);
    check_numbers("packed", 1);
}

/* Hashes as pymmh3 and mmh3 have them, and codes as the specification's example interleaves bits. */
static void numbers_of_chunks_are_those_of_the_specification(void **state)
{
    (void)state;
    static const struct {
        uint64_t number, hash;
    } hashes[] = {{0, 0x4772b084e028ae41}, {1, 0xe8bd67d616d4ce9a}, {42, 0xc20b94f95119f47a}};
    static const struct {
        size_t grid[3], at[3];
        uint64_t code;
    } codes[] = {{{2, 1, 2}, {1, 0, 1}, 3},     {{4, 4, 4}, {3, 3, 3}, 63},
                 {{4, 4, 4}, {2, 0, 1}, 4 + 8}, {{8, 1, 1}, {5, 0, 0}, 5},
                 {{5, 2, 1}, {4, 1, 0}, 8 + 2}, {{3, 100, 2}, {2, 64, 1}, 4 + 8 + 512}};
    for (size_t n = 0; n < sizeof hashes / sizeof *hashes; n++)
        assert_true(cwi_murmur_hash(hashes[n].number) == hashes[n].hash);
    for (size_t n = 0; n < sizeof codes / sizeof *codes; n++) {
        const cwi_chunk_storage whole = {.shard_bits = 64};
        const cwi_shard_place place = cwi_find_shard(&whole, codes[n].grid, codes[n].at);
        if (place.chunk != codes[n].code || place.shard != codes[n].code)
            fail_msg("%zu: the code is %llu", n, (unsigned long long)place.chunk);
    }
}

/* --- labels ------------------------------------------------------------------------------- */

/* A chunk of 3 x 2 x 2 voxels in blocks of 2 x 2 x 2: one with two labels by one bit, and one cut off,
 * with one label by none. */
static void labels_in_blocks_are_decoded(void **state)
{
    (void)state;
    static const uint32_t narrow[] = {1, 5 | 1 << 24, 4, 7, 0, 0xa5, 20, 30, 40};
    static const uint32_t wide[] = {1, 5 | 1 << 24, 4, 9, 0, 0xa5, 20, 1, 30, 2, 40, 3};
    static const unsigned expected[] = {30, 20, 40, 30, 20, 40, 20, 30, 40, 20, 30, 40};
    const size_t sizes[] = {3, 2, 2}, block[] = {2, 2, 2};
    unsigned char bytes[sizeof wide];
    uint32_t labels[12];
    uint64_t wide_labels[12];
    cw_error err = {0};
    for (size_t n = 0; n < sizeof narrow; n++)
        bytes[n] = (unsigned char)(narrow[n / 4] >> 8 * (n % 4));
    assert_ok(cwi_segmentation_decode(bytes, sizeof narrow, sizes, block, 1, 4, labels, &err),
              err);
    for (size_t n = 0; n < 12; n++)
        assert_int_equal(labels[n], expected[n]);
    for (size_t n = 0; n < sizeof wide; n++)
        bytes[n] = (unsigned char)(wide[n / 4] >> 8 * (n % 4));
    assert_ok(
        cwi_segmentation_decode(bytes, sizeof wide, sizes, block, 1, 8, wide_labels, &err),
        err);
    for (size_t n = 0; n < 12; n++)
        assert_true(wide_labels[n] == expected[n] + ((uint64_t)(expected[n] / 10 - 1) << 32));
}

static void segments_bring_their_names(void **state)
{
    (void)state;
    static const char properties[] =
        "{\"@type\": \"neuroglancer_segment_properties\", \"inline\": {\"ids\": [\"7\", \"3\", "
        "\"99999999999\"], \"properties\": [{\"id\": \"area\", \"type\": \"number\", \"data_type\": "
        "\"float32\", \"values\": [1, 2, 3]}, {\"id\": \"name\", \"type\": \"label\", \"values\": "
        "[\"liver\", \"spleen\", \"far\"]}]}}";
    char text[1024];
    cw_label_table table = {0};
    cw_label_ids ids = {0};
    cw_read_desc desc = {.labels = &table};
    cw_volume v;
    cw_error err = {0};
    snprintf(
        text, sizeof text,
        "{\"type\": \"segmentation\", \"data_type\": \"uint64\", \"num_channels\": 1, "
        "\"segment_properties\": \"names\", \"scales\": [{\"key\": \"s\", \"size\": [2, 2, "
        "2], \"resolution\": [1, 1, 1], \"chunk_sizes\": [[2, 2, 2]], \"encoding\": \"raw\"}]}");
    zarr_put_text("organs/info", text);
    zarr_put_text("organs/names/info", properties);
    zarr_put("organs/s/0-2_0-2_0-2",
             "\7\0\0\0\0\0\0\0\3\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0"
             "\7\0\0\0\0\0\0\0\3\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0",
             64);
    assert_ok(cw_volume_read(test_path("organs"), &desc, &v, NULL, &err), err);
    assert_int_equal(v.type, CW_U32);
    assert_int_equal(v.known & CW_KNOWN_LABELS, CW_KNOWN_LABELS);
    assert_int_equal(table.count, 3);
    assert_string_equal(cw_label_find(&table, 0, 3)->name, "spleen");
    assert_string_equal(cw_label_find(&table, 0, 7)->name, "liver");
    assert_true(cw_label_find_name(&table, "far")->id == 99999999999);
    cw_label_table_free(&table);
    cw_volume_free(&v);
    zarr_put("organs/s/0-2_0-2_0-2",
             "\7\0\0\0\1\0\0\0\3\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0"
             "\7\0\0\0\0\0\0\0\3\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0",
             64);
    assert_fails(cw_volume_read(test_path("organs"), &desc, &v, NULL, &err), CW_ERR_FORMAT,
                 "info: 'data_type' is uint64, and a number is 4294967303", err);
    desc.ids = &ids;
    assert_ok(cw_volume_read(test_path("organs"), &desc, &v, NULL, &err), err);
    assert_int_equal(v.type, CW_U32);
    assert_int_equal(((const uint32_t *)v.data)[0], 3); /* the places of 0, 3, 7 and 2^32 + 7 */
    assert_int_equal(((const uint32_t *)v.data)[4], 2);
    cw_label_ids_free(&ids);
    cw_label_table_free(&table);
    cw_volume_free(&v);
}

/* --- scales ------------------------------------------------------------------------------- */

static void a_scale_has_its_size_and_place(void **state)
{
    (void)state;
    static const char text[] =
        "{\"type\": \"image\", \"data_type\": \"UINT8\", \"num_channels\": 1, \"scales\": ["
        "{\"key\": \"fine\", \"size\": [4, 4, 2], \"resolution\": [10, 10, 30], \"chunk_sizes\": "
        "[[64, 64, 64]], \"encoding\": \"raw\"}, "
        "{\"key\": \"deep/coarse\", \"size\": [2, 2, 2], \"resolution\": [20, 20, 30], "
        "\"voxel_offset\": [5, 0, 0], \"chunk_sizes\": [[64, 64, 64]], \"encoding\": \"RAW\"}]}";
    static const struct {
        const char *array;
        size_t level;
    } ways[] = {{NULL, 1}, {"deep/coarse", 0}};
    cw_level *levels;
    size_t count;
    cw_volume v;
    cw_error err = {0};
    zarr_put_text("scales/info", text);
    zarr_put("scales/deep/coarse/5-7_0-2_0-2", "abcdefgh", 8);
    assert_ok(cw_levels_list(test_path("scales"), NULL, &levels, &count, &err), err);
    assert_int_equal(count, 2);
    assert_string_equal(levels[1].name, "deep/coarse");
    assert_string_equal(levels[1].axes, "x y z");
    assert_int_equal(levels[0].shape.dim[0], 4);
    cw_levels_free(levels);
    for (size_t n = 0; n < sizeof ways / sizeof *ways; n++) {
        const cw_read_desc desc = {.array = ways[n].array, .level = ways[n].level};
        assert_ok(cw_volume_read(test_path("scales"), &desc, &v, NULL, &err), err);
        assert_int_equal(v.dim[0], 2);
        assert_memory_equal(v.data, "abcdefgh", 8);
        assert_place(&v, 0, 0, 0, 110e-6, 10e-6, 15e-6);
        cw_volume_free(&v);
    }
    assert_fails(
        cw_volume_read(test_path("scales"), &(cw_read_desc){.level = 2}, &v, NULL, &err),
        CW_ERR_ARGUMENT, "level 2 was asked for; there are 2, from 0", err);
    assert_fails(
        cw_volume_read(test_path("scales"), &(cw_read_desc){.array = "rough"}, &v, NULL, &err),
        CW_ERR_ARGUMENT, "the store has no array 'rough'", err);
}

static void running_out_of_memory_is_an_error(void **state)
{
    (void)state;
    bool failed = true;
    put_info("plain", "image", "uint16", 1, sharding);
    put_shards("plain", false);
    put_info("files", "segmentation", "uint16", 1, "");
    put_chunks("files", 1);
    for (long n = 0; failed; n++) {
        cw_volume v = {0}, w = {0};
        cw_error err = {0};
        cwi_alloc_fail_after(n);
        cw_status st = read_back("plain", &v, &err);
        if (st == CW_OK)
            st = read_back("files", &w, &err);
        failed = cwi_alloc_fail_after(-1);
        if (st != (failed ? CW_ERR_NO_MEMORY : CW_OK))
            fail_msg("allocation %ld: %s", n, err.message);
        cw_volume_free(&v);
        cw_volume_free(&w);
    }
}

int main(void)
{
#define FRESH(test) cmocka_unit_test_setup_teardown(test, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        FRESH(every_chunk_is_found_by_its_place),
        FRESH(chunks_that_are_missing_are_zero),
        FRESH(chunks_of_shards_are_found_by_their_numbers),
        FRESH(numbers_of_chunks_are_those_of_the_specification),
        FRESH(labels_in_blocks_are_decoded),
        FRESH(segments_bring_their_names),
        FRESH(a_scale_has_its_size_and_place),
        FRESH(running_out_of_memory_is_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
