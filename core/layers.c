#include "core/layers.h"

#include "core/status.h"

#include <omp.h>

/* As many threads as are asked for, or as there are enough samples for. */
static int choose_threads(size_t layers, size_t layer_size, int asked)
{
    enum { SHARE = 1 << 19 }; /* samples worth a thread */
    const size_t shares = layers * layer_size / SHARE + 1;
    const int threads = cwi_threads(asked);
    return asked <= 0 && shares < (size_t)threads ? (int)shares : threads;
}

/* A thread takes a few neighbouring layers at a time: they share samples, and short turns keep
 * the threads busy to the end. One region for all layers: waking and joining threads for every
 * few layers cost more than it balanced. */
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
#pragma omp parallel num_threads(threads) if (threads > 1)
    for (bool stopped = false; !stopped;) {
        size_t begin;
#pragma omp atomic capture
        {
            begin = next;
            next += turn;
        }
        if (begin >= layers)
            break;
        if (omp_get_thread_num() == 0) {
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
    return st;
}
