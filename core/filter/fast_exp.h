/* An exponential function that compilers turn into SIMD instructions. */
#ifndef CORE_FILTER_FAST_EXP_H
#define CORE_FILTER_FAST_EXP_H

#include <stdint.h>

/* Returns exp(-t) for t of 0 or more, within 1e-6 of it in proportion; 0 for t above 80 and for
 * NaN. exp(-t) is 2^(-n) 2^f with an integer n and f from -1/2 to 1/2. The powers of f are from
 * the Taylor series of 2^f, up to the sixth. */
static inline float cwi_fast_exp(float t)
{
    const float y = (t < 80 ? t : 80) * -1.44269504f; /* log2(e) */
    const int32_t n = (int32_t)(y - 0.5f);            /* towards 0: rounds y <= 0 */
    const float f = y - (float)n;
    const float power =
        1 +
        f * (0.69314718f +
             f * (0.24022651f +
                  f * (0.05550411f + f * (0.00961813f + f * (0.00133336f + f * 0.00015404f)))));
    const union {
        int32_t bits;
        float number;
    } scale = {.bits = (n + 127) * (1 << 23)};
    return t < 80 ? scale.number * power : 0;
}

#endif
