/* Cameras around test volumes, and the truth about a scene by fine steps of ray casting. */
#ifndef TESTS_VIEWS_H
#define TESTS_VIEWS_H

#include "support/pictures.h"

/* A camera that looks at the world's middle from an angle around z and one above the xy plane;
 * size is about what the picture covers, in mm. fov_deg 0: orthographic. */
cw_camera test_view(double yaw_deg, double pitch_deg, double fov_deg, double size_mm);

/* The same scene by ray casting in steps of 0.1, at their middles. */
cw_picture test_truth(cw_renderer *renderer, const cw_scene *scene);

/* How far a scene's picture is from test_truth(). */
test_gap test_error(cw_renderer *renderer, const cw_scene *scene);

#endif
