/* Loops on several threads: each layer once, on the threads that there are, whoever calls. */
#define _GNU_SOURCE /* RLIMIT_AS */
#include "core/base/parallel.h"
#include "core/base/sandbox.h"
#include "core/base/thread_pool.h"
#include "support/support.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { LAYERS = 3000, SIZE = 1 << 20 };

/* Counts how often each layer was worked on, and notes which threads did it. */
typedef struct record {
    uint8_t done[LAYERS];
    bool seen[CWI_MAX_THREADS], is_bad;
    int threads; /* that the loop was given */
} record;

static void work_on_layer(void *context, size_t k)
{
    record *r = context;
    const int number = cwi_thread_number();
    if (number < 0 || number >= cwi_threads(r->threads))
        cwi_set_flag(&r->is_bad);
    else
        cwi_set_flag(&r->seen[number]);
    __atomic_fetch_add(&r->done[k], 1, __ATOMIC_RELAXED);
}

static bool each_was_done_once(const record *r)
{
    bool once = !r->is_bad;
    for (size_t k = 0; k < LAYERS; k++)
        once = once && r->done[k] == 1;
    return once;
}

static void each_layer_is_done_once_by_any_number_of_threads(void **state)
{
    (void)state;
    static const int counts[] = {0, 1, 2, 3, 7, 64, 100000};
    for (size_t n = 0; n < sizeof counts / sizeof *counts; n++) {
        record r = {.threads = counts[n]};
        cwi_parallel_for_all(LAYERS, SIZE, counts[n], work_on_layer, &r);
        assert_true(each_was_done_once(&r));
    }
    assert_int_equal(cwi_threads(100000), CWI_MAX_THREADS);
    assert_true(cwi_granted_threads() > 0);
    cwi_parallel_for_all(0, SIZE, 4, work_on_layer, NULL);
}

/* --- threads that must be there ------------------------------------------------------------ */

/* Lets a thread go on when all have come. */
typedef struct meeting {
    pthread_mutex_t lock;
    pthread_cond_t all_here;
    int wanted, here;
    record *inner; /* one for each layer: a loop within it */
    bool changed_thread;
} meeting;

static void meet_others(void *context, size_t k)
{
    meeting *m = context;
    const pthread_t self = pthread_self();
    pthread_mutex_lock(&m->lock);
    if (++m->here == m->wanted)
        pthread_cond_broadcast(&m->all_here);
    while (m->here < m->wanted)
        pthread_cond_wait(&m->all_here, &m->lock);
    pthread_mutex_unlock(&m->lock);
    if (!m->inner)
        return;
    const int number = cwi_thread_number();
    m->inner[k].threads = 1; /* a loop within a loop has one, whose number is 0 */
    cwi_parallel_for_all(LAYERS, SIZE, 4, work_on_layer, &m->inner[k]);
    if (cwi_thread_number() != number || !pthread_equal(self, pthread_self()))
        cwi_set_flag(&m->changed_thread);
}

/* As many layers as threads, none of which ends before all have begun. */
static void as_many_threads_work_as_were_requested(void **state)
{
    (void)state;
    for (int threads = 2; threads <= 16; threads *= 2) {
        meeting m = {PTHREAD_MUTEX_INITIALIZER, PTHREAD_COND_INITIALIZER, .wanted = threads};
        cwi_parallel_for_all((size_t)threads, SIZE, threads, meet_others, &m);
        assert_int_equal(m.here, threads);
    }
}

static void a_loop_within_a_loop_runs_where_it_is(void **state)
{
    (void)state;
    static record inner[4];
    meeting m = {PTHREAD_MUTEX_INITIALIZER, PTHREAD_COND_INITIALIZER, .wanted = 4,
                 .inner = inner};
    memset(inner, 0, sizeof inner);
    cwi_parallel_for_all(4, SIZE, 4, meet_others, &m);
    assert_false(m.changed_thread);
    for (int n = 0; n < 4; n++) {
        assert_true(each_was_done_once(&inner[n]));
        assert_true(inner[n].seen[0]);
    }
    assert_int_equal(cwi_thread_number(), 0);
}

/* --- callers ------------------------------------------------------------------------------- */

static void *loop_many_times(void *bad)
{
    for (int n = 0; n < 50; n++) {
        record r = {.threads = 3};
        cwi_parallel_for_all(LAYERS, SIZE, 3, work_on_layer, &r);
        if (!each_was_done_once(&r))
            cwi_set_flag(bad);
    }
    return NULL;
}

static void several_threads_may_call_at_once(void **state)
{
    (void)state;
    pthread_t callers[4];
    bool bad = false;
    for (int n = 0; n < 4; n++)
        assert_int_equal(pthread_create(&callers[n], NULL, loop_many_times, &bad), 0);
    for (int n = 0; n < 4; n++)
        pthread_join(callers[n], NULL);
    assert_false(bad);
}

typedef struct listening {
    pthread_t caller;
    int calls, stop_at;
    bool is_elsewhere;
} listening;

static bool hear_progress(void *user, const char *step, double done)
{
    listening *l = user;
    l->is_elsewhere = l->is_elsewhere || !pthread_equal(pthread_self(), l->caller) ||
                      strcmp(step, "counting") != 0 || done < 0 || done > 1;
    return ++l->calls != l->stop_at;
}

static void progress_comes_from_the_calling_thread_which_may_stop_the_loop(void **state)
{
    (void)state;
    for (int stop_at = 0; stop_at < 3; stop_at++) {
        record r = {.threads = 4};
        cw_error err = {0};
        listening l = {.caller = pthread_self(), .stop_at = stop_at};
        const cw_progress progress = {hear_progress, &l};
        const cw_status st =
            cwi_parallel_for(LAYERS, SIZE, 4, &progress, "counting", work_on_layer, &r, &err);
        assert_false(l.is_elsewhere);
        assert_true(each_was_done_once(&r) || st == CW_ERR_CANCELLED);
        if (stop_at == 0)
            assert_ok(st, err);
        if (stop_at == 1) { /* before the first layer */
            assert_fails(st, CW_ERR_CANCELLED, "interrupted while counting", err);
            assert_int_equal(r.done[0], 0);
        }
    }
}

/* --- forks --------------------------------------------------------------------------------- */

/* Returns true if a child that does so ends by itself, and well. */
static bool child_does(int (*work)(void))
{
    int how = 0;
    const pid_t child = fork();
    if (child == 0) {
        alarm(test_limit_s()); /* instead of hanging for ever */
        _exit(work());
    }
    return waitpid(child, &how, 0) == child && WIFEXITED(how) && WEXITSTATUS(how) == 0;
}

static int loop_on_four(void)
{
    meeting m = {PTHREAD_MUTEX_INITIALIZER, PTHREAD_COND_INITIALIZER, .wanted = 4};
    record r = {.threads = 4};
    cwi_parallel_for_all(4, SIZE, 4, meet_others, &m); /* waits for all four */
    cwi_parallel_for_all(LAYERS, SIZE, 4, work_on_layer, &r);
    return each_was_done_once(&r) ? 0 : 1;
}

static void a_forked_process_has_threads_of_its_own(void **state)
{
    (void)state;
    if (CWI_SANITIZED)
        skip();
    pthread_t busy[2];
    bool bad = false;
    assert_int_equal(loop_on_four(), 0); /* the pool has threads, which no child inherits */
    assert_true(child_does(loop_on_four));
    for (int n = 0; n < 2; n++)
        assert_int_equal(pthread_create(&busy[n], NULL, loop_many_times, &bad), 0);
    for (int n = 0; n < 20; n++) /* at any moment of what the others do */
        assert_true(child_does(loop_on_four));
    for (int n = 0; n < 2; n++)
        pthread_join(busy[n], NULL);
    assert_false(bad);
}

typedef struct forking {
    pthread_mutex_t lock;
    pthread_cond_t changed;
    bool is_child, has_forked;
    record r;
} forking;

/* Lets the calling thread alone come to its next report. */
static void wait_for_fork(void *context, size_t k)
{
    forking *f = context;
    if (cwi_thread_number() > 0) {
        pthread_mutex_lock(&f->lock);
        while (!f->has_forked)
            pthread_cond_wait(&f->changed, &f->lock);
        pthread_mutex_unlock(&f->lock);
    }
    work_on_layer(&f->r, k);
}

static bool fork_in_progress(void *user, const char *step, double done)
{
    forking *f = user;
    (void)step;
    if (f->has_forked || done <= 0)
        return true;
    int how = 0;
    pthread_mutex_lock(&f->lock);
    const pid_t child = fork();
    f->is_child = child == 0;
    f->has_forked = true;
    pthread_cond_broadcast(&f->changed);
    pthread_mutex_unlock(&f->lock);
    if (f->is_child)
        alarm(test_limit_s());
    else
        assert_true(waitpid(child, &how, 0) == child && WIFEXITED(how) &&
                    WEXITSTATUS(how) == 0);
    return true;
}

/* The threads that work on the loop are not in the child: it may not wait for them. */
static void a_process_forked_within_a_loop_is_told_that_it_cannot_end(void **state)
{
    (void)state;
    if (CWI_SANITIZED)
        skip();
    forking f = {PTHREAD_MUTEX_INITIALIZER, PTHREAD_COND_INITIALIZER, .r.threads = 4};
    cw_error err = {0};
    const cw_progress progress = {fork_in_progress, &f};
    const cw_status st =
        cwi_parallel_for(LAYERS, SIZE, 4, &progress, "counting", wait_for_fork, &f, &err);
    if (f.is_child)
        _exit(st == CW_ERR_CANCELLED && strstr(err.message, "forked") && loop_on_four() == 0
                  ? 0
                  : 1);
    assert_ok(st, err);
    assert_true(f.has_forked);
    assert_true(each_was_done_once(&f.r));
}

/* --- limits -------------------------------------------------------------------------------- */

/* Leaves no room for the stack of a thread. */
static int loop_without_threads(void)
{
    unsigned long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file || fscanf(file, "%lu", &pages) != 1)
        return 1;
    fclose(file);
    const rlim_t bytes = pages * (rlim_t)sysconf(_SC_PAGESIZE) + (2 << 20);
    if (setrlimit(RLIMIT_AS, &(struct rlimit){bytes, bytes}) != 0)
        return 2;
    record r = {.threads = 4};
    cwi_parallel_for_all(LAYERS, SIZE, 4, work_on_layer, &r);
    if (!each_was_done_once(&r))
        return 3;
    return cwi_try_threads(8) == 0 && cwi_granted_threads() == 1 ? 0 : 4;
}

static void a_loop_ends_without_threads_and_tells(void **state)
{
    (void)state;
    if (CWI_SANITIZED)
        skip();
    assert_true(child_does(loop_without_threads));
    assert_int_equal(cwi_granted_threads(), 0);
}

static void the_default_number_can_be_set(void **state)
{
    (void)state;
    const int processors = cwi_threads(0);
    assert_true(processors >= 1);
    cwi_set_default_threads(5);
    assert_int_equal(cwi_threads(0), 5);
    assert_int_equal(cwi_threads(-1), 5);
    assert_int_equal(cwi_threads(2), 2);
    cwi_set_default_threads(0);
    assert_int_equal(cwi_threads(0), processors);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        /* before there are threads: the C library keeps the stacks of those that were */
        cmocka_unit_test(a_loop_ends_without_threads_and_tells),
        cmocka_unit_test(each_layer_is_done_once_by_any_number_of_threads),
        cmocka_unit_test(as_many_threads_work_as_were_requested),
        cmocka_unit_test(a_loop_within_a_loop_runs_where_it_is),
        cmocka_unit_test(several_threads_may_call_at_once),
        cmocka_unit_test(progress_comes_from_the_calling_thread_which_may_stop_the_loop),
        cmocka_unit_test(a_forked_process_has_threads_of_its_own),
        cmocka_unit_test(a_process_forked_within_a_loop_is_told_that_it_cannot_end),
        cmocka_unit_test(the_default_number_can_be_set),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
