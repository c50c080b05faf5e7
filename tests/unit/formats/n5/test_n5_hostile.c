/* Tests damaged and hostile stores of N5: every error names the file and the key. */
#define _GNU_SOURCE /* symlink */
#include "support/files/reading.h"
#include "support/files/zarr_store.h"

#include <unistd.h>

static const char good[] =
    "{\"dimensions\": [4, 4, 4], \"blockSize\": [4, 4, 2], \"dataType\": "
    "\"uint8\", \"compression\": {\"type\": \"raw\"}}";

/* Writes attributes with one text replaced by another. */
static void put_changed(const char *old, const char *new)
{
    char changed[1024];
    const char *at = strstr(good, old);
    assert_non_null(at);
    snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - good), good, new,
             at + strlen(old));
    zarr_put_text("store.n5/attributes.json", changed);
}

/* Writes the first block. */
static void put_block(const char *header, size_t header_size, size_t body)
{
    char block[256] = {0};
    memcpy(block, header, header_size);
    zarr_put("store.n5/0/0/0", block, header_size + body);
}

#define HEADER "\0\0\0\3\0\0\0\4\0\0\0\4\0\0\0\2"

static void wrong_attributes_are_refused_by_name(void **state)
{
    (void)state;
    static const struct {
        const char *old, *new;
        cw_status status;
        const char *words;
    } changes[] = {
        {"[4, 4, 4]", "[]", CW_ERR_FORMAT,
         "attributes.json: 'dimensions' lists 0 sizes; 1 to 8 are read"},
        {"[4, 4, 4]", "[1, 1, 1, 1, 1, 1, 1, 1, 1]", CW_ERR_FORMAT,
         "'dimensions' lists 9 sizes"},
        {"[4, 4, 4]", "4", CW_ERR_FORMAT, "'dimensions' is 4.0; a list of sizes was expected"},
        {"[4, 4, 4]", "[0, 4, 4]", CW_ERR_FORMAT, "'dimensions' is [0.0,4.0,4.0]"},
        {"[4, 4, 4]", "[4, 4, 1e300]", CW_ERR_FORMAT, "'dimensions' is"},
        {"[4, 4, 4]", "[16777216, 1048576, 4]", CW_ERR_LIMIT, "'dimensions' asks"},
        {"[4, 4, 4]", "[4, 4, 4, 4, 4, 2]", CW_ERR_FORMAT, "'blockSize' lists 3 numbers"},
        {"[4, 4, 2]", "[4, 4]", CW_ERR_FORMAT, "'blockSize' lists 2 numbers; 3 were expected"},
        {"[4, 4, 2]", "[4, 4, 0]", CW_ERR_FORMAT, "'blockSize' is"},
        {"[4, 4, 2]", "\"4\"", CW_ERR_FORMAT, "'blockSize' is \"4\""},
        {"\"uint8\"", "\"uint128\"", CW_ERR_FORMAT,
         "'dataType' is uint128; the types that are"},
        {"\"uint8\"", "\"object\"", CW_ERR_FORMAT, "'dataType' is object"},
        {"\"uint8\"", "7", CW_ERR_FORMAT, "'dataType' is 7.0; a type such as \"uint16\" was"},
        {"\"raw\"", "\"xz\"", CW_ERR_FORMAT,
         "'compression' is 'xz'; those that are read are raw, gzip, zlib, zstd, lz4, blosc, bzip2"},
        {"{\"type\": \"raw\"}", "\"raw\"", CW_ERR_FORMAT,
         "'compression' is \"raw\"; an object with a 'type' was expected"},
        {"\"raw\"}", "\"raw\"}, \"isLabelMultiset\": true", CW_ERR_FORMAT,
         "'isLabelMultiset' is true; false, as sets of labels in a voxel are not read"},
        {"\"raw\"}", "\"raw\"}, \"resolution\": [1, 2]", CW_ERR_FORMAT,
         "attributes.json: 'resolution' lists 2 numbers; 3 were expected"},
        {"\"raw\"}", "\"raw\"}, \"resolution\": [1, \"a\", 1]", CW_ERR_FORMAT,
         "'resolution' has no number at 1"},
        {"\"raw\"}", "\"raw\"}, \"resolution\": [1, 0, 1]", CW_ERR_FORMAT, "'resolution'"},
        {"\"raw\"}", "\"raw\"}, \"pixelResolution\": {}", CW_ERR_FORMAT,
         "'pixelResolution' lists 0 numbers"},
        {"\"raw\"}", "\"raw\"}, \"downsamplingFactors\": [2, 2, -1]", CW_ERR_FORMAT,
         "'downsamplingFactors' has the factor -1; one above 0 was expected"},
        {"\"raw\"}", "\"raw\"}, \"axes\": [\"x\"]", CW_ERR_FORMAT, "'axes' lists 1 names; 3"},
        {"\"raw\"}", "\"raw\"}, \"transform\": {}", CW_ERR_FORMAT,
         "transform: 'axes' is missing; a list of names was expected"},
        {"\"raw\"}", "\"raw\"}, \"transform\": {\"axes\": [\"w\"]}", CW_ERR_FORMAT,
         "transform: 'axes' names 'w', which is no axis of the array"},
        {"\"raw\"}", "\"raw\"}, \"transform\": {\"axes\": [\"x\"], \"scale\": []}",
         CW_ERR_FORMAT,
         "transform: 'scale' is []; a list of numbers, one an axis, was expected"},
        {"{\"dim", "[{\"dim", CW_ERR_FORMAT, "attributes.json: line 1"},
    };
    cw_volume v;
    cw_error err = {0};
    put_block(HEADER, 16, 32);
    for (size_t n = 0; n < sizeof changes / sizeof *changes; n++) {
        put_changed(changes[n].old, changes[n].new);
        assert_fails(read_back("store.n5", &v, &err), changes[n].status, changes[n].words, err);
    }
    zarr_put_text("store.n5/attributes.json", "{\"n5\": \"2.0.0\"}");
    assert_fails(read_back("store.n5", &v, &err), CW_ERR_FORMAT, "the group holds no array",
                 err);
}

static void a_header_says_what_fits(void **state)
{
    (void)state;
    static const struct {
        const char *header;
        size_t size, body;
        const char *words; /* NULL: read */
    } blocks[] = {
        {HEADER, 16, 32, NULL},
        {"\0\1\0\3\0\0\0\4\0\0\0\4\0\0\0\2\0\0\0\x20", 20, 32, NULL},
        {"\0\0\0\3\0\0\0\1\0\0\0\1\0\0\0\1", 16, 1, NULL}, /* the others are 0 */
        {"", 0, 0, "0/0/0: the file is empty"},
        {"\0", 1, 0, "0/0/0: the file ends inside the header of a block"},
        {HEADER, 15, 0, "the file ends inside the header of a block"},
        {"\0\1\0\3\0\0\0\4\0\0\0\4\0\0\0\2\0\0", 18, 0, "ends inside the header"},
        {HEADER, 16, 31, "a chunk has 31 bytes; 32 were expected"},
        {HEADER, 16, 33, "a chunk has 33 bytes; 32 were expected"},
        {"\0\2\0\3\0\0\0\4\0\0\0\4\0\0\0\2", 16, 32, "says mode 2; 0 or 1 was expected"},
        {"\0\0\0\2\0\0\0\4\0\0\0\4\0\0\0\2", 16, 32,
         "says 2 dimensions; the 3 of 'dimensions' were expected"},
        {"\0\0\0\3\0\0\0\4\0\0\0\5\0\0\0\2", 16, 32,
         "says size 5 along dimension 1; 1 to the 'blockSize' of 4 were expected"},
        {"\0\0\0\3\0\0\0\4\0\0\0\0\0\0\0\2", 16, 32, "says size 0 along dimension 1"},
        {"\0\0\0\3\xff\xff\xff\xff\0\0\0\4\0\0\0\2", 16, 32, "says size 4294967295 along"},
        {"\0\1\0\3\0\0\0\4\0\0\0\4\0\0\0\2\0\0\0\x21", 20, 32,
         "says 33 elements; its sizes are 32"},
    };
    cw_volume v;
    cw_error err = {0};
    zarr_put_text("store.n5/attributes.json", good);
    for (size_t n = 0; n < sizeof blocks / sizeof *blocks; n++) {
        put_block(blocks[n].header, blocks[n].size, blocks[n].body);
        const cw_status st = read_back("store.n5", &v, &err);
        if (!blocks[n].words) {
            assert_ok(st, err);
            assert_int_equal(((const uint8_t *)v.data)[63], 0);
            cw_volume_free(&v);
            continue;
        }
        assert_true(st != CW_OK);
        if (!strstr(err.message, blocks[n].words))
            fail_msg("block %zu: %s", n, err.message);
    }
}

/* Blocks of sizes that no memory holds are refused by the size of their file. */
static void lying_sizes_take_no_memory(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    put_block("\0\0\0\3\0\0\x40\0\0\0\x40\0\0\0\0\2", 16, 32);
    put_changed("[4, 4, 4], \"blockSize\": [4, 4, 2]",
                "[4, 4, 4], \"blockSize\": [16384, 16384, 2]");
    assert_fails(read_back("store.n5", &v, &err), CW_ERR_FORMAT,
                 "a chunk has 32 bytes; 536870912 were expected", err);
    put_block("\0\0\0\3\0\1\0\0\0\1\0\0\0\0\0\2", 16, 32);
    put_changed("[4, 4, 4], \"blockSize\": [4, 4, 2]",
                "[4, 4, 4], \"blockSize\": [65536, 65536, 2]");
    assert_fails(read_back("store.n5", &v, &err), CW_ERR_LIMIT,
                 "the header of a block asks for 2 GiB or more", err);
    put_block("\0\0\0\3\0\0\x10\0\0\0\x10\0\0\0\0\2", 16, 32);
    put_changed(
        "[4, 4, 4], \"blockSize\": [4, 4, 2], \"dataType\": \"uint8\", \"compression\": "
        "{\"type\": \"raw\"}",
        "[4, 4, 4], \"blockSize\": [4096, 4096, 2], \"dataType\": \"uint8\", "
        "\"compression\": {\"type\": \"gzip\"}");
    assert_fails(read_back("store.n5", &v, &err), CW_ERR_FORMAT,
                 "a chunk has 32 bytes, too few for its 33554432 bytes", err);
}

static void links_stay_within_the_store(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    const cw_read_desc desc = {.array = "../outside"};
    zarr_put_text("outside/attributes.json", good);
    zarr_put_text("store.n5/attributes.json", good);
    unlink(test_path("store.n5/0/0/0"));
    zarr_put_text("store.n5/0/0/1", "");
    assert_int_equal(symlink("/etc/passwd", test_path("store.n5/0/0/0")), 0);
    assert_fails(read_back("store.n5", &v, &err), CW_ERR_UNSAFE, "0/0/0: a symbolic link", err);
    assert_fails(cw_volume_read(test_path("store.n5"), &desc, &v, NULL, &err), CW_ERR_UNSAFE,
                 "a path with '..'", err);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wrong_attributes_are_refused_by_name),
        cmocka_unit_test(a_header_says_what_fits),
        cmocka_unit_test(lying_sizes_take_no_memory),
        cmocka_unit_test(links_stay_within_the_store),
    };
    return cmocka_run_group_tests(tests, test_folder_make, test_folder_remove);
}
