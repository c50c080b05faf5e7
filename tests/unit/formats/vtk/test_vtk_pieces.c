/* Tests files of VTK in pieces and blocks: surfaces and grids are joined, wrong lists are refused. */
#include "support/files/reading.h"
#include "support/meshes.h"
#include "support/solids.h"

#include <stdarg.h>

enum { TEXT_BYTES = 20000 };

/* --- surfaces ----------------------------------------------------------------------------- */

/* Appends to text. */
static void add(char *text, const char *format, ...) CW_PRINTF(2, 3);
static void add(char *text, const char *format, ...)
{
    const size_t used = strlen(text);
    va_list values;
    va_start(values, format);
    vsnprintf(text + used, TEXT_BYTES - used, format, values);
    va_end(values);
}

/* Elements in a Piece of one triangle: arrays of points, of cells. */
typedef struct extra {
    const char *points, *cells;
} extra;

/* Adds a Piece of triangles that share nothing: corner c of triangle t is places[triangles[t][c]]. */
static void add_piece(char *text, const float (*places)[3], const int (*triangles)[3],
                      size_t count, const extra *e)
{
    add(text,
        "<Piece NumberOfPoints='%zu' NumberOfPolys='%zu'><PointData>%s</PointData>"
        "<CellData>%s</CellData><Points><DataArray type='Float32' NumberOfComponents='3'>",
        3 * count, count, e ? e->points : "", e ? e->cells : "");
    for (size_t i = 0; i < 3 * count; i++) {
        const float *at = places[triangles[i / 3][i % 3]];
        add(text, "%g %g %g ", (double)at[0], (double)at[1], (double)at[2]);
    }
    add(text, "</DataArray></Points><Polys><DataArray type='Int32' Name='connectivity'>");
    for (size_t i = 0; i < 3 * count; i++)
        add(text, "%zu ", i);
    add(text, "</DataArray><DataArray type='Int32' Name='offsets'>");
    for (size_t i = 0; i < count; i++)
        add(text, "%zu ", 3 * (i + 1));
    add(text, "</DataArray></Polys></Piece>");
}

#define POLY_START "<VTKFile type='PolyData'><PolyData>"
#define POLY_END   "</PolyData></VTKFile>"

static void save(const char *name, const char *text)
{
    put_file(name, text, NULL, 0);
}

/* Writes a list of pieces. */
static void save_list(const char *name, const char *type, const char *const *files,
                      size_t count)
{
    char text[TEXT_BYTES] = "";
    add(text, "<VTKFile type='%s'><%s WholeExtent='0 4 0 2 0 2'>", type, type);
    for (size_t n = 0; n < count; n++)
        add(text, "<Piece Source='%s'/>", files[n]);
    add(text, "</%s></VTKFile>", type);
    save(name, text);
}

/* Saves a triangle a file, and the list of them. */
static void save_triangles(const char *list, const float (*places)[3],
                           const int (*triangles)[3], size_t count, const extra *extras)
{
    char names[16][16];
    const char *files[16];
    for (size_t n = 0; n < count; n++) {
        char text[TEXT_BYTES] = POLY_START;
        add_piece(text, places, triangles + n, 1, extras ? &extras[n] : NULL);
        add(text, POLY_END);
        snprintf(names[n], sizeof names[n], "t%zu.vtp", n);
        files[n] = names[n];
        save(files[n], text);
    }
    save_list(list, "PPolyData", files, count);
}

static const float corners[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                    {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
static const int tetrahedron[4][3] = {{0, 3, 1}, {0, 1, 4}, {0, 4, 3}, {1, 3, 4}};
static const int cube[12][3] = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7},
                                {0, 1, 5}, {0, 5, 4}, {1, 2, 6}, {1, 6, 5},
                                {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
static const int strip[3][3] = {{0, 1, 2}, {2, 1, 5}, {5, 6, 2}};

static void seams_are_closed(void **state)
{
    (void)state;
    static const struct {
        const int (*triangles)[3];
        size_t count, vertices;
        bool closed;
    } rows[] = {{tetrahedron, 4, 4, true}, {cube, 12, 8, true}, {strip, 3, 5, false}};
    for (size_t n = 0; n < 3; n++) {
        cw_mesh mesh;
        cw_mesh_file file;
        cw_error err = {0};
        save_triangles("a.pvtp", corners, rows[n].triangles, rows[n].count, NULL);
        assert_ok(cw_mesh_read(test_path("a.pvtp"), NULL, &mesh, &file, &err), err);
        assert_string_equal(file.format, "vtp");
        assert_int_equal(file.pieces, rows[n].count);
        assert_int_equal(file.merged_vertices, 3 * rows[n].count - rows[n].vertices);
        assert_int_equal(file.parts, 1);
        assert_int_equal(mesh.vertex_count, rows[n].vertices);
        assert_int_equal(mesh.triangle_count, rows[n].count);
        assert_int_equal(test_solid_fault(&mesh) == NULL, rows[n].closed);
        assert_usable(&mesh);
        cw_mesh_free(&mesh);
    }
}

/* Pieces of one file are joined as those of files are; what a piece has twice is not. */
static void a_file_may_have_pieces(void **state)
{
    (void)state;
    char text[TEXT_BYTES] = POLY_START;
    cw_mesh mesh;
    cw_error err = {0};
    add_piece(text, corners, cube, 6, NULL); /* its corners are all apart */
    add_piece(text, corners, cube + 6, 1, NULL);
    add(text, "<Piece NumberOfPoints='0' NumberOfPolys='0'/>");
    add_piece(text, corners, cube + 7, 1, NULL);
    add(text, POLY_END);
    assert_ok(read_text("a.vtp", text, &mesh, NULL, &err), err);
    assert_int_equal(mesh.triangle_count, 8);
    /* 18 and 6; of the last two, corners 1 and 6 are shared, where the first piece has 1 twice */
    assert_int_equal(mesh.vertex_count, 24 - 2);
    cw_mesh_free(&mesh);
}

#define IDS(a, b, c)                                                                           \
    {                                                                                          \
        "<DataArray type='Int64' Name='GlobalPointIds'>" #a " " #b " " #c "</DataArray>", ""   \
    }

static void ids_decide_which_vertices_are_one(void **state)
{
    (void)state;
    static const int two[2][3] = {{0, 1, 2}, {2, 1, 5}};
    static const extra same[2] = {IDS(7, 8, 9), IDS(9, 8, 3)},
                       other[2] = {IDS(7, 8, 9), IDS(9, 4, 3)},
                       lying[2] = {IDS(7, 8, 9), IDS(7, 8, 9)};
    const extra *rows[] = {same, other, lying};
    const size_t vertices[] = {4, 5,
                               5}; /* lying: corner 1 alone has id 8 at one place in both */
    for (size_t n = 0; n < 3; n++) {
        cw_mesh mesh;
        cw_error err = {0};
        save_triangles("a.pvtp", corners, two, 2, rows[n]);
        assert_ok(cw_mesh_read(test_path("a.pvtp"), NULL, &mesh, NULL, &err), err);
        assert_int_equal(mesh.vertex_count, vertices[n]);
        assert_null(mesh.scalars); /* the ids are none */
        cw_mesh_free(&mesh);
    }
}

#define MARK(name, value)                                                                      \
    {                                                                                          \
        "", "<DataArray type='UInt8' Name='" name "'>" value "</DataArray>"                    \
    }

static void cells_of_other_pieces_are_left_out(void **state)
{
    (void)state;
    static const extra types[3] = {MARK("vtkGhostType", "0"), MARK("vtkGhostType", "1"),
                                   MARK("vtkGhostType", "4")};
    static const extra levels[3] = {MARK("vtkGhostLevels", "0"), MARK("vtkGhostLevels", "1"),
                                    MARK("vtkGhostLevels", "2")};
    static const extra hidden[3] = {MARK("vtkGhostType", "32"), MARK("vtkGhostType", "0"),
                                    MARK("vtkGhostType", "8")};
    const extra *rows[] = {types, levels, hidden};
    const size_t left[] = {2, 1, 1},
                 vertices[] = {5, 3, 3}; /* 4: no triangle is blanked by it */
    for (size_t n = 0; n < 3; n++) {
        cw_mesh mesh;
        cw_mesh_file file;
        cw_error err = {0};
        save_triangles("a.pvtp", corners, strip, 3, rows[n]);
        assert_ok(cw_mesh_read(test_path("a.pvtp"), NULL, &mesh, &file, &err), err);
        assert_int_equal(mesh.triangle_count, left[n]);
        assert_int_equal(mesh.vertex_count, vertices[n]);
        assert_int_equal(file.marked_cells, 3 - left[n]);
        cw_mesh_free(&mesh);
    }
}

#define SHADE(a)                                                                               \
    {                                                                                          \
        "<DataArray type='Float32' Name='" a "'>1 2 3</DataArray>", ""                         \
    }
#define FACE                                                                                   \
    {                                                                                          \
        "", "<DataArray type='UInt8' Name='c' NumberOfComponents='3'>9 8 7</DataArray>"        \
    }

static void attributes_are_those_of_all_pieces(void **state)
{
    (void)state;
    static const int two[2][3] = {{0, 1, 2}, {4, 6, 5}};
    static const extra both[2] = {SHADE("s"), SHADE("s")}, one[2] = {SHADE("s"), {"", ""}},
                       differ[2] = {SHADE("s"), SHADE("t")}, last[2] = {{"", ""}, FACE};
    const extra *rows[] = {both, one, differ, last};
    for (size_t n = 0; n < 4; n++) {
        cw_mesh mesh;
        cw_mesh_file file;
        cw_error err = {0};
        save_triangles("a.pvtp", corners, two, 2, rows[n]);
        assert_ok(cw_mesh_read(test_path("a.pvtp"), NULL, &mesh, &file, &err), err);
        assert_int_equal(mesh.scalars != NULL, n == 0);
        assert_string_equal(file.left_out, n == 1 || n == 2 ? "scalars of some pieces" : "");
        if (n == 0)
            assert_true(mesh.scalars[5] == 3);
        if (n == 3) {
            const cw_attribute *faces = cw_mesh_attribute_find(&mesh, CW_FACE_COLORS);
            assert_non_null(faces);
            assert_int_equal(((const uint8_t *)faces->data)[0], 255);
            assert_int_equal(((const uint8_t *)faces->data)[4], 9);
        }
        cw_mesh_free(&mesh);
    }
}

static void lists_that_lie_are_told(void **state)
{
    (void)state;
    static const struct {
        const char *files[2];
        const char *words;
        cw_status status;
    } rows[] = {
        {{"t0.vtp", "none.vtp"}, "none.vtp", CW_ERR_IO},
        {{"t0.vtp", "../t1.vtp"}, "'..'", CW_ERR_UNSAFE},
        {{"t0.vtp", "/etc/passwd"}, "/etc/passwd", CW_ERR_UNSAFE},
        {{"t0.vtp", "t0.vtp"},
         "'t0.vtp' and 't0.vtp' are one file, listed twice",
         CW_ERR_FORMAT},
        {{"t0.vtp", "a.pvtp"}, "'a.pvtp' is the list itself", CW_ERR_FORMAT},
        {{"t0.vtp", "b.pvtp"}, "b.pvtp: the VTK file is 'PPolyData', a list", CW_ERR_FORMAT},
        {{"t0.vtp", "i.vti"}, "i.vti: the VTK file is 'ImageData'", CW_ERR_FORMAT},
        {{"t0.vtp", "bad.vtp"}, "bad.vtp: triangle 1 names vertex 3 of 3", CW_ERR_FORMAT},
    };
    char text[TEXT_BYTES] = POLY_START;
    save_triangles("b.pvtp", corners, strip, 2, NULL);
    save("i.vti", "<VTKFile type='ImageData'/>");
    add_piece(text, corners, cube, 1, NULL);
    add(text, POLY_END);
    *strstr(text, "0 1 2 <") = '3';
    save("bad.vtp", text);
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        cw_mesh mesh;
        cw_error err = {0};
        save_list("a.pvtp", "PPolyData", rows[n].files, 2);
        assert_fails(cw_mesh_read(test_path("a.pvtp"), NULL, &mesh, NULL, &err), rows[n].status,
                     rows[n].words, err);
    }
    cw_mesh mesh;
    cw_error err = {0};
    save_list("a.pvtp", "PPolyData", NULL, 0);
    assert_fails(cw_mesh_read(test_path("a.pvtp"), NULL, &mesh, NULL, &err), CW_ERR_FORMAT,
                 "PPolyData lists no Piece", err);
}

/* Many pieces may not name the same bytes. */
static void pieces_have_bytes_of_their_own(void **state)
{
    (void)state;
    char text[TEXT_BYTES] = "<VTKFile type='PolyData' byte_order='LittleEndian'><PolyData>";
    char bytes[604] = {0};
    cw_mesh mesh;
    cw_error err = {0};
    const uint32_t size = 600;
    memcpy(bytes, &size, sizeof size);
    for (int n = 0; n < 30; n++)
        add(text, "<Piece NumberOfPoints='50'><Points><DataArray type='Float32' "
                  "NumberOfComponents='3' format='appended' offset='0'/></Points></Piece>");
    add(text, "</PolyData><AppendedData encoding='raw'>_");
    const size_t used = strlen(text);
    memcpy(text + used, bytes, sizeof bytes);
    static const char end[] = "</AppendedData></VTKFile>";
    memcpy(text + used + sizeof bytes, end, sizeof end - 1);
    assert_fails(
        read_bytes("a.vtp", text, used + sizeof bytes + sizeof end - 1, &mesh, NULL, &err),
        CW_ERR_FORMAT, "some share theirs", err);
}

/* --- grids -------------------------------------------------------------------------------- */

/* Saves a tetrahedron with its apex at x = apex. */
static void save_cell(const char *name, int apex, const char *cells)
{
    char text[TEXT_BYTES] = "";
    add(text,
        "<VTKFile type='UnstructuredGrid'><UnstructuredGrid><Piece NumberOfPoints='4' "
        "NumberOfCells='1'><PointData><DataArray type='Float32' Name='s'>0 0 0 %d</DataArray>"
        "</PointData><CellData>%s</CellData><Points><DataArray type='Float32' "
        "NumberOfComponents='3'>0 0 0 0 1 0 0 0 1 %d 0 0</DataArray></Points><Cells><DataArray "
        "type='Int32' Name='connectivity'>%s</DataArray><DataArray type='Int32' "
        "Name='offsets'>4</DataArray><DataArray type='UInt8' Name='types'>10</DataArray></Cells>"
        "</Piece></UnstructuredGrid></VTKFile>",
        apex, cells, apex, apex > 0 ? "0 1 2 3" : "0 2 1 3");
    save(name, text);
}

static void grids_are_joined(void **state)
{
    (void)state;
    static const char *const files[] = {"c0.vtu", "c1.vtu"}, *const bad[] = {"c0.vtu",
                                                                             "c2.vtu"};
    cw_volume v;
    cw_error err = {0};
    for (int n = 0; n < 3; n++) {
        save_cell("c0.vtu", 1, "");
        save_cell("c1.vtu", -1,
                  n == 1   ? "<DataArray type='UInt8' Name='vtkGhostLevels'>1</DataArray>"
                  : n == 2 ? "<DataArray type='UInt8' Name='vtkGhostType'>1</DataArray>"
                           : "");
        save_list("a.pvtu", "PUnstructuredGrid", files, 2);
        assert_ok(read_back("a.pvtu", &v, &err), err);
        assert_int_equal(v.dim[0], 5); /* the three points between them are one each */
        assert_int_equal(v.cells->count, n == 0 ? 2 : 1);
        cw_volume_free(&v);
    }
    save_cell("c2.vtu", -1, "");
    save_list("a.pvtu", "PUnstructuredGrid", bad, 2);
    size_t size;
    char *text = test_file_read(test_path("c2.vtu"), &size);
    memcpy(strstr(text, "'>10<"), "'>99<", 5);
    test_file_write(test_path("c2.vtu"), text, size);
    free(text);
    assert_fails(read_back("a.pvtu", &v, &err), CW_ERR_FORMAT,
                 "a.pvtu: c2.vtu: cell 0 is of type 99", err);
}

/* Saves points first..last along x of a rectilinear grid of 5 x 3 x 3 points, values 10 x + z. */
static void save_slab(const char *name, int first, int last, double shift)
{
    char text[TEXT_BYTES] = "";
    add(text,
        "<VTKFile type='RectilinearGrid'><RectilinearGrid WholeExtent='0 4 0 2 0 2'><Piece "
        "Extent='%d %d 0 2 0 2'><PointData><DataArray type='Int16' Name='s'>",
        first, last);
    for (int n = 0; n < 9; n++)
        for (int x = first; x <= last; x++)
            add(text, "%d ", 10 * x + n / 3);
    add(text, "</DataArray></PointData><Coordinates><DataArray type='Float64'>");
    for (int x = first; x <= last; x++)
        add(text, "%g ", x * x + shift);
    add(text,
        "</DataArray><DataArray type='Float64'>3 2 0</DataArray><DataArray type='Float64'>"
        "0 1 5</DataArray></Coordinates></Piece></RectilinearGrid></VTKFile>");
    save(name, text);
}

static void rectilinear_pieces_are_joined(void **state)
{
    (void)state;
    static const char *const files[] = {"r1.vtr", "r0.vtr"}, *const one[] = {"r0.vtr"};
    const cw_box box = {.first = {1, 0, 1}, .count = {4, 2, 1}};
    const cw_read_desc part = {.region = &box}, head = {.header_only = true};
    cw_volume v;
    cw_error err = {0};
    save_slab("r0.vtr", 0, 2, 0);
    save_slab("r1.vtr", 2, 4, 0);
    save_list("a.pvtr", "PRectilinearGrid", files, 2);
    for (int n = 0; n < 3; n++) {
        const size_t shift = n == 1;
        assert_ok(cw_volume_read(test_path("a.pvtr"),
                                 n == 1   ? &part
                                 : n == 2 ? &head
                                          : NULL,
                                 &v, NULL, &err),
                  err);
        assert_int_equal(v.dim[0], n == 1 ? 4 : 5);
        assert_place(&v, 3 - (double)shift, 0, 1 - (double)shift, 9, 3, 1);
        if (n < 2)
            assert_true(cw_volume_value(&v, 3 - shift, 1, 1 - shift) == 31);
        cw_volume_free(&v);
    }
    save_slab("r1.vtr", 2, 4, 0.5);
    assert_fails(read_back("a.pvtr", &v, &err), CW_ERR_FORMAT,
                 "pieces differ: plane 2 along x is at", err);
    save_slab("r1.vtr", 3, 4, 0);
    assert_ok(read_back("a.pvtr", &v, &err), err); /* pieces may end where the next begins */
    cw_volume_free(&v);
    save_list("a.pvtr", "PRectilinearGrid", one, 1);
    assert_fails(read_back("a.pvtr", &v, &err), CW_ERR_FORMAT,
                 "has 5 points along x; all pieces have 3", err);
}

/* A whole that its pieces cannot fill takes no memory. */
static void a_whole_that_lies_takes_no_memory(void **state)
{
    (void)state;
    static const char list[] =
        "<VTKFile type='PImageData'><PImageData WholeExtent='0 40000 0 40000 0 400'><Piece "
        "Source='p.vti'/></PImageData></VTKFile>";
    static const struct {
        const char *extent, *words;
    } rows[] = {{"0 1 0 1 0 1", "all pieces together have 8"},
                {"0 40000 0 40000 0 400", "the file holds"}};
    cw_volume v;
    cw_error err = {0};
    save("a.pvti", list);
    for (size_t n = 0; n < 2; n++) {
        char text[TEXT_BYTES] = "";
        add(text,
            "<VTKFile type='ImageData'><ImageData WholeExtent='0 1 0 1 0 1'><Piece Extent='%s'>"
            "<PointData><DataArray type='UInt8' Name='s'>1 2 3 4 5 6 7 8</DataArray></PointData>"
            "</Piece></ImageData></VTKFile>",
            rows[n].extent);
        save("p.vti", text);
        assert_fails(read_back("a.pvti", &v, &err), CW_ERR_FORMAT, rows[n].words, err);
    }
}

/* --- blocks ------------------------------------------------------------------------------- */

static void save_blocks(const char *text)
{
    char all[TEXT_BYTES] = "";
    add(all,
        "<VTKFile type='vtkMultiBlockDataSet'><vtkMultiBlockDataSet>%s</vtkMultiBlockDataSet>"
        "</VTKFile>",
        text);
    save("a.vtm", all);
}

static void surfaces_are_parts_with_the_names_of_blocks(void **state)
{
    (void)state;
    static const char *const names[] = {"bone", "head/left/eye", "head/1", "skin"};
    cw_part *parts;
    size_t count;
    cw_mesh_file file;
    cw_error err = {0};
    save_triangles("b.pvtp", corners, strip, 3, NULL);
    save_triangles("b.pvtp", corners, cube, 5, NULL);
    save_cell("c0.vtu", 1, "");
    save_blocks(
        "<DataSet index='0' name='bone' file='t0.vtp'/><Block index='1' name='head'><Block "
        "name='left'><DataSet name='eye' file='t1.vtp'/><DataSet name='empty'/></Block>"
        "<DataSet index='1' file='t2.vtp'/></Block><DataSet name='grid' file='c0.vtu'/>"
        "<Piece name='skin'><DataSet index='0' file='t3.vtp'/><DataSet index='1' "
        "file='t4.vtp'/></Piece>");
    assert_ok(cw_parts_read(test_path("a.vtm"), NULL, &parts, &count, &file, &err), err);
    assert_string_equal(file.format, "vtm");
    assert_int_equal(count, 4);
    for (size_t n = 0; n < 4; n++) {
        assert_string_equal(parts[n].name, names[n]);
        assert_int_equal(parts[n].mesh->triangle_count, n == 3 ? 2 : 1);
    }
    assert_string_equal(file.left_out, "blocks that are volumes: 1, such as 'grid'");
    cw_parts_free(parts, count);
}

static void a_volume_is_chosen_among_blocks(void **state)
{
    (void)state;
    static const struct {
        const char *array;
        double dim;
        const char *words; /* of the message; NULL: it is read */
    } rows[] = {{NULL, 4, NULL},
                {"in/c", 4, NULL},
                {"r", 3, NULL},
                {"r/s", 3, NULL},
                {"r/x", 0, "no array 'x'"},
                {"x", 0, "no block is called 'x'; those with volumes are 'in/c', 'r'"}};
    cw_array *arrays;
    size_t count;
    cw_volume v;
    cw_error err = {0};
    save_cell("c0.vtu", 1, "");
    save_slab("r0.vtr", 0, 2, 0);
    save_triangles("b.pvtp", corners, strip, 1, NULL);
    save_blocks("<DataSet name='s' file='t0.vtp'/><Block name='in'><DataSet name='c' "
                "file='c0.vtu'/></Block><DataSet name='r' file='r0.vtr'/>");
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        const cw_read_desc desc = {.array = rows[n].array};
        const cw_status st = cw_volume_read(test_path("a.vtm"), &desc, &v, NULL, &err);
        if (rows[n].words) {
            assert_fails(st, CW_ERR_ARGUMENT, rows[n].words, err);
            continue;
        }
        assert_ok(st, err);
        assert_true((double)v.dim[0] == rows[n].dim);
        cw_volume_free(&v);
    }
    assert_ok(cw_arrays_list(test_path("a.vtm"), NULL, &arrays, &count, &err), err);
    assert_int_equal(count, 2);
    assert_string_equal(arrays[0].name, "in/c");
    assert_true(arrays[0].is_default && !arrays[1].is_default);
    cw_arrays_free(arrays);
    save_blocks("<DataSet name='r' file='r0.vtr'/>");
    assert_ok(cw_volume_read(test_path("a.vtm"), &(cw_read_desc){.array = "s"}, &v, NULL, &err),
              err);
    cw_volume_free(&v);
}

static void blocks_that_lie_are_told(void **state)
{
    (void)state;
    static const struct {
        const char *blocks, *words;
    } rows[] = {
        {"", "none of its blocks names a file"},
        {"<DataSet file='none.vtp'/>", "none.vtp"},
        {"<DataSet file='../t0.vtp'/>", "'..'"},
        {"<DataSet file='a.vtm'/>", "'a.vtm' is the list itself"},
        {"<DataSet name='x' file='b.vtm'/>",
         "the file 'b.vtm' of block 'x' is none of PolyData"},
        {"<DataSet file='t0.vtp'/><DataSet file='t0.vtp'/>", "one file, listed twice"},
        {"<DataSet file='c0.vtu'/>", "its blocks are volumes, such as '0'"},
        {"<DataSet file='b.pvtp'/>", "b.pvtp: the VTK file is 'PPolyData', a list"},
    };
    cw_mesh mesh;
    cw_volume v;
    cw_error err = {0};
    save_cell("c0.vtu", 1, "");
    save_triangles("b.pvtp", corners, strip, 2, NULL);
    save_blocks("<DataSet file='c0.vtu'/>");
    size_t size;
    char *text = test_file_read(test_path("a.vtm"), &size);
    test_file_write(test_path("b.vtm"), text, size);
    free(text);
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        save_blocks(rows[n].blocks);
        const cw_status st = cw_mesh_read(test_path("a.vtm"), NULL, &mesh, NULL, &err);
        if (st == CW_OK || !strstr(err.message, rows[n].words))
            fail_msg("row %zu says: %s; not: %s", n, st == CW_OK ? "read" : err.message,
                     rows[n].words);
    }
    save_blocks("<DataSet file='t0.vtp'/>");
    assert_fails(read_back("a.vtm", &v, &err), CW_ERR_FORMAT, "its blocks are surfaces", err);
    save("a.vtm", "<VTKFile type='vtkHierarchicalBoxDataSet'/>");
    assert_fails(read_back("a.vtm", &v, &err), CW_ERR_FORMAT, "a list of other files", err);
}

static void memory_may_run_out_anywhere(void **state)
{
    (void)state;
    static const char *const slabs[] = {"r0.vtr", "r1.vtr"}, *const cells[] = {"c0.vtu",
                                                                               "c1.vtu"};
    static const extra ids[2] = {IDS(7, 8, 9), IDS(9, 8, 3)};
    save_triangles("a.pvtp", corners, strip, 2, ids);
    check_starved_mesh_reads("a.pvtp");
    save_blocks("<DataSet file='t0.vtp'/><Block name='b'><DataSet file='t1.vtp'/></Block>");
    check_starved_mesh_reads("a.vtm");
    save_slab("r0.vtr", 0, 2, 0);
    save_slab("r1.vtr", 2, 4, 0);
    save_list("a.pvtr", "PRectilinearGrid", slabs, 2);
    check_starved("a.pvtr", NULL);
    save_cell("c0.vtu", 1, "");
    save_cell("c1.vtu", -1, "");
    save_list("a.pvtu", "PUnstructuredGrid", cells, 2);
    check_starved("a.pvtu", NULL);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(seams_are_closed),
        TEST(a_file_may_have_pieces),
        TEST(ids_decide_which_vertices_are_one),
        TEST(cells_of_other_pieces_are_left_out),
        TEST(attributes_are_those_of_all_pieces),
        TEST(lists_that_lie_are_told),
        TEST(pieces_have_bytes_of_their_own),
        TEST(grids_are_joined),
        TEST(rectilinear_pieces_are_joined),
        TEST(a_whole_that_lies_takes_no_memory),
        TEST(surfaces_are_parts_with_the_names_of_blocks),
        TEST(a_volume_is_chosen_among_blocks),
        TEST(blocks_that_lie_are_told),
        TEST(memory_may_run_out_anywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
