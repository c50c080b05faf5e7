/* Lets a thread produce bytes into a ring of buffers while another one takes them. */
#include "core/base/read_ahead.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/thread_pool.h"

#include <string.h>
#include <unistd.h>

enum { BUFFERS = 4, BUFFER_BYTES = 256 << 10 };

struct cwi_ahead {
    cwi_produce *produce;
    void *context;
    unsigned char *bytes;         /* of all buffers */
    size_t sizes[BUFFERS], taken; /* taken: of the first buffer */
    size_t produced, released;    /* buffers so far; behind the lock */
    bool is_ended, is_stopped;    /* behind the lock */
    cw_status status;             /* why it ended; final when is_ended is set */
    cw_error error;
    pid_t process;
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t changed;
};

/* Waits for an empty buffer; returns false when nobody wants more. */
static bool await_empty(cwi_ahead *a)
{
    pthread_mutex_lock(&a->lock);
    while (!a->is_stopped && a->produced - a->released == BUFFERS)
        pthread_cond_wait(&a->changed, &a->lock);
    const bool is_wanted = !a->is_stopped;
    pthread_mutex_unlock(&a->lock);
    return is_wanted;
}

static void *produce_all(void *of)
{
    cwi_ahead *a = of;
    for (bool is_ended = false; !is_ended && await_empty(a);) {
        const size_t n = a->produced % BUFFERS;
        a->sizes[n] = 0;
        a->status = a->produce(a->context, a->bytes + n * BUFFER_BYTES, BUFFER_BYTES,
                               &a->sizes[n], &a->error);
        is_ended = a->status != CW_OK || a->sizes[n] < BUFFER_BYTES;
        pthread_mutex_lock(&a->lock);
        a->produced++;
        a->is_ended = is_ended;
        pthread_cond_broadcast(&a->changed);
        pthread_mutex_unlock(&a->lock);
    }
    return NULL;
}

cwi_ahead *cwi_ahead_start(cwi_produce *produce, void *context)
{
    cwi_ahead *a = cwi_alloc_zeroed(1, sizeof *a);
    if (!a)
        return NULL;
    a->produce = produce;
    a->context = context;
    a->process = getpid();
    a->bytes = cwi_alloc_array(BUFFERS, BUFFER_BYTES);
    pthread_mutex_init(&a->lock, NULL);
    pthread_cond_init(&a->changed, NULL);
    if (a->bytes && cwi_start_thread(&a->thread, produce_all, a))
        return a;
    pthread_cond_destroy(&a->changed);
    pthread_mutex_destroy(&a->lock);
    cwi_free(a->bytes);
    cwi_free(a);
    return NULL;
}

/* Waits for a buffer with bytes; returns false where they have ended. */
static bool await_bytes(cwi_ahead *a)
{
    pthread_mutex_lock(&a->lock);
    while (a->produced == a->released && !a->is_ended)
        pthread_cond_wait(&a->changed, &a->lock);
    const bool has_bytes = a->produced != a->released;
    pthread_mutex_unlock(&a->lock);
    return has_bytes;
}

static void release_buffer(cwi_ahead *a)
{
    a->taken = 0;
    pthread_mutex_lock(&a->lock);
    a->released++;
    pthread_cond_broadcast(&a->changed);
    pthread_mutex_unlock(&a->lock);
}

cw_status cwi_ahead_take(cwi_ahead *a, void *to, size_t size, size_t *got, cw_error *err)
{
    *got = 0;
    if (a->process != getpid())
        return cwi_fail(
            err, CW_ERR_CANCELLED,
            "this process was forked while reading: its other threads are not in it");
    while (*got < size && await_bytes(a)) {
        const size_t n = a->released % BUFFERS, left = a->sizes[n] - a->taken;
        const size_t count = left < size - *got ? left : size - *got;
        memcpy((unsigned char *)to + *got, a->bytes + n * BUFFER_BYTES + a->taken, count);
        a->taken += count;
        *got += count;
        if (a->taken == a->sizes[n])
            release_buffer(a);
    }
    if (*got == size || a->status == CW_OK)
        return CW_OK;
    if (err)
        *err = a->error;
    return a->status;
}

void cwi_ahead_stop(cwi_ahead *a)
{
    if (!a)
        return;
    if (a->process == getpid()) {
        pthread_mutex_lock(&a->lock);
        a->is_stopped = true;
        pthread_cond_broadcast(&a->changed);
        pthread_mutex_unlock(&a->lock);
        pthread_join(a->thread, NULL);
        pthread_cond_destroy(&a->changed);
        pthread_mutex_destroy(&a->lock);
    }
    cwi_free(a->bytes);
    cwi_free(a);
}
