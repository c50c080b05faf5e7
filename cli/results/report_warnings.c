/* Warnings of a run: printed at once, and kept for its report. */
#include "cli/framework/console.h"
#include "cli/results/run_report.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void cli_report_warn(cli_report *report, const char *format, ...)
{
    cli_made *made = &report->made[report->made_count - 1];
    char text[sizeof *made->warning];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    cli_say("cubewright: warning: %s", text);
    if (made->warning_count < CLI_MAX_WARNINGS)
        memcpy(made->warning[made->warning_count++], text, sizeof text);
}
