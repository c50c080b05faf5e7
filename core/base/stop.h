/* One request to stop, noticed by all threads of a call: the caller's progress is asked on the
 * calling thread alone, and the others learn what it said. */
#ifndef CORE_BASE_STOP_H
#define CORE_BASE_STOP_H

#include <cubewright/core.h>

#include <pthread.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Initialise it on the calling thread; it must not move while its progress is in use. */
typedef struct cwi_stop {
    const cw_progress *progress; /* the caller's; borrowed */
    pthread_t caller;
    double done; /* the share reported last */
    bool stopped;
} cwi_stop;

void cwi_stop_init(cwi_stop *stop, const cw_progress *progress);

/* A progress that may be reported from any thread. A negative share repeats the last one. */
cw_progress cwi_stop_progress(cwi_stop *stop);

#ifdef __cplusplus
}
#endif

#endif
