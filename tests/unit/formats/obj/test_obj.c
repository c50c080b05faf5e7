/* Tests the writer of OBJ: exact places, origins, faces and normals. */
#include "support/support.h"

#include <stdlib.h>
#include <string.h>

/* The next line that starts with a word; moves *text behind the word. */
static bool next_line(const char **text, const char *word)
{
    const size_t length = strlen(word);
    for (const char *at = *text; (at = strchr(at, '\n')); at++)
        if (strncmp(at + 1, word, length) == 0 && at[1 + length] == ' ') {
            *text = at + length + 2;
            return true;
        }
    return false;
}

static void places_come_back_to_the_bit(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_error err = {0};
    size_t size, count = 0;
    test_make_cube(&mesh);
    for (size_t i = 0; i < 24; i++)
        mesh.positions[i] = 1.0f / (float)(i + 3) - 0.1f * (float)i;
    assert_ok(cw_mesh_write(test_path("a.obj"), &mesh, NULL, &err), err);
    char *text = test_file_read(test_path("a.obj"), &size);
    for (const char *at = text; next_line(&at, "v"); count++)
        for (size_t a = 0; a < 3; a++)
            assert_true((float)strtod(at, (char **)&at) == mesh.positions[3 * count + a]);
    assert_int_equal(count, 8);
    count = 0;
    for (const char *at = text; next_line(&at, "vn"); count++)
        for (size_t a = 0; a < 3; a++)
            assert_true((float)strtod(at, (char **)&at) == mesh.normals[3 * count + a]);
    assert_int_equal(count, 8);
    free(text);
    cw_mesh_free(&mesh);
}

static void far_from_zero_places_are_the_sum_to_the_bit(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_error err = {0};
    size_t size, i = 0;
    test_make_far_sphere(&mesh);
    assert_ok(cw_mesh_write(test_path("a.obj"), &mesh, NULL, &err), err);
    char *text = test_file_read(test_path("a.obj"), &size);
    for (const char *at = text; next_line(&at, "v");)
        for (size_t a = 0; a < 3; a++, i++)
            assert_true(strtod(at, (char **)&at) == mesh.origin[a] + (double)mesh.positions[i]);
    assert_int_equal(i, 3 * mesh.vertex_count);
    free(text);
    cw_mesh_free(&mesh);
}

static void a_local_file_holds_positions_and_names_the_origin(void **state)
{
    (void)state;
    static const char head[] = "# cubewright " CW_VERSION ", LPS, mm\n"
                               "# origin 1000003.2 1000003.2 1000160\no a\n";
    cw_mesh mesh = {0};
    cw_error err = {0};
    size_t size, i = 0;
    test_make_far_sphere(&mesh);
    assert_ok(cw_mesh_write(test_path("a.obj"), &mesh, &(cw_write_desc){.local = true}, &err),
              err);
    char *text = test_file_read(test_path("a.obj"), &size);
    assert_memory_equal(text, head, sizeof head - 1);
    for (const char *at = text; next_line(&at, "v");)
        for (size_t a = 0; a < 3; a++, i++)
            assert_true((float)strtod(at, (char **)&at) == mesh.positions[i]);
    assert_int_equal(i, 3 * mesh.vertex_count);
    free(text);
    cw_mesh_free(&mesh);
}

static void faces_name_vertices_and_normals_from_one(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_error err = {0};
    size_t size, count = 0;
    test_make_cube(&mesh);
    assert_ok(cw_mesh_write(test_path("a.obj"), &mesh, NULL, &err), err);
    char *text = test_file_read(test_path("a.obj"), &size);
    for (const char *at = text; next_line(&at, "f"); count++)
        for (size_t c = 0; c < 3; c++) {
            const unsigned long vertex = strtoul(at, (char **)&at, 10);
            assert_int_equal(vertex, mesh.triangles[3 * count + c] + 1);
            assert_memory_equal(at, "//", 2);
            assert_int_equal(strtoul(at + 2, (char **)&at, 10), vertex);
        }
    assert_int_equal(count, 12);
    free(text);
    cw_mesh_free(&mesh);
}

static void a_mesh_without_normals_is_plain(void **state)
{
    (void)state;
    static const char expected[] = "# cubewright " CW_VERSION ", LPS, mm\no a\n"
                                   "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
                                   "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    cw_mesh mesh = {0};
    cw_error err = {0};
    size_t size;
    test_make_tetrahedron(&mesh);
    free(mesh.normals);
    mesh.normals = NULL;
    assert_ok(cw_mesh_write(test_path("a.obj"), &mesh, NULL, &err), err);
    char *text = test_file_read(test_path("a.obj"), &size);
    assert_string_equal(text, expected);
    free(text);
    cw_mesh_free(&mesh);
}

#define CASE(test) cmocka_unit_test_setup_teardown(test, test_folder_make, test_folder_remove)

int main(void)
{
    const struct CMUnitTest tests[] = {
        CASE(places_come_back_to_the_bit),
        CASE(far_from_zero_places_are_the_sum_to_the_bit),
        CASE(a_local_file_holds_positions_and_names_the_origin),
        CASE(faces_name_vertices_and_normals_from_one),
        CASE(a_mesh_without_normals_is_plain),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
