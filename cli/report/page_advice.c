/* The advice of a study, in words. */
#include "cli/report/page.h"

void cli_put_advice(FILE *out, const cli_study *s)
{
    cli_advice advice[CLI_MAX_ADVICE];
    const size_t count = cli_find_advice(s, advice);
    if (count)
        fputs("<h2 id=\"advice\">What to take</h2>\n<ul class=\"advice\">\n", out);
    for (size_t n = 0; n < count; n++) {
        fprintf(out, "<li><p><strong>%s: ", advice[n].purpose);
        cli_put_html(out, advice[n].point->name);
        fputs("</strong>: ", out);
        cli_put_html(out, advice[n].why);
        fputs("</p>", out);
        if (advice[n].command)
            cli_put_code(out, advice[n].command);
        fputs("</li>\n", out);
    }
    if (count)
        fputs("</ul>\n", out);
    cli_free_advice(advice, count);
}
