/* Checked sizes and allocation. All memory of the library is allocated here. */
#ifndef CORE_BASE_MEMORY_H
#define CORE_BASE_MEMORY_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Computes *out = a * b or a + b. Returns false, with *out untouched, when the result does not
 * fit. */
bool cwi_size_mul(size_t a, size_t b, size_t *out);
bool cwi_size_add(size_t a, size_t b, size_t *out);

/* Allocates count elements of the given size, zeroed or not. Returns NULL when the product
 * overflows or memory is out. A count of 0 gives a pointer that can be freed. Free with
 * cwi_free(). */
void *cwi_alloc_array(size_t count, size_t size);
void *cwi_alloc_zeroed(size_t count, size_t size);
void *cwi_realloc_array(void *memory, size_t count, size_t size);
void cwi_free(void *memory);

/* Lengthens an array of count elements if it has no capacity for one more. Returns NULL, with the
 * array untouched, when memory is out. */
void *cwi_grow_array(void *array, size_t count, size_t *capacity, size_t size);

/* Allocates as cwi_alloc_array(), for arrays that are written once from end to end. Large
 * arrays stand on large pages where the system has them. The system hands those out 512 times
 * faster than small pages. */
void *cwi_alloc_large(size_t count, size_t size);

/* Allocates as cwi_alloc_large(), in place of an array that is no longer needed, or NULL. That
 * array is reused unless it is too short, or more than twice too long. A new one is an eighth
 * longer than requested, as similar requests may follow. The system need not clear memory that
 * was used before. */
void *cwi_renew_large(void *memory, size_t count, size_t size);

/* The account of a process: allocated bytes, the limit, and the requests that it refused. A
 * module has a copy of this code, and shares the account of the program that loads it. */
typedef struct cwi_memory_account cwi_memory_account;
cwi_memory_account *cwi_memory_account_get(void);
void cwi_memory_account_share(cwi_memory_account *of_the_program);

/* Counts memory that a library is about to allocate by itself, until it is given back. Returns
 * false, and takes nothing, when the limit of cw_memory_limit() has no room for it. */
bool cwi_memory_take(size_t bytes);
void cwi_memory_give(size_t bytes);

/* Returns the bytes that may still be allocated; SIZE_MAX without a limit. */
size_t cwi_memory_left(void);

/* Announces arrays of some bytes. If they exceed the limit, and cw_memory_overflow() has a
 * folder for them, large ones go to files from now on, so that half of the limit is left for the pages of
 * these.
 * Returns  CW_ERR_OUTPUT: the disk has no room for them */
CW_NODISCARD cw_status cwi_memory_expect(size_t bytes, cw_error *err);

/* Drops pages of arrays in files from memory if they exceed what the limit leaves. Sweeps over arrays call it
 * after each piece of work, as cwi_parallel_for() and cwi_progress() do. It costs next to nothing where no
 * array is in a file, and microseconds otherwise. */
void cwi_memory_trim(void);

/* Returns true for an array that is in a file. */
bool cwi_memory_is_in_file(const void *memory);

/* Trims at every 16384th element of a sweep. */
static inline void cwi_memory_trim_at(size_t n)
{
    if (n % (1 << 14) == 0)
        cwi_memory_trim();
}

/* Copies and sets bytes of large arrays as memcpy() and memset() do, and trims on the way. */
void cwi_copy_large(void *to, const void *from, size_t bytes);
void cwi_set_large(void *to, int byte, size_t bytes);

/* Returns the bytes that the limit refused last, and those that were left then; 0: it refused
 * none. */
size_t cwi_memory_refused(size_t *left);

/* Fails with CW_ERR_NO_MEMORY: says how much the last allocation that failed had asked for, and what
 * cw_memory_limit() left. Allocations by malloc() are not known. */
cw_status cwi_fail_memory(cw_error *err);

/* Copies a string; returns NULL when memory is out. */
char *cwi_strdup(const char *text);

/* Returns true if the address space of this process is limited (ulimit -v). */
bool cwi_memory_is_limited(void);

/* Makes the n-th allocation of this thread from now on (0: the next) and all later ones fail.
 * -1 ends this. For tests of failing allocations. Returns true if one has failed since the last
 * call. */
bool cwi_alloc_fail_after(long n);

#ifdef __cplusplus
}
#endif

#endif
