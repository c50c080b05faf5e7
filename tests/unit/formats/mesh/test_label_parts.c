/* Parts that are the surfaces of labels: names, colours and codes in every format. */
#include "support/files/unzip.h"
#include "support/meshes.h"

#include "core/base/module.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Two labels, a cube and a tetrahedron. */
typedef struct pair {
    cw_mesh cube, tetrahedron;
    cw_label labels[2];
    cw_part parts[2];
} pair;

static pair *make_pair(pair *p)
{
    *p = (pair){.labels = {{.value = 17,
                            .color = {0x01, 0x80, 0xfe, 255},
                            .has_color = true,
                            .type = {.scheme = "SCT", .value = "10200004", .meaning = "Liver"}},
                           {.value = 4000000000u, .color = {9, 8, 7, 51}, .has_color = true}}};
    test_make_cube(&p->cube);
    test_make_tetrahedron(&p->tetrahedron);
    p->tetrahedron.origin[0] = 5;
    p->parts[0] = (cw_part){.mesh = &p->cube, .name = "left \"lobe\"", .label = p->labels};
    p->parts[1] = (cw_part){.mesh = &p->tetrahedron, .name = "rest", .label = p->labels + 1};
    return p;
}

static void free_pair(pair *p)
{
    cw_mesh_free(&p->cube);
    cw_mesh_free(&p->tetrahedron);
}

static char *write_pair(const pair *p, const char *name, const cw_write_desc *desc)
{
    size_t size;
    cw_error err = {0};
    assert_ok(cw_parts_write(test_path(name), p->parts, 2, desc, &err), err);
    return test_file_read(test_path(name), &size);
}

static const char *assert_holds(const char *text, const char *words)
{
    const char *at = strstr(text, words);
    if (!at)
        fail_msg("no %s in\n%s", words, text);
    return at;
}

/* A linear component of glTF becomes the same byte of sRGB again. */
static int to_srgb(double c)
{
    return (int)lround(255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * pow(c, 1 / 2.4) - 0.055));
}

static void gltf_has_a_material_a_label(void **state)
{
    (void)state;
    static const int bytes[2][3] = {{0x01, 0x80, 0xfe}, {9, 8, 7}};
    pair p;
    if (!cwi_module_present("gltf"))
        skip();
    char *text = write_pair(make_pair(&p), "a.gltf", NULL);
    const char *at = text;
    for (int i = 0; i < 2; i++) {
        at = assert_holds(at, "\"baseColorFactor\":[") + 19;
        for (int c = 0; c < 3; c++) {
            char *end;
            assert_int_equal(to_srgb(strtod(at, &end)), bytes[i][c]);
            at = end + 1;
        }
    }
    assert_near(strtod(at, NULL), 0.2, 1e-12);
    assert_holds(text, "\"alphaMode\":\"BLEND\"");
    assert_holds(text, "\"name\":\"left \\\"lobe\\\"\"");
    assert_holds(text, "\"color\":\"#0180FE\"");
    assert_holds(text, "\"label\":17,");
    assert_holds(text, "\"label\":4000000000");
    assert_holds(text, "\"type\":{\"meaning\":\"Liver\",\"scheme\":\"SCT\",\"value\":"
                       "\"10200004\"}");
    free(text);
    p.cube.colors = calloc(p.cube.vertex_count, 4); /* colours of vertices go before */
    p.cube.colors[0] = 1;
    text = write_pair(&p, "a.gltf", NULL);
    assert_holds(text, "\"name\":\"surface\"");
    free(text);
    free_pair(&p);
}

static void obj_names_materials_of_a_second_file(void **state)
{
    (void)state;
    size_t size;
    pair p;
    cw_error err = {0};
    char *text = write_pair(make_pair(&p), "two words.obj", NULL);
    assert_holds(text, "mtllib two words.mtl\n");
    assert_holds(text, "o left \"lobe\"\nusemtl left_\"lobe\"_17\nv ");
    assert_holds(text, "o rest\nusemtl rest_4000000000\nv ");
    free(text);
    text = test_file_read(test_path("two words.mtl"), &size);
    assert_holds(text, "newmtl left_\"lobe\"_17\nKd 0.0039 0.5020 0.9961\nd 1.0000\n");
    assert_holds(text, "newmtl rest_4000000000\nKd 0.0353 0.0314 0.0275\nd 0.2000\n");
    free(text);
    /* the digits give every byte again */
    for (int byte = 0; byte < 256; byte++) {
        char digits[16];
        snprintf(digits, sizeof digits, "%.4f", byte / 255.0);
        assert_int_equal(lround(255 * strtod(digits, NULL)), byte);
    }
    /* neither file is written when one of them exists */
    const size_t entries = test_folder_entries();
    assert_int_equal(rename(test_path("two words.mtl"), test_path("b.mtl")), 0);
    assert_fails(cw_parts_write(test_path("b.obj"), p.parts, 2,
                                &(cw_write_desc){.no_clobber = true}, &err),
                 CW_ERR_OUTPUT, "exists", err);
    assert_int_equal(test_folder_entries(), entries);
    free_pair(&p);
}

static void objects_of_3mf_have_a_colour(void **state)
{
    (void)state;
    pair p;
    free(write_pair(make_pair(&p), "a.3mf", NULL));
    char *text = unzip(test_path("a.3mf"), "3D/3dmodel.model");
    assert_holds(text, "<m:colorgroup id=\"1\">\n<m:color color=\"#0180FEFF\"/>\n"
                       "</m:colorgroup>\n<object id=\"2\" type=\"model\" "
                       "name=\"left &quot;lobe&quot;\" pid=\"1\" pindex=\"0\">\n");
    assert_holds(text, "<m:color color=\"#09080733\"/>\n</m:colorgroup>\n<object id=\"4\" "
                       "type=\"model\" name=\"rest\" pid=\"3\" pindex=\"0\">\n");
    assert_holds(text, "<triangle v1=\"0\" v2=\"2\" v3=\"1\"/>");
    free(text);
    free_pair(&p);
}

/* Formats of one mesh: the vertices have label and colour. */
static void vertices_have_label_and_colour(void **state)
{
    (void)state;
    static const char *const names[] = {"a.ply", "b.ply", "a.vtp", "a.off"};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        pair p;
        cw_mesh back;
        cw_error err = {0};
        const cw_write_desc desc = {.text = n == 1};
        free(write_pair(make_pair(&p), names[n], &desc));
        assert_ok(cw_mesh_read(test_path(names[n]), NULL, &back, NULL, &err), err);
        assert_int_equal(back.vertex_count, 12);
        assert_int_equal(back.triangle_count, 16);
        for (size_t v = 0; v < 12; v++) {
            const cw_label *label = &p.labels[v < 8 ? 0 : 1];
            if (n < 3)
                assert_int_equal(back.labels[v], label->value);
            assert_memory_equal(back.colors + 4 * v, label->color, 4);
        }
        cw_mesh_free(&back);
        p.parts[1].label = NULL; /* all or none */
        free(write_pair(&p, names[n], &desc));
        assert_ok(cw_mesh_read(test_path(names[n]), NULL, &back, NULL, &err), err);
        assert_null(back.labels);
        assert_null(back.colors);
        cw_mesh_free(&back);
        free_pair(&p);
    }
}

static void triangles_have_labels_on_both_sides(void **state)
{
    (void)state;
    size_t size;
    pair p;
    cw_error err = {0};
    cw_mesh back;
    uint32_t sides[8] = {1, 0, 2, 0, 3, 1, 4000000000u, 0};
    cw_write_desc desc = {.sides = sides, .text = true};
    make_pair(&p);
    assert_ok(cw_mesh_write(test_path("a.ply"), &p.tetrahedron, &desc, &err), err);
    char *text = test_file_read(test_path("a.ply"), &size);
    assert_holds(text, "property uint label_0\nproperty uint label_1\nend_header\n");
    assert_holds(text, "\n3 0 2 1 1 0\n");
    assert_holds(text, " 4000000000 0\n");
    free(text);
    desc.text = false;
    for (int n = 0; n < 2; n++) {
        const char *path = test_path(n ? "a.vtp" : "a.ply");
        assert_ok(cw_mesh_write(path, &p.tetrahedron, &desc, &err), err);
        text = test_file_read(path, &size);
        assert_true(!n || strstr(text, "<CellData>\n<DataArray type=\"UInt32\" "
                                       "Name=\"BoundaryLabels\" NumberOfComponents=\"2\""));
        free(text);
        assert_ok(cw_mesh_read(path, NULL, &back, NULL, &err), err);
        assert_int_equal(back.triangle_count, 4);
        cw_mesh_free(&back);
    }
    assert_fails(cw_mesh_write(test_path("a.stl"), &p.tetrahedron, &desc, &err),
                 CW_ERR_ARGUMENT, "stl has no labels on both sides of triangles", err);
    assert_fails(cw_parts_write(test_path("a.vtp"), p.parts, 2, &desc, &err), CW_ERR_ARGUMENT,
                 "one mesh, not of 2", err);
    free_pair(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gltf_has_a_material_a_label),
        cmocka_unit_test(obj_names_materials_of_a_second_file),
        cmocka_unit_test(objects_of_3mf_have_a_colour),
        cmocka_unit_test(vertices_have_label_and_colour),
        cmocka_unit_test(triangles_have_labels_on_both_sides),
    };
    return cmocka_run_group_tests(tests, test_folder_make, test_folder_remove);
}
