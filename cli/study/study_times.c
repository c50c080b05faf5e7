/* Runs of a point, and their median. One run of some milliseconds tells little: what else the
 * machine did then may have doubled it. */
#include "cli/framework/console.h"
#include "cli/study/study.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static cw_status run_again(cli_study *s, cli_point *p, cw_error *err)
{
    cw_mesh mesh = {0};
    const char *path = NULL;
    const size_t bytes = p->file_bytes;
    cw_status st = p->family == CLI_EXTRACTION       ? cli_run_extraction(s, p, &mesh, err)
                   : p->family == CLI_SIMPLIFICATION ? cli_run_simplification(s, p, &mesh, err)
                                                     : cli_run_compression(s, p, &path, err);
    p->file_bytes = bytes;
    if (path)
        remove(path);
    cw_mesh_free(&mesh);
    return st;
}

/* The fastest of the points that are still to be repeated, as often as `runs`. */
static cli_point *find_next(cli_study *s, size_t runs)
{
    cli_point *next = NULL;
    for (size_t n = 0; n < s->point_count; n++) {
        cli_point *p = &s->points[n];
        if (p->done && !cli_is_drawn(p->family) && p->runs <= runs &&
            (!next || p->seconds < next->seconds))
            next = p;
    }
    return next;
}

/* All have two repetitions, or none: a median of two is no better than one of them. */
cw_status cli_time_again(cli_study *s, cw_error *err)
{
    cw_error why = {0};
    cli_point *p;
    while ((p = find_next(s, 1)) != NULL) {
        const size_t before = p->runs;
        cw_status st = CW_OK;
        if (cli_seconds() + (CLI_MAX_RUNS - 1) * 1.5 * p->seconds > s->deadline)
            return CW_OK;
        while (st == CW_OK && p->runs < CLI_MAX_RUNS)
            st = run_again(s, p, &why);
        if (st == CW_OK)
            continue;
        p->runs = before;
        p->seconds = p->times[0];
        if (cli_interrupted()) {
            *err = why;
            return st;
        }
        return CW_OK; /* the budget is spent */
    }
    return CW_OK;
}
