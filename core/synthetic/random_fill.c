/* Makes random numbers by SplitMix64 and Box-Muller, and stores voxels of any type. */
#include "core/synthetic/random_fill.h"
#include "core/geometry/vec3.h"

#include <math.h>

uint64_t cwi_random_bits(uint64_t seed, uint64_t n)
{
    uint64_t z = seed + (n + 1) * UINT64_C(0x9E3779B97F4A7C15);
    z = (z ^ z >> 30) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ z >> 27) * UINT64_C(0x94D049BB133111EB);
    return z ^ z >> 31;
}

double cwi_chance(uint64_t seed, uint64_t n)
{
    return (double)(cwi_random_bits(seed, n) >> 11) * 0x1p-53;
}

/* Makes a Gaussian number by Box-Muller: one of the pair is used. */
double cwi_gaussian(uint64_t seed, uint64_t n)
{
    const double u = cwi_chance(seed, 2 * n) + 0x1p-53;
    const double v = cwi_chance(seed, 2 * n + 1);
    return sqrt(-2 * log(u)) * cos(2 * CWI_PI * v);
}

bool cwi_fill_range(cw_type type, double *low, double *high)
{
    const bool is_signed = type == CW_I8 || type == CW_I16 || type == CW_I32;
    const double values = cw_type_size(type) == 1 ? 256 : 65536;
    *low = is_signed ? -values / 2 : 0;
    *high = *low + values - 1;
    return type != CW_F32 && type != CW_F64;
}

void cwi_fill(cw_type type, void *voxels, size_t n, double value)
{
    double low, high;
    if (cwi_fill_range(type, &low, &high))
        value = rint(fmin(fmax(value, low), high));
    switch (type) {
#define CASE(name, ctype, text)                                                                \
    case name:                                                                                 \
        ((ctype *)voxels)[n] = (ctype)value;                                                   \
        break;
        CW_TYPE_TABLE(CASE)
#undef CASE
    default:
        break;
    }
}
