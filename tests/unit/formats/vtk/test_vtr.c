/* VTK's XML rectilinear grids: coordinates, values of points and of cells. */
#include "support/files/reading.h"
#include "support/files/vtk_xml.h"

#include "core/base/memory.h"

#include <stdio.h>

#define FILE_START                                                                             \
    "<VTKFile type='RectilinearGrid' byte_order='LittleEndian'><RectilinearGrid "              \
    "WholeExtent='2 4 0 1 0 1'><Piece Extent='2 4 0 1 0 1'>"
#define FILE_END "</Piece></RectilinearGrid></VTKFile>\n"
#define POINTS                                                                                 \
    "<PointData><DataArray type='Int16' Name='p'>0 1 2 3 4 5 6 7 8 9 10 11</DataArray>"        \
    "</PointData>"
#define CELLS                                                                                  \
    "<CellData Scalars='d'><DataArray type='Float32' Name='c'>5 7</DataArray>"                 \
    "<DataArray type='UInt8' Name='d'>8 9</DataArray></CellData>"
#define ALONG(numbers) "<DataArray type='Float64'>" numbers "</DataArray>"
#define COORDINATES                                                                            \
    "<Coordinates>" ALONG("1 2 4") ALONG("7 6.5") "<DataArray type='Float32' "                 \
                                                  "format='binary'>CAAAAAAAAD8AAEBA"           \
                                                  "</DataArray></Coordinates>" /* 0.5 3 */

static void put(const char *text)
{
    test_file_write(test_path("a.vtr"), text, strlen(text));
}

/* Numbers along y fall: they are taken from the other end. */
static void points_stand_at_their_coordinates(void **state)
{
    (void)state;
    for (int after = 0; after < 2; after++) {
        char text[2000];
        cw_volume v;
        cw_error err = {0};
        snprintf(text, sizeof text, "%s%s%s%s", FILE_START, after ? POINTS : COORDINATES,
                 after ? COORDINATES : POINTS, FILE_END);
        put(text);
        assert_ok(read_back("a.vtr", &v, &err), err);
        assert_int_equal(v.dim[0], 3);
        assert_int_equal(v.dim[1], 2);
        assert_place(&v, 0, 0, 0, 1, 7, 0.5);
        assert_place(&v, 1, 1, 1, 2, 6.5, 3);
        assert_place(&v, 2, 0, 0.5, 4, 7, 1.75);
        assert_true(cw_volume_value(&v, 2, 1, 1) == 11);
        cw_volume_free(&v);
    }
}

static void keep_note(void *user, const char *text)
{
    strncat(user, text, 999 - strlen(user));
}

static void cells_are_samples_in_their_middles(void **state)
{
    (void)state;
    char note[1000] = "";
    cw_read_desc desc = {.note = keep_note, .note_user = note};
    cw_volume v;
    cw_error err = {0};
    put(FILE_START CELLS COORDINATES FILE_END);
    assert_ok(cw_volume_read(test_path("a.vtr"), &desc, &v, NULL, &err), err);
    assert_int_equal(v.dim[0], 2);
    assert_int_equal(v.dim[2], 1);
    assert_true(cw_volume_value(&v, 0, 0, 0) == 8);
    assert_place(&v, 0, 0, 0, 1.5, 6.75, 1.75);
    assert_place(&v, 1, 0, 0, 3, 6.75, 1.75);
    assert_non_null(strstr(note, "'d' has a value for each cell"));
    cw_volume_free(&v);
    desc.array = "c";
    assert_ok(cw_volume_read(test_path("a.vtr"), &desc, &v, NULL, &err), err);
    assert_true(cw_volume_value(&v, 1, 0, 0) == 7);
    cw_volume_free(&v);
    /* those of points go first */
    put(FILE_START CELLS POINTS COORDINATES FILE_END);
    assert_ok(read_back("a.vtr", &v, &err), err);
    assert_int_equal(v.dim[0], 3);
    cw_volume_free(&v);
    assert_ok(cw_volume_read(test_path("a.vtr"), &desc, &v, NULL, &err), err);
    assert_int_equal(v.dim[0], 2);
    cw_volume_free(&v);
}

static void a_region_or_the_header_has_its_coordinates(void **state)
{
    (void)state;
    const cw_box box = {{1, 0, 0}, {2, 2, 1}};
    cw_volume v;
    cw_error err = {0};
    put(FILE_START POINTS COORDINATES FILE_END);
    assert_ok(
        cw_volume_read(test_path("a.vtr"), &(cw_read_desc){.region = &box}, &v, NULL, &err),
        err);
    assert_place(&v, 0, 1, 0, 2, 6.5, 0.5);
    assert_place(&v, 1, 0, 0, 4, 7, 0.5);
    assert_true(cw_volume_value(&v, 1, 1, 0) == 5);
    cw_volume_free(&v);
    assert_ok(cw_volume_read(test_path("a.vtr"), &(cw_read_desc){.header_only = true}, &v, NULL,
                             &err),
              err);
    assert_place(&v, 2, 1, 1, 4, 6.5, 3);
    cw_volume_free(&v);
}

static void damaged_files_are_told_where(void **state)
{
    (void)state;
    static const struct {
        const char *text, *words;
    } cases[] = {
        {FILE_START POINTS FILE_END, "Coordinates has 0 arrays"},
        {FILE_START POINTS "<Coordinates>" ALONG("1 2 4")
             ALONG("6 7") "</Coordinates>" FILE_END,
         "Coordinates has 2 arrays"},
        {FILE_START POINTS "<Coordinates>" ALONG("1 2 4") ALONG("6 7") ALONG("1 2")
             ALONG("1 2") "</Coordinates>" FILE_END,
         "more than three arrays"},
        {FILE_START POINTS "<Coordinates>" ALONG("1 4 2") ALONG("6 7")
             ALONG("1 2") "</Coordinates>" FILE_END,
         "Coordinates along x: number 2, 2, follows 4; all must rise, or all fall"},
        {FILE_START POINTS "<Coordinates>" ALONG("1 2 4") ALONG("7 7")
             ALONG("1 2") "</Coordinates>" FILE_END,
         "Coordinates along y: number 1, 7, follows 7"},
        {FILE_START POINTS "<Coordinates>" ALONG("1 2 4") ALONG("6 nan")
             ALONG("1 2") "</Coordinates>" FILE_END,
         "Coordinates along y"},
        {FILE_START POINTS "<Coordinates>" ALONG("1 2") ALONG("6 7")
             ALONG("1 2") "</Coordinates>" FILE_END,
         "'Extent' asks for 24 bytes of coordinates"},
        {FILE_START POINTS "<Coordinates><DataArray type='Int64'>1 2 4</DataArray>"
                           "</Coordinates>" FILE_END,
         "coordinates along x are 1 of type 'Int64' each"},
        {FILE_START "<CellData/>" COORDINATES FILE_END, "hold no array that is read"},
        {"<VTKFile type='RectilinearGrid' byte_order='LittleEndian'><RectilinearGrid><Piece "
         "Extent='0 2147483646 0 1 0 1'>" POINTS COORDINATES FILE_END,
         "'Extent' asks for"},
        {"<VTKFile type='Table'/>",
         "only ImageData, RectilinearGrid (vti), StructuredGrid or UnstructuredGrid (vtu), or a "
         "list of one kind is a volume"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        put(cases[i].text);
        check_told("a.vtr", i, cases[i].words);
    }
}

static void arrays_go_by_name(void **state)
{
    (void)state;
    const cw_read_desc desc = {.array = "q"};
    cw_volume v;
    cw_error err = {0};
    put(FILE_START POINTS CELLS COORDINATES FILE_END);
    assert_fails(cw_volume_read(test_path("a.vtr"), &desc, &v, NULL, &err), CW_ERR_ARGUMENT,
                 "there is no array 'q' that is read; there are 'p' (1 Int16), 'c' (1 Float32)",
                 err);
    test_file_write(test_path("a.raw"), "abcdefgh", 8);
    const cw_raw_layout raw = {.dim = {2, 2, 2}, .type = CW_U8};
    const cw_read_desc other = {.array = "q", .raw = &raw};
    assert_fails(cw_volume_read(test_path("a.raw"), &other, &v, NULL, &err), CW_ERR_ARGUMENT,
                 "no arrays with names", err);
}

static void memory_may_run_out_anywhere(void **state)
{
    (void)state;
    put(FILE_START POINTS COORDINATES FILE_END);
    check_starved("a.vtr", NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_stand_at_their_coordinates),
        cmocka_unit_test(cells_are_samples_in_their_middles),
        cmocka_unit_test(a_region_or_the_header_has_its_coordinates),
        cmocka_unit_test(damaged_files_are_told_where),
        cmocka_unit_test(arrays_go_by_name),
        cmocka_unit_test(memory_may_run_out_anywhere),
    };
    return cmocka_run_group_tests(tests, test_folder_make, test_folder_remove);
}
