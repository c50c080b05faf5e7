/* Asks for the stack at the start: a stack that cannot grow is a fault that no function can report. */
#define _DEFAULT_SOURCE /* sigaltstack */
#include "cli/framework/stack_space.h"

#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

/* Bytes: twice those of the deepest calls, and the limit to ask for where a lower one stands. */
enum { STACK_BYTES = 512 << 10, WANTED_BYTES = 2 << 20 };

static void tell_and_end(int number)
{
    static const char text[] =
        "cubewright: memory is short: the stack needs 512 kB ('ulimit -s' and 'ulimit -v' limit it)\n";
    (void)number;
    const ssize_t written = write(STDERR_FILENO, text, sizeof text - 1);
    (void)written;
    _exit(8);
}

/* Raises a limit that is too low, as far as the user may. */
static void raise_limit(void)
{
    struct rlimit limit;
    if (getrlimit(RLIMIT_STACK, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY ||
        limit.rlim_cur >= WANTED_BYTES)
        return;
    const rlim_t most = limit.rlim_max; /* which those who may raise, too */
    limit.rlim_cur = WANTED_BYTES;
    limit.rlim_max = most < WANTED_BYTES ? WANTED_BYTES : most;
    if (setrlimit(RLIMIT_STACK, &limit) == 0)
        return;
    limit.rlim_cur = limit.rlim_max = most;
    setrlimit(RLIMIT_STACK, &limit);
}

/* Writes to the far end of the stack, so that the system grows it. */
static __attribute__((noinline)) void touch_stack(void)
{
    volatile char room[STACK_BYTES];
    room[0] = 0;
    room[sizeof room - 1] = room[0];
}

void cli_reserve_stack(void)
{
    static char other_stack[16 << 10];
    const stack_t other = {.ss_sp = other_stack, .ss_size = sizeof other_stack};
    struct sigaction tell, before;
    stack_t stack_before;
    memset(&tell, 0, sizeof tell);
    tell.sa_handler = tell_and_end;
    tell.sa_flags = SA_ONSTACK;
    sigemptyset(&tell.sa_mask);
    raise_limit();
    if (sigaltstack(&other, &stack_before) != 0)
        return;
    if (sigaction(SIGSEGV, &tell, &before) == 0) {
        touch_stack();
        sigaction(SIGSEGV, &before, NULL);
    }
    sigaltstack(&stack_before, NULL);
}
