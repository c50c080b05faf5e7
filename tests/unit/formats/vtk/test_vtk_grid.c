/* Legacy VTK files of rectilinear grids; values of cells, and arrays chosen by name. */
#include "support/files/reading.h"
#include "support/files/regions.h"

#include <stdio.h>

#define HEAD(form) "# vtk DataFile Version 3.0\na title\n" form "\n"
#define GRID       "DATASET RECTILINEAR_GRID\nDIMENSIONS 3 2 2\n"
#define EVEN       "DATASET STRUCTURED_POINTS\nDIMENSIONS 3 2 2\nSPACING 2 4 6\nORIGIN 1 1 1\n"
#define ALONG_X    "X_COORDINATES 3 float\n1 2 4\n"
#define ALONG_Y    "Y_COORDINATES 2 double\n7 6.5\n"
#define ALONG_Z    "Z_COORDINATES 2 int\n0\n3\n"
#define ALONG      ALONG_X ALONG_Y ALONG_Z
#define POINTS                                                                                 \
    "POINT_DATA 12\nSCALARS p short\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 7 8 9 10 11\n"
#define CELLS                                                                                  \
    "CELL_DATA 2\nFIELD f 2\na%20cell 1 2 float\n5 7\nother%2 1 2 char\n3 4\n"                 \
    "SCALARS d unsigned_char\nLOOKUP_TABLE default\n8 9\n"

static void put(const char *text)
{
    put_file("a.vtk", text, NULL, 0);
}

static cw_status read_array(const char *name, cw_volume *v, cw_error *err)
{
    return cw_volume_read(test_path("a.vtk"), &(cw_read_desc){.array = name}, v, NULL, err);
}

/* Numbers along y fall: they are taken from the other end. */
static void check_points(void)
{
    cw_volume v;
    cw_error err = {0};
    assert_ok(read_back("a.vtk", &v, &err), err);
    assert_int_equal(v.dim[0], 3);
    assert_place(&v, 0, 0, 0, 1, 7, 0);
    assert_place(&v, 1, 1, 1, 2, 6.5, 3);
    assert_place(&v, 2, 0, 0.5, 4, 7, 1.5);
    assert_true(cw_volume_value(&v, 2, 1, 1) == 11);
    cw_volume_free(&v);
    check_regions("a.vtk", NULL);
}

static void points_stand_at_their_coordinates(void **state)
{
    (void)state;
    put(HEAD("ASCII") GRID ALONG POINTS);
    check_points();
    check_starved("a.vtk", NULL);
    put(HEAD("ASCII") GRID ALONG CELLS POINTS);
    check_points();
    put(HEAD("ASCII") "DATASET RECTILINEAR_GRID\n" ALONG_Z ALONG_Y
                      "DIMENSIONS 3 2 2\n" ALONG_X POINTS);
    check_points();
}

static void binary_numbers_are_big_endian(void **state)
{
    (void)state;
    static const char text[] =
        HEAD("BINARY") GRID "X_COORDINATES 3 float\n\x3f\x80\0\0\x40\0\0\0\x40\x80\0\0\n"
                            "Y_COORDINATES 2 double\n\x40\x1c\0\0\0\0\0\0\x40\x1a\0\0\0\0\0\0\n"
                            "Z_COORDINATES 2 short\n\0\0\0\3\n"
                            "POINT_DATA 12\nSCALARS p unsigned_char\nLOOKUP_TABLE default\n"
                            "\0\1\2\3\4\5\6\7\x8\x9\xa\xb";
    put_file("a.vtk", "", text, sizeof text - 1);
    check_points();
    check_every_cut("a.vtk");
}

static void keep_note(void *user, const char *text)
{
    strncat(user, text, 999 - strlen(user));
}

static void cells_are_samples_in_their_middles(void **state)
{
    (void)state;
    for (int even = 0; even < 2; even++) {
        char note[1000] = "";
        const cw_read_desc desc = {.note = keep_note, .note_user = note};
        cw_volume v;
        cw_error err = {0};
        put(even ? HEAD("ASCII") EVEN CELLS : HEAD("ASCII") GRID ALONG CELLS);
        assert_ok(cw_volume_read(test_path("a.vtk"), &desc, &v, NULL, &err), err);
        assert_int_equal(v.dim[0], 2);
        assert_int_equal(v.dim[2], 1);
        assert_true(cw_volume_value(&v, 1, 0, 0) == 9);
        assert_place(&v, 0, 0, 0, even ? 2 : 1.5, even ? 3 : 6.75, even ? 4 : 1.5);
        assert_place(&v, 1, 0, 0, even ? 4 : 3, even ? 3 : 6.75, even ? 4 : 1.5);
        assert_non_null(strstr(note, "'d' has a value for each cell"));
        cw_volume_free(&v);
    }
}

/* Those of points go first; blanks are written as %20, and what is no such thing stays. */
static void arrays_go_by_name(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double first;
        size_t along_x;
    } cases[] = {{"p", 0, 3}, {"a cell", 5, 2}, {"other%2", 3, 2},
                 {"d", 8, 2}, {"v", 20, 3},     {"in field", 40, 3}};
    cw_volume v, one;
    cw_error err = {0};
    put(HEAD("ASCII") GRID ALONG CELLS POINTS
        "VECTORS v float\n20 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 "
        "1 1\nFIELD f 2\nin%20field 1 12 int\n40 1 2 3 4 5 6 7 8 9 10 11\n"
        "d 1 2 int\n1 1\n");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_ok(read_array(cases[i].name, &v, &err), err);
        assert_int_equal(v.dim[0], cases[i].along_x);
        assert_ok(cw_volume_select(&v, 0, 0, &one, &err), err);
        assert_true(cw_volume_value(&one, 0, 0, 0) == cases[i].first);
        cw_volume_free(&v);
    }
    assert_fails(read_array("q", &v, &err), CW_ERR_ARGUMENT,
                 "a.vtk: there is no array 'q' that is read; there are 'a cell' (float), "
                 "'other%2' (char), 'd' (unsigned_char), 'p' (short), 'v' (float)",
                 err);
}

static void damaged_files_are_told_where(void **state)
{
    (void)state;
    static const struct {
        const char *text, *words;
    } cases[] = {
        {HEAD("ASCII") GRID ALONG_X ALONG_Y POINTS,
         "'Z_COORDINATES' lists 0 numbers; 'DIMENSIONS' says 2"},
        {HEAD("ASCII") GRID "X_COORDINATES 2 float\n1 2\n" ALONG_Y ALONG_Z POINTS,
         "'X_COORDINATES' lists 2 numbers; 'DIMENSIONS' says 3"},
        {HEAD("ASCII") GRID "X_COORDINATES 3 float\n1 4 2\n" ALONG_Y ALONG_Z POINTS,
         "Coordinates along x: number 2, 2, follows 4; all must rise, or all fall"},
        {HEAD("ASCII") GRID "X_COORDINATES 3 float\n1 nan 2\n" ALONG_Y ALONG_Z POINTS,
         "Coordinates along x"},
        {HEAD("ASCII") GRID "X_COORDINATES 3 float\n1 two 2\n" ALONG_Y ALONG_Z POINTS,
         "number 2 of the coordinates is 'two'"},
        {HEAD("ASCII") GRID "X_COORDINATES 3\n", "'X_COORDINATES 3', is cut short"},
        {HEAD("ASCII") GRID "Y_COORDINATES many float\n", "'Y_COORDINATES' is 'many'"},
        {HEAD("ASCII") GRID "Y_COORDINATES 3 long\n",
         "'Y_COORDINATES' is of type 'long'; numbers of up to 32 bits"},
        {HEAD("ASCII") GRID "Y_COORDINATES 3 float\n1 2",
         "the array 'Y_COORDINATES' has 3 numbers; the file ends after 2"},
        {HEAD("BINARY") GRID "Z_COORDINATES 2000000000 double\n1234",
         "the array 'Z_COORDINATES' has 2000000000 numbers of 64 bits; the file holds 4 bytes"},
        {HEAD("ASCII") GRID "SPACING 1 1 1\n", "starts nothing that is known"},
        {HEAD("ASCII") GRID ALONG, "'POINT_DATA' is missing, and 'CELL_DATA' too"},
        {HEAD("ASCII") GRID ALONG "POINT_DATA 11\n", "'POINT_DATA' is 11; 'DIMENSIONS' asks"},
        {HEAD("ASCII") GRID ALONG "CELL_DATA 12\n", "'CELL_DATA' is 12; 'DIMENSIONS' asks for"},
        {HEAD("ASCII") "DATASET RECTILINEAR_GRID\nDIMENSIONS 1 2 2\nX_COORDINATES 1 "
                       "float\n1\n" ALONG_Y ALONG_Z "CELL_DATA 1\nSCALARS d int\n4\n",
         "'DIMENSIONS' has one plane of points along x"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        put(cases[i].text);
        check_told("a.vtk", i, cases[i].words);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_stand_at_their_coordinates),
        cmocka_unit_test(binary_numbers_are_big_endian),
        cmocka_unit_test(cells_are_samples_in_their_middles),
        cmocka_unit_test(arrays_go_by_name),
        cmocka_unit_test(damaged_files_are_told_where),
    };
    return cmocka_run_group_tests(tests, test_folder_make, test_folder_remove);
}
