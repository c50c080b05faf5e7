/* VTK's XML unstructured and curvilinear grids. */
#include "support/files/vtk_xml.h"
#include "support/grids.h"

#include <stdio.h>

/* --- one grid in every dialect ----------------------------------------------------------- */

enum { POINT_COUNT = 11, CELL_COUNT = 6, CORNER_COUNT = 34 };

static const double points[3 * POINT_COUNT] = {0, 0, 0,  1,  0, 0, 1, 1, 0, 0, 1,
                                               0, 0, 0,  1,  1, 0, 1, 1, 1, 1, 0,
                                               1, 1, .5, .5, 2, 2, 0, 0, 2, 0, 1};

/* A hexahedron, the same as a voxel, a pyramid, a wedge, a triangle and a tetrahedron. */
static const int types[CELL_COUNT] = {12, 11, 14, 13, 5, 10};
static const int ends[CELL_COUNT] = {8, 16, 21, 27, 30, 34};
static const int corners[CORNER_COUNT] = {0, 1, 2, 3, 4, 5, 6, 7, 0,  1, 3, 2, 4, 5, 7, 6, 4,
                                          5, 6, 7, 8, 1, 9, 2, 5, 10, 6, 0, 1, 2, 1, 9, 2, 10};

typedef enum array { VALUES, PLACES, CONNECTIVITY, OFFSETS, TYPES, ARRAY_COUNT } array;

static void add_double(byte_buffer *to, double number, bool big)
{
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    add_number(to, bits, sizeof bits, big);
}

static void make_plain(array which, const dialect *d, byte_buffer *plain)
{
    const size_t size = d->wide ? 8 : 4;
    plain->size = 0;
    for (int i = 0; which == VALUES && i < POINT_COUNT; i++)
        add_number(plain, (uint64_t)(int64_t)(10 * i - 30), 2, d->big);
    for (int i = 0; which == PLACES && i < 3 * POINT_COUNT; i++)
        add_double(plain, points[i], d->big);
    for (int i = 0; which == CONNECTIVITY && i < CORNER_COUNT; i++)
        add_number(plain, (uint64_t)corners[i], size, d->big);
    for (int i = 0; which == OFFSETS && i < CELL_COUNT; i++)
        add_number(plain, (uint64_t)ends[i], size, d->big);
    for (int i = 0; which == TYPES && i < CELL_COUNT; i++)
        add_number(plain, (uint64_t)types[i], 1, d->big);
}

static void add_ascii(byte_buffer *to, array which)
{
    char text[40];
    const int count[ARRAY_COUNT] = {POINT_COUNT, 3 * POINT_COUNT, CORNER_COUNT, CELL_COUNT,
                                    CELL_COUNT};
    for (int i = 0; i < count[which]; i++) {
        snprintf(text, sizeof text, "%g ",
                 which == VALUES         ? 10 * i - 30
                 : which == PLACES       ? points[i]
                 : which == CONNECTIVITY ? corners[i]
                 : which == OFFSETS      ? ends[i]
                                         : types[i]);
        add_text(to, text);
    }
}

/* One DataArray; what is appended goes to the end of `appended`. */
static void add_array(byte_buffer *file, byte_buffer *appended, const dialect *d, array which)
{
    static byte_buffer plain;
    const char *whole = d->wide ? "Int64" : "Int32";
    const char *const kinds[ARRAY_COUNT] = {"Int16", "Float64", whole, whole, "UInt8"};
    static const char *const names[ARRAY_COUNT] = {"s", "Points", "connectivity", "offsets",
                                                   "types"};
    char text[300], offset[40] = "";
    if (d->form >= APPENDED_TEXT)
        snprintf(offset, sizeof offset, "offset='%zu'", appended->size);
    snprintf(text, sizeof text,
             "<DataArray type='%s' Name='%s' NumberOfComponents='%d' format='%s' %s>",
             kinds[which], names[which], which == PLACES ? 3 : 1, form_names[d->form], offset);
    add_text(file, text);
    make_plain(which, d, &plain);
    if (d->form == ASCII)
        add_ascii(file, which);
    else
        add_payload(d->form == INLINE ? file : appended, d, &plain, d->form != APPENDED_RAW);
    add_text(file, "</DataArray>\n");
}

static void make_file(const dialect *d, byte_buffer *file)
{
    static byte_buffer appended;
    file->size = appended.size = 0;
    add_file_tag(file, d, "UnstructuredGrid");
    add_text(file, "<UnstructuredGrid><Piece NumberOfPoints='11' NumberOfCells='6'>"
                   "<PointData Scalars='s'>");
    add_array(file, &appended, d, VALUES);
    add_text(file, "</PointData><Points>");
    add_array(file, &appended, d, PLACES);
    add_text(file, "</Points><Cells>");
    add_array(file, &appended, d, CONNECTIVITY);
    add_array(file, &appended, d, OFFSETS);
    add_array(file, &appended, d, TYPES);
    add_text(file, "</Cells></Piece></UnstructuredGrid>\n");
    if (d->form >= APPENDED_TEXT) {
        add_text(file, d->form == APPENDED_RAW ? "<AppendedData encoding='raw'>_"
                                               : "<AppendedData encoding='base64'>_");
        add(file, appended.at, appended.size);
        add_text(file, "\n</AppendedData>");
    }
    add_text(file, "</VTKFile>");
}

static void check_file(const char *name)
{
    static const uint32_t block[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    const char *format = NULL;
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_volume_read(test_path(name), NULL, &v, &format, &err), err);
    assert_string_equal(format, "vtu");
    assert_int_equal(v.type, CW_I16);
    assert_int_equal(v.known, 0);
    assert_int_equal(v.dim[0], POINT_COUNT);
    assert_int_equal(v.cells->count, CELL_COUNT - 1);
    check_grid(&v);
    check_affine(&v, (const double[12]){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0});
    for (size_t n = 0; n < POINT_COUNT; n++) {
        assert_value(&v, n, 10 * (double)n - 30);
        assert_point(&v, n, points[3 * n], points[3 * n + 1], points[3 * n + 2]);
    }
    assert_cell(&v, 0, CW_HEXAHEDRON, 0, block);
    assert_cell(&v, 1, CW_HEXAHEDRON, 8, block);
    assert_cell(&v, 2, CW_PYRAMID, 16, (const uint32_t[]){4, 5, 6, 7, 8});
    assert_cell(&v, 3, CW_WEDGE, 21, (const uint32_t[]){1, 9, 2, 5, 10, 6});
    assert_cell(&v, 4, CW_TETRAHEDRON, 27, (const uint32_t[]){1, 9, 2, 10});
    cw_volume_free(&v);
    assert_null(v.cells);
}

static void every_dialect_gives_the_same_grid(void **state)
{
    (void)state;
    static byte_buffer file;
    for (unsigned n = 0; n < 128; n++) {
        const dialect d = dialect_of(n);
        if (!is_read(&d))
            continue;
        make_file(&d, &file);
        save(&file, "a.bin");
        check_file("a.bin");
    }
}

static void a_cut_is_never_a_grid(void **state)
{
    (void)state;
    static byte_buffer file;
    for (unsigned n = 0; n < 16; n++) {
        dialect d = dialect_of(n);
        d.big = n & 1;
        d.wide = n >> 1 & 1;
        if (!is_read(&d))
            continue;
        make_file(&d, &file);
        save(&file, "a.vtu");
        check_some_cuts("a.vtu", "a.vtu", 0, test_is_short() ? 7 : 1);
    }
}

/* Whatever a byte is turned into, what is read is a grid, or nothing is. */
static void no_byte_is_trusted(void **state)
{
    (void)state;
    static byte_buffer file;
    for (unsigned n = 0; n < 8; n++) {
        const dialect d = {.form = n & 1 ? APPENDED_RAW : ASCII,
                           .packing = n & 2 ? ZLIB : PLAIN,
                           .wide = n & 4};
        make_file(&d, &file);
        for (size_t i = 0; i < file.size; i += test_is_short() ? 9 : 1) {
            cw_volume v;
            cw_error err = {0};
            const unsigned char kept = file.at[i];
            file.at[i] ^= i % 2 ? 0x11 : 0x80;
            save(&file, "a.vtu");
            if (read_back("a.vtu", &v, &err) == CW_OK) {
                check_grid(&v);
                cw_volume_free(&v);
            }
            file.at[i] = kept;
        }
    }
}

/* --- grids as text ----------------------------------------------------------------------- */

#define FILE_START                                                                             \
    "<VTKFile type='UnstructuredGrid' byte_order='LittleEndian'><UnstructuredGrid>"
#define FILE_END             "</UnstructuredGrid></VTKFile>\n"
#define PIECE(points, cells) "<Piece NumberOfPoints='" #points "' NumberOfCells='" #cells "'>"
#define ARRAY(type, name, rest, text)                                                          \
    "<DataArray type='" type "' Name='" name "' " rest ">" text "</DataArray>"
#define PLACES(text)                                                                           \
    "<Points>" ARRAY("Float32", "Points", "NumberOfComponents='3'", text) "</Points>"
#define CELLS(corners, ends, types)                                                            \
    "<Cells>" ARRAY("Int64", "connectivity", "", corners) ARRAY("Int64", "offsets", "", ends)  \
        ARRAY("UInt8", "types", "", types) "</Cells>"
#define POINT_DATA(text) "<PointData>" text "</PointData>"
#define CELL_DATA(text)  "<CellData>" text "</CellData>"

/* A tetrahedron, and its mirror image at z = 0. */
#define ABOVE        "0 0 0  1 0 0  0 1 0  0 0 1"
#define BELOW        "0 0 -1  -0 0 -0  0 1 0  1 0 0"
#define ONE_CELL     CELLS("0 1 2 3", "4", "10")
#define VALUES_ABOVE POINT_DATA(ARRAY("Float32", "f", "", "1 2 3 4"))

static void put(const char *text)
{
    test_file_write(test_path("a.vtu"), text, strlen(text));
}

/* Along a seam points are in both pieces; where values differ, a sample stays twice. A piece
 * may have nothing. */
static void pieces_become_one_grid(void **state)
{
    (void)state;
    static char notes[NOTES];
    cw_volume v;
    cw_error err = {0};
    put(FILE_START PIECE(4, 1) VALUES_ABOVE PLACES(ABOVE) ONE_CELL
        "</Piece>" PIECE(0, 0) "</Piece>" PIECE(4, 1)
            POINT_DATA(ARRAY("Float32", "f", "", "5 1 3 2")) PLACES(BELOW) ONE_CELL
        "</Piece>" FILE_END);
    assert_ok(read_noted("a.vtu", NULL, notes, &v, &err), err);
    check_grid(&v);
    assert_int_equal(v.dim[0], 5);
    assert_cell(&v, 1, CW_TETRAHEDRON, 4, (const uint32_t[]){4, 0, 2, 1});
    assert_point(&v, 4, 0, 0, -1);
    assert_value(&v, 4, 5);
    assert_string_equal(
        notes, "merged, because others have the same position and value: 3 of 8 points\n");
    cw_volume_free(&v);
    check_starved("a.vtu", NULL);

    put(FILE_START PIECE(4, 1) VALUES_ABOVE PLACES(ABOVE) ONE_CELL "</Piece>" PIECE(4, 1)
            POINT_DATA(ARRAY("Float32", "f", "", "5 1 3.5 2")) PLACES(BELOW) ONE_CELL
        "</Piece>" FILE_END);
    assert_ok(read_back("a.vtu", &v, &err), err);
    assert_int_equal(v.dim[0], 6);
    assert_cell(&v, 1, CW_TETRAHEDRON, 4, (const uint32_t[]){4, 0, 5, 1});
    cw_volume_free(&v);

    put(FILE_START PIECE(4, 1) VALUES_ABOVE PLACES(ABOVE) ONE_CELL "</Piece>" PIECE(4, 1)
            POINT_DATA(ARRAY("Float32", "g", "", "5 1 3 2")) PLACES(BELOW) ONE_CELL
        "</Piece>" FILE_END);
    assert_fails(read_back("a.vtu", &v, &err), CW_ERR_FORMAT,
                 "piece 1 has the array 'g' (1 Float32) where the first has 'f' (1 Float32)",
                 err);
}

/* Points are merged before cells are averaged around them: across seams, too. */
static void values_of_cells_are_averaged(void **state)
{
    (void)state;
    static char notes[NOTES];
    cw_volume v;
    cw_error err = {0};
    put(FILE_START PIECE(5, 1) CELL_DATA(ARRAY("UInt8", "c", "", "10")) PLACES(ABOVE "  7 7 7")
            ONE_CELL "</Piece>" PIECE(4, 2) CELL_DATA(ARRAY("UInt8", "c", "", "99 20"))
                PLACES(BELOW) CELLS("0 1 2  0 1 2 3", "3 7", "5 10") "</Piece>" FILE_END);
    assert_ok(read_noted("a.vtu", NULL, notes, &v, &err), err);
    check_grid(&v);
    assert_int_equal(v.type, CW_F64);
    assert_int_equal(v.dim[0], 6);
    const double wanted[6] = {15, 15, 15, 10, NAN, 20};
    for (size_t n = 0; n < 6; n++)
        assert_value(&v, n, wanted[n]);
    assert_string_equal(notes,
                        "left out, as they have fewer than three dimensions: 1 of 3 cells\n"
                        "'c' has a value for each cell: samples are the mean of the cells "
                        "around them\n"
                        "merged, because others have the same position: 3 of 9 points\n");
    cw_volume_free(&v);
    check_starved("a.vtu", NULL);
}

/* The one asked for, of points or cells; else of points, the one that is named, or the first of
 * one value. */
static void arrays_go_by_name(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        size_t components;
        double last; /* component of sample 1 */
    } cases[] = {{NULL, 1, 6}, {"f", 1, 6},  {"v", 3, 23},
                 {"g", 2, 32}, {"c", 1, 10}, {"wide", 1, 2}};
    cw_volume v, one;
    cw_error err = {0};
    put(FILE_START PIECE(4, 1) POINT_DATA(
        ARRAY("Float32", "v", "NumberOfComponents='3'", "1 2 3 21 22 23 1 1 1 2 2 2")
            ARRAY("Int64", "wide", "", "1 2 3 4") ARRAY("UInt8", "vtkGhostType", "", "0 0 0 0")
                ARRAY("Int8", "f", "", "5 6 7 8")
                    ARRAY("Float64", "g", "NumberOfComponents='2'", "1 2 31 32 1 1 2 2"))
            CELL_DATA(ARRAY("UInt8", "c", "", "10")) PLACES(ABOVE) ONE_CELL
        "</Piece>" FILE_END);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const cw_read_desc desc = {.array = cases[i].name};
        assert_ok(cw_volume_read(test_path("a.vtu"), &desc, &v, NULL, &err), err);
        assert_int_equal(v.components, cases[i].components);
        assert_ok(cw_volume_select(&v, v.components - 1, 0, &one, &err), err);
        assert_value(&one, 1, cases[i].last);
        cw_volume_free(&v);
    }
    const cw_read_desc desc = {.array = "none"};
    assert_fails(cw_volume_read(test_path("a.vtu"), &desc, &v, NULL, &err), CW_ERR_ARGUMENT,
                 "there is no array 'none' that is read; there are 'v' (3 Float32), 'wide' (1 "
                 "Int64), 'f' (1 Int8)",
                 err);
}

/* Cells that another piece has (1), and hidden ones (32), but not others. */
static void marked_cells_are_left_out(void **state)
{
    (void)state;
    static char notes[NOTES];
    cw_volume v;
    cw_error err = {0};
    put(FILE_START PIECE(4, 4)
            VALUES_ABOVE CELL_DATA(ARRAY("UInt8", "vtkGhostType", "", "0 1 2 32")) PLACES(ABOVE)
                CELLS("0 1 2 3 0 1 2 3 1 0 3 2 0 1 2 3", "4 8 12 16",
                      "10 10 10 10") "</Piece>" FILE_END);
    assert_ok(read_noted("a.vtu", NULL, notes, &v, &err), err);
    check_grid(&v);
    assert_int_equal(v.cells->count, 2);
    assert_cell(&v, 1, CW_TETRAHEDRON, 4, (const uint32_t[]){1, 0, 3, 2});
    assert_string_equal(notes,
                        "left out, as they are hidden or another piece's: 2 of 4 cells\n");
    cw_volume_free(&v);
    put(FILE_START PIECE(4, 1) VALUES_ABOVE CELL_DATA(ARRAY("UInt8", "vtkGhostType", "", "32"))
            PLACES(ABOVE) ONE_CELL "</Piece>" FILE_END);
    check_told("a.vtu", 0,
               "none of the grid's 1 cells is left: 0 have fewer than three "
               "dimensions, 1 are marked");
}

/* Every kind that VTK numbers, with as many corners as there is room for. */
static void kinds_of_cells_are_known(void **state)
{
    (void)state;
    static char notes[NOTES];
    size_t read = 0, flat = 0;
    for (int type = 0; type < 256; type++) {
        char text[3000], list[200] = "";
        const cwi_cell_kind *kind = cwi_cell_kind_find(type);
        const bool curved = kind && kind->use == CWI_CELL_CURVED;
        const bool ours = kind && kind->use >= CWI_CELL_LINEAR;
        const size_t count = curved ? 27 : ours ? cwi_shape_corners(kind->shape) : 1;
        for (size_t i = 0; i < count; i++)
            snprintf(list + strlen(list), sizeof list - strlen(list), "%zu ", i % 8);
        snprintf(text, sizeof text,
                 FILE_START PIECE(8, 2) "%s" PLACES("0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 "
                                                    "0 1 1")
                     CELLS("0 1 2 3 %s", "4 %zu", "10 %d") "</Piece>" FILE_END,
                 POINT_DATA(ARRAY("Int8", "f", "", "1 2 3 4 5 6 7 8")), list, 4 + count, type);
        put(text);
        cw_volume v;
        cw_error err = {0};
        if (!kind || kind->use == CWI_CELL_REFUSED) {
            char words[80];
            if (kind)
                snprintf(words, sizeof words, "cell 1 is a %s (type %d);", kind->name, type);
            else
                snprintf(words, sizeof words, "cell 1 is of type %d, which", type);
            check_told("a.vtu", (size_t)type, words);
            continue;
        }
        assert_ok(read_noted("a.vtu", NULL, notes, &v, &err), err);
        check_grid(&v);
        assert_int_equal(v.cells->count, ours ? 2 : 1);
        assert_true(!ours || v.cells->shapes[1] == kind->shape);
        assert_true(
            !curved ==
            !strstr(notes, "curved, and taken as straight, by their corners alone: 1 of"));
        assert_true(ours == !strstr(notes, "fewer than three dimensions: 1 of 2 cells"));
        read += ours;
        flat += !ours;
        cw_volume_free(&v);
    }
    assert_int_equal(read, 5 + 4 + 5 + 4 + 4);
    assert_int_equal(flat, 10 + 8 + 6);
    assert_string_equal(cwi_cell_kind_find(42)->name, "polyhedron");
}

#define GRID(data, cells) FILE_START PIECE(4, 1) data PLACES(ABOVE) cells "</Piece>" FILE_END

static void damaged_files_are_told_where(void **state)
{
    (void)state;
    static const struct {
        const char *text, *words;
    } cases[] = {
        {FILE_START FILE_END, "the grid has no Piece"},
        {FILE_START PIECE(0, 0) VALUES_ABOVE "</Piece>" FILE_END,
         "the grid has 0 points and 0 cells"},
        {GRID("", ONE_CELL), "PointData and CellData hold no array that is read"},
        {GRID(VALUES_ABOVE, ""), "'NumberOfCells' is 1; the array for them is missing"},
        {FILE_START PIECE(4, 1) VALUES_ABOVE ONE_CELL "</Piece>" FILE_END,
         "'NumberOfPoints' is 4; the array for them is missing"},
        {FILE_START PIECE(-4, 1) "</Piece>" FILE_END, "'NumberOfPoints' is '-4'"},
        {FILE_START PIECE(4, many) "</Piece>" FILE_END, "'NumberOfCells' is 'many'"},
        {FILE_START PIECE(4000000000000, 1) VALUES_ABOVE PLACES(ABOVE) ONE_CELL
         "</Piece>" FILE_END,
         "'NumberOfPoints' asks for more than 4294967294 points"},
        {FILE_START PIECE(4000000000, 1) VALUES_ABOVE PLACES(ABOVE) ONE_CELL
         "</Piece>" FILE_END,
         "'NumberOfPoints' asks for 48000000000 bytes of numbers, encoded; the file holds"},
        {FILE_START PIECE(4, 4000000000) VALUES_ABOVE PLACES(ABOVE) ONE_CELL
         "</Piece>" FILE_END,
         "'NumberOfCells' asks for 4000000000 bytes of numbers, encoded; the file holds"},
        {GRID(VALUES_ABOVE, CELLS("0 1 2 4", "4", "10")),
         "cell 0 has the corner 4; 'NumberOfPoints' says that there are 4"},
        {GRID(VALUES_ABOVE, CELLS("0 1 2 -1", "4", "10")), "cell 0 has the corner -1"},
        {GRID(VALUES_ABOVE, CELLS("0 1 2 1e300", "4", "10")), "cell 0 has the corner -1"},
        {GRID(VALUES_ABOVE, CELLS("0 1 2", "3", "10")),
         "cell 0, a tetrahedron, has 3 corners; 4 expected"},
        {GRID(VALUES_ABOVE, CELLS("0 1 2 3 0", "5", "10")), "has 5 corners; 4 expected"},
        {GRID(VALUES_ABOVE, CELLS("0 1 2", "3", "24")),
         "cell 0, a quadratic tetrahedron, has 3 corners; at least 4 expected"},
        {GRID(VALUES_ABOVE, CELLS("0 1 2 3", "4000000000", "10")),
         "'offsets' asks for 32000000000 bytes of numbers"},
        {GRID(VALUES_ABOVE, CELLS("0 1 2 3", "-4", "10")),
         "'offsets' says that cell 0 ends at -4; it starts at 0, and the last ends at 0"},
        {FILE_START PIECE(4, 2) VALUES_ABOVE PLACES(ABOVE)
             CELLS("0 1 2 3 0 1 2 3", "9 8", "10 10") "</Piece>" FILE_END,
         "'offsets' says that cell 0 ends at 9; it starts at 0, and the last ends at 8"},
        {FILE_START PIECE(4, 3) VALUES_ABOVE PLACES(ABOVE)
             CELLS("0 1 2 3 0 1 2 3", "4 3 8", "10 10 10") "</Piece>" FILE_END,
         "'offsets' says that cell 1 ends at 3; it starts at 4"},
        {GRID(VALUES_ABOVE, CELLS("0 1 2 3", "4", "42")), "cell 0 is a polyhedron (type 42)"},
        {GRID(VALUES_ABOVE, CELLS("0 1 2 3", "4", "99")), "cell 0 is of type 99"},
        {GRID(VALUES_ABOVE, CELLS("0 1 2 3", "4", "5")),
         "none of the grid's 1 cells is left: 1 have fewer"},
        {FILE_START PIECE(4, 1) VALUES_ABOVE PLACES("0 0 0 1 0 0 0 1 0 0 0 nan") ONE_CELL
         "</Piece>" FILE_END,
         "point 3 has the coordinate nan"},
        {FILE_START PIECE(4, 1) VALUES_ABOVE PLACES("0 0 0 1 0 0 0 1 0 0 0 1e31") ONE_CELL
         "</Piece>" FILE_END,
         "point 3 has the coordinate 1e+31"},
        {FILE_START PIECE(4, 1) VALUES_ABOVE
         "<Points>" ARRAY("Float32", "Points", "NumberOfComponents='2'", "0 0") "</Points>",
         "the array 'Points' has 2 numbers of type 'Float32'; 3 were expected"},
        {GRID(VALUES_ABOVE, "<Cells>" ARRAY("Float32", "offsets", "", "4") "</Cells>"),
         "the array 'offsets' has 1 numbers of type 'Float32'; 1 whole one was expected"},
        {"<VTKFile type='UnstructuredGrid'><UnstructuredGrid TimeValues='0 1'>",
         "'TimeValues' is '0 1'"},
        {"<VTKFile type='StructuredGrid'><StructuredGrid><Piece Extent='0 1 0 1 3 3'>",
         "'Extent' has one plane of points along z: the grid is flat"},
        {"<VTKFile type='StructuredGrid'><StructuredGrid><Piece Extent='0 1 0 1 0'>",
         "'Extent' is '0 1 0 1 0'; six whole numbers"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        put(cases[i].text);
        check_told("a.vtu", i, cases[i].words);
    }
}

/* Many pieces cannot all be made of the same bytes of the file. */
static void pieces_share_no_bytes(void **state)
{
    (void)state;
    static byte_buffer file;
    const unsigned char zeros[2000] = {0};
    const dialect d = {.form = APPENDED_RAW};
    file.size = 0;
    add_file_tag(&file, &d, "UnstructuredGrid");
    add_text(&file, "<UnstructuredGrid>");
    for (int n = 0; n < 3; n++)
        add_text(&file, PIECE(166, 1) POINT_DATA(ARRAY(
                            "UInt8", "f", "format='appended' offset='2000'",
                            "")) "<Points>" ARRAY("Float32", "",
                                                  "NumberOfComponents='3' format='appended' "
                                                  "offset='0'",
                                                  "") "</Points>" ONE_CELL "</Piece>");
    add_text(&file, "</UnstructuredGrid><AppendedData encoding='raw'>_");
    add_number(&file, 1992, 4, false);
    add(&file, zeros, 1996);
    add_number(&file, 166, 4, false);
    add(&file, zeros, 166);
    add_text(&file, "</AppendedData></VTKFile>");
    save(&file, "a.vtu");
    check_told("a.vtu", 0, "bytes of the file, which has");
}

static void a_header_tells_of_samples_and_shapes(void **state)
{
    (void)state;
    static char notes[NOTES];
    cw_read_desc desc = {.header_only = true, .note = keep_notes, .note_user = notes};
    cw_volume v;
    cw_error err = {0};
    put(FILE_START PIECE(4, 3) CELL_DATA(ARRAY("UInt8", "c", "", "10 11 12")) PLACES(ABOVE)
            CELLS("0 1 2 0 1 2 3 3 2 0 1", "3 7 11", "5 10 24") "</Piece>" FILE_END);
    assert_ok(cw_volume_read(test_path("a.vtu"), &desc, &v, NULL, &err), err);
    assert_int_equal(v.dim[0], 4);
    assert_int_equal(v.type, CW_F64);
    assert_null(v.data);
    assert_int_equal(v.cells->count, 2);
    assert_int_equal(v.cells->shapes[1], CW_TETRAHEDRON);
    assert_null(v.cells->points);
    assert_null(v.cells->corners);
    assert_true(strstr(notes, "left out") &&
                strstr(notes, "curved, and taken as straight, by their corners alone: 1 of") &&
                strstr(notes, "'c' has a value for each cell"));
    cw_volume_free(&v);
    check_starved("a.vtu", &desc);
}

static void limits_and_what_is_for_even_grids_are_told(void **state)
{
    (void)state;
    static const cw_box box = {{0, 0, 0}, {2, 1, 1}};
    static const struct {
        cw_read_desc desc;
        cw_status status;
        const char *words;
    } cases[] = {
        {{.max_voxels = 3}, CW_ERR_LIMIT, "'NumberOfPoints' asks for 4 voxels; the limit is 3"},
        {{.max_bytes = 100}, CW_ERR_LIMIT, "the limit is 100 bytes (desc->max_bytes)"},
        {{.region = &box}, CW_ERR_UNSUPPORTED, "a crop on an irregular grid is not supported"},
        {{.spacing_mm = {1, 1, 1}}, CW_ERR_ARGUMENT, "a spacing is given (desc->spacing_mm)"},
    };
    cw_volume v;
    cw_error err = {0};
    put(GRID(VALUES_ABOVE, ONE_CELL));
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_fails(cw_volume_read(test_path("a.vtu"), &cases[i].desc, &v, NULL, &err),
                     cases[i].status, cases[i].words, err);
    const cw_read_desc enough = {.max_voxels = 4, .max_bytes = 1000};
    assert_ok(cw_volume_read(test_path("a.vtu"), &enough, &v, NULL, &err), err);
    cw_volume_free(&v);
}

typedef struct watch {
    double last;
    size_t calls, most;
} watch;

static bool report(void *user, const char *step, double done)
{
    watch *w = user;
    assert_string_equal(step, "reading");
    assert_true(done >= w->last && done <= 1);
    w->last = done;
    return ++w->calls <= w->most;
}

static void progress_rises_and_may_stop_it(void **state)
{
    (void)state;
    watch w = {.most = SIZE_MAX};
    const cw_read_desc desc = {.progress = {report, &w}};
    cw_volume v;
    cw_error err = {0};
    put(GRID(VALUES_ABOVE, ONE_CELL));
    assert_ok(cw_volume_read(test_path("a.vtu"), &desc, &v, NULL, &err), err);
    assert_true(w.last == 1);
    cw_volume_free(&v);
    const size_t calls = w.calls;
    for (size_t n = 0; n < calls; n++) {
        w = (watch){.most = n};
        assert_fails(cw_volume_read(test_path("a.vtu"), &desc, &v, NULL, &err),
                     CW_ERR_CANCELLED, "interrupted while reading", err);
        assert_null(v.data);
    }
}

/* --- curvilinear grids ------------------------------------------------------------------- */

#define BENT_START                                                                             \
    "<VTKFile type='StructuredGrid' byte_order='LittleEndian'><StructuredGrid "                \
    "WholeExtent='0 2 0 1 0 1'>"
#define BENT_END "</StructuredGrid></VTKFile>\n"
#define BENT(extent, values, positions, data)                                                  \
    "<Piece Extent='" extent "'>" POINT_DATA(ARRAY("Int16", "f", "", values) data)             \
        PLACES(positions) "</Piece>"

static void cells_in_rows_are_hexahedra(void **state)
{
    (void)state;
    static char notes[NOTES];
    cw_volume v;
    cw_error err = {0};
    put(BENT_START BENT("4 6 0 1 -1 0", "0 1 2 3 4 5 6 7 8 9 10 11",
                        "0 0 0 1 0 0 2 0 1  0 1 0 1 1 0 2 1 1  0 0 1 1 0 1 2 0 2  0 1 1 1 1 1 "
                        "2 1 2",
                        "") BENT_END);
    assert_ok(read_noted("a.vtu", NULL, notes, &v, &err), err);
    check_grid(&v);
    assert_int_equal(v.dim[0], 12);
    assert_cell(&v, 0, CW_HEXAHEDRON, 0, (const uint32_t[]){0, 1, 4, 3, 6, 7, 10, 9});
    assert_cell(&v, 1, CW_HEXAHEDRON, 8, (const uint32_t[]){1, 2, 5, 4, 7, 8, 11, 10});
    assert_point(&v, 8, 2, 0, 2);
    assert_value(&v, 8, 8);
    assert_string_equal(notes, "");
    cw_volume_free(&v);
    /* the same from two pieces */
    put(BENT_START BENT("0 1 0 1 0 1", "0 1 3 4 6 7 9 10",
                        "0 0 0 1 0 0 0 1 0 1 1 0 0 0 1 1 0 1 0 1 1 1 1 1", "")
            BENT("1 2 0 1 0 1", "1 2 4 5 7 8 10 11",
                 "1 0 0 2 0 1 1 1 0 2 1 1 1 0 1 2 0 2 1 1 1 2 1 2", "") BENT_END);
    assert_ok(read_noted("a.vtu", NULL, notes, &v, &err), err);
    check_grid(&v);
    assert_int_equal(v.dim[0], 12);
    assert_int_equal(v.cells->count, 2);
    assert_cell(&v, 1, CW_HEXAHEDRON, 8, (const uint32_t[]){1, 8, 9, 3, 5, 10, 11, 7});
    assert_non_null(strstr(notes, "same position and value: 4 of 16 points"));
    cw_volume_free(&v);
}

static void blanked_points_take_their_cells_along(void **state)
{
    (void)state;
    static char notes[NOTES];
    cw_volume v;
    cw_error err = {0};
    put(BENT_START BENT("0 2 0 1 0 1", "0 1 2 3 4 5 6 7 8 9 10 11",
                        "0 0 0 1 0 0 2 0 1  0 1 0 1 1 0 2 1 1  0 0 1 1 0 1 2 0 2  0 1 1 1 1 1 "
                        "2 1 2",
                        ARRAY("UInt8", "vtkGhostType", "", "2 1 1 1 1 1 1 1 1 1 1 1"))
            BENT_END);
    assert_ok(read_noted("a.vtu", NULL, notes, &v, &err), err);
    check_grid(&v);
    assert_int_equal(v.cells->count, 1);
    assert_cell(&v, 0, CW_HEXAHEDRON, 0, (const uint32_t[]){1, 2, 5, 4, 7, 8, 11, 10});
    assert_non_null(strstr(notes, "left out, as they are hidden"));
    cw_volume_free(&v);
    check_starved("a.vtu", NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_dialect_gives_the_same_grid),
        cmocka_unit_test(a_cut_is_never_a_grid),
        cmocka_unit_test(no_byte_is_trusted),
        cmocka_unit_test(pieces_become_one_grid),
        cmocka_unit_test(values_of_cells_are_averaged),
        cmocka_unit_test(arrays_go_by_name),
        cmocka_unit_test(marked_cells_are_left_out),
        cmocka_unit_test(kinds_of_cells_are_known),
        cmocka_unit_test(damaged_files_are_told_where),
        cmocka_unit_test(pieces_share_no_bytes),
        cmocka_unit_test(a_header_tells_of_samples_and_shapes),
        cmocka_unit_test(limits_and_what_is_for_even_grids_are_told),
        cmocka_unit_test(progress_rises_and_may_stop_it),
        cmocka_unit_test(cells_in_rows_are_hexahedra),
        cmocka_unit_test(blanked_points_take_their_cells_along),
    };
    return cmocka_run_group_tests(tests, test_folder_make, test_folder_remove);
}
