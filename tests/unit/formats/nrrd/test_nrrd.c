/* Tests the reader of NRRD: frames, roles of axes, encodings, data files, limits, and damaged
 * headers. */
#define _GNU_SOURCE /* symlink, mkfifo */
#include "formats/bytes/bzip2.h"
#include "support/files/reading.h"
#include "support/files/regions.h"

#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

/* 2 x 3 x 2 voxels that tell where they stand. */
static const uint8_t counting[12] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};

/* bzip2's data, of the same, and of both halves in a row; of the numbers 1, -2, 300, -32768 in
 * big endian, behind three bytes. */
static const uint8_t bzipped[] = {66,  90,  104, 49,  49,  65, 89, 38,  83,  89,  82,  119,
                                  107, 164, 0,   0,   0,   64, 0,  127, 248, 32,  0,   34,
                                  1,   160, 104, 64,  208, 52, 11, 60,  72,  171, 205, 227,
                                  226, 238, 72,  167, 10,  18, 10, 78,  237, 116, 128};
static const uint8_t halves[] = {
    66,  90, 104, 57, 49,  65, 89, 38, 83, 89,  96,  26,  179, 146, 0,  0,  0,   64, 0,   126,
    0,   32, 0,   33, 128, 12, 3,  39, 46, 226, 238, 72,  167, 10,  18, 12, 3,   86, 114, 64,
    66,  90, 104, 49, 49,  65, 89, 38, 83, 89,  147, 144, 1,   0,   0,  0,  0,   64, 0,   1,
    248, 32, 0,   33, 128, 12, 3,  39, 46, 226, 238, 72,  167, 10,  18, 18, 114, 0,  32,  0};
static const uint8_t big_bzipped[] = {
    66,  90,  104, 57,  49, 65,  89,  38,  83, 89,  145, 1,   161, 76, 0,  0,  2,  208,
    192, 224, 0,   0,   4,  0,   112, 64,  0,  0,   1,   160, 0,   49, 6,  76, 65, 0,
    205, 66,  102, 109, 48, 229, 226, 238, 72, 167, 10,  18,  18,  32, 52, 41, 128};

#define U8      "NRRD0004\ntype: uint8\nencoding: raw\n"
#define U8_3D   U8 "dimension: 3\nsizes: 2 3 2\n"
#define BZ2_3D  "NRRD0004\ntype: uint8\nencoding: bzip2\ndimension: 3\nsizes: 2 3 2\n"
#define HEX_3D  "NRRD0004\ntype: uint8\nencoding: hex\ndimension: 3\nsizes: 2 3 2\n"
#define GZIP_3D "NRRD0004\ntype: uint8\nencoding: gzip\ndimension: 3\nsizes: 2 3 2\n"

static void a_plain_header_gives_its_voxels(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    const char *format = NULL;
    put_file("a.nrrd", U8_3D "# a comment\nmy key:=my value\n\n", counting, sizeof counting);
    assert_ok(cw_volume_read(test_path("a.nrrd"), NULL, &v, &format, &err), err);
    assert_string_equal(format, "nrrd");
    assert_int_equal(v.type, CW_U8);
    assert_int_equal(v.known, 0);
    for (size_t i = 0; i < 12; i++)
        assert_true(cw_volume_value(&v, i % 2, i / 2 % 3, i / 6) == (double)i);
    check_affine(&v, (const double[12]){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0});
    cw_volume_free(&v);
}

static void slicer_says_that_its_values_are_labels(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    put_file("a.nrrd", U8_3D "Segment0_ID:=Segment_1\nSegment0_LabelValue:=1\n\n", counting,
             sizeof counting);
    assert_ok(cw_volume_read(test_path("a.nrrd"), NULL, &v, NULL, &err), err);
    assert_int_equal(v.known, CW_KNOWN_LABELS);
    cw_volume_free(&v);
}

static void keep_note(void *user, const char *text)
{
    snprintf(user, 300, "%s", text);
}

/* Headers with place and direction, and the affine on paper. */
static void frames_are_turned_to_lps_millimetres(void **state)
{
    (void)state;
    const unsigned unit = CW_KNOWN_UNIT, frame = CW_KNOWN_FRAME, both = unit | frame;
    const struct {
        const char *header;
        unsigned known;
        double affine[12];
    } cases[] = {
        {"space: left-posterior-superior\nspace directions: (2,0,0) (0,3,0) (0,0,4)\n"
         "space origin: (5,6,7)\n",
         both,
         {2, 0, 0, 5, 0, 3, 0, 6, 0, 0, 4, 7}},
        {"space: RAS\nspace directions: (2,0,0) (0,3,0) (0,0,4)\nspace origin: (5,6,7)\n",
         both,
         {-2, 0, 0, -5, 0, -3, 0, -6, 0, 0, 4, 7}},
        {"Space: Left-Anterior-Superior\nSPACE DIRECTIONS: ( 2 , 0, 0 ) (0,3,0)(0,0,4)\n"
         "space origin: (5,6,7)\n",
         both,
         {2, 0, 0, 5, 0, -3, 0, -6, 0, 0, 4, 7}},
        {"space: LPS\nspace directions: (-2,0.5,0) (0.25,-3,0) (0,1,-4)\nspace origin: "
         "(0,0,0)\n",
         both,
         {-2, 0.25, 0, 0, 0.5, -3, 1, 0, 0, 0, -4, 0}},
        {"space: left-anterior-superior-time\nspace directions: (2,0,0,0) (0,3,0,0) (0,0,4,0)\n"
         "space origin: (5,6,7,0)\n",
         both,
         {2, 0, 0, 5, 0, -3, 0, -6, 0, 0, 4, 7}},
        {"space: RAST\nspace directions: (2,0,0,0) (0,3,0,0) (0,0,4,0)\n"
         "space origin: (5,6,7,0)\n",
         both,
         {-2, 0, 0, -5, 0, -3, 0, -6, 0, 0, 4, 7}},
        {"space dimension: 3\nspace directions: (0,0,2) (3,0,0) (0,4,0)\nspace origin: "
         "(1,2,3)\n",
         0,
         {0, 3, 0, 1, 0, 0, 4, 2, 2, 0, 0, 3}},
        {"space: scanner-xyz\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
         "space units: \"mm\" \"mm\" \"mm\"\n",
         unit,
         {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}},
        {"space: RAS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (1,1,1)\n"
         "space units: \"cm\" \"m\" \"um\"\n",
         both,
         {-10, 0, 0, -10, 0, -1000, 0, -1000, 0, 0, 1e-3, 1e-3}},
        {"space: RAS\nspacings: 1 2 3\nspace origin: (1,2,3)\n",
         unit,
         {1, 0, 0, -1, 0, 2, 0, -2, 0, 0, 3, 3}},
        {"spacings: 0.5 0.25 2\n", 0, {0.5, 0, 0, 0, 0, 0.25, 0, 0, 0, 0, 2, 0}},
        {"spacings: 0.5 0.25 2\nunits: \"mm\" \"mm\" \"cm\"\n",
         unit,
         {0.5, 0, 0, 0, 0, 0.25, 0, 0, 0, 0, 20, 0}},
        {"spacings: 2 -2 2\naxis mins: 10 20 30\ncenters: cell node ???\n",
         0,
         {2, 0, 0, 11, 0, -2, 0, 20, 0, 0, 2, 30}},
        {"axismins: 0 0 0\naxismaxs: 4 4 4\ncenterings: cell node cell\n",
         0,
         {2, 0, 0, 1, 0, 2, 0, 0, 0, 0, 2, 1}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char header[1000];
        cw_volume v;
        cw_error err = {0};
        snprintf(header, sizeof header, U8_3D "%s\n", cases[i].header);
        put_file("a.nrrd", header, counting, sizeof counting);
        assert_ok(read_back("a.nrrd", &v, &err), err);
        check_affine(&v, cases[i].affine);
        assert_int_equal(v.known, cases[i].known);
        cw_volume_free(&v);
    }
}

/* Axes of values and time in any place; `at` is the byte of voxel (1, 2, 1), last value, last
 * step. All hold 24 voxels. */
static void axes_find_their_roles(void **state)
{
    (void)state;
    const struct {
        const char *header;
        size_t components, steps, at, depth;
    } cases[] = {
        {"dimension: 4\nsizes: 2 2 3 2\nkinds: vector domain domain domain\n", 2, 1, 23, 2},
        {"dimension: 4\nsizes: 2 3 2 2\nkinds: domain domain domain list\n", 2, 1, 23, 2},
        {"dimension: 4\nsizes: 2 3 2 2\nkinds: domain domain domain time\n", 1, 2, 23, 2},
        {"dimension: 4\nsizes: 2 3 2 2\n", 1, 2, 23, 2},
        {"dimension: 4\nsizes: 2 2 3 2\nspacings: nan 1 1 1\n", 2, 1, 23, 2},
        {"dimension: 4\nsizes: 2 2 3 2\nspace: LPS\n"
         "space directions: none (1,0,0) (0,1,0) (0,0,1)\n",
         2, 1, 23, 2},
        {"dimension: 4\nsizes: 2 3 2 2\nspace: LPST\n"
         "space directions: (1,0,0,0) (0,1,0,0) (0,0,1,0) (0,0,0,2)\n",
         1, 2, 23, 2},
        {"dimension: 4\nsizes: 2 2 3 2\nkinds: domain 2-vector domain domain\n", 2, 1, 23, 2},
        {"dimension: 4\nsizes: 2 2 2 3\nkinds: RGB-color time domain domain\n", 2, 2, 0, 1},
        {"dimension: 2\nsizes: 8 3\n", 1, 1, 0, 1},
    };
    uint8_t voxels[24];
    for (size_t i = 0; i < 24; i++)
        voxels[i] = (uint8_t)i;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char header[1000];
        cw_volume v, last;
        cw_error err = {0};
        snprintf(header, sizeof header, U8 "%s\n", cases[i].header);
        put_file("a.nrrd", header, voxels, sizeof voxels);
        assert_ok(read_back("a.nrrd", &v, &err), err);
        assert_int_equal(v.components, cases[i].components);
        assert_int_equal(v.steps, cases[i].steps);
        assert_int_equal(v.dim[2], cases[i].depth);
        assert_ok(cw_volume_select(&v, v.components - 1, v.steps - 1, &last, &err), err);
        if (cases[i].at)
            assert_true(cw_volume_value(&last, 1, 2, 1) == (double)cases[i].at);
        check_regions("a.nrrd", NULL);
        cw_volume_free(&v);
    }
}

/* Up to 16 entries are the values of a voxel, more of them are steps. */
static void only_short_lists_are_values(void **state)
{
    (void)state;
    static const uint8_t voxels[2 * 17];
    for (size_t length = 15; length <= 17; length++) {
        char header[300];
        cw_volume v;
        cw_error err = {0};
        snprintf(header, sizeof header,
                 U8 "dimension: 4\nsizes: 2 1 1 %zu\nkinds: domain domain domain list\n\n",
                 length);
        put_file("a.nrrd", header, voxels, 2 * length);
        assert_ok(read_back("a.nrrd", &v, &err), err);
        assert_int_equal(v.components, length <= 16 ? length : 1);
        assert_int_equal(v.steps, length <= 16 ? 1 : length);
        cw_volume_free(&v);
    }
}

/* The fastest axis holds the values: neighbours along x are two apart, values one. */
static void interleaved_values_are_reached_by_strides(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    const uint8_t pairs[8] = {10, 20, 11, 21, 12, 22, 13, 23};
    put_file("a.nrrd",
             U8 "dimension: 4\nsizes: 2 2 2 1\nkinds: 2-vector domain domain domain\n\n", pairs,
             sizeof pairs);
    assert_ok(read_back("a.nrrd", &v, &err), err);
    cw_volume second;
    assert_ok(cw_volume_select(&v, 1, 0, &second, &err), err);
    assert_true(cw_volume_value(&v, 1, 1, 0) == 13);
    assert_true(cw_volume_value(&second, 0, 1, 0) == 22);
    cw_volume_free(&v);
}

static void flat_data_get_a_third_direction(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    put_file("a.nrrd",
             U8 "dimension: 2\nsizes: 4 3\nspace: LPS\nspace directions: (0,2,0) (0,0,3)\n\n",
             counting, sizeof counting);
    assert_ok(read_back("a.nrrd", &v, &err), err);
    check_affine(&v, (const double[12]){0, 0, 1, 0, 2, 0, 0, 0, 0, 3, 0, 0});
    cw_volume_free(&v);
}

static void time_is_told_in_seconds(void **state)
{
    (void)state;
    static const char *const spacings[] = {"1 1 1 40", "1 1 1 -40"}; /* backwards: as long */
    for (size_t i = 0; i < 2; i++) {
        char header[300];
        cw_volume v;
        cw_error err = {0};
        snprintf(header, sizeof header,
                 U8 "dimension: 4\nsizes: 2 3 1 2\nkinds: domain domain domain time\n"
                    "spacings: %s\nunits: \"mm\" \"mm\" \"mm\" \"ms\"\n\n",
                 spacings[i]);
        put_file("a.nrrd", header, counting, sizeof counting);
        assert_ok(read_back("a.nrrd", &v, &err), err);
        assert_near(v.step_seconds, 0.04, 1e-15);
        assert_int_equal(v.known, CW_KNOWN_UNIT);
        cw_volume_free(&v);
    }
}

static void encodings_and_byte_orders_give_the_same_numbers(void **state)
{
    (void)state;
    const int16_t expected[4] = {1, -2, 300, -32768};
    const uint8_t little[8] = {1, 0, 0xfe, 0xff, 0x2c, 1, 0, 0x80};
    const uint8_t big[8] = {0, 1, 0xff, 0xfe, 1, 0x2c, 0x80, 0};
    const char text[] = "1 -2\n300\t-32768";
    size_t packed_size;
    unsigned char *packed = pack_bytes(big, 8, true, &packed_size);
    const struct {
        const char *fields;
        const void *bytes;
        size_t size;
    } cases[] = {
        {"endian: little\nencoding: raw", little, 8},
        {"endian: big\nencoding: raw", big, 8},
        {"endian: big\nencoding: gz", packed, packed_size},
        {"encoding: ascii", text, sizeof text - 1},
        {"endian: big\nencoding: raw\nbyte skip: -1", "junkjunk\0\1\xff\xfe\1\x2c\x80\0", 16},
        {"endian: big\nencoding: raw\nline skip: 2\nbyte skip: 3",
         "a\nb\nccc\0\1\xff\xfe\1\x2c\x80\0", 15},
        {"endian: big\nencoding: hex", "0001 fFfE\n012C\t8000\n", 20},
        {"endian: little\nencoding: hex", "0100feff2c010080", 16},
        {"endian: big\nencoding: hex\nline skip: 1\nbyte skip: 2", "#\n# 0001fffe012c8000", 20},
        {"endian: big\nencoding: bz2\nbyte skip: 3", big_bzipped, sizeof big_bzipped},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char header[300];
        cw_volume v;
        cw_error err = {0};
        if (strstr(cases[i].fields, "bz2") && !cwi_bzip2_present())
            continue;
        snprintf(header, sizeof header,
                 "NRRD0001\ntype: short\ndimension: 3\nsizes: 4 1 1\n%s\n\n", cases[i].fields);
        put_file("a.nrrd", header, cases[i].bytes, cases[i].size);
        assert_ok(read_back("a.nrrd", &v, &err), err);
        assert_int_equal(v.type, CW_I16);
        assert_memory_equal(v.data, expected, sizeof expected);
        check_regions("a.nrrd", NULL);
        cw_volume_free(&v);
    }
    free(packed);
}

#define DETACHED U8_3D "data file: "

static void voxels_may_lie_in_files_of_their_own(void **state)
{
    (void)state;
    static const char *const headers[] = {
        DETACHED "whole.raw\n",           U8_3D "datafile: LIST\none.raw\ntwo.raw\n",
        DETACHED "slice%02d.raw 5 8 3\n", DETACHED "line%d.raw 1 6 1 1\n",
        DETACHED "sub/whole.raw\n",       U8_3D "byte skip: -1\ndata file: whole.raw\n",
    };
    char name[] = "lineN.raw";
    assert_int_equal(mkdir(test_path("sub"), 0700), 0);
    put_file("whole.raw", "", counting, 12);
    put_file("sub/whole.raw", "", counting, 12);
    put_file("one.raw", "", counting, 6);
    put_file("two.raw", "", counting + 6, 6);
    put_file("slice05.raw", "", counting, 6);
    put_file("slice08.raw", "", counting + 6, 6);
    for (int i = 0; i < 6; i++) {
        name[4] = (char)('1' + i);
        put_file(name, "", counting + 2 * i, 2);
    }
    for (size_t i = 0; i < sizeof headers / sizeof *headers; i++) {
        cw_volume v;
        cw_error err = {0};
        put_file("a.nhdr", headers[i], NULL, 0);
        assert_ok(read_back("a.nhdr", &v, &err), err);
        assert_memory_equal(v.data, counting, sizeof counting);
        check_regions("a.nhdr", NULL);
        cw_volume_free(&v);
    }
}

/* Patterns may count down, and Windows writes backslashes. */
static void names_of_data_files_come_from_everywhere(void **state)
{
    (void)state;
    static const char *const headers[] = {
        DETACHED "up%d.raw 7 1 -6\n", DETACHED "up%02d.raw 9 8 -1\n",
        DETACHED "sub\\whole.raw\n", DETACHED ".\\sub\\whole.raw\n",
        DETACHED "LIST\nsub\\first.raw\nsub\\second.raw\n"};
    mkdir(test_path("sub"), 0777);
    put_file("up7.raw", "", counting, 6);
    put_file("up1.raw", "", counting + 6, 6);
    put_file("up09.raw", "", counting, 6);
    put_file("up08.raw", "", counting + 6, 6);
    put_file("sub/whole.raw", "", counting, 12);
    put_file("sub/first.raw", "", counting, 6);
    put_file("sub/second.raw", "", counting + 6, 6);
    cw_read_desc trusting = {.allow_external = false};
    cw_volume v;
    cw_error err = {0};
    for (size_t i = 0; i < 2 * sizeof headers / sizeof *headers; i++) {
        trusting.allow_external = i % 2;
        put_file("a.nhdr", headers[i / 2], NULL, 0);
        assert_ok(cw_volume_read(test_path("a.nhdr"), &trusting, &v, NULL, &err), err);
        assert_memory_equal(v.data, counting, sizeof counting);
        cw_volume_free(&v);
    }
    put_file("odd\\name.raw", "", counting, 12); /* as a name may be here */
    put_file("a.nhdr", DETACHED "odd\\name.raw\n", NULL, 0);
    assert_ok(cw_volume_read(test_path("a.nhdr"), &trusting, &v, NULL, &err), err);
    cw_volume_free(&v);
}

/* Axes without a spacing are axes of space where fewer than three are. */
static void axes_of_unknown_spacing_may_be_of_space(void **state)
{
    (void)state;
    static const struct {
        const char *axes;
        size_t components, steps, dim[3];
        bool is_told;
    } cases[] = {
        {"dimension: 3\nsizes: 2 3 2\nspacings: 2 3 nan\n", 1, 1, {2, 3, 2}, true},
        {"dimension: 3\nsizes: 2 3 2\nspacings: 2 nan 4\n", 1, 1, {2, 3, 2}, true},
        {"dimension: 3\nsizes: 2 3 2\nspacings: nan 3 4\n", 2, 1, {3, 2, 1}, false},
        {"dimension: 4\nsizes: 2 3 1 2\nspacings: 2 3 4 nan\n", 1, 2, {2, 3, 1}, false},
        {"dimension: 4\nsizes: 3 1 2 2\nspacings: nan 3 4 nan\n", 3, 1, {1, 2, 2}, true},
        {"dimension: 3\nsizes: 2 3 2\nspacings: 2 3 nan\nkinds: space space time\n",
         1,
         2,
         {2, 3, 1},
         false},
        {"dimension: 3\nsizes: 2 3 2\nspacings: 2 3 nan\nkinds: space space space\n",
         1,
         1,
         {2, 3, 2},
         true}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char header[300], note[300] = "";
        const cw_read_desc desc = {.note = keep_note, .note_user = note};
        cw_volume v;
        cw_error err = {0};
        snprintf(header, sizeof header, U8 "%s\n", cases[i].axes);
        put_file("a.nrrd", header, counting, 12);
        assert_ok(cw_volume_read(test_path("a.nrrd"), &desc, &v, NULL, &err), err);
        if (v.components != cases[i].components || v.steps != cases[i].steps ||
            memcmp(v.dim, cases[i].dim, sizeof v.dim) != 0)
            fail_msg("case %zu: %zu x %zu x %zu, %zu components, %zu steps", i, v.dim[0],
                     v.dim[1], v.dim[2], v.components, v.steps);
        assert_true((strstr(note, "1 is taken") != NULL) == cases[i].is_told);
        cw_volume_free(&v);
    }
}

static void data_files_stay_in_the_headers_folder(void **state)
{
    (void)state;
    const struct {
        const char *name, *words;
    } cases[] = {
        {"/etc/passwd", "an absolute path"},
        {"../x.raw", "a path with '..'"},
        {"sub/../../x.raw", "a path with '..'"},
        {"http://example.org/x.raw", "an address"},
        {"c:\\x.raw", "an absolute path of Windows"},
        {"link.raw", "a symbolic link"},
        {"..\\x.raw", "a path with '..'"},
        {"\\\\host\\x.raw", "an absolute path"},
    };
    cw_volume v;
    cw_error err = {0};
    put_file("real.raw", "", counting, 12);
    assert_int_equal(symlink("real.raw", test_path("link.raw")), 0);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char header[300];
        snprintf(header, sizeof header, DETACHED "%s\n", cases[i].name);
        put_file("a.nhdr", header, NULL, 0);
        assert_fails(read_back("a.nhdr", &v, &err), CW_ERR_UNSAFE, cases[i].words, err);
    }
    put_file("a.nhdr", DETACHED "link.raw\n", NULL, 0);
    const cw_read_desc trusting = {.allow_external = true};
    assert_ok(cw_volume_read(test_path("a.nhdr"), &trusting, &v, NULL, &err), err);
    cw_volume_free(&v);
}

/* A link the user names is the user's business; what is no file at all is refused by name. */
static void only_files_are_opened(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    put_file("a.nrrd", U8_3D "\n", counting, 12);
    put_file("empty.nrrd", "", NULL, 0);
    put_file("odd.xyz", "hello", NULL, 0);
    assert_int_equal(symlink("a.nrrd", test_path("named.nrrd")), 0);
    assert_int_equal(mkfifo(test_path("pipe.nrrd"), 0600), 0);
    assert_ok(read_back("named.nrrd", &v, &err), err);
    cw_volume_free(&v);
    assert_fails(read_back("pipe.nrrd", &v, &err), CW_ERR_IO, "a named pipe, not a file", err);
    assert_fails(read_back("", &v, &err), CW_ERR_FORMAT,
                 "is a slice; volumes by themselves: 1 (nrrd), name one of them; 1 links", err);
    put_file("a.nhdr", U8_3D "data file: pipe.nrrd\n", NULL, 0);
    assert_fails(read_back("a.nhdr", &v, &err), CW_ERR_IO, "a named pipe, not a file", err);
    assert_fails(read_back("none.nrrd", &v, &err), CW_ERR_IO, "No such file", err);
    assert_fails(read_back("empty.nrrd", &v, &err), CW_ERR_IO, "the file is empty", err);
    assert_fails(read_back("odd.xyz", &v, &err), CW_ERR_FORMAT, "(desc->raw)", err);
    const cw_read_desc odd = {.reader = "jpeg"};
    assert_fails(cw_volume_read(test_path("a.nrrd"), &odd, &v, NULL, &err), CW_ERR_ARGUMENT,
                 "nrrd, nifti, metaimage", err);
}

/* Damaged headers, and words of the message. */
static void damaged_headers_are_told_field_by_field(void **state)
{
    (void)state;
    const struct {
        const char *header, *words;
    } cases[] = {
        {"hello\n\n", "the first line is not 'NRRD0001'"},
        {"NRRD0009\n\n", "the version is 'NRRD0009'"},
        {U8 "dimension: 3\nsizes: 2 3\n\n", "'sizes' lists 2 numbers; 'dimension' says 3"},
        {U8 "dimension: 3\nsizes: 2 3 4 5\n\n", "'sizes' lists 4 numbers; 'dimension' says 3"},
        {U8 "dimension: 3\nsizes: 2 0 4\n\n", "'sizes' holds 0"},
        {U8 "dimension: 3\nsizes: 2 -3 4\n\n", "'sizes' holds -3"},
        {U8 "dimension: 3\nsizes: 2 x 4\n\n", "'sizes' holds 'x 4' where a whole number"},
        {U8 "dimension: 3\nsizes: 2.5 3\n\n", "'sizes' holds '2.5 3' where a whole number"},
        {U8 "dimension: 3\nsizes: 2 2 2.5\n\n", "'sizes' holds '2.5' where a whole number"},
        {U8 "dimension: 3\nsizes: 2 39223372036854775807 2\n\n",
         "'sizes' holds '39223372036854775807 2' where a whole number"},
        {U8 "dimension: 17\n\n", "'dimension' is '17'"},
        {U8 "sizes: 2\n\n", "'dimension' is missing"},
        {U8_3D "sizes: 1 1 1\n\n", "appears a second time"},
        {U8_3D "space direction: none\n\n", "'space direction' is not a field of NRRD"},
        {U8_3D "nonsense\n\n", "line 6 holds no 'field: value'"},
        {"NRRD0004\ntype: block\ndimension: 1\nsizes: 1\n\n", "'type' is block; the types"},
        {"NRRD0004\ntype: short\ndimension: 1\nsizes: 1\nencoding: raw\n\n",
         "'endian' is missing"},
        {"NRRD0004\ntype: int8\ndimension: 1\nsizes: 1\nencoding: zstd\n\n",
         "'encoding' is zstd; those that are read are raw, gzip, bzip2, ascii and hex"},
        {"NRRD0004\ntype: int8\ndimension: 1\nsizes: 2\nencoding: hex\n\n012",
         "'sizes' asks for 2 bytes of voxels, encoded; the file holds 3 bytes"},
        {"NRRD0004\ntype: int8\ndimension: 1\nsizes: 2\nencoding: hex\n\n01 2  ",
         "wanted 2 bytes from byte 0 on, there were 1"},
        {"NRRD0004\ntype: int8\ndimension: 1\nsizes: 2\nencoding: hex\n\n01 2g",
         "byte 61 of the file is not a hexadecimal digit"},
        {"NRRD0004\ntype: short\ndimension: 1\nsizes: 1\nencoding: hex\n\n0001",
         "'endian' is missing"},
        {"NRRD0004\ntype: int8\ndimension: 1\nsizes: 3\nencoding: ascii\n\n1 2   \n",
         "end after 2 numbers"},
        {"NRRD0004\ntype: int8\ndimension: 1\nsizes: 3\nencoding: ascii\n\n1 2 200",
         "i8 cannot hold"},
        {U8_3D "space: mars\n\n", "'space' is 'mars'"},
        {U8_3D "space: LPS\nspace directions: (1,0,0) (0,1,0)\n\n", "lists 2 vectors"},
        {U8_3D "space: LPS\nspace directions: (1,0) (0,1) (0,0)\n\n",
         "(3 finite numbers) belong"},
        {U8_3D "space: LPS\nspace directions: (nan,0,0) (0,1,0) (0,0,1)\n\n",
         "3 finite numbers"},
        {U8_3D "space: LPS\nspace directions: (1,0,0) (0,1,0) (1,1,0)\n\nx",
         "lie in one plane"},
        {U8_3D "space: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,0)\n\nx",
         "axis 2 no length"},
        {U8_3D "space directions: (1,0,0) (0,1,0) (0,0,1)\n\n", "need 'space'"},
        {U8_3D "spacings: 1 0 1\n\nx", "'spacings' gives axis 1 no length"},
        {U8_3D "spacings: 1 inf 1\n\nx", "not finite"},
        {U8_3D "kinds: vector list domain\n\n", "a second axis of values"},
        {U8_3D "kinds: domain domain\n\n", "'kinds' lists 2 words; 'dimension' says 3"},
        {U8_3D "data file: none.raw\n", "none.raw: cannot be opened"},
        {U8_3D "data file: LIST\na\nb\nc\n", "names 3 files; 'sizes' needs 2"},
        {U8_3D "data file: x%s.raw 1 2 1\n", "needs one %d"},
        {U8_3D "data file: x%d%d.raw 1 2 1\n", "needs one %d"},
        {U8_3D "data file: x%d.raw 1 2 0\n", "counts from 1 to 2 by 0; it must reach its end"},
        {U8_3D "data file: x%d.raw 1 2 -1\n", "counts from 1 to 2 by -1"},
        {U8_3D "data file: x%d.raw 1 -2 -1\n", "counts from 1 to -2 by -1"},
        {U8_3D "data file: x%d.raw 1 2\n", "three numbers"},
        {U8_3D "data file: x%d.raw 1 2000000000 1\n", "more than 65536"},
        {U8_3D, "the file ends with its header"},
        {U8_3D "\nshort", "'sizes' asks for 12 bytes of voxels; the file holds 5 bytes"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        cw_volume v;
        cw_error err = {0};
        put_file("a.nrrd", cases[i].header, NULL, 0);
        if (read_back("a.nrrd", &v, &err) == CW_OK)
            fail_msg("case %zu was read; not: %s", i, cases[i].words);
        if (!strstr(err.message, cases[i].words))
            fail_msg("case %zu says: %s; not: %s", i, err.message, cases[i].words);
        assert_non_null(strstr(err.message, "a.nrrd: "));
    }
}

/* If these sizes reached the allocator, its counter would tell. */
static void lying_sizes_fail_before_any_allocation(void **state)
{
    (void)state;
    const struct {
        const char *sizes, *encoding, *words;
        cw_status status;
    } cases[] = {
        {"2147483647 2147483647 1", "raw", "'sizes' asks for 4611686014132420609",
         CW_ERR_FORMAT},
        {"2147483647 2147483647 1", "gzip", "'sizes' asks for 4611686014132420609",
         CW_ERR_FORMAT},
        {"2147483647 2147483647 1", "ascii", "'sizes' asks for 4611686014132420609",
         CW_ERR_FORMAT},
        {"2147483647 2147483647 1", "hex", "'sizes' asks for 4611686014132420609",
         CW_ERR_FORMAT},
        {"2147483647 2147483647 1", "bzip2",
         cwi_bzip2_present() ? "'sizes' asks for 4611686014132420609" : "has no libbz2",
         cwi_bzip2_present() ? CW_ERR_FORMAT : CW_ERR_UNSUPPORTED},
        {"2147483647 2147483647 9", "raw", "'sizes' asks for more", CW_ERR_LIMIT},
        {"2147483648 1 1", "raw", "'sizes' holds 2147483648", CW_ERR_FORMAT},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char header[300];
        cw_volume v;
        cw_error err = {0};
        snprintf(header, sizeof header,
                 "NRRD0004\ntype: uint8\ndimension: 3\nsizes: %s\nencoding: %s\n\nx",
                 cases[i].sizes, cases[i].encoding);
        put_file("a.nrrd", header, NULL, 0);
        cwi_alloc_fail_after(1); /* the header's text, and no more */
        const cw_status st = read_back("a.nrrd", &v, &err);
        assert_false(cwi_alloc_fail_after(-1));
        assert_fails(st, cases[i].status, cases[i].words, err);
    }
}

static void limits_name_the_value_and_the_limit(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    const cw_read_desc voxels = {.max_voxels = 11}, bytes = {.max_bytes = 11};
    put_file("a.nrrd", U8_3D "\n", counting, 12);
    assert_fails(cw_volume_read(test_path("a.nrrd"), &voxels, &v, NULL, &err), CW_ERR_LIMIT,
                 "'sizes' asks for 12 voxels; the limit is 11 (desc->max_voxels)", err);
    assert_fails(cw_volume_read(test_path("a.nrrd"), &bytes, &v, NULL, &err), CW_ERR_LIMIT,
                 "12 bytes of voxels; the limit is 11 bytes (desc->max_bytes)", err);
}

static void the_header_alone_is_checked_but_holds_no_voxels(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    const cw_read_desc desc = {.header_only = true};
    put_file("a.nrrd", U8_3D "space: RAS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n\n",
             counting, 12);
    assert_ok(cw_volume_read(test_path("a.nrrd"), &desc, &v, NULL, &err), err);
    assert_null(v.data);
    assert_int_equal(v.dim[1], 3);
    assert_true(v.affine[0][0] == -1);
    put_file("a.nrrd", U8_3D "\n", counting, 11);
    assert_fails(cw_volume_read(test_path("a.nrrd"), &desc, &v, NULL, &err), CW_ERR_FORMAT,
                 "the file holds 11 bytes", err);
}

static bool stop(void *user, const char *step, double done)
{
    (void)user, (void)done;
    assert_string_equal(step, "reading");
    return false;
}

static void a_reader_can_be_interrupted(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    const cw_read_desc desc = {.progress = {.report = stop}};
    put_file("a.nrrd", U8_3D "\n", counting, 12);
    assert_fails(cw_volume_read(test_path("a.nrrd"), &desc, &v, NULL, &err), CW_ERR_CANCELLED,
                 "interrupted while reading", err);
    assert_null(v.data);
}

static void long_headers_are_cut_off(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    char *long_text = malloc(2000001);
    assert_non_null(long_text);
    memset(long_text, '#', 2000000);
    put_file("a.nrrd", "NRRD0004\n", long_text, 2000000);
    assert_fails(read_back("a.nrrd", &v, &err), CW_ERR_FORMAT, "line 2 of the header is longer",
                 err);
    for (size_t i = 0; i < 2000000; i += 100)
        long_text[i] = '\n', long_text[i + 1] = '#';
    put_file("a.nrrd", "NRRD0004", long_text, 2000000);
    assert_fails(read_back("a.nrrd", &v, &err), CW_ERR_FORMAT, "longer than 1 MiB", err);
    put_file("a.nrrd", "NRRD0004\n", "ty\0pe: uint8\n\n", 14);
    assert_fails(read_back("a.nrrd", &v, &err), CW_ERR_FORMAT,
                 "line 2 of the header holds a zero", err);
    free(long_text);
}

/* Lines that end with carriage returns alone, as on an old Macintosh. */
static void old_line_ends_are_read(void **state)
{
    (void)state;
    char header[] = U8_3D "\n";
    cw_volume v;
    cw_error err = {0};
    for (char *c = header; *c; c++)
        *c = *c == '\n' ? '\r' : *c;
    put_file("a.nrrd", header, "\n1234567890", 12); /* the data may begin with the other one */
    assert_ok(read_back("a.nrrd", &v, &err), err);
    assert_memory_equal(v.data, "\n1234567890", 12);
    cw_volume_free(&v);
}

static void a_cut_is_never_a_volume(void **state)
{
    (void)state;
    size_t size;
    unsigned char *packed = pack_bytes(counting, 12, true, &size);
    put_file("a.nrrd", U8_3D "\n", counting, 12);
    check_every_cut("a.nrrd");
    put_file("a.nrrd", GZIP_3D "\n", packed, size);
    check_every_cut("a.nrrd");
    put_file("a.nrrd",
             "NRRD0004\ntype: uint8\nencoding: ascii\ndimension: 3\nsizes: 2 3 2\n\n"
             "0 1 2 3 4 5 6 7 8 9 10 1",
             NULL, 0);
    check_every_cut("a.nrrd");
    put_file("a.nrrd", HEX_3D "\n000102030405060708090A0b", NULL, 0);
    check_every_cut("a.nrrd");
    put_file("one.raw", "", counting, 6);
    put_file("two.raw", "", counting + 6, 6);
    put_file("a.nhdr", U8_3D "data file: LIST\none.raw\ntwo.raw\n", NULL, 0);
    check_cuts("a.nhdr", "one.raw", 0);
    check_cuts("a.nhdr", "two.raw", 0);
    free(packed);
}

static void nothing_but_zeros_may_follow_gzip_data(void **state)
{
    (void)state;
    size_t size;
    unsigned char *packed = pack_bytes(counting, 12, true, &size);
    put_file("a.nrrd", GZIP_3D "\n", packed, size);
    check_tail("a.nrrd", "a.nrrd");
    put_file("a.gz", "", packed, size);
    put_file("a.nhdr", GZIP_3D "data file: a.gz\n", NULL, 0);
    check_tail("a.nhdr", "a.gz");
    free(packed);
}

static cw_status read_counting(const char *name, cw_error *err)
{
    cw_volume v = {0};
    const cw_status st = read_back(name, &v, err);
    if (st == CW_OK)
        assert_memory_equal(v.data, counting, sizeof counting);
    cw_volume_free(&v);
    return st;
}

/* Whole or in two streams, in the header's file or beside it; damage is refused or does not
 * matter. */
static void bzip2_data_are_read_and_checked(void **state)
{
    (void)state;
    cw_error err = {0};
    put_file("a.nrrd", BZ2_3D "\n", bzipped, sizeof bzipped);
    if (!cwi_bzip2_present()) {
        assert_fails(read_counting("a.nrrd", &err), CW_ERR_UNSUPPORTED, "libbz2-dev", err);
        return;
    }
    assert_ok(read_counting("a.nrrd", &err), err);
    check_regions("a.nrrd", NULL);
    check_every_cut("a.nrrd");
    check_tail("a.nrrd", "a.nrrd");
    put_file("a.bz2", "", halves, sizeof halves);
    put_file("a.nhdr", BZ2_3D "data file: a.bz2\n", NULL, 0);
    assert_ok(read_counting("a.nhdr", &err), err);
    check_tail("a.nhdr", "a.bz2");
    check_starved_reads("a.nhdr");
    size_t refusals = 0;
    for (size_t i = 0; i < sizeof bzipped; i++) { /* some bits are of codes that are not used */
        uint8_t damaged[sizeof bzipped];
        memcpy(damaged, bzipped, sizeof bzipped);
        damaged[i] ^= 0x10;
        put_file("a.nrrd", BZ2_3D "\n", damaged, sizeof damaged);
        refusals += read_counting("a.nrrd", &err) == CW_ERR_FORMAT;
    }
    assert_true(refusals > sizeof bzipped * 3 / 4);
    put_file("a.nrrd", BZ2_3D "\n", "BZip is not", 11);
    assert_fails(read_counting("a.nrrd", &err), CW_ERR_FORMAT, "incorrect header check", err);
}

static void memory_may_run_out_anywhere(void **state)
{
    (void)state;
    size_t size;
    unsigned char *packed = pack_bytes(counting, 6, true, &size);
    put_file("one.gz", "", packed, size);
    put_file("two.gz", "", packed, size);
    put_file("a.nhdr", GZIP_3D "data file: LIST\none.gz\ntwo.gz\n", NULL, 0);
    check_starved_reads("a.nhdr");
    free(packed);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(a_plain_header_gives_its_voxels),
        TEST(slicer_says_that_its_values_are_labels),
        TEST(frames_are_turned_to_lps_millimetres),
        TEST(axes_find_their_roles),
        TEST(interleaved_values_are_reached_by_strides),
        TEST(flat_data_get_a_third_direction),
        TEST(time_is_told_in_seconds),
        TEST(only_short_lists_are_values),
        TEST(encodings_and_byte_orders_give_the_same_numbers),
        TEST(voxels_may_lie_in_files_of_their_own),
        TEST(names_of_data_files_come_from_everywhere),
        TEST(axes_of_unknown_spacing_may_be_of_space),
        TEST(data_files_stay_in_the_headers_folder),
        TEST(only_files_are_opened),
        TEST(damaged_headers_are_told_field_by_field),
        TEST(lying_sizes_fail_before_any_allocation),
        TEST(limits_name_the_value_and_the_limit),
        TEST(the_header_alone_is_checked_but_holds_no_voxels),
        TEST(a_reader_can_be_interrupted),
        TEST(long_headers_are_cut_off),
        TEST(old_line_ends_are_read),
        TEST(a_cut_is_never_a_volume),
        TEST(nothing_but_zeros_may_follow_gzip_data),
        TEST(bzip2_data_are_read_and_checked),
        TEST(memory_may_run_out_anywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
