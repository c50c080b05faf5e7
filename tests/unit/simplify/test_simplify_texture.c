/* Simplification of textured meshes: the old texture still fits. */
#include "support/solids.h"
#include "support/texture.h"

#include <cubewright/atlas.h>
#include <cubewright/simplify.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

static cw_mesh simplify(const cw_mesh *mesh, const cw_simplify_desc *desc)
{
    cw_mesh out;
    cw_error err = {0};
    assert_ok(cw_simplify(mesh, desc, &out, NULL, &err), err);
    return out;
}

static cw_texture_distance measure(const cw_mesh *mesh, const cw_mesh *full)
{
    cw_texture_distance distance;
    cw_error err = {0};
    assert_ok(cw_mesh_texture_distance(mesh, full, 0, &distance, &err), err);
    return distance;
}

/* Surfaces with an atlas each. */
static cw_mesh make_textured(cw_field field, size_t n)
{
    cw_mesh mesh = test_extract_field(field, n);
    cw_error err = {0};
    assert_ok(cw_mesh_atlas(&mesh, NULL, NULL, &err), err);
    return mesh;
}

/* Holds what is promised of any texture that had no overlaps. */
static void check_texture(const cw_mesh *out, const cw_mesh *full)
{
    const float(*uv)[2] = test_coordinates(out);
    size_t covered, full_covered;
    for (size_t t = 0; t < out->triangle_count; t++)
        assert_true(test_texture_area(uv + 3 * t) > 0);
    assert_int_equal(test_count_overlaps(full, &full_covered), 0);
    assert_int_equal(test_count_overlaps(out, &covered), 0);
    assert_within((double)covered, (double)full_covered, 0.1);
    assert_int_equal(test_count_charts(out), test_count_charts(full));
    test_assert_sound(full, out);
}

static void charts_stay_whole(void **state)
{
    (void)state;
    static const cw_field fields[] = {CW_FIELD_SPHERE, CW_FIELD_TORUS, CW_FIELD_GYROID};
    for (size_t n = 0; n < sizeof fields / sizeof *fields; n++) {
        cw_mesh full = make_textured(fields[n], 40);
        cw_mesh out = simplify(&full, &(cw_simplify_desc){.ratio = 0.3});
        check_texture(&out, &full);
        const cw_texture_distance d = measure(&out, &full);
        assert_true(d.samples > out.triangle_count);
        assert_true(d.mean_mm < 0.1 && d.max_mm < 1.5); /* voxels of 1 mm */
        cw_mesh_free(&out);
        cw_mesh_free(&full);
    }
}

static void places_move_about_as_far_as_the_surface(void **state)
{
    (void)state;
    static const double errors[] = {0.05, 0.3};
    cw_mesh full = make_textured(CW_FIELD_TORUS, 40);
    for (size_t n = 0; n < 2; n++) {
        cw_mesh out = simplify(&full, &(cw_simplify_desc){.error_mm = errors[n]});
        assert_true(out.triangle_count < full.triangle_count);
        check_texture(&out, &full);
        assert_true(measure(&out, &full).max_mm < 2 * errors[n]);
        cw_mesh_free(&out);
    }
    cw_mesh_free(&full);
}

/* Large enough for several blocks, whose seams stay until the last pass. */
static void blocks_and_threads_change_nothing(void **state)
{
    (void)state;
    static const cw_simplify_desc descs[] = {{.ratio = 0.2}, {.error_mm = 0.2}};
    cw_mesh full = make_textured(CW_FIELD_GYROID, 44);
    assert_true(full.triangle_count > 1 << 15);
    for (size_t n = 0; n < 2; n++) {
        cw_simplify_desc desc = descs[n];
        desc.threads = 1;
        cw_mesh out = simplify(&full, &desc);
        check_texture(&out, &full);
        desc.threads = 3;
        cw_mesh again = simplify(&full, &desc);
        test_assert_same_mesh(&out, &again);
        assert_memory_equal(test_coordinates(&out), test_coordinates(&again),
                            3 * out.triangle_count * sizeof(float[2]));
        if (n == 0)
            assert_within((double)out.triangle_count, 0.2 * (double)full.triangle_count, 0.02);
        cw_mesh_free(&again);
        cw_mesh_free(&out);
    }
    cw_mesh_free(&full);
}

static void levels_keep_the_texture(void **state)
{
    (void)state;
    cw_mesh full = make_textured(CW_FIELD_TORUS, 40), out[2];
    cw_error err = {0};
    const size_t half = full.triangle_count / 2;
    assert_ok(cw_simplify_levels(&full, &(cw_simplify_desc){0}, (size_t[]){half, half / 2}, 2,
                                 out, NULL, &err),
              err);
    for (int n = 0; n < 2; n++) {
        check_texture(&out[n], &full);
        cw_mesh_free(&out[n]);
    }
    cw_mesh_free(&full);
}

/* --- made by hand ------------------------------------------------------------------------- */

enum { SIDE = 40 };

/* Makes a flat square of SIDE mm, with place(x, y) for the corners of square x, y. */
static cw_mesh make_square(cw_on on,
                           void (*place)(double x, double y, const double cell[2], float uv[2]))
{
    const size_t row = SIDE + 1;
    cw_mesh mesh = {.vertex_count = row * row, .triangle_count = (size_t)2 * SIDE * SIDE};
    cw_attribute *uv;
    cw_error err = {0};
    mesh.positions = calloc(3 * mesh.vertex_count, sizeof(float));
    mesh.triangles = calloc(3 * mesh.triangle_count, sizeof(uint32_t));
    assert_true(mesh.positions && mesh.triangles);
    for (size_t v = 0; v < mesh.vertex_count; v++) {
        mesh.positions[3 * v] = (float)(v % row);
        mesh.positions[3 * v + 1] = (float)(v / row);
    }
    const cw_attribute like = {CW_TEXTURE_COORDINATES, on,  CW_F32, 2,
                               CW_INTERPOLATE_LINEAR,  NULL};
    for (uint32_t t = 0; t < mesh.triangle_count; t++) {
        const uint32_t first = t / 2 / SIDE * (uint32_t)row + t / 2 % SIDE;
        const uint32_t v[2][3] = {{first, first + 1, first + (uint32_t)row + 1},
                                  {first, first + (uint32_t)row + 1, first + (uint32_t)row}};
        memcpy(mesh.triangles + 3 * (size_t)t, v[t % 2], sizeof *v);
    }
    assert_ok(cw_mesh_attribute_add(&mesh, &like, &uv, &err), err);
    for (size_t c = 0; c < 3 * mesh.triangle_count; c++) {
        const uint32_t v = mesh.triangles[c];
        const double cell[2] = {(double)(c / 6 % SIDE), (double)(c / 6 / SIDE)};
        place((double)mesh.positions[3 * (size_t)v] / SIDE,
              (double)mesh.positions[3 * (size_t)v + 1] / SIDE, cell,
              (float *)uv->data + 2 * (on == CW_ON_CORNERS ? c : v));
    }
    return mesh;
}

static void free_square(cw_mesh *mesh)
{
    free(mesh->positions);
    free(mesh->triangles);
    mesh->positions = NULL;
    mesh->triangles = NULL;
    cw_mesh_free(mesh);
}

static void place_warped(double x, double y, const double cell[2], float uv[2])
{
    (void)cell;
    uv[0] = (float)(0.2 * x + 0.8 * x * x);
    uv[1] = (float)(1 - y - 0.05 * sin(6 * y));
}

/* A plane costs the surface nothing, but the texture is bent on it. */
static void a_bent_texture_on_a_plane_keeps_triangles(void **state)
{
    (void)state;
    for (int on = CW_ON_VERTICES; on <= CW_ON_CORNERS; on++) {
        cw_mesh full = make_square((cw_on)on, place_warped);
        cw_mesh out = simplify(&full, &(cw_simplify_desc){.error_mm = 0.2});
        assert_true(out.triangle_count > 8 && out.triangle_count < full.triangle_count / 2);
        assert_int_equal(cw_mesh_attribute_find(&out, CW_TEXTURE_COORDINATES)->on, on);
        assert_true(measure(&out, &full).max_mm < 0.4);
        cw_mesh_free(&out);
        free_square(&full);
    }
}

static void place_straight(double x, double y, const double cell[2], float uv[2])
{
    (void)cell;
    uv[0] = (float)x;
    uv[1] = (float)(1 - y);
}

static void a_straight_texture_on_a_plane_keeps_none(void **state)
{
    (void)state;
    cw_mesh full = make_square(CW_ON_CORNERS, place_straight);
    cw_mesh out = simplify(&full, &(cw_simplify_desc){.error_mm = 0.01});
    assert_true(out.triangle_count <= 12);
    assert_true(measure(&out, &full).max_mm < 0.01);
    cw_mesh_free(&out);
    free_square(&full);
}

/* Both halves show the same texture, mirrored at the middle: overlaps that are meant. */
static void place_mirrored(double x, double y, const double cell[2], float uv[2])
{
    (void)cell;
    uv[0] = (float)(x > 0.5 ? 2 - 2 * x : 2 * x);
    uv[1] = (float)(1 - y);
}

/* Each square of cells shows the whole texture. */
static void place_tiled(double x, double y, const double cell[2], float uv[2])
{
    uv[0] = (float)(4 * x - floor(cell[0] * 4 / SIDE));
    uv[1] = (float)(1 - (4 * y - floor(cell[1] * 4 / SIDE)));
}

static void overlaps_that_are_meant_may_stay(void **state)
{
    (void)state;
    cw_mesh mirrored = make_square(CW_ON_CORNERS, place_mirrored),
            tiled = make_square(CW_ON_CORNERS, place_tiled), *all[] = {&mirrored, &tiled};
    static const size_t most[] = {40, 400};
    for (int n = 0; n < 2; n++) {
        cw_mesh out = simplify(all[n], &(cw_simplify_desc){.error_mm = 0.05});
        assert_true(out.triangle_count < most[n]);
        assert_int_equal(test_count_charts(&out), test_count_charts(all[n]));
        assert_true(measure(&out, all[n]).max_mm < 0.1);
        cw_mesh_free(&out);
        free_square(all[n]);
    }
}

static void place_apart(double x, double y, const double cell[2], float uv[2])
{
    uv[0] = (float)((x + cell[0]) / (SIDE + 2));
    uv[1] = (float)((y + cell[1]) / (SIDE + 2));
}

static void place_nowhere(double x, double y, const double cell[2], float uv[2])
{
    uv[0] = uv[1] = x + y + cell[0] > 20 ? NAN : 0;
}

/* Makes a chart for each square, and coordinates that are not finite. */
static void odd_textures_end(void **state)
{
    (void)state;
    cw_mesh apart = make_square(CW_ON_CORNERS, place_apart),
            nowhere = make_square(CW_ON_CORNERS, place_nowhere);
    cw_mesh out = simplify(&apart, &(cw_simplify_desc){.ratio = 0.1});
    assert_int_equal(test_count_charts(&out), test_count_charts(&apart));
    cw_mesh_free(&out);
    out = simplify(&nowhere, &(cw_simplify_desc){.ratio = 0.1});
    assert_true(out.triangle_count > 0);
    cw_texture_distance d;
    cw_error err = {0};
    assert_int_equal(cw_mesh_texture_distance(&out, &nowhere, 0, &d, &err), CW_ERR_EMPTY);
    cw_mesh_free(&out);
    free_square(&apart);
    free_square(&nowhere);
}

static void a_cube_keeps_its_corners_in_the_texture(void **state)
{
    (void)state;
    cw_mesh full = test_make_boxes(1);
    cw_error err = {0};
    test_add_box(&full, (double[3]){0, 0, 0}, (double[3]){1, 2, 3}, false);
    assert_ok(cw_mesh_atlas(&full, NULL, NULL, &err), err);
    cw_mesh out = simplify(&full, &(cw_simplify_desc){.error_mm = 0.01});
    assert_int_equal(out.triangle_count, 12);
    assert_true(measure(&out, &full).max_mm < 1e-5);
    cw_mesh_free(&out);
    cw_mesh_free(&full);
}

/* Vertices that were split at seams are joined again, with a place for each corner. */
static void welding_keeps_split_seams(void **state)
{
    (void)state;
    cw_mesh mesh = make_textured(CW_FIELD_TORUS, 20), split = make_textured(CW_FIELD_TORUS, 20);
    cw_error err = {0};
    size_t merged;
    assert_ok(cw_mesh_split_seams(&split, &err), err);
    assert_true(split.vertex_count > mesh.vertex_count);
    assert_ok(cw_mesh_weld(&split, &merged, &err), err);
    assert_true(merged > 0);
    assert_int_equal(split.vertex_count, mesh.vertex_count);
    assert_memory_equal(test_coordinates(&mesh), test_coordinates(&split),
                        3 * mesh.triangle_count * sizeof(float[2]));
    cw_mesh_free(&mesh);
    cw_mesh_free(&split);
}

static void bad_calls_are_named(void **state)
{
    (void)state;
    cw_mesh textured = make_textured(CW_FIELD_SPHERE, 12),
            bare = test_extract_field(CW_FIELD_SPHERE, 12);
    cw_texture_distance d;
    cw_error err = {0};
    assert_int_equal(cw_mesh_texture_distance(&bare, &textured, 0, &d, &err), CW_ERR_ARGUMENT);
    assert_non_null(strstr(err.message, "the mesh has no texture coordinates"));
    assert_int_equal(cw_mesh_texture_distance(&textured, &bare, 0, &d, &err), CW_ERR_ARGUMENT);
    assert_non_null(strstr(err.message, "the full mesh has no texture coordinates"));
    cw_mesh_free(&textured);
    cw_mesh_free(&bare);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(charts_stay_whole),
        cmocka_unit_test(places_move_about_as_far_as_the_surface),
        cmocka_unit_test(blocks_and_threads_change_nothing),
        cmocka_unit_test(levels_keep_the_texture),
        cmocka_unit_test(a_bent_texture_on_a_plane_keeps_triangles),
        cmocka_unit_test(a_straight_texture_on_a_plane_keeps_none),
        cmocka_unit_test(overlaps_that_are_meant_may_stay),
        cmocka_unit_test(odd_textures_end),
        cmocka_unit_test(a_cube_keeps_its_corners_in_the_texture),
        cmocka_unit_test(welding_keeps_split_seams),
        cmocka_unit_test(bad_calls_are_named),
    };
    return cw_simplify_available() ? cmocka_run_group_tests(tests, NULL, NULL) : 0;
}
