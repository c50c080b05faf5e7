/* Textured meshes in files: what is read, written, and read again is the same to the bit. */
#include "support/meshes.h"
#include "support/texture.h"

#include <cubewright/atlas.h>
#include <cubewright/quality.h>

#include <stdio.h>
#include <unistd.h>

static const uint8_t png[] = {0x89, 'P', 'N', 'G', 13, 10, 26, 10, 1, 2, 3},
                     jpeg[] = {0xff, 0xd8, 0xff, 0xe0, 9, 8, 7}, webp[] = "RIFF0000WEBPVP8 ";

static cw_mesh make_textured(void)
{
    cw_volume volume = test_sample(CW_FIELD_TORUS, 20, CW_F32);
    cw_mesh mesh = test_extract(&volume, &(cw_extract_desc){0}, NULL);
    cw_error err = {0};
    cw_volume_free(&volume);
    assert_ok(cw_mesh_atlas(&mesh, NULL, NULL, &err), err);
    return mesh;
}

static cw_part *read_parts(const char *name, size_t count, cw_mesh_file *file)
{
    cw_part *parts;
    size_t found;
    cw_error err = {0};
    assert_ok(cw_parts_read(test_path(name), NULL, &parts, &found, file, &err), err);
    assert_int_equal(found, count);
    return parts;
}

static void check_picture(const cw_texture *picture, const void *bytes, size_t size)
{
    assert_int_equal(picture->size, size);
    assert_memory_equal(picture->bytes, bytes, size);
}

static void check_same(const cw_mesh *mesh, const cw_mesh *back)
{
    assert_int_equal(back->triangle_count, mesh->triangle_count);
    assert_int_equal(back->vertex_count, mesh->vertex_count);
    assert_memory_equal(test_coordinates(back), test_coordinates(mesh),
                        3 * mesh->triangle_count * sizeof(float[2]));
    const cw_quality q = test_measure(back);
    assert_int_equal(q.open_edges, 0);
}

/* GLB, OBJ, GLB: vertices are split and joined, coordinates and pictures stay as they are. */
static void texture_and_pictures_come_back(void **state)
{
    (void)state;
    static const char *const names[] = {"a.glb", "b.obj", "c.glb", "d.gltf"};
    cw_mesh mesh = make_textured();
    const cw_textures set = {.color = {jpeg, sizeof jpeg},
                             .normal = {png, sizeof png},
                             .emissive = {webp, sizeof webp}};
    cw_part first = {.mesh = &mesh, .textures = &set}, *last = NULL;
    cw_error err = {0};
    if (!cw_mesh_format("a.glb", NULL)->in_this_build)
        skip();
    const cw_part *from = &first;
    for (size_t n = 0; n < 4; n++) {
        assert_ok(cw_parts_write(test_path(names[n]), from, 1, NULL, &err), err);
        cw_part *back = read_parts(names[n], 1, NULL);
        cw_parts_free(last, last ? 1 : 0);
        from = last = back;
        check_same(&mesh, back->mesh);
        assert_non_null(back->textures);
        check_picture(&back->textures->color, jpeg, sizeof jpeg);
        check_picture(&back->textures->normal, png, sizeof png);
        check_picture(&back->textures->emissive, webp, sizeof webp);
    }
    cw_parts_free(last, 1);
    cw_mesh_free(&mesh);
}

static void all_pictures_of_gltf_come_back(void **state)
{
    (void)state;
    cw_mesh mesh = make_textured();
    const cw_textures set = {.metallic_roughness = {jpeg, sizeof jpeg},
                             .occlusion = {jpeg, sizeof jpeg},
                             .has_factors = true,
                             .color_factor = {0.5F, 0.25F, 1, 1},
                             .metallic_factor = 0.5F,
                             .roughness_factor = 0.75F,
                             .emissive_factor = {0, 1, 0},
                             .occlusion_strength = 0.5F,
                             .repeats = true};
    const cw_part part = {.mesh = &mesh, .textures = &set};
    cw_error err = {0};
    if (!cw_mesh_format("a.glb", NULL)->in_this_build)
        skip();
    for (cw_compression kind = CW_COMPRESS_NONE; kind <= CW_COMPRESS_MESHOPT; kind++) {
        const cw_write_desc desc = {.compression = kind};
        const cw_status st = cw_parts_write(test_path("a.glb"), &part, 1, &desc, &err);
        if (st == CW_ERR_UNSUPPORTED)
            continue;
        assert_ok(st, err);
        cw_part *back = read_parts("a.glb", 1, NULL);
        const cw_textures *s = back->textures;
        assert_non_null(s);
        check_picture(&s->metallic_roughness, jpeg, sizeof jpeg);
        check_picture(&s->occlusion, jpeg, sizeof jpeg);
        assert_null(s->color.bytes);
        assert_true(s->has_factors && s->repeats && s->color_factor[1] == 0.25F &&
                    s->roughness_factor == 0.75F && s->emissive_factor[1] == 1 &&
                    s->occlusion_strength == 0.5F);
        assert_true(test_measure(back->mesh).open_edges == 0);
        cw_parts_free(back, 1);
    }
    cw_write_loss loss;
    assert_ok(cw_parts_write_loss("a.obj", &part, 1, NULL, &loss, &err), err);
    assert_true(loss.dropped & CW_KEEPS_MATERIALS);
    cw_mesh_free(&mesh);
}

#define SQUARES                                                                                \
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"

/* A part for each material with pictures, however often the file changes between them. */
static void materials_of_obj_are_parts(void **state)
{
    (void)state;
    static const char text[] =
        "mtllib m.mtl\n" SQUARES "usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 2/1 5/2 6/3\n"
        "usemtl a\nf -6/-4 -4/-2 -3/-1\nusemtl b\nf 2/1 6/3 3/4\n";
    static const char materials[] = "newmtl a\nmap_Kd -s 2 2 2 -clamp on my a.png\nnewmtl b\n"
                                    "norm b.png\nmap_Bump c.png\nmap_Ks d.png\n";
    test_file_write(test_path("m.mtl"), materials, strlen(materials));
    test_file_write(test_path("my a.png"), png, sizeof png);
    test_file_write(test_path("b.png"), jpeg, sizeof jpeg);
    test_file_write(test_path("a.obj"), text, strlen(text));
    cw_mesh_file file;
    cw_part *parts = read_parts("a.obj", 2, &file);
    for (int n = 0; n < 2; n++) {
        assert_int_equal(parts[n].mesh->triangle_count, 2);
        assert_int_equal(parts[n].mesh->vertex_count, 4);
    }
    check_picture(&parts[0].textures->color, png, sizeof png);
    check_picture(&parts[1].textures->normal, jpeg, sizeof jpeg);
    assert_non_null(strstr(file.left_out, "-o, -s and -t of textures"));
    assert_non_null(strstr(file.left_out, "other pictures"));
    const float(*uv)[2] = test_coordinates(parts[0].mesh);
    static const float expected[6][2] = {{0, 1}, {1, 1}, {1, 0}, {0, 1}, {1, 0}, {0, 0}};
    assert_memory_equal(uv, expected, sizeof expected);
    cw_parts_free(parts, 2);
    cw_mesh mesh; /* as one mesh it stays whole */
    cw_error err = {0};
    assert_ok(cw_mesh_read(test_path("a.obj"), NULL, &mesh, NULL, &err), err);
    assert_int_equal(mesh.vertex_count, 6);
    cw_mesh_free(&mesh);
}

/* Polygons that are no fans keep the places of their corners. */
static void ears_keep_their_places(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_error err = {0};
    assert_ok(read_text("a.obj",
                        "v 2 1 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 0 0 0\nvt 2 1\nvt 4 0\nvt 4 4\n"
                        "vt 0 4\nvt 0 0\nf 2/2 3/3 4/4 5/5 1/1\n",
                        &mesh, NULL, &err),
              err);
    const float(*uv)[2] = test_coordinates(&mesh);
    for (size_t c = 0; c < 3 * mesh.triangle_count; c++) {
        const float *p = mesh.positions + 3 * (size_t)mesh.triangles[c];
        assert_true(uv[c][0] == p[0] && uv[c][1] == 1 - p[1]);
    }
    cw_mesh_free(&mesh);
}

static void broken_textures_change_no_shape(void **state)
{
    (void)state;
    static const struct {
        const char *text, *words;
    } rows[] = {
        {SQUARES "f 1/9 2/2 3/3\n", "texture coordinates that are not there"},
        {SQUARES "f 1/-9 2/2 3/3\n", "texture coordinates that are not there"},
        {"mtllib n.mtl\n" SQUARES "usemtl out\nf 1/1 2/2 3/3\n", "outside the folder"},
        {"mtllib n.mtl\n" SQUARES "usemtl none\nf 1/1 2/2 3/3\n", "missing files"},
        {"mtllib n.mtl\n" SQUARES "usemtl self\nf 1/1 2/2 3/3\n", ""},
    };
    static const char materials[] = "newmtl out\nmap_Kd ../../../etc/passwd\nnewmtl none\n"
                                    "map_Kd nothing.png\nnewmtl self\nmap_Kd n.mtl\nmap_Kd\n";
    test_file_write(test_path("n.mtl"), materials, strlen(materials));
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        test_file_write(test_path("a.obj"), rows[n].text, strlen(rows[n].text));
        cw_mesh_file file;
        cw_part *parts = read_parts("a.obj", 1, &file);
        assert_int_equal(parts->mesh->triangle_count, 1);
        if (!strstr(file.left_out, rows[n].words))
            fail_msg("'%s' is not in '%s'", rows[n].words, file.left_out);
        cw_parts_free(parts, 1);
    }
}

/* A triangle with 2 coordinates of 16 bits a vertex, and members of the file's own. */
#define GLTF(view, members)                                                                       \
    "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{"      \
    "\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,"                  \
    "\"TEXCOORD_0\":1},\"material\":0}]}],\"accessors\":[{\"bufferView\":0,"                      \
    "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"min\":[0,0,0],\"max\":[1,1,0]},{"     \
    "\"bufferView\":1,\"componentType\":5123,\"normalized\":true,\"count\":3,\"type\":"           \
    "\"VEC2\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":36},{\"buffer\":0,"                 \
    "\"byteOffset\":36,\"byteLength\":12}" view "],\"buffers\":[{\"byteLength\":48,\"uri\":"      \
    "\"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAA" \
    "AP//AAAAAP//\"}]," members "}"

#define MATERIAL(more)                                                                         \
    "\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0" more "}}}]"

static void gltf_places_textures(void **state)
{
    (void)state;
    static const struct {
        const char *text, *not_applied, *left_out;
        bool has_picture;
        float u, v; /* of the second corner */
    } rows[] = {
        {GLTF("", MATERIAL("") ",\"textures\":[{\"source\":0}],\"images\":[{\"uri\":"
                               "\"data:image/png;base64,iVBORw==\"}]"),
         "", "", true, 1, 0},
        {GLTF("", MATERIAL(",\"extensions\":{\"KHR_texture_transform\":{\"offset\":[0.5,0.25],"
                           "\"scale\":[2,3]}}") ",\"textures\":[{\"source\":0}],\"images\":[{"
                                                "\"uri\":\"data:image/png;base64,iVBORw==\"}]"),
         "", "", true, 2.5F, 0.25F},
        {GLTF("", MATERIAL(",\"texCoord\":1") ",\"textures\":[{\"source\":0}],\"images\":[{"
                                              "\"uri\":\"data:image/png;base64,iVBORw==\"}]"),
         "TEXCOORD_1", "", false, 1, 0},
        {GLTF("", MATERIAL("") ",\"textures\":[{\"source\":0}],\"images\":[{\"uri\":"
                               "\"../secret.png\"}]"),
         "", "outside the folder", false, 1, 0},
        {GLTF("", MATERIAL("") ",\"textures\":[{\"source\":7}],\"images\":[]"), "", "", false,
         1, 0},
        {GLTF("", MATERIAL("") ",\"textures\":[{\"extensions\":{\"EXT_texture_webp\":{"
                               "\"source\":0}}}],\"images\":[{\"bufferView\":1,\"mimeType\":"
                               "\"image/webp\"}]"),
         "", "", true, 1, 0},
    };
    if (!cw_mesh_format("a.gltf", NULL)->in_this_build)
        skip();
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        test_file_write(test_path("a.gltf"), rows[n].text, strlen(rows[n].text));
        cw_mesh_file file;
        cw_part *parts = read_parts("a.gltf", 1, &file);
        const float(*uv)[2] = test_coordinates(parts->mesh);
        assert_near((double)uv[1][0], (double)rows[n].u, 1e-6);
        assert_near((double)uv[1][1], (double)rows[n].v, 1e-6);
        assert_true(!parts->textures == !rows[n].has_picture);
        assert_non_null(strstr(file.not_applied, rows[n].not_applied));
        assert_non_null(strstr(file.left_out, rows[n].left_out));
        cw_parts_free(parts, 1);
    }
}

static void pictures_that_claim_too_much_are_refused(void **state)
{
    (void)state;
    static const char *const rows[] = {
        GLTF("", MATERIAL("") ",\"textures\":[{\"source\":0}],\"images\":[{\"bufferView\":9}]"),
        GLTF(",{\"buffer\":0,\"byteOffset\":40,\"byteLength\":4000000000}",
             MATERIAL("") ",\"textures\":[{\"source\":0}],\"images\":[{\"bufferView\":2}]"),
        GLTF("", MATERIAL("") ",\"textures\":[{\"source\":0}],\"images\":[{\"uri\":"
                              "\"data:image/png;base64,%%%%\"}]"),
    };
    if (!cw_mesh_format("a.gltf", NULL)->in_this_build)
        skip();
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        cw_part *parts;
        size_t count;
        cw_error err = {0};
        test_file_write(test_path("a.gltf"), rows[n], strlen(rows[n]));
        assert_int_equal(cw_parts_read(test_path("a.gltf"), NULL, &parts, &count, NULL, &err),
                         CW_ERR_FORMAT);
        assert_null(parts);
    }
}

/* A picture beside the mesh is used again if it is the same, and never written over. */
static void pictures_are_not_written_over(void **state)
{
    (void)state;
    cw_mesh mesh = make_textured();
    const cw_textures set = {.color = {jpeg, sizeof jpeg}},
                      other = {.color = {png, sizeof png}};
    const cw_part part = {.mesh = &mesh, .textures = &set};
    cw_error err = {0};
    size_t size;
    test_file_write(test_path("w_color.jpg"), "mine", 4);
    for (int n = 0; n < 2; n++)
        assert_ok(cw_parts_write(test_path("w.obj"), &part, 1, NULL, &err), err);
    char *text = test_file_read(test_path("w_color.jpg"), &size);
    assert_memory_equal(text, "mine", 4);
    free(text);
    text = test_file_read(test_path("w.mtl"), &size);
    assert_non_null(strstr(text, "map_Kd w_color_2.jpg\n"));
    free(text);
    assert_int_not_equal(access(test_path("w_color_3.jpg"), F_OK), 0);
    const cw_part two[] = {part, {.mesh = &mesh, .textures = &other}};
    assert_ok(cw_parts_write(test_path("w.obj"), two, 2, NULL, &err), err);
    cw_part *back = read_parts("w.obj", 2, NULL);
    check_picture(&back[0].textures->color, jpeg, sizeof jpeg);
    check_picture(&back[1].textures->color, png, sizeof png);
    cw_parts_free(back, 2);
    cw_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(texture_and_pictures_come_back),
        cmocka_unit_test(all_pictures_of_gltf_come_back),
        cmocka_unit_test(materials_of_obj_are_parts),
        cmocka_unit_test(ears_keep_their_places),
        cmocka_unit_test(broken_textures_change_no_shape),
        cmocka_unit_test(gltf_places_textures),
        cmocka_unit_test(pictures_that_claim_too_much_are_refused),
        cmocka_unit_test(pictures_are_not_written_over),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
