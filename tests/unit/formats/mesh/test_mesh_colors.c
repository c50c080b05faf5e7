/* Names, labels and colours of parts, vertices and faces, from file to file. */
#include "support/meshes.h"

#include "core/base/module.h"

#include <stdio.h>
#include <stdlib.h>

/* A colour of its own for each element, also dark and translucent ones. */
static void fill_colors(uint8_t *colors, size_t count)
{
    for (size_t i = 0; i < 4 * count; i++)
        colors[i] = (uint8_t)(i % 4 == 3 ? 255 - 10 * (i / 4 % 3) : 37 * i + i * i % 11);
}

static uint8_t *add_face_colors(cw_mesh *mesh)
{
    static const cw_attribute like = {.name = CW_FACE_COLORS,
                                      .on = CW_ON_TRIANGLES,
                                      .type = CW_U8,
                                      .components = 4,
                                      .interpolation = CW_INTERPOLATE_COLOR};
    cw_attribute *row = NULL;
    cw_error err = {0};
    assert_ok(cw_mesh_attribute_add(mesh, &like, &row, &err), err);
    fill_colors(row->data, mesh->triangle_count);
    return row->data;
}

static const uint8_t *face_colors(const cw_mesh *mesh)
{
    const cw_attribute *row = cw_mesh_attribute_find(mesh, CW_FACE_COLORS);
    return row ? row->data : NULL;
}

/* All formats that hold colours of faces give them back, beside those of vertices or without. */
static void faces_keep_their_colours(void **state)
{
    (void)state;
    static const char *const names[] = {"a.ply", "b.ply", "a.off", "a.obj", "a.3mf", "a.vtp"};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        cw_mesh mesh, back;
        cw_error err = {0};
        cw_write_loss loss;
        const cw_write_desc desc = {.text = *names[n] == 'b'};
        test_make_cube(&mesh);
        const uint8_t *colors = add_face_colors(&mesh);
        assert_ok(cw_mesh_write_loss(test_path(names[n]), &mesh, &desc, &loss, &err), err);
        assert_int_equal(loss.dropped & (CW_KEEPS_FACE_COLORS | CW_KEEPS_ATTRIBUTES), 0);
        assert_ok(cw_mesh_write(test_path(names[n]), &mesh, &desc, &err), err);
        assert_ok(cw_mesh_read(test_path(names[n]), NULL, &back, NULL, &err), err);
        assert_int_equal(back.triangle_count, mesh.triangle_count);
        assert_non_null(face_colors(&back));
        assert_null(back.colors);
        assert_memory_equal(face_colors(&back), colors, 4 * mesh.triangle_count);
        cw_mesh_free(&back);
        cw_mesh_free(&mesh);
    }
}

static void faces_without_a_place_for_colours_are_told(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_error err = {0};
    cw_write_loss loss;
    const cw_write_desc text = {.text = true};
    test_make_cube(&mesh);
    add_face_colors(&mesh);
    assert_ok(cw_mesh_write_loss("a.stl", &mesh, &text, &loss, &err), err);
    assert_int_equal(loss.dropped, CW_KEEPS_SHARING | CW_KEEPS_NORMALS | CW_KEEPS_FACE_COLORS);
    assert_string_equal(loss.attributes, "");
    cw_mesh_free(&mesh);
}

/* --- OBJ ----------------------------------------------------------------------------------- */

#define FACE "f 1 2 3\n"

static void vertices_of_obj_have_colours(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        uint8_t colors[3][4];
    } rows[] = {
        {"v 0 0 0 1 0.5019 0\nv 1 0 0 1 0.5019 0\nv 0 1 0 0 0 1\n" FACE,
         {{255, 128, 0, 255}, {255, 128, 0, 255}, {0, 0, 255, 255}}},
        {"v 0 0 0 255 128 0\nv 1 0 0 1 2 3\nv 0 1 0 0 0 1 # last\n" FACE,
         {{255, 128, 0, 255}, {1, 2, 3, 255}, {0, 0, 1, 255}}},
        {"v 0 0 0\nv 1 0 0 0 1 0\nv 0 1 0 1.0\n" FACE,
         {{255, 255, 255, 255}, {0, 255, 0, 255}, {255, 255, 255, 255}}},
        {"v 0 0 0 -1 nan 0\nv 1 0 0 0 1 0 0.25\nv 0 1 0 0 0 0\n" FACE,
         {{0, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 0, 255}}},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        cw_mesh mesh;
        cw_error err = {0};
        assert_ok(read_text("a.obj", rows[n].text, &mesh, NULL, &err), err);
        assert_non_null(mesh.colors);
        assert_memory_equal(mesh.colors, rows[n].colors, 12);
        cw_mesh_free(&mesh);
    }
    cw_mesh mesh;
    cw_error err = {0};
    assert_ok(read_text("a.obj", "v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\n" FACE, &mesh, NULL, &err),
              err);
    assert_null(mesh.colors); /* weights */
    cw_mesh_free(&mesh);
}

static void write_file(const char *name, const char *text)
{
    test_file_write(test_path(name), text, strlen(text));
}

#define SQUARE "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"

static void faces_of_obj_have_colours_of_materials(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_mesh_file file;
    cw_error err = {0};
    write_file("m.mtl", "newmtl blue\nKd 0 0 1\nnewmtl red one\n  Kd 1 0 0\nd 0.2\nKs 1 1 1\n"
                        "newmtl bare\nmap_Kd wood.png\nnewmtl blue\nKd 1 1 1\n");
    assert_ok(read_text("a.obj",
                        "mtllib m.mtl\n" SQUARE "usemtl red one\nf 1 2 3\nusemtl blue\n"
                        "f 1 3 4\nusemtl nothing\nf 1 4 2\nvt 0 0\n",
                        &mesh, &file, &err),
              err);
    static const uint8_t faces[12] = {255, 0, 0, 51, 0, 0, 255, 255, 255, 255, 255, 255};
    assert_memory_equal(face_colors(&mesh), faces, 12);
    assert_string_equal(file.left_out, "");
    cw_mesh_free(&mesh);

    /* no vertex has two: they are colours of vertices, and each part has its own */
    cw_part *parts;
    size_t count;
    write_file("b.obj", "mtllib m.mtl\n" SQUARE "o one\nusemtl blue\nf 1 2 3\n" SQUARE
                        "o two\nusemtl red one\nf 5 6 7\n");
    assert_ok(cw_parts_read(test_path("b.obj"), NULL, &parts, &count, NULL, &err), err);
    assert_int_equal(count, 2);
    assert_memory_equal(parts[0].mesh->colors + 4, faces + 4, 4);
    assert_memory_equal(parts[1].mesh->colors + 4, faces, 4);
    assert_null(face_colors(parts[0].mesh));
    cw_parts_free(parts, count);

    assert_ok(read_text("a.obj", "mtllib m.mtl\n" SQUARE "usemtl bare\nf 1 2 3\n", &mesh, &file,
                        &err),
              err);
    assert_null(mesh.colors);
    assert_string_equal(file.left_out, "");
    cw_mesh_free(&mesh);
}

/* Faces before the first colour are white, also where they are many. */
static void faces_before_the_first_colour_have_none(void **state)
{
    (void)state;
#define PLATE "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
    static const struct {
        const char *name, *text;
    } rows[] = {
        {"a.obj", "mtllib m.mtl\n" SQUARE "f 1 2 3\nusemtl blue\nf 1 3 4\n"},
        {"b.obj", "mtllib m.mtl\n" SQUARE "usemtl none\nf 1 2 3\nusemtl blue\nf 1 3 4\n"},
        {"a.off", PLATE "3 0 1 2\n3 0 2 3 0 0 255\n"},
    };
    write_file("m.mtl", "newmtl blue\nKd 0 0 1\n");
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        static const uint8_t expected[8] = {255, 255, 255, 255, 0, 0, 255, 255};
        cw_mesh mesh;
        cw_error err = {0};
        assert_ok(read_text(rows[n].name, rows[n].text, &mesh, NULL, &err), err);
        assert_non_null(face_colors(&mesh));
        assert_memory_equal(face_colors(&mesh), expected, 8);
        cw_mesh_free(&mesh);
    }
}

/* Shapes do not depend on materials. */
static void materials_that_are_missing_are_told(void **state)
{
    (void)state;
    static const char *const names[] = {"none.mtl", "../x.mtl", "/etc/passwd", "", "a.obj/b"};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        char text[256];
        cw_mesh mesh;
        cw_mesh_file file;
        cw_error err = {0};
        snprintf(text, sizeof text, "mtllib %s\n" SQUARE "usemtl blue\nf 1 2 3\n", names[n]);
        assert_ok(read_text("a.obj", text, &mesh, &file, &err), err);
        assert_int_equal(mesh.triangle_count, 1);
        assert_string_equal(file.left_out, "materials of a missing or damaged file");
        cw_mesh_free(&mesh);
    }
}

/* --- labels and materials of glTF ---------------------------------------------------------- */

static void check_label(const cw_part *part, const cw_label *label, const char *name)
{
    assert_string_equal(part->name, name);
    assert_non_null(part->label);
    assert_int_equal(part->label->value, label->value);
    assert_true(part->label->has_color);
    assert_memory_equal(part->label->color, label->color, 4);
    assert_null(part->mesh->colors); /* those of the label */
}

static void labels_come_back_through_gltf(void **state)
{
    (void)state;
    const cw_label labels[2] = {{.value = 17,
                                 .layer = 2,
                                 .color = {1, 128, 254, 51},
                                 .has_color = true,
                                 .type = {.scheme = "SCT", .meaning = "Liver"}},
                                {.value = 9, .color = {255, 255, 255, 255}, .has_color = true}};
    cw_mesh cube, tetrahedron, mesh;
    cw_part *parts, *again;
    size_t count;
    cw_error err = {0};
    if (!cwi_module_present("gltf"))
        skip();
    test_make_cube(&cube);
    test_make_tetrahedron(&tetrahedron);
    const cw_part given[2] = {{.mesh = &cube, .name = "left lobe", .label = labels},
                              {.mesh = &tetrahedron, .name = "bone", .label = labels + 1}};
    assert_ok(cw_parts_write(test_path("a.glb"), given, 2, NULL, &err), err);
    assert_ok(cw_parts_read(test_path("a.glb"), NULL, &parts, &count, NULL, &err), err);
    assert_int_equal(count, 2);
    assert_ok(cw_parts_write(test_path("b.gltf"), parts, count, NULL, &err), err);
    assert_ok(cw_parts_read(test_path("b.gltf"), NULL, &again, &count, NULL, &err), err);
    assert_int_equal(count, 2);
    for (size_t p = 0; p < 2; p++) {
        check_label(&parts[p], &labels[p], given[p].name);
        check_label(&again[p], &labels[p], given[p].name);
    }
    assert_int_equal(again[0].label->layer, 2);
    assert_string_equal(again[0].label->type.scheme, "SCT");
    assert_string_equal(again[0].label->type.meaning, "Liver");
    assert_null(again[0].label->type.value);
    cw_parts_free(parts, 2);
    cw_parts_free(again, 2);

    /* as one mesh */
    assert_ok(cw_mesh_read(test_path("a.glb"), NULL, &mesh, NULL, &err), err);
    assert_int_equal(mesh.labels[0], 17);
    assert_int_equal(mesh.labels[mesh.vertex_count - 1], 9);
    assert_memory_equal(mesh.colors, labels[0].color, 4);
    assert_memory_equal(mesh.colors + 4 * (mesh.vertex_count - 1), labels[1].color, 4);
    cw_mesh_free(&mesh);
    cw_mesh_free(&cube);
    cw_mesh_free(&tetrahedron);
}

/* A part whose vertices have one colour has a material of it, so that all viewers show it. */
static void parts_of_one_colour_keep_it(void **state)
{
    (void)state;
    static const char *const names[] = {"a.glb", "a.3mf", "a.obj"};
    static const uint8_t colors[3][4] = {
        {10, 13, 14, 255}, {255, 255, 255, 255}, {3, 0, 2, 51}};
    for (size_t n = cwi_module_present("gltf") ? 0 : 1; n < 3; n++)
        for (size_t c = 0; c < 3; c++) {
            cw_mesh cube, back;
            cw_error err = {0};
            test_make_cube(&cube);
            cube.colors = malloc(4 * cube.vertex_count);
            assert_non_null(cube.colors);
            for (size_t v = 0; v < cube.vertex_count; v++)
                memcpy(cube.colors + 4 * v, colors[c], 4);
            assert_ok(cw_mesh_write(test_path(names[n]), &cube, NULL, &err), err);
            assert_ok(cw_mesh_read(test_path(names[n]), NULL, &back, NULL, &err), err);
            assert_non_null(back.colors);
            assert_memory_equal(back.colors, cube.colors, 4 * cube.vertex_count);
            cw_mesh_free(&back);
            cw_mesh_free(&cube);
        }
}

/* Four corners of a square as floats, then the triangles 0 1 2 and 0 2 3, then 8-bit colours. */
#define GLTF_BUFFER                                                                            \
    "\"buffers\":[{\"byteLength\":76,\"uri\":\"data:;base64,"                                  \
    "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAACAPwAAgD8AAAAAAAAAAAAAgD8AAAAAAAABAAIAAAACAAMA"         \
    "////////////////gICA/w==\"}],"                                                            \
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48},{\"buffer\":0,\"byteOffset\":48,"       \
    "\"byteLength\":12},{\"buffer\":0,\"byteOffset\":60,\"byteLength\":16}],"                  \
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\","   \
    "\"min\":[0,0,0],\"max\":[1,1,0]},"                                                        \
    "{\"bufferView\":1,\"componentType\":5123,\"count\":3,\"type\":\"SCALAR\"},"               \
    "{\"bufferView\":1,\"byteOffset\":6,\"componentType\":5123,\"count\":3,"                   \
    "\"type\":\"SCALAR\"},{\"bufferView\":2,\"componentType\":5121,\"normalized\":true,"       \
    "\"count\":4,\"type\":\"VEC4\"}],"
#define GLTF_MATERIALS                                                                         \
    "\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,0,0,1]}},"               \
    "{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0,0,1,0.4],\"baseColorTexture\":"         \
    "{\"index\":0}}},{\"name\":\"none\"}],"
#define GLTF_TEXT(primitives, nodes, materials)                                                \
    "{\"asset\":{\"version\":\"2.0\"}," GLTF_BUFFER materials                                  \
    "\"meshes\":[{\"name\":\"plate\",\"primitives\":[" primitives "]}],"                       \
    "\"nodes\":[" nodes "]}"
#define PRIMITIVE(indices, more)                                                               \
    "{\"attributes\":{\"POSITION\":0" more "},\"indices\":" #indices ",\"material\":" #indices \
    "}"

static void materials_of_gltf_colour_faces_or_vertices(void **state)
{
    (void)state;
    static const uint8_t red[4] = {255, 0, 0, 255}, blue[4] = {0, 0, 255, 102};
    cw_mesh mesh;
    cw_mesh_file file;
    cw_part *parts;
    size_t count;
    cw_error err = {0};
    if (!cwi_module_present("gltf"))
        skip();
    /* primitives that share vertices: accessor 1 has material 1, 2 has 2, which is white */
    assert_ok(read_text("a.gltf",
                        GLTF_TEXT(PRIMITIVE(1, "") "," PRIMITIVE(2, ""), "{\"mesh\":0}",
                                  GLTF_MATERIALS),
                        &mesh, &file, &err),
              err);
    assert_int_equal(mesh.vertex_count, 4);
    assert_memory_equal(face_colors(&mesh), blue, 4);
    assert_string_equal(file.left_out, "");
    cw_mesh_free(&mesh);
    /* COLOR_0 times the base colour */
    assert_ok(
        read_text("a.gltf",
                  GLTF_TEXT("{\"attributes\":{\"POSITION\":0,\"COLOR_0\":3},\"indices\":1,"
                            "\"material\":0}",
                            "{\"mesh\":0}", GLTF_MATERIALS),
                  &mesh, &file, &err),
        err);
    assert_memory_equal(mesh.colors, red, 4);
    assert_int_equal(mesh.colors[4 * 3], 188); /* half of the light */
    assert_int_equal(mesh.colors[4 * 3 + 1], 0);
    cw_mesh_free(&mesh);
    /* names of nodes, else of meshes; escapes; no colour without materials */
    write_file("a.gltf", GLTF_TEXT(PRIMITIVE(1, ""),
                                   "{\"mesh\":0,\"name\":\"a \\u00e9\\u0001\"},{\"mesh\":0,"
                                   "\"translation\":[5,0,0]}",
                                   ""));
    assert_ok(cw_parts_read(test_path("a.gltf"), NULL, &parts, &count, NULL, &err), err);
    assert_int_equal(count, 2);
    assert_string_equal(parts[0].name, "a \xc3\xa9_");
    assert_string_equal(parts[1].name, "plate");
    assert_null(parts[0].mesh->colors);
    assert_null(parts[0].label);
    cw_parts_free(parts, count);
}

/* Looks that are wrong are left out, as a whole. */
static void materials_of_gltf_that_are_wrong_change_no_shape(void **state)
{
    (void)state;
    static const char *const texts[] = {
        GLTF_TEXT(PRIMITIVE(1, ""), "{\"mesh\":0}", "\"materials\":{},"),
        GLTF_TEXT(PRIMITIVE(1, ""), "{\"mesh\":0}", "\"materials\":[null,3],"),
        GLTF_TEXT(PRIMITIVE(1, ""), "{\"mesh\":0}",
                  "\"materials\":[{},{\"pbrMetallicRoughness\":{\"baseColorFactor\":[9,0]}}],"),
        GLTF_TEXT(PRIMITIVE(1, ""), "{\"mesh\":0}",
                  "\"materials\":[{},{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0,1]}}],"),
        GLTF_TEXT(PRIMITIVE(1, ""), "{\"mesh\":0}", "\"materials\":[{}],"),
    };
    if (!cwi_module_present("gltf"))
        skip();
    for (size_t n = 0; n < sizeof texts / sizeof *texts; n++) {
        cw_mesh mesh;
        cw_error err = {0};
        assert_ok(read_text("a.gltf", texts[n], &mesh, NULL, &err), err);
        assert_int_equal(mesh.triangle_count, 1);
        assert_null(mesh.colors);
        cw_mesh_free(&mesh);
    }
}

/* --- PLY ----------------------------------------------------------------------------------- */

static void ply_states_colours_in_several_ways(void **state)
{
    (void)state;
    static const char *const names[][3] = {{"red", "green", "blue"},
                                           {"diffuse_red", "diffuse_green", "diffuse_blue"}};
    for (size_t n = 0; n < 2; n++)
        for (int real = 0; real < 2; real++) {
            char text[800];
            cw_mesh mesh;
            cw_error err = {0};
            const char *type = real ? "float" : "uchar";
            snprintf(
                text, sizeof text,
                "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float "
                "y\nproperty float z\nelement face 2\nproperty %s %s\nproperty list uchar "
                "int vertex_index\nproperty %s %s\nproperty %s %s\nend_header\n0 0 0\n1 0 "
                "0\n1 1 0\n0 1 0\n%s\n%s\n",
                type, names[n][0], type, names[n][1], type, names[n][2],
                real ? "1 4 0 1 2 3 0.2 0" : "255 4 0 1 2 3 51 0", "0 3 0 2 1 0 1");
            assert_ok(read_text("a.ply", text, &mesh, NULL, &err), err);
            const uint8_t *colors = face_colors(&mesh);
            assert_non_null(colors);
            static const uint8_t first[8] = {255, 51, 0, 255, 255, 51, 0, 255};
            assert_memory_equal(colors, first, 8); /* both triangles of the polygon */
            assert_int_equal(colors[10], real ? 255 : 1);
            cw_mesh_free(&mesh);
        }
}

static void memory_may_run_out_anywhere(void **state)
{
    (void)state;
    static const char *const names[] = {"a.ply", "a.off", "a.obj", "a.3mf", "a.vtp"};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        cw_mesh mesh;
        cw_error err = {0};
        test_make_cube(&mesh);
        add_face_colors(&mesh);
        assert_ok(cw_mesh_write(test_path(names[n]), &mesh, NULL, &err), err);
        check_starved_mesh_reads(names[n]);
        cw_mesh_free(&mesh);
    }
    write_file("v.obj", "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 0 0 1\n" FACE);
    check_starved_mesh_reads("v.obj");
    write_file("m.mtl", "newmtl blue\nKd 0 0 1\n");
    write_file("m.obj", "mtllib m.mtl\n" SQUARE "usemtl blue\nf 1 2 3\nf 1 3 4\n");
    check_starved_mesh_reads("m.obj");
    if (!cwi_module_present("gltf"))
        return;
    write_file("m.gltf", GLTF_TEXT(PRIMITIVE(1, "") "," PRIMITIVE(2, ""), "{\"mesh\":0}",
                                   GLTF_MATERIALS));
    check_starved_mesh_reads("m.gltf");
}

/* OBJ has no opacity of vertices; a part of one colour has it in its material. */
static void opacity_that_is_lost_is_told(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_error err = {0};
    cw_write_loss loss;
    test_make_cube(&mesh);
    mesh.colors = malloc(4 * mesh.vertex_count);
    assert_non_null(mesh.colors);
    memset(mesh.colors, 99, 4 * mesh.vertex_count);
    assert_ok(cw_mesh_write_loss("a.obj", &mesh, NULL, &loss, &err), err);
    assert_int_equal(loss.dropped, 0);
    mesh.colors[0] = 98;
    assert_ok(cw_mesh_write_loss("a.obj", &mesh, NULL, &loss, &err), err);
    assert_int_equal(loss.dropped, CW_KEEPS_OPACITY);
    assert_ok(cw_mesh_write_loss("a.ply", &mesh, NULL, &loss, &err), err);
    assert_int_equal(loss.dropped, 0);
    cw_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(faces_keep_their_colours),
        cmocka_unit_test(faces_without_a_place_for_colours_are_told),
        cmocka_unit_test(vertices_of_obj_have_colours),
        cmocka_unit_test(faces_of_obj_have_colours_of_materials),
        cmocka_unit_test(faces_before_the_first_colour_have_none),
        cmocka_unit_test(materials_that_are_missing_are_told),
        cmocka_unit_test(labels_come_back_through_gltf),
        cmocka_unit_test(parts_of_one_colour_keep_it),
        cmocka_unit_test(materials_of_gltf_colour_faces_or_vertices),
        cmocka_unit_test(materials_of_gltf_that_are_wrong_change_no_shape),
        cmocka_unit_test(ply_states_colours_in_several_ways),
        cmocka_unit_test(memory_may_run_out_anywhere),
        cmocka_unit_test(opacity_that_is_lost_is_told),
    };
    return cmocka_run_group_tests(tests, test_folder_make, test_folder_remove);
}
