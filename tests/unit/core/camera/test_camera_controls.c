/* Tests camera controls: orbit, pan, roll, dolly, and the projection of points and pixels. */
#include "support/support.h"

#include <math.h>
#include <string.h>

enum { WIDTH = 160, HEIGHT = 120 };

static const cw_camera cameras[] = {
    {{40, -90, 30}, {1, 2, 3}, {0, 0, 1}, .fov_deg = 30},
    {{-20, 70, 55}, {0, 0, 0}, {0.3, -0.2, 1}, .fov_deg = 75},
    {{40, -90, 30}, {1, 2, 3}, {0, 0, 2}, .height_mm = 50},
};

enum { CAMERAS = sizeof cameras / sizeof *cameras };

static void project(const cw_camera *c, const double point[3], double pixel[2])
{
    assert_true(cw_camera_project(c, WIDTH, HEIGHT, point, pixel, NULL));
}

static double distance(const double a[3], const double b[3])
{
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

static void a_line_of_sight_shows_as_the_pixel_it_goes_through(void **state)
{
    (void)state;
    cw_error err = {0};
    for (size_t n = 0; n < CAMERAS; n++)
        for (int k = 0; k < 20; k++) {
            const double pixel[2] = {7.3 * k, 120 - 5.1 * k};
            double origin[3], direction[3], point[3], back[2], depth, axes[3][3];
            assert_ok(cw_camera_ray(&cameras[n], WIDTH, HEIGHT, pixel, origin, direction, &err),
                      err);
            assert_near(distance(direction, (double[3]){0}), 1, 1e-14);
            assert_ok(cw_camera_axes(&cameras[n], axes[0], axes[1], axes[2], &err), err);
            for (int a = 0; a < 3; a++)
                point[a] = origin[a] + (5 + k) * direction[a];
            assert_true(cw_camera_project(&cameras[n], WIDTH, HEIGHT, point, back, &depth));
            assert_near(back[0], pixel[0], 1e-9);
            assert_near(back[1], pixel[1], 1e-9);
            double along = 0;
            for (int a = 0; a < 3; a++)
                along += direction[a] * axes[2][a] * (5 + k);
            assert_near(depth, along, 1e-9);
        }
}

static void what_is_behind_the_eye_is_on_no_picture(void **state)
{
    (void)state;
    cw_error err = {0};
    const cw_camera *c = &cameras[0];
    double pixel[2], behind[3], depth, line[2][3];
    for (int a = 0; a < 3; a++)
        behind[a] = 2 * c->eye[a] - c->target[a];
    assert_false(cw_camera_project(c, WIDTH, HEIGHT, behind, pixel, NULL));
    assert_false(cw_camera_project(c, WIDTH, HEIGHT, c->eye, pixel, NULL));
    assert_true(cw_camera_project(&cameras[2], WIDTH, HEIGHT, behind, pixel, &depth));
    assert_true(depth < 0);
    assert_near(pixel[0], WIDTH / 2.0, 1e-9);
    assert_false(cw_camera_project(c, WIDTH, 0, c->target, pixel, NULL));
    assert_false(cw_camera_project(&(cw_camera){0}, 9, 9, c->target, pixel, NULL));
    assert_fails(cw_camera_ray(c, 0, 9, pixel, line[0], line[1], &err), CW_ERR_ARGUMENT,
                 "0 x 9", err);
    assert_fails(cw_camera_ray(&(cw_camera){0}, 9, 9, pixel, line[0], line[1], &err),
                 CW_ERR_ARGUMENT, "apart", err);
}

static cw_picture draw(const cw_scene *scene)
{
    cw_error err = {0};
    cw_renderer *renderer = NULL;
    cw_picture picture = {0};
    assert_ok(cw_renderer_new(CW_BACKEND_CPU, &renderer, &err), err);
    assert_ok(cw_render(renderer, scene, &picture, &err), err);
    cw_renderer_free(renderer);
    return picture;
}

/* The middle of what is drawn, each pixel weighing as much as it is bright. */
static void find_middle(const cw_picture *p, double middle[2])
{
    double sum = 0;
    middle[0] = middle[1] = 0;
    for (size_t y = 0; y < p->height; y++)
        for (size_t x = 0; x < p->width; x++) {
            const double weight = (double)p->pixels[4 * (y * p->width + x)];
            sum += weight;
            middle[0] += weight * ((double)x + 0.5);
            middle[1] += weight * ((double)y + 0.5);
        }
    assert_true(sum > 0);
    middle[0] /= sum;
    middle[1] /= sum;
}

static void assert_drawn_at(const cw_scene *scene, const double point[3])
{
    double pixel[2], middle[2];
    cw_picture picture = draw(scene);
    find_middle(&picture, middle);
    project(&scene->camera, point, pixel);
    assert_near(middle[0], pixel[0], 0.5);
    assert_near(middle[1], pixel[1], 0.5);
    cw_picture_free(&picture);
}

/* Off the middle, so that no sign can be wrong; a voxel's blob spans a few pixels. */
static void a_bright_voxel_is_drawn_where_it_is_projected(void **state)
{
    (void)state;
    uint8_t voxels[9 * 9 * 9] = {0};
    voxels[(6 * 9 + 2) * 9 + 7] = 200;
    const cw_volume v = {.data = voxels,
                         .dim = {9, 9, 9},
                         .affine = {{2, 0.3, 0, -8}, {0, 1.5, 0.2, -6}, {0, 0, 2, -7}}};
    const cw_transfer grey = {.color_count = 2,
                              .colors = {{0, {0, 0, 0}}, {200, {1, 1, 1}}},
                              .opacity_count = 1,
                              .opacities = {{0, 1}}};
    double point[3];
    cw_volume_to_world(&v, (const double[3]){7, 2, 6}, point);
    for (size_t n = 0; n < CAMERAS; n++) {
        const cw_scene scene = {.mode = CW_MODE_MIP,
                                .volume = &v,
                                .transfer = &grey,
                                .camera = cameras[n],
                                .width = WIDTH,
                                .height = HEIGHT};
        assert_drawn_at(&scene, point);
    }
}

static void a_small_triangle_is_drawn_where_it_is_projected(void **state)
{
    (void)state;
    float positions[9] = {-1, 0, -1, 1, 0, -1, 0, 0, 2};
    uint32_t triangle[3] = {0, 1, 2};
    const cw_mesh mesh = {.origin = {12, -3, 7},
                          .vertex_count = 3,
                          .triangle_count = 1,
                          .positions = positions,
                          .triangles = triangle};
    for (size_t n = 0; n < CAMERAS; n++) {
        const cw_scene scene = {.mode = CW_MODE_MESH,
                                .mesh = &mesh,
                                .camera = cameras[n],
                                .width = WIDTH,
                                .height = HEIGHT};
        assert_drawn_at(&scene, mesh.origin);
    }
}

static void what_is_as_far_as_the_target_follows_a_pan(void **state)
{
    (void)state;
    cw_error err = {0};
    for (size_t n = 0; n < CAMERAS; n++) {
        cw_camera c = cameras[n];
        double before[2], after[2], axes[3][3], point[3];
        assert_ok(cw_camera_axes(&c, axes[0], axes[1], axes[2], &err), err);
        for (int a = 0; a < 3; a++)
            point[a] = c.target[a] + 3 * axes[0][a] - 5 * axes[1][a];
        project(&c, point, before);
        assert_ok(cw_camera_pan(&c, HEIGHT, 17, -9.5, &err), err);
        project(&c, point, after);
        assert_near(after[0], before[0] + 17, 1e-9);
        assert_near(after[1], before[1] - 9.5, 1e-9);
        assert_near(distance(c.eye, c.target), distance(cameras[n].eye, cameras[n].target),
                    1e-9);
        assert_fails(cw_camera_pan(&c, 0, 1, 1, &err), CW_ERR_ARGUMENT, "no inside", err);
        assert_fails(cw_camera_pan(&c, 9, NAN, 1, &err), CW_ERR_ARGUMENT, "nan", err);
    }
}

static cw_camera fit(const char *view, double azimuth, double elevation)
{
    cw_error err = {0};
    cw_camera c;
    const cw_fit_desc d = {.view = view,
                           .min = {-10, -10, -10},
                           .max = {10, 12, 14},
                           .azimuth_deg = azimuth,
                           .elevation_deg = elevation};
    assert_ok(cw_camera_fit(&d, &c, &err), err);
    return c;
}

static void assert_looks_alike(const cw_camera *a, const cw_camera *b, double margin)
{
    cw_error err = {0};
    double p[3][3], q[3][3];
    assert_ok(cw_camera_axes(a, p[0], p[1], p[2], &err), err);
    assert_ok(cw_camera_axes(b, q[0], q[1], q[2], &err), err);
    for (int n = 0; n < 3; n++)
        assert_true(distance(p[n], q[n]) <= margin);
}

/* Orbits from a view are the fitted camera's angles, in as many moves as one likes; also from
 * straight above, and with the tilted up that a fitted camera has. */
static void orbits_keep_heads_up(void **state)
{
    (void)state;
    cw_error err = {0};
    const cw_camera expected = fit("front", 50, 35), above = fit("top", 0, 0),
                    behind = fit("back", 0, 40);
    cw_camera c = fit("front", 0, 0);
    for (int n = 0; n < 10; n++)
        assert_ok(cw_camera_orbit(&c, 5, 3.5, &err), err);
    assert_looks_alike(&c, &expected, 1e-12);
    c = fit("front", 20, 50);
    assert_ok(cw_camera_orbit(&c, 30, -15, &err), err);
    assert_looks_alike(&c, &expected, 1e-12);
    c = above;
    assert_ok(cw_camera_orbit(&c, 0, -50, &err), err);
    assert_looks_alike(&c, &behind, 1e-5);
    assert_near(distance(c.eye, c.target), distance(above.eye, above.target), 1e-9);
    assert_memory_equal(c.target, above.target, sizeof c.target);
}

/* Beyond the pole nothing flips, and one comes back the way one went. */
static void orbits_end_at_the_poles(void **state)
{
    (void)state;
    cw_error err = {0};
    const cw_camera start = fit("iso", 0, 0);
    for (int side = -1; side <= 1; side += 2) {
        double right[2][3], up[3], forward[3];
        cw_camera c = start;
        assert_ok(cw_camera_axes(&c, right[0], up, forward, &err), err);
        for (int n = 0; n < 3; n++)
            assert_ok(cw_camera_orbit(&c, 0, side * 100, &err), err);
        assert_ok(cw_camera_axes(&c, right[1], up, forward, &err), err);
        assert_near(forward[2], -side, 1e-9);
        assert_true(up[2] > 0);
        assert_true(distance(right[0], right[1]) < 1e-8);
    }
}

/* A camera with an axis of its own, or one that was rolled, turns about that. */
static void other_ups_are_kept(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_camera c = {{0, 10, -50}, {0, 0, 0}, {0, -1, 0}, .fov_deg = 30};
    double before = c.eye[1];
    for (int n = 0; n < 8; n++)
        assert_ok(cw_camera_orbit(&c, 33, 0, &err), err);
    assert_near(c.eye[1], before, 1e-9);
    assert_near(c.up[1], -1, 1e-12);
    c = fit("front", 0, 0);
    assert_ok(cw_camera_roll(&c, 90, &err), err);
    before = c.eye[0];
    assert_ok(cw_camera_orbit(&c, 33, 0, &err), err);
    assert_near(c.eye[0], before, 1e-9);
    assert_fails(cw_camera_orbit(&c, NAN, 0, &err), CW_ERR_ARGUMENT, "nan", err);
    assert_fails(cw_camera_orbit(&(cw_camera){0}, 1, 0, &err), CW_ERR_ARGUMENT, "apart", err);
}

static void rolls_turn_the_picture_clockwise(void **state)
{
    (void)state;
    cw_error err = {0};
    for (size_t n = 0; n < CAMERAS; n++) {
        cw_camera c = cameras[n];
        double before[2], after[2];
        const double point[3] = {4, 2, 1};
        project(&c, point, before);
        assert_ok(cw_camera_roll(&c, 90, &err), err);
        project(&c, point, after);
        assert_near(after[0] - WIDTH / 2.0, -(before[1] - HEIGHT / 2.0), 1e-9);
        assert_near(after[1] - HEIGHT / 2.0, before[0] - WIDTH / 2.0, 1e-9);
        assert_fails(cw_camera_roll(&c, INFINITY, &err), CW_ERR_ARGUMENT, "roll of inf", err);
    }
}

static void a_dolly_enlarges_what_is_at_the_target(void **state)
{
    (void)state;
    cw_error err = {0};
    for (size_t n = 0; n < CAMERAS; n++) {
        cw_camera c = cameras[n];
        double axes[3][3], point[3], before[2], after[2];
        assert_ok(cw_camera_axes(&c, axes[0], axes[1], axes[2], &err), err);
        for (int a = 0; a < 3; a++)
            point[a] = c.target[a] + 2 * axes[0][a];
        project(&c, point, before);
        assert_ok(cw_camera_dolly(&c, 1.7, &err), err);
        project(&c, point, after);
        assert_near(after[0] - WIDTH / 2.0, 1.7 * (before[0] - WIDTH / 2.0), 1e-9);
        assert_true(c.fov_deg == cameras[n].fov_deg);
        assert_fails(cw_camera_dolly(&c, 0, &err), CW_ERR_ARGUMENT, "above 0", err);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_line_of_sight_shows_as_the_pixel_it_goes_through),
        cmocka_unit_test(what_is_behind_the_eye_is_on_no_picture),
        cmocka_unit_test(a_bright_voxel_is_drawn_where_it_is_projected),
        cmocka_unit_test(a_small_triangle_is_drawn_where_it_is_projected),
        cmocka_unit_test(what_is_as_far_as_the_target_follows_a_pan),
        cmocka_unit_test(orbits_keep_heads_up),
        cmocka_unit_test(orbits_end_at_the_poles),
        cmocka_unit_test(other_ups_are_kept),
        cmocka_unit_test(rolls_turn_the_picture_clockwise),
        cmocka_unit_test(a_dolly_enlarges_what_is_at_the_target),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
