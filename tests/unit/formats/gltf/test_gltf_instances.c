/* glTF read as viewers draw its first frame: instances of EXT_mesh_gpu_instancing, and nodes that
 * KHR_node_visibility hides. */
#include "support/files/gltf_builder.h"

#include "core/base/module.h"

static const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};

/* --- instances --------------------------------------------------------------------------- */

static void instances_are_parts_with_numbers(void **state)
{
    (void)state;
    static const float moves[9] = {0, 0, 0, 10, 0, 0, 0, 0, -5},
                       sizes[9] = {1, 1, 1, 2, 2, 2, 1, 1, -1};
    static const float quarter[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0.70710678f, 0, 0.70710678f};
    static const int8_t bytes[12] = {0, 0, 0, 127, 0, 0, 0, 127, 0, 90, 0, 90};
    static const int16_t shorts[12] = {0, 0, 0, 32767, 0, 0, 0, 32767, 0, 23170, 0, 23170};
    static const char fractions[] = "VEC4\",\"normalized\":true,\"x\":\"";
    for (int n = 0; n < 3; n++) {
        gltf_builder *b = calloc(1, sizeof *b);
        cw_part *parts;
        cw_mesh_file file;
        cw_error err = {0};
        size_t count;
        char rest[800];
        assert_non_null(b);
        const int position = add_floats(b, "VEC3", 3, 3, corners);
        const int move = add_floats(b, "VEC3", 3, 3, moves),
                  size = add_floats(b, "VEC3", 3, 3, sizes);
        const int turn = n == 0   ? add_floats(b, "VEC4", 4, 3, quarter)
                         : n == 1 ? add_array(b, 5120, fractions, 4, 3, bytes)
                                  : add_array(b, 5122, fractions, 4, 3, shorts);
        snprintf(
            rest, sizeof rest,
            "\"extensionsRequired\":[\"EXT_mesh_gpu_instancing\"],\"meshes\":[{\"primitives\":["
            "{\"attributes\":{\"POSITION\":%d}}]}],\"nodes\":[{\"name\":\"tree\",\"mesh\":0,"
            "\"translation\":[0,1,0],\"extensions\":{\"EXT_mesh_gpu_instancing\":{"
            "\"attributes\":{\"TRANSLATION\":%d,\"ROTATION\":%d,\"SCALE\":%d,\"_ID\":0}}}}]",
            position, move, turn, size);
        assert_ok(cw_parts_read(write_built(b, rest), NULL, &parts, &count, &file, &err), err);
        assert_int_equal(count, 3);
        assert_string_equal(parts[0].name, "tree 1");
        assert_string_equal(parts[2].name, "tree 3");
        assert_int_equal(file.parts, 3);
        assert_string_equal(file.not_applied, "");
        check_vertex(parts[0].mesh, 1, 1, 1, 0);
        check_vertex(parts[1].mesh, 1, 12, 1, 0);
        check_vertex(parts[1].mesh, 2, 10, 3, 0);
        check_vertex(parts[2].mesh, 1, 0, 1, -6);         /* a quarter turn about +Y */
        assert_int_equal(parts[2].mesh->triangles[0], 2); /* and a mirror */
        cw_parts_free(parts, count);
        free(b);
    }
}

/* One that only moves keeps the node's transform; without attributes there is one instance. */
static void instances_by_one_array_or_none(void **state)
{
    (void)state;
    static const float moves[6] = {0, 0, 1, 0, 0, 2};
    static const char *const forms[] = {"{\"attributes\":{\"TRANSLATION\":1}}",
                                        "{\"attributes\":{\"SCALE\":1}}", "{\"attributes\":{}}",
                                        "{}"};
    static const size_t triangles[] = {2, 2, 1, 1};
    for (size_t n = 0; n < 4; n++) {
        gltf_builder *b = calloc(1, sizeof *b);
        cw_mesh mesh;
        cw_error err = {0};
        char rest[600];
        assert_non_null(b);
        add_floats(b, "VEC3", 3, 3, corners);
        add_floats(b, "VEC3", 3, 2, moves);
        snprintf(
            rest, sizeof rest,
            "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[{"
            "\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":%s}}]",
            forms[n]);
        assert_ok(read_built(b, rest, &mesh, NULL, &err), err);
        assert_int_equal(mesh.triangle_count, triangles[n]);
        if (n == 0)
            check_vertex(&mesh, 4, 1, 0, 2);
        cw_mesh_free(&mesh);
        free(b);
    }
}

/* --- hidden nodes ------------------------------------------------------------------------ */

static void hidden_nodes_and_their_children_are_left_out(void **state)
{
    (void)state;
#define HIDDEN "\"extensions\":{\"KHR_node_visibility\":{\"visible\":false}}"
    static const struct {
        const char *nodes, *names;
        size_t invisible, triangles;
    } rows[] = {
        {"{\"mesh\":0,\"name\":\"wheel\"," HIDDEN "},{\"mesh\":0},{}", "wheel", 1, 1},
        {"{\"children\":[1,2]," HIDDEN
         "},{\"mesh\":0,\"name\":\"a\"},{\"mesh\":0,\"name\":\"b\","
         "\"extensions\":{\"KHR_node_visibility\":{\"visible\":true}}}",
         "a, b", 2, 0},
        {"{\"mesh\":0,\"extensions\":{\"KHR_node_visibility\":{\"visible\":true}}},{\"mesh\":0,"
         "\"extensions\":{\"KHR_node_visibility\":{}}},{\"name\":\"none\"," HIDDEN "}",
         "", 0, 2},
        {"{\"mesh\":0," HIDDEN "},{\"mesh\":0,\"name\":\"a\\u0007b\"," HIDDEN "},{\"mesh\":0}",
         "box, a_b", 2, 1},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        gltf_builder *b = calloc(1, sizeof *b);
        cw_mesh mesh;
        cw_mesh_file file;
        cw_error err = {0};
        char rest[800];
        assert_non_null(b);
        add_floats(b, "VEC3", 3, 3, corners);
        snprintf(
            rest, sizeof rest,
            "\"extensionsRequired\":[\"KHR_node_visibility\"],\"meshes\":[{\"name\":\"box\","
            "\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[%s]",
            rows[n].nodes);
        assert_ok(read_built(b, rest, &mesh, &file, &err), err);
        assert_int_equal(file.invisible, rows[n].invisible);
        assert_string_equal(file.invisible_names, rows[n].names);
        assert_int_equal(mesh.triangle_count, rows[n].triangles);
        cw_mesh_free(&mesh);
        free(b);
    }
}

/* Names that have no place are "...", once. */
static void many_hidden_names_are_cut_off(void **state)
{
    (void)state;
    gltf_builder *b = calloc(1, sizeof *b);
    cw_mesh mesh;
    cw_mesh_file file;
    cw_error err = {0};
    char rest[12000] =
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[{}";
    assert_non_null(b);
    add_floats(b, "VEC3", 3, 3, corners);
    for (int n = 0; n < 60; n++)
        snprintf(rest + strlen(rest), sizeof rest - strlen(rest),
                 ",{\"mesh\":0,\"name\":\"node of number %d\"," HIDDEN "}", n);
    strcat(rest, "]");
    assert_ok(read_built(b, rest, &mesh, &file, &err), err);
    assert_int_equal(file.invisible, 60);
    assert_true(strlen(file.invisible_names) < sizeof file.invisible_names);
    assert_string_equal(strchr(file.invisible_names, '.'), "...");
    cw_mesh_free(&mesh);
    free(b);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(instances_are_parts_with_numbers),
        TEST(instances_by_one_array_or_none),
        TEST(hidden_nodes_and_their_children_are_left_out),
        TEST(many_hidden_names_are_cut_off),
    };
    return cwi_module_present("gltf") ? cmocka_run_group_tests(tests, NULL, NULL) : 0;
}
