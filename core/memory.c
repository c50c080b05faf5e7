#define _DEFAULT_SOURCE /* madvise */
#include "core/memory.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

/* Per thread, so that a test that starves itself starves no one else. */
static _Thread_local long allocations_left = -1;
static _Thread_local bool one_failed;

bool cwi_alloc_fail_after(long n)
{
    const bool failed = one_failed;
    one_failed = false;
    allocations_left = n;
    return failed;
}

static bool starved(void)
{
    if (allocations_left < 0)
        return false;
    if (allocations_left > 0) {
        allocations_left--;
        return false;
    }
    one_failed = true;
    return true;
}

bool cwi_size_mul(size_t a, size_t b, size_t *out)
{
    size_t product;
    if (__builtin_mul_overflow(a, b, &product))
        return false;
    *out = product;
    return true;
}

bool cwi_size_add(size_t a, size_t b, size_t *out)
{
    size_t sum;
    if (__builtin_add_overflow(a, b, &sum))
        return false;
    *out = sum;
    return true;
}

/* Sizes beyond PTRDIFF_MAX cannot be indexed; malloc refuses them, and compilers warn. */
static bool usable(size_t count, size_t size, size_t *bytes)
{
    return cwi_size_mul(count, size, bytes) && *bytes <= PTRDIFF_MAX && !starved();
}

void *cwi_alloc_array(size_t count, size_t size)
{
    size_t bytes;
    return usable(count, size, &bytes) ? malloc(bytes ? bytes : 1) : NULL;
}

void *cwi_alloc_zeroed(size_t count, size_t size)
{
    size_t bytes;
    return usable(count, size, &bytes) ? calloc(bytes ? bytes : 1, 1) : NULL;
}

void *cwi_alloc_large(size_t count, size_t size)
{
    const size_t page = (size_t)2 << 20, least = 2 * page;
    size_t bytes;
    if (!usable(count, size, &bytes))
        return NULL;
    if (bytes < least || bytes > PTRDIFF_MAX - page)
        return malloc(bytes ? bytes : 1);
    bytes = (bytes + page - 1) / page * page;
    void *memory = aligned_alloc(page, bytes);
#ifdef MADV_HUGEPAGE
    if (memory)
        madvise(memory, bytes, MADV_HUGEPAGE); /* a wish: no harm if it is not granted */
#endif
    return memory;
}

void *cwi_realloc_array(void *memory, size_t count, size_t size)
{
    size_t bytes;
    return usable(count, size, &bytes) ? realloc(memory, bytes ? bytes : 1) : NULL;
}

void cwi_free(void *memory)
{
    free(memory);
}

char *cwi_strdup(const char *text)
{
    const size_t bytes = strlen(text) + 1;
    char *copy = cwi_alloc_array(bytes, 1);
    return copy ? memcpy(copy, text, bytes) : NULL;
}
