/* VTP read: every dialect of VTK's XML, and files that lie. */
#include "support/files/vtk_xml.h"
#include "support/meshes.h"

#include <math.h>

/* --- files put together in every dialect ------------------------------------------------- */

enum { POINT_COUNT = 6 };

static const float points[3 * POINT_COUNT] = {0, 0, 0, 1, 0, 0, 1, 1, 0,
                                              0, 1, 0, 0, 2, 0, 1, 2, 0.5f};

/* A quadrilateral, two corners, a triangle; and a strip of four. */
static const int polygons[] = {0, 1, 2, 3, 0, 1, 3, 2, 4}, polygon_ends[] = {4, 6, 9};
static const int strip[] = {3, 2, 4, 5}, strip_ends[] = {4};
static const uint32_t triangles[] = {0, 1, 2, 0, 2, 3, 3, 2, 4, 3, 2, 4, 2, 5, 4};

/* One array of the file: its numbers as they are written in text, and their type. */
typedef struct array {
    const char *tag, *type;
    size_t components, count; /* numbers in all */
    double numbers[3 * POINT_COUNT];
} array;

static size_t type_size(const char *type)
{
    return strstr(type, "64") ? 8 : strstr(type, "32") ? 4 : strstr(type, "16") ? 2 : 1;
}

static void add_value(byte_buffer *plain, const char *type, double value, bool big)
{
    const float single = (float)value;
    uint32_t bits32;
    uint64_t bits = (uint64_t)(int64_t)value;
    memcpy(&bits32, &single, sizeof bits32);
    if (strcmp(type, "Float32") == 0)
        bits = bits32;
    if (strcmp(type, "Float64") == 0)
        memcpy(&bits, &value, sizeof bits);
    add_number(plain, bits, type_size(type), big);
}

/* The array's element; appended, its bytes go behind those that are there. */
static void add_array(byte_buffer *file, byte_buffer *appended, const dialect *d,
                      const array *a)
{
    char text[300];
    byte_buffer plain = {.size = 0};
    for (size_t i = 0; i < a->count; i++)
        add_value(&plain, a->type, a->numbers[i], d->big);
    snprintf(text, sizeof text, "<%s type='%s' NumberOfComponents='%zu' format='%s' ", a->tag,
             a->type, a->components, form_names[d->form]);
    add_text(file, text);
    if (d->form >= APPENDED_TEXT) {
        snprintf(text, sizeof text, "offset='%zu'/>", appended->size);
        add_text(file, text);
        add_payload(appended, d, &plain, d->form == APPENDED_TEXT);
        return;
    }
    add_text(file, ">");
    for (size_t i = 0; i < a->count && d->form == ASCII; i++) {
        snprintf(text, sizeof text, " %.9g", a->numbers[i]);
        add_text(file, text);
    }
    if (d->form == INLINE)
        add_payload(file, d, &plain, true);
    add_text(file, "\n</DataArray>");
}

static array whole_array(const char *tag, const char *type, const int *numbers, size_t count)
{
    array a = {tag, type, 1, count, {0}};
    for (size_t i = 0; i < count; i++)
        a.numbers[i] = numbers[i];
    return a;
}

static array real_array(const char *tag, const char *type, size_t components,
                        const float *numbers, size_t count)
{
    array a = {tag, type, components, count, {0}};
    for (size_t i = 0; i < count; i++)
        a.numbers[i] = (double)numbers[i];
    return a;
}

/* real and whole are the types of points and of indices. */
static void make_file(const dialect *d, const char *real, const char *whole, byte_buffer *file)
{
    static const int label[] = {0, 1, 2, 3, 4, 4000000}, scalar[] = {-3, 2, 1, 0, 9, 7};
    static const int colors[] = {1,  2,  3,  4,  5,  6,  7,  8,  9,
                                 10, 11, 12, 13, 14, 15, 16, 17, 255};
    static byte_buffer appended;
    array rgb = whole_array("DataArray Name='odd colours'", "UInt8", colors, 18);
    rgb.components = 3;
    appended.size = file->size = 0;
    add_text(&appended, d->form == APPENDED_RAW ? "_<&<" : "_AAAA");
    appended.size -= 1; /* offsets count from behind the underscore */
    memmove(appended.at, appended.at + 1, appended.size);
    add_file_tag(file, d, "PolyData");
    add_text(file,
             "<PolyData><FieldData><DataArray type='Float64' Name='t'>1</DataArray>"
             "</FieldData><Piece NumberOfPoints='6' NumberOfVerts='1' NumberOfLines='2' "
             "NumberOfStrips='1' NumberOfPolys='3'>"
             "<PointData Scalars='shade'><DataArray type='String' Name='s'>65</DataArray>");
    const array arrays[] = {
        real_array("DataArray Name='Normals'", "Float32", 3, points, 18),
        rgb,
        whole_array("DataArray Name='other'", "Int8", label, 6),
        whole_array("DataArray Name='label'", whole, label, 6),
        whole_array("DataArray Name='shade'", "Int16", scalar, 6),
    };
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        add_array(file, &appended, d, &arrays[i]);
    add_text(file, "</PointData><CellData><DataArray type='UInt8' Name='RGB' "
                   "format='ascii' NumberOfComponents='3'>1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 "
                   "16 17 18 19 20 21</DataArray></CellData><Points>");
    const array positions = real_array("DataArray", real, 3, points, 18);
    const array corners = whole_array("DataArray Name='connectivity'", whole, polygons, 9);
    const array ends = whole_array("DataArray Name='offsets'", whole, polygon_ends, 3);
    const array strips = whole_array("DataArray Name='connectivity'", whole, strip, 4);
    const array strips_end = whole_array("DataArray Name='offsets'", whole, strip_ends, 1);
    add_array(file, &appended, d, &positions);
    add_text(file, "</Points><Verts><DataArray Name='connectivity' type='Int32'>0</DataArray>"
                   "</Verts><Strips>");
    add_array(file, &appended, d, &strips);
    add_array(file, &appended, d, &strips_end);
    add_text(file, "</Strips><Polys>");
    add_array(file, &appended, d, &corners);
    add_array(file, &appended, d, &ends);
    add_text(file, "</Polys></Piece></PolyData>");
    if (d->form >= APPENDED_TEXT) {
        add_text(file, d->form == APPENDED_RAW ? "<AppendedData encoding='raw'>\n _"
                                               : "<AppendedData encoding='base64'>_");
        add(file, appended.at, appended.size);
        add_text(file, "\n</AppendedData>");
    }
    add_text(file, "</VTKFile>\n");
}

static void check_file(const char *name)
{
    static const float scalars[] = {-3, 2, 1, 0, 9, 7};
    cw_mesh mesh;
    cw_mesh_file file;
    cw_error err = {0};
    assert_ok(cw_mesh_read(test_path(name), NULL, &mesh, &file, &err), err);
    assert_string_equal(file.format, "vtp");
    assert_int_equal(file.known, 0);
    assert_int_equal(file.skipped, 1 + 2 + 1);
    assert_int_equal(file.polygons, 1);
    assert_usable(&mesh);
    check_positions(&mesh, POINT_COUNT, points);
    check_triangles(&mesh, 5, triangles);
    assert_true(mesh.normals && mesh.colors && mesh.scalars && mesh.labels);
    assert_memory_equal(mesh.normals, points, sizeof points);
    assert_memory_equal(mesh.scalars, scalars, sizeof scalars);
    for (size_t i = 0; i < 4 * POINT_COUNT; i++)
        assert_int_equal(mesh.colors[i], i % 4 == 3      ? 255
                                         : i < 4 * 5 + 2 ? i / 4 * 3 + i % 4 + 1
                                                         : 255);
    assert_int_equal(mesh.labels[5], 4000000);
    cw_mesh_free(&mesh);
}

/* --- tests ------------------------------------------------------------------------------- */

static void every_dialect_gives_the_same_mesh(void **state)
{
    (void)state;
    static const char *const reals[] = {"Float32", "Float64"};
    static const char *const wholes[] = {"Int32", "Int64", "UInt32", "UInt64"};
    static byte_buffer file;
    for (unsigned n = 0; n < 128; n++) {
        const dialect d = dialect_of(n);
        if (!is_read(&d))
            continue;
        for (unsigned t = n / 4 % 2; t < 8; t += 2) {
            make_file(&d, reals[(t + n) / 2 % 2], wholes[t / 2], &file);
            save(&file, "a.bin");
            check_file("a.bin");
        }
    }
}

/* A cut file is an error, unless nothing but the line end is gone. */
static void a_cut_is_never_a_mesh(void **state)
{
    (void)state;
    static byte_buffer file;
    for (unsigned n = 0; n < FORM_COUNT; n++) {
        const dialect d = {.form = (form)n, .packing = n % 2 ? ZLIB : PLAIN};
        make_file(&d, "Float32", "Int64", &file);
        for (size_t cut = 1; cut + 1 < file.size; cut += test_is_short() ? 7 : 1) {
            cw_mesh mesh;
            cw_error err = {0};
            if (read_bytes("a.vtp", file.at, cut, &mesh, NULL, &err) != CW_ERR_FORMAT)
                fail_msg("form %d, packing %d, cut at %zu of %zu: %s", d.form, d.packing, cut,
                         file.size, err.message);
            assert_null(mesh.positions);
        }
    }
}

static void no_byte_is_trusted(void **state)
{
    (void)state;
    static byte_buffer file;
    for (unsigned n = 0; n < 2; n++) {
        const dialect d = {.form = n ? APPENDED_RAW : ASCII, .packing = n ? ZLIB : PLAIN};
        make_file(&d, "Float32", "Int32", &file);
        for (size_t i = 0; i < file.size; i += test_is_short() ? 9 : 1) {
            cw_mesh mesh;
            cw_error err = {0};
            const unsigned char kept = file.at[i];
            file.at[i] ^= 0x11;
            if (read_bytes("a.vtp", file.at, file.size, &mesh, NULL, &err) == CW_OK)
                assert_usable(&mesh);
            cw_mesh_free(&mesh);
            file.at[i] = kept;
        }
    }
}

#define HEAD   "<VTKFile type='PolyData' byte_order='LittleEndian'><PolyData>"
#define PIECE  HEAD "<Piece NumberOfPoints='3' NumberOfPolys='1'>"
#define POINTS "<Points><DataArray type='Float32' NumberOfComponents='3'>"
#define PLACES PIECE POINTS "0 0 0 1 0 0 0 1 0</DataArray></Points>"
#define POLYS  PLACES "<Polys><DataArray type='Int32' Name='connectivity'>"
#define ENDS   "</DataArray><DataArray type='Int32' Name='offsets'>"
#define END    "</DataArray></Polys></Piece></PolyData></VTKFile>"

static void damaged_files_are_told_where(void **state)
{
    (void)state;
    static const refused rows[] = {
        {"<VTKFile type='PolyData'", "line 1 is not XML"},
        {"<VTKFile type='PolyData' byte_order='LittleEndian'/>", "PolyData holds no Piece"},
        {HEAD "<Piece NumberOfPoints='-1'>", "'NumberOfPoints' is '-1'"},
        {HEAD "<Piece NumberOfPolys='99999999999999999999'>", "'NumberOfPolys' is '9999"},
        {PIECE "</Piece></PolyData></VTKFile>",
         "'NumberOfPoints' is 3; the array for them is missing"},
        {PIECE POINTS "0 0 0 1 0 0 0 1</DataArray></Points></Piece></PolyData></VTKFile>",
         "'NumberOfPoints' asks for 36 bytes of numbers"},
        {PIECE POINTS "0 0 0 1 0 0 0 1 x</DataArray></Points></Piece></PolyData></VTKFile>",
         "number 9 of the numbers is 'x'"},
        {HEAD "<Piece NumberOfPoints='3'>" POINTS
              "0 0 0 1 0 0 0 1 nan</DataArray></Points></Piece></PolyData></VTKFile>",
         "'z' of vertex 2 is nan"},
        {PIECE "<Points><DataArray type='Float32' NumberOfComponents='2'>",
         "has 2 numbers of type 'Float32'; 3 were expected"},
        {PIECE "<Points><DataArray type='Half' NumberOfComponents='3'>",
         "has 3 numbers of type 'Half'; 3 were expected"},
        {PLACES "</Piece></PolyData></VTKFile>",
         "'NumberOfPolys' is 1; the array for them is missing"},
        {PLACES "<Polys><DataArray type='Float32' Name='offsets'>",
         "'offsets' has 1 numbers of type 'Float32'; 1 whole one was expected"},
        {POLYS "0 1 2" ENDS "4" END, "'offsets' asks for 16 bytes of numbers"},
        {POLYS "0 1 2" ENDS "-3" END, "number 0 of 'NumberOfPolys' ends at -3, behind 0"},
        {POLYS "0 1 3" ENDS "3" END, "triangle 0 names vertex 3 of 3"},
        {POLYS "0 1 -1" ENDS "3" END, "names vertex -1, which cannot be"},
        {POLYS "0 1 2.5" ENDS "3" END, "number 3 of the numbers is '2.5'; i32 cannot hold it"},
        {HEAD "<Piece NumberOfPoints='1000000000000'>" POINTS "1</DataArray></Points></Piece>"
              "</PolyData></VTKFile>",
         "'NumberOfPoints' asks for 12000000000000 bytes of numbers, encoded; the file holds"},
        {"<VTKFile type='PolyData'><PolyData><Piece NumberOfPoints='1'><Points><DataArray "
         "type='Float32' NumberOfComponents='3' format='binary'>DAAAAAAAAAAAAAAAAAAAAA=="
         "</DataArray></Points></Piece></PolyData></VTKFile>",
         "'byte_order' is missing"},
        {HEAD "<Piece NumberOfPoints='1'><Points><DataArray type='Float32' format='binary' "
              "NumberOfComponents='3'>DQAAAAAAAAAAAAAAAAAAAA==</DataArray></Points></Piece>"
              "</PolyData></VTKFile>",
         "the array '' has 13 bytes; 'NumberOfPoints' and 'type' ask for 12"},
    };
    check_refused("a.vtp", rows, sizeof rows / sizeof *rows);
}

static void ends_may_not_go_back(void **state)
{
    (void)state;
    static const refused rows[] = {
        {HEAD "<Piece NumberOfPoints='3' NumberOfPolys='2'>" POINTS
              "0 0 0 1 0 0 0 1 0</DataArray></Points><Polys><DataArray type='Int32' "
              "Name='connectivity'>0 1 2" ENDS "3 2" END,
         "number 1 of 'NumberOfPolys' ends at 2, behind 3"},
        {HEAD "<Piece NumberOfPoints='3' NumberOfPolys='1'>" POINTS
              "0 0 0 1 0 0 0 1 0</DataArray></Points><Polys><DataArray type='Int32' "
              "Name='connectivity'>0 1 2</DataArray><DataArray type='Int64' Name='offsets'>"
              "99999999999999999999" END,
         "ends at -1, behind 0"},
    };
    check_refused("a.vtp", rows, sizeof rows / sizeof *rows);
}

static void more_than_memory_has_addresses_is_over_the_limit(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_error err = {0};
    assert_fails(read_text("a.vtp",
                           HEAD "<Piece NumberOfPoints='2000000000000000000'>" POINTS
                                "1</DataArray></Points></Piece></PolyData></VTKFile>",
                           &mesh, NULL, &err),
                 CW_ERR_LIMIT, "more numbers than an address space holds", err);
}

static void other_kinds_and_document_types_are_refused(void **state)
{
    (void)state;
    const cw_mesh_read_desc vtp = {.reader = "vtp"};
    static const char image[] = "<VTKFile type='ImageData'/>";
    static const char doctype[] = "<!DOCTYPE x [<!ENTITY a 'b'>]>" PIECE;
    cw_mesh mesh;
    cw_error err = {0};
    test_file_write(test_path("a"), image, strlen(image));
    assert_fails(cw_mesh_read(test_path("a"), &vtp, &mesh, NULL, &err), CW_ERR_FORMAT,
                 "the VTK file is 'ImageData'; only PolyData is a surface", err);
    test_file_write(test_path("a"), doctype, strlen(doctype));
    assert_fails(cw_mesh_read(test_path("a"), &vtp, &mesh, NULL, &err), CW_ERR_UNSAFE,
                 "a document type", err);
}

/* Nothing at all, points alone, and polygons of nothing are meshes without triangles. */
static void a_file_may_be_empty(void **state)
{
    (void)state;
    static const char *const texts[] = {
        HEAD "<Piece/></PolyData></VTKFile>",
        HEAD "<Piece NumberOfPoints='0' NumberOfPolys='0'><Points><DataArray type='Float32' "
             "NumberOfComponents='3' format='binary'>AAAAAA==</DataArray></Points></Piece>"
             "</PolyData></VTKFile>",
        HEAD "<Piece NumberOfPoints='3' NumberOfPolys='2'>" POINTS
             "0 0 0 1 0 0 0 1 0</DataArray></Points><Polys><DataArray type='Int32' "
             "Name='connectivity'>1" ENDS "0 1" END,
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        cw_mesh mesh;
        cw_error err = {0};
        assert_ok(read_text("a.vtp", texts[i], &mesh, NULL, &err), err);
        assert_int_equal(mesh.triangle_count, 0);
        assert_int_equal(mesh.vertex_count, i == 2 ? 3 : 0);
        cw_mesh_free(&mesh);
    }
}

/* Among arrays of one kind the one that PointData names, else the first. */
static void named_arrays_go_before_others(void **state)
{
    (void)state;
    static const struct {
        const char *attributes;
        float scalar;
        bool normals;
    } rows[] = {
        {"", 1, false}, {"Scalars='b'", 2, false}, {"Scalars='c' Normals='n'", 1, true}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char text[900];
        cw_mesh mesh;
        cw_error err = {0};
        snprintf(text, sizeof text,
                 HEAD "<Piece NumberOfPoints='1'><PointData %s><DataArray type='Float32' "
                      "Name='a'>1</DataArray><DataArray type='UInt8' Name='b'>2</DataArray>"
                      "<DataArray type='Float64' Name='n' NumberOfComponents='3'>0 0 1"
                      "</DataArray></PointData>" POINTS "1 2 3</DataArray></Points></Piece>"
                      "</PolyData></VTKFile>",
                 rows[i].attributes);
        assert_ok(read_text("a.vtp", text, &mesh, NULL, &err), err);
        assert_true(mesh.scalars && mesh.scalars[0] == rows[i].scalar);
        assert_true(!mesh.normals == !rows[i].normals);
        cw_mesh_free(&mesh);
    }
}

static void far_doubles_get_an_origin(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_error err = {0};
    assert_ok(read_text("a.vtp",
                        HEAD "<Piece NumberOfPoints='2'><Points><DataArray type='Float64' "
                             "NumberOfComponents='3'>1e6 0 0 1000000.001 0 0</DataArray>"
                             "</Points></Piece></PolyData></VTKFile>",
                        &mesh, NULL, &err),
              err);
    assert_near(mesh.origin[0], 1000000.0005, 1e-9);
    assert_near((double)mesh.positions[3] - (double)mesh.positions[0], 0.001, 1e-9);
    cw_mesh_free(&mesh);
}

static void memory_may_run_out_anywhere(void **state)
{
    (void)state;
    static byte_buffer file;
    for (form f = ASCII; f < FORM_COUNT; f++) {
        const dialect d = {.form = f, .packing = ZLIB, .big = true};
        make_file(&d, "Float64", "Int64", &file);
        save(&file, "a.vtp");
        check_starved_mesh_reads("a.vtp");
    }
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(every_dialect_gives_the_same_mesh),
        TEST(a_cut_is_never_a_mesh),
        TEST(no_byte_is_trusted),
        TEST(damaged_files_are_told_where),
        TEST(ends_may_not_go_back),
        TEST(more_than_memory_has_addresses_is_over_the_limit),
        TEST(other_kinds_and_document_types_are_refused),
        TEST(a_file_may_be_empty),
        TEST(named_arrays_go_before_others),
        TEST(far_doubles_get_an_origin),
        TEST(memory_may_run_out_anywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
