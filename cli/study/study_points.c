/* Adds settings and their timed runs to a study, and knows when its time is up. */
#include "cli/study/study.h"

#include "cli/framework/console.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

cli_point *cli_add_point(cli_study *s, cli_family family, int rank, const char *group,
                         const char *format, ...)
{
    va_list args;
    cli_point *p = &s->points[s->point_count++];
    p->family = family;
    p->rank = rank;
    p->group = group;
    va_start(args, format);
    vsnprintf(p->name, sizeof p->name, format, args);
    va_end(args);
    return p;
}

bool cli_time_is_up(const cli_study *s)
{
    return cli_seconds() >= s->deadline;
}

static int compare_times(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

void cli_add_run(cli_point *p, double seconds)
{
    double sorted[CLI_MAX_RUNS];
    if (p->runs == CLI_MAX_RUNS)
        return;
    p->times[p->runs++] = seconds;
    memcpy(sorted, p->times, sizeof sorted);
    qsort(sorted, p->runs, sizeof *sorted, compare_times);
    p->seconds = p->runs % 2 ? sorted[p->runs / 2]
                             : 0.5 * (sorted[p->runs / 2 - 1] + sorted[p->runs / 2]);
}
