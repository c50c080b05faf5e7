/* Normal maps: what they show is the normal of the full surface. */
#include "support/solids.h"
#include "support/surface.h"

#include <cubewright/atlas.h>
#include <cubewright/bake.h>

#include "core/mesh/mesh.h"
#include "core/texture/split_seams.h"
#include "core/texture/tangents.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A sphere of radius 30 around the origin, extracted from n voxels, with texture coordinates. */
static cw_mesh make_textured(size_t n, uint32_t size)
{
    cw_mesh mesh = test_extract_field(CW_FIELD_SPHERE, n);
    cw_error err = {0};
    assert_ok(cw_mesh_normals(&mesh, &err), err);
    assert_ok(cw_mesh_atlas(&mesh, &(cw_atlas_desc){.size = size}, NULL, &err), err);
    return mesh;
}

static void normalise(double v[3])
{
    const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int k = 0; k < 3; k++)
        v[k] /= length;
}

/* Draws a texel as viewers do, and returns the angle of its normal from that of a sphere, degrees. */
static double measure_texel(const cw_mesh *split, const float (*tangents)[4], size_t t,
                            const double weights[3], const uint8_t *pixel)
{
    double point[3] = {0}, normal[3] = {0}, tangent[3] = {0}, up[3] = {0}, drawn[3];
    for (int c = 0; c < 3; c++) {
        const size_t v = split->triangles[3 * t + (size_t)c];
        const float *n = split->normals + 3 * v, *a = tangents[v];
        for (size_t k = 0; k < 3; k++) {
            point[k] += weights[c] * (split->origin[k] + (double)split->positions[3 * v + k]);
            normal[k] += weights[c] * (double)n[k];
            tangent[k] += weights[c] * (double)a[k];
            up[k] +=
                weights[c] * (double)a[3] *
                (double)(n[(k + 1) % 3] * a[(k + 2) % 3] - n[(k + 2) % 3] * a[(k + 1) % 3]);
        }
    }
    normalise(normal);
    normalise(tangent);
    normalise(up);
    for (int k = 0; k < 3; k++)
        drawn[k] = (pixel[0] / 127.5 - 1) * tangent[k] + (pixel[1] / 127.5 - 1) * up[k] +
                   (pixel[2] / 127.5 - 1) * normal[k];
    normalise(drawn);
    normalise(point);
    const double cosine = drawn[0] * point[0] + drawn[1] * point[1] + drawn[2] * point[2];
    return acos(fmin(1, cosine)) * 180 / PI;
}

/* Samples each triangle at its middle; the texel there shows the sphere, whose triangles are far coarser
 * than the full ones. */
static void a_coarse_sphere_looks_round(void **state)
{
    (void)state;
    enum { SIZE = 1024 };
    cw_error err = {0};
    cw_image image;
    cw_bake_facts facts;
    cw_mesh coarse = make_textured(10, SIZE), full = test_extract_field(CW_FIELD_SPHERE, 64),
            split;
    assert_ok(cw_mesh_normals(&full, &err), err);
    const cw_bake_desc desc = {.size = SIZE};
    assert_ok(cw_bake_normals(&coarse, &full, &desc, &image, &facts, &err), err);
    assert_int_equal(image.width, SIZE);
    assert_int_equal(facts.missed, 0);
    assert_true(facts.texels > 0.4 * SIZE * SIZE && facts.max_mm < 5);
    assert_ok(cwi_split_seams(&coarse, &split, &err), err);
    float(*tangents)[4] = malloc(split.vertex_count * sizeof *tangents);
    assert_ok(cwi_tangents(&split, tangents, &err), err);
    const float *uv = cwi_texture_of(&split)->data;
    double sum = 0;
    for (size_t t = 0; t < split.triangle_count; t++) {
        double u = 0, v = 0;
        for (size_t k = 0; k < 3; k++) {
            u += (double)uv[2 * split.triangles[3 * t + k]] / 3;
            v += (double)uv[2 * split.triangles[3 * t + k] + 1] / 3;
        }
        const size_t at = (size_t)(v * SIZE) * SIZE + (size_t)(u * SIZE);
        sum +=
            measure_texel(&split, (const float(*)[4])tangents, t,
                          (const double[3]){1.0 / 3, 1.0 / 3, 1.0 / 3}, image.pixels + 4 * at);
    }
    assert_true(sum / (double)split.triangle_count <
                1.5); /* the middle of a texel is elsewhere */
    free(tangents);
    cw_mesh_free(&split);
    cw_mesh_free(&coarse);
    cw_mesh_free(&full);
    cw_image_free(&image);
}

/* Baking a surface on itself gives flat texels: (128, 128, 255). */
static void the_same_surface_is_flat(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_image image;
    cw_bake_facts facts;
    cw_mesh mesh = make_textured(24, 256);
    const cw_bake_desc desc = {.size = 256};
    assert_ok(cw_bake_normals(&mesh, &mesh, &desc, &image, &facts, &err), err);
    assert_int_equal(facts.missed, 0);
    assert_true(facts.max_mm < 1e-4 && facts.mean_deg < 0.1);
    for (size_t n = 0; n < (size_t)256 * 256; n++) {
        const uint8_t *p = image.pixels + 4 * n;
        assert_true(abs(p[0] - 128) <= 1 && abs(p[1] - 128) <= 1 && p[2] >= 254 && p[3] == 255);
    }
    cw_mesh_free(&mesh);
    cw_image_free(&image);
}

/* An inner shell that is nearer faces the other way, and is not taken. */
static void surfaces_that_face_away_are_not_taken(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_image image;
    cw_bake_facts facts;
    cw_mesh mesh = make_textured(24, 128), away = test_extract_field(CW_FIELD_SPHERE, 24);
    for (size_t t = 0; t < away.triangle_count; t++) {
        const uint32_t second = away.triangles[3 * t + 1];
        away.triangles[3 * t + 1] = away.triangles[3 * t + 2];
        away.triangles[3 * t + 2] = second;
    }
    const cw_bake_desc desc = {.size = 128};
    assert_ok(cw_bake_normals(&mesh, &away, &desc, &image, &facts, &err), err);
    assert_int_equal(facts.missed, facts.texels);
    cw_image_free(&image);
    const cw_bake_desc near = {.size = 128, .reach_mm = 0.5};
    for (size_t i = 0; i < 3 * away.vertex_count; i++)
        away.positions[i] *= 1.2F; /* out of reach */
    assert_ok(cw_bake_normals(&mesh, &away, &near, &image, &facts, &err), err);
    assert_int_equal(facts.missed, facts.texels);
    cw_image_free(&image);
    cw_mesh_free(&mesh);
    cw_mesh_free(&away);
}

static void units_origins_and_threads_do_not_matter(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_image first, image;
    cw_mesh mesh = make_textured(16, 128), full = test_extract_field(CW_FIELD_SPHERE, 32);
    const cw_bake_desc one = {.size = 128, .threads = 1}, five = {.size = 128, .threads = 5};
    assert_ok(cw_mesh_normals(&full, &err), err);
    assert_ok(cw_bake_normals(&mesh, &full, &one, &first, NULL, &err), err);
    assert_ok(cw_bake_normals(&mesh, &full, &five, &image, NULL, &err), err);
    assert_memory_equal(first.pixels, image.pixels, (size_t)4 * 128 * 128);
    cw_image_free(&image);
    for (size_t i = 0; i < 3 * mesh.vertex_count; i++)
        mesh.positions[i] *= 0x1p13F;
    for (size_t i = 0; i < 3 * full.vertex_count; i++)
        full.positions[i] *= 0x1p13F;
    for (int k = 0; k < 3; k++) {
        mesh.origin[k] *= 0x1p13;
        full.origin[k] *= 0x1p13;
    }
    assert_ok(cw_bake_normals(&mesh, &full, &one, &image, NULL, &err), err);
    assert_memory_equal(first.pixels, image.pixels, (size_t)4 * 128 * 128);
    cw_image_free(&image);
    cw_image_free(&first);
    cw_mesh_free(&mesh);
    cw_mesh_free(&full);
}

static void wrong_inputs_are_named(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_image image;
    cw_mesh mesh = make_textured(12, 64), bare = test_extract_field(CW_FIELD_SPHERE, 12),
            none = {0};
    static const struct {
        cw_bake_desc desc;
        const char *words;
    } rows[] = {{{.size = 8}, "desc->size 8: expected 16 to 16384"},
                {{.margin = 65}, "desc->margin 65"},
                {{.reach_mm = -1}, "desc->reach_mm -1"},
                {{.reach_mm = NAN}, "desc->reach_mm"}};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++)
        assert_fails(cw_bake_normals(&mesh, &bare, &rows[n].desc, &image, NULL, &err),
                     CW_ERR_ARGUMENT, rows[n].words, err);
    assert_fails(cw_bake_normals(&bare, &mesh, NULL, &image, NULL, &err), CW_ERR_ARGUMENT,
                 "no texture coordinates", err);
    assert_fails(cw_bake_normals(&mesh, &none, NULL, &image, NULL, &err), CW_ERR_ARGUMENT,
                 "the full mesh is empty", err);
    long left = 1;
    const cw_bake_desc stops = {.progress = {test_stop_after, &left}};
    assert_int_equal(cw_bake_normals(&mesh, &bare, &stops, &image, NULL, &err),
                     CW_ERR_CANCELLED);
    assert_null(image.pixels);
    cw_mesh_free(&mesh);
    cw_mesh_free(&bare);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_coarse_sphere_looks_round),
        cmocka_unit_test(the_same_surface_is_flat),
        cmocka_unit_test(surfaces_that_face_away_are_not_taken),
        cmocka_unit_test(units_origins_and_threads_do_not_matter),
        cmocka_unit_test(wrong_inputs_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
