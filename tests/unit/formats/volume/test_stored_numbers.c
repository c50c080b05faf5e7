/* Tests numbers that no type of voxels has: integers of 64 bits, floats of 16 bits, in every format
 * that has them; and bytes that are left over behind the voxels. */
#include "formats/bytes/stored_numbers.h"
#include "support/files/reading.h"
#include "support/files/regions.h"

#include <math.h>
#include <stdio.h>

enum { COUNT = 12, NOTES = 600 };

static const double small_integers[COUNT] = {-3, -2, -1, 0, 1, 2, 3, 4, 5, 6, 7, 2147483647};
static const double large_integers[COUNT] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 4294967295};
static const double reals[COUNT] = {-65504, -1.5, -0.0,  0,       0.5,     1,
                                    2.25,   1024, 65504, 0x1p-14, 0x1p-24, -0x1p-20};

/* Stores a number byte by byte. */
static void store(unsigned char *to, cwi_stored stored, double value, bool big)
{
    const size_t size = cwi_stored_size(stored, CW_F32);
    const uint64_t bits = stored == CWI_STORED_F16   ? cwi_stored_half(value)
                          : stored == CWI_STORED_I64 ? (uint64_t)(int64_t)value
                                                     : (uint64_t)value;
    for (size_t b = 0; b < size; b++)
        to[big ? size - 1 - b : b] = (unsigned char)(bits >> 8 * b);
}

static size_t store_all(unsigned char *to, cwi_stored stored, const double *values, bool big)
{
    const size_t size = cwi_stored_size(stored, CW_F32);
    for (size_t i = 0; i < COUNT; i++)
        store(to + i * size, stored, values[i], big);
    return COUNT * size;
}

/* --- headers of 2 x 3 x 2 voxels ---------------------------------------------------------- */

static size_t put_nifti(unsigned char *to, cwi_stored stored)
{
    const int16_t type = stored == CWI_STORED_I64 ? 1024 : 1280, bits = 64;
    const int16_t dim[8] = {3, 2, 3, 2, 1, 1, 1, 1};
    const float pixdim[8] = {1, 1, 1, 1}, offset = 352;
    const int32_t size = 348;
    memset(to, 0, 352);
    memcpy(to, &size, 4);
    memcpy(to + 40, dim, sizeof dim);
    memcpy(to + 70, &type, 2);
    memcpy(to + 72, &bits, 2);
    memcpy(to + 76, pixdim, sizeof pixdim);
    memcpy(to + 108, &offset, 4);
    memcpy(to + 344, "n+1", 4);
    return 352;
}

static size_t put_mrc(unsigned char *to)
{
    const int32_t words[4] = {2, 3, 2, 12}, axes[3] = {1, 2, 3};
    memset(to, 0, 1024);
    memcpy(to, words, sizeof words);
    memcpy(to + 28, words, 12);
    memcpy(to + 64, axes, sizeof axes);
    memcpy(to + 208, "MAP \x44\x44", 6);
    return 1024;
}

static size_t put_mgh(unsigned char *to)
{
    const unsigned char head[24] = {0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3,
                                    0, 0, 0, 2, 0, 0, 0, 1, 0, 0, 0, 2};
    memset(to, 0, 284);
    memcpy(to, head, sizeof head);
    return 284;
}

static size_t put_npy(unsigned char *to, const char *descr)
{
    char text[128];
    memset(text, ' ', sizeof text);
    text[snprintf(text, sizeof text,
                  "{'descr': '%s', 'fortran_order': False, 'shape': (2, 3, 2), }", descr)] =
        ' ';
    text[117] = '\n';
    memcpy(to, "\x93NUMPY\1\0\x76\0", 10);
    memcpy(to + 10, text, 118);
    return 128;
}

static size_t put_text(unsigned char *to, const char *text)
{
    strcpy((char *)to, text);
    return strlen(text);
}

static const struct {
    const char *name, *header; /* NULL: by a function */
    cwi_stored stored;
    bool big;
} files[] = {
    {"a.nii", NULL, CWI_STORED_I64, false},
    {"b.nii", NULL, CWI_STORED_U64, false},
    {"a.mrc", NULL, CWI_STORED_F16, false},
    {"a.mgh", NULL, CWI_STORED_I64, true},
    {"a.npy", "<i8", CWI_STORED_I64, false},
    {"b.npy", ">u8", CWI_STORED_U64, true},
    {"c.npy", "<f2", CWI_STORED_F16, false},
    {"a.nrrd",
     "NRRD0004\ntype: long long int\nencoding: raw\nendian: big\ndimension: 3\nsizes: 2 3 2\n\n",
     CWI_STORED_I64, true},
    {"b.nrrd",
     "NRRD0004\ntype: uint64\nencoding: raw\nendian: little\ndimension: 3\nsizes: 2 3 2\n\n",
     CWI_STORED_U64, false},
    {"a.mha",
     "NDims = 3\nDimSize = 2 3 2\nElementType = MET_LONG_LONG\nElementDataFile = LOCAL\n",
     CWI_STORED_I64, false},
    {"b.mha",
     "NDims = 3\nDimSize = 2 3 2\nElementType = MET_ULONG_LONG\nElementByteOrderMSB = "
     "True\nElementDataFile = LOCAL\n",
     CWI_STORED_U64, true},
    {"a.vtk",
     "# vtk DataFile Version 3.0\nt\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 3 2\n"
     "SPACING 1 1 1\nORIGIN 0 0 0\nPOINT_DATA 12\nSCALARS s long\nLOOKUP_TABLE default\n",
     CWI_STORED_I64, true},
    {"b.vtk",
     "# vtk DataFile Version 3.0\nt\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 3 2\n"
     "SPACING 1 1 1\nORIGIN 0 0 0\nPOINT_DATA 12\nSCALARS s vtktypeuint64\nLOOKUP_TABLE default\n",
     CWI_STORED_U64, true},
};
enum { FILES = sizeof files / sizeof *files };

static size_t put_header(size_t n, unsigned char *to)
{
    const char *ending = strchr(files[n].name, '.');
    return strcmp(ending, ".nii") == 0   ? put_nifti(to, files[n].stored)
           : strcmp(ending, ".mrc") == 0 ? put_mrc(to)
           : strcmp(ending, ".mgh") == 0 ? put_mgh(to)
           : strcmp(ending, ".npy") == 0 ? put_npy(to, files[n].header)
                                         : put_text(to, files[n].header);
}

static const double *values_of(cwi_stored stored)
{
    return stored == CWI_STORED_I64   ? small_integers
           : stored == CWI_STORED_U64 ? large_integers
                                      : reals;
}

/* Writes a file, with values of its own form or others, and bytes behind them. */
static void put(size_t n, const double *values, size_t more)
{
    unsigned char bytes[2048];
    size_t size = put_header(n, bytes);
    size += store_all(bytes + size, files[n].stored, values, files[n].big);
    memset(bytes + size, 7, more);
    put_file(files[n].name, "", bytes, size + more);
}

static void keep_note(void *user, const char *text)
{
    strncat(user, text, NOTES - strlen(user) - 1);
}

/* --- tests -------------------------------------------------------------------------------- */

static void floats_of_16_bits_are_those_of_the_standard(void **state)
{
    (void)state;
    static const struct {
        uint16_t half;
        double value;
    } cases[] = {{0x0000, 0},
                 {0x3c00, 1},
                 {0xc000, -2},
                 {0x7bff, 65504},
                 {0x0400, 0x1p-14},
                 {0x0001, 0x1p-24},
                 {0x83ff, -1023 * 0x1p-24},
                 {0x3555, 0x1.554p-2},
                 {0x7c00, INFINITY},
                 {0xfc00, -INFINITY}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        float value;
        assert_int_equal(
            cwi_stored_convert(CWI_STORED_F16, CW_F32, &cases[i].half, 2, 1, &value), 1);
        assert_true((double)value == cases[i].value);
        assert_int_equal(cwi_stored_half(cases[i].value), cases[i].half);
    }
    for (uint32_t h = 0; h < 0x10000; h++) { /* all of them come back, but for kinds of NaN */
        const uint16_t half = (uint16_t)h;
        float value;
        cwi_stored_convert(CWI_STORED_F16, CW_F32, &half, 2, 1, &value);
        if (isnan(value))
            assert_true(isnan(value) && (h & 0x7fff) > 0x7c00);
        else
            assert_int_equal(cwi_stored_half((double)value), h);
    }
    assert_int_equal(cwi_stored_half(1 + 0x1p-11), 0x3c00); /* ties go to the even one */
    assert_int_equal(cwi_stored_half(1 + 3 * 0x1p-11), 0x3c02);
    assert_int_equal(cwi_stored_half(65519.9), 0x7bff);
    assert_int_equal(cwi_stored_half(65520), 0x7c00);
}

static void every_format_gives_the_numbers(void **state)
{
    (void)state;
    for (size_t n = 0; n < FILES; n++) {
        const double *values = values_of(files[n].stored);
        cw_volume v;
        cw_error err = {0};
        put(n, values, 0);
        assert_ok(read_back(files[n].name, &v, &err), err);
        assert_int_equal(v.type, cwi_stored_type(files[n].stored));
        for (size_t i = 0; i < COUNT; i++)
            if (cw_volume_value(&v, i % 2, i / 2 % 3, i / 6) != values[i])
                fail_msg("%s: voxel %zu is %.17g", files[n].name, i,
                         cw_volume_value(&v, i % 2, i / 2 % 3, i / 6));
        cw_volume_free(&v);
        check_regions(files[n].name, NULL);
    }
}

/* Large ones make the type unsigned; those that no type holds are refused, with their value. */
static void integers_that_fit_no_type_are_refused(void **state)
{
    (void)state;
    double beyond[COUNT], mixed[COUNT];
    memcpy(beyond, large_integers, sizeof beyond);
    memcpy(mixed, large_integers, sizeof mixed);
    beyond[5] = 5e9;
    mixed[0] = -1;
    for (size_t n = 0; n < FILES; n++) {
        cw_volume v;
        cw_error err = {0};
        if (files[n].stored == CWI_STORED_F16)
            continue;
        put(n, large_integers, 0);
        assert_ok(read_back(files[n].name, &v, &err), err);
        assert_int_equal(v.type, CW_U32);
        assert_true(cw_volume_value(&v, 1, 2, 1) == 4294967295);
        cw_volume_free(&v);
        put(n, beyond, 0);
        assert_fails(read_back(files[n].name, &v, &err), CW_ERR_FORMAT,
                     files[n].stored == CWI_STORED_I64 ? "a number is 5000000000 (int64)"
                                                       : "a number is 5000000000 (uint64)",
                     err);
        if (files[n].stored == CWI_STORED_I64) {
            put(n, mixed, 0);
            assert_fails(read_back(files[n].name, &v, &err), CW_ERR_FORMAT,
                         "a number is -1 (int64)", err);
        }
    }
}

/* A note reports bytes behind the voxels. Files of MGH may hold others there. */
static void bytes_behind_the_voxels_are_told(void **state)
{
    (void)state;
    for (size_t n = 0; n < FILES; n++) {
        const char *ending = strchr(files[n].name, '.');
        const bool is_told = strcmp(ending, ".mgh") != 0 && strcmp(ending, ".vtk") != 0;
        char notes[NOTES] = "", words[80];
        const cw_read_desc desc = {.note = keep_note, .note_user = notes};
        const size_t size = COUNT * cwi_stored_size(files[n].stored, CW_F32);
        cw_volume v;
        cw_error err = {0};
        put(n, values_of(files[n].stored), size);
        assert_ok(cw_volume_read(test_path(files[n].name), &desc, &v, NULL, &err), err);
        cw_volume_free(&v);
        snprintf(words, sizeof words, "behind them %zu more are left over, which makes 2 times",
                 size);
        assert_true((strstr(notes, words) != NULL) == is_told);
        *notes = '\0';
        put(n, values_of(files[n].stored), 0);
        assert_ok(cw_volume_read(test_path(files[n].name), &desc, &v, NULL, &err), err);
        cw_volume_free(&v);
        assert_null(strstr(notes, "left over"));
    }
}

static void bytes_behind_compressed_voxels_are_told(void **state)
{
    (void)state;
    static const unsigned char counting[24] = {1, 2, 3};
    char notes[NOTES] = "";
    size_t size;
    const cw_read_desc desc = {.note = keep_note, .note_user = notes};
    const cw_raw_layout layout = {.dim = {2, 3, 3}};
    const cw_read_desc raw = {.note = keep_note, .note_user = notes, .raw = &layout};
    cw_volume v;
    cw_error err = {0};
    unsigned char *packed = pack_bytes(counting, sizeof counting, true, &size);
    put_file("a.nrrd", "NRRD0004\ntype: uint8\nencoding: gzip\ndimension: 3\nsizes: 2 3 2\n\n",
             packed, size);
    assert_ok(cw_volume_read(test_path("a.nrrd"), &desc, &v, NULL, &err), err);
    assert_non_null(strstr(notes,
                           "'sizes' and the type u8 ask for 12 bytes of voxels; behind them "
                           "12 more are left over, which makes 2 times"));
    cw_volume_free(&v);
    *notes = '\0';
    put_file("a.raw", "", counting, sizeof counting);
    assert_ok(cw_volume_read(test_path("a.raw"), &raw, &v, NULL, &err), err);
    assert_non_null(
        strstr(notes, "ask for 18 bytes of voxels; behind them 6 more are left over"));
    assert_null(strstr(notes, "times"));
    cw_volume_free(&v);
    free(packed);
}

static void layouts_name_types_in_many_ways(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        cw_type type;
        size_t stored_bytes;
        bool big;
    } cases[] = {{"uint8", CW_U8, 0, false},
                 {"UINT8", CW_U8, 0, false},
                 {"u1", CW_U8, 0, false},
                 {"|u1", CW_U8, 0, false},
                 {"unsigned char", CW_U8, 0, false},
                 {"i8", CW_I8, 0, false},
                 {"<i8", CW_I32, 8, false},
                 {">u8", CW_U32, 8, true},
                 {"int16", CW_I16, 0, false},
                 {"int16be", CW_I16, 0, true},
                 {"<i2", CW_I16, 0, false},
                 {">u2", CW_U16, 0, true},
                 {"ushort", CW_U16, 0, false},
                 {"float32", CW_F32, 0, false},
                 {"float", CW_F32, 0, false},
                 {">f4", CW_F32, 0, true},
                 {"double", CW_F64, 0, false},
                 {"doublebe", CW_F64, 0, true},
                 {"f8", CW_F64, 0, false},
                 {"half", CW_F32, 2, false},
                 {"float16le", CW_F32, 2, false},
                 {"int64", CW_I32, 8, false},
                 {"u64be", CW_U32, 8, true}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[80];
        cw_raw_layout l;
        cw_error err = {0};
        snprintf(text, sizeof text, "dims=2x3x2,type=%s", cases[i].name);
        assert_ok(cw_raw_layout_parse(text, &l, &err), err);
        if (l.type != cases[i].type || l.stored_bytes != cases[i].stored_bytes ||
            l.big_endian != cases[i].big)
            fail_msg("%s is %s, %zu bytes", cases[i].name, cw_type_name(l.type),
                     l.stored_bytes);
    }
    const cw_raw_layout wrong = {.dim = {1, 1, 1}, .type = CW_I16, .stored_bytes = 8};
    const cw_read_desc desc = {.raw = &wrong};
    cw_volume v;
    cw_error err = {0};
    put_file("a.raw", "", "12345678", 8);
    assert_fails(cw_volume_read(test_path("a.raw"), &desc, &v, NULL, &err), CW_ERR_ARGUMENT,
                 "'stored_bytes' is 8", err);
}

/* In the blocks and the text of VTK's XML files. */
static void xml_files_of_vtk_give_the_numbers(void **state)
{
    (void)state;
    static const char head[] =
        "<VTKFile type='ImageData' byte_order='LittleEndian' header_type='UInt32'>"
        "<ImageData WholeExtent='0 1 0 2 0 1' Origin='0 0 0' Spacing='1 1 1'>"
        "<Piece Extent='0 1 0 2 0 1'><PointData>";
    unsigned char bytes[200];
    char text[900];
    cw_volume v;
    cw_error err = {0};
    snprintf(text, sizeof text,
             "%s<DataArray type='Int64' Name='s' format='ascii'>-3 -2 -1 0 1 2 3 4 5 6 7 "
             "2147483647</DataArray></PointData></Piece></ImageData></VTKFile>\n",
             head);
    put_file("a.vti", text, NULL, 0);
    assert_ok(read_back("a.vti", &v, &err), err);
    assert_true(v.type == CW_I32 && cw_volume_value(&v, 1, 2, 1) == 2147483647);
    cw_volume_free(&v);
    snprintf(text, sizeof text,
             "%s<DataArray type='UInt64' Name='s' format='appended' offset='0'/></PointData>"
             "</Piece></ImageData><AppendedData encoding='raw'>_",
             head);
    const size_t start = strlen(text),
                 size = store_all(bytes, CWI_STORED_U64, large_integers, false);
    memcpy(text + start, (const uint32_t[]){(uint32_t)size}, 4);
    memcpy(text + start + 4, bytes, size);
    memcpy(text + start + 4 + size, "</AppendedData></VTKFile>", 25);
    put_file("a.vti", "", text, start + 4 + size + 25);
    assert_ok(read_back("a.vti", &v, &err), err);
    assert_true(v.type == CW_U32 && cw_volume_value(&v, 1, 2, 1) == 4294967295);
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(floats_of_16_bits_are_those_of_the_standard),
        cmocka_unit_test(every_format_gives_the_numbers),
        cmocka_unit_test(integers_that_fit_no_type_are_refused),
        cmocka_unit_test(bytes_behind_the_voxels_are_told),
        cmocka_unit_test(bytes_behind_compressed_voxels_are_told),
        cmocka_unit_test(layouts_name_types_in_many_ways),
        cmocka_unit_test(xml_files_of_vtk_give_the_numbers),
    };
    return cmocka_run_group_tests(tests, test_folder_make, test_folder_remove);
}
