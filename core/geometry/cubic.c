/* Finds the turning points of a cubic, and the place where it has a value. */
#include "core/geometry/cubic.h"

#include <math.h>
#include <stdbool.h>

int cwi_cubic_turns(const double c[4], double x[2])
{
    const double discriminant = c[2] * c[2] - 3 * c[3] * c[1];
    if (!(discriminant > 0))
        return 0;
    const double q = -(c[2] + copysign(sqrt(discriminant), c[2]));
    const double r[2] = {q / (3 * c[3]), c[1] / q};
    const bool swap = r[1] < r[0];
    int count = 0;
    for (int n = 0; n < 2; n++) {
        const double at = r[swap ? 1 - n : n];
        if (at > 0 && at < 1)
            x[count++] = at;
    }
    return count;
}

/* Finds the place by Newton's method inside a bracket. Where a step leaves the bracket or is
 * slow, the bracket is halved. */
double cwi_cubic_meets(const double c[4], double from, double to, double value)
{
    const bool rises = cwi_cubic_at(c, from) < cwi_cubic_at(c, to);
    double x = (from + to) / 2;
    for (int n = 0; n < 80 && to - from > 1e-15; n++) {
        const double above = cwi_cubic_at(c, x) - value;
        if (above == 0)
            return x;
        if ((above > 0) == rises)
            to = x;
        else
            from = x;
        const double step = above / ((3 * c[3] * x + 2 * c[2]) * x + c[1]);
        const double next = x - step;
        if (fabs(step) < 1e-16)
            return x;
        x = n < 40 && next > from && next < to ? next : (from + to) / 2;
    }
    return x;
}
