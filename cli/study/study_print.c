/* Judges the plain surface as a print. */
#include "cli/study/study.h"

#include "cli/framework/console.h"
#include "cli/framework/field_names.h"

#include <stdio.h>

static void leave_out(cli_print_study *p, const char *why)
{
    snprintf(p->why, sizeof p->why, "%s", why);
}

cw_status cli_study_print(cli_study *s, cw_error *err)
{
    cli_print_study *p = &s->print;
    const cli_printer usual = {0};
    cw_error why = {0};
    if (cli_time_is_up(s)) {
        leave_out(p, "the budget was spent before it was measured");
        return CW_OK;
    }
    cli_say_v("print");
    cw_status st = cli_measure_printed(&s->full, &usual, s->threads, &p->seen, &why);
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
