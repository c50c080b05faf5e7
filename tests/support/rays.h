/* Rays gone along in many small steps, by formulas written down a second time. */
#ifndef TESTS_RAYS_H
#define TESTS_RAYS_H

#include "viewer/scene/frame_setup.h"

/* The trilinear field of packed floats at a point of index space, inside of the box; and its
 * gradient per voxel: central differences, also interpolated trilinearly. */
double test_field_at(const cw_volume *volume, const double index[3]);
void test_gradient_at(const cw_volume *volume, const double index[3], double gradient[3]);

/* Emission and absorption along the ray through a point of the picture: colour and opacity.
 * Steps are equal; the error falls with their square. */
void test_ray(const cwi_frame *frame, double x, double y, size_t steps, double out[4]);

/* The lowest, highest and mean value along it. */
void test_ray_values(const cwi_frame *frame, double x, double y, size_t steps, double out[3]);

/* A frame, and a test that fails when there is none. */
cwi_frame test_frame(const cw_scene *scene);

#endif
