/* Two pieces of work at the same time, the second of which waits for the verdict of the first. */
#ifndef CORE_BASE_BESIDE_H
#define CORE_BASE_BESIDE_H

#include <pthread.h>
#include <stdbool.h>

/* A zeroed struct is valid. */
typedef struct cwi_beside {
    void (*aside)(void *context);
    void *context;
    pthread_mutex_t lock;
    pthread_cond_t ended;
    bool own_ended; /* behind the lock */
} cwi_beside;

/* Runs own(context) on the calling thread and aside(context) on another one; returns after both.
 * Where no thread can be made, runs them here, own first. */
void cwi_beside_run(cwi_beside *beside, void (*own)(void *context),
                    void (*aside)(void *context), void *context);

/* Waits, in aside, until own has returned. */
void cwi_beside_wait(cwi_beside *beside);

#endif
