/* Texture coordinates in written files: glTF and OBJ keep them, also compressed and with colours. */
#include "support/meshes.h"
#include "support/solids.h"

#include "core/geometry/vec3.h"
#include "core/mesh/mesh_triangle.h"
#include "core/texture/split_seams.h"

#include <cubewright/atlas.h>

#include <stdio.h>

static const cw_attribute coordinates = {.name = CW_TEXTURE_COORDINATES,
                                         .on = CW_ON_CORNERS,
                                         .type = CW_F32,
                                         .components = 2,
                                         .interpolation = CW_INTERPOLATE_LINEAR};

/* A cube with an atlas: its 8 vertices have more than 8 places in the texture. */
static void make_textured(cw_mesh *cube)
{
    cw_error err = {0};
    *cube = test_make_boxes(1);
    test_add_box(cube, (const double[]){0, 0, 0}, (const double[]){1, 1, 1}, false);
    assert_ok(cw_mesh_atlas(cube, &(cw_atlas_desc){.size = 256}, NULL, &err), err);
}

static char *write_and_read(const cw_mesh *mesh, const char *name, const cw_write_desc *desc)
{
    cw_error err = {0};
    size_t size;
    assert_ok(cw_mesh_write(test_path(name), mesh, desc, &err), err);
    return test_file_read(test_path(name), &size);
}

static void obj_names_the_place_of_each_corner(void **state)
{
    (void)state;
    cw_mesh cube;
    make_textured(&cube);
    const float *uv = cw_mesh_attribute_find(&cube, CW_TEXTURE_COORDINATES)->data;
    for (int with_normals = 0; with_normals < 2; with_normals++) {
        cw_error err = {0};
        if (with_normals)
            assert_ok(cw_mesh_normals(&cube, &err), err);
        char *text = write_and_read(&cube, "a.obj", NULL);
        double places[64][2];
        size_t count = 0, corner = 0;
        for (char *line = strtok(text, "\n"); line; line = strtok(NULL, "\n")) {
            unsigned v[3], t[3], n[3];
            if (sscanf(line, "vt %lf %lf", &places[count][0], &places[count][1]) == 2)
                count++;
            const int found = with_normals
                                  ? sscanf(line, "f %u/%u/%u %u/%u/%u %u/%u/%u", &v[0], &t[0],
                                           &n[0], &v[1], &t[1], &n[1], &v[2], &t[2], &n[2])
                                  : sscanf(line, "f %u/%u %u/%u %u/%u", &v[0], &t[0], &v[1],
                                           &t[1], &v[2], &t[2]);
            for (int k = 0; k < 3 && found == (with_normals ? 9 : 6); k++, corner++) {
                assert_int_equal(v[k], cube.triangles[corner] + 1);
                assert_true(t[k] >= 1 && t[k] <= count);
                assert_near(places[t[k] - 1][0], (double)uv[2 * corner], 1e-8);
                assert_near(places[t[k] - 1][1], 1 - (double)uv[2 * corner + 1], 1e-8);
            }
        }
        assert_int_equal(corner, 36);
        assert_true(count > 8 && count <= 36);
        free(text);
    }
    cw_mesh_free(&cube);
}

static size_t count_words(const char *text, const char *word)
{
    size_t count = 0;
    for (const char *at = strstr(text, word); at; at = strstr(at + 1, word))
        count++;
    return count;
}

/* All forms of glTF name the coordinates; what was compressed is decoded and compared on the way. */
static void gltf_splits_vertices_at_seams(void **state)
{
    (void)state;
    cw_mesh cube, split;
    cw_error err = {0};
    make_textured(&cube);
    assert_ok(cwi_split_seams(&cube, &split, &err), err);
    for (cw_compression kind = CW_COMPRESS_NONE; kind <= CW_COMPRESS_MESHOPT; kind++) {
        const cw_write_desc desc = {.compression = kind};
        char name[32], vertices[32];
        snprintf(name, sizeof name, "%d.gltf", (int)kind);
        const cw_status st = cw_mesh_write(test_path(name), &cube, &desc, &err);
        if (st == CW_ERR_UNSUPPORTED) /* that codec is not in this build */
            continue;
        assert_ok(st, err);
        size_t size;
        char *text = test_file_read(test_path(name), &size);
        assert_int_equal(count_words(text, "\"TEXCOORD_0\""),
                         kind == CW_COMPRESS_DRACO ? 2 : 1);
        snprintf(vertices, sizeof vertices, "\"count\":%zu", split.vertex_count);
        assert_true(count_words(text, vertices) >= 2);
        free(text);
        cw_mesh back;
        assert_ok(cw_mesh_read(test_path(name), NULL, &back, NULL, &err), err);
        assert_int_equal(back.triangle_count, 12);
        cw_mesh_free(&back);
    }
    cw_mesh_free(&split);
    cw_mesh_free(&cube);
}

/* More colours than groups: vertices are split at seams, then by colour, and keep their coordinates. */
static void colours_of_faces_and_coordinates_go_together(void **state)
{
    (void)state;
    static const cw_attribute colors = {.name = CW_FACE_COLORS,
                                        .on = CW_ON_TRIANGLES,
                                        .type = CW_U8,
                                        .components = 4,
                                        .interpolation = CW_INTERPOLATE_COLOR};
    cw_attribute *row;
    cw_error err = {0};
    cw_mesh cube;
    make_textured(&cube);
    assert_ok(cw_mesh_attribute_add(&cube, &colors, &row, &err), err);
    for (size_t t = 0; t < cube.triangle_count; t++)
        memcpy((uint8_t *)row->data + 4 * t, (uint8_t[4]){(uint8_t)(20 * t), 9, 9, 255}, 4);
    for (int by_meshopt = 0; by_meshopt < 2; by_meshopt++) {
        const cw_write_desc desc = {.compression =
                                        by_meshopt ? CW_COMPRESS_MESHOPT : CW_COMPRESS_NONE};
        const cw_status st = cw_mesh_write(test_path("c.gltf"), &cube, &desc, &err);
        if (st == CW_ERR_UNSUPPORTED)
            continue;
        assert_ok(st, err);
        size_t size;
        char *text = test_file_read(test_path("c.gltf"), &size);
        assert_int_equal(count_words(text, "\"TEXCOORD_0\""), by_meshopt ? 1 : 12);
        free(text);
    }
    cw_mesh_free(&cube);
}

static void coordinates_of_vertices_are_written_as_they_are(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_mesh cube, split;
    make_textured(&cube);
    assert_ok(cwi_split_seams(&cube, &split, &err), err);
    char *text = write_and_read(&split, "v.obj", NULL);
    assert_int_equal(count_words(text, "\nvt "), split.vertex_count);
    free(text);
    if (cw_mesh_format("v.gltf", NULL)->in_this_build) {
        text = write_and_read(&split, "v.gltf", NULL);
        assert_int_equal(count_words(text, "\"TEXCOORD_0\""), 1);
        free(text);
    }
    cw_mesh_free(&split);
    cw_mesh_free(&cube);
}

/* A cube has 24 normals in a file, and 8 vertices stay 8 where a format can say so. */
static void creases_are_written(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_write_loss loss;
    cw_mesh cube, read = {0};
    for (int textured = 0; textured < 2; textured++) {
        make_textured(&cube);
        if (!textured)
            cw_mesh_attribute_remove(&cube, CW_TEXTURE_COORDINATES);
        const cw_part part = {.mesh = &cube};
        assert_ok(cw_mesh_crease_normals(&cube, 30, NULL, NULL, &err), err);
        char *text = write_and_read(&cube, "k.obj", NULL);
        assert_int_equal(count_words(text, "\nv "), 8);
        assert_true(count_words(text, "\nvn ") >= 24);
        assert_int_equal(count_words(text, "\nf "), 12);
        free(text);
        assert_ok(cw_parts_write_loss("k.ply", &part, 1, NULL, &loss, &err), err);
        assert_true(loss.dropped & CW_KEEPS_CREASES);
        assert_false(loss.dropped & CW_KEEPS_ATTRIBUTES);
        if (cw_mesh_format("k.glb", NULL)->in_this_build) {
            assert_ok(cw_parts_write_loss("k.glb", &part, 1, NULL, &loss, &err), err);
            assert_int_equal(loss.dropped & (CW_KEEPS_CREASES | CW_KEEPS_ATTRIBUTES), 0);
            assert_ok(cw_mesh_write(test_path("k.glb"), &cube, NULL, &err), err);
            assert_ok(cw_mesh_read(test_path("k.glb"), NULL, &read, NULL, &err), err);
            assert_int_equal(read.vertex_count, 24);
            for (size_t c = 0; c < 3 * read.triangle_count; c++) {
                double normal[3];
                cwi_mesh_normal(&read, c / 3, normal);
                assert_true(cwi_normalise(normal));
                for (size_t a = 0; a < 3; a++)
                    assert_near((double)read.normals[3 * (size_t)read.triangles[c] + a],
                                normal[a], 1e-6);
            }
            cw_mesh_free(&read);
        }
        cw_mesh_free(&cube);
    }
}

/* A normal map is in the file once, with tangents, and needs coordinates. */
static void normal_maps_are_embedded(void **state)
{
    (void)state;
    static const uint8_t png[] = {0x89, 'P', 'N', 'G', 13, 10, 26, 10, 1, 2, 3};
    const cw_textures textures = {.normal = {png, sizeof png}};
    cw_error err = {0};
    cw_write_loss loss;
    cw_mesh cube;
    make_textured(&cube);
    assert_ok(cw_mesh_normals(&cube, &err), err);
    const cw_part parts[] = {{.mesh = &cube, .name = "a", .textures = &textures},
                             {.mesh = &cube, .name = "b", .textures = &textures},
                             {.mesh = &cube, .name = "c"}};
    for (cw_compression kind = CW_COMPRESS_NONE; kind <= CW_COMPRESS_MESHOPT; kind++) {
        const cw_write_desc desc = {.compression = kind};
        const cw_status st = cw_parts_write(test_path("n.glb"), parts, 3, &desc, &err);
        if (st == CW_ERR_UNSUPPORTED)
            continue;
        assert_ok(st, err);
        size_t size;
        char *file = test_file_read(test_path("n.glb"), &size), *json = file + 20;
        const size_t length = (size_t)(unsigned char)file[12] | (size_t)(unsigned char)file[13]
                                                                    << 8;
        json[length - 1] = 0;
        assert_int_equal(count_words(json, "\"normalTexture\""), 2);
        assert_int_equal(count_words(json, "image/png"), 1);
        assert_int_equal(count_words(json, "\"TANGENT\""),
                         kind == CW_COMPRESS_DRACO ? 4 : 2);    /* in the extension, too */
        assert_memory_equal(file + size - 12, png, sizeof png); /* the last of the buffer */
        free(file);
    }
    if (cw_mesh_format("n.glb", NULL)->in_this_build) {
        assert_ok(cw_parts_write_loss("n.glb", parts, 3, NULL, &loss, &err), err);
        assert_int_equal(loss.dropped & CW_KEEPS_PICTURES, 0);
        cw_mesh_attribute_remove(&cube, CW_TEXTURE_COORDINATES);
        assert_ok(cw_parts_write_loss("n.glb", parts, 1, NULL, &loss, &err), err);
        assert_int_equal(loss.dropped & CW_KEEPS_PICTURES, CW_KEEPS_PICTURES);
    }
    assert_ok(cw_parts_write_loss("n.ply", parts, 1, NULL, &loss, &err), err);
    assert_int_equal(loss.dropped & CW_KEEPS_PICTURES, CW_KEEPS_PICTURES);
    cw_mesh_free(&cube);
}

static void other_formats_tell_what_they_lose(void **state)
{
    (void)state;
    static const struct {
        const char *path;
        bool keeps;
    } rows[] = {{"a.glb", true},  {"a.gltf", true}, {"a.obj", true},  {"a.stl", false},
                {"a.ply", false}, {"a.off", false}, {"a.vtp", false}, {"a.3mf", false}};
    cw_error err = {0};
    cw_write_loss loss;
    cw_mesh cube;
    make_textured(&cube);
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        const cw_status st = cw_mesh_write_loss(rows[n].path, &cube, NULL, &loss, &err);
        if (st == CW_ERR_UNSUPPORTED)
            continue;
        assert_ok(st, err);
        assert_int_equal((loss.dropped & CW_KEEPS_TEXTURE) == 0, rows[n].keeps);
        assert_int_equal(loss.dropped & CW_KEEPS_ATTRIBUTES, 0);
    }
    cw_mesh_attribute_remove(&cube, CW_TEXTURE_COORDINATES);
    cw_attribute other = coordinates, *row;
    other.components = 3; /* none that files know */
    assert_ok(cw_mesh_attribute_add(&cube, &other, &row, &err), err);
    assert_ok(cw_mesh_write_loss("a.obj", &cube, NULL, &loss, &err), err);
    assert_int_equal(loss.dropped & (CW_KEEPS_TEXTURE | CW_KEEPS_ATTRIBUTES),
                     CW_KEEPS_ATTRIBUTES);
    cw_mesh_free(&cube);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(obj_names_the_place_of_each_corner, test_folder_make,
                                        test_folder_remove),
        cmocka_unit_test_setup_teardown(gltf_splits_vertices_at_seams, test_folder_make,
                                        test_folder_remove),
        cmocka_unit_test_setup_teardown(colours_of_faces_and_coordinates_go_together,
                                        test_folder_make, test_folder_remove),
        cmocka_unit_test_setup_teardown(coordinates_of_vertices_are_written_as_they_are,
                                        test_folder_make, test_folder_remove),
        cmocka_unit_test_setup_teardown(creases_are_written, test_folder_make,
                                        test_folder_remove),
        cmocka_unit_test_setup_teardown(normal_maps_are_embedded, test_folder_make,
                                        test_folder_remove),
        cmocka_unit_test(other_formats_tell_what_they_lose),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
