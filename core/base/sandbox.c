/* Runs library code in a child process that seccomp and resource limits confine; talks to it by
 * a socket and shared memory. */
#define _GNU_SOURCE /* close_range, SCM_RIGHTS, strsignal */
#include "core/base/sandbox.h"

#include "core/base/clock.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#ifdef CW_SECCOMP
#include <seccomp.h>
enum { HAS_SECCOMP = 1 };
#else
enum { HAS_SECCOMP = 0 };
#endif

enum { POLL_MS = 100, LAST_STDIO = 2, CHILD_FILES = 64 };

/* Bytes of address space that the child needs for itself, beyond those of the library: for the
 * seccomp filter, and for the stack and heap of its loop. */
enum { CHILD_OVERHEAD = 4 << 20 };

typedef struct answer {
    cw_status status;
    cw_error error;
} answer;

/* --- messages: bytes, and at most one file ----------------------------------------------- */

typedef struct parcel {
    struct iovec bytes;
    _Alignas(struct cmsghdr) char files[CMSG_SPACE(sizeof(int))];
    struct msghdr head;
} parcel;

static void wrap_parcel(parcel *p, void *bytes, size_t size)
{
    *p = (parcel){.bytes = {.iov_base = bytes, .iov_len = size}};
    p->head.msg_iov = &p->bytes;
    p->head.msg_iovlen = 1;
    p->head.msg_control = p->files;
    p->head.msg_controllen = sizeof p->files;
}

static bool send_parcel(int socket, const void *bytes, size_t size, int fd)
{
    char copy[CWI_SANDBOX_REQUEST];
    parcel p;
    ssize_t sent;
    memcpy(copy, bytes, size);
    wrap_parcel(&p, copy, size);
    if (fd >= 0) {
        struct cmsghdr *c = CMSG_FIRSTHDR(&p.head);
        c->cmsg_level = SOL_SOCKET;
        c->cmsg_type = SCM_RIGHTS;
        c->cmsg_len = CMSG_LEN(sizeof fd);
        memcpy(CMSG_DATA(c), &fd, sizeof fd);
    } else {
        p.head.msg_control = NULL;
        p.head.msg_controllen = 0;
    }
    do
        sent = sendmsg(socket, &p.head, MSG_NOSIGNAL);
    while (sent < 0 && errno == EINTR);
    return sent == (ssize_t)size;
}

/* Returns true if there was a message; *fd is -1 where no file came with it. With fd NULL no
 * file is accepted: the buffer has no room for one. */
static bool receive_parcel(int socket, void *bytes, size_t size, int *fd)
{
    parcel p;
    ssize_t got;
    wrap_parcel(&p, bytes, size);
    if (!fd)
        p.head.msg_controllen = 0;
    do
        got = recvmsg(socket, &p.head, MSG_CMSG_CLOEXEC);
    while (got < 0 && errno == EINTR);
    const struct cmsghdr *c = fd && got > 0 ? CMSG_FIRSTHDR(&p.head) : NULL;
    if (fd)
        *fd = -1;
    if (c && c->cmsg_level == SOL_SOCKET && c->cmsg_type == SCM_RIGHTS)
        memcpy(fd, CMSG_DATA(c), sizeof *fd);
    return got > 0;
}

/* --- the child --------------------------------------------------------------------------- */

static void limit_resource(__rlimit_resource_t what, uint64_t limit)
{
    struct rlimit now;
    if (getrlimit(what, &now) != 0)
        return;
    if (now.rlim_max > limit)
        now.rlim_max = limit;
    now.rlim_cur = now.rlim_max;
    setrlimit(what, &now);
}

/* Returns the address space in use so far. */
static uint64_t space_in_use(void)
{
    unsigned long long pages = 0;
    FILE *f = fopen("/proc/self/statm", "r");
    if (f && fscanf(f, "%llu", &pages) != 1)
        pages = 0;
    if (f)
        fclose(f);
    return (uint64_t)pages * (uint64_t)sysconf(_SC_PAGESIZE);
}

static void set_limits(const cwi_sandbox_desc *d)
{
    limit_resource(RLIMIT_CORE, 0);
    limit_resource(RLIMIT_FSIZE, 0);
    limit_resource(RLIMIT_NOFILE, CHILD_FILES);
    limit_resource(RLIMIT_STACK, (uint64_t)8 << 20);
    if (!CWI_SANITIZED)
        limit_resource(RLIMIT_AS, space_in_use() + CHILD_OVERHEAD +
                                      (d->memory ? d->memory : CWI_SANDBOX_MEMORY));
}

/* Closes all files but the socket, which moves behind the standard streams. Those are
 * redirected to /dev/null, since a library must not print the data that it reads. */
static bool drop_files(int *socket, bool all)
{
    const int nowhere = open("/dev/null", O_RDWR);
    if (nowhere < 0)
        return false;
    const int moved = fcntl(*socket, F_DUPFD, LAST_STDIO + 1 + 1);
    for (int fd = 0; fd <= LAST_STDIO; fd++)
        if (dup2(nowhere, fd) < 0)
            return false;
    if (!all) {
        close(nowhere);
        *socket = moved;
        return moved >= 0;
    }
    if (moved < 0 || dup2(moved, LAST_STDIO + 1) < 0)
        return false;
    *socket = LAST_STDIO + 1;
    return close_range(LAST_STDIO + 2, ~0u, 0) == 0;
}

#ifdef CW_SECCOMP
/* Allows a few system calls. All others fail with EPERM, so a library that cannot read its
 * settings goes on without them. */
static bool lock_system_calls(void)
{
    static const int allowed[] = {
        SCMP_SYS(read),         SCMP_SYS(pread64),        SCMP_SYS(readv),
        SCMP_SYS(lseek),        SCMP_SYS(fstat),          SCMP_SYS(close),
        SCMP_SYS(munmap),       SCMP_SYS(mremap),         SCMP_SYS(brk),
        SCMP_SYS(madvise),      SCMP_SYS(futex),          SCMP_SYS(recvmsg),
        SCMP_SYS(sendmsg),      SCMP_SYS(exit),           SCMP_SYS(exit_group),
        SCMP_SYS(rt_sigreturn), SCMP_SYS(rt_sigprocmask), SCMP_SYS(clock_gettime),
        SCMP_SYS(gettimeofday), SCMP_SYS(getrandom),      SCMP_SYS(sched_yield),
        SCMP_SYS(getpid),       SCMP_SYS(gettid),         SCMP_SYS(sigaltstack)};
    const struct scmp_arg_cmp no_code = SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0);
    const struct scmp_arg_cmp no_path = SCMP_A3(SCMP_CMP_EQ, AT_EMPTY_PATH, 0); /* is fstat */
    scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ERRNO(EPERM));
    bool good = filter != NULL;
    for (size_t i = 0; good && i < sizeof allowed / sizeof *allowed; i++)
        good = seccomp_rule_add(filter, SCMP_ACT_ALLOW, allowed[i], 0) == 0;
    good = good && seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(mmap), 1, no_code) == 0 &&
           seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(mprotect), 1, no_code) == 0 &&
           seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(newfstatat), 1, no_path) == 0 &&
           seccomp_load(filter) == 0;
    seccomp_release(filter);
    return good;
}
#else
/* Fails: without libseccomp nothing is sandboxed. */
static bool lock_system_calls(void)
{
    return false;
}
#endif

static bool send_answer(int socket, answer *a)
{
    struct iovec bytes = {.iov_base = a, .iov_len = sizeof *a};
    const struct msghdr head = {.msg_iov = &bytes, .msg_iovlen = 1};
    return sendmsg(socket, &head, MSG_NOSIGNAL) == (ssize_t)sizeof *a;
}

static void serve_requests(const cwi_sandbox *box, int socket)
{
    char request[CWI_SANDBOX_REQUEST];
    int fd;
    while (memset(request, 0, sizeof request),
           receive_parcel(socket, request, sizeof request, &fd)) {
        answer a = {.status = CW_OK};
        a.status = box->desc.work(box->desc.state, fd, request, box->shared, &a.error);
        if (!send_answer(socket, &a))
            return;
    }
}

/* Prepares the library, then confines the process, unless it is trusted. */
static cw_status shut_in(const cwi_sandbox_desc *d, cw_error *err)
{
    cw_status st = d->prepare ? d->prepare(d->state, err) : CW_OK;
    if (st != CW_OK || d->trusted)
        return st;
    if (!HAS_SECCOMP)
        return cwi_fail(
            err, CW_ERR_UNSUPPORTED,
            "%s reads files in a sandbox, which this build lacks (libseccomp-dev); with "
            "desc->no_sandbox it is read in this process",
            d->library);
    set_limits(d);
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 || prctl(PR_SET_DUMPABLE, 0) != 0 ||
        !lock_system_calls())
        return cwi_fail(err, CW_ERR_BACKEND,
                        "the process that is to read with %s cannot be sandboxed (seccomp); "
                        "with desc->no_sandbox it is read in this one",
                        d->library);
    return CW_OK;
}

/* Runs the child. Its first answer reports whether the sandbox is in place. */
_Noreturn static void live(const cwi_sandbox *box, int socket, pid_t parent)
{
    const struct sigaction usual = {.sa_handler = SIG_DFL};
    for (int s = 1; s < NSIG; s++)
        sigaction(s, &usual, NULL);
    signal(SIGINT, SIG_IGN); /* Ctrl-C goes to all processes; the parent ends this one */
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    prctl(PR_SET_NAME, "cubewright-read");
    cwi_alloc_fail_after(-1); /* a test counts the caller's allocations only */
    answer ready = {.status = CW_OK};
    if (getppid() != parent || !drop_files(&socket, !box->desc.trusted))
        _exit(0);
    ready.status = shut_in(&box->desc, &ready.error);
    if (send_answer(socket, &ready) && ready.status == CW_OK)
        serve_requests(box, socket);
    _exit(0);
}

/* --- the parent -------------------------------------------------------------------------- */

static double timeout_s(const cwi_sandbox *box)
{
    return box->desc.timeout_s > 0 ? box->desc.timeout_s : 60;
}

/* Waits until there is something to receive, or the child has ended. */
static cw_status wait_for_answer(const cwi_sandbox *box, cw_error *err)
{
    const double start = cwi_now_s();
    struct pollfd p = {.fd = box->socket, .events = POLLIN};
    while (poll(&p, 1, POLL_MS) < 1) {
        cw_status st =
            box->progress ? cwi_progress(box->progress, "reading", box->done, err) : CW_OK;
        if (st != CW_OK)
            return st;
        if (cwi_now_s() - start > timeout_s(box))
            return cwi_fail(
                err, CW_ERR_BACKEND,
                "%s was stopped after %.6g s without a result; the file is damaged, "
                "or needs a longer desc->timeout_s",
                box->desc.library, timeout_s(box));
    }
    return CW_OK;
}

static cw_status fail_dead(cwi_sandbox *box, cw_error *err)
{
    int how = 0;
    const pid_t child = waitpid(box->child, &how, 0);
    box->child = 0;
    if (child > 0 && WIFSIGNALED(how))
        return cwi_fail(
            err, CW_ERR_BACKEND,
            "%s crashed on it (signal %d, %s), in a process of its own; the file is "
            "damaged or hostile%s",
            box->desc.library, WTERMSIG(how), strsignal(WTERMSIG(how)),
            cwi_memory_is_limited() ? ", or memory is short (ulimit -v)" : "");
    return cwi_fail(err, CW_ERR_BACKEND, "the process that reads with %s ended",
                    box->desc.library);
}

/* Checks an answer, which is untrusted: cuts its text off and makes it printable. */
static cw_status take_answer(answer *a, cw_error *err)
{
    char *text = a->error.message;
    if ((int)a->status < 0 || a->status >= CW_STATUS_COUNT)
        a->status = CW_ERR_BACKEND;
    text[sizeof a->error.message - 1] = '\0';
    for (char *s = text; *s; s++)
        if ((unsigned char)*s < ' ' || *s == 0x7f)
            *s = '?';
    return a->status == CW_OK ? CW_OK : cwi_fail(err, a->status, "%s", text);
}

/* Reports a child that ended before its first answer: it ran only the library's
 * constructors. */
static cw_status fail_unprepared(cwi_sandbox *box, cw_error *err)
{
    int how = 0;
    const pid_t child = waitpid(box->child, &how, 0);
    box->child = 0;
    cwi_sandbox_close(box);
    return cwi_fail(err, CW_ERR_NO_MEMORY,
                    "%s cannot be loaded: its process ended (signal %d); memory or threads are "
                    "short, or the library is damaged",
                    box->desc.library, child > 0 && WIFSIGNALED(how) ? WTERMSIG(how) : 0);
}

static void kill_child(cwi_sandbox *box)
{
    if (box->child > 0) {
        kill(box->child, SIGKILL);
        waitpid(box->child, NULL, 0);
    }
    box->child = 0;
}

cw_status cwi_sandbox_run(cwi_sandbox *box, int fd, const void *request, size_t size,
                          cw_error *err)
{
    char copy[CWI_SANDBOX_REQUEST] = {0};
    answer a = {.status = CW_OK};
    if (!box->open)
        return cwi_fail(err, CW_ERR_BACKEND, "%s is no longer running", box->desc.library);
    memcpy(copy, request, size);
    if (box->desc.inside)
        return box->desc.work(box->desc.state, fd < 0 ? -1 : fcntl(fd, F_DUPFD_CLOEXEC, 0),
                              copy, box->shared, err);
    cw_status st = CW_OK;
    if (send_parcel(box->socket, copy, sizeof copy, fd))
        st = wait_for_answer(box, err);
    if (st == CW_OK && !receive_parcel(box->socket, &a, sizeof a, NULL))
        st = fail_dead(box, err);
    else if (st == CW_OK)
        return take_answer(&a, err);
    cwi_sandbox_close(box);
    return st;
}

static cw_status fail_start(cwi_sandbox *box, const char *what, cw_error *err)
{
    const bool is_short = errno == EAGAIN || errno == ENOMEM;
    const char *why = strerrordesc_np(errno);
    cwi_sandbox_close(box);
    return cwi_fail(err, is_short ? CW_ERR_NO_MEMORY : CW_ERR_BACKEND,
                    "no process for %s: %s: %s", box->desc.library, what,
                    why ? why : "unknown error");
}

/* Maps memory into which the child writes its results, so that this side reads them without a
 * copy. */
static bool share_memory(cwi_sandbox *box)
{
    box->shared = mmap(NULL, box->desc.shared_bytes, PROT_READ | PROT_WRITE,
                       MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (box->shared == MAP_FAILED)
        box->shared = NULL;
    return box->shared != NULL;
}

cw_status cwi_sandbox_open(cwi_sandbox *box, const cwi_sandbox_desc *desc, cw_error *err)
{
    int pair[2];
    answer ready = {.status = CW_OK};
    cw_status st = CW_OK;
    *box = (cwi_sandbox){.desc = *desc, .socket = -1, .open = true};
    if (!share_memory(box)) {
        box->open = false;
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for %zu bytes to share with %s",
                        desc->shared_bytes, desc->library);
    }
    if (desc->inside) {
        st = desc->prepare ? desc->prepare(desc->state, err) : CW_OK;
        if (st != CW_OK)
            cwi_sandbox_close(box);
        return st;
    }
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair) != 0)
        return fail_start(box, "socketpair", err);
    box->socket = pair[0];
    const pid_t parent = getpid();
    box->child = fork();
    if (box->child == 0)
        live(box, pair[1], parent);
    close(pair[1]);
    if (box->child < 0)
        return fail_start(box, "fork", err);
    if (!receive_parcel(box->socket, &ready, sizeof ready, NULL))
        return fail_unprepared(box, err);
    st = take_answer(&ready, err);
    if (st != CW_OK)
        cwi_sandbox_close(box);
    return st;
}

void cwi_sandbox_close(cwi_sandbox *box)
{
    if (!box->open)
        return;
    kill_child(box);
    if (box->socket >= 0)
        close(box->socket);
    if (box->shared)
        munmap(box->shared, box->desc.shared_bytes);
    box->shared = NULL;
    box->socket = -1;
    box->open = false;
}
