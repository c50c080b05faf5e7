/* Scenes with known pictures, and how far two pictures differ. */
#ifndef TESTS_PICTURES_H
#define TESTS_PICTURES_H

#include "support/support.h"

#include <cubewright/render.h>

/* The renderer of this program; the test is skipped when this build has no GL, and fails when
 * it has but GL does not start. Close it in the group's teardown. */
cw_renderer *test_renderer(void);
int test_renderer_close(void **state);

/* Floats: value(p, q) at each voxel, with p in voxels and q from 0 to 1 along each axis;
 * spacing in mm, 0 at the middle of the world. */
void test_field(cw_volume *volume, size_t nx, size_t ny, size_t nz, const double spacing[3],
                double (*value)(const double p[3], const double q[3]));

/* Mirrors a volume along x, and shears it along y, around its middle. */
void test_shear(cw_volume *volume);

/* Fields: 1 everywhere; q along x; the product of all three; six Gaussians and a ripple. */
double test_constant(const double p[3], const double q[3]);
double test_ramp(const double p[3], const double q[3]);
double test_cubic(const double p[3], const double q[3]);
double test_blobs(const double p[3], const double q[3]);

/* For values from 0 to 1, per smallest spacing: opacity 0.05 everywhere; rising gently; a tent
 * about 0.02 wide around 0.5. */
cw_transfer test_flat_transfer(void);
cw_transfer test_soft_transfer(void);
cw_transfer test_tent_transfer(void);

/* Draws, and fails the test when that fails. */
cw_picture test_draw(cw_renderer *renderer, const cw_scene *scene);

/* Of all channels, in 1/255. */
typedef struct test_gap {
    double rmse, max;
} test_gap;
test_gap test_compare(const cw_picture *a, const cw_picture *b);

#endif
