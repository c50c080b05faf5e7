/* Somebody else's program at work: in a folder of its own choosing, told by lines, with a limit
 * on the time that it may take. */
#ifndef CLI_BENCH_BENCH_CHILD_H
#define CLI_BENCH_BENCH_CHILD_H

#include <cubewright/core.h>

/* A zeroed child is none. */
typedef struct cli_child {
    int pid; /* 0: none */
    int in, out;
    const char *folder;
    double limit_s; /* of time, for each question */
} cli_child;

/* Starts a program (a path, no name to look for) in a folder, where what it says of errors goes
 * to the file "words". It leads a group of its own, so that what it starts ends with it, and
 * ends with us.
 * Returns  CW_ERR_BACKEND when the system gives no process */
CW_NODISCARD cw_status cli_child_start(cli_child *child, const char *const *argv,
                                       const char *folder, double limit_s, cw_error *err);

/* Says a line (NULL: nothing) and waits for the next one of the child, without its end.
 * Returns  CW_ERR_BACKEND   it ended, gave no answer in time, or one that is too long
 *          CW_ERR_CANCELLED after Ctrl-C; the child is stopped in any of these cases */
CW_NODISCARD cw_status cli_child_ask(cli_child *child, const char *line, char *answer,
                                     size_t room, cw_error *err);

/* Waits until it ends by itself. Returns the same errors, and fails when its exit code is not
 * 0. */
CW_NODISCARD cw_status cli_child_wait(cli_child *child, cw_error *err);

/* Ends it and all it started; harmless on none. */
void cli_child_stop(cli_child *child);

/* The n-th program of a name in the folders of PATH, into path; false: there are no more. */
bool cli_find_program(const char *name, size_t n, char *path, size_t room);

#endif
