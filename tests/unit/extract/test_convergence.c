/* Tests that ray casting converges to the reference with the square of its step. */
#include "support/pictures.h"

#include <math.h>

/* The root mean square error of ray casting with a step, in 1/255. */
static double error_of(cw_scene scene, const cw_picture *truth, double step)
{
    static const float black[2][3];
    cw_error err = {0};
    cw_comparison gap;
    scene.mode = CW_MODE_COMPOSITE;
    scene.sampling.step_vox = step;
    cw_picture picture = test_draw(test_renderer(), &scene);
    assert_ok(cw_picture_compare(&picture, truth, black, &gap, &err), err);
    cw_picture_free(&picture);
    return gap.rmse;
}

/* Ray casting nears the reference with the square of its step, with and without
 * pre-integration. */
static void ray_casting_converges_to_the_reference(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_renderer *cpu;
    cw_volume blobs = {0};
    const cw_transfer soft = test_soft_transfer(), tent = test_tent_transfer();
    test_renderer(); /* or the test is skipped */
    assert_ok(cw_renderer_new(CW_BACKEND_CPU, &cpu, &err), err);
    test_field(&blobs, 128, 128, 128, (const double[3]){1, 1, 1}, test_blobs);
    for (int sharp = 0; sharp < 2; sharp++) {
        cw_scene scene = {.mode = CW_MODE_REFERENCE,
                          .volume = &blobs,
                          .transfer = sharp ? &tent : &soft,
                          .width = 96,
                          .height = 96,
                          .sampling.stop_opacity = 1,
                          .sampling.no_preintegration = !sharp};
        cw_picture truth = test_draw(cpu, &scene);
        const double coarse = error_of(scene, &truth, 1), fine = error_of(scene, &truth, 0.25);
        const double order = log2(coarse / fine) / 2;
        if (order < 1.8 || coarse > (sharp ? 0.6 : 0.05))
            fail_msg("rmse %g at a step of 1, order %g", coarse, order);
        cw_picture_free(&truth);
    }
    cw_volume_free(&blobs);
    cw_renderer_free(cpu);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ray_casting_converges_to_the_reference),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_close);
}
