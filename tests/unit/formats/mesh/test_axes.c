/* Units and frames other than LPS millimetres: in the file, and back. */
#include "support/meshes.h"

#include "core/base/module.h"

#include <math.h>
#include <stdio.h>

/* A cube from (1, 2, 3) to (2, 3, 4) mm. */
static void make_cube(cw_mesh *mesh)
{
    test_make_cube(mesh);
    memcpy(mesh->origin, (double[3]){1, 2, 3}, sizeof mesh->origin);
}

static void units_have_names_and_lengths(void **state)
{
    (void)state;
    assert_string_equal(cw_unit_name(CW_UNIT_MM), "mm");
    assert_string_equal(cw_unit_name(CW_UNIT_FT), "ft");
    assert_true(cw_unit_mm(CW_UNIT_IN) == 25.4);
    assert_true(cw_unit_mm((cw_unit)99) == 1);
}

/* The first vertex, at 1 2 3 mm, and its normal, as OBJ holds them. */
static void files_hold_what_was_asked_for(void **state)
{
    (void)state;
    static const struct {
        cw_axes axes;
        const char *head, *vertex;
        float normal[3];
    } rows[] = {
        {{0}, "LPS, mm\no a\n", "v 1 2 3\n", {1, 2, 3}},
        {{.unit = CW_UNIT_M}, "LPS, m\no a\n", "v 0.001 0.002 0.003\n", {1, 2, 3}},
        {{.unit = CW_UNIT_UM}, "LPS, um\no a\n", "v 1000 2000 3000\n", {1, 2, 3}},
        {{.unit = CW_UNIT_IN},
         "LPS, in\no a\n",
         "v 0.03937007874 0.07874015748 0.1181102362\n",
         {1, 2, 3}},
        {{.ras = true}, "RAS, mm\no a\n", "v -1 -2 3\n", {-1, -2, 3}},
        {{.y_up = true}, "LPS, mm, Y up\no a\n", "v 1 3 -2\n", {1, 3, -2}},
        {{CW_UNIT_CM, true, true}, "RAS, cm, Y up\no a\n", "v -0.1 0.3 0.2\n", {-1, 3, 2}},
    };
    cw_mesh mesh = {0};
    make_cube(&mesh);
    for (int a = 0; a < 3; a++)
        mesh.normals[a] = (float)(a + 1);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const cw_write_desc desc = {.axes = rows[i].axes};
        char expected[200];
        size_t size;
        cw_error err = {0};
        assert_ok(cw_mesh_write(test_path("a.obj"), &mesh, &desc, &err), err);
        char *text = test_file_read(test_path("a.obj"), &size);
        snprintf(expected, sizeof expected, "# cubewright " CW_VERSION ", %s%s", rows[i].head,
                 rows[i].vertex);
        if (strncmp(text, expected, strlen(expected)) != 0)
            fail_msg("row %zu: %.100s", i, text);
        snprintf(expected, sizeof expected, "\nvn %g %g %g\n", (double)rows[i].normal[0],
                 (double)rows[i].normal[1], (double)rows[i].normal[2]);
        assert_non_null(strstr(text, expected));
        free(text);
    }
    cw_mesh_free(&mesh);
}

/* n counts through every unit, frame and up. */
static cw_axes axes_of(int n)
{
    return (cw_axes){.unit = (cw_unit)(n / 4), .ras = n & 1, .y_up = n & 2};
}

static void check_back(const cw_mesh *mesh, const cw_mesh *back, bool local)
{
    const double volume = 1;
    double low[3], high[3];
    cw_quality q;
    cw_error err = {0};
    assert_usable(back);
    cw_mesh_bounds(back, low, high);
    for (int a = 0; a < 3; a++) {
        assert_near(low[a], a + 1, 3e-6);
        assert_near(high[a], a + 2, 3e-6);
        assert_near(back->origin[a], local ? mesh->origin[a] : 0, 1e-12);
    }
    assert_ok(cw_quality_measure(back, NULL, &q, &err), err);
    assert_near(q.volume_mm3, volume, 1e-4); /* not mirrored */
    for (size_t i = 0; back->normals && i < 24; i++)
        assert_near((double)back->normals[i], (double)mesh->normals[i], 1e-6);
}

static void what_is_written_is_read_back_in_millimetres(void **state)
{
    (void)state;
    static const char *const names[] = {"a.obj", "a.ply", "a.stl", "a.off", "a.3mf", "a.vtp"};
    cw_mesh mesh = {0};
    make_cube(&mesh);
    for (int n = 0; n < 4 * CW_UNIT_COUNT * 12; n++) {
        const char *name = names[n % 6];
        const cw_write_desc desc = {.axes = axes_of(n / 12), .local = n / 6 % 2};
        cw_mesh back;
        cw_mesh_file file;
        cw_error err = {0};
        if (n % 6 == 2 && desc.local && desc.axes.unit >= CW_UNIT_IN)
            continue; /* the origin's digits do not fit into the header */
        assert_ok(cw_mesh_write(test_path(name), &mesh, &desc, &err), err);
        assert_ok(cw_mesh_read(test_path(name), NULL, &back, &file, &err), err);
        assert_int_equal(file.known, CW_KNOWN_UNIT | CW_KNOWN_FRAME);
        assert_int_equal(file.axes.unit, desc.axes.unit);
        if (file.axes.ras != desc.axes.ras || file.axes.y_up != desc.axes.y_up)
            fail_msg("row %d, %s: RAS %d, Y up %d", n, name, file.axes.ras, file.axes.y_up);
        check_back(&mesh, &back, desc.local || strcmp(name, "a.3mf") == 0);
        cw_mesh_free(&back);
    }
    cw_mesh_free(&mesh);
}

static void gltf_has_its_own(void **state)
{
    (void)state;
    cw_mesh mesh = {0}, back;
    cw_error err = {0};
    make_cube(&mesh);
    const cw_write_desc inch = {.axes = {.unit = CW_UNIT_IN}}, ras = {.axes = {.ras = true}};
    const cw_write_desc own = {.axes = {.unit = CW_UNIT_M, .y_up = true}};
    assert_fails(cw_mesh_write(test_path("a.glb"), &mesh, &inch, &err), CW_ERR_ARGUMENT,
                 "a.glb: glb is in metres, +Y up", err);
    assert_fails(cw_mesh_write_check(test_path("a.gltf"), &ras, &err), CW_ERR_ARGUMENT,
                 "it has no other unit or frame", err);
    assert_int_equal(test_folder_entries(), 0);
    if (cwi_module_present("gltf")) {
        assert_ok(cw_mesh_write(test_path("a.glb"), &mesh, &own, &err), err);
        assert_ok(cw_mesh_read(test_path("a.glb"), NULL, &back, NULL, &err), err);
        check_back(&mesh, &back, true);
        cw_mesh_free(&back);
    }
    const cw_write_desc none = {.axes = {.unit = (cw_unit)CW_UNIT_COUNT}};
    assert_fails(cw_mesh_write(test_path("a.stl"), &mesh, &none, &err), CW_ERR_ARGUMENT,
                 "6 is not a unit", err);
    cw_mesh_free(&mesh);
}

/* The step is reported in millimetres, whatever the file counts in. */
static void loss_is_that_of_the_file(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_write_loss mm, um;
    cw_error err = {0};
    make_cube(&mesh);
    mesh.origin[2] = 1e8;
    assert_ok(cw_mesh_write_loss("a.stl", &mesh, NULL, &mm, &err), err);
    assert_ok(cw_mesh_write_loss("a.stl", &mesh,
                                 &(cw_write_desc){.axes = {CW_UNIT_UM, true, true}}, &um, &err),
              err);
    assert_int_equal(mm.merged_vertices, 4);
    assert_int_equal(um.merged_vertices, 4);
    assert_true(mm.step_mm == 8);
    assert_within(um.step_mm, 8.192, 1e-9);
    cw_mesh_free(&mesh);
}

#define FACES "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"

/* Comments that are not quite ours say nothing; numbers too large for mm are refused. */
static void only_our_words_count(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        unsigned known;
    } rows[] = {
        {"# cubewright 9.9, RAS, cm\n" FACES, CW_KNOWN_UNIT | CW_KNOWN_FRAME},
        {"# cubewright 9.9, RAS, cm, Y upside down\n" FACES, CW_KNOWN_UNIT | CW_KNOWN_FRAME},
        {"# cubewright 9.9, RAS, cmm\n" FACES, 0},
        {"# cubewright 9.9, RAS\n" FACES, 0},
        {"# cubewright 9.9\n" FACES, 0},
        {"# cubewright\n" FACES, 0},
        {"# somebody 9.9, RAS, cm\n" FACES, 0},
        {"# origin 1 2 3\n" FACES, 0},
    };
    cw_mesh mesh;
    cw_error err = {0};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        cw_mesh_file file;
        assert_ok(read_text("a.obj", rows[i].text, &mesh, &file, &err), err);
        assert_int_equal(file.known, rows[i].known);
        assert_true(!file.local && !file.axes.y_up);
        assert_true(mesh.positions[3] == (rows[i].known ? -10 : 1));
        cw_mesh_free(&mesh);
    }
    assert_fails(
        read_text("a.obj", "# cubewright 1, LPS, m\nv 3e36 0 0\n" FACES, &mesh, NULL, &err),
        CW_ERR_FORMAT, "its unit is 'm'; single precision cannot hold", err);
    assert_null(mesh.positions);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(units_have_names_and_lengths),
        TEST(files_hold_what_was_asked_for),
        TEST(what_is_written_is_read_back_in_millimetres),
        TEST(gltf_has_its_own),
        TEST(loss_is_that_of_the_file),
        TEST(only_our_words_count),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
