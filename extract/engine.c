#include "extract/engine.h"

#include "core/status.h"

#include <omp.h>

static bool always(void)
{
    return true;
}

#ifdef CWI_X86
static bool has_avx2(void)
{
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") &&
           __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("popcnt");
}

static bool has_avx512(void)
{
    return has_avx2() && __builtin_cpu_supports("avx512f") &&
           __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vbmi") &&
           __builtin_cpu_supports("avx512vbmi2") && __builtin_cpu_supports("avx512vpopcntdq") &&
           __builtin_cpu_supports("gfni");
}
#define ENGINES(X)                                                                             \
    X(plain, always)                                                                           \
    X(avx2, has_avx2)                                                                          \
    X(avx512, has_avx512)
#else
#define ENGINES(X) X(plain, always)
#endif

#define DECLARE(engine, test)                                                                  \
    void cwi_classify_layer_##engine(const cwi_grid *, size_t, bool *, bool *);                \
    void cwi_count_layer_##engine(const cwi_grid *, size_t, cwi_row *);                        \
    void cwi_write_layer_##engine(const cwi_grid *, size_t, const cwi_row *,                   \
                                  const cwi_emission *, cwi_vertex_sink *, uint32_t *);
ENGINES(DECLARE)

static const cwi_engine engines[] = {
#define ROW(engine, test)                                                                      \
    {#engine, test, cwi_classify_layer_##engine, cwi_count_layer_##engine,                     \
     cwi_write_layer_##engine},
    ENGINES(ROW)
#undef ROW
};

const cwi_engine *cwi_engine_at(size_t n)
{
    for (size_t e = 0; e < sizeof engines / sizeof *engines; e++)
        if (engines[e].usable() && n-- == 0)
            return &engines[e];
    return NULL;
}

const cwi_engine *cwi_engine_best(void)
{
    const cwi_engine *best = NULL, *next;
    for (size_t n = 0; (next = cwi_engine_at(n)); n++)
        best = next;
    return best;
}

/* A thread takes a few neighbouring layers at a time: they share samples, and short turns keep
 * the threads busy to the end. One region for all layers: waking and joining threads for every
 * few layers cost more than it balanced. */
cw_status cwi_each_layer(size_t layers, size_t layer_size, const cw_extract_desc *desc,
                         const char *step, void (*work)(void *context, size_t k), void *context,
                         cw_error *err)
{
    const int threads = cwi_pace_of(layers, layer_size, desc->threads).threads;
    const size_t share = layers / ((size_t)threads * 16), turn = share < 1   ? 1
                                                                 : share > 8 ? 8
                                                                             : share;
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
            st = cwi_progress(&desc->progress, step, (double)begin / (double)layers, err);
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
