/* Makes arrays in temporary files that are mapped to memory, and drops their pages from it. */
#define _GNU_SOURCE /* madvise */
#include "core/base/file_arrays.h"

#include "core/base/status.h"
#include "core/base/thread_pool.h"
#include "core/base/unnamed_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/statvfs.h>
#include <time.h>
#include <unistd.h>

/* Returns the bytes of files that are in this process's memory: its program and mapped arrays. */
static size_t measure_resident(void)
{
    char text[128];
    unsigned long pages = 0;
    const int file = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
    if (file < 0)
        return 0;
    const ssize_t length = read(file, text, sizeof text - 1);
    close(file);
    text[length > 0 ? length : 0] = '\0';
    if (sscanf(text, "%*u %*u %lu", &pages) != 1)
        return 0;
    return (size_t)pages * (size_t)sysconf(_SC_PAGESIZE);
}

/* Returns the number of the first array that ends behind an address; all of them end before: count. */
static size_t find_array(const cwi_file_arrays *f, const char *memory)
{
    size_t low = 0, high = atomic_load(&f->count);
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (f->items[middle].memory + f->items[middle].bytes <= memory)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static bool is_array(const cwi_file_arrays *f, size_t n, const char *memory)
{
    return n < atomic_load(&f->count) && f->items[n].memory == memory;
}

/* --- the folder ----------------------------------------------------------------------------- */

cw_status cwi_file_arrays_open(cwi_file_arrays *f, const char *folder, cw_error *err)
{
    char *copy = NULL;
    int file = -1;
    cw_status st = folder ? cwi_unnamed_open(folder, &file, err) : CW_OK;
    if (file >= 0)
        close(file);
    if (st == CW_OK && folder) {
        copy = strdup(folder);
        st = copy ? CW_OK : cwi_fail(err, CW_ERR_NO_MEMORY, "no memory");
    }
    if (st != CW_OK)
        return st;
    pthread_mutex_lock(&f->lock);
    free(f->folder);
    f->folder = copy;
    f->owner = getpid();
    pthread_mutex_unlock(&f->lock);
    return CW_OK;
}

bool cwi_file_arrays_are_open(const cwi_file_arrays *f)
{
    return f->folder && f->owner == getpid();
}

size_t cwi_folder_room(const char *folder)
{
    struct statvfs disk;
    if (statvfs(folder, &disk) != 0)
        return SIZE_MAX;
    return (size_t)disk.f_bavail * (size_t)disk.f_frsize;
}

/* --- pages in memory ------------------------------------------------------------------------ */

static bool are_too_many(const cwi_file_arrays *f)
{
    return measure_resident() > f->resident + f->max_resident();
}

/* Drops pages if there are too many. Threads wait for one that does: meanwhile they would add others. */
static void drop_pages(cwi_file_arrays *f)
{
    if (!are_too_many(f))
        return;
    pthread_mutex_lock(&f->lock);
    const size_t count = are_too_many(f) ? atomic_load(&f->count) : 0;
    for (size_t n = 0; n < count; n++)
        madvise(f->items[n].memory, f->items[n].bytes, MADV_DONTNEED);
    pthread_mutex_unlock(&f->lock);
}

void cwi_file_arrays_trim(cwi_file_arrays *f)
{
    if (atomic_load_explicit(&f->count, memory_order_relaxed) > 0)
        drop_pages(f);
}

/* Trims as long as there are arrays. */
static void *watch_pages(void *context)
{
    static const struct timespec pause = {.tv_nsec = 2000000};
    cwi_file_arrays *f = context;
    bool goes_on = true;
    while (goes_on) {
        nanosleep(&pause, NULL);
        drop_pages(f);
        pthread_mutex_lock(&f->lock);
        goes_on = f->is_watched = atomic_load(&f->count) > 0;
        pthread_mutex_unlock(&f->lock);
    }
    return NULL;
}

static void start_watching(cwi_file_arrays *f)
{
    pthread_t thread;
    f->is_watched = f->is_watched ||
                    (cwi_start_thread(&thread, watch_pages, f) && pthread_detach(thread) == 0);
}

void cwi_file_arrays_forked(cwi_file_arrays *f)
{
    f->is_watched = false;
}

/* --- arrays --------------------------------------------------------------------------------- */

/* Reserves the bytes of a file, so that none is missing when it is written to. Returns a number of
 * errno, or 0. A limit of sizes would end the process by a signal, so it is looked up before. */
static int reserve_bytes(int file, size_t bytes)
{
    struct rlimit size;
    if (getrlimit(RLIMIT_FSIZE, &size) == 0 && size.rlim_cur != RLIM_INFINITY &&
        bytes > size.rlim_cur)
        return EFBIG;
    return posix_fallocate(file, 0, (off_t)bytes);
}

/* Makes a file, and maps it. Returns NULL, with *error set, on failure. */
static char *map_file(const char *folder, size_t bytes, int *error)
{
    int file;
    void *memory = MAP_FAILED;
    if (cwi_unnamed_open(folder, &file, NULL) != CW_OK) {
        *error = errno;
        return NULL;
    }
    *error = reserve_bytes(file, bytes);
    if (!*error) {
        memory = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
        *error = memory == MAP_FAILED ? errno : 0;
    }
    close(file);
    return memory == MAP_FAILED ? NULL : memory;
}

/* Makes room for one array more. */
static bool reserve_item(cwi_file_arrays *f)
{
    if (atomic_load(&f->count) < f->capacity)
        return true;
    const size_t capacity = 2 * f->capacity + 64;
    cwi_file_array *longer = realloc(f->items, capacity * sizeof *longer);
    if (longer) {
        f->items = longer;
        f->capacity = capacity;
    }
    return longer;
}

static void insert_array(cwi_file_arrays *f, char *memory, size_t bytes)
{
    const size_t count = atomic_load(&f->count), n = find_array(f, memory);
    memmove(f->items + n + 1, f->items + n, (count - n) * sizeof *f->items);
    f->items[n] = (cwi_file_array){memory, bytes};
    atomic_store(&f->count, count + 1);
    atomic_fetch_add(&f->bytes, bytes);
}

void *cwi_file_array_new(cwi_file_arrays *f, size_t bytes, int *error)
{
    char *memory = NULL;
    *error = ENOMEM;
    pthread_mutex_lock(&f->lock);
    if (!atomic_load(&f->count))
        f->resident = measure_resident();
    if (f->folder && reserve_item(f))
        memory = map_file(f->folder, bytes, error);
    if (memory) {
        insert_array(f, memory, bytes);
        start_watching(f);
    }
    pthread_mutex_unlock(&f->lock);
    return memory;
}

/* Returns false for memory that cannot be an array, as most is not. */
static bool may_be_array(const cwi_file_arrays *f, const void *memory)
{
    enum { LEAST_PAGE = 4096 };
    return atomic_load_explicit(&f->count, memory_order_relaxed) > 0 && memory &&
           (uintptr_t)memory % LEAST_PAGE == 0;
}

bool cwi_file_array_free(cwi_file_arrays *f, const void *memory)
{
    if (!may_be_array(f, memory))
        return false;
    pthread_mutex_lock(&f->lock);
    const size_t n = find_array(f, memory), count = atomic_load(&f->count);
    const bool is_one = is_array(f, n, memory);
    if (is_one) {
        const cwi_file_array array = f->items[n];
        munmap(array.memory, array.bytes);
        memmove(f->items + n, f->items + n + 1, (count - n - 1) * sizeof *f->items);
        atomic_store(&f->count, count - 1);
        atomic_fetch_sub(&f->bytes, array.bytes);
    }
    pthread_mutex_unlock(&f->lock);
    return is_one;
}

size_t cwi_file_array_size(cwi_file_arrays *f, const void *memory)
{
    size_t bytes = 0;
    if (!may_be_array(f, memory))
        return 0;
    pthread_mutex_lock(&f->lock);
    const size_t n = find_array(f, memory);
    if (is_array(f, n, memory))
        bytes = f->items[n].bytes;
    pthread_mutex_unlock(&f->lock);
    return bytes;
}
