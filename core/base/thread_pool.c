/* Makes threads, lets them sleep, and shares them out among the jobs of all calling threads. */
#define _GNU_SOURCE /* sched_getaffinity */
#include "core/base/thread_pool.h"

#include "core/base/clock.h"

#include <math.h>
#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#include <time.h>

struct cwi_thread_pool {
    pthread_mutex_t lock; /* for all that is not atomic */
    pthread_cond_t has_work;
    cwi_job *jobs; /* those with free seats */
    int threads;   /* that exist, or are being made */
    int working;   /* of these, on a job */
    atomic_uint forks;
    atomic_int processors, default_threads, granted;
};

static cwi_thread_pool own_pool = {.lock = PTHREAD_MUTEX_INITIALIZER,
                                   .has_work = PTHREAD_COND_INITIALIZER};

/* The pool of this process. Threads may load a module at the same time: each shares the same pool
 * with it. */
static _Atomic(cwi_thread_pool *) pool = &own_pool;

cwi_thread_pool *cwi_thread_pool_get(void)
{
    return pool;
}

void cwi_thread_pool_share(cwi_thread_pool *of_the_program)
{
    pool = of_the_program;
}

/* --- forks --------------------------------------------------------------------------------- */

/* A forked process has the thread that forked and no other. */
static void forget_threads(void)
{
    static const pthread_mutex_t unlocked = PTHREAD_MUTEX_INITIALIZER;
    static const pthread_cond_t unused = PTHREAD_COND_INITIALIZER;
    cwi_thread_pool *p = pool;
    p->lock = unlocked;
    p->has_work = unused;
    p->jobs = NULL;
    p->threads = p->working = 0;
    atomic_fetch_add(&p->forks, 1);
}

static void watch_forks(void)
{
    pthread_atfork(NULL, NULL, forget_threads);
}

bool cwi_job_is_lost(const cwi_job *job)
{
    cwi_thread_pool *p = pool;
    return job->forks != atomic_load(&p->forks);
}

/* --- the threads --------------------------------------------------------------------------- */

static void unlist_job(cwi_thread_pool *p, const cwi_job *job)
{
    cwi_job **at = &p->jobs;
    while (*at && *at != job)
        at = &(*at)->next;
    if (*at)
        *at = job->next;
}

/* Joins a job, and works on it until it is done. */
static void join_job(cwi_thread_pool *p, cwi_job *job)
{
    const int number = ++job->joined;
    job->working++;
    p->working++;
    if (--job->free_seats == 0)
        unlist_job(p, job);
    pthread_mutex_unlock(&p->lock);
    fesetenv(&job->floats);
    job->run(job->context, number);
    pthread_mutex_lock(&p->lock);
    p->working--;
    if (--job->working == 0)
        pthread_cond_signal(&job->finished);
}

static void *serve_jobs(void *of)
{
    cwi_thread_pool *p = of;
    pthread_mutex_lock(&p->lock);
    for (;;) {
        while (!p->jobs)
            pthread_cond_wait(&p->has_work, &p->lock);
        join_job(p, p->jobs);
    }
    return NULL;
}

/* Stacks of threads are as large as the limit of the first one's, which may be too low. */
static void ask_for_stack(pthread_attr_t *attributes)
{
    enum { LEAST_BYTES = 1 << 20 };
    size_t bytes;
    if (pthread_attr_getstacksize(attributes, &bytes) == 0 && bytes < LEAST_BYTES)
        pthread_attr_setstacksize(attributes, LEAST_BYTES);
}

bool cwi_start_thread(pthread_t *thread, void *(*run)(void *context), void *context)
{
    static const int faults[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGTRAP, SIGSYS, SIGPROF};
    sigset_t blocked, before;
    sigfillset(&blocked);
    for (size_t n = 0; n < sizeof faults / sizeof *faults; n++)
        sigdelset(&blocked, faults[n]);
    if (pthread_sigmask(SIG_SETMASK, &blocked, &before) != 0)
        return false;
    pthread_attr_t attributes;
    bool is_started = pthread_attr_init(&attributes) == 0;
    if (is_started) {
        ask_for_stack(&attributes);
        is_started = pthread_create(thread, &attributes, run, context) == 0;
        pthread_attr_destroy(&attributes);
    }
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return is_started;
}

/* Makes a thread that nobody joins. */
static bool make_thread(cwi_thread_pool *p)
{
    pthread_t thread;
    return cwi_start_thread(&thread, serve_jobs, p) && pthread_detach(thread) == 0;
}

/* Makes threads that were counted already; corrects the count when the system gives fewer. */
static void make_threads(cwi_thread_pool *p, int count)
{
    while (count > 0 && make_thread(p))
        count--;
    if (count == 0)
        return;
    pthread_mutex_lock(&p->lock);
    p->threads -= count;
    atomic_store(&p->granted, p->threads + 1);
    pthread_mutex_unlock(&p->lock);
}

/* Returns how many threads to make for all free seats. */
static int count_missing(const cwi_thread_pool *p)
{
    const int idle = p->threads - p->working, max_new = CWI_MAX_THREADS - 1 - p->threads;
    int seats = 0;
    for (const cwi_job *job = p->jobs; job; job = job->next)
        seats += job->free_seats;
    const int missing = seats > idle ? seats - idle : 0;
    return missing < max_new ? missing : max_new;
}

/* --- jobs ---------------------------------------------------------------------------------- */

void cwi_job_start(cwi_job *job, int threads, void (*run)(void *context, int number),
                   void *context)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    cwi_thread_pool *p = pool;
    *job = (cwi_job){.run = run, .context = context, .free_seats = threads - 1};
    pthread_once(&once, watch_forks);
    job->forks = atomic_load(&p->forks);
    pthread_condattr_t clock;
    pthread_condattr_init(&clock);
    pthread_condattr_setclock(&clock, CLOCK_MONOTONIC);
    pthread_cond_init(&job->finished, &clock);
    pthread_condattr_destroy(&clock);
    fegetenv(&job->floats);

    pthread_mutex_lock(&p->lock);
    const int idle = p->threads - p->working;
    job->next = p->jobs;
    p->jobs = job;
    const int missing = count_missing(p);
    p->threads += missing;
    if (idle > 0 && idle <= job->free_seats)
        pthread_cond_broadcast(&p->has_work);
    for (int n = 0; n < job->free_seats && idle > job->free_seats; n++)
        pthread_cond_signal(&p->has_work);
    pthread_mutex_unlock(&p->lock);
    make_threads(p, missing);
}

void cwi_job_close(cwi_job *job)
{
    cwi_thread_pool *p = pool;
    if (cwi_job_is_lost(job))
        return;
    pthread_mutex_lock(&p->lock);
    unlist_job(p, job);
    pthread_mutex_unlock(&p->lock);
}

static struct timespec add_seconds(double seconds)
{
    const double at = cwi_now_s() + seconds;
    return (struct timespec){.tv_sec = (time_t)at, .tv_nsec = (long)(1e9 * (at - floor(at)))};
}

bool cwi_job_wait(cwi_job *job, double seconds)
{
    cwi_thread_pool *p = pool;
    const struct timespec until = add_seconds(seconds > 0 ? seconds : 0);
    int late = 0;
    pthread_mutex_lock(&p->lock);
    while (job->working > 0 && late == 0)
        late = seconds < 0 ? pthread_cond_wait(&job->finished, &p->lock)
                           : pthread_cond_timedwait(&job->finished, &p->lock, &until);
    const bool is_done = job->working == 0;
    pthread_mutex_unlock(&p->lock);
    if (is_done)
        pthread_cond_destroy(&job->finished);
    return is_done;
}

/* --- how many ------------------------------------------------------------------------------ */

/* Returns the number of processors that this process may use. */
static int count_processors(void)
{
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) == 0)
        return CPU_COUNT(&set);
    return CWI_MAX_THREADS; /* more than a set holds */
}

void cwi_set_default_threads(int threads)
{
    cwi_thread_pool *p = pool;
    atomic_store(&p->default_threads, threads);
}

int cwi_threads(int requested)
{
    cwi_thread_pool *p = pool;
    if (requested <= 0)
        requested = atomic_load(&p->default_threads);
    if (requested <= 0)
        requested = atomic_load(&p->processors);
    if (requested <= 0) {
        requested = count_processors();
        atomic_store(&p->processors, requested);
    }
    if (requested <= CWI_MAX_THREADS)
        return requested;
    atomic_store(&p->granted, CWI_MAX_THREADS);
    return CWI_MAX_THREADS;
}

static void *pass_gate(void *gate)
{
    pthread_mutex_lock(gate);
    pthread_mutex_unlock(gate);
    return NULL;
}

int cwi_try_threads(int count)
{
    pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;
    pthread_t threads[CWI_MAX_THREADS];
    int made = 0;
    count = count < CWI_MAX_THREADS ? count : CWI_MAX_THREADS;
    pthread_mutex_lock(&gate); /* they are there at the same time */
    while (made < count && cwi_start_thread(&threads[made], pass_gate, &gate))
        made++;
    pthread_mutex_unlock(&gate);
    for (int n = 0; n < made; n++)
        pthread_join(threads[n], NULL);
    pthread_mutex_destroy(&gate);
    return made;
}

int cwi_granted_threads(void)
{
    cwi_thread_pool *p = pool;
    return atomic_load(&p->granted);
}
