/* Lengths, angles and areas between points that people pick, in millimetres of the world. */
#ifndef VIEWER_INTERACT_MEASURE_H
#define VIEWER_INTERACT_MEASURE_H

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Returns the distance of two points. */
double cwi_measure_distance(const double from[3], const double to[3]);

/* Returns the angle at `corner` between the directions to two points, 0 to 180 degrees; NaN
 * where a direction has no length. */
double cwi_measure_angle(const double from[3], const double corner[3], const double to[3]);

/* Finds the vector area of a closed polygon: its normal, as long as its area. That is the area
 * of a flat polygon, and the largest shadow of one that is not flat.
 * points  count of them, in their order around the polygon */
void cwi_measure_vector_area(const double (*points)[3], size_t count, double area[3]);

/* Returns the area of a closed polygon in mm^2, as above. */
double cwi_measure_area(const double (*points)[3], size_t count);

/* Returns the largest distance of the points from the plane through their mean, across the
 * vector area: 0 for a flat polygon, and for one without area. */
double cwi_measure_bend(const double (*points)[3], size_t count);

/* Returns true if two edges of the polygon cross, seen along its vector area or, where that is
 * 0, along the normal of its first corner: then its parts count against each other. */
bool cwi_measure_crosses(const double (*points)[3], size_t count);

#ifdef __cplusplus
}
#endif

#endif
