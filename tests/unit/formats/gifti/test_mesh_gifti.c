/* Tests the GIfTI reader and writer: encodings, orders, frames, labels, and files that lie. */
#include "formats/bytes/base64.h"
#include "support/files/reading.h"
#include "support/meshes.h"

#include <stdarg.h>

enum { TEXT_BYTES = 20000 };

static const float places[12] = {1, 2, 3, 4, 2, 3, 1, 6, 3, 1, 2, 9.5f};
static const int32_t corners[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
static const float turned[12] = {-1, -2, 3, -4, -2, 3, -1, -6, 3, -1, -2, 9.5f}; /* LPS */

/* The form of an array in the file. */
typedef struct form {
    const char *encoding;
    bool big, columns, wide; /* wide: numbers of 64 bits */
} form;

static const form plain = {"ASCII", false, false, false};

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

/* Puts number n of an array of 4 x 3, in the order of the file; returns its end. */
static unsigned char *put_number(unsigned char *to, const form *f, bool real, size_t n)
{
    const size_t at = f->columns ? n % 4 * 3 + n / 4 : n, size = f->wide ? 8 : 4;
    const double wide_place = (double)places[at];
    const int64_t wide_corner = corners[at];
    unsigned char bytes[8];
    const void *from =
        real ? (f->wide ? (const void *)&wide_place : (const void *)&places[at])
             : (f->wide ? (const void *)&wide_corner : (const void *)&corners[at]);
    memcpy(bytes, from, size);
    for (size_t i = 0; i < size; i++)
        *to++ = bytes[f->big ? size - 1 - i : i];
    return to;
}

/* Adds the numbers; those of a file beside it are written there. */
static void add_numbers(char *text, const form *f, bool real)
{
    unsigned char bytes[100], *end = bytes;
    char coded[400];
    for (size_t n = 0; n < 12; n++)
        end = put_number(end, f, real, n);
    size_t size = (size_t)(end - bytes);
    if (strcmp(f->encoding, "ASCII") == 0) {
        for (size_t n = 0; n < 12; n++) {
            const size_t at = f->columns ? n % 4 * 3 + n / 4 : n;
            add(text, "%g ", real ? (double)places[at] : (double)corners[at]);
        }
    } else if (strcmp(f->encoding, "ExternalFileBinary") == 0) {
        put_file(real ? "p.bin" : "t.bin", "1234567", bytes, size);
    } else if (strcmp(f->encoding, "Base64Binary") == 0) {
        coded[cwi_base64_encode(bytes, size, coded)] = '\0';
        add(text, "%s", coded);
    } else {
        unsigned char *packed = pack_bytes(bytes, size, f->big, &size);
        coded[cwi_base64_encode(packed, size, coded)] = '\0';
        add(text, "\n%s\n", coded);
        free(packed);
    }
}

static void add_array(char *text, const form *f, bool real, const char *inside)
{
    add(text,
        "<DataArray Intent='NIFTI_INTENT_%s' DataType='NIFTI_TYPE_%s%d' ArrayIndexingOrder='%s' "
        "Dimensionality='2' Dim0='4' Dim1='3' Encoding='%s' Endian='%s' ExternalFileName='%s' "
        "ExternalFileOffset='%s'>%s<Data>",
        real ? "POINTSET" : "TRIANGLE", real ? "FLOAT" : "INT", f->wide ? 64 : 32,
        f->columns ? "ColumnMajorOrder" : "RowMajorOrder", f->encoding,
        f->big ? "BigEndian" : "LittleEndian", real ? "p.bin" : "t.bin",
        f->encoding[0] == 'E' ? "7" : "", inside);
    add_numbers(text, f, real);
    add(text, "</Data></DataArray>\n");
}

#define START                                                                                  \
    "<?xml version='1.0'?>\n<!DOCTYPE GIFTI SYSTEM 'http://www.nitrc.org/gifti.dtd'>\n"        \
    "<GIFTI Version='1.0' NumberOfDataArrays='2'>"

/* A tetrahedron; inside: elements in the array of points, behind: arrays behind the two. */
static void make_file(char *text, const form *f, const char *inside, const char *behind)
{
    strcpy(text, START);
    add_array(text, f, true, inside);
    add_array(text, f, false, "");
    add(text, "%s</GIFTI>\n", behind);
}

static void check_surface(const cw_mesh *mesh)
{
    uint32_t expected[12];
    for (size_t i = 0; i < 12; i++)
        expected[i] = (uint32_t)corners[i];
    check_positions(mesh, 4, turned);
    check_triangles(mesh, 4, expected);
}

static void every_form_is_read(void **state)
{
    (void)state;
    static const char *const encodings[] = {"ASCII", "Base64Binary", "GZipBase64Binary",
                                            "ExternalFileBinary"};
    for (int n = 0; n < 4 * 8; n++) {
        const form f = {encodings[n % 4], n & 4, n & 8, n & 16};
        char text[TEXT_BYTES];
        cw_mesh mesh;
        cw_mesh_file file;
        cw_error err = {0};
        make_file(text, &f, "", "");
        assert_ok(read_text("a.txt", text, &mesh, &file, &err), err); /* content decides */
        assert_string_equal(file.format, "gifti");
        assert_true(file.axes.ras && file.known == (CW_KNOWN_UNIT | CW_KNOWN_FRAME));
        assert_string_equal(file.placed, "");
        assert_string_equal(file.left_out, "");
        check_surface(&mesh);
        cw_mesh_free(&mesh);
    }
}

static void external_files_stay_in_the_folder(void **state)
{
    (void)state;
    static const form f = {"ExternalFileBinary", false, false, false};
    char text[TEXT_BYTES];
    cw_mesh mesh;
    cw_error err = {0};
    make_file(text, &f, "", "");
    memcpy(strstr(text, "p.bin"), "q.bin", 5);
    assert_fails(read_text("a.gii", text, &mesh, NULL, &err), CW_ERR_IO, "q.bin", err);
    memcpy(strstr(text, "q.bin"), "../pb", 5);
    assert_fails(read_text("a.gii", text, &mesh, NULL, &err), CW_ERR_UNSAFE, "'..'", err);
    memcpy(strstr(text, "../pb"), "t.bin", 5);
    memcpy(strstr(text, "Dim0='4'"), "Dim0='5'", 8);
    assert_fails(read_text("a.gii", text, &mesh, NULL, &err), CW_ERR_FORMAT,
                 "NIFTI_INTENT_POINTSET: t.bin: 'Dim0, Dim1' asks for 60 bytes", err);
}

#define MATRIX(from, to, numbers)                                                              \
    "<CoordinateSystemTransformMatrix><DataSpace><![CDATA[" from                               \
    "]]></DataSpace><TransformedSpace>" to "</TransformedSpace><MatrixData>\n" numbers         \
    "\n</MatrixData></CoordinateSystemTransformMatrix>"
#define UNKNOWN "NIFTI_XFORM_UNKNOWN"
#define SCANNER "NIFTI_XFORM_SCANNER_ANAT"
#define SHIFT   "1 0 0 10\n0 1 0 20\n0 0 1 -30\n0 0 0 1"

static void the_way_to_the_scanner_is_applied(void **state)
{
    (void)state;
    static const struct {
        const char *inside;
        double origin[3];
        float first[3]; /* vertex */
        bool mirrored;
        const char *placed;
    } rows[] = {
        {MATRIX(UNKNOWN, SCANNER, SHIFT),
         {-10, -20, -30},
         {-1, -2, 3},
         false,
         "MatrixData: a shift by (10, 20, -30) mm, RAS"},
        {MATRIX("", SCANNER, SHIFT),
         {-10, -20, -30},
         {-1, -2, 3},
         false,
         "MatrixData: a shift by (10, 20, -30) mm, RAS"},
        {MATRIX(SCANNER, SCANNER, SHIFT), {0}, {-1, -2, 3}, false, ""},
        {MATRIX(UNKNOWN, "NIFTI_XFORM_TALAIRACH", SHIFT), {0}, {-1, -2, 3}, false, ""},
        {MATRIX(UNKNOWN, "NIFTI_XFORM_TALAIRACH", "2 0 0 1 0 2 0 1 0 0 2 1 0 0 0 1")
             MATRIX(UNKNOWN, SCANNER, SHIFT),
         {-10, -20, -30},
         {-1, -2, 3},
         false,
         "MatrixData: a shift by (10, 20, -30) mm, RAS"},
        {MATRIX(UNKNOWN, SCANNER, "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"),
         {0},
         {-1, -2, 3},
         false,
         ""},
        {MATRIX(UNKNOWN, SCANNER, "0 1 0 5 -1 0 0 0 0 0 1 0 0 0 0 1"),
         {0},
         {-7, 1, 3},
         false,
         "MatrixData: a turn and a shift by (5, 0, 0) mm, RAS"},
        {MATRIX(UNKNOWN, SCANNER, "-1 0 0 5 0 1 0 0 0 0 1 0 0 0 0 1"),
         {0},
         {-4, -2, 3},
         true,
         "MatrixData: a turn and a shift by (5, 0, 0) mm, RAS"},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        char text[TEXT_BYTES];
        cw_mesh mesh;
        cw_mesh_file file;
        cw_error err = {0};
        make_file(text, &plain, rows[n].inside, "");
        assert_ok(read_text("a.gii", text, &mesh, &file, &err), err);
        for (size_t a = 0; a < 3; a++) {
            assert_true(mesh.origin[a] == rows[n].origin[a]);
            assert_true(mesh.positions[a] == rows[n].first[a]);
        }
        assert_int_equal(mesh.triangles[1], rows[n].mirrored ? 1 : 2);
        assert_string_equal(file.placed, rows[n].placed);
        cw_mesh_free(&mesh);
    }
}

static void a_centre_without_a_matrix_is_named(void **state)
{
    (void)state;
    char text[TEXT_BYTES];
    for (int n = 0; n < 2; n++) {
        cw_mesh mesh;
        cw_mesh_file file;
        cw_error err = {0};
        make_file(
            text, &plain,
            n ? "<MetaData><MD><Name>VolGeomC_A</Name><Value>0.000</Value></MD></MetaData>"
              : "<MetaData><MD><Name><![CDATA[VolGeomC_A]]></Name><Value>-4.5</Value></MD>"
                "</MetaData>",
            "");
        assert_ok(read_text("a.gii", text, &mesh, &file, &err), err);
        assert_string_equal(file.left_out, n ? "" : "the shift to the scanner (VolGeomC)");
        cw_mesh_free(&mesh);
    }
}

#define ARRAY(intent, type, sizes, numbers)                                                    \
    "<DataArray Intent='NIFTI_INTENT_" intent "' DataType='NIFTI_TYPE_" type                   \
    "' Encoding='ASCII' " sizes "><Data>" numbers "</Data></DataArray>"
#define TABLE                                                                                    \
    "<LabelTable><Label Key='-1' Red='1'>none</Label><Label Key='0' Red='1' Green='1' Blue='1' " \
    "Alpha='0'>unknown</Label><Label Key='7' Red='1' Green='0.5' Blue='0' Alpha='1'>V1</Label>"  \
    "</LabelTable>"

static void what_vertices_have_is_read(void **state)
{
    (void)state;
    static const uint8_t of_labels[16] = {255, 255, 255, 255, 255, 128, 0,   255,
                                          255, 255, 255, 255, 255, 255, 255, 255};
    static const uint8_t of_colors[16] = {255, 0, 0,  255, 0,   255, 0,   255,
                                          0,   0, 51, 255, 255, 255, 255, 255};
    static const uint32_t labels[4] = {0, 7, 0, 9};
    char text[TEXT_BYTES];
    for (int n = 0; n < 2; n++) {
        cw_mesh mesh;
        cw_mesh_file file;
        cw_error err = {0};
        make_file(text, &plain, "",
                  n ? ARRAY("RGB_VECTOR", "FLOAT32", "Dimensionality='2' Dim0='4' Dim1='3'",
                            "1 0 0 0 1 0 0 0 0.2 1 1 7")
                    : TABLE ARRAY("LABEL", "INT32", "Dimensionality='1' Dim0='4'", "0 7 -1 9")
                          ARRAY("SHAPE", "FLOAT32", "Dimensionality='2' Dim0='4' Dim1='1'",
                                "1 2 nan 4.5") ARRAY("TTEST", "FLOAT32",
                                                     "Dimensionality='1' Dim0='4'", "1 2 3 4"));
        assert_ok(read_text("a.gii", text, &mesh, &file, &err), err);
        check_surface(&mesh);
        assert_memory_equal(mesh.colors, n ? of_colors : of_labels, 16);
        assert_true((mesh.labels == NULL) == (n == 1) && (mesh.scalars == NULL) == (n == 1));
        if (!n) {
            assert_memory_equal(mesh.labels, labels, sizeof labels);
            assert_true(mesh.scalars[1] == 2 && mesh.scalars[2] != mesh.scalars[2]);
        }
        assert_string_equal(
            file.left_out,
            n ? "" : "arrays of the file: 1, such as NIFTI_INTENT_TTEST, names of labels");
        cw_mesh_free(&mesh);
    }
}

#define DIMS     "Dimensionality='2' Dim0='1' Dim1='3'"
#define POINTS   ARRAY("POINTSET", "FLOAT32", DIMS, "1 2 3")
#define FILE(in) "<GIFTI>" in "</GIFTI>"

static void damaged_files_are_told_where(void **state)
{
    (void)state;
    static const refused rows[] = {
        {"<GIFTI", "line 1 is not XML"},
        {"<!DOCTYPE GIFTI SYSTEM 'x'><html/>", "the first element is not GIFTI"},
        {FILE(""), "the file holds no DataArray"},
        {FILE(ARRAY("SHAPE", "FLOAT32", "Dimensionality='1' Dim0='1'", "1")),
         "its first array is NIFTI_INTENT_SHAPE, values of vertices, as in a .shape.gii"},
        {FILE(ARRAY("LABEL", "INT32", "Dimensionality='1' Dim0='1'", "1")),
         "as in a .label.gii"},
        {FILE(ARRAY("TIME_SERIES", "FLOAT32", "Dimensionality='1' Dim0='1'", "1")),
         "as in a .func.gii"},
        {FILE(POINTS), "and no triangles (NIFTI_INTENT_TRIANGLE) of a surface"},
        {FILE(ARRAY("TRIANGLE", "INT32", DIMS, "0 0 0")),
         "and no points (NIFTI_INTENT_POINTSET)"},
        {FILE(ARRAY("POINTSET", "RGB24", DIMS, "1")), "'DataType' is 'NIFTI_TYPE_RGB24'"},
        {FILE("<DataArray Intent='NIFTI_INTENT_POINTSET' DataType='NIFTI_TYPE_INT8'/>"),
         "'Dimensionality' is 0; 1 or 2 was expected"},
        {FILE("<DataArray Intent='NIFTI_INTENT_POINTSET' DataType='NIFTI_TYPE_INT8' "
              "Dimensionality='2' Dim0='-3'/>"),
         "'Dim0' is '-3'"},
        {FILE("<DataArray Intent='NIFTI_INTENT_POINTSET' DataType='NIFTI_TYPE_INT8' " DIMS
              " Encoding='Morse'/>"),
         "'Encoding' is 'Morse'"},
        {FILE("<DataArray Intent='NIFTI_INTENT_POINTSET' DataType='NIFTI_TYPE_INT8' " DIMS
              " Encoding='Base64Binary' Endian='Middle'/>"),
         "'Endian' is 'Middle'"},
        {FILE("<DataArray Intent='NIFTI_INTENT_POINTSET' DataType='NIFTI_TYPE_INT8' " DIMS
              " Encoding='ExternalFileBinary' Endian='BigEndian'/>"),
         "'ExternalFileName' is ''"},
        {FILE("<DataArray Intent='NIFTI_INTENT_POINTSET' DataType='NIFTI_TYPE_INT8' " DIMS
              " Encoding='ASCII' ArrayIndexingOrder='Diagonal'/>"),
         "'ArrayIndexingOrder' is 'Diagonal'"},
        {FILE(POINTS ARRAY("TRIANGLE", "INT32", "Dimensionality='2' Dim0='1' Dim1='4'",
                           "0 0 0 0")),
         "'Dim1' of NIFTI_INTENT_TRIANGLE is 4; 3 was expected"},
        {FILE(POINTS ARRAY("TRIANGLE", "INT32", DIMS, "")),
         "the array NIFTI_INTENT_TRIANGLE has no Data"},
        {FILE(POINTS ARRAY("TRIANGLE", "INT32", DIMS, "0 0")), "asks for 12 bytes of numbers"},
        {FILE(POINTS ARRAY("TRIANGLE", "INT32", DIMS, "0 0 x")),
         "number 3 of the numbers is 'x'"},
        {FILE(POINTS ARRAY("TRIANGLE", "INT32", DIMS, "0 0 1")),
         "triangle 0 names vertex 1 of 1"},
        {FILE(POINTS ARRAY("TRIANGLE", "INT32", DIMS, "0 0 -1")), "names vertex -1 of 1"},
        {FILE(POINTS ARRAY("TRIANGLE", "FLOAT32", DIMS, "0 0 0.5")), "names vertex 0.5 of 1"},
        {FILE(ARRAY("POINTSET", "FLOAT32", DIMS, "1 inf 2")
                  ARRAY("TRIANGLE", "INT32", DIMS, "0 0 0")),
         "'y' of vertex 0 is"},
        {FILE(ARRAY("POINTSET", "FLOAT32", "Dimensionality='2' Dim0='2000000000' Dim1='3'",
                    "1 2 3") ARRAY("TRIANGLE", "INT32", DIMS, "0 0 0")),
         "asks for 24000000000 bytes"},
        {FILE(POINTS ARRAY("TRIANGLE", "INT32", DIMS, "0 0 0")
                  ARRAY("SHAPE", "FLOAT32", "Dimensionality='1' Dim0='2'", "1 2")),
         "'Dim0' of NIFTI_INTENT_SHAPE is 2; there are 1 vertices"},
        {FILE("<LabelTable><Label Key='x'/></LabelTable>"), "'Key' is 'x'"},
    };
    check_refused("a.gii", rows, sizeof rows / sizeof *rows);
}

static void matrices_that_lie_are_told(void **state)
{
    (void)state;
    static const refused rows[] = {
        {MATRIX(UNKNOWN, SCANNER, "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0"), "15"},
        {MATRIX(UNKNOWN, SCANNER, "1 0 0 0 0 1 0 0 0 0 0 0 0 0 0 1"),
         "maps everything onto a plane"},
        {MATRIX(UNKNOWN, SCANNER, "1 0 0 nan 0 1 0 0 0 0 1 0 0 0 0 1"), "not finite"},
    };
    char text[TEXT_BYTES];
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        const refused row = {text, rows[n].words};
        make_file(text, &plain, rows[n].text, "");
        check_refused("a.gii", &row, 1);
    }
}

static void document_types_with_content_are_refused(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_error err = {0};
    assert_fails(
        read_text("a.gii", "<!DOCTYPE GIFTI [<!ENTITY a 'b'>]><GIFTI/>", &mesh, NULL, &err),
        CW_ERR_UNSAFE, "document type", err);
    assert_fails(read_text("a.gii", "<!DOCTYPE html SYSTEM 'x'><GIFTI/>", &mesh, NULL, &err),
                 CW_ERR_UNSAFE, "document type", err);
}

static void no_byte_is_trusted(void **state)
{
    (void)state;
    static const form forms[] = {{"ASCII", false, false, false},
                                 {"GZipBase64Binary", true, true, false},
                                 {"Base64Binary", false, true, true}};
    for (size_t n = 0; n < 3; n++) {
        char text[TEXT_BYTES];
        make_file(text, &forms[n], MATRIX(UNKNOWN, SCANNER, SHIFT), TABLE);
        const size_t size = strlen(text);
        for (size_t i = 0; i < size; i += test_is_short() ? 9 : 1) {
            cw_mesh mesh;
            cw_error err = {0};
            const char kept = text[i];
            text[i] ^= 0x11;
            if (read_bytes("a.gii", text, size, &mesh, NULL, &err) == CW_OK)
                assert_usable(&mesh);
            cw_mesh_free(&mesh);
            text[i] = kept;
            if (i < size - 10) /* without its last tag */
                assert_true(read_bytes("a.gii", text, i, &mesh, NULL, &err) != CW_OK);
        }
    }
}

static void memory_may_run_out_anywhere(void **state)
{
    (void)state;
    char text[TEXT_BYTES];
    make_file(text, &plain, "",
              TABLE ARRAY("LABEL", "INT32", "Dimensionality='1' Dim0='4'", "0 7 -1 9"));
    test_file_write(test_path("a.gii"), text, strlen(text));
    check_starved_mesh_reads("a.gii");
}

/* The two arrays of a surface and nothing else, whatever the mesh has. */
static void two_arrays_are_written(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_error err = {0};
    test_make_cube(&mesh);
    assert_ok(cw_mesh_write(test_path("a.surf.gii"), &mesh, NULL, &err), err);
    size_t size;
    char *text = test_file_read(test_path("a.surf.gii"), &size);
    assert_non_null(strstr(text, "NumberOfDataArrays=\"2\""));
    assert_non_null(strstr(text, "<Name>Name</Name><Value>a.surf</Value>"));
    assert_non_null(strstr(text, "<DataSpace><![CDATA[NIFTI_XFORM_SCANNER_ANAT]]>"));
    free(text);
    assert_fails(cw_mesh_write(test_path("a.gii"), &mesh,
                               &(cw_write_desc){.axes = {.unit = CW_UNIT_M}}, &err),
                 CW_ERR_ARGUMENT, "gifti is in millimetres, right-anterior-superior", err);
    assert_ok(
        cw_mesh_write(test_path("a.gii"), &mesh, &(cw_write_desc){.axes = {.ras = true}}, &err),
        err);
    cw_mesh_free(&mesh);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(every_form_is_read),
        TEST(external_files_stay_in_the_folder),
        TEST(the_way_to_the_scanner_is_applied),
        TEST(a_centre_without_a_matrix_is_named),
        TEST(what_vertices_have_is_read),
        TEST(damaged_files_are_told_where),
        TEST(matrices_that_lie_are_told),
        TEST(document_types_with_content_are_refused),
        TEST(no_byte_is_trusted),
        TEST(memory_may_run_out_anywhere),
        TEST(two_arrays_are_written),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
