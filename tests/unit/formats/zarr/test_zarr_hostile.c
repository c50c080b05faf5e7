/* Tests damaged and hostile stores of Zarr: every error names the file and the key. */
#define _GNU_SOURCE /* symlink */
#include "support/files/reading.h"
#include "support/files/zarr_store.h"

#include <unistd.h>

static const char good_v2[] =
    "{\"zarr_format\": 2, \"shape\": [4, 4, 4], \"chunks\": [2, 4, 4], "
    "\"dtype\": \"|u1\", \"order\": \"C\", \"fill_value\": 0, "
    "\"filters\": null, \"compressor\": null}";
static const char good_v3[] =
    "{\"zarr_format\": 3, \"node_type\": \"array\", \"shape\": [4, 4, 4], \"data_type\": "
    "\"uint8\", \"chunk_grid\": {\"name\": \"regular\", \"configuration\": {\"chunk_shape\": "
    "[4, 4, 4]}}, \"chunk_key_encoding\": {\"name\": \"default\"}, \"fill_value\": 0, "
    "\"codecs\": [{\"name\": \"sharding_indexed\", \"configuration\": {\"chunk_shape\": [2, 4, "
    "4], \"codecs\": [{\"name\": \"bytes\"}], \"index_codecs\": [{\"name\": \"bytes\", "
    "\"configuration\": {\"endian\": \"little\"}}, {\"name\": \"crc32c\"}]}}]}";

/* Writes metadata with one text replaced by another. */
static void put_changed(const char *path, const char *text, const char *old, const char *new)
{
    char changed[4096];
    const char *at = strstr(text, old);
    assert_non_null(at);
    snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - text), text, new,
             at + strlen(old));
    zarr_put_text(path, changed);
}

static const struct {
    const char *old, *new;
    cw_status status;
    const char *words;
} changes_v2[] =
    {
        {"2, \"shape\"", "1, \"shape\"", CW_ERR_FORMAT, ".zarray: 'zarr_format' is 1.0; 2 was"},
        {"[4, 4, 4], \"chunks\"", "[], \"chunks\"", CW_ERR_FORMAT, "'shape' has 0 dimensions"},
        {"[4, 4, 4], \"chunks\"", "[0, 4, 4], \"chunks\"", CW_ERR_FORMAT,
         "'shape' is [0.0,4.0,4.0]"},
        {"[4, 4, 4], \"chunks\"", "[-1, 4, 4], \"chunks\"", CW_ERR_FORMAT, "'shape' is"},
        {"[4, 4, 4], \"chunks\"", "\"a\", \"chunks\"", CW_ERR_FORMAT, "'shape' is \"a\""},
        {"[4, 4, 4], \"chunks\"",
         "[9007199254740992, 9007199254740992, 9007199254740992], \"chunks\"", CW_ERR_LIMIT,
         "'shape' asks for more voxels"},
        {"[4, 4, 4], \"chunks\"", "[16777216, 1048576, 4], \"chunks\"", CW_ERR_LIMIT,
         "'shape' asks"},
        {"[2, 4, 4]", "[2, 4]", CW_ERR_FORMAT, "'chunks' lists 2 numbers; 3 were expected"},
        {"[2, 4, 4]", "[2, 4, 0.5]", CW_ERR_FORMAT, "'chunks' is"},
        {"[2, 4, 4]", "[9007199254740992, 9007199254740992, 4]", CW_ERR_LIMIT,
         "'chunks' asks for"},
        {"[2, 4, 4]", "[4000000000, 4, 4]", CW_ERR_FORMAT, "0.0.0: a chunk has 32 bytes"},
        {"[2, 4, 4]", "[2, 4, 5]", CW_ERR_FORMAT,
         "0.0.0: a chunk has 32 bytes; 40 were expected"},
        {"\"|u1\"", "\"<f1\"", CW_ERR_FORMAT, "'dtype' is <f1; the types that are read are"},
        {"\"|u1\"", "[[\"a\", \"<u2\"]]", CW_ERR_FORMAT, "'dtype' is [["},
        {"\"C\"", "\"K\"", CW_ERR_FORMAT, "'order' is \"K\"; \"C\" or \"F\" was expected"},
        {"\"filters\": null", "\"filters\": [{\"id\": \"delta\"}]", CW_ERR_FORMAT,
         "'filters' is"},
        {"\"compressor\": null", "\"compressor\": {\"id\": \"lzma\"}", CW_ERR_FORMAT,
         "'compressor' names the codec 'lzma'; those that are read are"},
        {"\"compressor\": null", "\"compressor\": {\"id\": \"zlib\"}", CW_ERR_FORMAT,
         "a chunk is damaged, or has more than its 32 bytes (zlib)"},
        {"[2, 4, 4], \"dtype\": \"|u1\", \"order\": \"C\", \"fill_value\": 0, \"filters\": null, "
         "\"compressor\": null",
         "[200000, 4, 4], \"dtype\": \"|u1\", \"order\": \"C\", \"fill_value\": 0, \"filters\": null, "
         "\"compressor\": {\"id\": \"zlib\"}",
         CW_ERR_FORMAT, "a chunk has 32 bytes, too few for its 3200000 bytes"},
        {"[2, 4, 4], \"dtype\": \"|u1\", \"order\": \"C\", \"fill_value\": 0, \"filters\": null, "
         "\"compressor\": null",
         "[4000000000, 4, 4], \"dtype\": \"|u1\", \"order\": \"C\", \"fill_value\": 0, \"filters\": "
         "null, \"compressor\": {\"id\": \"zlib\"}",
         CW_ERR_LIMIT, "'chunks' asks for chunks of 64000000000 bytes"},
        {"\"fill_value\": 0", "\"fill_value\": 300", CW_ERR_FORMAT, "'fill_value' is 300"},
        {"\"zarr_format\": 2,", "\"zarr_format\": 2 \"a\"", CW_ERR_FORMAT, ".zarray: line 1"},
},
  changes_v3[] = {
      {"\"array\"", "\"arrow\"", CW_ERR_FORMAT, "zarr.json: 'node_type' is \"arrow\""},
      {"\"zarr_format\": 3", "\"zarr_format\": 4", CW_ERR_FORMAT, "'zarr_format' is 4.0"},
      {"\"uint8\"", "\"bfloat16\"", CW_ERR_FORMAT, "'data_type' is bfloat16"},
      {"\"uint8\"", "{\"name\": \"fixed\"}", CW_ERR_FORMAT, "'data_type' is {"},
      {"\"regular\"", "\"rectangular\"", CW_ERR_FORMAT, "'chunk_grid' is"},
      {"[4, 4, 4]}}", "[4, 4]}}", CW_ERR_FORMAT, "'chunk_shape' lists 2"},
      {"\"default\"", "\"other\"", CW_ERR_FORMAT, "'chunk_key_encoding' is"},
      {"\"default\"}", "\"default\", \"configuration\": {\"separator\": \"..\"}}",
       CW_ERR_FORMAT, "'separator' is \"..\""},
      {"[2, 4, 4], \"codecs\"", "[3, 4, 4], \"codecs\"", CW_ERR_FORMAT,
       "'chunk_shape' of the inner chunks is 3 at 0; a divisor of the shard's 4"},
      {"{\"name\": \"sharding_indexed\"", "{\"name\": \"bytes\"}, {\"name\": \"x\"",
       CW_ERR_FORMAT, "'codecs' names the codec 'x'"},
      {"{\"name\": \"sharding_indexed\"", "{\"name\": \"gzip\"", CW_ERR_FORMAT,
       "'codecs' names 'gzip'; 'transpose', 'bytes' or 'sharding_indexed' was expected first"},
      {"{\"name\": \"bytes\"}]", "{\"name\": \"sharding_indexed\", \"configuration\": {}}]",
       CW_ERR_FORMAT, "'codecs' puts shards into shards"},
      {"{\"name\": \"bytes\"}]",
       "{\"name\": \"transpose\", \"configuration\": {\"order\": [0, 1, "
       "1]}}]",
       CW_ERR_FORMAT, "'order' is [0.0,1.0,1.0]; each dimension once"},
      {"{\"name\": \"bytes\"}]",
       "{\"name\": \"transpose\", \"configuration\": {\"order\": [0, 1, "
       "2]}}]",
       CW_ERR_FORMAT, "'codecs' has no codec that makes bytes"},
      {"{\"name\": \"crc32c\"}]", "{\"name\": \"gzip\"}]", CW_ERR_FORMAT, "'index_codecs' is"},
      {"]}}]}", "], \"index_location\": \"middle\"}}]}", CW_ERR_FORMAT, "'index_location' is"},
      {"]}}]}", "]}}, {\"name\": \"gzip\"}]}", CW_ERR_FORMAT,
       "'codecs' names 'gzip' behind shards"},
      {"\"codecs\": [{\"name\": \"sharding_indexed\"",
       "\"storage_transformers\": [{}], \"codecs\": [{\"name\": \"sharding_indexed\"",
       CW_ERR_FORMAT, "'storage_transformers' is [{}]"},
};

static void wrong_metadata_are_refused_by_name(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    zarr_put("two/0.0.0", "0123456789abcdef0123456789abcdef", 32);
    for (size_t n = 0; n < sizeof changes_v2 / sizeof *changes_v2; n++) {
        put_changed("two/.zarray", good_v2, changes_v2[n].old, changes_v2[n].new);
        assert_fails(read_back("two", &v, &err), changes_v2[n].status, changes_v2[n].words,
                     err);
    }
    for (size_t n = 0; n < sizeof changes_v3 / sizeof *changes_v3; n++) {
        put_changed("three/zarr.json", good_v3, changes_v3[n].old, changes_v3[n].new);
        assert_fails(read_back("three", &v, &err), changes_v3[n].status, changes_v3[n].words,
                     err);
    }
}

/* --- shards ------------------------------------------------------------------------------- */

static void put_shard(const uint64_t words[4], bool good_sum, size_t body)
{
    const size_t size = body + 36;
    unsigned char *bytes = calloc(size, 1);
    uint32_t sum = UINT32_MAX;
    for (size_t n = 0; n < 32; n++) {
        bytes[body + n] = (unsigned char)(words[n / 8] >> 8 * (n % 8));
        sum ^= bytes[body + n];
        for (int bit = 0; bit < 8; bit++)
            sum = sum & 1 ? sum >> 1 ^ 0x82f63b78U : sum >> 1;
    }
    for (size_t b = 0; b < 4; b++)
        bytes[body + 32 + b] = (unsigned char)((~sum + !good_sum) >> 8 * b);
    zarr_put("shard/c/0/0/0", bytes, size);
    free(bytes);
}

static void an_index_stays_within_its_shard(void **state)
{
    (void)state;
    static const struct {
        uint64_t words[4];
        bool good_sum;
        const char *words_of_error; /* NULL: read */
    } indexes[] = {
        {{0, 32, 32, 32}, true, NULL},
        {{0, 32, UINT64_MAX, UINT64_MAX}, true, NULL},
        {{0, 32, 32, 32}, false, "its checksum is wrong"},
        {{0, 32, 100, 32}, true, "places inner chunk 1 at byte 100, 32 bytes long"},
        {{0, 32, UINT64_MAX - 5, 32}, true, "places inner chunk 1 at byte"},
        {{0, 32, 32, UINT64_MAX - 5}, true, "places inner chunk 1 at byte"},
        {{0, 31, 32, 32}, true, "inner chunk 0: a chunk has 31 bytes; 32 were expected"},
    };
    cw_volume v;
    cw_error err = {0};
    zarr_put_text("shard/zarr.json", good_v3);
    for (size_t n = 0; n < sizeof indexes / sizeof *indexes; n++) {
        put_shard(indexes[n].words, indexes[n].good_sum, 64);
        if (indexes[n].words_of_error) {
            assert_fails(read_back("shard", &v, &err), CW_ERR_FORMAT, indexes[n].words_of_error,
                         err);
            assert_non_null(strstr(err.message, "c/0/0/0"));
            continue;
        }
        assert_ok(read_back("shard", &v, &err), err);
        cw_volume_free(&v);
    }
    zarr_put("shard/c/0/0/0", "short", 5);
    assert_fails(read_back("shard", &v, &err), CW_ERR_FORMAT, "a shard has 5 bytes; its index",
                 err);
}

/* --- places outside the store ------------------------------------------------------------- */

static void put_level(const char *path)
{
    char text[512];
    zarr_put_text("store/.zgroup", "{\"zarr_format\": 2}");
    snprintf(text, sizeof text, "{\"multiscales\": [{\"datasets\": [{\"path\": \"%s\"}]}]}",
             path);
    zarr_put_text("store/.zattrs", text);
}

static void paths_and_links_stay_within_the_store(void **state)
{
    (void)state;
    cw_read_desc desc = {0};
    cw_volume v;
    cw_error err = {0};
    zarr_put_text("outside/.zarray", good_v2);
    put_level("../outside");
    assert_fails(read_back("store", &v, &err), CW_ERR_UNSAFE, "a path with '..'", err);
    put_level("/etc");
    assert_fails(read_back("store", &v, &err), CW_ERR_UNSAFE, "an absolute path", err);
    put_level("linked");
    assert_int_equal(symlink("../outside", test_path("store/linked")), 0);
    assert_fails(read_back("store", &v, &err), CW_ERR_IO, "is a link", err);
    desc.allow_external = true;
    assert_ok(cw_volume_read(test_path("store"), &desc, &v, NULL, &err), err);
    cw_volume_free(&v);
    put_level("missing");
    assert_fails(read_back("store", &v, &err), CW_ERR_FORMAT,
                 "level 0 is 'missing', where no array is", err);
    desc = (cw_read_desc){.array = "../outside"};
    assert_fails(cw_volume_read(test_path("store"), &desc, &v, NULL, &err), CW_ERR_UNSAFE,
                 "a path with '..'", err);
    zarr_put_text("chunk/.zarray", good_v2);
    assert_int_equal(symlink("/etc/passwd", test_path("chunk/0.0.0")), 0);
    assert_fails(read_back("chunk", &v, &err), CW_ERR_UNSAFE, "0.0.0: a symbolic link", err);
}

static void nested_groups_have_limits(void **state)
{
    (void)state;
    char path[256] = "deep";
    cw_volume v;
    cw_error err = {0};
    for (int depth = 0; depth < 12; depth++) {
        char name[300];
        snprintf(name, sizeof name, "%s/.zgroup", path);
        zarr_put_text(name, "{\"zarr_format\": 2}");
        snprintf(path + strlen(path), sizeof path - strlen(path), "/g");
    }
    assert_fails(read_back("deep", &v, &err), CW_ERR_FORMAT, "the group holds no array", err);
    put_level("0");
    zarr_put_text("store/.zattrs", "{\"multiscales\": [{\"datasets\": []}]}");
    assert_fails(read_back("store", &v, &err), CW_ERR_FORMAT, "'multiscales' has no 'datasets'",
                 err);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wrong_metadata_are_refused_by_name),
        cmocka_unit_test(an_index_stays_within_its_shard),
        cmocka_unit_test(paths_and_links_stay_within_the_store),
        cmocka_unit_test(nested_groups_have_limits),
    };
    return cmocka_run_group_tests(tests, test_folder_make, test_folder_remove);
}
