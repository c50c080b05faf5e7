/* Looks: two surfaces drawn from the same places and compared. */
#include "support/solids.h"
#include "support/surface.h"

#include <cubewright/appearance.h>
#include <cubewright/atlas.h>
#include <cubewright/bake.h>

#include "core/base/memory.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_attributes.h"
#include "viewer/image/color_difference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE = 128 };

static const cw_appearance_desc small = {.size = SIZE};

static cw_mesh make_smooth(cw_field field, size_t n)
{
    cw_mesh mesh = test_extract_field(field, n);
    assert_non_null(mesh.normals);
    return mesh;
}

static void paint(cw_mesh *mesh, const uint8_t rgb[3])
{
    cwi_free(mesh->colors);
    mesh->colors = cwi_alloc_array(mesh->vertex_count, 4);
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        memcpy(mesh->colors + 4 * v, rgb, 3);
        mesh->colors[4 * v + 3] = 255;
    }
}

static void measure(const cw_surface_look *a, const cw_surface_look *b, cw_appearance *with,
                    cw_appearance *without)
{
    cw_error err = {0};
    assert_ok(cw_appearance_measure(a, 1, b, 1, &small, with, without, &err), err);
}

static cw_image draw_view(const cw_surface_look *look, uint32_t n, uint32_t size)
{
    cw_error err = {0};
    cw_image image;
    cw_appearance_view view;
    assert_ok(cw_appearance_find_view(look, 1, 8, n, &view, &err), err);
    assert_ok(cw_appearance_draw(look, 1, &view.camera, &(cw_appearance_desc){.size = size},
                                 &image, &err),
              err);
    return image;
}

/* --- truth -------------------------------------------------------------------------------- */

static void equal_surfaces_look_equal(void **state)
{
    (void)state;
    static const cw_field fields[] = {CW_FIELD_SPHERE, CW_FIELD_TORUS, CW_FIELD_GYROID};
    static cw_appearance with, without;
    for (int n = 0; n < 3; n++) {
        cw_mesh mesh = make_smooth(fields[n], 24);
        const cw_surface_look look = {.mesh = &mesh};
        measure(&look, &look, &with, &without);
        assert_int_equal(with.views, 8);
        assert_int_equal(with.size, SIZE);
        assert_true(with.all.pixels > 8 * 1000 && with.all.shown_by_one == 0);
        assert_true(with.all.rmse == 0 && with.all.delta_e == 0 && isinf(with.all.psnr_db));
        assert_true(with.all.rmse_both == 0 && isinf(with.all.psnr_both_db));
        assert_memory_equal(&with, &without, sizeof with);
        cw_mesh_free(&mesh);
    }
}

/* Greys as three.js r187 shows them of the torus of 48 voxels, in metres, in the light and material of the
 * measurement, without a graphics card: at pixels of three views of 256 pixels. */
static void light_is_that_of_three_js(void **state)
{
    (void)state;
    static const int known[][4] = {{0, 60, 60, 197},   {0, 60, 90, 171},   {0, 60, 128, 165},
                                   {0, 90, 60, 162},   {0, 90, 90, 84},    {0, 90, 166, 151},
                                   {0, 128, 60, 148},  {0, 128, 196, 201}, {3, 128, 60, 199},
                                   {3, 128, 128, 191}, {3, 128, 196, 168}, {3, 166, 60, 135},
                                   {3, 166, 166, 113}, {3, 166, 196, 84},  {7, 60, 60, 178},
                                   {7, 60, 128, 130},  {7, 90, 60, 119},   {7, 128, 60, 84},
                                   {7, 166, 166, 199}, {7, 196, 128, 188}, {7, 196, 196, 129}};
    cw_mesh mesh = make_smooth(CW_FIELD_TORUS, 48);
    const cw_surface_look look = {.mesh = &mesh};
    for (size_t n = 0; n < sizeof known / sizeof *known; n++) {
        cw_image image = draw_view(&look, (uint32_t)known[n][0], 256);
        const uint8_t *pixel = image.pixels + 4 * (known[n][1] * 256 + known[n][2]);
        assert_true(pixel[3] == 255 && pixel[0] == pixel[1] && pixel[1] == pixel[2]);
        if (abs(pixel[0] - known[n][3]) > 2)
            fail_msg("row %zu is %d, not %d", n, pixel[0], known[n][3]);
        cw_image_free(&image);
    }
    cw_mesh_free(&mesh);
}

/* A sphere's outline is a circle known on paper: the cone of tangents. */
static void a_sphere_covers_its_circle(void **state)
{
    (void)state;
    cw_mesh mesh = make_smooth(CW_FIELD_SPHERE, 64);
    const cw_surface_look look = {.mesh = &mesh};
    double center[3] = {0, 0, 0}, radius = 30;
    for (uint32_t n = 0; n < 8; n++) {
        cw_error err = {0};
        cw_appearance_view view;
        cw_image image = draw_view(&look, n, 256);
        assert_ok(cw_appearance_find_view(&look, 1, 8, n, &view, &err), err);
        double far_sq = 0, covered = 0;
        for (int a = 0; a < 3; a++) {
            assert_within(view.camera.target[a] + 100, center[a] + 100, 1e-3);
            far_sq += pow(view.camera.eye[a] - view.camera.target[a], 2);
        }
        assert_near(sqrt(far_sq), radius / sin(PI / 12) * 1.02, 0.2);
        const double slope = radius / sqrt(far_sq - radius * radius),
                     circle = slope / tan(PI / 12) * 128;
        for (size_t i = 0; i < (size_t)256 * 256; i++)
            covered += image.pixels[4 * i + 3] / 255.0;
        assert_within(covered, PI * circle * circle, 0.005);
        cw_image_free(&image);
    }
    cw_mesh_free(&mesh);
}

/* Colours of vertices and of faces; the figures are those of the pictures. */
static void colors_differ_by_what_the_pictures_show(void **state)
{
    (void)state;
    static const uint8_t colors[][3] = {
        {255, 255, 255}, {200, 40, 40}, {40, 200, 90}, {0, 0, 0}};
    static cw_appearance with;
    cw_mesh a = make_smooth(CW_FIELD_SPHERE, 24), b = make_smooth(CW_FIELD_SPHERE, 24);
    const cw_surface_look looks[2] = {{.mesh = &a}, {.mesh = &b}};
    for (int n = 0; n < 4; n++) {
        double delta = 0, square = 0, pixels = 0;
        paint(&b, colors[n]);
        measure(&looks[0], &looks[1], &with, NULL);
        for (uint32_t v = 0; v < 8; v++) {
            cw_image p = draw_view(&looks[0], v, SIZE), q = draw_view(&looks[1], v, SIZE);
            for (size_t i = 0; i < (size_t)SIZE * SIZE; i++) {
                double lab[2][3], srgb[2][3];
                if (!p.pixels[4 * i + 3])
                    continue;
                for (size_t k = 0; k < 3; k++) {
                    srgb[0][k] = p.pixels[4 * i + k] / 255.0;
                    srgb[1][k] = q.pixels[4 * i + k] / 255.0;
                    square += pow(255 * (srgb[0][k] - srgb[1][k]), 2) / 3;
                }
                cwi_lab_of(srgb[0], lab[0]);
                cwi_lab_of(srgb[1], lab[1]);
                delta += cwi_delta_e(lab[0], lab[1]);
                pixels++;
            }
            cw_image_free(&p);
            cw_image_free(&q);
        }
        assert_true(with.all.pixels == (size_t)pixels && with.all.shown_by_one == 0);
        assert_near(with.all.delta_e, delta / pixels, 1e-5);
        assert_near(with.all.rmse, sqrt(square / pixels), 1e-9);
        assert_true((with.all.delta_e > 20) == (n > 0)); /* white is no colour of its own */
    }
    cw_mesh_free(&a);
    cw_mesh_free(&b);
}

/* The same colour as that of all vertices, of all faces, and of all texels. */
static void one_color_is_drawn_in_three_ways(void **state)
{
    (void)state;
    static const uint8_t color[4] = {180, 90, 30, 255};
    static cw_appearance with, without;
    cw_error err = {0};
    cw_image map;
    cw_mesh mesh[3];
    for (int n = 0; n < 3; n++)
        mesh[n] = make_smooth(CW_FIELD_TORUS, 20);
    paint(&mesh[0], color);
    const cw_attribute faces = {
        .name = CW_FACE_COLORS, .on = CW_ON_TRIANGLES, .type = CW_U8, .components = 4};
    cw_attribute *added;
    assert_ok(cw_mesh_attribute_add(&mesh[1], &faces, &added, &err), err);
    for (size_t t = 0; t < mesh[1].triangle_count; t++)
        memcpy((uint8_t *)added->data + 4 * t, color, 4);
    assert_ok(cw_mesh_atlas(&mesh[2], &(cw_atlas_desc){.size = 256}, NULL, &err), err);
    assert_ok(cw_image_alloc(&map, 100, 37, &err), err);
    for (size_t i = 0; i < map.width * map.height; i++)
        memcpy(map.pixels + 4 * i, color, 4);
    const cw_surface_look looks[3] = {
        {.mesh = &mesh[0]}, {.mesh = &mesh[1]}, {.mesh = &mesh[2], .color_map = &map}};
    measure(&looks[0], &looks[1], &with, &without);
    assert_true(with.all.rmse < 0.1);
    measure(&looks[0], &looks[2], &with, &without);
    assert_true(with.all.rmse < 0.1 && without.all.rmse > 30);
    cw_image_free(&map);
    for (int n = 0; n < 3; n++)
        cw_mesh_free(&mesh[n]);
}

/* Occlusion takes the light from everywhere away, and no other: white changes nothing. */
static void occlusion_darkens_the_light_from_everywhere(void **state)
{
    (void)state;
    static cw_appearance with;
    cw_error err = {0};
    double last = 1e9;
    cw_mesh mesh = make_smooth(CW_FIELD_SPHERE, 20);
    assert_ok(cw_mesh_atlas(&mesh, &(cw_atlas_desc){.size = 128}, NULL, &err), err);
    for (int open = 0; open <= 255; open += 85) {
        uint8_t texel[4] = {(uint8_t)open, 7, 9, 255};
        const cw_image map = {.width = 1, .height = 1, .pixels = texel};
        const cw_surface_look plain = {.mesh = &mesh},
                              dark = {.mesh = &mesh, .occlusion_map = &map};
        measure(&plain, &dark, &with, NULL);
        assert_true(with.all.rmse < last && (with.all.rmse == 0) == (open == 255));
        last = with.all.rmse;
    }
    cw_mesh_free(&mesh);
}

/* --- normal maps -------------------------------------------------------------------------- */

/* Bakes a full surface on a coarse one. */
static cw_image bake(cw_mesh *coarse, const cw_mesh *full)
{
    cw_error err = {0};
    cw_image map;
    assert_ok(cw_mesh_atlas(coarse, &(cw_atlas_desc){.size = 512}, NULL, &err), err);
    assert_ok(cw_bake_normals(coarse, full, &(cw_bake_desc){.size = 512}, &map, NULL, &err),
              err);
    return map;
}

static void a_surface_with_its_own_normals_looks_the_same(void **state)
{
    (void)state;
    static const cw_field fields[] = {CW_FIELD_SPHERE, CW_FIELD_TORUS, CW_FIELD_GYROID};
    static cw_appearance with, without;
    for (int n = 0; n < 3; n++) {
        cw_mesh mesh = make_smooth(fields[n], 20), same = make_smooth(fields[n], 20);
        cw_image map = bake(&mesh, &same);
        const cw_surface_look plain = {.mesh = &same},
                              mapped = {.mesh = &mesh, .normal_map = &map};
        measure(&plain, &mapped, &with, &without);
        assert_true(with.all.psnr_db > 42 && with.all.delta_e < 0.3);
        assert_true(isinf(without.all.psnr_db)); /* seams split vertices, and nothing else */
        cw_image_free(&map);
        cw_mesh_free(&mesh);
        cw_mesh_free(&same);
    }
}

/* Puts ripples on a surface, 0.3 mm high and 8 mm long. */
static void ripple(cw_mesh *mesh)
{
    cw_error err = {0};
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        float *p = mesh->positions + 3 * v;
        double height = 0.3;
        for (size_t k = 0; k < 3; k++)
            height *= sin(0.8 * (double)p[k] + 1);
        for (size_t k = 0; k < 3; k++)
            p[k] += (float)(height * (double)mesh->normals[3 * v + k]);
    }
    assert_ok(cw_mesh_normals(mesh, &err), err);
}

static void a_baked_map_shows_the_full_surface(void **state)
{
    (void)state;
    static const cw_field fields[] = {CW_FIELD_SPHERE, CW_FIELD_TORUS, CW_FIELD_GYROID};
    static cw_appearance with, without;
    for (int n = 0; n < 3; n++) {
        cw_mesh coarse = make_smooth(fields[n], 24), full = make_smooth(fields[n], 64);
        ripple(&full);
        cw_image map = bake(&coarse, &full);
        const cw_surface_look plain = {.mesh = &full},
                              mapped = {.mesh = &coarse, .normal_map = &map};
        measure(&plain, &mapped, &with, &without);
        assert_true(with.all.delta_e_both < 0.6 * without.all.delta_e_both);
        assert_true(with.all.psnr_both_db > without.all.psnr_both_db + 1);
        assert_int_equal(with.all.shown_by_one, without.all.shown_by_one);
        cw_image_free(&map);
        cw_mesh_free(&coarse);
        cw_mesh_free(&full);
    }
}

/* --- views, parts, threads ---------------------------------------------------------------- */

/* A spot is seen best by the view that it faces. */
static void the_worst_view_sees_the_difference(void **state)
{
    (void)state;
    static cw_appearance with;
    cw_error err = {0};
    for (uint32_t n = 0; n < 8; n += 3) {
        cw_mesh a = make_smooth(CW_FIELD_SPHERE, 32), b = make_smooth(CW_FIELD_SPHERE, 32);
        const cw_surface_look looks[2] = {{.mesh = &a}, {.mesh = &b}};
        cw_appearance_view view;
        assert_ok(cw_appearance_find_view(looks, 1, 8, n, &view, &err), err);
        paint(&b, (const uint8_t[3]){255, 255, 255});
        for (size_t v = 0; v < b.vertex_count; v++) {
            double toward = 0, far = 0;
            for (size_t k = 0; k < 3; k++) {
                const double eye = view.camera.eye[k] - view.camera.target[k];
                toward += eye * (b.origin[k] + (double)b.positions[3 * v + k]);
                far += eye * eye;
            }
            if (toward / sqrt(far) > 28)
                memset(b.colors + 4 * v, 0, 3);
        }
        measure(&looks[0], &looks[1], &with, NULL);
        assert_int_equal(with.worst, n);
        assert_true(with.view[n].psnr_db < with.all.psnr_db);
        cw_mesh_free(&a);
        cw_mesh_free(&b);
    }
}

static void views_are_named_by_where_they_are(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_mesh mesh = make_smooth(CW_FIELD_SPHERE, 12);
    const cw_surface_look look = {.mesh = &mesh};
    cw_appearance_view view;
    assert_ok(cw_appearance_find_view(&look, 1, 1, 0, &view, &err), err);
    assert_near(view.azimuth_deg, 0, 1e-9);
    assert_near(view.elevation_deg, 0, 1e-9);
    assert_true(view.camera.eye[1] < -100 && fabs(view.camera.eye[0]) < 0.1); /* the front */
    assert_ok(cw_appearance_find_view(&look, 1, 0, 7, &view, &err), err);
    assert_near(view.azimuth_deg, 242.554, 0.001);
    assert_near(view.elevation_deg, -61.045, 0.001);
    assert_fails(cw_appearance_find_view(&look, 1, 8, 8, &view, &err), CW_ERR_ARGUMENT,
                 "view 8 of 8", err);
    cw_mesh_free(&mesh);
}

/* Parts one by one look as they do in one mesh, and hide each other. */
static void parts_are_looked_at_together(void **state)
{
    (void)state;
    static cw_appearance with;
    cw_error err = {0};
    cw_mesh a = make_smooth(CW_FIELD_SPHERE, 20), b = make_smooth(CW_FIELD_TORUS, 20), all;
    for (int k = 0; k < 3; k++)
        b.origin[k] += 17;
    paint(&a, (const uint8_t[3]){255, 0, 0});
    paint(&b, (const uint8_t[3]){0, 0, 255});
    assert_ok(cwi_mesh_copy(&a, &all, &err), err);
    assert_ok(cwi_mesh_append(&all, &b, &err), err);
    const cw_surface_look parts[2] = {{.mesh = &a}, {.mesh = &b}}, whole = {.mesh = &all};
    assert_ok(cw_appearance_measure(&whole, 1, parts, 2, &small, &with, NULL, &err), err);
    assert_true(with.all.rmse < 0.05);
    assert_ok(cw_appearance_measure(&whole, 1, parts, 1, &small, &with, NULL, &err), err);
    assert_true(with.all.shown_by_one > 1000 && with.all.psnr_db < 20);
    assert_true(with.all.delta_e > 2 * with.all.delta_e_both);
    assert_ok(cw_appearance_measure(&whole, 1, NULL, 0, &small, &with, NULL, &err), err);
    assert_int_equal(with.all.shown_by_one, with.all.pixels);
    assert_true(with.all.delta_e_both == 0 && with.all.psnr_both_db == 0);
    cw_mesh_free(&a);
    cw_mesh_free(&b);
    cw_mesh_free(&all);
}

static void threads_and_places_do_not_matter(void **state)
{
    (void)state;
    static cw_appearance one, other;
    cw_error err = {0};
    cw_mesh full = make_smooth(CW_FIELD_GYROID, 40), coarse = make_smooth(CW_FIELD_GYROID, 14);
    cw_image map = bake(&coarse, &full);
    const cw_surface_look looks[2] = {{.mesh = &full}, {.mesh = &coarse, .normal_map = &map}};
    for (int threads = 1; threads <= 7; threads += 3) {
        const cw_appearance_desc desc = {.size = 100, .views = 5, .threads = threads};
        assert_ok(cw_appearance_measure(looks, 1, looks + 1, 1, &desc,
                                        threads == 1 ? &one : &other, NULL, &err),
                  err);
        if (threads > 1)
            assert_memory_equal(&one, &other, sizeof one);
    }
    for (int k = 0; k < 3; k++) {
        full.origin[k] += 0x1p20;
        coarse.origin[k] += 0x1p20;
    }
    const cw_appearance_desc desc = {.size = 100, .views = 5};
    assert_ok(cw_appearance_measure(looks, 1, looks + 1, 1, &desc, &other, NULL, &err), err);
    assert_near(one.all.rmse, other.all.rmse, 0.02 * one.all.rmse);
    cw_image_free(&map);
    cw_mesh_free(&full);
    cw_mesh_free(&coarse);
}

/* --- hard inputs -------------------------------------------------------------------------- */

/* Without normals each triangle has one colour: of a cube at most three faces are seen. */
static void a_mesh_without_normals_is_flat(void **state)
{
    (void)state;
    cw_mesh cube;
    test_make_cube(&cube);
    cwi_free(cube.normals);
    cube.normals = NULL;
    const cw_surface_look look = {.mesh = &cube};
    cw_image image = draw_view(&look, 1, SIZE);
    bool seen[256] = {false};
    int colors = 0;
    for (size_t i = 0; i < (size_t)SIZE * SIZE; i++)
        if (image.pixels[4 * i + 3] == 255)
            seen[image.pixels[4 * i]] = true;
    for (int n = 0; n < 256; n++)
        colors += seen[n];
    assert_true(colors >= 3 && colors < 40); /* a little gloss changes along a face */
    cw_image_free(&image);
    cw_mesh_free(&cube);
}

/* The other mesh may be far larger, so that the camera is within it, or far away, or tiny. */
static void other_sizes_are_told_and_harm_nothing(void **state)
{
    (void)state;
    static const float scales[] = {1e-6F, 1e-3F, 4, 30, 1e3F, 1e6F, 1e30F};
    static cw_appearance with;
    for (size_t n = 0; n < sizeof scales / sizeof *scales; n++) {
        cw_mesh a = make_smooth(CW_FIELD_SPHERE, 16), b = make_smooth(CW_FIELD_SPHERE, 16);
        const cw_surface_look looks[2] = {{.mesh = &a}, {.mesh = &b}};
        for (size_t i = 0; i < 3 * b.vertex_count; i++)
            b.positions[i] *= scales[n];
        measure(&looks[0], &looks[1], &with, NULL);
        assert_true(with.all.psnr_db < 12 && isfinite(with.all.delta_e));
        cw_mesh_free(&a);
        cw_mesh_free(&b);
    }
}

/* A wall that begins behind the camera hides the reference. */
static void triangles_across_the_camera_are_drawn(void **state)
{
    (void)state;
    static const float corners[] = {-5000, -900, -20, 5000, -900, -20, 0, 900, 20};
    static cw_appearance with;
    cw_mesh sphere = make_smooth(CW_FIELD_SPHERE, 16);
    cw_mesh wall = {.vertex_count = 3,
                    .triangle_count = 1,
                    .positions = (float *)(uintptr_t)corners,
                    .triangles = (uint32_t[]){0, 1, 2}};
    const cw_surface_look looks[2] = {{.mesh = &sphere}, {.mesh = &wall}};
    measure(&looks[0], &looks[1], &with, NULL);
    assert_true(with.all.pixels > 2 * (with.all.pixels - with.all.shown_by_one) &&
                with.all.pixels > with.all.shown_by_one);
    cw_mesh_free(&sphere);
}

static void wrong_inputs_are_named(void **state)
{
    (void)state;
    static cw_appearance out;
    cw_error err = {0};
    uint8_t texel[4] = {128, 128, 255, 255};
    const cw_image map = {.width = 1, .height = 1, .pixels = texel}, none = {0};
    cw_mesh mesh = make_smooth(CW_FIELD_SPHERE, 12), bare = make_smooth(CW_FIELD_SPHERE, 12),
            empty = {0}, point = make_smooth(CW_FIELD_SPHERE, 12);
    memset(point.positions, 0, 3 * point.vertex_count * sizeof *point.positions);
    assert_ok(cw_mesh_atlas(&bare, &(cw_atlas_desc){.size = 64}, NULL, &err), err);
    cwi_free(bare.normals);
    bare.normals = NULL;
    const struct {
        cw_surface_look a, b;
        cw_appearance_desc desc;
        const char *words;
    } rows[] = {
        {{.mesh = &mesh}, {.mesh = &mesh}, {.views = 65}, "desc->views 65: expected 1 to 64"},
        {{.mesh = &mesh}, {.mesh = &mesh}, {.size = 8}, "desc->size 8: expected 16 to 4096"},
        {{.mesh = &empty}, {.mesh = &mesh}, {0}, "nothing to look at"},
        {{.mesh = &point}, {.mesh = &mesh}, {0}, "nothing to look at"},
        {{.mesh = &mesh}, {.mesh = &mesh, .normal_map = &map}, {0}, "no texture coordinates"},
        {{.mesh = &mesh, .color_map = &map}, {.mesh = &mesh}, {0}, "no texture coordinates"},
        {{.mesh = &mesh}, {.mesh = &bare, .normal_map = &map}, {0}, "no normals"},
        {{.mesh = &mesh}, {.mesh = &bare, .color_map = &none}, {0}, "a map of 0 x 0 texels"},
        {{.mesh = &mesh}, {0}, {0}, "surface 0 has no mesh"},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++)
        assert_fails(cw_appearance_measure(&rows[n].a, 1, &rows[n].b, 1, &rows[n].desc, &out,
                                           NULL, &err),
                     CW_ERR_ARGUMENT, rows[n].words, err);
    int left = 2;
    const cw_surface_look look = {.mesh = &mesh};
    const cw_appearance_desc stops = {.size = 64, .progress = {test_stop_after, &left}};
    assert_int_equal(cw_appearance_measure(&look, 1, &look, 1, &stops, &out, NULL, &err),
                     CW_ERR_CANCELLED);
    cw_mesh_free(&mesh);
    cw_mesh_free(&bare);
    cw_mesh_free(&point);
}

/* Each allocation in turn fails: it says so, and leaves nothing. */
static void memory_may_run_out(void **state)
{
    (void)state;
    static cw_appearance out;
    cw_mesh full = make_smooth(CW_FIELD_TORUS, 16), coarse = make_smooth(CW_FIELD_TORUS, 10);
    cw_image map = bake(&coarse, &full);
    paint(&full, (const uint8_t[3]){200, 100, 50});
    const cw_surface_look looks[2] = {{.mesh = &full},
                                      {.mesh = &coarse, .normal_map = &map, .color_map = &map}};
    const cw_appearance_desc desc = {.size = 16, .views = 1, .threads = 1};
    long n = 0;
    for (;; n++) {
        cw_error err = {0};
        cwi_alloc_fail_after(n);
        const cw_status st =
            cw_appearance_measure(looks, 1, looks + 1, 1, &desc, &out, NULL, &err);
        if (!cwi_alloc_fail_after(-1)) {
            assert_ok(st, err);
            break;
        }
        assert_int_equal(st, CW_ERR_NO_MEMORY);
    }
    assert_true(n > 20);
    cw_image_free(&map);
    cw_mesh_free(&full);
    cw_mesh_free(&coarse);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_surfaces_look_equal),
        cmocka_unit_test(light_is_that_of_three_js),
        cmocka_unit_test(a_sphere_covers_its_circle),
        cmocka_unit_test(colors_differ_by_what_the_pictures_show),
        cmocka_unit_test(one_color_is_drawn_in_three_ways),
        cmocka_unit_test(occlusion_darkens_the_light_from_everywhere),
        cmocka_unit_test(a_surface_with_its_own_normals_looks_the_same),
        cmocka_unit_test(a_baked_map_shows_the_full_surface),
        cmocka_unit_test(the_worst_view_sees_the_difference),
        cmocka_unit_test(views_are_named_by_where_they_are),
        cmocka_unit_test(parts_are_looked_at_together),
        cmocka_unit_test(threads_and_places_do_not_matter),
        cmocka_unit_test(a_mesh_without_normals_is_flat),
        cmocka_unit_test(other_sizes_are_told_and_harm_nothing),
        cmocka_unit_test(triangles_across_the_camera_are_drawn),
        cmocka_unit_test(wrong_inputs_are_named),
        cmocka_unit_test(memory_may_run_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
