/* Tests damaged and hostile precomputed volumes: every error names the file and the key. */
#define _GNU_SOURCE /* symlink */
#include "support/files/reading.h"
#include "support/files/zarr_store.h"

#include <unistd.h>

static const char good[] =
    "{\"@type\": \"neuroglancer_multiscale_volume\", \"type\": \"segmentation\", \"data_type\": "
    "\"uint32\", \"num_channels\": 1, \"scales\": [{\"key\": \"s\", \"size\": [4, 4, 4], "
    "\"resolution\": [8, 8, 40], \"voxel_offset\": [0, 0, 0], \"chunk_sizes\": [[4, 4, 4]], "
    "\"encoding\": \"compressed_segmentation\", \"compressed_segmentation_block_size\": [4, 4, 4], "
    "\"sharding\": {\"@type\": \"neuroglancer_uint64_sharded_v1\", \"preshift_bits\": 0, \"hash\": "
    "\"identity\", \"minishard_bits\": 0, \"shard_bits\": 0}}]}";

/* A chunk of one channel and block: a label for all voxels. */
static const uint32_t chunk[] = {1, 2, 0, 17};

/* Writes metadata with one text replaced by another. */
static void put_changed(const char *old, const char *new)
{
    char changed[2048];
    const char *at = strstr(good, old);
    assert_non_null(at);
    snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - good), good, new,
             at + strlen(old));
    zarr_put_text("store/info", changed);
}

/* Writes a shard of one minishard with one entry: places of its table, then the entry, then the
 * chunk. */
static void put_shard(const uint64_t words[5], const uint32_t *labels, size_t count,
                      size_t size)
{
    unsigned char file[256] = {0};
    for (size_t n = 0; n < 40; n++)
        file[n] = (unsigned char)(words[n / 8] >> 8 * (n % 8));
    for (size_t n = 0; n < 4 * count; n++)
        file[40 + n] = (unsigned char)(labels[n / 4] >> 8 * (n % 4));
    zarr_put("store/s/0.shard", file, size);
}

static void wrong_metadata_are_refused_by_name(void **state)
{
    (void)state;
    static const struct {
        const char *old, *new;
        cw_status status;
        const char *words;
    } changes[] = {
        {"neuroglancer_multiscale_volume", "neuroglancer_multilod_draco", CW_ERR_FORMAT,
         "info: '@type' is \"neuroglancer_multilod_draco\", which is a mesh and no volume; "
         "\"neuroglancer_multiscale_volume\" was expected: name the folder of a volume"},
        {"neuroglancer_multiscale_volume", "neuroglancer_skeletons", CW_ERR_FORMAT,
         "info: '@type' is \"neuroglancer_skeletons\"; \"neuroglancer_multiscale_volume\" was"},
        {"\"neuroglancer_multiscale_volume\"", "\"a volume\"", CW_ERR_FORMAT,
         "'@type' is \"a volume\""},
        {"\"scales\"", "\"scale\"", CW_ERR_FORMAT, "'scales' is missing; a list of scales was"},
        {"segmentation", "mesh", CW_ERR_FORMAT, "info: 'type' is \"mesh\"; \"image\" or"},
        {"uint32", "float64", CW_ERR_FORMAT,
         "info: 'data_type' is float64; the types that are"},
        {"\"uint32\"", "32", CW_ERR_FORMAT, "'data_type' is 32.0; a type such as"},
        {"uint32", "uint16", CW_ERR_FORMAT,
         "info: scales[0]: 'encoding' is \"compressed_segmentation\" and 'data_type' uint16"},
        {"\"num_channels\": 1", "\"num_channels\": 0", CW_ERR_FORMAT, "'num_channels' is 0.0"},
        {"\"num_channels\": 1", "\"num_channels\": 99", CW_ERR_FORMAT, "'size'"},
        {"\"key\": \"s\"", "\"key\": 1", CW_ERR_FORMAT,
         "info: 'key' is 1.0; the path of a folder"},
        {"\"key\": \"s\"", "\"key\": \".\"", CW_ERR_FORMAT, "level 0 is '', where no array is"},
        {"\"size\": [4, 4, 4]", "\"size\": [4, 4]", CW_ERR_FORMAT,
         "info: scales[0]: 'size' lists 2 numbers; 3 were expected"},
        {"\"size\": [4, 4, 4]", "\"size\": [4, 4, 0]", CW_ERR_FORMAT, "scales[0]: 'size' is"},
        {"\"size\": [4, 4, 4]", "\"size\": [4, 4, 16777216000000]", CW_ERR_LIMIT,
         "'size' asks"},
        {"[8, 8, 40]", "[8, 8]", CW_ERR_FORMAT,
         "info: scales[0]: 'resolution' is [8.0,8.0]; a list of three numbers, x, y, z, was"},
        {"[8, 8, 40]", "[8, 0, 40]", CW_ERR_FORMAT,
         "scales[0]: 'resolution' is [8.0,0.0,40.0]; a list of three numbers above 0, in nanom"},
        {"[0, 0, 0]", "[0, 0, 0.5]", CW_ERR_FORMAT,
         "'voxel_offset' is [0.0,0.0,0.5]; a list of three whole numbers was expected"},
        {"[0, 0, 0]", "[0, 0, 1e30]", CW_ERR_FORMAT, "'voxel_offset' is"},
        {"[[4, 4, 4]]", "[4, 4, 4]", CW_ERR_FORMAT,
         "scales[0]: 'chunk_sizes' is [4.0,4.0,4.0]"},
        {"[[4, 4, 4]]", "[]", CW_ERR_FORMAT, "'chunk_sizes' is []; a list with three whole"},
        {"\"compressed_segmentation\"", "\"jpeg\"", CW_ERR_FORMAT,
         "scales[0]: 'encoding' is \"jpeg\"; \"raw\" or \"compressed_segmentation\" was expected"},
        {"\"compressed_segmentation_block_size\": [4, 4, 4]", "\"a\": 1", CW_ERR_FORMAT,
         "'compressed_segmentation_block_size' is missing"},
        {"sharded_v1", "sharded_v2", CW_ERR_FORMAT,
         "scales[0]: sharding: '@type' is \"neuroglancer_uint64_sharded_v2\""},
        {"\"identity\"", "\"md5\"", CW_ERR_FORMAT, "'hash' is \"md5\"; \"identity\" or"},
        {"\"minishard_bits\": 0", "\"minishard_bits\": 33", CW_ERR_FORMAT,
         "'minishard_bits' is 33.0; a whole number from 0 to 32 was expected"},
        {"\"shard_bits\": 0", "\"shard_bits\": 65", CW_ERR_FORMAT, "'shard_bits' is 65.0"},
        {"\"preshift_bits\": 0", "\"preshift_bits\": -1", CW_ERR_FORMAT,
         "'preshift_bits' is -1"},
        {"\"shard_bits\": 0", "\"shard_bits\": 0, \"data_encoding\": \"zstd\"", CW_ERR_FORMAT,
         "'data_encoding' is \"zstd\"; \"raw\" or \"gzip\" was expected"},
        {"{\"@type\"", "{\"@type", CW_ERR_FORMAT, "info: line 1"},
    };
    cw_volume v;
    cw_error err = {0};
    for (size_t n = 0; n < sizeof changes / sizeof *changes; n++) {
        put_changed(changes[n].old, changes[n].new);
        const cw_status st = read_back("store", &v, &err);
        if (st != changes[n].status || !strstr(err.message, changes[n].words))
            fail_msg("%s: %s", changes[n].new, err.message);
    }
}

static void an_index_stays_within_its_shard(void **state)
{
    (void)state;
    static const struct {
        uint64_t
            words[5]; /* start and end of the table, then number, offset, size of the chunk */
        size_t size;
        const char *words_of_error; /* NULL: read */
    } indexes[] = {
        {{0, 24, 0, 24, 16}, 56, NULL},
        {{0, 0, 0, 24, 16}, 56, NULL},  /* no table: the chunk is missing */
        {{0, 24, 5, 24, 16}, 56, NULL}, /* a chunk of another number */
        {{0, 24, 0, 24, 16}, 15, "a shard has 15 bytes; its index alone takes 16"},
        {{0, 24, 0, 24, 17},
         56,
         "a minishard places chunk 0 at byte 40, 17 bytes long; the file"},
        {{0, 24, 0, UINT64_MAX, 16},
         56,
         "a minishard places chunk 0 at byte 15; the index ends at 16"},
        {{0, 24, 0, (uint64_t)1 << 60, 16},
         56,
         "at byte 1152921504606846992, 16 bytes long; the file"},
        {{0, 24, 0, 24, UINT64_MAX}, 56, "18446744073709551615 bytes long"},
        {{0, 41, 0, 24, 16},
         56,
         "places minishard 0 at bytes 0 to 41; the file has 40 behind it"},
        {{24, 0, 0, 24, 16}, 56, "places minishard 0 at bytes 24 to 0"},
        {{0, 23, 0, 24, 16}, 56, "has 23 bytes; a multiple of 24 was expected"},
        {{0, 40, 0, 24, 16}, 56, "has 40 bytes; its chunks take 24 at most"},
        {{0, 24, 0, 24, 3}, 56, "chunk 0: a chunk has 3 bytes; its blocks take 12 to 528"},
    };
    cw_volume v;
    cw_error err = {0};
    zarr_put_text("store/info", good);
    for (size_t n = 0; n < sizeof indexes / sizeof *indexes; n++) {
        put_shard(indexes[n].words, chunk, 4, indexes[n].size);
        const cw_status st = read_back("store", &v, &err);
        if (!indexes[n].words_of_error) {
            assert_ok(st, err);
            assert_int_equal(((const uint32_t *)v.data)[63], n == 0 ? 17 : 0);
            cw_volume_free(&v);
        } else if (st != CW_ERR_FORMAT || !strstr(err.message, indexes[n].words_of_error) ||
                   !strstr(err.message, "s/0.shard: ")) {
            fail_msg("%zu: %s", n, err.message);
        }
    }
}

static void labels_stay_within_their_chunk(void **state)
{
    (void)state;
    static const struct {
        uint32_t words[4];
        const char *words_of_error;
    } chunks[] = {
        {{1, 3, 0, 17}, "block 0 of a chunk has its labels at word 3; its channel has 3 words"},
        {{1, 2 | 1 << 24, 9, 17}, "block 0 of a chunk has its voxels at word 9"},
        {{1, 2 | 1 << 24, UINT32_MAX, 17}, "its voxels at word 4294967295"},
        {{1, 2 | 1 << 24, 1, 17}, "block 0 of a chunk has its labels at word 3"},
        {{1, 2 | 32 << 24, 0, 17}, "block 0 of a chunk has its labels at word 536870916"},
        {{1, 2 | 3 << 24, 0, 17},
         "block 0 of a chunk has 3 bits a voxel; 0, 1, 2, 4, 8, 16 or"},
        {{1, 2 | 64U << 24, 0, 17}, "block 0 of a chunk has 64 bits a voxel"},
        {{3, 2, 0, 17}, "channel 0 of a chunk starts at word 3 of 4; 1 blocks do not fit"},
        {{UINT32_MAX, 2, 0, 17}, "channel 0 of a chunk starts at word 4294967295 of 4"},
    };
    cw_volume v;
    cw_error err = {0};
    zarr_put_text("store/info", good);
    for (size_t n = 0; n < sizeof chunks / sizeof *chunks; n++) {
        put_shard((const uint64_t[]){0, 24, 0, 24, 16}, chunks[n].words, 4, 56);
        const cw_status st = read_back("store", &v, &err);
        if (st != CW_ERR_FORMAT || !strstr(err.message, chunks[n].words_of_error))
            fail_msg("%zu: %s", n, err.message);
    }
}

/* Chunks in files of their own: sizes, drafts, and compression that is not read. */
static void files_are_refused_by_name(void **state)
{
    (void)state;
    static const char raw[] =
        "{\"type\": \"image\", \"data_type\": \"uint8\", \"num_channels\": 1, \"scales\": "
        "[{\"key\": \"s\", \"size\": [4, 4, 2], \"resolution\": [8, 8, 40], \"chunk_sizes\": "
        "[[4, 4, 2]], \"encoding\": \"raw\"}]}";
    cw_volume v;
    cw_error err = {0};
    zarr_put_text("store/info", raw);
    zarr_put("store/s/0-4_0-4_0-2", "0123456789012345678901234567890", 31);
    assert_fails(read_back("store", &v, &err), CW_ERR_FORMAT,
                 "s/0-4_0-4_0-2: a chunk has 31 bytes; 32 were expected", err);
    zarr_put("store/s/0-4_0-4_0-2", "\x1f\x8b\x08\0\0\0\0\0\0\0", 10);
    assert_fails(read_back("store", &v, &err), CW_ERR_FORMAT,
                 "s/0-4_0-4_0-2: a chunk is damaged, or has more than its 32 bytes (gzip)",
                 err);
    unlink(test_path("store/s/0-4_0-4_0-2"));
    zarr_put_text("store/s/0-4_0-4_0-2.br", "packed");
    assert_fails(read_back("store", &v, &err), CW_ERR_UNSUPPORTED,
                 "s/0-4_0-4_0-2: compressed with brotli, which is not read", err);
    assert_int_equal(symlink("/etc/passwd", test_path("store/s/0-4_0-4_0-2")), 0);
    assert_fails(read_back("store", &v, &err), CW_ERR_UNSAFE, "a symbolic link", err);
    zarr_put_text("draft/info", good);
    zarr_put_text("draft/s/0.index", "first");
    assert_fails(read_back("draft", &v, &err), CW_ERR_UNSUPPORTED,
                 "s/0.shard: the index of this shard is a file of its own", err);
    zarr_put_text("store/info", "{\"scales\": [], \"data_type\": 1, \"num_channels\": 1}");
    assert_fails(read_back("store", &v, &err), CW_ERR_FORMAT, "info: 'scales' is []", err);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wrong_metadata_are_refused_by_name),
        cmocka_unit_test(an_index_stays_within_its_shard),
        cmocka_unit_test(labels_stay_within_their_chunk),
        cmocka_unit_test(files_are_refused_by_name),
    };
    return cmocka_run_group_tests(tests, test_folder_make, test_folder_remove);
}
