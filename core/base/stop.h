/* A request to stop that all threads of a call notice. The caller's progress is called only on
 * the calling thread; the other threads learn its result. */
#ifndef CORE_BASE_STOP_H
#define CORE_BASE_STOP_H

#include <cubewright/core.h>

#include <pthread.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The state of the request. Initialise it on the calling thread; it must not move while its
 * progress is in use. */
typedef struct cwi_stop {
    const cw_progress *progress; /* the caller's; borrowed */
    pthread_t caller;
    double done; /* the fraction reported last */
    bool stopped;
} cwi_stop;

void cwi_stop_init(cwi_stop *stop, const cw_progress *progress);

/* Makes a progress that may be reported from any thread. A negative fraction repeats the last
 * one. */
cw_progress cwi_stop_progress(cwi_stop *stop);

#ifdef __cplusplus
}
#endif

#endif
