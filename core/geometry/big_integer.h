/* Integers of up to 1,088 bits, for signs of determinants that doubles cannot decide. */
#ifndef CORE_GEOMETRY_BIG_INTEGER_H
#define CORE_GEOMETRY_BIG_INTEGER_H

#include <stdbool.h>
#include <stdint.h>

enum { CWI_BIG_LIMBS = 17 };

/* Sign and magnitude. No result of the functions below may be wider than CWI_BIG_LIMBS: callers know the bits
 * of their inputs. */
typedef struct cwi_big {
    int count;     /* of limbs in use, the last of which is not 0; 0: the number is 0 */
    bool negative; /* false for 0 */
    uint64_t limbs[CWI_BIG_LIMBS]; /* least significant first */
} cwi_big;

__extension__ typedef __int128 cwi_wide; /* products of two 64-bit integers */
void cwi_big_set(cwi_big *out, cwi_wide value);

/* Computes a * b, a + b, a - b. The output is none of the inputs in a product, and may be one in a sum. */
void cwi_big_mul(const cwi_big *a, const cwi_big *b, cwi_big *out);
void cwi_big_add(const cwi_big *a, const cwi_big *b, cwi_big *out);
void cwi_big_sub(const cwi_big *a, const cwi_big *b, cwi_big *out);

/* Computes a * b - c * d, the determinant of two rows. */
void cwi_big_cross(const cwi_big *a, const cwi_big *b, const cwi_big *c, const cwi_big *d,
                   cwi_big *out);

static inline void cwi_big_negate(cwi_big *a)
{
    a->negative = a->count && !a->negative;
}

/* Returns -1, 0 or 1. */
static inline int cwi_big_sign(const cwi_big *a)
{
    return a->count ? (a->negative ? -1 : 1) : 0;
}

/* Returns a / b, where b is not 0, with a relative error below 2^-50. */
double cwi_big_ratio(const cwi_big *a, const cwi_big *b);

#endif
