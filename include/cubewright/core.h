/* Status codes, errors, progress reports and memory limits: what all calls of the library
 * share. */
#ifndef CUBEWRIGHT_CORE_H
#define CUBEWRIGHT_CORE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The version of the headers; cw_version() returns that of the library. */
#define CW_VERSION "0.2.0"

#if defined(__GNUC__)
/* Marks what the library exports. */
#define CW_API __attribute__((visibility("default")))
/* Marks a function that takes a format as printf does: numbers of that and of its first argument. */
#define CW_PRINTF(text, first) __attribute__((format(printf, text, first)))
/* Marks a function whose status is to be looked at. */
#define CW_NODISCARD __attribute__((warn_unused_result))
/* Marks a function or a field that a later version leaves out; text names what to use. */
#define CW_DEPRECATED(text) __attribute__((deprecated(text)))
#else
#define CW_API
#define CW_PRINTF(text, first)
#define CW_NODISCARD
#define CW_DEPRECATED(text)
#endif

/* One row per status: constant, exit code of the command line, name in JSON, text for people.
 * The enum, the exit codes of the command line and `cubewright help exit` are all made from
 * this table. */
#define CW_STATUS_TABLE(X)                                                                     \
    X(CW_OK, 0, "ok", "done")                                                                  \
    X(CW_ERR_CHECK, 1, "check-failed", "a check failed: the surface is not as promised")       \
    X(CW_ERR_ARGUMENT, 2, "usage", "the command or an argument is not usable")                 \
    X(CW_ERR_IO, 3, "unreadable", "an input cannot be opened or read")                         \
    X(CW_ERR_FORMAT, 3, "bad-input", "an input is damaged or of a kind that is not supported") \
    X(CW_ERR_BACKEND, 3, "library-failed", "a library failed on an input")                     \
    X(CW_ERR_UNSAFE, 4, "unsafe-input", "an input is readable but unsafe to trust")            \
    X(CW_ERR_UNSUPPORTED, 5, "not-in-this-build", "the feature is not in this build")          \
    X(CW_ERR_OUTPUT, 6, "output-not-written", "an output was not written")                     \
    X(CW_ERR_BATCH, 7, "batch-failed", "some files of a batch failed")                         \
    X(CW_ERR_LIMIT, 8, "over-limit", "a memory, voxel or triangle limit would be exceeded")    \
    X(CW_ERR_NO_MEMORY, 8, "no-memory", "memory ran out")                                      \
    X(CW_ERR_EMPTY, 9, "empty", "the result is empty: no surface at this isovalue")            \
    X(CW_ERR_CANCELLED, 130, "interrupted", "interrupted; partial files are removed")

/* The outcome of a call. */
typedef enum cw_status {
#define CW_STATUS_ENUM(name, exit_code, json, text) name,
    CW_STATUS_TABLE(CW_STATUS_ENUM)
#undef CW_STATUS_ENUM
        CW_STATUS_COUNT
} cw_status;

/* The reason why a call failed, for a person: subject, problem, expected value, actual value. A
 * message names a field of the call's options as "desc->max_bytes".
 *
 * Each call that takes a cw_error begins by clearing it: after a success the status is CW_OK and
 * the message is empty. NULL is allowed in its place. Other pointers that are NULL fail with
 * CW_ERR_ARGUMENT, unless the call says that they may be. Functions named _free take NULL; those
 * that look something up find nothing for it.
 *
 * Pointers to const are borrowed until the call returns, unless it says for how long. NULL in
 * place of a desc means all defaults. Those of field.h, hard.h, level_set.h and simplify.h,
 * cw_fit_desc and cw_label_simplify_desc are required. Each desc begins with the version of its struct.
 * A version that the library does not know fails with CW_ERR_ARGUMENT. threads is the number of threads; 0 means
 * one per processor that the process may use. Where the system gives fewer, fewer work. */
typedef struct cw_error {
    cw_status status;  /* what the call returned */
    char message[512]; /* for a person; empty after a success */
} cw_error;

/* A progress callback, with which the caller can also stop a call. Zeroed: no callback. */
typedef struct cw_progress {
    /* Called on the calling thread: the step's name and the share of it done, 0 to 1.
     * Return false to cancel: the call then fails with CW_ERR_CANCELLED. */
    bool (*report)(void *user, const char *step, double done);
    void *user; /* passed to report */
} cw_progress;

/* Returns the version of the library at run time, such as "0.2.0". */
CW_API const char *cw_version(void);

/* Limits the total size of the arrays of all calls in this process. Calls that need more fail
 * with CW_ERR_NO_MEMORY. Memory of other libraries is counted by estimates; the program itself
 * is not counted. 0 means no limit, as at the start. Only Linux counts.
 * bytes  the limit; 0: none */
CW_API void cw_memory_limit(size_t bytes);

/* Returns the number of bytes that arrays take now. */
CW_API size_t cw_memory_used(void);

/* Where arrays beyond the limit go. Zero-initialise it and set what you need. */
typedef struct cw_overflow_desc {
    uint32_t version; /* 0: the first version of this struct */
    const char
        *path; /* temporary files without a name stand in the folder of this path; copied */
    /* Called once, on any thread, before the first array goes to a file: with the bytes that
     * are known to follow. Default: none */
    void (*report)(void *user, size_t bytes);
    void *user; /* passed to report */
} cw_overflow_desc;

/* Lets large arrays overflow into temporary files where those of all calls exceed cw_memory_limit(), in place of
 * CW_ERR_NO_MEMORY. The files are mapped to memory, and end with their arrays or the process. Then half of
 * the limit is for large arrays in memory. The rest holds small ones, and pages of the files, which are
 * dropped when they exceed what is left. Room on the disk is reserved before it is used: a full disk is
 * CW_ERR_OUTPUT where it is foreseen, else CW_ERR_NO_MEMORY with the folder's name. Results have the same bytes.
 *
 * Sweeps over arrays are fast where they go from one end to the other, as in cw_extract_labels(). Others may
 * take long. Forked processes make no files. With cw_allocator_set(), such arrays do not come from that.
 *
 * desc     borrowed; NULL, or without a path: no more arrays go to files; those that did stay there
 * Returns  CW_ERR_OUTPUT  the folder cannot be written; CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_memory_overflow(const cw_overflow_desc *desc, cw_error *err);

/* Returns the number of bytes of arrays that are in files now. cw_memory_used() does not count them. */
CW_API size_t cw_memory_overflowed(void);

/* An allocator of the caller's, instead of malloc() and free(). Both functions are called from
 * any thread, also in the sandboxed processes that readers fork. */
typedef struct cw_allocator {
    /* Allocates `bytes`, more than 0, at a multiple of 64. Returns NULL when memory is out. */
    void *(*allocate)(void *user, size_t bytes);
    /* Frees memory of allocate(); bytes as they were there. Never called with NULL. */
    void (*release)(void *user, void *memory, size_t bytes);
    void *user; /* passed to both */
} cw_allocator;

/* Sets the allocator of all arrays that calls in this process make from now on, those of meshes,
 * volumes and pictures included. Each array takes 64 bytes more. Libraries behind modules, such
 * as OpenVDB and CGAL, allocate some memory by themselves.
 *
 * allocator  copied; NULL means malloc() and free() again
 * Returns    CW_ERR_ARGUMENT  a function is missing; or arrays are alive, so that another allocator
 *                             would have to free them: call this before anything else */
CW_NODISCARD CW_API cw_status cw_allocator_set(const cw_allocator *allocator, cw_error *err);

/* Returns the fields of a status' row in CW_STATUS_TABLE. An unknown status reads as
 * CW_ERR_BACKEND. */
CW_API int cw_status_exit_code(cw_status status);
CW_API const char *cw_status_name(cw_status status);
CW_API const char *cw_status_text(cw_status status);

/* An optional part of the library, which a build may lack. */
typedef struct cw_feature {
    const char *name;   /* such as "simplify" or "draco" */
    const char *about;  /* what it brings */
    bool available;     /* false: calls that need it return CW_ERR_UNSUPPORTED */
    const char *reason; /* why it is not available; "" when it is */
} cw_feature;

/* Returns the optional parts, available or not: count rows that live as long as the program. */
CW_API const cw_feature *cw_features(size_t *count);

#ifdef __cplusplus
}
#endif

#endif
