/* A smooth curve through values at times that stays between neighbouring values. */
#ifndef CORE_GEOMETRY_MONOTONE_CURVE_H
#define CORE_GEOMETRY_MONOTONE_CURVE_H

#include <stddef.h>

/* Returns the value of a cubic curve at a time: through all values, with a continuous slope, and
 * nowhere beyond the two values around it. Before the first time it is the first value, after
 * the last the last one.
 * times   count of them, rising; count is at least 1
 * Source  [Fritsch1980], with the slopes of [Steffen1990] */
double cwi_monotone_curve(const double *times, const double *values, size_t count, double time);

#endif
