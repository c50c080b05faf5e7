/* Runs work on the layers of a volume in parallel (OpenMP), with progress reports and
 * cancellation. */
#define _GNU_SOURCE /* clock_gettime */
#include "core/base/parallel.h"

#include "core/base/status.h"

#include <omp.h>
#include <pthread.h>
#include <time.h>

/* Returns the requested number of threads, or as many as there are enough samples for. */
static int choose_threads(size_t layers, size_t layer_size, int asked)
{
    enum { SHARE = 1 << 19 }; /* samples that are worth one thread */
    const size_t shares = layers * layer_size / SHARE + 1;
    const int threads = cwi_threads(asked);
    return asked <= 0 && shares < (size_t)threads ? (int)shares : threads;
}

/* Counts the threads that have run out of layers. */
typedef struct finishers {
    pthread_mutex_t lock;
    pthread_cond_t more;
    int count;
} finishers;

static void finish_thread(finishers *f)
{
    pthread_mutex_lock(&f->lock);
    f->count++;
    pthread_cond_signal(&f->more);
    pthread_mutex_unlock(&f->lock);
}

/* Waits up to 0.1 s for `count` threads; true when all have finished. */
static bool wait_for_threads(finishers *f, int count)
{
    struct timespec until;
    clock_gettime(CLOCK_REALTIME, &until);
    until.tv_nsec += 100000000;
    until.tv_sec += until.tv_nsec / 1000000000;
    until.tv_nsec %= 1000000000;
    pthread_mutex_lock(&f->lock);
    while (f->count < count && pthread_cond_timedwait(&f->more, &f->lock, &until) == 0)
        ;
    const bool finished = f->count == count;
    pthread_mutex_unlock(&f->lock);
    return finished;
}

/* Runs the layers. A thread takes a few neighbouring layers at a time: they share samples, and
 * short chunks keep the threads busy to the end. There is one parallel region for all layers.
 * Waking and joining threads for every few layers cost more than it balanced. When the calling
 * thread has run out of layers, it keeps polling the caller's progress, since the other threads
 * may take long. */
cw_status cwi_each_layer(size_t layers, size_t layer_size, int threads,
                         const cw_progress *progress, const char *step,
                         void (*work)(void *context, size_t k), void *context, cw_error *err)
{
    threads = choose_threads(layers, layer_size, threads);
    const size_t share = layers / ((size_t)threads * 16);
    const size_t turn = share < 1 ? 1 : share > 8 ? 8 : share;
    cw_status st = CW_OK;
    size_t next = 0;
    bool stop = false;
    finishers others = {PTHREAD_MUTEX_INITIALIZER, PTHREAD_COND_INITIALIZER, 0};
#pragma omp parallel num_threads(threads) if (threads > 1)
    {
        const bool asks = omp_get_thread_num() == 0;
        for (bool stopped = false; !stopped;) {
            size_t begin;
#pragma omp atomic capture
            {
                begin = next;
                next += turn;
            }
            if (begin >= layers)
                break;
            if (asks) {
                st = cwi_progress(progress, step, (double)begin / (double)layers, err);
                if (st != CW_OK) {
#pragma omp atomic write
                    stop = true;
                }
            }
#pragma omp atomic read
            stopped = stop;
            for (size_t k = begin; k < begin + turn && k < layers && !stopped; k++)
                work(context, k);
        }
        if (!asks && progress->report)
            finish_thread(&others);
        while (asks && progress->report && st == CW_OK &&
               !wait_for_threads(&others, omp_get_num_threads() - 1))
            st = cwi_progress(progress, step, 1, err);
        if (asks && st != CW_OK) {
#pragma omp atomic write
            stop = true;
        }
    }
    pthread_cond_destroy(&others.more);
    pthread_mutex_destroy(&others.lock);
    return st;
}
