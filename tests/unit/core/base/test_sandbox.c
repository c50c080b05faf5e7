/* Tests the sandbox: work runs in a child that can open and reach nothing, and its crashes,
 * hangs and answers are handled. */
#define _GNU_SOURCE /* memfd_create */
#include "support/support.h"

#include "core/base/sandbox.h"
#include "core/base/status.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

/* Deeds that the child is asked to do, and its results in the memory that both see. */
typedef enum deed {
    ADD,
    READ,
    CRASH,
    ABORT,
    HANG,
    FILL_MEMORY,
    OPEN,
    CONNECT,
    RUN,
    KILL,
    SEND_TO_PARENTS_FILE,
    MAP_CODE,
    PRINT,
    FAIL,
    LIE
} deed;

typedef struct request {
    deed deed;
    int number;
} request;

typedef struct result {
    long number;
    int why; /* errno */
    char text[64];
} result;

typedef struct memory_of_child {
    int base, calls;
} memory_of_child;

static void crash(void)
{
    raise(SIGSEGV); /* not permitted in there, as nothing is that reaches a process */
    volatile uintptr_t nowhere = 8;
    *(volatile int *)nowhere = 1;
}

static void fill_memory(result *r)
{
    for (r->number = 0; r->number < 1 << 16; r->number++) {
        char *mib = malloc(1 << 20);
        if (!mib)
            return;
        memset(mib, 1, 1 << 20);
    }
}

static void try_system(const request *q, result *r)
{
    char *const none[] = {NULL};
    errno = 0;
    r->number = q->deed == OPEN      ? open("/dev/zero", O_RDONLY)
                : q->deed == CONNECT ? socket(AF_INET, SOCK_STREAM, 0)
                : q->deed == RUN     ? execve("/bin/true", none, none)
                : q->deed == KILL    ? kill(getppid(), 0)
                : q->deed == SEND_TO_PARENTS_FILE
                    ? write(q->number, "x", 1)
                    : (long)(intptr_t)mmap(NULL, 4096, PROT_READ | PROT_WRITE | PROT_EXEC,
                                           MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    r->why = errno;
}

static cw_status work(void *state, int fd, const void *asked, void *shared, cw_error *err)
{
    const request *q = asked;
    result *r = shared;
    memory_of_child *m = state;
    m->calls++;
    switch (q->deed) {
    case ADD:
        r->number = q->number + m->base + m->calls;
        break;
    case READ:
        r->number = pread(fd, r->text, sizeof r->text - 1, 2);
        close(fd);
        break;
    case CRASH:
        crash();
        break;
    case ABORT:
        abort();
    case HANG:
        for (volatile int forever = 1; forever;) {
        }
        break;
    case FILL_MEMORY:
        fill_memory(r);
        break;
    case PRINT:
        r->number = printf("a name\n") + fprintf(stderr, "a name\n");
        fflush(stdout);
        break;
    case FAIL:
        return cwi_fail(err, CW_ERR_FORMAT, "'Rows' is %d", q->number);
    case LIE:
        memset(err->message, '\n', sizeof err->message);
        return (cw_status)-7;
    default:
        try_system(q, r);
    }
    return CW_OK;
}

static memory_of_child memory;

static cwi_sandbox open_box(bool inside, double timeout_s)
{
    cwi_sandbox box;
    cw_error err = {0};
    memory = (memory_of_child){.base = 100};
    const cwi_sandbox_desc desc = {.library = "libtest",
                                   .work = work,
                                   .state = &memory,
                                   .shared_bytes = 4096,
                                   .memory = (uint64_t)256 << 20,
                                   .timeout_s = timeout_s,
                                   .inside = inside};
    assert_ok(cwi_sandbox_open(&box, &desc, &err), err);
    return box;
}

static cw_status ask(cwi_sandbox *box, deed what, int number, int fd, cw_error *err)
{
    const request q = {.deed = what, .number = number};
    return cwi_sandbox_run(box, fd, &q, sizeof q, err);
}

static const result *found(const cwi_sandbox *box)
{
    return box->shared;
}

static void test_work_is_done_in_the_child(void **state)
{
    (void)state;
    cwi_sandbox box = open_box(false, 0);
    cw_error err = {0};
    for (int n = 1; n < 4; n++) {
        assert_ok(ask(&box, ADD, 1000 * n, -1, &err), err);
        assert_int_equal(found(&box)->number, 1000 * n + 100 + n); /* it keeps its state */
    }
    assert_int_equal(memory.calls, 0); /* this process's copy */
    cwi_sandbox_close(&box);
    cwi_sandbox_close(&box);
}

static void test_work_may_be_done_here(void **state)
{
    (void)state;
    cwi_sandbox box = open_box(true, 0);
    cw_error err = {0};
    assert_ok(ask(&box, ADD, 1, -1, &err), err);
    assert_int_equal(found(&box)->number, 102);
    assert_int_equal(memory.calls, 1);
    assert_int_equal(box.child, 0);
    cwi_sandbox_close(&box);
}

static void test_a_file_is_handed_over(void **state)
{
    (void)state;
    for (int inside = 0; inside < 2; inside++) {
        cwi_sandbox box = open_box(inside, 0);
        cw_error err = {0};
        const int fd = memfd_create("test", MFD_CLOEXEC);
        assert_int_equal(write(fd, "abcdef", 6), 6);
        for (int n = 0; n < 200; n++) /* more than a child may have open at a time */
            assert_ok(ask(&box, READ, 0, fd, &err), err);
        assert_int_equal(found(&box)->number, 4);
        assert_string_equal(found(&box)->text, "cdef");
        assert_int_equal(close(fd), 0); /* still ours */
        cwi_sandbox_close(&box);
    }
}

static void test_what_a_library_dies_of_is_told(void **state)
{
    (void)state;
    static const deed deaths[] = {CRASH, ABORT};
    for (size_t n = 0; n < 2; n++) {
        cwi_sandbox box = open_box(false, 0);
        cw_error err = {0};
        const cw_status st = ask(&box, deaths[n], 0, -1, &err);
        assert_fails(st, CW_ERR_BACKEND, "libtest crashed on it (signal", err);
        assert_fails(ask(&box, ADD, 1, -1, &err), CW_ERR_BACKEND, "no longer running", err);
        cwi_sandbox_close(&box);
    }
}

static void test_work_that_hangs_is_stopped(void **state)
{
    (void)state;
    cwi_sandbox box = open_box(false, 0.3);
    cw_error err = {0};
    assert_fails(ask(&box, HANG, 0, -1, &err), CW_ERR_BACKEND, "stopped after 0.3 s", err);
    cwi_sandbox_close(&box);
}

static void test_work_can_be_cancelled(void **state)
{
    (void)state;
    int polls = 1;
    const cw_progress progress = {.report = test_stop_after, .user = &polls};
    cwi_sandbox box = open_box(false, 0);
    cw_error err = {0};
    box.progress = &progress;
    assert_int_equal(ask(&box, HANG, 0, -1, &err), CW_ERR_CANCELLED);
    cwi_sandbox_close(&box);
}

static void test_the_child_can_reach_nothing(void **state)
{
    (void)state;
    static const deed deeds[] = {OPEN, CONNECT, RUN, KILL, MAP_CODE};
    cwi_sandbox box = open_box(false, 0);
    cw_error err = {0};
    for (size_t n = 0; n < sizeof deeds / sizeof *deeds; n++) {
        assert_ok(ask(&box, deeds[n], 0, -1, &err), err);
        assert_int_equal(found(&box)->number, -1);
        assert_int_equal(found(&box)->why, EPERM);
    }
    cwi_sandbox_close(&box);
}

static void test_the_parents_files_are_closed(void **state)
{
    (void)state;
    const int mine = memfd_create("test", 0);
    cwi_sandbox box = open_box(false, 0);
    cw_error err = {0};
    assert_ok(ask(&box, SEND_TO_PARENTS_FILE, mine, -1, &err), err);
    assert_int_equal(found(&box)->number, -1);
    assert_int_equal(lseek(mine, 0, SEEK_END), 0);
    close(mine);
    cwi_sandbox_close(&box);
}

/* Work that comes before the door closes, where files may still be opened. */
static cw_status look_around(void *state, cw_error *err)
{
    memory_of_child *m = state;
    const int file = open("/dev/zero", O_RDONLY);
    m->base = file >= 0 ? 200 : 300;
    close(file);
    return m->calls ? cwi_fail(err, CW_ERR_UNSUPPORTED, "it is not there") : CW_OK;
}

static cw_status die_of_memory(void *state, cw_error *err)
{
    (void)state, (void)err;
    abort();
}

static void test_libraries_are_loaded_in_the_child(void **state)
{
    (void)state;
    for (int inside = 0; inside < 2; inside++) {
        cwi_sandbox box;
        cw_error err = {0};
        cwi_sandbox_desc desc = {.library = "libtest",
                                 .prepare = look_around,
                                 .work = work,
                                 .state = &memory,
                                 .shared_bytes = 4096,
                                 .inside = inside};
        memory = (memory_of_child){.base = 100};
        assert_ok(cwi_sandbox_open(&box, &desc, &err), err);
        assert_int_equal(memory.base, inside ? 200 : 100);
        assert_ok(ask(&box, ADD, 1, -1, &err), err);
        assert_int_equal(found(&box)->number, 202);
        cwi_sandbox_close(&box);
        memory.calls = 1;
        assert_fails(cwi_sandbox_open(&box, &desc, &err), CW_ERR_UNSUPPORTED, "it is not there",
                     err);
        cwi_sandbox_close(&box);
        desc.prepare = die_of_memory;
        if (!inside)
            assert_fails(cwi_sandbox_open(&box, &desc, &err), CW_ERR_NO_MEMORY,
                         "libtest cannot be loaded: its process ended (signal 6)", err);
    }
}

/* Work on data of our own may open files; what it dies of is no more than an error. */
static void test_trusted_work_may_die(void **state)
{
    (void)state;
    cwi_sandbox box;
    cw_error err = {0};
    const cwi_sandbox_desc desc = {.library = "libtest",
                                   .work = work,
                                   .state = &memory,
                                   .shared_bytes = 4096,
                                   .trusted = true};
    memory = (memory_of_child){.base = 100};
    assert_ok(cwi_sandbox_open(&box, &desc, &err), err);
    assert_ok(ask(&box, OPEN, 0, -1, &err), err);
    assert_true(found(&box)->number >= 0);
    assert_fails(ask(&box, ABORT, 0, -1, &err), CW_ERR_BACKEND, "libtest crashed on it", err);
    assert_false(box.open);
    cwi_sandbox_close(&box);
}

static void test_memory_is_limited(void **state)
{
    (void)state;
#if !CWI_SANITIZED
    cwi_sandbox box = open_box(false, 0);
    cw_error err = {0};
    if (ask(&box, FILL_MEMORY, 0, -1, &err) == CW_OK)
        assert_in_range(found(&box)->number, 100, 260);
    cwi_sandbox_close(&box);
#endif
}

static void test_what_it_prints_is_lost(void **state)
{
    (void)state;
    char text[16];
    FILE *file = tmpfile();
    const int out = dup(1), err_out = dup(2);
    fflush(stdout);
    dup2(fileno(file), 1);
    dup2(fileno(file), 2);
    cwi_sandbox box = open_box(false, 0);
    cw_error err = {0};
    const cw_status st = ask(&box, PRINT, 0, -1, &err);
    cwi_sandbox_close(&box);
    fflush(stdout);
    dup2(out, 1);
    dup2(err_out, 2);
    close(out);
    close(err_out);
    assert_ok(st, err);
    assert_null(fgets(text, sizeof text, file));
    fclose(file);
}

static void test_answers_are_checked(void **state)
{
    (void)state;
    cwi_sandbox box = open_box(false, 0);
    cw_error err = {0};
    assert_fails(ask(&box, FAIL, 77, -1, &err), CW_ERR_FORMAT, "'Rows' is 77", err);
    assert_fails(ask(&box, LIE, 0, -1, &err), CW_ERR_BACKEND, "????", err);
    assert_ok(ask(&box, ADD, 0, -1, &err), err); /* an error is no reason to die */
    cwi_sandbox_close(&box);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_work_is_done_in_the_child),
        cmocka_unit_test(test_work_may_be_done_here),
        cmocka_unit_test(test_a_file_is_handed_over),
        cmocka_unit_test(test_what_a_library_dies_of_is_told),
        cmocka_unit_test(test_work_that_hangs_is_stopped),
        cmocka_unit_test(test_work_can_be_cancelled),
        cmocka_unit_test(test_the_child_can_reach_nothing),
        cmocka_unit_test(test_the_parents_files_are_closed),
        cmocka_unit_test(test_libraries_are_loaded_in_the_child),
        cmocka_unit_test(test_trusted_work_may_die),
        cmocka_unit_test(test_memory_is_limited),
        cmocka_unit_test(test_what_it_prints_is_lost),
        cmocka_unit_test(test_answers_are_checked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
