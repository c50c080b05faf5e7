/* Runs two pieces of work at the same time, on the calling thread and on another one. */
#define _POSIX_C_SOURCE 200809L /* pthread_sigmask */
#include "core/base/beside.h"

#include <signal.h>

static void *run_aside(void *context)
{
    const cwi_beside *b = context;
    b->aside(b->context);
    return NULL;
}

static void tell_ended(cwi_beside *b)
{
    pthread_mutex_lock(&b->lock);
    b->own_ended = true;
    pthread_cond_broadcast(&b->ended);
    pthread_mutex_unlock(&b->lock);
}

/* Signals go to the calling thread, as if it were alone: the other one blocks them. */
static bool start_thread(cwi_beside *b, pthread_t *thread)
{
    sigset_t all, before;
    sigfillset(&all);
    if (pthread_sigmask(SIG_SETMASK, &all, &before) != 0)
        return false;
    const bool started = pthread_create(thread, NULL, run_aside, b) == 0;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return started;
}

void cwi_beside_run(cwi_beside *b, void (*own)(void *context), void (*aside)(void *context),
                    void *context)
{
    pthread_t thread;
    *b = (cwi_beside){.aside = aside, .context = context};
    pthread_mutex_init(&b->lock, NULL);
    pthread_cond_init(&b->ended, NULL);
    const bool started = start_thread(b, &thread);
    own(context);
    tell_ended(b);
    if (started)
        pthread_join(thread, NULL);
    else
        aside(context);
    pthread_cond_destroy(&b->ended);
    pthread_mutex_destroy(&b->lock);
}

void cwi_beside_wait(cwi_beside *b)
{
    pthread_mutex_lock(&b->lock);
    while (!b->own_ended)
        pthread_cond_wait(&b->ended, &b->lock);
    pthread_mutex_unlock(&b->lock);
}
