/* Parallel work on a volume, layer by layer. */
#ifndef CORE_BASE_PARALLEL_H
#define CORE_BASE_PARALLEL_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Runs work(context, k) for every layer k, each once, and polls progress on the calling thread.
 *
 * layer_size  samples in a layer: unless a number of threads is requested, none are woken for
 *             work that one thread does in a moment
 * threads     0 means all
 * Returns     CW_OK, or CW_ERR_CANCELLED: then some layers were left out */
CW_NODISCARD cw_status cwi_each_layer(size_t layers, size_t layer_size, int threads,
                                      const cw_progress *progress, const char *step,
                                      void (*work)(void *context, size_t k), void *context,
                                      cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
