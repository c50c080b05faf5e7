/* Parallel loops over the layers of a volume, or over chunks of anything. */
#ifndef CORE_BASE_PARALLEL_H
#define CORE_BASE_PARALLEL_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Runs work(context, k) for every layer k, each once, and polls progress on the calling thread.
 * Within such a loop another one runs on the thread that starts it.
 *
 * layer_size  samples in a layer: unless a number of threads is requested, none are woken for
 *             work that one thread does in a moment
 * threads     0 means the default number
 * Returns     CW_OK, or CW_ERR_CANCELLED: then some layers were left out */
CW_NODISCARD cw_status cwi_parallel_for(size_t layers, size_t layer_size, int threads,
                                        const cw_progress *progress, const char *step,
                                        void (*work)(void *context, size_t k), void *context,
                                        cw_error *err);

/* Does the same without progress: all layers are done. */
void cwi_parallel_for_all(size_t layers, size_t layer_size, int threads,
                          void (*work)(void *context, size_t k), void *context);

/* Returns the number of the thread within the loop that it works on: below cwi_threads() of the
 * threads that the loop was given, and 0 on the calling thread. */
int cwi_thread_number(void);

/* Sets a flag that several threads may set. It is read when their loop has ended. */
static inline void cwi_set_flag(bool *flag)
{
    __atomic_store_n(flag, true, __ATOMIC_RELAXED);
}

#ifdef __cplusplus
}
#endif

#endif
