#define _DEFAULT_SOURCE /* madvise */
#include "core/memory.h"

#ifdef __linux__
#include <malloc.h>
#endif
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>

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

enum { LARGE_PAGE = 2 << 20 };

/* Asks for large pages where whole ones lie in large memory: no harm if they are not granted.
 */
static void wish_large_pages(char *memory, size_t bytes)
{
#ifdef MADV_HUGEPAGE
    const size_t skip = -(uintptr_t)memory % LARGE_PAGE;
    if (memory && bytes >= 2 * (size_t)LARGE_PAGE)
        madvise(memory + skip, (bytes - skip) / LARGE_PAGE * LARGE_PAGE, MADV_HUGEPAGE);
#else
    (void)memory, (void)bytes;
#endif
}

void *cwi_alloc_array(size_t count, size_t size)
{
    size_t bytes;
    return usable(count, size, &bytes) ? malloc(bytes ? bytes : 1) : NULL;
}

void *cwi_alloc_zeroed(size_t count, size_t size)
{
    size_t bytes;
    if (!usable(count, size, &bytes))
        return NULL;
    char *memory = calloc(bytes ? bytes : 1, 1);
    wish_large_pages(memory, bytes);
    return memory;
}

void *cwi_alloc_large(size_t count, size_t size)
{
    const size_t page = LARGE_PAGE;
    size_t bytes;
    if (!usable(count, size, &bytes))
        return NULL;
    if (bytes < 2 * page || bytes > PTRDIFF_MAX - page)
        return malloc(bytes ? bytes : 1);
    bytes = (bytes + page - 1) / page * page;
    void *memory = aligned_alloc(page, bytes);
    wish_large_pages(memory, bytes);
    return memory;
}

/* The bytes that allocated memory has; 0: not known. */
static size_t room_of(void *memory)
{
#ifdef __linux__
    return malloc_usable_size(memory);
#else
    (void)memory;
    return 0;
#endif
}

void *cwi_renew_large(void *memory, size_t count, size_t size)
{
    const size_t room = room_of(memory), more = memory ? count / 8 : 0;
    size_t bytes;
    if (memory && usable(count, size, &bytes) && bytes <= room && bytes >= room / 2)
        return memory;
    free(memory);
    return cwi_alloc_large(count + more, size);
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

bool cwi_memory_is_limited(void)
{
    struct rlimit space;
    return getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY;
}
