/* Bytes that a thread of its own produces ahead of their reader. */
#ifndef CORE_BASE_READ_AHEAD_H
#define CORE_BASE_READ_AHEAD_H

#include <cubewright/core.h>

/* Puts up to size bytes at `to`; *got is less only where they end. */
typedef cw_status cwi_produce(void *context, void *to, size_t size, size_t *got, cw_error *err);

typedef struct cwi_ahead cwi_ahead;

/* Starts a thread that produces some buffers ahead. context is the thread's until the stop.
 * Returns NULL where there is no memory, or no thread: then nothing was produced. */
cwi_ahead *cwi_ahead_start(cwi_produce *produce, void *context);

/* Takes up to size bytes, and waits for them; *got is less only where they end.
 * Returns what failed producing, once all bytes before were taken; CW_ERR_CANCELLED in a process
 * that was forked off meanwhile, and has no such thread. */
CW_NODISCARD cw_status cwi_ahead_take(cwi_ahead *a, void *to, size_t size, size_t *got,
                                      cw_error *err);

/* Ends the thread, and frees. Bytes that were not taken are lost. NULL is harmless. */
void cwi_ahead_stop(cwi_ahead *a);

#endif
