/* Says what smoothing did, for people and for the report. */
#include "cli/results/smoothed.h"

#include "cli/framework/quantity.h"

#include <math.h>
#include <stdio.h>

/* Smaller changes of the volume are rounding to single precision. */
static const double UNCHANGED_PERCENT = 1e-4;

void cli_json_smoothed(cli_json *j, const cw_smooth_facts *f)
{
    cli_json_open(j, "smooth", '{');
    cli_json_number(j, "max_mm", f->max_mm);
    cli_json_number(j, "mean_mm", f->mean_mm);
    cli_json_number(j, "volume_before_mm3", f->volume_before_mm3);
    cli_json_number(j, "volume_after_mm3", f->volume_after_mm3);
    cli_json_count(j, "flipped", f->flipped);
    cli_json_count(j, "border_vertices", f->border);
    cli_json_count(j, "junction_vertices", f->junction);
    cli_json_count(j, "put_back", f->put_back);
    cli_json_close(j, '}');
}

void cli_smoothed_text(const cw_smooth_facts *f, char text[CLI_SMOOTHED_TEXT])
{
    const double change = 100 * (f->volume_after_mm3 / f->volume_before_mm3 - 1);
    size_t used = (size_t)snprintf(text, CLI_SMOOTHED_TEXT,
                                   "vertices moved by at most %.3g mm, mean %.3g mm", f->max_mm,
                                   f->mean_mm);
    if (!f->border && f->volume_before_mm3 != 0)
        used += (size_t)snprintf(text + used, CLI_SMOOTHED_TEXT - used,
                                 "; volume %.6g mm3, changed by %.2g %%", f->volume_after_mm3,
                                 fabs(change) < UNCHANGED_PERCENT ? 0 : change);
    snprintf(text + used, CLI_SMOOTHED_TEXT - used, "; %s triangle%s flipped",
             cli_count(f->flipped), f->flipped == 1 ? "" : "s");
}
