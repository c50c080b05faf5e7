/* Runs two pieces of work at the same time, on the calling thread and on another one. */
#include "core/base/task_pair.h"

#include "core/base/thread_pool.h"

static void *run_second(void *context)
{
    const cwi_task_pair *p = context;
    p->second(p->context);
    return NULL;
}

static void report_ended(cwi_task_pair *p)
{
    pthread_mutex_lock(&p->lock);
    p->first_ended = true;
    pthread_cond_broadcast(&p->ended);
    pthread_mutex_unlock(&p->lock);
}

void cwi_task_pair_run(cwi_task_pair *p, void (*first)(void *context),
                       void (*second)(void *context), void *context)
{
    pthread_t thread;
    *p = (cwi_task_pair){.second = second, .context = context};
    pthread_mutex_init(&p->lock, NULL);
    pthread_cond_init(&p->ended, NULL);
    const bool started = cwi_start_thread(&thread, run_second, p);
    first(context);
    report_ended(p);
    if (started)
        pthread_join(thread, NULL);
    else
        second(context);
    pthread_cond_destroy(&p->ended);
    pthread_mutex_destroy(&p->lock);
}

void cwi_task_pair_wait(cwi_task_pair *p)
{
    pthread_mutex_lock(&p->lock);
    while (!p->first_ended)
        pthread_cond_wait(&p->ended, &p->lock);
    pthread_mutex_unlock(&p->lock);
}
