/* Helpers of every call: errors and progress. */
#ifndef CORE_BASE_STATUS_H
#define CORE_BASE_STATUS_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Writes the message (err may be NULL) and returns the status, so that a function can report an
 * error and return in one line. */
cw_status cwi_fail(cw_error *err, cw_status status, const char *format, ...) CW_PRINTF(3, 4);

/* Puts "subject: " in front of the message, for a caller that knows the file's name. Returns
 * the same status, so that it can be passed through. */
cw_status cwi_fail_in(cw_error *err, cw_status status, const char *subject);

/* Begins a public call: clears *err, and returns CW_ERR_ARGUMENT from the calling function when a
 * pointer is NULL. One to six pointers, or none but err. */
#define CWI_REQUIRE(...) CWI_REQUIRE_(__VA_ARGS__, NULL)
#define CWI_REQUIRE_(err, ...)                                                                 \
    do {                                                                                       \
        const void *const pointers_[] = {__VA_ARGS__};                                         \
        const size_t count_ = sizeof pointers_ / sizeof *pointers_ - 1;                        \
        if (!cwi_begin_call(err, __func__, #__VA_ARGS__, pointers_, count_))                   \
            return CW_ERR_ARGUMENT;                                                            \
    } while (0)
bool cwi_begin_call(cw_error *err, const char *function, const char *names,
                    const void *const *pointers, size_t count);

/* Returns CW_ERR_ARGUMENT from the calling function when a struct of the caller, which may be NULL, has a
 * later version than the newest one that the function knows. */
#define CWI_REQUIRE_VERSION(err, desc, newest)                                                 \
    do {                                                                                       \
        if ((desc) && (desc)->version > (newest))                                              \
            return cwi_fail(err, CW_ERR_ARGUMENT,                                              \
                            "%s: %s->version is %u; this library knows up to %u", __func__,    \
                            #desc, (unsigned)(desc)->version, (unsigned)(newest));             \
    } while (0)

/* Returns CW_ERR_ARGUMENT from the calling function when an array with elements is NULL. */
#define CWI_REQUIRE_ARRAY(err, array, count)                                                   \
    do {                                                                                       \
        if ((count) > 0 && !(array))                                                           \
            return cwi_fail(err, CW_ERR_ARGUMENT, "%s: '%s' is NULL", __func__, #array);       \
    } while (0)

/* Reports progress, and returns CW_ERR_CANCELLED if the caller stops the call. */
CW_NODISCARD cw_status cwi_progress(const cw_progress *progress, const char *step, double done,
                                    cw_error *err);

/* A part of a call, whose progress is a share of the whole. */
typedef struct cwi_part_progress {
    const cw_progress *whole;
    double from, fraction;
} cwi_part_progress;

/* Returns the progress that the part reports to; it borrows the part. */
cw_progress cwi_progress_part(const cwi_part_progress *part);

#ifdef __cplusplus
}
#endif

#endif
