/* Allocates the library's memory, counts it against a limit, and lets tests make allocations
 * fail. */
#define _DEFAULT_SOURCE /* madvise */
#include "core/base/memory.h"

#include "core/base/file_arrays.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/base/unnamed_file.h"

#ifdef __linux__
#include <malloc.h>
#endif
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>

/* The counters are per thread, so that a test that lets allocations fail affects no other
 * thread. */
static _Thread_local long allocations_left = -1;
static _Thread_local bool one_failed;

/* Size of this thread's last request that failed, for its message; 0: none since. */
static _Thread_local size_t failed_bytes;

/* Why no temporary file took that request: a number of errno; 0: none was asked for. */
static _Thread_local int file_error;

static bool fail_by_request(void)
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

struct cwi_memory_account {
    atomic_size_t used;         /* bytes of all arrays that are allocated now */
    atomic_size_t limit;        /* 0: none */
    atomic_size_t refused;      /* size of the last request beyond the limit */
    atomic_size_t refused_left; /* bytes that were left then */
    atomic_size_t failed;       /* size of the last request that failed, of any thread */
    bool (*next_fails)(void);   /* callback for cwi_alloc_fail_after() */
    cw_allocator allocator;     /* of the caller; without functions: malloc() */
    cwi_file_arrays files;      /* arrays beyond the limit */
    cw_overflow_desc overflow;  /* how they were asked for */
    atomic_bool overflows;      /* large arrays go to files before the limit is reached */
};

static size_t find_max_resident(void);

static cwi_memory_account own_account = {
    .next_fails = fail_by_request,
    .files = {.lock = PTHREAD_MUTEX_INITIALIZER, .max_resident = find_max_resident}};

/* The account of this process. Threads may load a module at the same time: each shares the same
 * account with it. */
static _Atomic(cwi_memory_account *) account = &own_account;

cwi_memory_account *cwi_memory_account_get(void)
{
    return account;
}

void cwi_memory_account_share(cwi_memory_account *of_the_program)
{
    account = of_the_program;
}

bool cwi_alloc_fail_after(long n)
{
    const bool failed = one_failed;
    one_failed = false;
    allocations_left = n;
    return failed;
}

/* --- the limit ---------------------------------------------------------------------------- */

void cw_memory_limit(size_t bytes)
{
    atomic_store(&account->limit, bytes);
    atomic_store(&account->refused, 0);
}

size_t cw_memory_used(void)
{
    return atomic_load(&account->used);
}

size_t cwi_memory_refused(size_t *left)
{
    *left = atomic_load(&account->refused_left);
    return atomic_load(&account->refused);
}

size_t cwi_memory_left(void)
{
    const size_t max = atomic_load(&account->limit), now = atomic_load(&account->used);
    return !max ? SIZE_MAX : max > now ? max - now : 0;
}

/* Keeps the size of a request that failed. Returns NULL. */
static void *note_failure(size_t bytes)
{
    failed_bytes = bytes;
    atomic_store(&account->failed, bytes);
    return NULL;
}

/* Fails for an array that neither memory nor a temporary file took. */
static cw_status fail_file(size_t needed, int error, cw_error *err)
{
    char needed_text[CWI_MEMORY_TEXT];
    cwi_print_memory(needed, needed_text);
    return cwi_fail(
        err, CW_ERR_NO_MEMORY,
        "no memory: %s were needed beyond cw_memory_limit(), and a temporary file in "
        "'%s' cannot hold them: %s",
        needed_text, account->files.folder ? account->files.folder : "", strerror(error));
}

cw_status cwi_fail_memory(cw_error *err)
{
    char needed_text[CWI_MEMORY_TEXT], left_text[CWI_MEMORY_TEXT];
    const size_t of_any = atomic_exchange(&account->failed, 0);
    const size_t needed = failed_bytes ? failed_bytes : of_any;
    const int of_file = file_error;
    failed_bytes = 0;
    file_error = 0;
    if (needed && of_file)
        return fail_file(needed, of_file, err);
    if (!needed)
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory");
    cwi_print_memory(needed, needed_text);
    if (needed != atomic_load(&account->refused))
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory: %s were needed", needed_text);
    cwi_print_memory(atomic_load(&account->refused_left), left_text);
    return cwi_fail(err, CW_ERR_NO_MEMORY,
                    "no memory: %s were needed, and cw_memory_limit() leaves %s", needed_text,
                    left_text);
}

bool cwi_memory_take(size_t bytes)
{
    const size_t max = atomic_load_explicit(&account->limit, memory_order_relaxed);
    const size_t before =
        atomic_fetch_add_explicit(&account->used, bytes, memory_order_relaxed);
    if (!max || (before <= max && bytes <= max - before))
        return true;
    atomic_fetch_sub_explicit(&account->used, bytes, memory_order_relaxed);
    atomic_store(&account->refused_left, max > before ? max - before : 0);
    atomic_store(&account->refused, bytes);
    note_failure(bytes);
    return false;
}

/* Gives bytes back. The count never falls below 0, since uncounted arrays of a caller may be
 * freed here, too. */
void cwi_memory_give(size_t bytes)
{
    size_t now = atomic_load_explicit(&account->used, memory_order_relaxed);
    while (!atomic_compare_exchange_weak_explicit(&account->used, &now,
                                                  now > bytes ? now - bytes : 0,
                                                  memory_order_relaxed, memory_order_relaxed))
        ;
}

/* --- files beyond the limit ---------------------------------------------------------------- */

enum { LEAST_FILE = 1 << 20 }; /* bytes of an array that is worth a file */

static void lock_files(void)
{
    pthread_mutex_lock(&account->files.lock);
}

static void unlock_files(void)
{
    pthread_mutex_unlock(&account->files.lock);
}

static void leave_parent(void)
{
    cwi_file_arrays_forked(&account->files);
    unlock_files();
}

/* A forked process has its own lock, and whole lists. */
static void watch_forks(void)
{
    pthread_atfork(lock_files, unlock_files, leave_parent);
}

cw_status cw_memory_overflow(const cw_overflow_desc *desc, cw_error *err)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    CWI_REQUIRE(err, account);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cw_overflow_desc d = desc ? *desc : (cw_overflow_desc){0};
    char *folder = d.path ? cwi_folder_of(d.path) : NULL;
    if (d.path && !folder)
        return cwi_fail_memory(err);
    pthread_once(&once, watch_forks);
    cw_status st = cwi_file_arrays_open(&account->files, folder, err);
    cwi_free(folder);
    if (st != CW_OK)
        return st;
    d.path = NULL; /* the caller's */
    account->overflow = d;
    atomic_store(&account->overflows, false);
    return CW_OK;
}

size_t cw_memory_overflowed(void)
{
    return atomic_load(&account->files.bytes);
}

/* Returns the bytes of memory for large arrays: once some go to files, half of it is for their pages
 * and for small arrays. */
static size_t limit_of_large(void)
{
    const size_t limit = atomic_load_explicit(&account->limit, memory_order_relaxed);
    return atomic_load_explicit(&account->overflows, memory_order_relaxed) ? limit / 2 : limit;
}

/* Returns true if an array should be in a file. */
static bool belongs_to_file(size_t bytes)
{
    const size_t used = atomic_load_explicit(&account->used, memory_order_relaxed);
    if (bytes < LEAST_FILE || !atomic_load_explicit(&account->limit, memory_order_relaxed) ||
        (used <= limit_of_large() && bytes <= limit_of_large() - used))
        return false;
    return cwi_file_arrays_are_open(&account->files);
}

static void begin_overflow(size_t bytes)
{
    const cw_overflow_desc *d = &account->overflow;
    if (!atomic_exchange(&account->overflows, true) && d->report)
        d->report(d->user, bytes);
}

/* Makes an array in a file. Returns NULL when the disk is full. */
static void *allocate_in_file(size_t bytes)
{
    begin_overflow(bytes);
    cwi_memory_trim();
    return cwi_file_array_new(&account->files, bytes, &file_error);
}

cw_status cwi_memory_expect(size_t bytes, cw_error *err)
{
    char needed_text[CWI_MEMORY_TEXT], room_text[CWI_MEMORY_TEXT];
    const char *folder = account->files.folder;
    if (bytes <= cwi_memory_left() || !cwi_file_arrays_are_open(&account->files))
        return CW_OK;
    const size_t room = cwi_folder_room(folder);
    if (room >= bytes) {
        begin_overflow(bytes);
        return CW_OK;
    }
    cwi_print_memory(bytes, needed_text);
    cwi_print_memory(room, room_text);
    return cwi_fail(
        err, CW_ERR_OUTPUT,
        "arrays of %s exceed what cw_memory_limit() leaves, and '%s' has room for %s: "
        "free it, choose an output on another disk, or raise the limit",
        needed_text, folder, room_text);
}

/* Returns the bytes of files that may be in memory: a third of what is left. The rest is for those that
 * threads add before they are dropped, and for what malloc() adds to arrays. */
static size_t find_max_resident(void)
{
    return cwi_memory_left() / 3;
}

void cwi_memory_trim(void)
{
    cwi_file_arrays_trim(&account->files);
}

bool cwi_memory_is_in_file(const void *memory)
{
    return cwi_file_array_size(&account->files, memory) > 0;
}

enum { COPIED = 1 << 20 }; /* bytes between two trims */

void cwi_copy_large(void *to, const void *from, size_t bytes)
{
    for (size_t at = 0; at < bytes; at += COPIED) {
        memcpy((char *)to + at, (const char *)from + at,
               bytes - at < COPIED ? bytes - at : COPIED);
        cwi_memory_trim();
    }
}

void cwi_set_large(void *to, int byte, size_t bytes)
{
    for (size_t at = 0; at < bytes; at += COPIED) {
        memset((char *)to + at, byte, bytes - at < COPIED ? bytes - at : COPIED);
        cwi_memory_trim();
    }
}

/* --- the caller's allocator --------------------------------------------------------------- */

enum { HEADER = 64 }; /* bytes before an array of the caller's allocator: the array's size */

cw_status cw_allocator_set(const cw_allocator *allocator, cw_error *err)
{
    CWI_REQUIRE(err, account);
    if (allocator && (!allocator->allocate || !allocator->release))
        return cwi_fail(err, CW_ERR_ARGUMENT, "the allocator has no function '%s'",
                        allocator->allocate ? "release" : "allocate");
    const size_t used = cw_memory_used();
    if (used > 0)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "arrays of %zu bytes are alive; an allocator is set before the first "
                        "or after the last",
                        used);
    account->allocator = allocator ? *allocator : (cw_allocator){0};
    return CW_OK;
}

static void *allocate_by_caller(size_t bytes)
{
    const cw_allocator *a = &account->allocator;
    char *memory = bytes <= PTRDIFF_MAX - HEADER ? a->allocate(a->user, bytes + HEADER) : NULL;
    if (!memory)
        return NULL;
    memcpy(memory, &bytes, sizeof bytes);
    return memory + HEADER;
}

static size_t caller_size(const void *memory)
{
    size_t bytes = 0;
    if (memory)
        memcpy(&bytes, (const char *)memory - HEADER, sizeof bytes);
    return bytes;
}

static void free_by_caller(void *memory)
{
    const cw_allocator *a = &account->allocator;
    if (memory)
        a->release(a->user, (char *)memory - HEADER, caller_size(memory) + HEADER);
}

static void *reallocate_by_caller(void *memory, size_t bytes)
{
    void *moved = allocate_by_caller(bytes);
    const size_t before = caller_size(memory);
    if (moved && memory)
        memcpy(moved, memory, before < bytes ? before : bytes);
    if (moved)
        free_by_caller(memory);
    return moved;
}

static bool has_caller_allocator(void)
{
    return account->allocator.allocate != NULL;
}

/* --- malloc, or that ----------------------------------------------------------------------- */

static void *allocate_bytes(size_t bytes)
{
    return has_caller_allocator() ? allocate_by_caller(bytes) : malloc(bytes);
}

static void *allocate_zeroed(size_t bytes)
{
    if (!has_caller_allocator())
        return calloc(bytes, 1);
    void *memory = allocate_by_caller(bytes);
    return memory ? memset(memory, 0, bytes) : NULL;
}

static void *reallocate_bytes(void *memory, size_t bytes)
{
    return has_caller_allocator() ? reallocate_by_caller(memory, bytes)
                                  : realloc(memory, bytes);
}

static void free_bytes(void *memory)
{
    if (has_caller_allocator())
        free_by_caller(memory);
    else
        free(memory);
}

/* Returns the true size of allocated memory that is in no file; 0: unknown, and then it is not
 * counted. */
static size_t capacity_of(void *memory)
{
    if (has_caller_allocator())
        return caller_size(memory);
#ifdef __linux__
    return malloc_usable_size(memory);
#else
    (void)memory;
    return 0;
#endif
}

/* Corrects the count from the bytes taken beforehand to the true size of the memory. Returns
 * the memory. */
static void *count_memory(void *memory, size_t taken)
{
    const size_t has = capacity_of(memory);
    if (!memory)
        note_failure(taken);
    if (has > taken)
        atomic_fetch_add_explicit(&account->used, has - taken, memory_order_relaxed);
    else
        cwi_memory_give(taken - has);
    return memory;
}

/* --- allocation --------------------------------------------------------------------------- */

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

/* Computes the size of an array. Sizes beyond PTRDIFF_MAX cannot be indexed; malloc refuses
 * them, and compilers warn. */
static bool is_usable(size_t count, size_t size, size_t *bytes)
{
    if (!cwi_size_mul(count, size, bytes) || *bytes > PTRDIFF_MAX)
        return note_failure(SIZE_MAX) != NULL;
    return !account->next_fails() || note_failure(*bytes) != NULL;
}

/* Makes an array in a file where it belongs there. Returns NULL where it does not, or the disk is full. */
static void *allocate_beyond(size_t bytes)
{
    file_error = 0;
    return belongs_to_file(bytes) ? allocate_in_file(bytes) : NULL;
}

enum { LARGE_PAGE = 2 << 20 };

/* Requests large pages for the whole ones inside large memory. A refusal does no harm. */
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
    if (!is_usable(count, size, &bytes))
        return NULL;
    void *memory = allocate_beyond(bytes);
    if (memory || !cwi_memory_take(bytes))
        return memory;
    return count_memory(allocate_bytes(bytes ? bytes : 1), bytes);
}

void *cwi_alloc_zeroed(size_t count, size_t size)
{
    size_t bytes;
    if (!is_usable(count, size, &bytes))
        return NULL;
    char *memory = allocate_beyond(bytes);
    if (memory || !cwi_memory_take(bytes))
        return memory;
    memory = count_memory(allocate_zeroed(bytes ? bytes : 1), bytes);
    wish_large_pages(memory, bytes);
    return memory;
}

void *cwi_alloc_large(size_t count, size_t size)
{
    const size_t page = LARGE_PAGE;
    size_t bytes;
    if (!is_usable(count, size, &bytes))
        return NULL;
    void *memory = allocate_beyond(bytes);
    if (memory || !cwi_memory_take(bytes))
        return memory;
    if (bytes < 2 * page || bytes > PTRDIFF_MAX - page || has_caller_allocator())
        return count_memory(allocate_bytes(bytes ? bytes : 1), bytes);
    const size_t whole = (bytes + page - 1) / page * page;
    memory = count_memory(aligned_alloc(page, whole), bytes);
    wish_large_pages(memory, whole);
    return memory;
}

void *cwi_renew_large(void *memory, size_t count, size_t size)
{
    const size_t more = memory ? count / 8 : 0,
                 in_file = cwi_file_array_size(&account->files, memory),
                 capacity = in_file ? in_file : capacity_of(memory);
    size_t bytes;
    if (memory && is_usable(count, size, &bytes) && bytes <= capacity && bytes >= capacity / 2)
        return memory;
    cwi_free(memory);
    return cwi_alloc_large(count + more, size);
}

/* Moves an array of some bytes from or to a file. Returns NULL, with the array untouched, when there is
 * no room. */
static void *move_array(void *memory, size_t before, size_t bytes)
{
    void *moved = cwi_alloc_array(bytes, 1);
    if (moved) {
        cwi_copy_large(moved, memory, before < bytes ? before : bytes);
        cwi_free(memory);
    }
    return moved;
}

void *cwi_realloc_array(void *memory, size_t count, size_t size)
{
    const size_t in_file = cwi_file_array_size(&account->files, memory),
                 before = in_file ? in_file : capacity_of(memory);
    size_t bytes;
    if (!is_usable(count, size, &bytes))
        return NULL;
    if (in_file && bytes <= in_file && bytes >= in_file / 2)
        return memory;
    const size_t more = bytes > before ? bytes - before : 0;
    if (in_file || (before && more && belongs_to_file(more)))
        return move_array(memory, before, bytes);
    if (!memory)
        return cwi_alloc_array(count, size);
    if (!cwi_memory_take(more))
        return NULL;
    void *moved = reallocate_bytes(memory, bytes ? bytes : 1);
    if (moved)
        count_memory(moved, before + more);
    else {
        cwi_memory_give(more);
        note_failure(more);
    }
    return moved;
}

void *cwi_grow_array(void *array, size_t count, size_t *capacity, size_t size)
{
    if (count < *capacity)
        return array;
    const size_t more = 2 * *capacity + 256;
    void *larger = cwi_realloc_array(array, more, size);
    if (larger)
        *capacity = more;
    return larger;
}

void cwi_free(void *memory)
{
    if (cwi_file_array_free(&account->files, memory))
        return;
    cwi_memory_give(capacity_of(memory));
    free_bytes(memory);
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
