/* Tests the reader of MetaImage: frames, types, encodings, data files, and damaged or lying
 * headers. */
#define _GNU_SOURCE /* symlink */
#include "support/files/reading.h"
#include "support/files/regions.h"

#include <stdio.h>
#include <unistd.h>

static const uint8_t counting[12] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};

#define U8_3D "ObjectType = Image\nNDims = 3\nDimSize = 2 3 2\nElementType = MET_UCHAR\n"
#define LOCAL "ElementDataFile = LOCAL\n"

static void a_plain_header_gives_its_voxels(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    const char *format = NULL;
    put_file("a.mha", U8_3D "MyOwnKey = 7\n" LOCAL, counting, sizeof counting);
    assert_ok(cw_volume_read(test_path("a.mha"), NULL, &v, &format, &err), err);
    assert_string_equal(format, "metaimage");
    assert_int_equal(v.known, CW_KNOWN_FRAME | CW_KNOWN_UNIT);
    assert_memory_equal(v.data, counting, sizeof counting);
    check_affine(&v, (const double[12]){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0});
    cw_volume_free(&v);
}

/* The matrix holds the direction of axis after axis, as a file of ITK does. */
static void frames_are_columns_of_direction_times_spacing(void **state)
{
    (void)state;
    const struct {
        const char *header;
        double affine[12];
    } cases[] = {
        {"ElementSpacing = 2 3 4\nOffset = 5 6 7\n", {2, 0, 0, 5, 0, 3, 0, 6, 0, 0, 4, 7}},
        {"ElementSize = 2 3 4\nOrigin = 5 6 7\n", {2, 0, 0, 5, 0, 3, 0, 6, 0, 0, 4, 7}},
        {"ElementSize = 9 9 9\nElementSpacing = 2 3 4\nPosition = 0 0 0\n",
         {2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4, 0}},
        {"ElementSpacing = 2 3 4\nTransformMatrix = 0 1 0 0 0 1 -1 0 0\n",
         {0, 0, -4, 0, 2, 0, 0, 0, 0, 3, 0, 0}},
        {"Rotation = -1 0 0 0 1 0 0 0 1\n", {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}},
        {"ElementSpacing = 1 1 1\nOffset = 1 2 3\nDistanceUnits = cm\n",
         {10, 0, 0, 10, 0, 10, 0, 20, 0, 0, 10, 30}},
        {"ElementSpacing = 1 1 1\nOffset = 1 2 3\nDistanceUnits = um\n",
         {1e-3, 0, 0, 1e-3, 0, 1e-3, 0, 2e-3, 0, 0, 1e-3, 3e-3}},
        {"ElementSpacing = 4.000000e+000 4 4\n", {4, 0, 0, 0, 0, 4, 0, 0, 0, 0, 4, 0}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char header[500];
        cw_volume v;
        cw_error err = {0};
        snprintf(header, sizeof header, U8_3D "%s" LOCAL, cases[i].header);
        put_file("a.mha", header, counting, sizeof counting);
        assert_ok(read_back("a.mha", &v, &err), err);
        check_affine(&v, cases[i].affine);
        cw_volume_free(&v);
    }
}

static void values_are_those_of_the_line_that_is_stated(void **state)
{
    (void)state;
    static const struct {
        const char *keys;
        double slope, intercept;
    } cases[] = {
        {"", 1, 0},
        {"ElementToIntensityFunctionSlope = 2\nElementToIntensityFunctionOffset = -100\n", 2,
         -100},
        {"ElementToIntensityFunctionOffset = 5\n", 1, 5},
        {"ElementToIntensityFunctionSlope = -0.25\n", -0.25, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char header[300];
        cw_volume v;
        cw_error err = {0};
        snprintf(header, sizeof header, U8_3D "%s" LOCAL, cases[i].keys);
        put_file("a.mha", header, counting, sizeof counting);
        assert_ok(read_back("a.mha", &v, &err), err);
        assert_true(cw_volume_value(&v, 1, 2, 1) == 11 * cases[i].slope + cases[i].intercept);
        cw_volume_free(&v);
    }
}

static void two_and_four_dimensions_are_read(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    put_file("a.mha",
             "NDims = 2\nDimSize = 4 3\nElementType = MET_UCHAR\nElementSpacing = 2 3\n" LOCAL,
             counting, 12);
    assert_ok(read_back("a.mha", &v, &err), err);
    assert_int_equal(v.dim[2], 1);
    assert_int_equal(v.known, 0);
    check_affine(&v, (const double[12]){2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 1, 0});
    cw_volume_free(&v);
    put_file("a.mha",
             "NDims = 4\nDimSize = 2 3 1 2\nElementType = MET_UCHAR\nElementSpacing = 2 3 4 5\n"
             "TransformMatrix = 0 1 0 0 1 0 0 0 0 0 1 0 0 0 0 1\nOffset = 1 2 3 4\n" LOCAL,
             counting, 12);
    assert_ok(read_back("a.mha", &v, &err), err);
    assert_int_equal(v.steps, 2);
    check_affine(&v, (const double[12]){0, 3, 0, 1, 2, 0, 0, 2, 0, 0, 4, 3});
    cw_volume_free(&v);
}

static void channels_are_interleaved(void **state)
{
    (void)state;
    cw_volume v, third;
    cw_error err = {0};
    put_file("a.mha",
             "NDims = 3\nDimSize = 2 2 1\nElementType = MET_UCHAR_ARRAY\n"
             "ElementNumberOfChannels = 3\n" LOCAL,
             counting, 12);
    assert_ok(read_back("a.mha", &v, &err), err);
    assert_int_equal(v.components, 3);
    assert_ok(cw_volume_select(&v, 2, 0, &third, &err), err);
    assert_true(cw_volume_value(&third, 1, 1, 0) == 11);
    cw_volume_free(&v);
}

static void byte_orders_and_encodings_give_the_same_numbers(void **state)
{
    (void)state;
    const int16_t wanted[4] = {1, -2, 300, -32768};
    const uint8_t little[8] = {1, 0, 0xfe, 0xff, 0x2c, 1, 0, 0x80};
    const uint8_t big[8] = {0, 1, 0xff, 0xfe, 1, 0x2c, 0x80, 0};
    size_t zlib_size;
    unsigned char *zlib = pack_bytes(big, 8, false, &zlib_size);
    const struct {
        const char *fields;
        const void *bytes;
        size_t size;
    } cases[] = {
        {"", little, 8},
        {"BinaryDataByteOrderMSB = False\n", little, 8},
        {"ElementByteOrderMSB = True\n", big, 8},
        {"BinaryDataByteOrderMSB = True\nCompressedData = True\n", zlib, zlib_size},
        {"BinaryData = False\n", "1 -2 300 -32768", 15},
        {"HeaderSize = -1\n", "junk\1\0\xfe\xff\x2c\1\0\x80", 12},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char header[500];
        cw_volume v;
        cw_error err = {0};
        snprintf(
            header, sizeof header,
            "ObjectType = Image\nNDims = 3\nDimSize = 4 1 1\nElementType = MET_SHORT\n%s" LOCAL,
            cases[i].fields);
        put_file("a.mha", header, cases[i].bytes, cases[i].size);
        assert_ok(read_back("a.mha", &v, &err), err);
        assert_memory_equal(v.data, wanted, sizeof wanted);
        check_regions("a.mha", NULL);
        cw_volume_free(&v);
    }
    free(zlib);
}

static void every_type_has_its_name(void **state)
{
    (void)state;
    const struct {
        const char *name;
        cw_type type;
    } cases[] = {
        {"MET_UCHAR", CW_U8},   {"MET_CHAR", CW_I8},  {"MET_USHORT", CW_U16},
        {"MET_SHORT", CW_I16},  {"MET_UINT", CW_U32}, {"MET_INT", CW_I32},
        {"MET_ULONG", CW_U32},  {"MET_LONG", CW_I32}, {"MET_FLOAT", CW_F32},
        {"MET_DOUBLE", CW_F64},
    };
    const uint8_t zeros[8] = {0};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char header[300];
        cw_volume v;
        cw_error err = {0};
        snprintf(header, sizeof header, "NDims = 3\nDimSize = 1 1 1\nElementType = %s\n" LOCAL,
                 cases[i].name);
        put_file("a.mha", header, zeros, cw_type_size(cases[i].type));
        assert_ok(read_back("a.mha", &v, &err), err);
        assert_int_equal(v.type, cases[i].type);
        cw_volume_free(&v);
    }
}

static void voxels_may_lie_in_files_of_their_own(void **state)
{
    (void)state;
    static const char *const headers[] = {
        U8_3D "ElementDataFile = whole.raw\n",
        U8_3D "HeaderSize = 3\nElementDataFile = padded.raw\n",
        U8_3D "HeaderSize = -1\nElementDataFile = padded.raw\n",
        U8_3D "ElementDataFile = LIST\none.raw\ntwo.raw\n",
        U8_3D "ElementDataFile = LIST 2D\none.raw\ntwo.raw\n",
        U8_3D "ElementDataFile = LIST 3\nwhole.raw\n",
        U8_3D "ElementDataFile = slice%03d.raw 1 2 1\n",
    };
    put_file("whole.raw", "", counting, 12);
    put_file("padded.raw", "xyz", counting, 12);
    put_file("one.raw", "", counting, 6);
    put_file("two.raw", "", counting + 6, 6);
    put_file("slice001.raw", "", counting, 6);
    put_file("slice002.raw", "", counting + 6, 6);
    for (size_t i = 0; i < sizeof headers / sizeof *headers; i++) {
        cw_volume v;
        cw_error err = {0};
        put_file("a.mhd", headers[i], NULL, 0);
        assert_ok(read_back("a.mhd", &v, &err), err);
        assert_memory_equal(v.data, counting, sizeof counting);
        check_regions("a.mhd", NULL);
        cw_volume_free(&v);
    }
}

static void damaged_headers_are_told_key_by_key(void **state)
{
    (void)state;
    const struct {
        const char *header, *words;
    } cases[] = {
        {"garbage", "line 1 holds no 'Key = value'"},
        {U8_3D, "'ElementDataFile' is missing"},
        {"NDims = 3\n" LOCAL, "'ElementType' is missing"},
        {"ElementType = MET_UCHAR\n" LOCAL, "'NDims' is missing"},
        {"ElementType = MET_UCHAR\nNDims = 3\n" LOCAL, "'DimSize' is missing"},
        {"ElementType = MET_UCHAR\nNDims = 5\n" LOCAL, "'NDims' is '5'"},
        {"ElementType = MET_UCHAR\nNDims = 3\nDimSize = 2 3\n" LOCAL,
         "'DimSize' lists 2 numbers; 'NDims' says 3"},
        {U8_3D "ElementToIntensityFunctionSlope = 0\n" LOCAL "123456789012",
         "'ElementToIntensityFunctionSlope' is 0"},
        {U8_3D "ElementToIntensityFunctionOffset = nan\n" LOCAL "123456789012",
         "must be finite"},
        {U8_3D "ElementToIntensityFunctionSlope = two\n" LOCAL "123456789012", "holds 'two'"},
        {"ElementType = MET_STRING\n" LOCAL, "'ElementType' is MET_STRING; the types"},
        {U8_3D "NDims = 3\n" LOCAL, "'NDims' was given before"},
        {U8_3D "ElementSpacing = 1 1\n" LOCAL,
         "'ElementSpacing' lists 2 numbers; 'NDims' says 3"},
        {U8_3D "ElementSpacing = 1 0 1\n" LOCAL, "gives axis 1 no length"},
        {U8_3D "ElementSpacing = 1 nan 1\n" LOCAL, "not finite"},
        {U8_3D "TransformMatrix = 1 0 0 1 0 0 0 0 1\n" LOCAL, "lie in one plane"},
        {U8_3D "ElementNumberOfChannels = 17\n" LOCAL, "'ElementNumberOfChannels' is '17'"},
        {U8_3D "CompressedData = maybe\n" LOCAL, "'CompressedData' is 'maybe'"},
        {U8_3D "DistanceUnits = inch\n" LOCAL, "'DistanceUnits' is 'inch'"},
        {U8_3D "CompressedData = True\nHeaderSize = -1\n" LOCAL, "'HeaderSize' is -1"},
        {U8_3D "BinaryData = False\nHeaderSize = -1\n" LOCAL, "'HeaderSize' is -1"},
        {U8_3D "CompressedData = True\nCompressedDataSize = 99\n" LOCAL "x",
         "'CompressedDataSize' is 99; the file holds 1"},
        {U8_3D "CompressedData = True\n" LOCAL "hello", "the compressed data are damaged"},
        {U8_3D "ElementDataFile = LIST\na\nb\nc\n", "names 3 files; 'DimSize' needs 2"},
        {U8_3D "ElementDataFile = LIST of files\n", "'LIST of files'; 'LIST 2D' was expected"},
        {U8_3D "ElementDataFile = ../x.raw\n", "a path with '..'"},
        {U8_3D "ElementDataFile = none.raw\n", "none.raw: cannot be opened"},
        {U8_3D LOCAL "short", "'DimSize' asks for 12 bytes of voxels; the file holds 5"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        cw_volume v;
        cw_error err = {0};
        put_file("a.mhd", cases[i].header, NULL, 0);
        if (read_back("a.mhd", &v, &err) == CW_OK)
            fail_msg("case %zu was read; not: %s", i, cases[i].words);
        if (!strstr(err.message, cases[i].words))
            fail_msg("case %zu says: %s; not: %s", i, err.message, cases[i].words);
    }
}

/* In the header's own file, and beside it as far as that file can hold them; 0 is a size that
 * no one knew. */
static void the_compressed_size_is_that_of_the_data(void **state)
{
    (void)state;
    static const struct {
        int off;           /* from the true size */
        size_t padding;    /* zeros behind the data */
        const char *words; /* NULL: it is read */
    } rows[] = {{0, 0, NULL},
                {0, 3, NULL},
                {3, 3, NULL},
                {-1, 0, "; the compressed data take "},
                {-1, 3, "; the compressed data take "},
                {-9, 0, "'CompressedDataSize' is "},
                {1, 0, "; the file holds "},
                {4, 3, "; the file holds "}};
    size_t size;
    unsigned char *zlib = pack_bytes(counting, sizeof counting, false, &size);
    unsigned char data[256] = {0};
    assert_true(size + 3 < sizeof data);
    memcpy(data, zlib, size);
    free(zlib);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        for (int beside = 0; beside < 2; beside++) {
            char header[500];
            cw_volume v = {0};
            cw_error err = {0};
            snprintf(header, sizeof header,
                     U8_3D "CompressedData = True\nCompressedDataSize = %d\n"
                           "ElementDataFile = %s\n",
                     (int)size + rows[i].off, beside ? "a.zraw" : "LOCAL");
            put_file("a.mha", header, data, beside ? 0 : size + rows[i].padding);
            put_file("a.zraw", "", data, size + rows[i].padding);
            const cw_status st = read_back("a.mha", &v, &err);
            if (rows[i].words && !(beside && rows[i].off < 0))
                assert_fails(st, CW_ERR_FORMAT, rows[i].words, err);
            else
                assert_ok(st, err);
            cw_volume_free(&v);
        }
    put_file("a.mha", U8_3D "CompressedData = True\nCompressedDataSize = 0\n" LOCAL, data,
             size);
    cw_volume v;
    cw_error err = {0};
    assert_ok(read_back("a.mha", &v, &err), err);
    cw_volume_free(&v);
}

/* Lines that end with carriage returns alone, as on an old Macintosh. */
static void old_line_ends_are_read(void **state)
{
    (void)state;
    char header[] = U8_3D LOCAL;
    cw_volume v;
    cw_error err = {0};
    for (char *c = header; *c; c++)
        *c = *c == '\n' ? '\r' : *c;
    put_file("a.mha", header, "\n1234567890", 12); /* the data may begin with the other one */
    assert_ok(read_back("a.mha", &v, &err), err);
    assert_memory_equal(v.data, "\n1234567890", 12);
    cw_volume_free(&v);
}

static void a_cut_is_never_a_volume(void **state)
{
    (void)state;
    static const struct {
        const char *header, *text;
    } cases[] = {
        {U8_3D LOCAL, NULL},
        {U8_3D "CompressedData = True\n" LOCAL, NULL},
        {U8_3D "BinaryData = False\n" LOCAL, "0 1 2 3 4 5 6 7 8 9 10 1"},
    };
    size_t size;
    unsigned char *packed = pack_bytes(counting, 12, false, &size);
    for (size_t i = 0; i < 3; i++) {
        const void *bytes[] = {counting, packed, cases[i].text};
        put_file("a.mha", cases[i].header, bytes[i], i == 0 ? 12 : i == 1 ? size : 24);
        check_cuts("a.mha", "a.mha", strlen(cases[i].header));
    }
    put_file("a.zraw", "", packed, size);
    put_file("a.mhd", U8_3D "CompressedData = True\nElementDataFile = a.zraw\n", NULL, 0);
    check_cuts("a.mhd", "a.zraw", 0);
    free(packed);
}

static void lying_sizes_are_told_before_memory_is_taken(void **state)
{
    (void)state;
    static const struct {
        const char *fields, *words;
    } cases[] = {
        {"DimSize = 2147483647 2147483647 1\n", "asks for 4611686014132420609 bytes of voxels"},
        {"DimSize = 2147483647 2147483647 1\nCompressedData = True\n",
         "asks for 4611686014132420609 bytes of voxels, encoded"},
        {"DimSize = 2147483647 2147483647 1\nBinaryData = False\n",
         "asks for 4611686014132420609 bytes of voxels, encoded"},
        {"DimSize = 2147483647 2147483647 9\n", "more voxels than an address space holds"},
        {"DimSize = 2147483648 1 1\n", "'DimSize' holds 2147483648"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char header[300];
        snprintf(header, sizeof header, "NDims = 3\nElementType = MET_UCHAR\n%s" LOCAL,
                 cases[i].fields);
        put_file("a.mha", header, counting, 12);
        check_told("a.mha", i, cases[i].words);
    }
}

static void data_files_stay_in_the_headers_folder(void **state)
{
    (void)state;
    static const struct {
        const char *name, *words;
    } cases[] = {
        {"/etc/passwd", "an absolute path"}, {"LIST\n../x.raw\nx.raw", "a path with '..'"},
        {"http://x.org/x", "an address"},    {"x%2e%2e.raw", "needs one %d"},
        {"link.raw", "a symbolic link"},
    };
    put_file("x.raw", "", counting, 12);
    assert_int_equal(symlink("x.raw", test_path("link.raw")), 0);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char header[300];
        snprintf(header, sizeof header, U8_3D "ElementDataFile = %s\n", cases[i].name);
        put_file("a.mhd", header, NULL, 0);
        check_told("a.mhd", i, cases[i].words);
    }
}

static void nothing_but_zeros_may_follow_zlib_data(void **state)
{
    (void)state;
    size_t size;
    unsigned char *packed = pack_bytes(counting, 12, false, &size);
    put_file("a.mha", U8_3D "CompressedData = True\n" LOCAL, packed, size);
    check_tail("a.mha", "a.mha");
    put_file("a.zraw", "", packed, size);
    put_file("a.mhd", U8_3D "CompressedData = True\nElementDataFile = a.zraw\n", NULL, 0);
    check_tail("a.mhd", "a.zraw");
    free(packed);
}

static void memory_may_run_out_anywhere(void **state)
{
    (void)state;
    size_t size;
    unsigned char *packed = pack_bytes(counting, 12, false, &size);
    put_file("a.zraw", "", packed, size);
    put_file("a.mhd", U8_3D "CompressedData = True\nElementDataFile = a.zraw\n", NULL, 0);
    check_starved_reads("a.mhd");
    free(packed);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(a_plain_header_gives_its_voxels),
        TEST(frames_are_columns_of_direction_times_spacing),
        TEST(values_are_those_of_the_line_that_is_stated),
        TEST(two_and_four_dimensions_are_read),
        TEST(channels_are_interleaved),
        TEST(byte_orders_and_encodings_give_the_same_numbers),
        TEST(every_type_has_its_name),
        TEST(voxels_may_lie_in_files_of_their_own),
        TEST(damaged_headers_are_told_key_by_key),
        TEST(the_compressed_size_is_that_of_the_data),
        TEST(old_line_ends_are_read),
        TEST(a_cut_is_never_a_volume),
        TEST(lying_sizes_are_told_before_memory_is_taken),
        TEST(data_files_stay_in_the_headers_folder),
        TEST(nothing_but_zeros_may_follow_zlib_data),
        TEST(memory_may_run_out_anywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
