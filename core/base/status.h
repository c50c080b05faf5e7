/* Filling in a cw_error, and the small checks every call makes. */
#ifndef CORE_BASE_STATUS_H
#define CORE_BASE_STATUS_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Writes the message (err may be NULL) and returns the status, so that a failing function can
 * say why and leave in one line. */
cw_status cw_fail(cw_error *err, cw_status status, const char *format, ...) CW_PRINTF(3, 4);

/* Puts "subject: " in front of the message: for the caller that knows the file's name. Returns
 * status, unchanged, so that it can be passed through. */
cw_status cwi_fail_in(cw_error *err, cw_status status, const char *subject);

/* Reports progress and turns a refusal to go on into CW_ERR_CANCELLED. */
CW_NODISCARD cw_status cwi_progress(const cw_progress *progress, const char *step, double done,
                                    cw_error *err);

/* The number of threads a desc asks for: all that OpenMP offers when it says 0 or less. */
int cwi_threads(int asked);

#ifdef __cplusplus
}
#endif

#endif
