/* Occlusion, curvature, thickness and colours: on spheres, whose answers are known. */
#include "support/solids.h"
#include "support/surface.h"

#include <cubewright/atlas.h>
#include <cubewright/bake.h>

#include "core/base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE = 256, COARSE = SIZE / CW_OCCLUSION_DIVISOR };

/* A sphere of radius 30 around the origin, extracted from n voxels. */
static cw_mesh make_sphere(size_t n)
{
    cw_mesh mesh = test_extract_field(CW_FIELD_SPHERE, n);
    cw_error err = {0};
    assert_ok(cw_mesh_normals(&mesh, &err), err);
    return mesh;
}

static cw_mesh make_textured(size_t n)
{
    cw_mesh mesh = make_sphere(n);
    cw_error err = {0};
    assert_ok(cw_mesh_atlas(&mesh, &(cw_atlas_desc){.size = SIZE}, NULL, &err), err);
    return mesh;
}

/* Calls check for the middle texel of each triangle of some size, with the middle of the triangle. */
static void sample_triangles(const cw_mesh *mesh, const cw_image *image,
                             void (*check)(const double point[3], const uint8_t *pixel))
{
    const float *uv = cw_mesh_attribute_find(mesh, CW_TEXTURE_COORDINATES)->data;
    size_t count = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        double point[3] = {0}, at[2] = {0};
        for (size_t c = 0; c < 3; c++) {
            const size_t v = mesh->triangles[3 * t + c];
            for (size_t k = 0; k < 3; k++)
                point[k] += (mesh->origin[k] + (double)mesh->positions[3 * v + k]) / 3;
            for (size_t k = 0; k < 2; k++)
                at[k] += (double)uv[6 * t + 2 * c + k] / 3;
        }
        const size_t x = (size_t)(at[0] * (double)image->width),
                     y = (size_t)(at[1] * (double)image->height);
        check(point, image->pixels + 4 * (y * image->width + x));
        count++;
    }
    assert_true(count > 100);
}

static void is_white(const double point[3], const uint8_t *pixel)
{
    (void)point;
    assert_true(pixel[0] == 255 && pixel[1] == 255 && pixel[2] == 255 && pixel[3] == 255);
}

static void is_black(const double point[3], const uint8_t *pixel)
{
    (void)point;
    assert_true(pixel[0] == 0);
}

/* 1 / 30 of 1 / 15: half of the way from grey to white. */
static void is_bent_outward(const double point[3], const uint8_t *pixel)
{
    (void)point;
    assert_in_range(pixel[0], 178, 204);
}

/* Rays within 30 degrees of the normal go 60 cos of the angle: evenly spread over its cosine, 56 of 80 mm. */
static void is_as_thick_as_a_sphere(const double point[3], const uint8_t *pixel)
{
    (void)point;
    assert_in_range(pixel[0], 174, 183);
}

static void is_coloured_by_height(const double point[3], const uint8_t *pixel)
{
    assert_true(fabs(pixel[0] - (128 + 4 * point[2])) < 9);
    assert_int_equal(pixel[1], 10);
}

static void a_sphere_is_open_round_and_thick(void **state)
{
    (void)state;
    cw_mesh mesh = make_textured(24), full = make_sphere(64);
    cw_image images[CW_MAP_COUNT];
    cw_bake_facts facts;
    cw_error err = {0};
    const cw_bake_desc desc = {.size = SIZE,
                               .maps = 1u << CW_MAP_OCCLUSION | 1u << CW_MAP_CURVATURE |
                                       1u << CW_MAP_THICKNESS | 1u << CW_MAP_COLORS,
                               .thickness_mm = 80,
                               .curvature_max = 1.0 / 15};
    assert_fails(cw_bake_maps(&mesh, &full, &desc, images, NULL, &err), CW_ERR_ARGUMENT,
                 "no colours", err);
    full.colors = cwi_alloc_array(full.vertex_count, 4);
    assert_non_null(full.colors);
    for (size_t v = 0; v < full.vertex_count; v++) {
        const double z = full.origin[2] + (double)full.positions[3 * v + 2];
        const uint8_t color[4] = {(uint8_t)(128 + 4 * z + 0.5), 10, 200, 255};
        memcpy(full.colors + 4 * v, color, 4);
    }
    assert_ok(cw_bake_maps(&mesh, &full, &desc, images, &facts, &err), err);
    assert_null(images[CW_MAP_NORMALS].pixels);
    assert_int_equal(images[CW_MAP_OCCLUSION].width, COARSE);
    assert_int_equal(images[CW_MAP_THICKNESS].height, COARSE);
    assert_int_equal(images[CW_MAP_COLORS].width, SIZE);
    assert_int_equal(facts.missed, 0);
    sample_triangles(&mesh, &images[CW_MAP_OCCLUSION], is_white);
    sample_triangles(&mesh, &images[CW_MAP_CURVATURE], is_bent_outward);
    sample_triangles(&mesh, &images[CW_MAP_THICKNESS], is_as_thick_as_a_sphere);
    sample_triangles(&mesh, &images[CW_MAP_COLORS], is_coloured_by_height);
    for (int m = 0; m < CW_MAP_COUNT; m++)
        cw_image_free(&images[m]);
    cw_mesh_free(&mesh);
    cw_mesh_free(&full);
}

/* Turns a mesh inside out: the wall of a cavity. */
static void turn_over(cw_mesh *mesh)
{
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t v = mesh->triangles[3 * t];
        mesh->triangles[3 * t] = mesh->triangles[3 * t + 1];
        mesh->triangles[3 * t + 1] = v;
    }
    for (size_t n = 0; n < 3 * mesh->vertex_count; n++)
        mesh->normals[n] = -mesh->normals[n];
}

static void a_cavity_is_dark(void **state)
{
    (void)state;
    cw_mesh mesh = make_sphere(24), full = make_sphere(64);
    cw_image images[CW_MAP_COUNT];
    cw_error err = {0};
    cw_bake_desc desc = {.size = SIZE, .maps = 1u << CW_MAP_OCCLUSION, .occlusion_mm = 100};
    turn_over(&mesh);
    turn_over(&full);
    assert_ok(cw_mesh_atlas(&mesh, &(cw_atlas_desc){.size = SIZE}, NULL, &err), err);
    assert_ok(cw_bake_maps(&mesh, &full, &desc, images, NULL, &err), err);
    sample_triangles(&mesh, &images[CW_MAP_OCCLUSION], is_black);
    cw_image_free(&images[CW_MAP_OCCLUSION]);
    cw_mesh_free(&mesh);
    cw_mesh_free(&full);
}

static void deep_images_agree_with_bytes(void **state)
{
    (void)state;
    cw_mesh mesh = make_textured(12), full = make_sphere(32);
    cw_image images[2][CW_MAP_COUNT];
    cw_error err = {0};
    const unsigned maps = 1u << CW_MAP_NORMALS | 1u << CW_MAP_CURVATURE;
    for (int deep = 0; deep < 2; deep++) {
        const cw_bake_desc desc = {
            .size = SIZE, .maps = maps, .deep = deep, .threads = 1 + 3 * deep};
        assert_ok(cw_bake_maps(&mesh, &full, &desc, images[deep], NULL, &err), err);
    }
    size_t finer = 0;
    for (int m = 0; m < CW_MAP_COUNT; m++) {
        const cw_image *flat = &images[0][m], *fine = &images[1][m];
        if (!(maps >> m & 1))
            continue;
        assert_null(flat->deep);
        assert_memory_equal(flat->pixels, fine->pixels, 4 * SIZE * SIZE);
        for (size_t n = 0; n < 4 * SIZE * SIZE; n++) {
            assert_int_equal((fine->deep[n] + 128) / 257, fine->pixels[n]);
            finer += fine->deep[n] != 257 * fine->pixels[n];
        }
    }
    assert_true(finer > SIZE * SIZE);
    uint8_t *png;
    size_t size;
    assert_ok(cw_image_encode(&images[1][CW_MAP_NORMALS], false, &png, &size, &err), err);
    assert_int_equal(png[24], 16); /* bits of a channel, in the header */
    cw_bytes_free(png);
    for (int n = 0; n < 2 * CW_MAP_COUNT; n++)
        cw_image_free(&images[0][0] + n);
    cw_mesh_free(&mesh);
    cw_mesh_free(&full);
}

static void unknown_maps_and_settings_are_refused(void **state)
{
    (void)state;
    cw_mesh mesh = make_textured(10);
    cw_image images[CW_MAP_COUNT];
    cw_error err = {0};
    assert_fails(cw_bake_maps(&mesh, &mesh, &(cw_bake_desc){.maps = 1u << CW_MAP_COUNT}, images,
                              NULL, &err),
                 CW_ERR_ARGUMENT, "desc->maps", err);
    assert_fails(
        cw_bake_maps(&mesh, &mesh, &(cw_bake_desc){.occlusion_mm = -1}, images, NULL, &err),
        CW_ERR_ARGUMENT, "desc->occlusion_mm -1", err);
    assert_string_equal(cw_map_name(CW_MAP_THICKNESS), "thickness");
    assert_null(cw_map_name(CW_MAP_COUNT));
    cw_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sphere_is_open_round_and_thick),
        cmocka_unit_test(a_cavity_is_dark),
        cmocka_unit_test(deep_images_agree_with_bytes),
        cmocka_unit_test(unknown_maps_and_settings_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
