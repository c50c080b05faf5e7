/* Tests the rasterizer on the CPU: coverage, views, holes, hiding, perspective, and errors. */
#include "support/support.h"

#include "core/base/memory.h"
#include <cubewright/render.h>

#include <math.h>
#include <png.h>
#include <stdlib.h>
#include <string.h>

#define CLEAR                                                                                  \
    {                                                                                          \
        {255, 255, 255, 0},                                                                    \
        {                                                                                      \
            255, 255, 255, 0                                                                   \
        }                                                                                      \
    }

static void make_arrays(cw_mesh *mesh, size_t vertices, size_t triangles)
{
    *mesh = (cw_mesh){.vertex_count = vertices, .triangle_count = triangles};
    mesh->positions = malloc(12 * vertices);
    mesh->triangles = malloc(12 * triangles);
    assert_true(mesh->positions && mesh->triangles);
}

static void put_triangle(cw_mesh *mesh, size_t t, size_t a, size_t b, size_t c)
{
    mesh->triangles[3 * t] = (uint32_t)a;
    mesh->triangles[3 * t + 1] = (uint32_t)b;
    mesh->triangles[3 * t + 2] = (uint32_t)c;
}

/* A sheet of n x m quads: vertices in rows, counter-clockwise with rows up and
 * columns right. */
static void put_quads(cw_mesh *mesh, size_t n, size_t m)
{
    size_t t = 0;
    for (size_t j = 0; j < m; j++)
        for (size_t i = 0; i < n; i++) {
            const size_t a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
            put_triangle(mesh, t++, a, b, d);
            put_triangle(mesh, t++, a, d, c);
        }
}

/* A sphere by longitude and latitude, far from zero. */
static void make_sphere(cw_mesh *mesh, double radius)
{
    enum { N = 128, M = 64 };
    make_arrays(mesh, (N + 1) * (M + 1), 2 * N * M);
    mesh->normals = malloc(12 * mesh->vertex_count);
    assert_non_null(mesh->normals);
    put_quads(mesh, N, M);
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        const double a = 2 * PI * (double)(v % (N + 1)) / N, b = PI * (double)(v / (N + 1)) / M;
        const double n[3] = {sin(b) * cos(a), sin(b) * sin(a), -cos(b)};
        for (size_t c = 0; c < 3; c++) {
            mesh->normals[3 * v + c] = (float)n[c];
            mesh->positions[3 * v + c] = (float)(radius * n[c]);
        }
    }
    for (int a = 0; a < 3; a++)
        mesh->origin[a] = 1000.0 * (a + 1);
}

/* A plane facing the front (-y), columns to +x, rows to +z; each quad 1 mm. */
static void make_sheet(cw_mesh *mesh, size_t n, size_t m)
{
    make_arrays(mesh, (n + 1) * (m + 1), 2 * n * m);
    put_quads(mesh, n, m);
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        mesh->positions[3 * v] = (float)(v % (n + 1));
        mesh->positions[3 * v + 1] = 0;
        mesh->positions[3 * v + 2] = (float)(v / (n + 1));
    }
}

static cw_camera fit(const cw_mesh *mesh, const char *view, double fov_deg, double margin)
{
    cw_fit_desc desc = {.view = view, .fov_deg = fov_deg, .margin = margin};
    cw_camera camera;
    cw_error err = {0};
    cw_mesh_bounds(mesh, desc.min, desc.max);
    assert_ok(cw_camera_fit(&desc, &camera, &err), err);
    return camera;
}

static void render(const cw_mesh *mesh, const cw_render_mesh_desc *desc, cw_image *image)
{
    cw_error err = {0};
    assert_ok(cw_render_mesh(mesh, desc, image, &err), err);
}

static const uint8_t *pixel_at(const cw_image *image, size_t x, size_t y)
{
    return image->pixels + 4 * (y * image->width + x);
}

/* Pixels' worth of surface in a picture whose background is transparent. */
static double covered(const cw_image *image)
{
    double sum = 0;
    for (size_t i = 0; i < image->width * image->height; i++)
        sum += image->pixels[4 * i + 3] / 255.0;
    return sum;
}

static void a_sphere_fills_pi_quarters_of_its_square(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_image image;
    make_sphere(&mesh, 50);
    for (int samples = 1; samples <= 4; samples++) {
        const cw_render_mesh_desc desc = {.camera = fit(&mesh, "front", 0, 0),
                                          .width = 200,
                                          .height = 200,
                                          .samples = samples,
                                          .background = CLEAR};
        render(&mesh, &desc, &image);
        assert_within(covered(&image), PI / 4 * 200 * 200, 0.01);
        cw_image_free(&image);
    }
    cw_mesh_free(&mesh);
}

static void the_middle_of_a_sphere_is_brighter_than_its_rim(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_image image;
    make_sphere(&mesh, 50);
    const cw_render_mesh_desc desc = {
        .camera = fit(&mesh, "front", 0, 0), .width = 100, .height = 100};
    render(&mesh, &desc, &image);
    const uint8_t *middle = pixel_at(&image, 50, 50);
    assert_int_equal(middle[3], 255);
    for (int i = 0; i < 4; i++) {
        const size_t x = (const size_t[]){2, 97, 50, 50}[i],
                     y = (const size_t[]){50, 50, 2, 97}[i];
        assert_true(pixel_at(&image, x, y)[1] + 15 < middle[1]);
    }
    cw_image_free(&image);
    cw_mesh_free(&mesh);
}

static void any_number_of_threads_gives_the_same_bytes(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_image one, many;
    make_sphere(&mesh, 20);
    cw_render_mesh_desc desc = {.width = 150, .height = 101, .samples = 3, .threads = 1};
    render(&mesh, &desc, &one);
    for (desc.threads = 2; desc.threads <= 5; desc.threads++) {
        render(&mesh, &desc, &many);
        assert_memory_equal(one.pixels, many.pixels, 4 * one.width * one.height);
        cw_image_free(&many);
    }
    cw_image_free(&one);
    cw_mesh_free(&mesh);
}

/* Which way of the patient is to the right and which is up in each view. */
static void views_show_the_patient_unmirrored(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double right[3], up[3];
    } rows[] = {
        {"front", {1, 0, 0}, {0, 0, 1}}, {"back", {-1, 0, 0}, {0, 0, 1}},
        {"left", {0, 1, 0}, {0, 0, 1}},  {"right", {0, -1, 0}, {0, 0, 1}},
        {"top", {-1, 0, 0}, {0, -1, 0}}, {"bottom", {1, 0, 0}, {0, -1, 0}},
    };
    cw_mesh mesh = {0};
    cw_error err = {0};
    double right[3], up[3], forward[3];
    make_sphere(&mesh, 5);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const cw_camera camera = fit(&mesh, rows[i].name, 0, 0);
        assert_string_equal(cw_view_name(i), rows[i].name);
        assert_ok(cw_camera_axes(&camera, right, up, forward, &err), err);
        for (int a = 0; a < 3; a++) {
            assert_near(right[a], rows[i].right[a], 1e-12);
            assert_near(up[a], rows[i].up[a], 1e-12);
        }
    }
    assert_string_equal(cw_view_name(6), "iso");
    assert_null(cw_view_name(7));
    cw_mesh_free(&mesh);
}

/* One quad of a 3 x 3 sheet is left out: the hole must be where it belongs. */
static void a_hole_is_seen_where_it_is(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_image image;
    make_sheet(&mesh, 3, 3);
    const size_t top_right = 3 * 2 + 2; /* +x is the patient's left: the picture's right */
    memmove(mesh.triangles + 6 * top_right, mesh.triangles + 6 * (top_right + 1),
            (mesh.triangle_count / 2 - top_right - 1) * 24);
    mesh.triangle_count -= 2;
    const cw_render_mesh_desc desc = {
        .camera = fit(&mesh, "front", 0, 0), .width = 30, .height = 30, .background = CLEAR};
    render(&mesh, &desc, &image);
    for (size_t y = 0; y < 30; y++)
        for (size_t x = 0; x < 30; x++)
            assert_int_equal(pixel_at(&image, x, y)[3], x >= 20 && y < 10 ? 0 : 255);
    cw_image_free(&image);
    cw_mesh_free(&mesh);
}

/* Vertices and edges lie exactly on samples, the worst case. Drawn one by one, the triangles
 * cover each sample once. */
static void every_sample_belongs_to_one_triangle(void **state)
{
    (void)state;
    enum { SIZE = 36 };
    cw_mesh mesh = {0};
    cw_image image;
    make_sheet(&mesh, 6, 6);
    for (size_t v = 0; v < mesh.vertex_count; v++) /* shear, so that edges have all slopes */
        if (v % 7 % 6 != 0 && v / 7 % 6 != 0)
            mesh.positions[3 * v + v % 2 * 2] += (float)(v % 5) / 12.0f;
    cw_render_mesh_desc desc = {.camera = fit(&mesh, "front", 0, 0),
                                .width = SIZE,
                                .height = SIZE,
                                .samples = 1,
                                .background = CLEAR};
    desc.camera.height_mm += 1.0 / SIZE * desc.camera.height_mm; /* pixels off the vertices */
    for (int shifted = 0; shifted < 2; shifted++) {
        static unsigned char count[SIZE * SIZE];
        memset(count, 0, sizeof count);
        cw_mesh single = mesh;
        single.triangle_count = 1;
        for (size_t t = 0; t < mesh.triangle_count; t++) {
            single.triangles = mesh.triangles + 3 * t;
            render(&single, &desc, &image);
            for (size_t i = 0; i < SIZE * SIZE; i++)
                count[i] += image.pixels[4 * i + 3] == 255;
            cw_image_free(&image);
        }
        for (size_t i = 0; i < SIZE * SIZE; i++) {
            const bool inner =
                i % SIZE > 0 && i % SIZE < SIZE - 1 && i / SIZE > 0 && i / SIZE < SIZE - 1;
            assert_true(inner ? count[i] == 1 : count[i] <= 1);
        }
        desc.camera = fit(&mesh, "front", 0, 0); /* again with samples on vertices */
        desc.camera.eye[0] += 1.0 / 12;
        desc.camera.target[0] += 1.0 / 12;
        desc.camera.eye[2] -= 1.0 / 12;
        desc.camera.target[2] -= 1.0 / 12;
    }
    cw_mesh_free(&mesh);
}

static void the_nearer_surface_hides_the_other(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_image image;
    make_arrays(&mesh, 8, 4);
    mesh.colors = calloc(8, 4);
    assert_non_null(mesh.colors);
    for (size_t q = 0; q < 2; q++) {
        for (size_t v = 0; v < 4; v++) {
            const float at[3] = {(float)(v % 2), q == 0 ? 5.0f : 1.0f, (float)(v / 2)};
            memcpy(mesh.positions + 12 * q + 3 * v, at, sizeof at);
            mesh.colors[16 * q + 4 * v + 2 * q] = 255; /* far red, near blue */
        }
        put_triangle(&mesh, 2 * q, 4 * q, 4 * q + 1, 4 * q + 3);
        put_triangle(&mesh, 2 * q + 1, 4 * q, 4 * q + 3, 4 * q + 2);
    }
    for (int swap = 0; swap < 2; swap++) {
        for (double fov = 0; fov < 50; fov += 20) {
            const cw_render_mesh_desc desc = {
                .camera = fit(&mesh, "front", fov, 0), .width = 20, .height = 20};
            render(&mesh, &desc, &image);
            const uint8_t *p = pixel_at(&image, 10, 10);
            assert_true(p[2] > 200 && p[0] < 100);
            cw_image_free(&image);
        }
        for (size_t i = 0; i < 6; i++) { /* the same with the order of triangles turned */
            const uint32_t kept = mesh.triangles[i];
            mesh.triangles[i] = mesh.triangles[i + 6];
            mesh.triangles[i + 6] = kept;
        }
    }
    cw_mesh_free(&mesh);
}

static void an_inside_out_surface_is_red(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_image image;
    make_sphere(&mesh, 10);
    const cw_render_mesh_desc desc = {
        .camera = fit(&mesh, "left", 20, 0), .width = 40, .height = 40};
    render(&mesh, &desc, &image);
    assert_true(pixel_at(&image, 20, 20)[0] < pixel_at(&image, 20, 20)[1] + 40);
    cw_image_free(&image);
    for (size_t t = 0; t < mesh.triangle_count; t++)
        put_triangle(&mesh, t, mesh.triangles[3 * t], mesh.triangles[3 * t + 2],
                     mesh.triangles[3 * t + 1]);
    render(&mesh, &desc, &image);
    assert_true(pixel_at(&image, 20, 20)[0] > pixel_at(&image, 20, 20)[1] + 60);
    cw_image_free(&image);
    cw_mesh_free(&mesh);
}

/* Triangles cross the eye's plane; none may leave a gap or appear mirrored from behind. */
static void from_inside_a_sphere_there_is_no_gap(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_image image;
    make_sphere(&mesh, 10);
    cw_render_mesh_desc desc = {.width = 120, .height = 120, .background = CLEAR};
    desc.camera = (cw_camera){.eye = {1003, 1997, 3001}, .up = {0, 0, 1}, .fov_deg = 150};
    for (int i = 0; i < test_some(6); i++) {
        for (int a = 0; a < 3; a++)
            desc.camera.target[a] = desc.camera.eye[a] + sin(1.7 * i + a);
        render(&mesh, &desc, &image);
        assert_near(covered(&image), 120 * 120, 0);
        for (size_t p = 0; p < 120 * 120; p++)
            assert_true(image.pixels[4 * p] > image.pixels[4 * p + 1] + 20);
        cw_image_free(&image);
    }
    cw_mesh_free(&mesh);
}

static void what_is_behind_the_eye_is_not_drawn(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_image image;
    make_sphere(&mesh, 10);
    for (double fov = 0; fov < 100; fov += 45) {
        cw_render_mesh_desc desc = {.width = 50, .height = 50, .background = CLEAR};
        desc.camera = fit(&mesh, "front", fov, 0.1);
        for (int a = 0; a < 3; a++) /* look away from it */
            desc.camera.target[a] = 2 * desc.camera.eye[a] - desc.camera.target[a];
        render(&mesh, &desc, &image);
        assert_near(covered(&image), 0, 0);
        cw_image_free(&image);
    }
    cw_mesh_free(&mesh);
}

/* A fitted box is whole, and large: its outermost pixels are next to the picture's edge. */
static void a_fitted_box_touches_the_margin_and_no_more(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_image image;
    test_make_cube(&mesh);
    for (double fov = 0; fov < 100; fov += 30)
        for (size_t i = 0; cw_view_name(i); i++) {
            const cw_render_mesh_desc desc = {.camera = fit(&mesh, cw_view_name(i), fov, 0.1),
                                              .width = 100,
                                              .height = 100,
                                              .background = CLEAR};
            size_t nearest = 100;
            render(&mesh, &desc, &image);
            for (size_t p = 0; p < 100 * 100; p++) {
                const size_t x = p % 100 < 50 ? p % 100 : 99 - p % 100;
                const size_t y = p / 100 < 50 ? p / 100 : 99 - p / 100;
                const size_t rim = x < y ? x : y;
                if (image.pixels[4 * p + 3] && rim < nearest)
                    nearest = rim;
            }
            assert_in_range(nearest, 9, 11);
            cw_image_free(&image);
        }
    cw_mesh_free(&mesh);
}

/* A floor from black at 100 mm to white at 300 mm: at 200 mm it is half as light, and that is
 * not half way down the picture. */
static void shares_are_right_in_perspective(void **state)
{
    (void)state;
    enum { SIZE = 400 };
    cw_mesh mesh = {0};
    cw_image ramp, flat;
    make_sheet(&mesh, 1, 1);
    mesh.colors = malloc(16);
    assert_non_null(mesh.colors);
    for (size_t v = 0; v < 4; v++) {
        const float at[3] = {v % 2 ? 200.0f : -200.0f, v / 2 ? 300.0f : 100.0f, -50};
        memcpy(mesh.positions + 3 * v, at, sizeof at);
        memset(mesh.colors + 4 * v, v / 2 ? 255 : 0, 4);
    }
    cw_render_mesh_desc desc = {.width = SIZE, .height = SIZE, .samples = 1};
    desc.camera = (cw_camera){.target = {0, 1, 0}, .up = {0, 0, 1}, .fov_deg = 90};
    render(&mesh, &desc, &ramp);
    memset(mesh.colors, 188, 16); /* sRGB of half the light */
    render(&mesh, &desc, &flat);
    const size_t y = SIZE / 2 + SIZE / 2 * 50 / 200;
    for (size_t x = 150; x < 250; x += 10)
        assert_near(pixel_at(&ramp, x, y)[1], pixel_at(&flat, x, y)[1], 2);
    assert_true(pixel_at(&ramp, 200, y + 20)[1] + 10 < pixel_at(&flat, 200, y + 20)[1]);
    cw_image_free(&ramp);
    cw_image_free(&flat);
    cw_mesh_free(&mesh);
}

static void without_normals_faces_are_flat(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_image image;
    test_make_cube(&mesh);
    free(mesh.normals);
    mesh.normals = NULL;
    const cw_render_mesh_desc desc = {
        .camera = fit(&mesh, "front", 0, 0), .width = 16, .height = 16};
    render(&mesh, &desc, &image);
    for (size_t p = 1; p < 256; p++) {
        assert_near(image.pixels[4 * p], image.pixels[0], 0);
        assert_near(image.pixels[4 * p + 2], image.pixels[2], 0);
    }
    cw_image_free(&image);
    cw_mesh_free(&mesh);
}

static void an_empty_mesh_gives_the_background(void **state)
{
    (void)state;
    const cw_mesh mesh = {0};
    const cw_render_mesh_desc desc = {
        .width = 3, .height = 2, .background = {{10, 20, 30, 255}, {110, 120, 130, 255}}};
    cw_image image;
    render(&mesh, &desc, &image);
    assert_memory_equal(pixel_at(&image, 0, 0), "\x23\x2d\x37\xff", 4);
    assert_memory_equal(pixel_at(&image, 2, 1), "\x55\x5f\x69\xff", 4);
    cw_image_free(&image);
}

static void mistakes_are_named(void **state)
{
    (void)state;
    const cw_camera good = {.target = {0, 1, 0}, .up = {0, 0, 1}, .fov_deg = 30};
    const cw_camera same = {.up = {0, 0, 1}, .fov_deg = 30};
    const cw_camera along = {.target = {0, 0, 1}, .up = {0, 0, 1}, .fov_deg = 30};
    const cw_camera wide = {.target = {0, 1, 0}, .up = {0, 0, 1}, .fov_deg = 180};
    const cw_camera low = {.target = {0, 1, 0}, .up = {0, 0, 1}};
    const struct {
        cw_render_mesh_desc desc;
        const char *words;
    } rows[] = {
        {{.camera = same}, "eye and target must be apart"},
        {{.camera = along}, "up is along its line of sight"},
        {{.camera = wide}, "opens 180 degrees"},
        {{.camera = low}, "picture is 0 mm high"},
        {{.camera = good, .width = 16385}, "a picture of 16385 x 720"},
        {{.camera = good, .samples = 5}, "5 samples a side"},
    };
    cw_mesh mesh = {0};
    cw_image image;
    cw_error err = {0};
    cw_camera camera;
    test_make_cube(&mesh);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        assert_fails(cw_render_mesh(&mesh, &rows[i].desc, &image, &err), CW_ERR_ARGUMENT,
                     rows[i].words, err);
        assert_null(image.pixels);
    }
    const cw_fit_desc sideways = {.view = "sideways"}, narrow = {.margin = 0.5};
    assert_fails(cw_camera_fit(&sideways, &camera, &err), CW_ERR_ARGUMENT,
                 "no view is named 'sideways'; there are front back", err);
    assert_fails(cw_camera_fit(&narrow, &camera, &err), CW_ERR_ARGUMENT, "margin of 0.5", err);
    mesh.triangles[5] = 8;
    assert_fails(cw_render_mesh(&mesh, NULL, &image, &err), CW_ERR_ARGUMENT, "names vertex 8",
                 err);
    cw_mesh_free(&mesh);
}

static bool stop_half_way(void *user, const char *step, double done)
{
    assert_string_equal(step, "drawing");
    ++*(int *)user;
    return done < 0.5;
}

static void drawing_can_be_cancelled(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_image image;
    cw_error err = {0};
    int calls = 0;
    test_make_cube(&mesh);
    const cw_render_mesh_desc desc = {
        .width = 64, .height = 640, .progress = {stop_half_way, &calls}};
    assert_fails(cw_render_mesh(&mesh, &desc, &image, &err), CW_ERR_CANCELLED, "drawing", err);
    assert_null(image.pixels);
    assert_in_range(calls, 1, 41);
    cw_mesh_free(&mesh);
}

static void running_out_of_memory_is_an_error(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_error err = {0};
    test_make_cube(&mesh);
    const cw_render_mesh_desc desc = {.width = 32, .height = 32, .threads = 1};
    bool failed = true;
    for (long n = 0; failed; n++) {
        cw_image image = {0};
        cwi_alloc_fail_after(n);
        cw_status st = cw_render_mesh(&mesh, &desc, &image, &err);
        if (st == CW_OK)
            st = cw_image_write(test_path("a.png"), &image, &err);
        failed = cwi_alloc_fail_after(-1);
        assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
        assert_int_equal(test_folder_entries(), failed ? 0 : 1);
        cw_image_free(&image);
    }
    cw_mesh_free(&mesh);
}

/* Read by libpng's own simple reader; the pixels must come back to the bit. */
static void pngs_come_back_to_the_bit(void **state)
{
    (void)state;
    cw_error err = {0};
    for (int alpha = 255; alpha >= 128; alpha -= 127) {
        cw_image image;
        assert_ok(cw_image_alloc(&image, 57, 31, &err), err);
        for (size_t i = 0; i < 57 * 31; i++) {
            const uint8_t rgba[4] = {(uint8_t)(i * 7), (uint8_t)(i >> 3), (uint8_t)(i * i),
                                     (uint8_t)(i % 2 ? 255 : alpha)};
            memcpy(image.pixels + 4 * i, rgba, 4);
        }
        assert_ok(cw_image_write(test_path("a.png"), &image, &err), err);
        png_image png = {.version = PNG_IMAGE_VERSION};
        assert_true(png_image_begin_read_from_file(&png, test_path("a.png")));
        assert_int_equal(png.width, 57);
        assert_int_equal(png.height, 31);
        assert_int_equal(png.format, alpha == 255 ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA);
        png.format = PNG_FORMAT_RGBA;
        uint8_t *back = malloc(PNG_IMAGE_SIZE(png));
        assert_non_null(back);
        assert_true(png_image_finish_read(&png, NULL, back, 0, NULL));
        assert_memory_equal(back, image.pixels, 4 * 57 * 31);
        free(back);
        cw_image_free(&image);
    }
    const cw_image nothing = {0};
    assert_fails(cw_image_write(test_path("b.png"), &nothing, &err), CW_ERR_ARGUMENT,
                 "b.png: there is no picture", err);
    assert_int_equal(test_folder_entries(), 1);
}

#define CASE(test) cmocka_unit_test_setup_teardown(test, test_folder_make, test_folder_remove)

int main(void)
{
    const struct CMUnitTest tests[] = {
        CASE(a_sphere_fills_pi_quarters_of_its_square),
        CASE(the_middle_of_a_sphere_is_brighter_than_its_rim),
        CASE(any_number_of_threads_gives_the_same_bytes),
        CASE(views_show_the_patient_unmirrored),
        CASE(a_hole_is_seen_where_it_is),
        CASE(every_sample_belongs_to_one_triangle),
        CASE(the_nearer_surface_hides_the_other),
        CASE(an_inside_out_surface_is_red),
        CASE(from_inside_a_sphere_there_is_no_gap),
        CASE(what_is_behind_the_eye_is_not_drawn),
        CASE(a_fitted_box_touches_the_margin_and_no_more),
        CASE(shares_are_right_in_perspective),
        CASE(without_normals_faces_are_flat),
        CASE(an_empty_mesh_gives_the_background),
        CASE(mistakes_are_named),
        CASE(drawing_can_be_cancelled),
        CASE(running_out_of_memory_is_an_error),
        CASE(pngs_come_back_to_the_bit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
