/* Threads that sleep until a loop wants them. They are made when first needed, and stay. */
#ifndef CORE_BASE_THREAD_POOL_H
#define CORE_BASE_THREAD_POOL_H

#include <cubewright/core.h>

#include <fenv.h>
#include <pthread.h>

#ifdef __cplusplus
extern "C" {
#endif

/* No call uses more threads than this: each costs a stack, and callers keep scratch for each. */
enum { CWI_MAX_THREADS = 1024 };

/* The pool of a process. A module has a copy of this code, and shares the pool of the program that
 * loads it. */
typedef struct cwi_thread_pool cwi_thread_pool;
cwi_thread_pool *cwi_thread_pool_get(void);
void cwi_thread_pool_share(cwi_thread_pool *of_the_program);

/* A job that threads of the pool may join. It stands on the stack of the thread that starts it,
 * which works on it, too. A thread that wakes up late does not join: nobody waits for it. */
typedef struct cwi_job {
    void (*run)(void *context, int number); /* number: from 1, another for each thread */
    void *context;
    int free_seats, joined, working;
    unsigned forks;
    fenv_t floats; /* how the starting thread rounds; so do the others */
    pthread_cond_t finished;
    struct cwi_job *next;
} cwi_job;

/* Starts a job of two or more threads: all but the calling one may join it. Where the system gives
 * fewer threads, fewer do. */
void cwi_job_start(cwi_job *job, int threads, void (*run)(void *context, int number),
                   void *context);

/* Lets no more threads join. */
void cwi_job_close(cwi_job *job);

/* Waits for the threads that have joined a closed job: up to some seconds, or without a limit
 * when they are below 0. Returns true when none works any more; the job has ended then. */
bool cwi_job_wait(cwi_job *job, double seconds);

/* Returns true in a process that was forked off while the job was under way. The threads that had
 * joined it do not exist there. */
bool cwi_job_is_lost(const cwi_job *job);

/* Sets the number of threads of calls that request none; 0 means one per processor of this
 * process. For the command; not while calls are running. */
void cwi_set_default_threads(int threads);

/* Returns the number of threads that a desc requests: the default number for 0 or less. It is the
 * same in all calls of a process. */
int cwi_threads(int requested);

/* Returns how many threads could be had when more were requested; 0 means always enough. */
int cwi_granted_threads(void);

/* Starts a thread that takes no signals but faults of its own: those that a program handles go to
 * its other threads. Returns false when the system gives none. */
bool cwi_start_thread(pthread_t *thread, void *(*run)(void *context), void *context);

/* Returns how many threads beyond those there are could be made now, up to `count`. For libraries
 * that make their own, and end the process when they get none. */
int cwi_try_threads(int count);

#ifdef __cplusplus
}
#endif

#endif
