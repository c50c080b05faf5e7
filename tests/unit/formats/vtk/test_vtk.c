/* Tests the reader of legacy VTK: types, arrays, old and new words, and damaged files. */
#include "support/files/reading.h"
#include "support/files/regions.h"

#include <stdio.h>

static const uint8_t counting[12] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};

#define HEAD(form) "# vtk DataFile Version 3.0\na title\n" form "\n"
#define GRID       "DATASET STRUCTURED_POINTS\nDIMENSIONS 2 3 2\n"
#define U8         HEAD("BINARY") GRID "POINT_DATA 12\nSCALARS s unsigned_char\n"
#define TABLE      "LOOKUP_TABLE default\n"

static void a_plain_file_gives_its_voxels(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    const char *format = NULL;
    put_file("a.bin", U8 TABLE, counting, sizeof counting);
    assert_ok(cw_volume_read(test_path("a.bin"), NULL, &v, &format, &err), err);
    assert_string_equal(format, "vtk");
    assert_int_equal(v.known, 0);
    assert_int_equal(v.type, CW_U8);
    assert_int_equal(v.dim[1], 3);
    assert_memory_equal(v.data, counting, sizeof counting);
    check_affine(&v, (const double[12]){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0});
    cw_volume_free(&v);
}

static void the_grid_may_be_told_in_old_and_new_words(void **state)
{
    (void)state;
    static const char *const heads[] = {
        HEAD("BINARY") "DATASET STRUCTURED_POINTS\nDIMENSIONS 2 3 2\nSPACING 1 2 3\n"
                       "ORIGIN 5 6 7\n",
        "# vtk DataFile Version 1.0\n\n\nBINARY\n\nDATASET STRUCTURED_POINTS\n\nDIMENSIONS 2 3 "
        "2\n"
        "ASPECT_RATIO 1.0 2.0 3.0\nORIGIN 5.0 6.0 7.0\n",
        "# vtk DataFile Version 5.1\r\nvtk output\r\nbinary\r\ndataset structured_points\r\n"
        "FIELD FieldData 1\r\nTIME 1 1 double\r\n12345678\r\nMETADATA\r\nINFORMATION 0\r\n\r\n"
        "dimensions 2 3 2\r\nspacing 1 2 3\r\norigin 5 6 7\r\n",
    };
    for (size_t i = 0; i < sizeof heads / sizeof *heads; i++) {
        char header[500];
        cw_volume v;
        cw_error err = {0};
        snprintf(header, sizeof header, "%sPOINT_DATA 12\nSCALARS s unsigned_char 1\n" TABLE,
                 heads[i]);
        put_file("a.vtk", header, counting, sizeof counting);
        assert_ok(read_back("a.vtk", &v, &err), err);
        check_affine(&v, (const double[12]){1, 0, 0, 5, 0, 2, 0, 6, 0, 0, 3, 7});
        assert_memory_equal(v.data, counting, sizeof counting);
        check_regions("a.vtk", NULL);
        cw_volume_free(&v);
    }
}

static void every_type_is_big_endian_or_text(void **state)
{
    (void)state;
    const struct {
        const char *name;
        cw_type type;
        const char *bytes;
        double value;
        const char *text;
    } cases[] = {
        {"unsigned_char", CW_U8, "\xfe", 254, "254"},
        {"char", CW_I8, "\xfe", -2, "-2"},
        {"unsigned_short", CW_U16, "\xff\xfe", 65534, "65534"},
        {"short", CW_I16, "\xff\xfe", -2, "-2"},
        {"unsigned_int", CW_U32, "\xff\xff\xff\xfe", 4294967294.0, "4294967294"},
        {"int", CW_I32, "\xff\xff\xff\xfe", -2, "-2"},
        {"vtkIdType", CW_I32, "\0\0\1\0", 256, "256"},
        {"float", CW_F32, "\x3f\xc0\0\0", 1.5, "1.5"},
        {"double", CW_F64, "\x3f\xf8\0\0\0\0\0\0", 1.5, "1.5e0"},
    };
    for (size_t i = 0; i < 2 * sizeof cases / sizeof *cases; i++) {
        const bool text = i % 2;
        char header[300];
        cw_volume v;
        cw_error err = {0};
        snprintf(header, sizeof header,
                 HEAD("%s") "DATASET STRUCTURED_POINTS\nDIMENSIONS 1 1 1\nPOINT_DATA 1\n"
                            "SCALARS s %s 1\n" TABLE "%s",
                 text ? "ASCII" : "BINARY", cases[i / 2].name, text ? cases[i / 2].text : "");
        put_file("a.vtk", header, cases[i / 2].bytes,
                 text ? 0 : cw_type_size(cases[i / 2].type));
        assert_ok(read_back("a.vtk", &v, &err), err);
        assert_int_equal(v.type, cases[i / 2].type);
        assert_true(cw_volume_value(&v, 0, 0, 0) == cases[i / 2].value);
        cw_volume_free(&v);
    }
}

#define TEN "1 2 3 4 5 6 7 8 9 0 "

/* The arrays in front must be passed over to the byte; in text, to the number. */
static void scalars_go_before_other_arrays(void **state)
{
    (void)state;
    const struct {
        const char *text;
        size_t components;
        double first;
    } cases[] = {
        {"SCALARS s unsigned_char\n0 1 2 3", 1, 0},
        {"VECTORS v float\n9 9 9 9 9 9\n9 9 9 9 9 9\nSCALARS s int 1\n" TABLE "5 6 7 8", 1, 5},
        {"SCALARS s int 2\n" TABLE "0 1 2 3 4 5 6 7", 2, 0},
        {"VECTORS v float\n3 1 2 3 4 5 6 7 8 9 10 11", 3, 3},
        {"TENSORS t float\n1 2 3 4 5 6 7 8 9 1 2 3 4 5 6 7 8 9 1 2 3 4 5 6 7 8 9 1 2 3 4 5 6 7 "
         "8 9\n"
         "NORMALS n float\n7 0 0 0 0 0 0 0 0 0 0 0\n",
         9, 1},
        {"COLOR_SCALARS c 3\n.5 0 0 1 1 1 0 0 0 1 1 1", 3, 0.5},
        {"TEXTURE_COORDINATES t 2 float\n8 0 1 0 0 1 1 1", 2, 8},
        {"LOOKUP_TABLE mine 1\n0 0 0 1\nSCALARS s int\nLOOKUP_TABLE mine\n4 3 2 1", 1, 4},
        {"FIELD f 3\nfew 1 3 int\n1 2 3\nMETADATA\nINFORMATION 0\n\nvec 2 4 int\n1 2 3 4 5 6 7 "
         "8\n"
         "one 1 4 float\n2.5 0 0 0",
         1, 2.5},
        {"FIELD f 2\nmany 17 4 int\n" TEN TEN TEN TEN TEN TEN "1 2 3 4 5 6 7 8\n"
         "some 16 4 int\n3 " TEN TEN TEN TEN TEN TEN "1 2 3\n",
         16, 3},
        {"SCALARS l long\n" TABLE "1 2 3 4\nFIELD f 1\none 1 4 short\n-7 0 0 0", 1, 1},
        {"FIELD f 2\nl 1 4 long\n1 2 3 4\none 1 4 short\n-7 0 0 0", 1, -7},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[600];
        cw_volume v;
        cw_error err = {0};
        snprintf(text, sizeof text,
                 HEAD("ASCII") "DATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 1\n"
                               "CELL_DATA 1\nSCALARS cells float 1\n" TABLE "99\n"
                               "POINT_DATA 4\n%s",
                 cases[i].text);
        put_file("a.vtk", text, NULL, 0);
        assert_ok(read_back("a.vtk", &v, &err), err);
        assert_int_equal(v.components, cases[i].components);
        cw_volume one;
        assert_ok(cw_volume_select(&v, 0, 0, &one, &err), err);
        assert_true(cw_volume_value(&one, 0, 0, 0) == cases[i].first);
        cw_volume_free(&v);
    }
}

static void binary_arrays_are_passed_over_by_their_size(void **state)
{
    (void)state;
    static const char text[] = HEAD("BINARY") GRID
        "CELL_DATA 2\nSCALARS b bit\n" TABLE "\1\nPOINT_DATA 12\nFIELD f 1\nx 1 12 "
        "unsigned_short\n\nSCALARS \nPOINT_DATA 1\n7\n\nCOLOR_SCALARS c 1\nabcdefghijkl\n"
        "SCALARS s unsigned_char\n" TABLE;
    cw_volume v;
    cw_error err = {0};
    put_file("a.vtk", text, counting, sizeof counting);
    assert_ok(read_back("a.vtk", &v, &err), err);
    assert_memory_equal(v.data, counting, sizeof counting);
    cw_volume_free(&v);
}

static void damaged_files_are_told_where(void **state)
{
    (void)state;
    const struct {
        const char *text, *words;
    } cases[] = {
        {"# vtk DataFile Version 9.0\n", "the version is '9.0'"},
        {"hello\n", "the first line is not"},
        {HEAD("HEX"), "line 3 is 'HEX'; it must be ASCII or BINARY"},
        {HEAD("ASCII"), "'DATASET' is missing"},
        {HEAD("ASCII") "DATASET FIELD\n", "'DATASET FIELD'; only"},
        {HEAD("ASCII") "DATASET POLYDATA\n", "this is a mesh (vtk)"},
        {HEAD("ASCII") GRID, "'POINT_DATA' is missing"},
        {HEAD("ASCII") GRID "CELL_DATA 12\n", "'CELL_DATA' is 12; 'DIMENSIONS' asks for 2"},
        {HEAD("ASCII") GRID "X_COORDINATES 2 float\n1 2\n", "starts nothing that is known"},
        {HEAD("ASCII") "DATASET STRUCTURED_POINTS\nPOINT_DATA 12\n", "'DIMENSIONS' is missing"},
        {HEAD("ASCII") "DATASET STRUCTURED_POINTS\nDIMENSIONS 2 3\n",
         "'DIMENSIONS' lists 2 numbers"},
        {HEAD("ASCII") "DATASET STRUCTURED_POINTS\nDIMENSIONS 2 0 3\n", "'DIMENSIONS' holds 0"},
        {HEAD("ASCII") GRID "POINT_DATA 13\n", "'POINT_DATA' is 13; 'DIMENSIONS' asks for 12"},
        {HEAD("ASCII") GRID "POINT_DATA many\n", "'POINT_DATA' is 'many'"},
        {HEAD("ASCII") GRID "SPACING 1 0 1\nPOINT_DATA 12\nSCALARS s int\n1 2",
         "gives axis 1 no length"},
        {HEAD("ASCII") GRID "ORIGIN 1 nan 1\nPOINT_DATA 12\nSCALARS s int\n1 2", "not finite"},
        {HEAD("ASCII") GRID "POINT_DATA 12\nSCALARS s\n", "'SCALARS s', is cut short"},
        {HEAD("ASCII") GRID "POINT_DATA 12\nSCALARS s quad\n", "of type 'quad'"},
        {HEAD("ASCII") GRID "POINT_DATA 12\nSCALARS s int 17\n" TABLE "1",
         "the array 's' has 204 numbers"},
        {HEAD("ASCII") GRID "POINT_DATA 12\nSPLATS s int\n", "'SPLATS s int', starts nothing"},
        {HEAD("ASCII") GRID "POINT_DATA 12\nSCALARS s bit\n" TABLE "1 0 1 1 0 1 1 0 1 1 0 1",
         "no array that is read; there are 's' (bit)"},
        {HEAD("ASCII") GRID "POINT_DATA 12\nVECTORS v float\n1 2 3\n",
         "the array 'v' has 36 numbers; the file ends after 3"},
        {HEAD("BINARY") GRID "POINT_DATA 12\nVECTORS v float\n1 2 3\n",
         "the array 'v' has 36 numbers of 32 bits; the file holds 6 bytes"},
        {HEAD("ASCII") GRID "POINT_DATA 12\nFIELD f 9223372036854775807\n", "'FIELD' is '922"},
        {HEAD("ASCII") GRID "POINT_DATA 12\nFIELD f 2\na 1 1 int\n1\n",
         "1 arrays of 'f' are to"},
        {HEAD("ASCII") GRID "POINT_DATA 12\nFIELD f 1\na 65536 9223372036854775807 int\n",
         "larger than an address space"},
        {HEAD("BINARY") GRID "POINT_DATA 12\nFIELD f 1\na 1 9223372036854775807 int\n",
         "the file holds 0 bytes"},
        {HEAD("ASCII") GRID "POINT_DATA 12\nFIELD f 1\na 1 x int\n", "'a' is 'x'"},
        {HEAD("ASCII") GRID "POINT_DATA 12\nSCALARS s int\n1 2 3                      ",
         "the voxels end after 3"},
        {HEAD("ASCII") GRID "POINT_DATA 12\nSCALARS s char\n1 2 300 4 5 6 7 8 9 1 2 3",
         "number 3 of the voxels is '300'"},
        {U8 TABLE "short", "'DIMENSIONS' asks for 12 bytes of voxels; the file holds 5"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        put_file("a.vtk", cases[i].text, NULL, 0);
        check_told("a.vtk", i, cases[i].words);
    }
    put_file("a.vtk", HEAD("BINARY"), counting, sizeof counting);
    check_told("a.vtk", 100, "line 4 holds a zero byte");
    char *large = malloc(20000);
    memset(large, 'x', 20000);
    put_file("a.vtk", HEAD("BINARY"), large, 20000);
    check_told("a.vtk", 101, "line 4 is longer than 1023 bytes");
    memset(large, '\n', 20000);
    put_file("a.vtk", HEAD("BINARY"), large, 20000);
    check_told("a.vtk", 102, "more than 10000 lines");
    free(large);
}

/* All that are there, also behind the one that is read; what is damaged there does no harm. */
static void arrays_are_listed(void **state)
{
    (void)state;
    static const char text[] =
        HEAD("ASCII") GRID "POINT_DATA 12\nSCALARS s int\n" TABLE "0 1 2 3 4 5 6 7 8 9 10 11\n"
                           "VECTORS w float\n0 0 0 1 1 1 2 2 2 3 3 3 4 4 4 5 5 5 6 6 6 7 7 7 "
                           "8 8 8 9 9 9 0 0 0 1 1 1\n"
                           "CELL_DATA 2\nFIELD f 2\nc 1 2 long\n1 2\nd 1 2 ";
    cw_array *a;
    size_t count;
    cw_error err = {0};
    for (int damaged = 0; damaged < 2; damaged++) {
        put_file("a.vtk", text, damaged ? "what\n" : "short\n5 6\n", damaged ? 5 : 10);
        assert_ok(cw_arrays_list(test_path("a.vtk"), NULL, &a, &count, &err), err);
        assert_int_equal(count, damaged ? 3 : 4);
        assert_string_equal(a[0].name, "s");
        assert_true(a[0].is_default && a[0].is_read && !a[0].of_cells);
        assert_string_equal(a[1].name, "w");
        assert_int_equal(a[1].components, 3);
        assert_string_equal(a[1].type, "float");
        assert_true(a[2].of_cells && a[2].is_read && !a[2].is_default);
        cw_arrays_free(a);
    }
    put_file("a.nrrd", "NRRD0004\ntype: uint8\nencoding: raw\ndimension: 3\nsizes: 2 3 2\n\n",
             counting, sizeof counting);
    assert_ok(cw_arrays_list(test_path("a.nrrd"), NULL, &a, &count, &err), err);
    assert_true(!a && count == 0);
}

/* No more is claimed than the file holds before memory is taken. */
static void sizes_are_checked_before_memory_is_taken(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    put_file("a.vtk",
             HEAD("BINARY") "DATASET STRUCTURED_POINTS\nDIMENSIONS 2000000000 2000000000 2\n"
                            "POINT_DATA 8000000000000000000\nSCALARS s unsigned_char\n" TABLE,
             counting, sizeof counting);
    cwi_alloc_fail_after(0);
    const cw_status st = read_back("a.vtk", &v, &err);
    assert_false(cwi_alloc_fail_after(-1));
    assert_fails(st, CW_ERR_FORMAT, "'DIMENSIONS' asks for 8000000000000000000 bytes", err);
    put_file("a.vtk",
             HEAD("ASCII") "DATASET STRUCTURED_POINTS\nDIMENSIONS 2000000000 2000000000 9\n"
                           "POINT_DATA 1\nSCALARS s int\n1",
             NULL, 0);
    check_told("a.vtk", 0, "'DIMENSIONS' asks for more voxels than an address space holds");
}

static void a_cut_is_never_a_volume(void **state)
{
    (void)state;
    put_file("a.vtk", U8 TABLE, counting, sizeof counting);
    check_every_cut("a.vtk");
    put_file("a.vtk",
             HEAD("ASCII") GRID "POINT_DATA 12\nSCALARS s int\n" TABLE
                                "10 11 12 13 14 15\n16 17 18 19 20 1",
             NULL, 0);
    check_every_cut("a.vtk");
    put_file("a.vtk",
             HEAD("BINARY") GRID "POINT_DATA 12\nFIELD f 2\na 3 1 unsigned_char\nabc\n"
                                 "b 1 12 unsigned_char\n",
             counting, sizeof counting);
    check_every_cut("a.vtk");
}

static void memory_may_run_out_anywhere(void **state)
{
    (void)state;
    put_file("a.vtk", U8 TABLE, counting, sizeof counting);
    check_starved_reads("a.vtk");
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(a_plain_file_gives_its_voxels),
        TEST(the_grid_may_be_told_in_old_and_new_words),
        TEST(every_type_is_big_endian_or_text),
        TEST(scalars_go_before_other_arrays),
        TEST(binary_arrays_are_passed_over_by_their_size),
        TEST(arrays_are_listed),
        TEST(damaged_files_are_told_where),
        TEST(sizes_are_checked_before_memory_is_taken),
        TEST(a_cut_is_never_a_volume),
        TEST(memory_may_run_out_anywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
