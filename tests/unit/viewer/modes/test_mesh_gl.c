/* Tests meshes drawn by OpenGL against the CPU: blending, edges, scalars, and the shape of
 * triangles. */
#include "support/sheets.h"

#include "viewer/scene/mesh_tint.h"
#include <cubewright/render.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 96 };

/* Every pixel that both cover is the same to rounding; coverage differs at most at outlines. */
static void check_against_cpu(const cw_mesh *mesh, const cw_camera *camera)
{
    cw_renderer *r = test_renderer();
    cw_error err = {0};
    cw_image truth;
    const cw_render_mesh_desc desc = {.camera = *camera,
                                      .width = SIDE,
                                      .height = SIDE,
                                      .samples = 1,
                                      .color = {230, 222, 209, 255},
                                      .background = {{9, 9, 9, 0}, {9, 9, 9, 0}}};
    const cw_scene scene = {.mode = CW_MODE_MESH,
                            .mesh = mesh,
                            .camera = *camera,
                            .width = SIDE,
                            .height = SIDE,
                            .mesh_look.color = {230 / 255.f, 222 / 255.f, 209 / 255.f, 1}};
    assert_ok(cw_render_mesh(mesh, &desc, &truth, &err), err);
    cw_renderer_forget(r);
    cw_picture drawn = test_draw(r, &scene);
    double sum = 0, max = 0;
    size_t both = 0, one = 0;
    for (size_t p = 0; p < (size_t)SIDE * SIDE; p++) {
        const float *a = drawn.pixels + 4 * p;
        const uint8_t *b = truth.pixels + 4 * p;
        one += (a[3] > 0) != (b[3] > 0);
        if (!(a[3] > 0 && b[3] > 0))
            continue;
        both++;
        for (int c = 0; c < 3; c++) {
            const double d = 255 * (double)a[c] - b[c];
            sum += d * d;
            max = fmax(max, fabs(d));
        }
    }
    print_message("rmse %.4f, max %.3f over %zu pixels; %zu covered by one\n",
                  sqrt(sum / 3 / (double)both), max, both, one);
    assert_true(both > (size_t)SIDE * SIDE / 5);
    assert_true(one * 500 <= both);
    assert_true(sqrt(sum / 3 / (double)both) < 0.5);
    cw_picture_free(&drawn);
    cw_image_free(&truth);
}

static void looks_as_the_reference(void **state)
{
    (void)state;
    cw_mesh mesh;
    const cw_camera cameras[] = {
        {.eye = {30, -90, 40}, .target = {1, 2, 3}, .up = {0, 0, 1}, .fov_deg = 30},
        {.eye = {-90, 20, 10}, .up = {0, 0, 1}, .height_mm = 50}};
    for (int n = 0; n < 2; n++) {
        make_ball(&mesh, 20, (const double[3]){1, 2, 3});
        check_against_cpu(&mesh, &cameras[n]);
        free(mesh.normals); /* flat; and without a few triangles the inside is seen */
        mesh.normals = NULL;
        mesh.triangle_count = mesh.triangle_count * 5 / 9;
        check_against_cpu(&mesh, &cameras[n]);
        mesh.colors = calloc(mesh.vertex_count, 4);
        for (size_t v = 0; v < 4 * mesh.vertex_count; v++)
            mesh.colors[v] = v % 4 == 3 ? 255 : (uint8_t)(v * 7919 % 251);
        check_against_cpu(&mesh, &cameras[n]);
        cw_mesh_free(&mesh);
    }
}

/* An open ball is red inside, unless its inside is to look as its outside; by either backend. */
static void insides_may_look_as_outsides(void **state)
{
    (void)state;
    cw_renderer *renderers[2] = {test_renderer(), NULL};
    cw_mesh ball;
    cw_error err = {0};
    assert_ok(cw_renderer_new(CW_BACKEND_CPU, &renderers[1], &err), err);
    make_ball(&ball, 20, (const double[3]){0, 0, 0});
    ball.triangle_count = ball.triangle_count * 5 / 9;
    cw_renderer_forget(renderers[0]);
    for (int n = 0; n < 4; n++) {
        const bool same = n & 1;
        const cw_scene scene = {
            .mode = CW_MODE_MESH,
            .mesh = &ball,
            .camera = {.eye = {-90, 20, 60}, .up = {0, 0, 1}, .fov_deg = 30},
            .width = SIDE,
            .height = SIDE,
            .mesh_look.color = {0.8f, 0.8f, 0.8f, 1},
            .mesh_look.same_inside = same};
        cw_picture picture = test_draw(renderers[n / 2], &scene);
        size_t red = 0, grey = 0;
        for (size_t p = 0; p < (size_t)SIDE * SIDE; p++) {
            const float *c = picture.pixels + 4 * p;
            red += c[0] > 1.3f * c[2];
            grey += c[3] > 0 && fabsf(c[0] - c[2]) < 0.01f;
        }
        assert_true(grey > 300);
        assert_int_equal(red > 300, !same);
        cw_picture_free(&picture);
    }
    cw_renderer_free(renderers[1]);
    cw_mesh_free(&ball);
}

/* By either backend a scene looks the same, tints too; what the CPU does not draw it says. */
static void backends_agree(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer(), *cpu;
    cw_mesh ball;
    cw_error err = {0};
    assert_ok(cw_renderer_new(CW_BACKEND_CPU, &cpu, &err), err);
    make_ball(&ball, 20, (const double[3]){0, 0, 0});
    ball.scalars = calloc(ball.vertex_count, sizeof(float));
    for (size_t v = 0; v < ball.vertex_count; v++)
        ball.scalars[v] = ball.positions[3 * v + 2];
    cw_scene scene = {.mode = CW_MODE_MESH, .mesh = &ball, .width = SIDE, .height = SIDE};
    cw_renderer_forget(r);
    for (int n = 0; n < 2 * CW_TINT_COUNT; n++) {
        scene.mesh_look.tint = (cw_tint)(n / 2);
        scene.samples = n % 2 + 1;
        cw_picture a = test_draw(r, &scene), b = test_draw(cpu, &scene);
        assert_true(test_compare(&a, &b).rmse < 0.5);
        assert_true(pixel(&b, SIDE / 2, SIDE / 2)[3] == 1 && pixel(&b, 0, 0)[3] == 0);
        cw_picture_free(&a);
        cw_picture_free(&b);
    }
    cw_scene others[] = {scene, scene, scene, scene, scene, scene};
    others[0].mesh_look.wireframe = true;
    others[1].clip_count = 1;
    others[1].clips[0].normal[0] = 1;
    memcpy(others[2].mesh_look.color, (float[4]){1, 1, 1, 0.5f}, sizeof scene.mesh_look.color);
    others[3].depth_cue = 0.5f;
    others[4].material = flat;
    others[5].one_sided = true;
    for (size_t n = 0; n < 6; n++) {
        cw_picture picture;
        assert_fails(cw_render(cpu, &others[n], &picture, &err), CW_ERR_UNSUPPORTED, "the CPU",
                     err);
        assert_null(picture.pixels);
    }
    cw_renderer_free(cpu);
    cw_mesh_free(&ball);
}

/* Sheets at several depths, given in several orders, blend as the formula says. */
static void translucent_sheets_blend_in_any_order(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    static const uint8_t colors[3][4] = {
        {255, 0, 0, 102}, {0, 255, 0, 153}, {51, 102, 255, 204}};
    static const int orders[4][3] = {{0, 1, 2}, {2, 1, 0}, {1, 2, 0}, {0, 2, 1}};
    double expected[4] = {0};
    for (int c = 0; c < 4; c++) { /* from the nearest on */
        double left = 1;
        for (int s = 0; s < 3; s++) {
            const double alpha = colors[s][3] / 255.0;
            expected[c] += left * alpha * (c < 3 ? colors[s][c] / 255.0 : 1);
            left *= 1 - alpha;
        }
    }
    for (int n = 0; n < 4; n++) {
        cw_mesh mesh;
        make_arrays(&mesh, 12, 6);
        for (size_t k = 0; k < 3; k++)
            put_sheet(&mesh, k, (float)(10 * orders[n][k]), 5, colors[orders[n][k]]);
        const cw_scene scene = {.mode = CW_MODE_MESH,
                                .mesh = &mesh,
                                .camera = straight(20),
                                .width = 32,
                                .height = 32,
                                .material = flat};
        cw_renderer_forget(r);
        cw_picture picture = test_draw(r, &scene);
        for (int c = 0; c < 4; c++) {
            assert_near((double)pixel(&picture, 16, 16)[c], expected[c], 1e-5);
            assert_near((double)pixel(&picture, 2, 2)[c], 0, 0);
        }
        cw_picture_free(&picture);
        cw_mesh_free(&mesh);
    }
}

/* Sheets that cross: each half of the picture has the other in front. */
static void crossing_sheets_blend_pixel_by_pixel(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    cw_mesh mesh;
    static const uint8_t red[4] = {255, 0, 0, 128}, blue[4] = {0, 0, 255, 128};
    make_arrays(&mesh, 8, 4);
    put_sheet(&mesh, 0, 0, 5, red);
    put_sheet(&mesh, 1, 0, 5, blue);
    for (size_t v = 0; v < 8; v++)
        mesh.positions[3 * v + 1] = mesh.positions[3 * v] * (v < 4 ? 1.f : -1.f);
    const cw_scene scene = {.mode = CW_MODE_MESH,
                            .mesh = &mesh,
                            .camera = straight(10),
                            .width = 32,
                            .height = 32,
                            .material = flat};
    cw_renderer_forget(r);
    cw_picture picture = test_draw(r, &scene);
    const double a = 128 / 255.0;
    for (int side = 0; side < 2; side++) { /* left of the middle red is nearer */
        const float *at = pixel(&picture, side ? 28 : 4, 16);
        assert_near((double)at[side ? 2 : 0], a, 1e-5);
        assert_near((double)at[side ? 0 : 2], (1 - a) * a, 1e-5);
    }
    cw_picture_free(&picture);
    cw_mesh_free(&mesh);
}

/* A hundred sheets are peeled one by one. */
static void deep_stacks_are_peeled_to_the_end(void **state)
{
    (void)state;
    enum { COUNT = 100 };
    cw_renderer *r = test_renderer();
    cw_mesh mesh;
    static const uint8_t haze[4] = {255, 255, 255, 10};
    make_arrays(&mesh, 4 * COUNT, 2 * COUNT);
    for (size_t n = 0; n < COUNT; n++)
        put_sheet(&mesh, n, (float)(n * 37 % COUNT), 5, haze);
    cw_scene scene = {.mode = CW_MODE_MESH,
                      .mesh = &mesh,
                      .camera = straight(20),
                      .width = 16,
                      .height = 16,
                      .material = flat,
                      .sampling.stop_opacity = 1};
    cw_renderer_forget(r);
    cw_picture picture = test_draw(r, &scene);
    assert_near((double)pixel(&picture, 8, 8)[3], 1 - pow(1 - 10 / 255.0, COUNT), 1e-5);
    cw_picture_free(&picture);
    scene.sampling.stop_opacity = 0.9f; /* 58 layers are the first to reach it */
    picture = test_draw(r, &scene);
    assert_near((double)pixel(&picture, 8, 8)[3], 1 - pow(1 - 10 / 255.0, 58), 1e-5);
    cw_picture_free(&picture);
    cw_mesh_free(&mesh);
}

/* With a part of the mesh behind it, too, an eye sees what is nearest before it. */
static void an_eye_may_be_among_what_it_sees(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    static const uint8_t colors[3][4] = {{0, 255, 0, 255}, {255, 0, 0, 255}, {0, 0, 255, 255}};
    static const int orders[2][3] = {{10, 0, -50}, {0, 10, -50}}; /* along the line of sight */
    for (int n = 0; n < 2; n++) {
        cw_mesh mesh;
        make_arrays(&mesh, 12, 6);
        for (size_t s = 0; s < 3; s++)
            put_sheet(&mesh, s, (float)orders[n][s], 20,
                      colors[s == 2 ? 2 : orders[n][s] == 0]);
        const cw_scene scene = {.mode = CW_MODE_MESH,
                                .mesh = &mesh,
                                .camera = {.eye = {0, -20, 0}, .up = {0, 0, 1}, .fov_deg = 40},
                                .width = 16,
                                .height = 16,
                                .material = flat};
        cw_renderer_forget(r);
        cw_picture picture = test_draw(r, &scene);
        for (size_t x = 4; x < 12; x++) {
            assert_near((double)pixel(&picture, x, 8)[0], 1, 1e-3);
            assert_near((double)pixel(&picture, x, 8)[1], 0, 1e-3);
        }
        cw_picture_free(&picture);
        cw_mesh_free(&mesh);
    }
}

/* Each triangle draws its half of an edge: 0.6 pixels, of any sample count, at any distance. */
static void edges_are_as_wide_as_said(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    static const uint8_t white[4] = {255, 255, 255, 255};
    for (int n = 0; n < 4; n++) {
        cw_mesh mesh;
        make_arrays(&mesh, 4, 2);
        put_sheet(&mesh, 0, n < 2 ? 0 : 200, 5, white);
        const cw_scene scene = {
            .mode = CW_MODE_MESH,
            .mesh = &mesh,
            .camera = {.eye = {0, -50, 0},
                       .up = {0, 0, 1},
                       .fov_deg = 360 / PI * atan(8 / (n < 2 ? 50.0 : 250.0))},
            .width = 64,
            .height = 64,
            .samples = n % 2 ? 3 : 1,
            .material = flat,
            .mesh_look.wireframe = true};
        cw_renderer_forget(r);
        cw_picture picture = test_draw(r, &scene);
        double width = 0, diagonal = 0;
        const double drop = 1 - 0.08;     /* of red, from the sheet to the line */
        for (size_t x = 0; x < 20; x++) { /* across the left edge, clear of the diagonal */
            const float *at = pixel(&picture, x, 24);
            if (at[3] > 0)
                width += ((double)at[3] - (double)at[0]) / drop;
        }
        for (size_t x = 22; x < 42; x++)
            diagonal += (1 - (double)pixel(&picture, x, 32)[0]) / drop;
        assert_near(width, 0.6, 0.02); /* the outline is between samples */
        assert_near(diagonal, 1.2 * sqrt(2), 0.12);
        cw_picture_free(&picture);
        cw_mesh_free(&mesh);
    }
}

/* The colour of one value, and none where there is none. */
static void scalars_are_shown_by_the_ramp(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    cw_mesh mesh;
    static const uint8_t any[4] = {1, 2, 3, 255};
    make_arrays(&mesh, 4, 2);
    put_sheet(&mesh, 0, 0, 5, any);
    mesh.scalars = calloc(4, sizeof(float));
    for (int n = 0; n < 6; n++) {
        const float value = (float)(n == 5 ? NAN : 10 + 2.5 * n);
        double expected[3] = {0};
        for (int v = 0; v < 4; v++)
            mesh.scalars[v] = value;
        const cw_scene scene = {.mode = CW_MODE_MESH,
                                .mesh = &mesh,
                                .camera = straight(8),
                                .width = 8,
                                .height = 8,
                                .mesh_look.tint = CW_TINT_SCALARS,
                                .mesh_look.tint_low = 10,
                                .mesh_look.tint_high = 20,
                                .material = flat};
        cw_renderer_forget(r);
        cw_picture picture = test_draw(r, &scene);
        cwi_ramp_color(n / 4.0, expected);
        for (int c = 0; c < 3; c++) {
            const double shown = (double)pixel(&picture, 4, 4)[c];
            if (n == 5)
                assert_near(shown, (double)pixel(&picture, 4, 4)[0], 1e-6);
            else
                assert_near(shown, expected[c], 2e-3);
        }
        cw_picture_free(&picture);
    }
    cw_error err = {0};
    cw_picture picture;
    cw_scene scene = {.mode = CW_MODE_MESH, .mesh = &mesh, .mesh_look.tint = CW_TINT_SCALARS};
    scene.mesh_look.tint_low = 2;
    scene.mesh_look.tint_high = 1;
    assert_fails(cw_render(r, &scene, &picture, &err), CW_ERR_ARGUMENT, "2 to 1", err);
    free(mesh.scalars);
    mesh.scalars = NULL;
    assert_fails(cw_render(r, &scene, &picture, &err), CW_ERR_ARGUMENT, "no scalars", err);
    cw_mesh_free(&mesh);
}

/* A mesh of nothing is drawn as nothing, and then another as itself. */
static void empty_meshes_are_no_trouble(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    cw_error err = {0};
    cw_mesh cube;
    const cw_mesh nothing = {0};
    test_make_cube(&cube);
    cw_scene scene = {.mode = CW_MODE_MESH,
                      .width = 16,
                      .height = 16,
                      .clips = {{{1, 0, 0}, 0.5}},
                      .clip_count = 1,
                      .mesh_look.cap = true,
                      .mesh_look.wireframe = true};
    for (int n = 0; n < 4; n++) {
        scene.mesh = n % 2 ? &cube : &nothing;
        scene.mesh_look.color[0] = scene.mesh_look.color[3] = n < 2 ? 1 : 0.5f;
        cw_picture picture = test_draw(r, &scene);
        float most = 0;
        for (size_t p = 0; p < 4 * 16 * 16; p++)
            most = fmaxf(most, picture.pixels[p]);
        assert_true(n % 2 ? most > 0.3f : most == 0);
        cw_picture_free(&picture);
    }
    cw_picture picture;
    scene.mesh_look.color[0] = 2;
    assert_fails(cw_render(r, &scene, &picture, &err), CW_ERR_ARGUMENT,
                 "mesh_look.color[0] is 2", err);
    scene.mesh_look.color[0] = 1;
    scene.mesh_look.tint = CW_TINT_COUNT;
    assert_fails(cw_render(r, &scene, &picture, &err), CW_ERR_ARGUMENT, "tint", err);
    cw_mesh_free(&cube);
}

static double lightness(const double srgb[3])
{
    static const double weight[3] = {0.2126, 0.7152, 0.0722};
    double y = 0;
    for (int c = 0; c < 3; c++)
        y += weight[c] *
             (srgb[c] <= 0.04045 ? srgb[c] / 12.92 : pow((srgb[c] + 0.055) / 1.055, 2.4));
    return 116 * cbrt(y) - 16;
}

/* Equal steps are equally lighter, and no colour is cut off at the gamut. */
static void ramp_is_perceptually_even(void **state)
{
    (void)state;
    for (int n = 0; n <= 100; n++) {
        double c[3];
        cwi_ramp_color(n / 100.0, c);
        assert_near(lightness(c), 18 + 0.74 * n, 0.3);
        for (int a = 0; a < 3; a++)
            assert_true(c[a] > 0 && c[a] < 1);
    }
}

/* An equilateral triangle and a right one look different. */
static void shape_of_triangles_is_shown(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    cw_mesh mesh;
    double expected[2][3];
    make_arrays(&mesh, 6, 2);
    for (uint32_t n = 0; n < 6; n++)
        mesh.triangles[n] = n;
    static const float corners[6][2] = {{-9, -4}, {-1, -4}, {-5, 2.9282032f},
                                        {1, -4},  {9, -4},  {1, 4}};
    for (size_t v = 0; v < 6; v++) {
        mesh.positions[3 * v] = corners[v][0];
        mesh.positions[3 * v + 2] = corners[v][1];
    }
    assert_near(cwi_triangle_shape(&mesh, 0), 1, 1e-6);
    assert_near(cwi_triangle_shape(&mesh, 1), sqrt(3) / 2, 1e-6);
    const cw_scene scene = {.mode = CW_MODE_MESH,
                            .mesh = &mesh,
                            .camera = straight(20),
                            .width = 40,
                            .height = 40,
                            .mesh_look.tint = CW_TINT_QUALITY,
                            .material = flat};
    cw_renderer_forget(r);
    cw_picture picture = test_draw(r, &scene);
    cwi_ramp_color(1, expected[0]);
    cwi_ramp_color(sqrt(3) / 2, expected[1]);
    for (int c = 0; c < 3; c++) {
        assert_near((double)pixel(&picture, 10, 24)[c], expected[0][c], 2e-3);
        assert_near((double)pixel(&picture, 25, 24)[c], expected[1][c], 2e-3);
    }
    cw_picture_free(&picture);
    cw_mesh_free(&mesh);
}

/* The share of the background in what is farthest is the depth cue. */
static void depth_fades_into_the_background(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    cw_mesh mesh;
    static const uint8_t white[4] = {255, 255, 255, 255};
    make_arrays(&mesh, 8, 4);
    put_sheet(&mesh, 0, 100, 9, white);
    put_sheet(&mesh, 1, 0, 3, white);
    static const struct {
        double range[2], near, far; /* shares of the background */
        cw_cue_form form;
    } cases[] = {{{0, 0}, 0, 0.7, CW_CUE_LINEAR},
                 {{0, 2}, 0, 0.35, CW_CUE_LINEAR},
                 {{-1, 0.5}, 0.7 * 2 / 3, 0.7, CW_CUE_LINEAR},
                 {{0, 0}, 0, 0.7, CW_CUE_EXPONENTIAL},
                 {{0, 0.5}, 0, 0.91, CW_CUE_EXPONENTIAL},
                 {{-1, 0}, 0.7, 0.91, CW_CUE_EXPONENTIAL}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        const cw_scene scene = {.mode = CW_MODE_MESH,
                                .mesh = &mesh,
                                .camera = straight(20),
                                .width = 40,
                                .height = 40,
                                .background = {{0.2f, 0.4f, 0.6f}, {0.2f, 0.4f, 0.6f}},
                                .depth_cue = 0.7f,
                                .cue_range = {cases[n].range[0], cases[n].range[1]},
                                .cue_form = cases[n].form,
                                .material = flat};
        cw_renderer_forget(r);
        cw_picture picture = test_draw(r, &scene);
        for (int c = 0; c < 3; c++) {
            const double other = 1 - 0.2 * (c + 1);
            assert_near((double)pixel(&picture, 20, 20)[c], 1 - cases[n].near * other, 3e-3);
            assert_near((double)pixel(&picture, 4, 20)[c], 1 - cases[n].far * other, 3e-3);
        }
        cw_picture_free(&picture);
    }
    cw_mesh_free(&mesh);
}

/* A ball lit on one side is dark in a light from behind, and seen from inside, through a cut, in
 * one from the eye. */
static void one_sided_meshes_are_lit_from_outside(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    cw_mesh ball;
    make_ball(&ball, 8, (const double[3]){0, 0, 0});
    cw_renderer_forget(r);
    for (int n = 0; n < 8; n++) {
        const bool one_sided = n & 1, is_behind = n & 2, is_cut = n & 4;
        cw_scene scene = {.mode = CW_MODE_MESH,
                          .mesh = &ball,
                          .camera = straight(20),
                          .width = 40,
                          .height = 40,
                          .one_sided = one_sided,
                          .mesh_look.color = {1, 1, 1, 1},
                          .material = {.diffuse = 0.8f, .shininess = 1},
                          .light_count = 1,
                          .lights = {{{0, 0, is_behind ? -1 : 1}, {1, 1, 1}}}};
        cw_camera *c = &scene.camera;
        for (int a = 0; a < 3; a++)
            scene.clips[0].normal[a] = c->target[a] - c->eye[a];
        scene.clip_count = is_cut;
        cw_picture picture = test_draw(r, &scene);
        const bool is_lit = !one_sided || is_behind == is_cut;
        assert_near((double)pixel(&picture, 20, 20)[3], 1, 1e-6);
        assert_int_equal(pixel(&picture, 20, 20)[2] > 0.05f, is_lit); /* red inside */
        cw_picture_free(&picture);
    }
    cw_mesh_free(&ball);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(looks_as_the_reference),
        cmocka_unit_test(insides_may_look_as_outsides),
        cmocka_unit_test(backends_agree),
        cmocka_unit_test(translucent_sheets_blend_in_any_order),
        cmocka_unit_test(crossing_sheets_blend_pixel_by_pixel),
        cmocka_unit_test(deep_stacks_are_peeled_to_the_end),
        cmocka_unit_test(an_eye_may_be_among_what_it_sees),
        cmocka_unit_test(edges_are_as_wide_as_said),
        cmocka_unit_test(scalars_are_shown_by_the_ramp),
        cmocka_unit_test(empty_meshes_are_no_trouble),
        cmocka_unit_test(ramp_is_perceptually_even),
        cmocka_unit_test(shape_of_triangles_is_shown),
        cmocka_unit_test(depth_fades_into_the_background),
        cmocka_unit_test(one_sided_meshes_are_lit_from_outside),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_close);
}
