/* Pictures by the definition: emission and absorption summed up along rays in small steps, in
 * double precision, from voxels that are interpolated by hand. */
#ifndef TESTS_INTEGRAL_H
#define TESTS_INTEGRAL_H

#include "support/pictures.h"

/* Unlit, without a gradient's factor, depth cue or mesh; of a volume of floats. By steps of
 * step_vox, each of which stands for its middle: the error falls with its square. With
 * scene.colors_first, emission and extinction of the voxels are interpolated. */
cw_picture test_integral(const cw_scene *scene, double step_vox);

#endif
