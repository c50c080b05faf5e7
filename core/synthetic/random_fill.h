/* Common parts of the samplers of synthetic volumes: pseudorandom numbers, and voxels of any
 * type. */
#ifndef CORE_SYNTHETIC_RANDOM_FILL_H
#define CORE_SYNTHETIC_RANDOM_FILL_H

#include <cubewright/volume.h>

/* Returns the n-th number of SplitMix64: it depends on n alone, so threads do not matter. */
uint64_t cwi_random_bits(uint64_t seed, uint64_t n);

/* Returns the n-th of a stream of numbers 0 <= x < 1, or of Gaussian ones of deviation 1. */
double cwi_chance(uint64_t seed, uint64_t n);
double cwi_gaussian(uint64_t seed, uint64_t n);

/* Returns the range in which integer types are filled, 8 bits or 16; false for floats. */
bool cwi_fill_range(cw_type type, double *low, double *high);

/* Stores the n-th of packed voxels; in integer types rounded, and clamped to that range. */
void cwi_fill(cw_type type, void *voxels, size_t n, double value);

#endif
