/* Volumes of noise of every type, to try filters on. */
#ifndef SUPPORT_NOISE_VOLUME_H
#define SUPPORT_NOISE_VOLUME_H

#include <cubewright/volume.h>

enum { NOISE_TYPES = 8 };

extern const cw_type noise_types[NOISE_TYPES];

/* Makes a volume of random numbers of a type, with 0.5 x 2 x 0.75 mm. With gaps every ninth has no
 * value: no data, and of floats not a number. */
cw_volume make_noise_volume(cw_type type, const size_t dim[3], bool gaps);

/* Returns the stored number of a voxel. */
double stored_at(const cw_volume *v, size_t i, size_t j, size_t k);

/* Returns true if a stored number is no value. */
bool is_gap(const cw_volume *v, double x);

/* Returns the index next to n that an axis of `count` voxels has. */
size_t clamp_index(long n, size_t count);

/* Returns the stored number at a displacement from a voxel; beyond the border that at the border. */
double value_near(const cw_volume *v, const size_t at[3], long x, long y, long z);

/* Compares a filtered volume with the numbers that it should have; NaN: no value. */
void assert_filtered(const cw_volume *in, const cw_volume *out,
                     double (*expected)(const cw_volume *, const size_t[3], const void *),
                     const void *context);

#endif
