/* Judges the plain surface as a print. */
#include "cli/report/study.h"

#include "cli/framework/console.h"
#include "cli/framework/field_names.h"

#include <stdio.h>

static void leave_out(cli_print_study *p, const char *why)
{
    snprintf(p->why, sizeof p->why, "%s", why);
}

/* Measures the surface, of which walls take longest. */
static cw_status measure(cli_study *s, cw_quality *quality, cw_crossings *crossings,
                         cw_error *err)
{
    const cw_progress progress =
        cli_progress((double)s->full.triangle_count / 1e6, "Mtriangle");
    const cw_quality_desc desc = {
        .weld = CW_WELD_LOCAL, .shells = true, .threads = s->threads, .progress = progress};
    const cw_crossings_desc meet = {.threads = s->threads, .progress = progress};
    const cw_print_desc print = {.threads = s->threads, .progress = progress};
    cw_status st = cw_quality_measure(&s->full, &desc, quality, err);
    if (st == CW_OK)
        st = cw_self_intersections(&s->full, &meet, crossings, err);
    if (st == CW_OK && cw_quality_is_closed_manifold(quality))
        st = cw_print_measure(&s->full, &print, &s->print.facts, err);
    return st;
}

cw_status cli_study_print(cli_study *s, cw_error *err)
{
    cli_print_study *p = &s->print;
    cw_quality quality;
    cw_crossings crossings = {0};
    cw_error why = {0};
    if (cli_time_is_up(s)) {
        leave_out(p, "the budget was spent before it was measured");
        return CW_OK;
    }
    cli_say_v("print");
    cw_status st = measure(s, &quality, &crossings, &why);
    if (st == CW_OK) {
        const bool is_solid = cw_quality_is_closed_manifold(&quality);
        const cw_findings findings = {
            .quality = &quality, .crossings = &crossings, .print = is_solid ? &p->facts : NULL};
        p->verdict_count = cw_check_judge(&findings, CW_PROFILE_PRINT, p->verdicts);
    }
    cw_crossings_free(&crossings);
    if (st != CW_OK && cli_interrupted()) {
        *err = why;
        return st;
    }
    if (st != CW_OK)
        leave_out(p, st == CW_ERR_CANCELLED
                         ? "it was still being measured when the budget was spent"
                         : cli_name_options(why.message, (char[CLI_MESSAGE]){0}));
    return CW_OK;
}
