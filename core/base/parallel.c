/* Runs work on the layers of a volume in parallel, with progress reports and cancellation. */
#include "core/base/parallel.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/thread_pool.h"

#include <assert.h>
#include <stdatomic.h>

/* The loop that a thread works on. */
static _Thread_local struct {
    bool is_inside;
    int number; /* of the thread in it */
} loop;

int cwi_thread_number(void)
{
    return loop.number;
}

typedef struct layer_job {
    void (*work)(void *context, size_t k);
    void *context;
    size_t layers, turn; /* turn: how many a thread takes at a time */
    atomic_size_t next;
    atomic_bool is_stopped;
    const cw_progress *progress; /* of the calling thread */
    const char *step;
    cw_status status;
    cw_error *err;
} layer_job;

static void report_layer(layer_job *j, size_t layer)
{
    j->status = cwi_progress(j->progress, j->step, (double)layer / (double)j->layers, j->err);
    if (j->status != CW_OK)
        atomic_store(&j->is_stopped, true);
}

/* Works on layers until none is left. */
static void run_items(void *context, int number)
{
    layer_job *j = context;
    const bool was_inside = loop.is_inside;
    const int outer_number = loop.number;
    loop.is_inside = true;
    loop.number = number;
    while (!atomic_load_explicit(&j->is_stopped, memory_order_relaxed)) {
        const size_t begin = atomic_fetch_add_explicit(&j->next, j->turn, memory_order_relaxed);
        if (begin >= j->layers)
            break;
        if (number == 0 && begin > 0)
            report_layer(j, begin);
        for (size_t k = begin; k < begin + j->turn && k < j->layers; k++)
            if (!atomic_load_explicit(&j->is_stopped, memory_order_relaxed)) {
                j->work(j->context, k);
                cwi_memory_trim();
            }
    }
    loop.is_inside = was_inside;
    loop.number = outer_number;
}

/* Returns the requested number of threads, or as many as there are enough samples for. */
static int choose_threads(size_t layers, size_t layer_size, int requested)
{
    enum { SAMPLES_PER_THREAD = 1 << 19 }; /* samples that are worth one thread */
    if (loop.is_inside)
        return 1;
    size_t threads = (size_t)cwi_threads(requested);
    const size_t max_threads = layers * layer_size / SAMPLES_PER_THREAD + 1;
    if (requested <= 0 && max_threads < threads)
        threads = max_threads;
    return (int)(layers < threads && layers > 0 ? layers : threads);
}

/* Runs the layers. A thread takes a few neighbouring layers at a time: they share samples, and
 * short turns keep the threads busy to the end. When the calling thread has run out of layers, it
 * keeps polling the caller's progress, since the other threads may take long. */
cw_status cwi_parallel_for(size_t layers, size_t layer_size, int threads,
                           const cw_progress *progress, const char *step,
                           void (*work)(void *context, size_t k), void *context, cw_error *err)
{
    enum { TURNS = 16, MAX_TURN = 8 };
    static const double POLL_S = 0.1; /* between two reports of progress */
    threads = choose_threads(layers, layer_size, threads);
    size_t turn = layers / ((size_t)threads * TURNS);
    turn = turn < 1 ? 1 : turn > MAX_TURN ? MAX_TURN : turn;
    layer_job j = {.work = work,
                   .context = context,
                   .layers = layers,
                   .turn = turn,
                   .progress = progress,
                   .step = step,
                   .err = err};
    if (layers > 0)
        report_layer(&j, 0);
    if (threads < 2 || layers == 0 || j.status != CW_OK) {
        run_items(&j, 0);
        return j.status;
    }
    cwi_job others;
    cwi_job_start(&others, threads, run_items, &j);
    run_items(&j, 0);
    cwi_job_close(&others);
    while (!cwi_job_is_lost(&others)) {
        if (cwi_job_wait(&others, progress->report && j.status == CW_OK ? POLL_S : -1))
            return j.status;
        report_layer(&j, layers);
    }
    return cwi_fail(err, CW_ERR_CANCELLED,
                    "this process was forked while %s: the other threads are not in it", step);
}

void cwi_parallel_for_all(size_t layers, size_t layer_size, int threads,
                          void (*work)(void *context, size_t k), void *context)
{
    static const cw_progress none = {0};
    const cw_status st =
        cwi_parallel_for(layers, layer_size, threads, &none, "", work, context, NULL);
    assert(st == CW_OK); /* only a progress stops the loop */
    (void)st;
}
