/* Checked sizes and allocation. All memory of the library comes from here. */
#ifndef CORE_BASE_MEMORY_H
#define CORE_BASE_MEMORY_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* *out = a * b; false, and *out untouched, when the product does not fit. */
bool cwi_size_mul(size_t a, size_t b, size_t *out);
bool cwi_size_add(size_t a, size_t b, size_t *out);

/* count elements of the given size, zeroed or not. NULL when the product overflows or memory is
 * out; a count of 0 gives a pointer that can be freed. Free with cwi_free(). */
void *cwi_alloc_array(size_t count, size_t size);
void *cwi_alloc_zeroed(size_t count, size_t size);
void *cwi_realloc_array(void *memory, size_t count, size_t size);
void cwi_free(void *memory);

/* As cwi_alloc_array(), for arrays that are written once from end to end: large ones stand on
 * large pages where the system has them, which are handed out 512 times faster than
 * small ones. */
void *cwi_alloc_large(size_t count, size_t size);

/* The same in place of an array that is no longer needed, or NULL: that array, unless it is too
 * short, or more than twice too long; else a new one, an eighth longer than asked for, as more
 * like it may be wanted. What was written to before, the system need not clear. */
void *cwi_renew_large(void *memory, size_t count, size_t size);

/* The account of a process: what is allocated, the limit, the requests that it refused. A module
 * has a copy of this code, and shares the account of the program that loads it. */
typedef struct cwi_memory_account cwi_memory_account;
cwi_memory_account *cwi_memory_account_get(void);
void cwi_memory_account_share(cwi_memory_account *of_the_program);

/* Counts memory that a library is about to take for itself, until it is given back. False, and
 * nothing taken, when the limit of cw_memory_limit() has no room for it. */
bool cwi_memory_take(size_t bytes);
void cwi_memory_give(size_t bytes);

/* Bytes that may still be allocated; SIZE_MAX without a limit. */
size_t cwi_memory_left(void);

/* The bytes that the limit refused last, and those that were left then; 0: it refused none. */
size_t cwi_memory_refused(size_t *left);

/* A copy of a string; NULL when memory is out. */
char *cwi_strdup(const char *text);

/* Whether somebody has limited the address space of this process (ulimit -v). */
bool cwi_memory_is_limited(void);

/* Makes the n-th allocation of this thread from now on (0: the next) and all later ones fail,
 * until it is called with -1. For tests of what happens then. Returns whether one has failed
 * since the last call. */
bool cwi_alloc_fail_after(long n);

#ifdef __cplusplus
}
#endif

#endif
