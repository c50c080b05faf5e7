/* Tests meshes cut by planes: caps, hollows, and a mesh in a volume. */
#include "support/sheets.h"

enum { SIDE = 96 };

static cw_scene cut_ball(const cw_mesh *ball)
{
    return (cw_scene){.mode = CW_MODE_MESH,
                      .mesh = ball,
                      .camera = straight(50),
                      .width = SIDE,
                      .height = SIDE,
                      .clips = {{{0, 1, 0}, 0}},
                      .clip_count = 1,
                      .mesh_look.color = {0.5f, 0.5f, 0.5f, 1},
                      .material = flat,
                      .mesh_look.cap = true};
}

/* The front half of a ball is cut away: a disc is seen, of one colour, not the ball's red
 * inside; and what the disc covers is what the ball's outline is. */
static void cap_closes_a_cut_ball(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    cw_mesh ball;
    make_ball(&ball, 20, (const double[3]){0, 0, 0});
    cw_scene scene = cut_ball(&ball);
    cw_renderer_forget(r);
    cw_picture capped = test_draw(r, &scene);
    scene.mesh_look.cap = false;
    cw_picture open = test_draw(r, &scene);
    scene.mesh_look.color[3] = 0.5f;
    scene.mesh_look.cap = true;
    cw_picture clear = test_draw(r, &scene);
    size_t covered = 0;
    for (size_t p = 0; p < (size_t)SIDE * SIDE; p++) {
        const float *c = capped.pixels + 4 * p, *o = open.pixels + 4 * p;
        assert_true(c[3] == o[3]);
        if (!(c[3] > 0))
            continue;
        covered++;
        assert_true(o[0] > 1.5f * o[1]); /* the red inside */
        assert_true(c[1] > 0.8f * c[0]); /* the cap */
        assert_near((double)c[0], (double)pixel(&capped, SIDE / 2, SIDE / 2)[0], 1e-6);
        assert_near((double)clear.pixels[4 * p + 3], 0.75, 1e-6); /* cap and back: two layers */
    }
    const double radius = 20.0 * SIDE / 50;
    assert_within((double)covered, PI * radius * radius, 0.01);
    cw_picture_free(&capped);
    cw_picture_free(&open);
    cw_picture_free(&clear);
    cw_mesh_free(&ball);
}

/* Of a hollow ball the cut is a ring; of one that is inside out the same as of the
 * right one. */
static void caps_leave_hollows_open(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    for (int turned = 0; turned < 2; turned++) {
        cw_mesh ball, both;
        make_ball(&ball, 20, (const double[3]){0, 0, 0});
        const size_t vertices = ball.vertex_count, triangles = ball.triangle_count;
        make_arrays(&both, 2 * vertices, 2 * triangles);
        free(both.colors);
        both.colors = NULL;
        for (size_t n = 0; n < 6 * vertices; n++)
            both.positions[n] =
                ball.positions[n % (3 * vertices)] * (n < 3 * vertices ? 1 : 0.5f);
        for (size_t n = 0; n < 6 * triangles; n++) { /* the inner one is turned */
            const bool turn = (n >= 3 * triangles) != turned;
            const size_t from = turn ? n / 3 * 3 + 2 - n % 3 : n;
            both.triangles[n] = ball.triangles[from % (3 * triangles)] +
                                (uint32_t)(n < 3 * triangles ? 0 : vertices);
        }
        cw_scene scene = cut_ball(&both);
        cw_renderer_forget(r);
        cw_picture with = test_draw(r, &scene);
        scene.mesh_look.cap = false;
        cw_picture without = test_draw(r, &scene);
        size_t filled = 0;
        for (size_t p = 0; p < (size_t)SIDE * SIDE; p++)
            filled += fabsf(with.pixels[4 * p + 2] - without.pixels[4 * p + 2]) > 0.02f;
        const double scale = SIDE / 50.0;
        assert_within((double)filled, PI * (400 - 100) * scale * scale, 0.02);
        cw_picture_free(&with);
        cw_picture_free(&without);
        cw_mesh_free(&ball);
        cw_mesh_free(&both);
    }
}

/* A wedge is cut out by two planes: both cuts are closed, seen from any side no
 * inside shows. */
static void caps_close_what_is_cut_away(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    cw_mesh ball;
    make_ball(&ball, 20, (const double[3]){3, 1, -2});
    cw_scene scene = cut_ball(&ball);
    scene.clips[0] = (cw_clip){{0.2, -1, 0}, -1};
    scene.clips[1] = (cw_clip){{1, 0, 0.3}, 2};
    scene.clip_count = 2;
    cw_renderer_forget(r);
    for (int n = 0; n < 8; n++) {
        const double a = n * PI / 4;
        scene.cut_away = n % 2;
        scene.camera = (cw_camera){.eye = {90 * sin(a), -90 * cos(a), 30},
                                   .up = {0, 0, 1},
                                   .fov_deg = n < 4 ? 35 : 0,
                                   .height_mm = 60};
        cw_picture picture = test_draw(r, &scene);
        size_t covered = 0, inside = 0;
        for (size_t p = 0; p < (size_t)SIDE * SIDE; p++) {
            const float *c = picture.pixels + 4 * p;
            covered += c[3] > 0;
            inside += c[1] < 0.8f * c[0];
        }
        assert_true(covered > SIDE * SIDE / 20);
        assert_true(inside <= 1); /* at an outline the two sides may change places */
        cw_picture_free(&picture);
    }
    cw_mesh_free(&ball);
}

/* A ball in, before and behind a box of fog: what is seen of the fog ends at the ball. */
static void mesh_stands_in_a_volume(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    cw_volume box = {0};
    const cw_transfer fog = test_flat_transfer();
    test_field(&box, 33, 33, 33, (const double[3]){1, 1, 1}, test_constant);
    cw_mesh ball;
    make_ball(&ball, 6, (const double[3]){0, 0, 0});
    cw_renderer_forget(r);
    for (int n = 0; n < 6; n++) {
        const double y[3] = {-30, 0, 30};
        ball.origin[1] = y[n % 3];
        const cw_scene scene = {.mode = CW_MODE_COMPOSITE,
                                .volume = &box,
                                .transfer = &fog,
                                .mesh = &ball,
                                .camera = {.eye = {0, -200, 0},
                                           .up = {0, 0, 1},
                                           .fov_deg = n < 3 ? 0 : 5,
                                           .height_mm = 20},
                                .width = SIDE,
                                .height = SIDE,
                                .mesh_look.color = {1, 0, 0, 1},
                                .material = flat};
        cw_picture picture = test_draw(r, &scene);
        for (size_t x = 3; x < SIDE; x += 9) {
            const double fov = tan(5 * PI / 360) * 200, u = ((double)x + 0.5) / SIDE * 2 - 1,
                         v = 0.5 / SIDE * 2;
            const double side = (n < 3 ? 10 : fov) * u, up = (n < 3 ? 10 : fov) * v;
            /* along the ray to the plane y = 0, t from 0 to 1 */
            const double d[3] = {n < 3 ? 0 : side, 200, n < 3 ? 0 : -up};
            const double o[3] = {n < 3 ? side : 0, -200 - y[n % 3], n < 3 ? -up : 0};
            double b = 0, c = -36, q = 0;
            for (int a = 0; a < 3; a++)
                b += o[a] * d[a], c += o[a] * o[a], q += d[a] * d[a];
            const double root = b * b - q * c;
            if (fabs(root) < 3e4 * 6) /* the ball's outline has corners */
                continue;
            const double hit = root > 0 ? (-b - sqrt(root)) / q : 1e9;
            const double enter = (200.0 - 16) / 200, leave = (200.0 + 16) / 200;
            const double way = fmax(fmin(leave, hit) - enter, 0) * sqrt(q);
            const double through = pow(0.95, way);
            const float *at = pixel(&picture, x, SIDE / 2);
            assert_near((double)at[3], root > 0 ? 1 : 1 - through, 3e-3);
            assert_near((double)at[1], 0.6 * (1 - through), 3e-3);
            assert_near((double)at[0], 0.8 * (1 - through) + (root > 0 ? through : 0), 3e-3);
        }
        cw_picture_free(&picture);
    }
    cw_mesh_free(&ball);
    cw_volume_free(&box);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cap_closes_a_cut_ball),
        cmocka_unit_test(caps_leave_hollows_open),
        cmocka_unit_test(caps_close_what_is_cut_away),
        cmocka_unit_test(mesh_stands_in_a_volume),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_close);
}
