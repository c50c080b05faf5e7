/* Sums the volume that a surface encloses in whole numbers, so that the order of the triangles does
 * not matter. */
#ifndef CORE_MESH_ENCLOSED_VOLUME_H
#define CORE_MESH_ENCLOSED_VOLUME_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

/* Coordinates are rounded to whole units of at most 2^28. A triangle then adds less than 2^91 to a
 * sum, so a sum of 2^36 triangles fits. */
enum { CWI_VOLUME_BITS = 28 };

/* A sum of volumes or areas. Without integers of 128 bits its last digits depend on the order. */
#ifdef __SIZEOF_INT128__
__extension__ typedef __int128 cwi_volume_sum;
#else
typedef double cwi_volume_sum;
#endif

/* Units of coordinates: millimetres times `scale`, which is the power 28 - exponent of 2. */
typedef struct cwi_volume_unit {
    double scale;
    int exponent;
} cwi_volume_unit;

/* Returns the unit for finite coordinates of up to this size. */
static inline cwi_volume_unit cwi_volume_unit_for(float max)
{
    cwi_volume_unit unit;
    frexp((double)max, &unit.exponent);
    unit.scale = ldexp(1, CWI_VOLUME_BITS - unit.exponent);
    return unit;
}

/* Rounds a coordinate to units. The offset makes it positive, as conversion cuts towards 0. */
static inline int64_t cwi_volume_coordinate(double scale, float mm)
{
    const int64_t offset = (int64_t)1 << (CWI_VOLUME_BITS + 1);
    return (int64_t)((double)mm * scale + ((double)offset + 0.5)) - offset;
}

/* Computes the area vector of a triangle, twice as long. */
static inline void cwi_volume_area(const int64_t a[3], const int64_t b[3], const int64_t c[3],
                                   int64_t area[3])
{
    const int64_t p[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]},
                  q[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    area[0] = p[1] * q[2] - p[2] * q[1];
    area[1] = p[2] * q[0] - p[0] * q[2];
    area[2] = p[0] * q[1] - p[1] * q[0];
}

static inline cwi_volume_sum cwi_volume_dot(const int64_t a[3], const int64_t b[3])
{
    return (cwi_volume_sum)a[0] * b[0] + (cwi_volume_sum)a[1] * b[1] +
           (cwi_volume_sum)a[2] * b[2];
}

static inline cwi_volume_sum cwi_volume_abs(cwi_volume_sum x)
{
    return x < 0 ? -x : x;
}

/* Returns true for a closed component whose triangles face inward.
 * volume  any multiple of it
 * area    any multiple of the area vector */
static inline bool cwi_volume_is_cavity(cwi_volume_sum volume, const cwi_volume_sum area[3])
{
    return volume < 0 && area[0] == 0 && area[1] == 0 && area[2] == 0;
}

/* Converts twelve times a volume to cubic millimetres. */
static inline double cwi_volume_mm3(const cwi_volume_unit *unit, cwi_volume_sum twelvefold)
{
    return ldexp((double)twelvefold / 12, 3 * (unit->exponent - CWI_VOLUME_BITS));
}

#endif
