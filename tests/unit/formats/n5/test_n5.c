/* Tests the reader of N5 on stores that the test writes block by block: numbers, frames, levels,
 * groups, and data of other writers. */
#include "support/files/reading.h"
#include "support/files/regions.h"
#include "support/files/zarr_store.h"

enum { MAX_RANK = 5 };

/* An array to be written. Lists are in the order of N5, x first. */
typedef struct n5_made {
    const char *name;
    const char *kind;        /* "u1", "i2", "f4" ... */
    const char *compression; /* as N5 names it */
    size_t rank;
    size_t dims[MAX_RANK], block[MAX_RANK];
    bool is_counted;   /* blocks say the number of their elements */
    bool is_whole;     /* blocks at the ends have all their voxels */
    unsigned left_out; /* every n-th block; 0: none */
    const char *more;  /* further attributes */
} n5_made;

static double value_at(const size_t at[MAX_RANK])
{
    return (double)((1 + at[0] + 3 * at[1] + 7 * at[2] + 11 * at[3] + 17 * at[4]) % 101);
}

static size_t put_number(unsigned char *to, uint64_t number, size_t bytes)
{
    for (size_t n = 0; n < bytes; n++)
        to[n] = (unsigned char)(number >> 8 * (bytes - 1 - n));
    return bytes;
}

static size_t put_value(const n5_made *m, double value, unsigned char *to)
{
    const size_t bytes = (size_t)(m->kind[1] - '0');
    const float single = (float)value;
    uint64_t bits = (uint64_t)value;
    uint32_t narrow;
    memcpy(&narrow, &single, sizeof narrow);
    if (m->kind[0] == 'f' && bytes == 8)
        memcpy(&bits, &value, sizeof bits);
    else if (m->kind[0] == 'f')
        bits = narrow;
    return put_number(to, bits, bytes);
}

static const char *codec_of(const char *compression)
{
    return strcmp(compression, "raw") == 0 ? NULL : compression;
}

/* Writes the block at a place of the grid. */
static void put_block(const n5_made *m, const size_t index[MAX_RANK])
{
    unsigned char *numbers, header[4 + 4 * MAX_RANK + 4], *all, *body;
    size_t sizes[MAX_RANK] = {1, 1, 1, 1, 1}, count = 1, used = 0, head = 0, packed;
    char path[256];
    head += put_number(header, m->is_counted, 2);
    head += put_number(header + head, m->rank, 2);
    for (size_t d = 0; d < m->rank; d++) {
        const size_t left = m->dims[d] - index[d] * m->block[d];
        sizes[d] = m->is_whole || left > m->block[d] ? m->block[d] : left;
        count *= sizes[d];
        head += put_number(header + head, sizes[d], 4);
    }
    if (m->is_counted)
        head += put_number(header + head, count, 4);
    numbers = malloc(8 * count);
    assert_non_null(numbers);
    for (size_t n = 0; n < count; n++) {
        size_t at[MAX_RANK] = {0}, rest = n;
        for (size_t d = 0; d < m->rank; d++) {
            at[d] = index[d] * m->block[d] + rest % sizes[d];
            rest /= sizes[d];
        }
        used += put_value(m, value_at(at), numbers + used);
    }
    body =
        zarr_pack(codec_of(m->compression), numbers, used, (size_t)(m->kind[1] - '0'), &packed);
    all = malloc(head + packed);
    assert_non_null(all);
    memcpy(all, header, head);
    memcpy(all + head, body, packed);
    size_t end = (size_t)snprintf(path, sizeof path, "%s", m->name);
    for (size_t d = 0; d < m->rank; d++)
        end += (size_t)snprintf(path + end, sizeof path - end, "/%zu", index[d]);
    zarr_put(path, all, head + packed);
    free(numbers);
    free(body);
    free(all);
}

static void list_numbers(const size_t *numbers, size_t count, char text[64])
{
    size_t used = 0;
    for (size_t n = 0; n < count; n++)
        used += (size_t)snprintf(text + used, 64 - used, "%s%zu", n ? ", " : "", numbers[n]);
}

static bool is_left_out(const n5_made *m, size_t number)
{
    return m->left_out && number % m->left_out == m->left_out - 1;
}

static void write_n5(const n5_made *m)
{
    char path[256], text[1024], dims[64], block[64];
    size_t blocks = 1, counts[MAX_RANK];
    const char *kind = m->kind[0] == 'u' ? "uint" : m->kind[0] == 'i' ? "int" : "float";
    list_numbers(m->dims, m->rank, dims);
    list_numbers(m->block, m->rank, block);
    snprintf(path, sizeof path, "%s/attributes.json", m->name);
    snprintf(text, sizeof text,
             "{\"dimensions\": [%s], \"blockSize\": [%s], \"dataType\": \"%s%d\", "
             "\"compression\": {\"type\": \"%s\"}%s%s}",
             dims, block, kind, 8 * (m->kind[1] - '0'), m->compression, m->more ? ", " : "",
             m->more ? m->more : "");
    zarr_put_text(path, text);
    for (size_t d = 0; d < m->rank; d++)
        blocks *= counts[d] = (m->dims[d] - 1) / m->block[d] + 1;
    for (size_t n = 0; n < blocks; n++) {
        size_t index[MAX_RANK] = {0}, rest = n;
        for (size_t d = 0; d < m->rank; d++) {
            index[d] = rest % counts[d];
            rest /= counts[d];
        }
        if (!is_left_out(m, n))
            put_block(m, index);
    }
}

/* Returns the number that a store has at a place, which is 0 in blocks that are left out. */
static double find_value(const n5_made *m, const size_t at[MAX_RANK])
{
    size_t number = 0;
    for (size_t d = m->rank; d > 0; d--)
        number =
            number * ((m->dims[d - 1] - 1) / m->block[d - 1] + 1) + at[d - 1] / m->block[d - 1];
    return is_left_out(m, number) ? 0 : value_at(at);
}

static void check_numbers(const n5_made *m)
{
    cw_volume v, resolved;
    cw_error err = {0};
    size_t at[MAX_RANK], n = 0;
    assert_ok(read_back(m->name, &v, &err), err);
    const size_t all[MAX_RANK] = {v.dim[0], v.dim[1], v.dim[2], v.components, v.steps};
    for (size_t d = 0; d < MAX_RANK; d++)
        assert_int_equal(all[d], d < m->rank ? m->dims[d] : 1);
    for (at[4] = 0; at[4] < all[4]; at[4]++)
        for (at[3] = 0; at[3] < all[3]; at[3]++)
            for (at[2] = 0; at[2] < all[2]; at[2]++)
                for (at[1] = 0; at[1] < all[1]; at[1]++)
                    for (at[0] = 0; at[0] < all[0]; at[0]++, n++) {
                        const cw_volume line = {
                            .data = v.data, .type = v.type, .dim = {n + 1, 1, 1}};
                        assert_int_equal(cw_volume_resolve(&line, &resolved, NULL), CW_OK);
                        if (cw_volume_value(&resolved, n, 0, 0) != find_value(m, at))
                            fail_msg("%s: number %zu is %g, not %g", m->name, n,
                                     cw_volume_value(&resolved, n, 0, 0), find_value(m, at));
                    }
    cw_volume_free(&v);
}

static void every_number_is_that_of_the_writer(void **state)
{
    (void)state;
    static const char *const kinds[] = {"u1", "i1", "u2", "i2", "u4",
                                        "i4", "u8", "i8", "f4", "f8"};
    static const char *const compressions[] = {"raw", "gzip", "zlib", "zstd", "blosc"};
    static const size_t blocks[][MAX_RANK] = {
        {4, 3, 2, 1, 1}, {5, 7, 6, 3, 2}, {9, 4, 8, 5, 3}, {1, 20, 3, 2, 1}};
    static const size_t dims[MAX_RANK] = {9, 7, 6, 3, 2};
    int n = 0;
    for (size_t c = 0; c < sizeof compressions / sizeof *compressions; c++)
        for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++, n++) {
            char name[24];
            n5_made m = {.name = name,
                         .kind = kinds[k],
                         .compression = compressions[c],
                         .rank = 1 + (size_t)n % MAX_RANK,
                         .is_counted = n & 1,
                         .is_whole = n & 2,
                         .left_out = n % 3 ? 0 : 3};
            if (!zarr_can_write(codec_of(m.compression)))
                continue;
            snprintf(name, sizeof name, "numbers%d.n5", n);
            memcpy(m.dims, dims, sizeof dims);
            memcpy(m.block, blocks[n % 4], sizeof m.block);
            write_n5(&m);
            check_numbers(&m);
        }
}

static void a_region_has_its_blocks(void **state)
{
    (void)state;
    const n5_made m = {.name = "region.n5",
                       .kind = "u2",
                       .compression = "gzip",
                       .rank = 3,
                       .dims = {13, 11, 9},
                       .block = {4, 5, 3}};
    write_n5(&m);
    check_regions("region.n5", NULL);
}

/* Data of other writers: the examples of the specification of N5, and frames of lz4-java, which stand
 * raw where they would not shrink. */
static void blocks_of_other_writers_are_read(void **state)
{
    (void)state;
    static const struct {
        const char *compression, *bytes;
        size_t size;
        const char *dims;
        uint16_t numbers[3];
    } cases[] = {
        {"raw", "\0\1\0\2\0\3\0\4\0\5\0\6", 12, "1, 2, 3", {1, 2, 6}},
        {"bzip2",
         "BZh91AY&SY\x02\x3e\x0d\xd2\0\0\0\x40\0\x7f\0\x20\0\x31\x0c\x01\x0d\x31\xa8\x73\x94\x33"
         "\x7c\x5d\xc9\x14\xe1\x42\x40\x08\xf8\x37\x48",
         43,
         "1, 2, 3",
         {1, 2, 6}},
        {"gzip",
         "\x1f\x8b\x08\0\0\0\0\0\0\0\x63\x60\x64\x60\x62\x60\x66\x60\x61\x60\x65\x60\x03\0\xaa"
         "\xea\x6d\xbf\x0c\0\0\0",
         32,
         "1, 2, 3",
         {1, 2, 6}},
        {"lz4",
         "LZ4Block\x16\x0c\0\0\0\x0c\0\0\0\x90\x25\x8b\x06\0\x01\0\x02\0\x03\0\x04\0\x05\0\x06"
         "LZ4Block\x16\0\0\0\0\0\0\0\0\0\0\0\0",
         54,
         "1, 2, 3",
         {1, 2, 6}},
        {"lz4",
         "LZ4Block\x26\x0e\0\0\0\x40\0\0\0\xcb\xb1\x9f\x04\x4f\0\x01\0\x02\x04\0\x24\x50\x02\0"
         "\x01\0\x02LZ4Block\x26\x0e\0\0\0\x20\0\0\0\xbc\x41\x6f\x02\x4f\0\x01\0\x02\x04\0\x04"
         "\x50\x02\0\x01\0\x02LZ4Block\x16\0\0\0\0\0\0\0\0\0\0\0\0",
         91,
         "4, 4, 3",
         {1, 2, 2}},
        {"bzip2",
         "BZh91AY&SY\x0a\xb1\x93\x99\0\0\x05\xc0\0\x70\0\x20\0\x20\xa5\x34\x19\x8c\x58\xb0\xbc"
         "\x5d\xc9\x14\xe1\x42\x40\x2a\xc6\x4e\x64"
         "BZh91AY&SY\x0a\xb1\x93\x99\0\0\x05\xc0\0\x70\0\x20\0\x20\xa5\x34\x19\x8c\x58\xb0\xbc"
         "\x5d\xc9\x14\xe1\x42\x40\x2a\xc6\x4e\x64",
         82,
         "4, 4, 3",
         {1, 2, 2}},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        unsigned char block[256] = {0, 0, 0, 3};
        char text[256];
        unsigned sizes[3];
        cw_volume v;
        cw_error err = {0};
        snprintf(text, sizeof text,
                 "{\"dimensions\": [%s], \"blockSize\": [%s], \"dataType\": \"uint16\", "
                 "\"compression\": {\"type\": \"%s\"}}",
                 cases[n].dims, cases[n].dims, cases[n].compression);
        zarr_put_text("other/attributes.json", text);
        assert_int_equal(sscanf(cases[n].dims, "%u, %u, %u", sizes, sizes + 1, sizes + 2), 3);
        for (size_t d = 0; d < 3; d++)
            put_number(block + 4 + 4 * d, sizes[d], 4);
        memcpy(block + 16, cases[n].bytes, cases[n].size);
        zarr_put("other/0/0/0", block, 16 + cases[n].size);
        const cw_status st = read_back("other", &v, &err);
        if (st == CW_ERR_UNSUPPORTED)
            continue; /* this build lacks the codec */
        if (st != CW_OK)
            fail_msg("%zu: %s", n, err.message);
        const uint16_t *got = v.data;
        assert_int_equal(got[0], cases[n].numbers[0]);
        assert_int_equal(got[1], cases[n].numbers[1]);
        assert_int_equal(got[v.dim[0] * v.dim[1] * v.dim[2] - 1], cases[n].numbers[2]);
        cw_volume_free(&v);
        block[16 + cases[n].size / 2] ^= 0x10;
        zarr_put("other/0/0/0", block, 16 + cases[n].size);
        if (n > 0)
            assert_fails(read_back("other", &v, &err), CW_ERR_FORMAT,
                         "0/0/0: a chunk is damaged", err);
    }
}

/* --- frames ------------------------------------------------------------------------------- */

static void put_array(const char *name, const char *more, size_t rank, size_t x, size_t y,
                      size_t z, size_t c)
{
    const n5_made m = {.name = name,
                       .kind = "u1",
                       .compression = "raw",
                       .rank = rank,
                       .dims = {x, y, z, c},
                       .block = {x, y, z, c},
                       .more = more};
    write_n5(&m);
}

/* However the size of voxels is written; places of voxel 1, 1, 1. */
static void frames_are_read_in_each_spelling(void **state)
{
    (void)state;
    static const struct {
        const char *more;
        double place[3];
        bool has_unit;
    } cases[] = {
        {NULL, {1, 1, 1}, false},
        {"\"resolution\": [4, 5, 40]", {4, 5, 40}, false},
        {"\"resolution\": [4, 5, 40], \"units\": [\"nm\", \"nm\", \"um\"]",
         {4e-6, 5e-6, 40e-3},
         true},
        {"\"pixelResolution\": {\"unit\": \"um\", \"dimensions\": [2, 3, 4]}",
         {2e-3, 3e-3, 4e-3},
         true},
        {"\"pixelResolution\": [2, 3, 4]", {2, 3, 4}, false},
        {"\"resolution\": [2, 3, 4], \"offset\": [10, 20, 30]", {12, 23, 34}, false},
        {"\"resolution\": [2, 3, 4], \"downsamplingFactors\": [2, 2, 1]", {5, 7.5, 4}, false},
        {"\"axes\": [\"z\", \"y\", \"x\"], \"resolution\": [2, 3, 4], \"units\": [\"mm\", \"mm\", "
         "\"mm\"]",
         {4, 3, 2},
         true},
        {"\"axes\": [\"depth\", \"y\", \"x\"], \"resolution\": [2, 3, 4]", {2, 3, 4}, false},
        {"\"transform\": {\"axes\": [\"z\", \"y\", \"x\"], \"scale\": [4, 3, 2], \"translate\": "
         "[30, 20, 10], \"units\": [\"nm\", \"nm\", \"nm\"]}, \"resolution\": [9, 9, 9]",
         {12e-6, 23e-6, 34e-6},
         true},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        cw_volume v;
        cw_error err = {0};
        put_array("frame", cases[n].more, 3, 3, 3, 3, 1);
        assert_ok(read_back("frame", &v, &err), err);
        assert_place(&v, 1, 1, 1, cases[n].place[0], cases[n].place[1], cases[n].place[2]);
        assert_int_equal(v.known & CW_KNOWN_UNIT, cases[n].has_unit ? CW_KNOWN_UNIT : 0);
        cw_volume_free(&v);
    }
}

static void a_fourth_axis_is_components_or_steps(void **state)
{
    (void)state;
    static const struct {
        const char *more;
        size_t count, components, steps;
    } cases[] = {{NULL, 3, 3, 1},
                 {NULL, 17, 1, 17},
                 {"\"axes\": [\"x\", \"y\", \"z\", \"t\"]", 3, 1, 3},
                 {"\"resolution\": [1, 1, 1]", 2, 2, 1}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        cw_volume v;
        cw_error err = {0};
        put_array("fourth", cases[n].more, 4, 2, 2, 2, cases[n].count);
        assert_ok(read_back("fourth", &v, &err), err);
        assert_int_equal(v.components, cases[n].components);
        assert_int_equal(v.steps, cases[n].steps);
        cw_volume_free(&v);
    }
}

/* The factors of levels in their own attributes, in those of the image, and in those of a folder
 * above it, as BigDataViewer has them. */
static void a_level_has_its_size_and_frame(void **state)
{
    (void)state;
    static const struct {
        const char *above, *image, *level;
    } cases[] = {
        {"{\"n5\": \"2.0.0\"}",
         "{\"resolution\": [4, 4, 10], \"units\": [\"mm\", \"mm\", \"mm\"]}",
         "\"downsamplingFactors\": [2, 2, 1]"},
        {"{}",
         "{\"pixelResolution\": {\"unit\": \"mm\", \"dimensions\": [4, 4, 10]}, \"scales\": [[1, "
         "1, 1], [2, 2, 1]]}",
         NULL},
        {"{\"downsamplingFactors\": [[1, 1, 1], [2, 2, 1]], \"dataType\": \"uint8\"}",
         "{\"multiScale\": true, \"resolution\": [4, 4, 10], \"units\": [\"mm\", \"mm\", \"mm\"]}",
         NULL},
        {"{\"resolution\": [4, 4, 10], \"units\": [\"mm\", \"mm\", \"mm\"]}", NULL,
         "\"downsamplingFactors\": [2, 2, 1]"},
    };
    static const struct {
        const char *path, *array;
        size_t level;
    } ways[] = {{"top.n5", "image", 1},
                {"top.n5", "image/s1", 0},
                {"top.n5", NULL, 1},
                {"top.n5/image/s1", NULL, 0},
                {"top.n5/image", "s1", 0}};
    enum {
        SELF_CONTAINED = 2,
        FROM_TOP = 3
    }; /* images that need nothing above; ways from the top */
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        zarr_put_text("top.n5/attributes.json", cases[n].above);
        if (cases[n].image)
            zarr_put_text("top.n5/image/attributes.json", cases[n].image);
        put_array("top.n5/image/s0", NULL, 3, 4, 4, 2, 1);
        put_array("top.n5/image/s1", cases[n].level, 3, 2, 2, 2, 1);
        for (size_t w = 0; w < (n < SELF_CONTAINED ? sizeof ways / sizeof *ways : FROM_TOP);
             w++) {
            const cw_read_desc desc = {.array = ways[w].array, .level = ways[w].level};
            cw_volume v;
            cw_error err = {0};
            assert_ok(cw_volume_read(test_path(ways[w].path), &desc, &v, NULL, &err), err);
            assert_int_equal(v.dim[0], 2);
            assert_place(&v, 0, 0, 0, 2, 2, 0);
            assert_place(&v, 1, 1, 1, 10, 10, 10);
            cw_volume_free(&v);
        }
        test_folder_remove(NULL);
        test_folder_make(NULL);
    }
}

static void levels_are_listed(void **state)
{
    (void)state;
    cw_level *levels;
    size_t count;
    cw_error err = {0};
    cw_volume v;
    put_array("image/s0", NULL, 3, 4, 4, 2, 1);
    put_array("image/s1", "\"downsamplingFactors\": [2, 2, 1]", 3, 2, 2, 2, 1);
    put_array("image/s3", "\"downsamplingFactors\": [8, 8, 1]", 3, 1, 1, 2, 1);
    assert_ok(cw_levels_list(test_path("image"), NULL, &levels, &count, &err), err);
    assert_int_equal(count, 2);
    assert_string_equal(levels[1].name, "s1");
    assert_string_equal(levels[1].axes, "x y z");
    assert_int_equal(levels[1].shape.dim[0], 2);
    cw_levels_free(levels);
    assert_fails(
        cw_volume_read(test_path("image"), &(cw_read_desc){.level = 2}, &v, NULL, &err),
        CW_ERR_ARGUMENT, "level 2 was asked for; there are 2, from 0", err);
    put_array("image/s1", NULL, 3, 2, 2, 2, 1);
    assert_fails(
        cw_volume_read(test_path("image"), &(cw_read_desc){.level = 1}, &v, NULL, &err),
        CW_ERR_FORMAT, "s1/attributes.json: 'downsamplingFactors' is missing for level 1", err);
}

static void keep_note(void *user, const char *text)
{
    snprintf(user, 256, "%s", text);
}

/* Folders without attributes are groups, too. */
static void the_first_solid_array_of_a_group_is_taken(void **state)
{
    (void)state;
    char note[256] = "";
    cw_read_desc desc = {.note = keep_note, .note_user = note};
    cw_array *arrays;
    size_t count;
    cw_volume v;
    cw_error err = {0};
    zarr_put_text("group/attributes.json", "{\"n5\": \"2.0.0\"}");
    put_array("group/a1", NULL, 2, 4, 3, 1, 1);
    put_array("group/a2/deep", NULL, 3, 5, 4, 3, 1);
    put_array("group/a10", NULL, 3, 7, 4, 3, 1);
    assert_ok(cw_volume_read(test_path("group"), &desc, &v, NULL, &err), err);
    assert_int_equal(v.dim[0], 5);
    assert_non_null(strstr(note, "a2/deep"));
    cw_volume_free(&v);
    assert_ok(cw_arrays_list(test_path("group"), NULL, &arrays, &count, &err), err);
    assert_int_equal(count, 3);
    cw_arrays_free(arrays);
    desc.array = "a11";
    assert_fails(cw_volume_read(test_path("group"), &desc, &v, NULL, &err), CW_ERR_ARGUMENT,
                 "the store has no array 'a11'; there are 'a1', 'a2/deep', 'a10'", err);
    assert_ok(read_back("group/a10/attributes.json", &v, &err), err);
    assert_int_equal(v.dim[0], 7);
    cw_volume_free(&v);
    zarr_put_text("image/attributes.json", "{\"affineTransform\": [[1, 0, 0, 0]]}");
    put_array("image/s0", NULL, 3, 4, 4, 2, 1);
    desc.array = NULL;
    assert_ok(cw_volume_read(test_path("image"), &desc, &v, NULL, &err), err);
    assert_non_null(strstr(note, "'affineTransform' is left out"));
    cw_volume_free(&v);
}

static void running_out_of_memory_is_an_error(void **state)
{
    (void)state;
    bool failed = true;
    const n5_made m = {.name = "small.n5",
                       .kind = "u2",
                       .compression = "gzip",
                       .rank = 3,
                       .dims = {3, 3, 3},
                       .block = {4, 2, 2},
                       .is_whole = true};
    put_array("image/s0", NULL, 3, 4, 4, 2, 1);
    write_n5(&m);
    for (long n = 0; failed; n++) {
        cw_volume v = {0}, w = {0};
        cw_error err = {0};
        cwi_alloc_fail_after(n);
        cw_status st = read_back("image", &v, &err);
        if (st == CW_OK)
            st = read_back("small.n5", &w, &err);
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
        FRESH(every_number_is_that_of_the_writer),
        FRESH(a_region_has_its_blocks),
        FRESH(blocks_of_other_writers_are_read),
        FRESH(frames_are_read_in_each_spelling),
        FRESH(a_fourth_axis_is_components_or_steps),
        FRESH(a_level_has_its_size_and_frame),
        FRESH(levels_are_listed),
        FRESH(the_first_solid_array_of_a_group_is_taken),
        FRESH(running_out_of_memory_is_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
