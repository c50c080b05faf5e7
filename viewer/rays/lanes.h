/* Four floats at once, by the vectors of GCC and Clang. */
#ifndef VIEWER_RAYS_LANES_H
#define VIEWER_RAYS_LANES_H

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
