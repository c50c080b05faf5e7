/* Measures what people mark by points: distances, angles, and areas of polygons. */
#include "viewer/interact/measure.h"

#include "core/geometry/vec3.h"

#include <string.h>

double cwi_measure_distance(const double from[3], const double to[3])
{
    return cwi_distance(from, to);
}

/* The arc cosine would lose half of the digits near 0 and 180 degrees. */
double cwi_measure_angle(const double from[3], const double corner[3], const double to[3])
{
    double a[3], b[3], across[3];
    cwi_sub(from, corner, a);
    cwi_sub(to, corner, b);
    cwi_cross(a, b, across);
    if (cwi_length(a) == 0 || cwi_length(b) == 0)
        return NAN;
    return atan2(cwi_length(across), cwi_dot(a, b)) * 180 / CWI_PI;
}

/* Measures from the first point: coordinates far from the origin keep their digits. */
void cwi_measure_vector_area(const double (*points)[3], size_t count, double area[3])
{
    memset(area, 0, 3 * sizeof *area);
    for (size_t n = 1; n + 1 < count; n++) {
        double a[3], b[3], across[3];
        cwi_sub(points[n], points[0], a);
        cwi_sub(points[n + 1], points[0], b);
        cwi_cross(a, b, across);
        for (int c = 0; c < 3; c++)
            area[c] += 0.5 * across[c];
    }
}

double cwi_measure_area(const double (*points)[3], size_t count)
{
    double area[3];
    cwi_measure_vector_area(points, count, area);
    return cwi_length(area);
}

double cwi_measure_bend(const double (*points)[3], size_t count)
{
    double normal[3], mean[3] = {0}, bend = 0;
    cwi_measure_vector_area(points, count, normal);
    if (!cwi_normalise(normal))
        return 0;
    for (size_t n = 0; n < count; n++)
        for (int c = 0; c < 3; c++)
            mean[c] += (points[n][c] - points[0][c]) / (double)count;
    for (size_t n = 0; n < count; n++) {
        double d[3];
        cwi_sub(points[n], points[0], d);
        bend = fmax(bend, fabs(cwi_dot(normal, d) - cwi_dot(normal, mean)));
    }
    return bend;
}

/* Finds two axes across the polygon's normal; false: all points are on a line. */
static bool find_axes(const double (*points)[3], size_t count, double x[3], double y[3])
{
    double normal[3];
    cwi_measure_vector_area(points, count, normal);
    for (size_t n = 1; n + 1 < count && cwi_length(normal) == 0; n++)
        cwi_measure_vector_area(points + n - 1, 3, normal);
    if (!cwi_normalise(normal))
        return false;
    const double helper[3] = {fabs(normal[0]) < 0.6, fabs(normal[0]) >= 0.6, 0};
    cwi_cross(normal, helper, x);
    cwi_normalise(x);
    cwi_cross(normal, x, y);
    return true;
}

static double side_of(const double a[2], const double b[2], const double p[2])
{
    return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
}

bool cwi_measure_crosses(const double (*points)[3], size_t count)
{
    double axes[2][3];
    if (count < 4 || !find_axes(points, count, axes[0], axes[1]))
        return false;
    for (size_t i = 0; i < count; i++)
        for (size_t j = i + 2; j < count; j++) {
            const size_t ends[4] = {i, i + 1, j, (j + 1) % count};
            double at[4][2];
            if (ends[3] == i)
                continue;
            for (int n = 0; n < 4; n++)
                for (int a = 0; a < 2; a++) {
                    double d[3];
                    cwi_sub(points[ends[n]], points[0], d);
                    at[n][a] = cwi_dot(axes[a], d);
                }
            if (side_of(at[0], at[1], at[2]) * side_of(at[0], at[1], at[3]) < 0 &&
                side_of(at[2], at[3], at[0]) * side_of(at[2], at[3], at[1]) < 0)
                return true;
        }
    return false;
}
