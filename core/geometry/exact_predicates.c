/* Computes orientation predicates exactly [Shewchuk1997]. Doubles decide first. Where their
 * rounding could matter, coordinates are taken as whole numbers of a common unit, which nearly
 * always fit. Ties are usual, as extraction cuts flat polygons into triangles. Coordinates that
 * do not fit are summed without rounding: a product of two floats is exact in a double, of
 * three in two doubles. */
#include "core/geometry/exact_predicates.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { MAX_TERMS = 48 };

/* A sum without rounding: its parts do not overlap, and their sizes increase. */
typedef struct sum {
    int count;
    double part[MAX_TERMS];
} sum;

static void add_to_sum(sum *s, double x)
{
    int kept = 0;
    for (int n = 0; n < s->count; n++) {
        const double total = x + s->part[n], back = total - x;
        const double lost = (x - (total - back)) + (s->part[n] - back);
        if (lost != 0)
            s->part[kept++] = lost;
        x = total;
    }
    if (x != 0)
        s->part[kept++] = x;
    s->count = kept;
}

static int sign_of(double x)
{
    return (x > 0) - (x < 0);
}

static int sign_of_sum(const sum *s)
{
    return s->count ? sign_of(s->part[s->count - 1]) : 0;
}

static void add_product(sum *s, double xy, double z)
{
    const double rounded = xy * z;
    add_to_sum(s, fma(xy, z, -rounded));
    add_to_sum(s, rounded);
}

/* Adds sign times the determinant of the rows a, b, c. */
static void add_determinant(sum *s, double sign, const float *a, const float *b, const float *c)
{
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double bc = (double)b[j] * (double)c[k], cb = (double)b[k] * (double)c[j];
        add_product(s, bc, sign * (double)a[i]);
        add_product(s, cb, -sign * (double)a[i]);
    }
}

static int exact_orient3d(const float *a, const float *b, const float *c, const float *d)
{
    sum s = {0};
    add_determinant(&s, 1, b, c, d);
    add_determinant(&s, -1, a, c, d);
    add_determinant(&s, 1, a, b, d);
    add_determinant(&s, -1, a, b, c);
    return sign_of_sum(&s);
}

/* An integer of 128 bits. The determinant's three rows are differences of whole numbers below
 * 2^40 in size, so its six products sum up to less than 2^126. */
#ifdef __SIZEOF_INT128__
__extension__ typedef __int128 wide;
enum { WHOLE_BITS = 40 };

/* Returns the power of two that takes coordinates up to `max_magnitude` to just below 2^40. */
static double unit_for(float max_magnitude)
{
    uint64_t bits;
    double unit;
    const double m = (double)max_magnitude;
    memcpy(&bits, &m, sizeof bits);
    bits = (uint64_t)(2 * 1023 + WHOLE_BITS - 1 - (int)(bits >> 52)) << 52;
    memcpy(&unit, &bits, sizeof unit);
    return unit;
}

/* Converts points to units of a power of two; returns false when a coordinate is not whole. */
static bool make_whole(const float *const p[], int count, long long whole[][3])
{
    float max_magnitude = FLT_MIN;
    for (int n = 0; n < count; n++)
        for (int a = 0; a < 3; a++)
            max_magnitude = fabsf(p[n][a]) > max_magnitude ? fabsf(p[n][a]) : max_magnitude;
    const double unit = unit_for(max_magnitude);
    for (int n = 0; n < count; n++)
        for (int a = 0; a < 3; a++) {
            const double scaled = (double)p[n][a] * unit;
            whole[n][a] = (long long)scaled;
            if ((double)whole[n][a] != scaled)
                return false;
        }
    return true;
}

static int sign_of_wide(wide x)
{
    return (x > 0) - (x < 0);
}

static bool whole_orient3d(const float *const p[4], int *sign)
{
    long long x[4][3];
    wide value = 0;
    if (!make_whole(p, 4, x))
        return false;
    for (int n = 1; n < 4; n++)
        for (int a = 0; a < 3; a++)
            x[n][a] -= x[0][a];
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        value += x[1][i] * ((wide)x[2][j] * x[3][k] - (wide)x[2][k] * x[3][j]);
    }
    *sign = sign_of_wide(value);
    return true;
}

static bool whole_orient2d(const float *const p[3], int x, int y, int *sign)
{
    long long w[3][3];
    if (!make_whole(p, 3, w))
        return false;
    const wide left = (wide)(w[0][x] - w[2][x]) * (w[1][y] - w[2][y]);
    *sign = sign_of_wide(left - (wide)(w[0][y] - w[2][y]) * (w[1][x] - w[2][x]));
    return true;
}
#else
static bool whole_orient3d(const float *const p[4], int *sign)
{
    (void)p, (void)sign;
    return false;
}

static bool whole_orient2d(const float *const p[3], int x, int y, int *sign)
{
    (void)p, (void)x, (void)y, (void)sign;
    return false;
}
#endif

/* Decides by doubles if possible. The bound is Shewchuk's, for inputs of any size; those here
 * cannot under- or overflow. Where all products vanish, as of points in a plane across an axis,
 * the determinant does so exactly. */
int cwi_orient3d(const float a[3], const float b[3], const float c[3], const float d[3])
{
    const double unit = DBL_EPSILON / 2, error_factor = (7 + 56 * unit) * unit;
    double u[3], v[3], w[3], value = 0, size = 0;
    for (int i = 0; i < 3; i++) {
        u[i] = (double)b[i] - (double)a[i];
        v[i] = (double)c[i] - (double)a[i];
        w[i] = (double)d[i] - (double)a[i];
    }
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double vw = v[j] * w[k], wv = v[k] * w[j];
        value += u[i] * (vw - wv);
        size += fabs(u[i]) * (fabs(vw) + fabs(wv));
    }
    if (fabs(value) > error_factor * size || size == 0)
        return sign_of(value);
    int sign;
    return whole_orient3d((const float *[4]){a, b, c, d}, &sign) ? sign
                                                                 : exact_orient3d(a, b, c, d);
}

static int exact_orient2d(const float *a, const float *b, const float *c, int x, int y)
{
    sum s = {0};
    const float *point[3] = {a, b, c};
    for (int n = 0; n < 3; n++) {
        const float *p = point[n], *q = point[(n + 1) % 3];
        add_to_sum(&s, (double)p[x] * (double)q[y]);
        add_to_sum(&s, -((double)p[y] * (double)q[x]));
    }
    return sign_of_sum(&s);
}

static int settle_orient2d(const float *a, const float *b, const float *c, int x, int y)
{
    const double left = ((double)a[x] - (double)c[x]) * ((double)b[y] - (double)c[y]);
    const double right = ((double)a[y] - (double)c[y]) * ((double)b[x] - (double)c[x]);
    int sign;
    if (left == 0 && right == 0)
        return 0;
    return whole_orient2d((const float *[3]){a, b, c}, x, y, &sign)
               ? sign
               : exact_orient2d(a, b, c, x, y);
}

int cwi_orient2d(const float a[3], const float b[3], const float c[3], int axis)
{
    const int sign = cwi_sure_orient2d(a, b, c, axis);
    return sign ? sign : settle_orient2d(a, b, c, (axis + 1) % 3, (axis + 2) % 3);
}

int cwi_seen_along(const float a[3], const float b[3], const float c[3])
{
    for (int axis = 0; axis < 3; axis++)
        if (cwi_orient2d(a, b, c, axis) != 0)
            return axis;
    return -1;
}
