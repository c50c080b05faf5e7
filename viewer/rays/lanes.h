/* Four floats at once, by the vectors of GCC and Clang. */
#ifndef VIEWER_RAYS_LANES_H
#define VIEWER_RAYS_LANES_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef float cwi_lanes __attribute__((vector_size(16)));
typedef int32_t cwi_int_lanes __attribute__((vector_size(16)));

static inline cwi_lanes cwi_lanes_load(const float *p)
{
    cwi_lanes v;
    memcpy(&v, p, sizeof v);
    return v;
}

static inline cwi_lanes cwi_lanes_spread(float x)
{
    return (cwi_lanes){x, x, x, x};
}

/* Returns a where the mask is set, else b. */
static inline cwi_lanes cwi_lanes_choose(cwi_int_lanes mask, cwi_lanes a, cwi_lanes b)
{
    return (cwi_lanes)(((cwi_int_lanes)a & mask) | ((cwi_int_lanes)b & ~mask));
}

static inline cwi_lanes cwi_lanes_min(cwi_lanes a, cwi_lanes b)
{
    return cwi_lanes_choose(a < b, a, b);
}

static inline cwi_lanes cwi_lanes_max(cwi_lanes a, cwi_lanes b)
{
    return cwi_lanes_choose(a > b, a, b);
}

/* Returns true if all of a mask is set. */
static inline int cwi_lanes_all(cwi_int_lanes mask)
{
    int64_t half[2];
    memcpy(half, &mask, sizeof half);
    return (half[0] & half[1]) == -1;
}

/* Swaps rows and columns of four by four numbers. */
static inline void cwi_lanes_transpose(cwi_lanes m[4])
{
    const cwi_lanes a = __builtin_shufflevector(m[0], m[1], 0, 4, 1, 5),
                    b = __builtin_shufflevector(m[0], m[1], 2, 6, 3, 7),
                    c = __builtin_shufflevector(m[2], m[3], 0, 4, 1, 5),
                    d = __builtin_shufflevector(m[2], m[3], 2, 6, 3, 7);
    m[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
    m[1] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
    m[2] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
    m[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}

static inline cwi_lanes cwi_lanes_root(cwi_lanes x)
{
    cwi_lanes root;
    for (int n = 0; n < 4; n++)
        root[n] = sqrtf(x[n]);
    return root;
}

/* Returns exp(-x) for x above -0.3, to a relative error of 2e-7: 2^n times a polynomial for
 * 2^f, f from -1/2 to 1/2. */
static inline cwi_lanes cwi_lanes_fade(cwi_lanes x)
{
    const cwi_lanes y = cwi_lanes_choose(x < 80.0f, x, cwi_lanes_spread(80)) * -1.44269504f;
    const cwi_int_lanes n = __builtin_convertvector(y - 0.5f, cwi_int_lanes);
    const cwi_lanes f = (y - __builtin_convertvector(n, cwi_lanes)) * 0.69314718f;
    const cwi_lanes p =
        ((((f * (1.0f / 720) + 1.0f / 120) * f + 1.0f / 24) * f + 1.0f / 6) * f + 0.5f) * f *
            f +
        f + 1;
    return p * (cwi_lanes)((n + 127) << 23);
}

#ifdef __cplusplus
}
#endif

#endif
