/* Reads the monotonic clock of the system (CLOCK_MONOTONIC). */
#define _GNU_SOURCE /* clock_gettime */
#include "core/base/clock.h"

#include <time.h>

double cwi_now_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
