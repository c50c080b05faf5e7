/* Fills in errors, describes status codes, and reports progress. */
#include "core/base/status.h"

#include "core/base/memory.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const struct {
    int exit_code;
    const char *name, *text;
} table[CW_STATUS_COUNT] = {
#define ROW(name, exit_code, json, text) {exit_code, json, text},
    CW_STATUS_TABLE(ROW)
#undef ROW
};

static cw_status clamp_status(cw_status status)
{
    return (unsigned)status < CW_STATUS_COUNT ? status : CW_ERR_BACKEND;
}

const char *cw_version(void)
{
    return CW_VERSION;
}

int cw_status_exit_code(cw_status status)
{
    return table[clamp_status(status)].exit_code;
}

const char *cw_status_name(cw_status status)
{
    return table[clamp_status(status)].name;
}

const char *cw_status_text(cw_status status)
{
    return table[clamp_status(status)].text;
}

cw_status cwi_fail(cw_error *err, cw_status status, const char *format, ...)
{
    if (err) {
        va_list args;
        va_start(args, format);
        err->status = status;
        vsnprintf(err->message, sizeof err->message, format, args);
        va_end(args);
    }
    return status;
}

cw_status cwi_fail_in(cw_error *err, cw_status status, const char *subject)
{
    if (err) {
        const cw_error inner = *err;
        cwi_fail(err, status, "%s: %s", subject, inner.message);
    }
    return status;
}

bool cwi_begin_call(cw_error *err, const char *function, const char *names,
                    const void *const *pointers, size_t count)
{
    if (err) {
        err->status = CW_OK;
        err->message[0] = '\0';
    }
    for (size_t n = 0; n < count; n++) {
        if (!pointers[n]) {
            cwi_fail(err, CW_ERR_ARGUMENT, "%s: '%.*s' is NULL", function,
                     (int)strcspn(names, ","), names);
            return false;
        }
        names += strcspn(names, ",");
        names += strspn(names, ", ");
    }
    return true;
}

cw_status cwi_progress(const cw_progress *progress, const char *step, double done,
                       cw_error *err)
{
    cwi_memory_trim();
    if (progress->report && !progress->report(progress->user, step, done))
        return cwi_fail(err, CW_ERR_CANCELLED, "interrupted while %s", step);
    return CW_OK;
}

static bool report_part(void *user, const char *step, double done)
{
    const cwi_part_progress *p = user;
    return p->whole->report(p->whole->user, step, p->from + p->fraction * done);
}

cw_progress cwi_progress_part(const cwi_part_progress *part)
{
    return part->whole->report ? (cw_progress){.report = report_part, .user = (void *)part}
                               : (cw_progress){0};
}
