/* A sandbox: a child process that works on untrusted bytes. If a library crashes, hangs or is
 * taken over there, only the child is lost, and the caller gets an error.
 *
 * The child has no files except those handed to it one by one. seccomp leaves it the system
 * calls that read them, allocate memory and answer. It cannot open files, start programs or
 * send data. Its results go into memory that both sides see. That memory and the answers are
 * untrusted: copy, then check. */
#ifndef CORE_BASE_SANDBOX_H
#define CORE_BASE_SANDBOX_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Sanitizers reserve terabytes of address space: memory has no limit then. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define CWI_SANITIZED 1
#elif defined(__has_feature)
#define CWI_SANITIZED (__has_feature(address_sanitizer) || __has_feature(thread_sanitizer))
#else
#define CWI_SANITIZED 0
#endif

/* A piece of work, done in the child.
 * state    as in the description: the child's own copy, kept from one piece to the next
 * fd       the file handed over, which the work now owns; -1: none
 * request  a copy of the bytes given to cwi_sandbox_run()
 * shared   the memory that both sides see */
typedef cw_status (*cwi_sandbox_work)(void *state, int fd, const void *request, void *shared,
                                      cw_error *err);

/* The first step in the child, while it may still open files: loading a library. The library's
 * constructors may end a process that is short of memory. */
typedef cw_status (*cwi_sandbox_prepare)(void *state, cw_error *err);

enum { CWI_SANDBOX_REQUEST = 64 };
#define CWI_SANDBOX_MEMORY ((uint64_t)2 << 30) /* bytes; the default */

typedef struct cwi_sandbox_desc {
    const char *library;         /* for messages: "DCMTK" */
    cwi_sandbox_prepare prepare; /* NULL: nothing */
    cwi_sandbox_work work;
    void *state;
    size_t shared_bytes; /* of the memory that both sides see */
    uint64_t memory;     /* bytes for the library, besides what the child itself needs;
                            0: CWI_SANDBOX_MEMORY */
    double timeout_s;    /* for one piece of work; 0: 60 */
    bool inside;         /* no child: the work is done here */
    bool trusted;        /* the work is on our own data: a child that may die, without limits */
} cwi_sandbox_desc;

/* A zeroed sandbox is closed. */
typedef struct cwi_sandbox {
    cwi_sandbox_desc desc;
    void *shared;
    bool open;
    int socket;
    int child;                   /* process id; 0: none */
    const cw_progress *progress; /* may be set between pieces: called every 100 ms ... */
    double done;                 /* ... with this fraction */
} cwi_sandbox;

/* Starts the child.
 * Returns  the preparation's result; CW_ERR_BACKEND when the system gives no process, or
 *          has no seccomp; CW_ERR_NO_MEMORY, also when the child died of its preparation */
CW_NODISCARD cw_status cwi_sandbox_open(cwi_sandbox *box, const cwi_sandbox_desc *desc,
                                        cw_error *err);

/* Makes the child do a piece of work, and waits for it.
 * fd       borrowed; -1: none
 * request  at most CWI_SANDBOX_REQUEST bytes
 * Returns  the work's result; CW_ERR_BACKEND when the child died or took too long, which
 *          closes the sandbox; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_sandbox_run(cwi_sandbox *box, int fd, const void *request,
                                       size_t size, cw_error *err);

/* Ends the child. Harmless on a zeroed or already closed sandbox. */
void cwi_sandbox_close(cwi_sandbox *box);

#ifdef __cplusplus
}
#endif

#endif
