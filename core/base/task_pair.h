/* Two pieces of work at the same time, the second of which waits for the verdict of the first. */
#ifndef CORE_BASE_TASK_PAIR_H
#define CORE_BASE_TASK_PAIR_H

#include <pthread.h>
#include <stdbool.h>

/* A zeroed struct is valid. */
typedef struct cwi_task_pair {
    void (*second)(void *context);
    void *context;
    pthread_mutex_t lock;
    pthread_cond_t ended;
    bool first_ended; /* behind the lock */
} cwi_task_pair;

/* Runs first(context) on the calling thread and second(context) on another thread; returns
 * after both. Where no thread can be made, runs both here. */
void cwi_task_pair_run(cwi_task_pair *pair, void (*first)(void *context),
                       void (*second)(void *context), void *context);

/* Waits, in the second task, until the first has returned. */
void cwi_task_pair_wait(cwi_task_pair *pair);

#endif
