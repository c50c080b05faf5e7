/* Which settings are worth choosing: those that no other one beats. */
#include "cli/study/study.h"

#include <math.h>

static bool beats_point(double cost, double error, double other_cost, double other_error)
{
    return cost <= other_cost && error <= other_error &&
           (cost < other_cost || error < other_error);
}

void cli_pareto(const double *cost, const double *error, size_t count, bool *front)
{
    for (size_t n = 0; n < count; n++) {
        front[n] = isfinite(cost[n]) && isfinite(error[n]);
        for (size_t other = 0; other < count && front[n]; other++)
            front[n] = !beats_point(cost[other], error[other], cost[n], error[n]);
    }
}
