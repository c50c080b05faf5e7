/* Makes cameras around test volumes, and draws scenes by ray casting in fine steps for
 * comparison. */
#include "support/views.h"

#include <math.h>

cw_camera test_view(double yaw_deg, double pitch_deg, double fov_deg, double size_mm)
{
    const double degree = acos(-1) / 180;
    const double yaw = yaw_deg * degree, pitch = pitch_deg * degree;
    const double away = fov_deg > 0 ? size_mm / 2 / tan(fov_deg * degree / 2) : 2 * size_mm;
    return (cw_camera){
        .eye = {away * cos(pitch) * sin(yaw), -away * cos(pitch) * cos(yaw), away * sin(pitch)},
        .up = {0, 0, 1},
        .fov_deg = fov_deg,
        .height_mm = fov_deg > 0 ? 0 : size_mm};
}

cw_picture test_truth(cw_renderer *renderer, const cw_scene *scene)
{
    cw_scene fine = *scene;
    fine.mode = CW_MODE_COMPOSITE;
    fine.sampling.step_vox = 0.1;
    fine.sampling.stop_opacity = 1;
    fine.sampling.no_preintegration = true; /* its table would be made again each time */
    fine.sampling.no_skipping = true;
    return test_draw(renderer, &fine);
}

test_gap test_error(cw_renderer *renderer, const cw_scene *scene)
{
    cw_picture truth = test_truth(renderer, scene), drawn = test_draw(renderer, scene);
    const test_gap gap = test_compare(&drawn, &truth);
    cw_picture_free(&truth);
    cw_picture_free(&drawn);
    return gap;
}
