/* Helpers that the benches of pictures share: values in order, medians, errors. */
#ifndef BENCH_BENCH_H
#define BENCH_BENCH_H

#include <cubewright/core.h>

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

/* Processor time of all threads so far. */
static inline double bench_cpu_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

static inline int bench_by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Sorts the values. */
static inline double bench_median(double *values, int count)
{
    qsort(values, (size_t)count, sizeof *values, bench_by_value);
    return values[count / 2];
}

/* Ends the program with the message when something failed. */
static inline void bench_check(cw_status st, const cw_error *err)
{
    if (st == CW_OK)
        return;
    fprintf(stderr, "%s\n", err->message);
    exit(1);
}

#endif
