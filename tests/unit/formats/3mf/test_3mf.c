/* Tests the writer of 3MF: names in the archive, vertices, triangles, parts, colours and
 * limits. */
#include "formats/3mf/3mf_format.h"
#include "support/files/unzip.h"

#include "formats/mesh/mesh_writer.h"

#include <stdio.h>

static char *write_model(const cw_part *parts, size_t count, const cw_write_desc *desc)
{
    cw_error err = {0};
    assert_ok(cw_parts_write(test_path("a.3mf"), parts, count, desc, &err), err);
    return unzip(test_path("a.3mf"), "3D/3dmodel.model");
}

static char *write_one(const cw_mesh *mesh, const cw_write_desc *desc)
{
    return write_model(&(cw_part){.mesh = mesh}, 1, desc);
}

static void assert_holds(const char *text, const char *words)
{
    if (!strstr(text, words))
        fail_msg("no %s in\n%s", words, text);
}

/* Names and types are what the format's rules for packages say. */
static void the_archive_names_its_model(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    test_make_tetrahedron(&mesh);
    free(write_one(&mesh, NULL));
    char *types = unzip(test_path("a.3mf"), "[Content_Types].xml");
    assert_holds(types, "Extension=\"model\" ContentType=\"application/vnd.ms-package."
                        "3dmanufacturing-3dmodel+xml\"");
    char *rels = unzip(test_path("a.3mf"), "_rels/.rels");
    assert_holds(rels, "Target=\"/3D/3dmodel.model\"");
    free(types);
    free(rels);
    cw_mesh_free(&mesh);
}

static void an_object_has_its_vertices_and_triangles(void **state)
{
    (void)state;
    static const char object[] = "<resources>\n<object id=\"2\" type=\"model\" name=\"a\">\n"
                                 "<mesh>\n<vertices>\n<vertex x=\"0\" y=\"0\" z=\"0\"/>\n"
                                 "<vertex x=\"1.25\" y=\"0\" z=\"0\"/>\n";
    static const char triangles[] = "</vertices>\n<triangles>\n"
                                    "<triangle v1=\"0\" v2=\"2\" v3=\"1\"/>\n";
    static const char end[] = "<triangle v1=\"1\" v2=\"2\" v3=\"3\"/>\n</triangles>\n</mesh>\n"
                              "</object>\n</resources>\n<build>\n<item objectid=\"2\"/>\n"
                              "</build>\n</model>\n";
    cw_mesh mesh = {0};
    test_make_tetrahedron(&mesh);
    mesh.positions[3] = 1.25f;
    char *text = write_one(&mesh, NULL);
    assert_holds(text, "<model unit=\"millimeter\" ");
    assert_holds(text, "<metadata name=\"Application\">cubewright " CW_VERSION "</metadata>");
    assert_holds(text, object);
    assert_holds(text, triangles);
    assert_string_equal(text + strlen(text) - strlen(end), end);
    free(text);
    cw_mesh_free(&mesh);
}

/* The vertices keep their bits; the item places them, in the unit and axes of the file. */
static void the_origin_is_in_the_item(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    test_make_tetrahedron(&mesh);
    memcpy(mesh.origin, (double[3]){1000003.2, 0.1, -5}, sizeof mesh.origin);
    char *text = write_one(&mesh, NULL);
    assert_holds(text,
                 "<item objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 1 1000003.2 0.1 -5\"/>");
    assert_holds(text, "<vertex x=\"1\" y=\"0\" z=\"0\"/>");
    assert_null(strstr(text, "cw:origin"));
    free(text);
    text = write_one(&mesh, &(cw_write_desc){.local = true});
    assert_holds(text, "<item objectid=\"2\"/>");
    assert_holds(text, "<metadata name=\"cw:origin\">1000003.2 0.1 -5</metadata>");
    free(text);
    text = write_one(&mesh, &(cw_write_desc){.axes = {CW_UNIT_CM, true, true}});
    assert_holds(text, "unit=\"centimeter\"");
    assert_holds(text, "<metadata name=\"cw:frame\">RAS</metadata>\n"
                       "<metadata name=\"cw:up\">Y</metadata>");
    assert_holds(text, "1 -100000.31999999999 -0.5 0.01\"/>"); /* all its digits */
    assert_holds(text, "<vertex x=\"-0.1\" y=\"0\" z=\"0\"/>");
    free(text);
    cw_mesh_free(&mesh);
}

static void parts_are_objects_with_escaped_names(void **state)
{
    (void)state;
    cw_mesh cube = {0}, tetrahedron = {0};
    test_make_cube(&cube);
    test_make_tetrahedron(&tetrahedron);
    tetrahedron.origin[1] = 3;
    const cw_part parts[] = {{.mesh = &cube, .name = "<a & \"b\">"},
                             {.mesh = &tetrahedron, .name = NULL}};
    char *text = write_model(parts, 2, &(cw_write_desc){.name = "skull & jaw"});
    assert_holds(text, "<metadata name=\"Title\">skull &amp; jaw</metadata>");
    assert_holds(text,
                 "<object id=\"2\" type=\"model\" name=\"&lt;a &amp; &quot;b&quot;&gt;\">");
    assert_holds(text, "<object id=\"4\" type=\"model\" name=\"skull &amp; jaw 2\">");
    assert_holds(text, "<item objectid=\"2\"/>\n<item objectid=\"4\" "
                       "transform=\"1 0 0 0 1 0 0 0 1 0 3 0\"/>");
    free(text);
    cw_mesh_free(&cube);
    cw_mesh_free(&tetrahedron);
}

/* Every colour once; triangles name those of their corners. */
static void colors_are_a_group_of_the_object(void **state)
{
    (void)state;
    static uint8_t colors[16] = {255, 128, 0, 255, 0, 0, 9, 255, 255, 128, 0, 255, 0, 0, 9, 0};
    static const char group[] = "<m:colorgroup id=\"1\">\n<m:color color=\"#00000900\"/>\n"
                                "<m:color color=\"#000009FF\"/>\n"
                                "<m:color color=\"#FF8000FF\"/>\n</m:colorgroup>\n"
                                "<object id=\"2\" type=\"model\" name=\"a\" pid=\"1\" "
                                "pindex=\"0\">\n";
    cw_mesh mesh = {0}, plain = {0};
    test_make_tetrahedron(&mesh);
    test_make_tetrahedron(&plain);
    mesh.colors = colors;
    char *text = write_one(&mesh, NULL);
    assert_holds(text, group);
    assert_holds(text,
                 "<triangle v1=\"0\" v2=\"2\" v3=\"1\" pid=\"1\" p1=\"2\" p2=\"2\" p3=\"1\"/>");
    assert_holds(text,
                 "<triangle v1=\"1\" v2=\"2\" v3=\"3\" pid=\"1\" p1=\"1\" p2=\"2\" p3=\"0\"/>");
    free(text);
    const cw_part parts[] = {{.mesh = &plain, .name = "plain"},
                             {.mesh = &mesh, .name = "coloured"}};
    text = write_model(parts, 2, NULL);
    assert_null(strstr(text, "colorgroup id=\"1\""));
    assert_holds(text, "<m:colorgroup id=\"3\">");
    assert_holds(text, "name=\"coloured\" pid=\"3\" pindex=\"0\">");
    free(text);
    mesh.colors = NULL;
    cw_mesh_free(&mesh);
    cw_mesh_free(&plain);
}

static void triangles_that_name_a_vertex_twice_are_left_out(void **state)
{
    (void)state;
    size_t count = 0;
    cw_mesh mesh = {0};
    test_make_tetrahedron(&mesh);
    mesh.triangles[0] = mesh.triangles[1];
    mesh.triangles[9] = mesh.triangles[11];
    char *text = write_one(&mesh, NULL);
    for (const char *at = text; (at = strstr(at, "<triangle ")); at++)
        count++;
    assert_int_equal(count, 2);
    free(text);
    cw_mesh_free(&mesh);
}

/* Counted before any of them is touched. */
static void more_vertices_than_an_object_can_have_are_refused(void **state)
{
    (void)state;
    cwi_part part = {.mesh = {.vertex_count = (size_t)INT32_MAX + 1}, .name = "big"};
    const cwi_parts parts = {.items = &part, .count = 1};
    cwi_mesh_output out = {0};
    cw_error err = {0};
    assert_fails(cwi_3mf_write(&parts, &out, &err), CW_ERR_LIMIT,
                 "at most 2147483647 vertices in an object; 'big' has 2147483648", err);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(the_archive_names_its_model),
        TEST(an_object_has_its_vertices_and_triangles),
        TEST(the_origin_is_in_the_item),
        TEST(parts_are_objects_with_escaped_names),
        TEST(colors_are_a_group_of_the_object),
        TEST(triangles_that_name_a_vertex_twice_are_left_out),
        TEST(more_vertices_than_an_object_can_have_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
