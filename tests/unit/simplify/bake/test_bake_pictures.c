/* Baking of pictures: texels show what the old texture showed at the same place. */
#include "support/solids.h"
#include "support/texture.h"

#include <cubewright/atlas.h>
#include <cubewright/bake.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE = 256 };

static cw_mesh make_textured(size_t n)
{
    cw_mesh mesh = test_extract_field(CW_FIELD_TORUS, n);
    cw_error err = {0};
    assert_ok(cw_mesh_atlas(&mesh, &(cw_atlas_desc){.size = SIZE}, NULL, &err), err);
    assert_ok(cw_mesh_normals(&mesh, &err), err);
    return mesh;
}

/* Colours that tell the place: red rises along x, green along y, blue along z. */
static void color_of(const double p[3], uint8_t color[4])
{
    for (int a = 0; a < 3; a++)
        color[a] = (uint8_t)fmin(fmax(128 + 4 * p[a], 0), 255);
    color[3] = 255;
}

/* Draws the places of a mesh into its texture, with room around charts. */
static cw_image draw_places(const cw_mesh *mesh)
{
    const float(*uv)[2] = test_coordinates(mesh);
    cw_image image;
    cw_error err = {0};
    assert_ok(cw_image_alloc(&image, SIZE, SIZE, &err), err);
    for (size_t t = 0; t < mesh->triangle_count; t++, uv += 3)
        for (int i = 0; i <= 24; i++)
            for (int j = 0; i + j <= 24; j++) {
                const double w[3] = {i / 24.0, j / 24.0, 1 - (i + j) / 24.0};
                double p[3] = {0, 0, 0}, x = 0, y = 0;
                for (size_t k = 0; k < 3; k++) {
                    const float *v = mesh->positions + 3 * (size_t)mesh->triangles[3 * t + k];
                    for (size_t a = 0; a < 3; a++)
                        p[a] += w[k] * (mesh->origin[a] + (double)v[a]);
                    x += w[k] * (double)uv[k][0] * SIZE;
                    y += w[k] * (double)uv[k][1] * SIZE;
                }
                for (int n = 0; n < 9; n++) {
                    const int column = (int)x + n % 3 - 1, row = (int)y + n / 3 - 1;
                    if (column < 0 || row < 0 || column >= SIZE || row >= SIZE)
                        continue;
                    uint8_t *pixel = image.pixels + 4 * ((size_t)row * SIZE + (size_t)column);
                    if (n == 4 || pixel[3] == 0)
                        color_of(p, pixel);
                }
            }
    return image;
}

static void free_images(cw_image *images)
{
    for (int use = 0; use < CW_PICTURE_USES; use++)
        cw_image_free(&images[use]);
}

static void colours_stay_at_their_place(void **state)
{
    (void)state;
    cw_mesh old = make_textured(40), mesh = make_textured(28);
    cw_image drawn = draw_places(&old), expected = draw_places(&mesh), baked[CW_PICTURE_USES];
    const cw_bake_source source = {.mesh = &old, .pictures = {[CW_PICTURE_COLOR] = &drawn}};
    cw_bake_facts facts;
    cw_error err = {0};
    const cw_bake_desc desc = {.size = SIZE};
    assert_ok(cw_bake_pictures(&mesh, &source, 1, &desc, baked, &facts, &err), err);
    assert_int_equal(facts.missed, 0);
    assert_true(facts.max_mm < 1);
    assert_null(baked[CW_PICTURE_NORMAL].pixels);
    size_t off = 0, seen = 0;
    const float(*uv)[2] = test_coordinates(&mesh);
    for (size_t t = 0; t < mesh.triangle_count; t++, uv += 3) {
        const double x = (double)(uv[0][0] + uv[1][0] + uv[2][0]) / 3 * SIZE,
                     y = (double)(uv[0][1] + uv[1][1] + uv[2][1]) / 3 * SIZE;
        const size_t at = 4 * ((size_t)y * SIZE + (size_t)x);
        for (size_t c = 0; c < 3; c++) {
            seen++;
            off += abs(baked->pixels[at + c] - expected.pixels[at + c]) > 6;
        }
    }
    assert_true(seen > 1000 && off < seen / 100);
    free_images(baked);
    cw_image_free(&drawn);
    cw_image_free(&expected);
    cw_mesh_free(&old);
    cw_mesh_free(&mesh);
}

/* A flat normal map says what none says. Sources without a picture that others have are white. */
static void normal_maps_are_turned(void **state)
{
    (void)state;
    cw_mesh old = make_textured(32), mesh = make_textured(24);
    cw_image flat, baked[CW_PICTURE_USES], expected;
    cw_error err = {0};
    const cw_bake_desc desc = {.size = SIZE, .threads = 1},
                       again = {.size = SIZE, .threads = 3};
    assert_ok(cw_image_alloc(&flat, 16, 16, &err), err);
    for (size_t n = 0; n < 256; n++)
        memcpy(flat.pixels + 4 * n, (uint8_t[4]){128, 128, 255, 255}, 4);
    const cw_bake_source source = {
        .mesh = &old, .pictures = {[CW_PICTURE_NORMAL] = &flat}, .repeats = true};
    assert_ok(cw_bake_normals(&mesh, &old, &desc, &expected, NULL, &err), err);
    assert_ok(cw_bake_pictures(&mesh, &source, 1, &desc, baked, NULL, &err), err);
    size_t off = 0;
    for (size_t n = 0; n < 4 * SIZE * SIZE; n++)
        off += abs(baked[CW_PICTURE_NORMAL].pixels[n] - expected.pixels[n]) > 3;
    assert_true(off < 4 * SIZE * SIZE / 1000);
    cw_image threads[CW_PICTURE_USES];
    assert_ok(cw_bake_pictures(&mesh, &source, 1, &again, threads, NULL, &err), err);
    assert_memory_equal(threads[CW_PICTURE_NORMAL].pixels, baked[CW_PICTURE_NORMAL].pixels,
                        4 * SIZE * SIZE);
    free_images(threads);
    free_images(baked);
    cw_image_free(&expected);
    cw_image_free(&flat);
    cw_mesh_free(&old);
    cw_mesh_free(&mesh);
}

static void bad_sources_are_named(void **state)
{
    (void)state;
    cw_mesh mesh = make_textured(16), bare = test_extract_field(CW_FIELD_TORUS, 16);
    uint8_t pixel[4] = {1, 2, 3, 255};
    const cw_image image = {.width = 1, .height = 1, .pixels = pixel};
    const cw_bake_source source = {.mesh = &bare, .pictures = {&image}}, none = {0};
    cw_image baked[CW_PICTURE_USES];
    cw_error err = {0};
    assert_int_equal(cw_bake_pictures(&mesh, &source, 1, NULL, baked, NULL, &err),
                     CW_ERR_ARGUMENT);
    assert_non_null(strstr(err.message, "no texture coordinates"));
    assert_int_equal(cw_bake_pictures(&mesh, &source, 0, NULL, baked, NULL, &err),
                     CW_ERR_ARGUMENT);
    assert_int_equal(cw_bake_pictures(&mesh, &none, 1, NULL, baked, NULL, &err),
                     CW_ERR_ARGUMENT);
    cw_mesh_free(&mesh);
    cw_mesh_free(&bare);
}

/* Decodes an encoded picture, and parts of one, which are refused. */
static void pictures_are_decoded(void **state)
{
    (void)state;
    cw_image image, back;
    cw_error err = {0};
    uint8_t *bytes;
    size_t size;
    assert_ok(cw_image_alloc(&image, 5, 3, &err), err);
    for (size_t n = 0; n < 60; n++)
        image.pixels[n] = (uint8_t)(4 * n);
    assert_ok(cw_image_encode(&image, true, &bytes, &size, &err), err);
    cw_status st = cw_image_decode(bytes, size, &back, &err);
    if (st != CW_ERR_UNSUPPORTED) { /* without libpng in this build */
        assert_ok(st, err);
        assert_int_equal(back.width, 5);
        assert_memory_equal(back.pixels, image.pixels, 60);
        cw_image_free(&back);
        for (size_t cut = 0; cut < size; cut += 7) {
            st = cw_image_decode(bytes, cut, &back, &err);
            assert_true(st != CW_OK && !back.pixels);
        }
    }
    static const uint8_t jpeg[] = {0xff, 0xd8, 0xff, 0xc0, 0, 17,   8, 0,
                                   16,   0,    16,   3,    1, 0x22, 0};
    assert_true(cw_image_decode(jpeg, sizeof jpeg, &back, &err) != CW_OK);
    assert_true(cw_image_decode(jpeg, 4, &back, &err) != CW_OK);
    assert_true(cw_image_decode((const uint8_t *)"RIFF....WEBP", 12, &back, &err) ==
                CW_ERR_UNSUPPORTED);
    cw_bytes_free(bytes);
    cw_image_free(&image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(colours_stay_at_their_place),
        cmocka_unit_test(normal_maps_are_turned),
        cmocka_unit_test(bad_sources_are_named),
        cmocka_unit_test(pictures_are_decoded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
