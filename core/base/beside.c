/* Runs two pieces of work at the same time, on the calling thread and on another one. */
#include "core/base/beside.h"

#include "core/base/thread_pool.h"

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

void cwi_beside_run(cwi_beside *b, void (*own)(void *context), void (*aside)(void *context),
                    void *context)
{
    pthread_t thread;
    *b = (cwi_beside){.aside = aside, .context = context};
    pthread_mutex_init(&b->lock, NULL);
    pthread_cond_init(&b->ended, NULL);
    const bool started = cwi_start_thread(&thread, run_aside, b);
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
