/* Tests the light on faces that clip planes cut: of a solid without any gradient, on paper. */
#include "support/pictures.h"

#include <math.h>

enum { SIDE = 40, PIXELS = 8 };

static const double cube[3] = {1, 1, 1};

/* Returns the share of white light that leaves a solid through a face: a face reflects diffuse
 * light within a millimetre, fading up to two. slope: of the ray to the face's normal. */
static double light_of_face(double extinction, double slope, double depth)
{
    const double step = 1e-3, facing = 0.75 * fabs(slope);
    double light = 0;
    for (double t = step / 2; t < depth; t += step) {
        const double away = t * fabs(slope);
        const double share = away < 1 ? 1 : away < 2 ? 2 - away : 0;
        light += (0.25 + share * facing) * exp(-extinction * (t - step / 2)) *
                 (1 - exp(-extinction * step));
    }
    return light;
}

/* A plane through the middle, square to the view or turned by 40 degrees; what is behind it is
 * kept, or what a half-space leaves is drawn; on even and on rectilinear grids. */
static void faces_are_lit_by_their_plane(void **state)
{
    (void)state;
    static const cw_mode modes[] = {CW_MODE_REFERENCE, CW_MODE_VBUFFER,
                                    CW_MODE_COMPOSITE, CW_MODE_PROJECTION,
                                    CW_MODE_TEXTURE,   CW_MODE_SHADED_TEXTURE};
    static const double bounds[] = {1e-4, 2e-3, 2e-3, 2e-2, 2e-3, 5e-3};
    const cw_transfer half = {
        .opacity_count = 2, .opacities = {{-9, 0.5f}, {9, 0.5f}}, .unit_mm = 1};
    cw_volume box = {0};
    cw_renderer *r;
    cw_error err = {0};
    double coordinates[SIDE];
    (void)test_renderer(); /* skips without OpenGL */
    assert_ok(cw_renderer_new(CW_BACKEND_AUTO, &r, &err), err);
    test_field(&box, SIDE, SIDE, SIDE, cube, test_constant);
    for (int n = 0; n < SIDE; n++)
        coordinates[n] = n;
    for (int n = 0; n < 8; n++) {
        for (int a = 0; a < 3; a++)
            box.coordinates[a] = n & 4 ? coordinates : NULL;
        const double angle = n & 1 ? 40 * PI / 180 : 0;
        const double sign = n & 2 ? -1 : 1;
        cw_scene scene = {.volume = &box,
                          .transfer = &half,
                          .camera = {.eye = {0, -500, 0}, .up = {0, 0, 1}, .height_mm = 4},
                          .width = PIXELS,
                          .height = PIXELS,
                          .lit = true,
                          .sampling.step_vox = 0.1,
                          .clips = {{{sign * sin(angle), sign * cos(angle), 0}, 0}},
                          .clip_count = 1,
                          .cut_away = n & 2};
        for (int m = 0; m < 6; m++) {
            scene.mode = modes[m];
            if (!cw_mode_draws(modes[m], &box))
                continue;
            cw_picture picture = test_draw(r, &scene);
            for (size_t p = 0; p < PIXELS * PIXELS; p++) {
                const double x = ((double)(p % PIXELS) + 0.5) * 4 / PIXELS - 2;
                const double depth = SIDE / 2.0 - 0.5 + x * tan(angle);
                const double light = light_of_face(-log(0.5), cos(angle), depth);
                for (size_t c = 0; c < 3; c++)
                    if (fabs((double)picture.pixels[4 * p + c] - light) > bounds[m])
                        fail_msg("%s, %d: %g, not %g", cw_mode_name(scene.mode), n,
                                 (double)picture.pixels[4 * p + c], light);
            }
            cw_picture_free(&picture);
        }
    }
    for (int a = 0; a < 3; a++)
        box.coordinates[a] = NULL;
    cw_volume_free(&box);
    cw_renderer_free(r);
}

/* A plane that is farther than two units from all that is seen changes nothing. */
static void light_beyond_two_units_stays(void **state)
{
    (void)state;
    cw_volume blobs = {0};
    const cw_transfer soft = test_soft_transfer();
    cw_renderer *r = test_renderer();
    test_field(&blobs, 30, 30, 30, cube, test_blobs);
    cw_scene scene = {.mode = CW_MODE_COMPOSITE,
                      .volume = &blobs,
                      .transfer = &soft,
                      .width = 32,
                      .height = 32,
                      .lit = true};
    cw_picture plain = test_draw(r, &scene);
    scene.clip_count = 1;
    scene.clips[0] = (cw_clip){{0, 1, 0}, -17}; /* 2.5 mm before the first voxels */
    cw_picture clipped = test_draw(r, &scene);
    assert_true(test_compare(&plain, &clipped).max < 1e-3);
    cw_picture_free(&plain);
    cw_picture_free(&clipped);
    cw_volume_free(&blobs);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(faces_are_lit_by_their_plane),
                                       cmocka_unit_test(light_beyond_two_units_stays)};
    return cmocka_run_group_tests(tests, NULL, test_renderer_close);
}
