/* glTF read: scenes by hand in every dialect. */
#include "support/files/gltf_cases.h"

/* Metres and +Y up become millimetres and head along +Z. */
static void bytes_as_indices_and_a_plain_node(void **state)
{
    (void)state;
    static const uint32_t triangle[3] = {0, 1, 2};
    cw_mesh mesh;
    cw_mesh_file file;
    cw_error err = {0};
    assert_ok(read_primitive(BY_BYTES, &mesh, &file, &err), err);
    assert_string_equal(file.format, "glb");
    assert_int_equal(file.known, CW_KNOWN_UNIT);
    assert_int_equal(file.parts, 1);
    check_triangles(&mesh, 1, triangle);
    check_point(&mesh, 0, 0, 0, 0);
    check_point(&mesh, 1, 1000, 0, 0);
    check_point(&mesh, 2, 0, 0, 1000);
    assert_usable(&mesh);
    cw_mesh_free(&mesh);
}

static void strips_fans_and_vertices_without_indices(void **state)
{
    (void)state;
    static const struct {
        const char *primitive;
        size_t count;
        uint32_t triangles[6];
    } rows[] = {
        {"{\"attributes\":{\"POSITION\":4},\"indices\":2,\"mode\":5}", 2, {0, 1, 2, 1, 3, 2}},
        {"{\"attributes\":{\"POSITION\":4},\"indices\":2,\"mode\":6}", 2, {1, 2, 0, 2, 3, 0}},
        {"{\"attributes\":{\"POSITION\":4},\"mode\":5}", 2, {0, 1, 2, 1, 3, 2}},
        {"{\"attributes\":{\"POSITION\":0}}", 1, {0, 1, 2}},
        {"{\"attributes\":{\"POSITION\":0},\"indices\":1,\"mode\":4}", 1, {0, 1, 2}},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        cw_mesh mesh;
        cw_error err = {0};
        assert_ok(read_primitive(rows[i].primitive, &mesh, NULL, &err), err);
        check_triangles(&mesh, rows[i].count, rows[i].triangles);
        cw_mesh_free(&mesh);
    }
}

static void points_and_lines_are_counted_and_left_out(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_mesh_file file;
    cw_error err = {0};
    assert_ok(read_primitive("{\"attributes\":{\"POSITION\":0},\"mode\":0},"
                             "{\"attributes\":{\"POSITION\":4},\"mode\":1},"
                             "{\"attributes\":{\"POSITION\":4},\"mode\":2},"
                             "{\"attributes\":{\"POSITION\":4},\"mode\":3}",
                             &mesh, &file, &err),
              err);
    assert_int_equal(mesh.vertex_count + mesh.triangle_count, 0);
    assert_int_equal(file.skipped, 3 + 2 + 4 + 3);
    assert_int_equal(file.parts, 0);
    cw_mesh_free(&mesh);
}

/* Primitives that share their vertices do so in the mesh; others follow one another. */
static void primitives_are_merged(void **state)
{
    (void)state;
    static const uint32_t shared[6] = {0, 1, 2, 0, 1, 2}, apart[6] = {0, 1, 2, 3, 4, 5};
    cw_mesh mesh;
    cw_mesh_file file;
    cw_error err = {0};
    assert_ok(read_primitive(BY_BYTES "," BY_BYTES, &mesh, &file, &err), err);
    assert_int_equal(file.parts, 1);
    assert_int_equal(mesh.vertex_count, 3);
    check_triangles(&mesh, 2, shared);
    cw_mesh_free(&mesh);
    assert_ok(read_primitive("{\"attributes\":{\"POSITION\":0,\"NORMAL\":6}}," BY_BYTES, &mesh,
                             &file, &err),
              err);
    assert_int_equal(mesh.vertex_count, 6);
    check_triangles(&mesh, 2, apart);
    assert_null(mesh.normals); /* the second part has none */
    cw_mesh_free(&mesh);
}

/* sRGB of linear 55, 1 and 188 of 255; a part without colours is white. */
static void colors_are_turned_to_srgb(void **state)
{
    (void)state;
    static const uint8_t expected[24] = {0,   255, 128, 255, 13,  223, 0,   0,
                                         255, 255, 255, 128, 255, 255, 255, 255,
                                         255, 255, 255, 255, 255, 255, 255, 255};
    cw_mesh mesh;
    cw_error err = {0};
    assert_ok(read_primitive("{\"attributes\":{\"POSITION\":0,\"COLOR_0\":3}}," BY_BYTES, &mesh,
                             NULL, &err),
              err);
    for (int i = 0; i < 24; i++)
        assert_int_equal(mesh.colors[i], expected[i]);
    cw_mesh_free(&mesh);
    assert_ok(read_primitive(BY_BYTES ",{\"attributes\":{\"POSITION\":0,\"COLOR_0\":3}}", &mesh,
                             NULL, &err),
              err);
    for (int i = 0; i < 24; i++)
        assert_int_equal(mesh.colors[i], expected[(i + 12) % 24]);
    cw_mesh_free(&mesh);
}

static void quantized_positions_are_shares_of_the_largest(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_error err = {0};
    assert_ok(read_nodes("\"extensionsRequired\":[\"KHR_mesh_quantization\"],"
                         "\"nodes\":[{\"mesh\":1}]",
                         &mesh, NULL, &err),
              err);
    check_point(&mesh, 1, 1000, 0, 0);
    check_point(&mesh, 2, 0, 0, -1000);
    cw_mesh_free(&mesh);
}

/* The triangle twice: once beneath a parent that moves it, and once in a mirror. */
static void nodes_place_meshes_and_mirrors_turn_the_winding(void **state)
{
    (void)state;
    static const uint32_t triangles[6] = {0, 1, 2, 5, 4, 3};
    cw_mesh mesh;
    cw_mesh_file file;
    cw_error err = {0};
    assert_ok(read_nodes("\"scenes\":[{\"nodes\":[2,1]}],\"nodes\":["
                         "{\"mesh\":0,\"translation\":[0,0,5]},"
                         "{\"mesh\":0,\"scale\":[-2,2,2]},"
                         "{\"children\":[0],\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,10,20,30,1]},"
                         "{\"mesh\":0,\"name\":\"in no scene\"}]",
                         &mesh, &file, &err),
              err);
    assert_int_equal(file.parts, 2);
    assert_int_equal(mesh.vertex_count, 6);
    check_triangles(&mesh, 2, triangles);
    check_point(&mesh, 0, 10000, -35000, 20000);
    check_point(&mesh, 1, 11000, -35000, 20000);
    check_point(&mesh, 2, 10000, -35000, 21000);
    check_point(&mesh, 4, -2000, 0, 0);
    check_point(&mesh, 5, 0, 0, 2000);
    cw_mesh_free(&mesh);
}

/* The most that a node of the scene names; what is no list names none. */
static void levels_of_detail_are_counted_and_left_out(void **state)
{
    (void)state;
    static const struct {
        const char *extension;
        size_t levels;
    } rows[] = {{"{\"ids\":[1,2]}", 2}, {"{\"ids\":[]}", 0}, {"{\"ids\":7}", 0}, {"3", 0}};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        char nodes[512];
        cw_mesh mesh;
        cw_mesh_file file;
        cw_error err = {0};
        snprintf(nodes, sizeof nodes,
                 "\"scenes\":[{\"nodes\":[0,3]}],\"nodes\":["
                 "{\"mesh\":0,\"extensions\":{\"MSFT_lod\":%s}},{\"mesh\":0},{\"mesh\":0},"
                 "{\"mesh\":0}]",
                 rows[n].extension);
        assert_ok(read_nodes(nodes, &mesh, &file, &err), err);
        assert_int_equal(file.levels, rows[n].levels);
        assert_int_equal(mesh.triangle_count, 2);
        cw_mesh_free(&mesh);
    }
}

/* A scale of 0 hides a node and what is below it; a flat one hides nothing. */
static void what_has_no_scale_is_hidden(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_mesh_file file;
    cw_error err = {0};
    assert_ok(read_nodes("\"scenes\":[{\"nodes\":[0,1,3,4]}],\"nodes\":["
                         "{\"mesh\":0,\"scale\":[0,0,0],\"translation\":[1,2,3]},"
                         "{\"scale\":[0,0,0],\"children\":[2]},{\"mesh\":0},"
                         "{\"mesh\":0,\"scale\":[1,0,1]},{\"mesh\":0}]",
                         &mesh, &file, &err),
              err);
    assert_int_equal(file.hidden, 2);
    assert_int_equal(file.parts, 2);
    assert_int_equal(mesh.triangle_count, 2);
    cw_mesh_free(&mesh);
    assert_ok(read_nodes("\"scenes\":[{\"nodes\":[0]}],"
                         "\"nodes\":[{\"mesh\":0,\"scale\":[0,0,0]}]",
                         &mesh, &file, &err),
              err);
    assert_int_equal(file.hidden, 1);
    assert_int_equal(mesh.vertex_count, 0);
    cw_mesh_free(&mesh);
}

/* A quarter turn about +Y, and normals that follow; a mirror leaves them outward. */
static void normals_turn_with_their_node(void **state)
{
    (void)state;
    static const char *const nodes[2] = {"\"rotation\":[0,0.7071067811865475,0,"
                                         "0.7071067811865475],\"scale\":[1,3,1]",
                                         "\"scale\":[1,1,-3]"};
    static const float expected[2][3] = {{1, 0, 0}, {0, 1, 0}};
    for (size_t i = 0; i < 2; i++) {
        char json[8192];
        cw_mesh mesh;
        cw_error err = {0};
        snprintf(json, sizeof json,
                 "{" ARRAYS ",\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,"
                 "\"NORMAL\":6}}]}],\"nodes\":[{\"mesh\":0,%s}]}",
                 nodes[i]);
        assert_ok(read_glb(json, &mesh, NULL, &err), err);
        for (size_t k = 0; k < 9; k++)
            assert_near((double)mesh.normals[k], (double)expected[i][k % 3], 1e-6);
        cw_mesh_free(&mesh);
    }
}

/* Colours as floats are linear light, the dark ones too; what is beyond 0 to 1 is cut off.
 * Normals of bytes are rounded: they become unit vectors again. (y, up, becomes z.) */
static void floats_are_light_and_bytes_are_rounded(void **state)
{
    (void)state;
    static const char form[] =
        "{\"asset\":{\"version\":\"2.0\"},\"extensionsRequired\":[\"KHR_mesh_quantization\"],"
        "\"extensionsUsed\":[\"KHR_mesh_quantization\"],\"buffers\":[{\"byteLength\":84,"
        "\"uri\":\"data:application/octet-stream;base64,"
        "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAbxIDOwAAAD8AAIA/"
        "AAAAAKabRDvNzEw+AACAvwAA"
        "AEBmZmY/WloAAAAAnAA8AFAA\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":36},"
        "{\"buffer\":0,\"byteOffset\":36,\"byteLength\":36},"
        "{\"buffer\":0,\"byteOffset\":72,\"byteLength\":12,\"byteStride\":4}],\"accessors\":["
        "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"
        "{\"bufferView\":1,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"
        "{\"bufferView\":2,\"componentType\":5120,\"count\":3,\"type\":\"VEC3\","
        "\"normalized\":true}],\"nodes\":[{\"mesh\":0%s}],\"meshes\":[{\"primitives\":[{"
        "\"attributes\":{\"POSITION\":0,\"COLOR_0\":1,\"NORMAL\":2}}]}]}";
    static const char *const nodes[2] = {
        "", ",\"matrix\":[0.001,0,0,0,0,0,-0.001,0,0,0.001,0,0,0,0,0,1]"}; /* back to z up and
                                                                              millimetres */
    static const uint8_t colors[12] = {7, 188, 255, 255, 0, 10, 124, 255, 0, 255, 243, 255};
    const double half = sqrt(0.5);
    const double normals[2][9] = {{half, 0, half, 0, 1, 0, 0.6, -0.8, 0},
                                  {half, half, 0, 0, 0, -1, 0.6, 0, 0.8}};
    for (int i = 0; i < 2; i++) {
        char json[2048];
        cw_mesh mesh;
        cw_error err = {0};
        snprintf(json, sizeof json, form, nodes[i]);
        assert_ok(read_text("a.gltf", json, &mesh, NULL, &err), err);
        assert_int_equal(mesh.vertex_count, 3);
        assert_memory_equal(mesh.colors, colors, sizeof colors);
        for (size_t n = 0; n < 9; n++)
            assert_near((double)mesh.normals[n], normals[i][n], 1e-6);
        cw_mesh_free(&mesh);
    }
}

/* A kilometre away, turned: single precision alone would keep a sixteenth of a millimetre. */
static void far_nodes_get_an_origin(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_error err = {0};
    assert_ok(read_nodes("\"nodes\":[{\"mesh\":0,\"scale\":[0.001,0.001,0.001],"
                         "\"rotation\":[0,1,0,0],\"translation\":[1000.0001,0,0]}]",
                         &mesh, NULL, &err),
              err);
    assert_near(mesh.origin[0], 1000000.1, 1);
    check_point(&mesh, 0, 1000000.1, 0, 0);
    check_point(&mesh, 1, 1000000.1 - 1, 0, 0);
    cw_mesh_free(&mesh);
}

static void what_we_wrote_comes_back_to_the_bit(void **state)
{
    (void)state;
    static const double origins[][3] = {
        {0, 0, 0}, {12.3, -45.678, 1e6}, {1.0 / 3, -2e-7, 123456.789012345}};
    for (size_t i = 0; i < 3; i++) {
        cw_mesh mesh, back;
        cw_mesh_file file;
        cw_error err = {0};
        test_make_cube(&mesh);
        memcpy(mesh.origin, origins[i], sizeof mesh.origin);
        for (size_t k = 0; k < 24; k++)
            mesh.positions[k] = 0.1f * (float)k + 0.007f;
        for (int k = 0; k < 12; k++)
            mesh.affine[k / 4][k % 4] = k == 3 ? 1.0 / 7 : k;
        assert_ok(cw_mesh_write(test_path("a.gltf"), &mesh, NULL, &err), err);
        assert_ok(cw_mesh_read(test_path("a.gltf"), NULL, &back, &file, &err), err);
        assert_int_equal(file.known, CW_KNOWN_UNIT | CW_KNOWN_FRAME);
        assert_false(file.local);
        check_positions(&back, 8, mesh.positions);
        check_triangles(&back, 12, mesh.triangles);
        assert_memory_equal(back.normals, mesh.normals, 24 * sizeof(float));
        assert_memory_equal(back.affine, mesh.affine, sizeof mesh.affine);
        for (int a = 0; a < 3; a++)
            assert_near(back.origin[a], mesh.origin[a], 2e-16 * fabs(mesh.origin[a]));
        cw_mesh_free(&back);
        cw_mesh_free(&mesh);
    }
}

/* Buffers of .gltf: in the text, beside it with a name in percents, outside. */
static void buffers_lie_in_the_text_or_beside_it(void **state)
{
    (void)state;
    static const char form[] =
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"uri\":\"%s\",\"byteLength\":36}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,"
        "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],\"nodes\":[{\"mesh\":0}],"
        "\"images\":[{\"uri\":\"no-such-image.png\"},{\"uri\":\"data:image/png;base64,AAAA\"}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]}";
    static const struct {
        const char *uri;
        cw_status status;
        const char *words;
    } rows[] = {
        {"data:application/"
         "octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA",
         CW_OK, NULL},
        {"DATA:application/gltf-buffer;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA",
         CW_OK, NULL},
        {"my%20corners.bin", CW_OK, NULL},
        {"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAA", CW_ERR_FORMAT,
         "buffers[0].byteLength: 36 bytes are more than the 18 there are"},
        {"data:application/"
         "octet-stream;base64,AAAAAAAAAAAAAAAA*ACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA",
         CW_ERR_FORMAT, "is not base64"},
        {"data:application/octet-stream,abc", CW_ERR_FORMAT, "is not base64"},
        {"short.bin", CW_ERR_FORMAT, "buffers[0].byteLength: 36 bytes are more than the 5"},
        {"none.bin", CW_ERR_IO, "none.bin: cannot be opened"},
        {"../corners.bin", CW_ERR_UNSAFE, "a path with '..'"},
        {"%2e%2e%2fcorners.bin", CW_ERR_UNSAFE, "a path with '..'"},
        {"/etc/passwd", CW_ERR_UNSAFE, "an absolute path"},
        {"https://example.org/a.bin", CW_ERR_UNSAFE, "an address"},
        {"a%00b", CW_ERR_UNSAFE, "a zero"},
    };
    test_file_write(test_path("my corners.bin"), bin.corners, sizeof bin.corners);
    test_file_write(test_path("short.bin"), "short", 5);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char json[2048];
        cw_mesh mesh;
        cw_error err = {0};
        snprintf(json, sizeof json, form, rows[i].uri);
        const cw_status st = read_text("a.gltf", json, &mesh, NULL, &err);
        if (rows[i].status != CW_OK) {
            assert_fails(st, rows[i].status, rows[i].words, err);
            continue;
        }
        assert_ok(st, err);
        check_point(&mesh, 2, 0, 0, 1000);
        cw_mesh_free(&mesh);
    }
}

static void a_build_without_the_module_names_the_option(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_error err = {0};
    assert_fails(read_text("a.gltf", "{}", &mesh, NULL, &err), CW_ERR_UNSUPPORTED,
                 "-DCUBEWRIGHT_GLTF=ON", err);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)

int main(void)
{
    const struct CMUnitTest without[] = {TEST(a_build_without_the_module_names_the_option)};
    const struct CMUnitTest with[] = {
        TEST(bytes_as_indices_and_a_plain_node),
        TEST(strips_fans_and_vertices_without_indices),
        TEST(points_and_lines_are_counted_and_left_out),
        TEST(primitives_are_merged),
        TEST(colors_are_turned_to_srgb),
        TEST(quantized_positions_are_shares_of_the_largest),
        TEST(nodes_place_meshes_and_mirrors_turn_the_winding),
        TEST(levels_of_detail_are_counted_and_left_out),
        TEST(what_has_no_scale_is_hidden),
        TEST(floats_are_light_and_bytes_are_rounded),
        TEST(normals_turn_with_their_node),
        TEST(far_nodes_get_an_origin),
        TEST(what_we_wrote_comes_back_to_the_bit),
        TEST(buffers_lie_in_the_text_or_beside_it),
    };
    return cwi_module_present("gltf") ? cmocka_run_group_tests(with, NULL, NULL)
                                      : cmocka_run_group_tests(without, NULL, NULL);
}
