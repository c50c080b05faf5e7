/* Tests reading of regions: crops in any order of axes, limits, checks of whole files, and
 * interruption. */
#include "support/files/reading.h"
#include "support/files/regions.h"

#include <stdio.h>

/* --- NRRD files of five axes in any order ------------------------------------------------ */

enum { COMPONENTS = 3, X = 7, Y = 5, Z = 4, STEPS = 2, AXES = 5 };
enum { COUNT = COMPONENTS * X * Y * Z * STEPS, ORDERS = 20 };

typedef enum encoding { LITTLE, BIG, GZIP, TEXT, ENCODINGS } encoding;
static const char *const encodings[ENCODINGS] = {
    "encoding: raw\nendian: little\n", "encoding: raw\nendian: big\n",
    "encoding: gzip\nendian: big\n", "encoding: ascii\n"};

/* The values 1000, 1001, ... as a file holds them; free them. */
static unsigned char *encode(encoding e, size_t first, size_t count, size_t *size)
{
    unsigned char *bytes = malloc(8 * count + 1), *packed;
    assert_non_null(bytes);
    *size = 0;
    for (size_t i = first; i < first + count; i++) {
        const unsigned v = (unsigned)(1000 + i);
        if (e == TEXT)
            *size += (size_t)sprintf((char *)bytes + *size, "%u\n", v);
        else
            for (int b = 0; b < 2; b++)
                bytes[(*size)++] = (unsigned char)(v >> (8 * (e == LITTLE ? b : 1 - b)));
    }
    if (e != GZIP)
        return bytes;
    packed = pack_bytes(bytes, *size, true, size);
    free(bytes);
    return packed;
}

/* Components and steps stand at any two of the five places, x y z at the others. */
static void describe(unsigned order, encoding e, char header[500], size_t sizes[AXES])
{
    static const size_t space[] = {X, Y, Z};
    const unsigned values = order % AXES, others = order / AXES;
    const unsigned time = others < values ? others : others + 1;
    char kinds[100] = "", text[100] = "", directions[100] = "";
    for (unsigned a = 0, s = 0; a < AXES; a++) {
        const bool is_space = a != values && a != time;
        sizes[a] = is_space ? space[s] : a == time ? STEPS : COMPONENTS;
        sprintf(text + strlen(text), " %zu", sizes[a]);
        strcat(kinds, is_space ? " domain" : a == time ? " time" : " vector");
        strcat(directions, !is_space ? " none"
                           : s == 0  ? " (0,2,0)"
                           : s == 1  ? " (-3,0,0.5)"
                                     : " (0,0.25,4)");
        s += is_space;
    }
    snprintf(header, 500,
             "NRRD0005\ntype: uint16\ndimension: 5\n%ssizes:%s\nkinds:%s\nspace: RAS\n"
             "space directions:%s\nspace origin: (10,-20,30)\n",
             encodings[e], text, kinds, directions);
}

static void regions_of_any_order_of_axes_are_crops(void **state)
{
    (void)state;
    for (unsigned order = 0; order < ORDERS; order++)
        for (encoding e = LITTLE; e < ENCODINGS; e++) {
            char header[500];
            size_t sizes[AXES], size;
            unsigned char *bytes = encode(e, 0, COUNT, &size);
            describe(order, e, header, sizes);
            strcat(header, "\n");
            put_file("a.nrrd", header, bytes, size);
            check_regions("a.nrrd", NULL);
            free(bytes);
        }
}

/* Files of one to four axes each, so that runs end with the file or go on in the next. */
static void regions_may_lie_in_several_files(void **state)
{
    (void)state;
    for (unsigned order = 0; order < ORDERS; order += test_is_short() ? 11 : 3)
        for (unsigned n = 0; n < ENCODINGS * (AXES - 1); n++) {
            const encoding e = (encoding)(n % ENCODINGS);
            const unsigned depth = 1 + n / ENCODINGS;
            char header[500], name[20];
            size_t sizes[AXES], size, each = 1;
            describe(order, e, header, sizes);
            for (unsigned a = 0; a < depth; a++)
                each *= sizes[a];
            for (size_t i = 0; i < COUNT / each; i++) {
                unsigned char *bytes = encode(e, i * each, each, &size);
                sprintf(name, "f%03zu", i);
                put_file(name, "", bytes, size);
                free(bytes);
            }
            sprintf(header + strlen(header), "data file: f%%03d 0 %zu 1 %u\n", COUNT / each - 1,
                    depth);
            put_file("a.nhdr", header, NULL, 0);
            check_regions("a.nhdr", NULL);
        }
}

/* --- more than passes at a time ---------------------------------------------------------- */

enum { WIDE = 300, HIGH = 200, DEEP = 40 };

static void runs_and_gaps_may_be_long(void **state)
{
    (void)state;
    static uint16_t voxels[WIDE * HIGH * DEEP];
    const cw_raw_layout layout = {
        .dim = {WIDE, HIGH, DEEP}, .type = CW_U16, .offset = 5, .big_endian = true};
    size_t size;
    for (size_t i = 0; i < WIDE * HIGH * DEEP; i++)
        voxels[i] = (uint16_t)(i % 10007);
    put_file("a.raw", "12345", voxels, sizeof voxels);
    check_regions("a.raw", &(cw_read_desc){.raw = &layout});
    unsigned char *packed = pack_bytes(voxels, sizeof voxels, true, &size);
    put_file("a.nrrd",
             "NRRD0004\ntype: uint16\ndimension: 3\nsizes: 300 200 40\nencoding: gzip\n"
             "endian: big\n\n",
             packed, size);
    check_regions("a.nrrd", NULL);
    free(packed);
}

/* --- what else may happen ---------------------------------------------------------------- */

#define GZIP_3D "NRRD0004\ntype: uint8\nencoding: gzip\ndimension: 3\nsizes: 2 3 2\n"
#define RAW_3D  "NRRD0004\ntype: uint8\nencoding: raw\ndimension: 3\nsizes: 2 3 2\n"
static const uint8_t counting[12] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};

static cw_status read_box(const char *name, const cw_box *box, cw_volume *v, cw_error *err)
{
    const cw_read_desc desc = {.region = box};
    return cw_volume_read(test_path(name), &desc, v, NULL, err);
}

static void regions_must_lie_in_the_volume(void **state)
{
    (void)state;
    static const struct {
        cw_box box;
        const char *words;
    } cases[] = {
        {{{0, 0, 0}, {0, 3, 2}}, "box 0+0 leaves the volume's 2 voxels along x"},
        {{{2, 0, 0}, {1, 3, 2}}, "box 2+1 leaves the volume's 2 voxels along x"},
        {{{0, 1, 0}, {2, 3, 2}}, "box 1+3 leaves the volume's 3 voxels along y"},
        {{{0, 0, 1}, {2, 3, SIZE_MAX}}, "leaves the volume's 2 voxels along z"},
        {{{0, 0, SIZE_MAX}, {2, 3, 1}}, "leaves the volume's 2 voxels along z"},
    };
    put_file("a.nrrd", RAW_3D "\n", counting, 12);
    for (size_t i = 0; i < 2 * (sizeof cases / sizeof *cases); i++) {
        const cw_read_desc desc = {.region = &cases[i / 2].box, .header_only = i % 2};
        cw_volume v;
        cw_error err = {0};
        assert_fails(cw_volume_read(test_path("a.nrrd"), &desc, &v, NULL, &err),
                     CW_ERR_ARGUMENT, cases[i / 2].words, err);
        assert_null(v.data);
    }
}

static void limits_are_those_of_the_region(void **state)
{
    (void)state;
    const cw_box box = {{0, 1, 0}, {2, 2, 1}};
    cw_read_desc desc = {.region = &box, .max_voxels = 4, .max_bytes = 4};
    cw_volume v;
    cw_error err = {0};
    put_file("a.nrrd", RAW_3D "\n", counting, 12);
    assert_ok(cw_volume_read(test_path("a.nrrd"), &desc, &v, NULL, &err), err);
    cw_volume_free(&v);
    desc.max_bytes = 3;
    assert_fails(cw_volume_read(test_path("a.nrrd"), &desc, &v, NULL, &err), CW_ERR_LIMIT,
                 "'region' asks for 4 bytes of voxels; the limit is 3", err);
    desc.max_voxels = 3;
    assert_fails(cw_volume_read(test_path("a.nrrd"), &desc, &v, NULL, &err), CW_ERR_LIMIT,
                 "'region' asks for 4 voxels; the limit is 3", err);
}

/* Compressed data are read up to the last voxel of the region, and verified if they
 * end there. */
static void what_is_behind_the_region_is_not_read(void **state)
{
    (void)state;
    const cw_box front = {{0, 0, 0}, {2, 3, 1}}, back = {{1, 2, 1}, {1, 1, 1}};
    size_t size;
    cw_volume v;
    cw_error err = {0};
    unsigned char *packed = pack_bytes(counting, 12, true, &size);
    packed[size - 5] ^= 1; /* the checksum */
    put_file("a.nrrd", GZIP_3D "\n", packed, size);
    assert_ok(read_box("a.nrrd", &front, &v, &err), err);
    assert_memory_equal(v.data, counting, 6);
    cw_volume_free(&v);
    assert_fails(read_box("a.nrrd", &back, &v, &err), CW_ERR_FORMAT, "incorrect data check",
                 err);
    assert_null(v.data);
    free(packed);
}

/* The claims of a file are checked for all of it, also for parts that are not wanted. */
static void files_are_checked_whole(void **state)
{
    (void)state;
    const cw_box front = {{0, 0, 0}, {2, 3, 1}};
    cw_volume v;
    cw_error err = {0};
    put_file("a.nrrd", RAW_3D "\n", counting, 11);
    assert_fails(read_box("a.nrrd", &front, &v, &err), CW_ERR_FORMAT, "the file holds 11 bytes",
                 err);
    put_file("one.raw", "", counting, 6);
    put_file("two.raw", "", counting, 5);
    put_file("a.nhdr", RAW_3D "data file: LIST\none.raw\ntwo.raw\n", NULL, 0);
    assert_fails(read_box("a.nhdr", &front, &v, &err), CW_ERR_FORMAT,
                 "two.raw: 'sizes' asks for 6 bytes", err);
    put_file("a.nrrd",
             "NRRD0004\ntype: uint8\nencoding: ascii\ndimension: 3\nsizes: 2 3 2\n\n"
             "0 1 2 three 4 5 6 7 8 9 10 11",
             NULL, 0);
    const cw_box behind = {{0, 0, 1}, {2, 3, 1}};
    assert_fails(read_box("a.nrrd", &behind, &v, &err), CW_ERR_FORMAT,
                 "number 4 of the voxels is 'three'", err);
}

/* Also on the way to the region, where nothing is kept yet. */
static void reading_can_be_interrupted_at_every_portion(void **state)
{
    (void)state;
    enum { SIZE = 5 << 20, PORTIONS = 5 };
    const cw_box last = {{0, 0, SIZE - 1}, {1, 1, 1}};
    int polls = 0;
    size_t size;
    cw_volume v;
    cw_error err = {0};
    unsigned char *zeros = calloc(SIZE, 1);
    assert_non_null(zeros);
    unsigned char *packed = pack_bytes(zeros, SIZE, true, &size);
    put_file("a.nrrd",
             "NRRD0004\ntype: uint8\nencoding: gzip\ndimension: 3\nsizes: 1 1 5242880\n\n",
             packed, size);
    for (int stop = 0; stop < PORTIONS + 2; stop++) {
        const cw_read_desc desc = {.region = &last,
                                   .progress = {.report = test_stop_after, .user = &polls}};
        polls = stop;
        assert_fails(cw_volume_read(test_path("a.nrrd"), &desc, &v, NULL, &err),
                     CW_ERR_CANCELLED, "interrupted while reading", err);
        assert_null(v.data);
    }
    free(packed), free(zeros);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(regions_of_any_order_of_axes_are_crops),
        TEST(regions_may_lie_in_several_files),
        TEST(runs_and_gaps_may_be_long),
        TEST(regions_must_lie_in_the_volume),
        TEST(limits_are_those_of_the_region),
        TEST(what_is_behind_the_region_is_not_read),
        TEST(files_are_checked_whole),
        TEST(reading_can_be_interrupted_at_every_portion),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
