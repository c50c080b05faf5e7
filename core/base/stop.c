/* Calls the caller's progress on the calling thread, and passes its request to stop to all
 * threads. */
#include "core/base/stop.h"

void cwi_stop_init(cwi_stop *stop, const cw_progress *progress)
{
    *stop = (cwi_stop){.progress = progress, .caller = pthread_self()};
}

static bool report_progress(void *user, const char *step, double done)
{
    cwi_stop *s = user;
    bool stopped = __atomic_load_n(&s->stopped, __ATOMIC_RELAXED);
    if (stopped || !s->progress->report || !pthread_equal(pthread_self(), s->caller))
        return !stopped;
    s->done = done < 0 ? s->done : done;
    stopped = !s->progress->report(s->progress->user, step, s->done);
    if (stopped)
        __atomic_store_n(&s->stopped, true, __ATOMIC_RELAXED);
    return !stopped;
}

cw_progress cwi_stop_progress(cwi_stop *stop)
{
    return (cw_progress){.report = report_progress, .user = stop};
}
