/* Legacy VTK files of unstructured and curvilinear grids. */
#include "support/grids.h"

#include <stdio.h>

#define HEAD(version, form) "# vtk DataFile Version " version "\na title\n" form "\n"
#define UNSTRUCTURED        "DATASET UNSTRUCTURED_GRID\n"
#define PLACES                                                                                 \
    "POINTS 6 double\n0 0 0  1 0 0  0 1 0\n0 0 1  1 0 1  0 1 1\n"                              \
    "METADATA\nINFORMATION 0\n\n"
#define LISTED "CELLS 3 16\n6 0 1 2 3 4 5\n4 0 1 2 3\n3 0 1 2\nCELL_TYPES 3\n13\n10\n5\n"
#define SPLIT                                                                                  \
    "CELLS 4 13\nOFFSETS vtktypeint64\n0 6 10 13\nCONNECTIVITY vtktypeint64\n"                 \
    "0 1 2 3 4 5 0 1 2 3 0 1 2\nCELL_TYPES 3\n13\n10\n5\n"
#define VALUES "POINT_DATA 6\nSCALARS f short\nLOOKUP_TABLE default\n-3 1 2 3 4 5\n"
#define CELLS                                                                                  \
    "CELL_DATA 3\nFIELD g 2\nvtkGhostType 1 3 unsigned_char\n0 0 0\nc 1 3 float\n2 4 6\n"

static void put(const char *text)
{
    put_file("a.vtk", text, NULL, 0);
}

/* --- text and bytes ---------------------------------------------------------------------- */

static void check_file(void)
{
    static char notes[NOTES];
    cw_volume v;
    cw_error err = {0};
    assert_ok(read_noted("a.vtk", NULL, notes, &v, &err), err);
    check_grid(&v);
    assert_int_equal(v.type, CW_I16);
    assert_int_equal(v.dim[0], 6);
    assert_int_equal(v.cells->count, 2);
    assert_cell(&v, 0, CW_WEDGE, 0, (const uint32_t[]){0, 1, 2, 3, 4, 5});
    assert_cell(&v, 1, CW_TETRAHEDRON, 6, (const uint32_t[]){0, 1, 2, 3});
    assert_point(&v, 4, 1, 0, 1);
    assert_value(&v, 0, -3);
    assert_non_null(
        strstr(notes, "left out, as they have fewer than three dimensions: 1 of 3 cells\n"));
    cw_volume_free(&v);
}

static void text_of_every_version_gives_the_grid(void **state)
{
    (void)state;
    put(HEAD("3.0", "ASCII") UNSTRUCTURED PLACES LISTED CELLS VALUES);
    check_file();
    check_starved("a.vtk", NULL);
    put(HEAD("5.1", "ASCII") UNSTRUCTURED PLACES SPLIT VALUES);
    check_file();
    check_starved("a.vtk", NULL);
}

/* Numbers of a binary file, high byte first. */
typedef struct file {
    unsigned char at[2000];
    size_t size;
} file;

static void add_text(file *f, const char *text)
{
    memcpy(f->at + f->size, text, strlen(text));
    f->size += strlen(text);
}

static void add_numbers(file *f, size_t bytes, size_t count, const int *numbers)
{
    for (size_t n = 0; n < count; n++)
        for (size_t i = bytes; i-- > 0;)
            f->at[f->size++] = (unsigned char)((int64_t)numbers[n] >> (8 * i));
    add_text(f, "\n");
}

static void make_binary(int version, file *f)
{
    static const int one = 0x3f800000; /* 1 as a float */
    const int coordinates[18] = {0, 0, 0,   one, 0, 0,   0, one, 0,
                                 0, 0, one, one, 0, one, 0, one, one};
    f->size = 0;
    add_text(f, version < 5 ? HEAD("4.2", "BINARY") : HEAD("5.1", "BINARY"));
    add_text(f, UNSTRUCTURED "POINTS 6 float\n");
    add_numbers(f, 4, 18, coordinates);
    if (version < 5) {
        add_text(f, "CELLS 3 16\n");
        add_numbers(f, 4, 16, (const int[]){6, 0, 1, 2, 3, 4, 5, 4, 0, 1, 2, 3, 3, 0, 1, 2});
    } else {
        add_text(f, "CELLS 4 13\nOFFSETS vtktypeint64\n");
        add_numbers(f, 8, 4, (const int[]){0, 6, 10, 13});
        add_text(f, "CONNECTIVITY vtktypeint64\n");
        add_numbers(f, 8, 13, (const int[]){0, 1, 2, 3, 4, 5, 0, 1, 2, 3, 0, 1, 2});
    }
    add_text(f, "CELL_TYPES 3\n");
    add_numbers(f, 4, 3, (const int[]){13, 10, 5});
    add_text(f, "POINT_DATA 6\nSCALARS f short\nLOOKUP_TABLE default\n");
    add_numbers(f, 2, 6, (const int[]){-3, 1, 2, 3, 4, 5});
    f->size--; /* the last line's end need not be there */
}

static void bytes_of_every_version_give_the_grid(void **state)
{
    (void)state;
    file f;
    for (int version = 4; version <= 5; version++) {
        make_binary(version, &f);
        put_file("a.vtk", "", f.at, f.size);
        check_file();
        check_every_cut("a.vtk");
    }
}

static void no_byte_is_trusted(void **state)
{
    (void)state;
    file f;
    for (int version = 4; version <= 5; version++) {
        make_binary(version, &f);
        for (size_t i = 0; i < f.size; i++)
            for (int flip = 1; flip < 256; flip *= 2) {
                cw_volume v;
                cw_error err = {0};
                f.at[i] ^= (unsigned char)flip;
                put_file("a.vtk", "", f.at, f.size);
                if (read_back("a.vtk", &v, &err) == CW_OK && v.cells)
                    check_grid(&v);
                cw_volume_free(&v);
                f.at[i] ^= (unsigned char)flip;
            }
    }
}

/* --- values, curvilinear grids ----------------------------------------------------------- */

static void values_of_cells_are_averaged(void **state)
{
    (void)state;
    static char notes[NOTES];
    cw_volume v;
    cw_error err = {0};
    put(HEAD("3.0", "ASCII") UNSTRUCTURED PLACES LISTED CELLS);
    assert_ok(read_noted("a.vtk", NULL, notes, &v, &err), err);
    check_grid(&v);
    assert_int_equal(v.type, CW_F64);
    const double wanted[6] = {3, 3, 3, 3, 2, 2};
    for (size_t n = 0; n < 6; n++)
        assert_value(&v, n, wanted[n]);
    assert_non_null(strstr(notes, "'c' has a value for each cell: samples are the mean"));
    cw_volume_free(&v);
    put(HEAD("3.0", "ASCII") UNSTRUCTURED PLACES LISTED CELLS VALUES
        "VECTORS v float\n1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 9\n");
    assert_ok(read_noted("a.vtk", "c", notes, &v, &err), err);
    assert_value(&v, 0, 3);
    cw_volume_free(&v);
    assert_ok(read_noted("a.vtk", "v", notes, &v, &err), err);
    assert_int_equal(v.components, 3);
    cw_volume_free(&v);
    assert_fails(read_noted("a.vtk", "q", notes, &v, &err), CW_ERR_ARGUMENT,
                 "there is no array 'q' that is read; there are 'vtkGhostType'", err);
}

static void curvilinear_grids_have_hexahedra(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    put(HEAD("3.0", "ASCII") "DATASET STRUCTURED_GRID\nDIMENSIONS 3 2 2\nPOINTS 12 float\n"
                             "0 0 0 1 0 0 2 0 1  0 1 0 1 1 0 2 1 1  0 0 1 1 0 1 2 0 2  "
                             "0 1 1 1 1 1 2 1 2\nPOINT_DATA 12\nSCALARS f float\n"
                             "0 1 2 3 4 5 6 7 8 9 10 11\n");
    assert_ok(read_back("a.vtk", &v, &err), err);
    check_grid(&v);
    assert_int_equal(v.cells->count, 2);
    assert_cell(&v, 1, CW_HEXAHEDRON, 8, (const uint32_t[]){1, 2, 5, 4, 7, 8, 11, 10});
    assert_point(&v, 11, 2, 1, 2);
    cw_volume_free(&v);
    const cw_read_desc desc = {.header_only = true};
    assert_ok(cw_volume_read(test_path("a.vtk"), &desc, &v, NULL, &err), err);
    assert_int_equal(v.cells->count, 2);
    assert_null(v.cells->points);
    cw_volume_free(&v);
}

/* Cells' marks stand in front of points' values as VTK writes them, points' behind. */
static void marked_cells_are_left_out(void **state)
{
    (void)state;
    static char notes[NOTES];
    cw_volume v;
    cw_error err = {0};
    for (int of_points = 0; of_points < 2; of_points++) {
        char text[1000];
        snprintf(text, sizeof text,
                 HEAD("3.0", "ASCII") "DATASET STRUCTURED_GRID\nDIMENSIONS 3 2 2\n"
                                      "POINTS 12 float\n"
                                      "0 0 0 1 0 0 2 0 1  0 1 0 1 1 0 2 1 1  0 0 1 1 0 1 2 0 2 "
                                      "0 1 1 1 1 1 2 1 2\n%sPOINT_DATA 12\nSCALARS f float\n"
                                      "0 1 2 3 4 5 6 7 8 9 10 11\n%s",
                 of_points ? ""
                           : "CELL_DATA 2\nFIELD g 1\nvtkGhostType 1 2 unsigned_char\n32 0\n",
                 of_points ? "FIELD g 1\nvtkGhostType 1 12 unsigned_char\n"
                             "2 0 0 0 0 0 0 0 0 0 0 0\n"
                           : "");
        put(text);
        assert_ok(read_noted("a.vtk", NULL, notes, &v, &err), err);
        check_grid(&v);
        assert_int_equal(v.cells->count, 1);
        assert_cell(&v, 0, CW_HEXAHEDRON, 0, (const uint32_t[]){1, 2, 5, 4, 7, 8, 11, 10});
        assert_non_null(strstr(notes, "another piece's: 1 of 2 cells"));
        cw_volume_free(&v);
    }
}

#define START HEAD("3.0", "ASCII") UNSTRUCTURED PLACES
#define NEW   HEAD("5.1", "ASCII") UNSTRUCTURED PLACES

static void damaged_files_are_told_where(void **state)
{
    (void)state;
    static const struct {
        const char *text, *words;
    } cases[] = {
        {HEAD("3.0", "ASCII") UNSTRUCTURED VALUES, "'POINT_DATA' is 6; 'POINTS' asks for 0"},
        {HEAD("3.0", "ASCII") UNSTRUCTURED "POINTS 6\n", "'POINTS 6', is cut short"},
        {HEAD("3.0", "ASCII") UNSTRUCTURED "POINTS six float\n", "'POINTS' is 'six'"},
        {HEAD("3.0", "ASCII") UNSTRUCTURED "POINTS 6 quad\n", "'POINTS' is of type 'quad'"},
        {HEAD("3.0", "BINARY") UNSTRUCTURED "POINTS 1000000000000 float\n",
         "the array 'POINTS' has 3000000000000 numbers of 32 bits; the file holds 0"},
        {START VALUES, "the grid has 6 points and 0 cells"},
        {START "CELLS 3\n", "'CELLS 3', is cut short"},
        {START "CELLS 1 5\n4 0 1 2 3\n" VALUES, "'CELL_TYPES' is missing"},
        {START "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 0\n" VALUES,
         "'CELL_TYPES' lists 0; the grid asks for 1"},
        {START "CELL_TYPES 1\n10\n" VALUES, "the grid has 6 points and 0 cells"},
        {START "CELLS 1 5\n5 0 1 2 3\nCELL_TYPES 1\n10\n" VALUES,
         "'CELLS' ends within cell 0: it lists 5 numbers"},
        {START "CELLS 1 5\n-4 0 1 2 3\nCELL_TYPES 1\n10\n" VALUES,
         "'CELLS' ends within cell 0"},
        {START "CELLS 2 5\n4 0 1 2 3\nCELL_TYPES 2\n10 10\n" VALUES,
         "'CELLS' ends within cell 1"},
        {START "CELLS 1 5\n4 0 1 2 6\nCELL_TYPES 1\n10\n" VALUES,
         "cell 0 has the corner 6; 'POINTS' says that there are 6"},
        {START "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n42\n" VALUES, "cell 0 is a polyhedron"},
        {NEW "CELLS 2 4\nCONNECTIVITY vtktypeint64\n",
         "'CONNECTIVITY vtktypeint64'; OFFSETS and a type were expected"},
        {NEW "CELLS 2 4\nOFFSETS vtktypeint64\n0 5\nCONNECTIVITY int\n0 1 2 3\nCELL_TYPES "
             "1\n10\n" VALUES,
         "'CONNECTIVITY' lists 4; the grid asks for 5"},
        {NEW "CELLS 2 4\nOFFSETS vtktypeint64\n0 3\nCONNECTIVITY int\n0 1 2 3\nCELL_TYPES "
             "1\n10\n" VALUES,
         "cell 0, a tetrahedron, has 3 corners; 4 expected"},
        {START LISTED "POINT_DATA 5\n", "'POINT_DATA' is 5; 'POINTS' asks for 6"},
        {START LISTED "CELL_DATA 5\n", "'CELL_DATA' is 5; 'CELLS' asks for 3"},
        {START "DIMENSIONS 2 2 2\n", "starts nothing that is known"},
        {HEAD("3.0", "ASCII") "DATASET STRUCTURED_GRID\nDIMENSIONS 2 2 1\nPOINTS 4 float\n"
                              "0 0 0 1 0 0 0 1 0 1 1 0\nPOINT_DATA 4\nSCALARS f int\n1 2 3 4\n",
         "'DIMENSIONS' has one plane of points along z: the grid is flat"},
        {HEAD("3.0", "ASCII") "DATASET STRUCTURED_GRID\nDIMENSIONS 2 2 2\nPOINTS 4 float\n"
                              "0 0 0 1 0 0 0 1 0 1 1 0\nPOINT_DATA 8\nSCALARS f int\n"
                              "1 2 3 4 5 6 7 8\n",
         "'POINTS' lists 4; the grid asks for 8"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        put(cases[i].text);
        check_told("a.vtk", i, cases[i].words);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(text_of_every_version_gives_the_grid),
        cmocka_unit_test(bytes_of_every_version_give_the_grid),
        cmocka_unit_test(no_byte_is_trusted),
        cmocka_unit_test(values_of_cells_are_averaged),
        cmocka_unit_test(curvilinear_grids_have_hexahedra),
        cmocka_unit_test(marked_cells_are_left_out),
        cmocka_unit_test(damaged_files_are_told_where),
    };
    return cmocka_run_group_tests(tests, test_folder_make, test_folder_remove);
}
