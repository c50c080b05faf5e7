/* Colours of triangles in written glTF: primitives with materials that share the vertices, or
 * vertices that are split by colour. */
#include "support/meshes.h"

#include "core/base/module.h"

#include <math.h>
#include <stdio.h>

/* A torus of 2 * turns * sides triangles. Its colours go along it in `bands` bands; the last one is
 * half transparent if there are several. */
static void make_torus(uint32_t turns, uint32_t sides, uint32_t bands, cw_mesh *mesh)
{
    static const cw_attribute like = {.name = CW_FACE_COLORS,
                                      .on = CW_ON_TRIANGLES,
                                      .type = CW_U8,
                                      .components = 4,
                                      .interpolation = CW_INTERPOLATE_COLOR};
    cw_attribute *row;
    cw_error err = {0};
    const uint32_t count = 2 * turns * sides;
    *mesh = (cw_mesh){.vertex_count = turns * sides, .triangle_count = count};
    mesh->positions = malloc(12 * mesh->vertex_count);
    mesh->normals = calloc(3 * mesh->vertex_count, 4);
    mesh->triangles = malloc(12 * count);
    assert_true(mesh->positions && mesh->normals && mesh->triangles);
    for (uint32_t v = 0; v < turns * sides; v++) {
        const double a = 6.283185307 * (v / sides) / turns,
                     b = 6.283185307 * (v % sides) / sides;
        mesh->positions[3 * v] = (float)((3 + cos(b)) * cos(a));
        mesh->positions[3 * v + 1] = (float)((3 + cos(b)) * sin(a));
        mesh->positions[3 * v + 2] = (float)sin(b);
        mesh->normals[3 * v + 2] = 1;
    }
    for (uint32_t v = 0; v < turns * sides; v++) {
        const uint32_t i = v / sides, j = v % sides;
        const uint32_t q = (i + 1) % turns * sides + j;
        const uint32_t r = (i + 1) % turns * sides + (j + 1) % sides,
                       s = i * sides + (j + 1) % sides;
        memcpy(mesh->triangles + 6 * v, (uint32_t[6]){v, q, r, v, r, s}, 24);
    }
    assert_ok(cw_mesh_attribute_add(mesh, &like, &row, &err), err);
    for (uint32_t t = 0; t < count; t++) {
        const uint32_t n = (uint32_t)((uint64_t)t * bands / count);
        const uint8_t color[4] = {(uint8_t)(7 + n % 200), (uint8_t)(n / 200 % 256), 3,
                                  bands > 1 && n == bands - 1 ? 128 : 255};
        memcpy((uint8_t *)row->data + 4 * t, color, 4);
    }
}

static const uint8_t *face_colors(const cw_mesh *mesh)
{
    const cw_attribute *row = cw_mesh_attribute_find(mesh, CW_FACE_COLORS);
    return row ? row->data : NULL;
}

/* A triangle as a reader has it: its corners, and the colour of all three. */
typedef struct colored {
    float corners[9];
    uint8_t color[4];
} colored;

static int compare_colored(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(colored));
}

/* Lists the triangles of a mesh, sorted: with the colours of faces, else those of the vertices, which
 * must be the same at all corners. */
static colored *list_colored(const cw_mesh *mesh)
{
    colored *list = calloc(mesh->triangle_count, sizeof *list);
    const uint8_t *faces = face_colors(mesh);
    assert_non_null(list);
    assert_true(faces || mesh->colors);
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
        colored *at = &list[i / 3];
        const size_t v = mesh->triangles[i];
        const uint8_t *color = faces ? faces + 4 * (i / 3) : mesh->colors + 4 * v;
        for (size_t a = 0; a < 3; a++)
            at->corners[3 * (i % 3) + a] =
                (float)(mesh->origin[a] + (double)mesh->positions[3 * v + a]);
        if (i % 3)
            assert_memory_equal(at->color, color, 4);
        memcpy(at->color, color, 4);
    }
    qsort(list, mesh->triangle_count, sizeof *list, compare_colored);
    return list;
}

static void check_alike(const cw_mesh *a, const cw_mesh *b)
{
    assert_int_equal(a->triangle_count, b->triangle_count);
    colored *p = list_colored(a), *q = list_colored(b);
    assert_memory_equal(p, q, a->triangle_count * sizeof *p);
    free(p);
    free(q);
}

static size_t count_words(const char *text, const char *word)
{
    size_t count = 0;
    for (const char *at = strstr(text, word); at; at = strstr(at + 1, word))
        count++;
    return count;
}

static void few_colours_share_the_vertices(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        uint32_t turns, sides, bands;
    } rows[] = {{"a.gltf", 8, 5, 2},
                {"a.glb", 40, 30, 3},
                {"b.gltf", 300, 250, 128}, /* indices of 32 bits */
                {"b.glb", 16, 8, 128}};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        cw_mesh mesh, back;
        cw_mesh_file file;
        cw_quality q;
        cw_error err = {0};
        cw_write_loss loss;
        size_t size;
        make_torus(rows[n].turns, rows[n].sides, rows[n].bands, &mesh);
        assert_ok(cw_mesh_write_loss(test_path(rows[n].name), &mesh, NULL, &loss, &err), err);
        assert_int_equal(loss.dropped, 0);
        assert_int_equal(loss.split_vertices, 0);
        assert_ok(cw_mesh_write(test_path(rows[n].name), &mesh, NULL, &err), err);
        assert_ok(cw_mesh_read(test_path(rows[n].name), NULL, &back, &file, &err), err);
        assert_int_equal(back.vertex_count, mesh.vertex_count);
        assert_int_equal(file.parts, 1);
        assert_non_null(face_colors(&back));
        check_alike(&mesh, &back);
        assert_ok(cw_quality_measure(&back, NULL, &q, &err), err);
        assert_true(cw_quality_is_closed_manifold(&q));
        char *text = test_file_read(test_path(rows[n].name), &size);
        if (rows[n].name[2] == 'g' && rows[n].name[3] == 'l' && rows[n].name[4] == 't') {
            assert_int_equal(count_words(text, "baseColorFactor"), rows[n].bands);
            assert_int_equal(count_words(text, "\"BLEND\""), 1);
            assert_int_equal(count_words(text, "COLOR_0"), 0);
        }
        free(text);
        cw_mesh_free(&back);
        cw_mesh_free(&mesh);
    }
}

static void many_colours_split_the_vertices(void **state)
{
    (void)state;
    static const struct {
        uint32_t turns, sides, bands;
        size_t added; /* 0: some */
    } rows[] = {{40, 30, 129, 0}, {40, 30, 2400, 2400 * 3 - 1200}, {200, 10, 500, 0}};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        cw_mesh mesh, back;
        cw_error err = {0};
        cw_write_loss loss;
        make_torus(rows[n].turns, rows[n].sides, rows[n].bands, &mesh);
        assert_ok(cw_mesh_write_loss("a.glb", &mesh, NULL, &loss, &err), err);
        assert_true(rows[n].added ? loss.split_vertices == rows[n].added
                                  : loss.split_vertices > 0);
        assert_int_equal(loss.dropped, 0);
        assert_ok(cw_mesh_write(test_path("a.glb"), &mesh, NULL, &err), err);
        assert_ok(cw_mesh_read(test_path("a.glb"), NULL, &back, NULL, &err), err);
        assert_int_equal(back.vertex_count, mesh.vertex_count + loss.split_vertices);
        assert_null(face_colors(&back));
        assert_non_null(back.normals);
        check_alike(&mesh, &back);
        cw_mesh_free(&back);
        cw_mesh_free(&mesh);
    }
}

/* Quantized positions keep the triangles in groups; codecs that order triangles split vertices. */
static void compressed_files_have_the_colours(void **state)
{
    (void)state;
    static const struct {
        cw_compression compression;
        const char *module;
    } rows[] = {{CW_COMPRESS_QUANTIZE, "gltf"},
                {CW_COMPRESS_DRACO, "draco"},
                {CW_COMPRESS_MESHOPT, "meshopt"}};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        const cw_write_desc desc = {.compression = rows[n].compression};
        cw_mesh mesh, back;
        cw_error err = {0};
        cw_write_loss loss;
        if (!cwi_module_present(rows[n].module))
            continue;
        make_torus(40, 30, 3, &mesh);
        assert_ok(cw_mesh_write_loss("a.glb", &mesh, &desc, &loss, &err), err);
        assert_true((loss.split_vertices == 0) == (n == 0));
        assert_ok(cw_mesh_write(test_path("a.glb"), &mesh, &desc, &err), err);
        assert_ok(cw_mesh_read(test_path("a.glb"), NULL, &back, NULL, &err), err);
        assert_true((face_colors(&back) != NULL) == (n == 0));
        colored *list = list_colored(&back); /* one colour at all corners of each */
        size_t translucent = 0;
        for (size_t t = 0; t < back.triangle_count; t++)
            translucent += list[t].color[3] == 128;
        assert_int_equal(translucent, 800);
        free(list);
        cw_mesh_free(&back);
        cw_mesh_free(&mesh);
    }
}

/* One colour is that of the material; white is that of vertices, since a white material is none. */
static void one_colour_needs_no_groups(void **state)
{
    (void)state;
    for (int white = 0; white < 2; white++) {
        cw_mesh mesh, back;
        cw_error err = {0};
        size_t size;
        make_torus(6, 5, 1, &mesh);
        uint8_t *colors = cw_mesh_attribute_find(&mesh, CW_FACE_COLORS)->data;
        if (white)
            memset(colors, 255, 4 * mesh.triangle_count);
        assert_ok(cw_mesh_write(test_path("a.gltf"), &mesh, NULL, &err), err);
        char *text = test_file_read(test_path("a.gltf"), &size);
        assert_int_equal(count_words(text, "COLOR_0"), white);
        assert_int_equal(count_words(text, "\"indices\""), 1);
        free(text);
        assert_ok(cw_mesh_read(test_path("a.gltf"), NULL, &back, NULL, &err), err);
        assert_int_equal(back.vertex_count, mesh.vertex_count);
        check_alike(&mesh, &back);
        cw_mesh_free(&back);
        cw_mesh_free(&mesh);
    }
}

/* Colours of faces win over those of vertices and of labels; the loss is named, and labels stay. */
static void faces_win_over_vertices_and_labels(void **state)
{
    (void)state;
    static const char *const names[] = {"a.glb", "a.gltf", "a.3mf"};
    const cw_label label = {.value = 5, .color = {1, 2, 3, 255}, .has_color = true};
    for (size_t n = 0; n < 3; n++) {
        cw_mesh mesh, cube;
        cw_part *parts;
        size_t count;
        cw_error err = {0};
        cw_write_loss loss;
        make_torus(6, 5, 2, &mesh);
        test_make_cube(&cube);
        mesh.colors = calloc(4, mesh.vertex_count);
        assert_non_null(mesh.colors);
        assert_ok(cw_mesh_write_loss(names[n], &mesh, NULL, &loss, &err), err);
        assert_int_equal(loss.dropped & ~(unsigned)CW_KEEPS_NORMALS, CW_KEEPS_COLORS);
        const cw_part given[] = {{.mesh = &mesh, .name = "torus", .label = &label},
                                 {.mesh = &cube, .name = "cube"}};
        assert_ok(cw_parts_write(test_path(names[n]), given, 2, NULL, &err), err);
        assert_ok(cw_parts_read(test_path(names[n]), NULL, &parts, &count, NULL, &err), err);
        assert_int_equal(count, 2);
        check_alike(&mesh, parts[0].mesh);
        if (n < 2)
            assert_memory_equal(parts[0].label->color, label.color, 4);
        cw_parts_free(parts, count);
        cw_mesh_free(&cube);
        cw_mesh_free(&mesh);
    }
}

static void memory_may_run_out_anywhere(void **state)
{
    (void)state;
    static const uint32_t bands[] = {3, 150};
    for (size_t n = 0; n < 2; n++) {
        cw_mesh mesh;
        cw_error err = {0};
        bool failed = true;
        make_torus(10, 8, bands[n], &mesh);
        for (long at = 0; failed; at++) {
            cwi_alloc_fail_after(at);
            const cw_status st = cw_mesh_write(test_path("a.glb"), &mesh, NULL, &err);
            failed = cwi_alloc_fail_after(-1);
            assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
        }
        failed = true;
        for (long at = 0; failed; at++) {
            cw_write_loss loss;
            cwi_alloc_fail_after(at);
            const cw_status st = cw_mesh_write_loss("a.glb", &mesh, NULL, &loss, &err);
            failed = cwi_alloc_fail_after(-1);
            assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
        }
        cw_mesh_free(&mesh);
    }
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(few_colours_share_the_vertices),     TEST(many_colours_split_the_vertices),
        TEST(compressed_files_have_the_colours),  TEST(one_colour_needs_no_groups),
        TEST(faces_win_over_vertices_and_labels), TEST(memory_may_run_out_anywhere),
    };
    return cwi_module_present("gltf") ? cmocka_run_group_tests(tests, NULL, NULL) : 0;
}
