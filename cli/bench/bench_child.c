/* Starts a program as a child process, exchanges lines with it through pipes, and ends it
 * after a time limit. */
#define _GNU_SOURCE /* pipe2, strchrnul */
#include "cli/bench/bench_child.h"

#include "cli/framework/console.h"
#include "core/base/status.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

bool cli_find_program(const char *name, size_t n, char *path, size_t room)
{
    const char *at = getenv("PATH");
    while (at && *at) {
        const char *end = strchrnul(at, ':');
        const int length = snprintf(path, room, "%.*s/%s", (int)(end - at), at, name);
        const bool good = *at == '/' && length > 0 && (size_t)length < room;
        if (good && access(path, X_OK) == 0 && n-- == 0)
            return true;
        at = *end ? end + 1 : end;
    }
    return false;
}

/* In the child: nothing here may allocate. */
static void exec_child(const char *const *argv, const char *folder, int in, int out)
{
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    setpgid(0, 0);
    signal(SIGPIPE, SIG_DFL);
    signal(SIGXFSZ, SIG_DFL);
    if (chdir(folder) == 0) {
        const int words = open("words", O_WRONLY | O_CREAT | O_TRUNC, 0600);
        if (dup2(in, STDIN_FILENO) >= 0 && dup2(out, STDOUT_FILENO) >= 0 &&
            dup2(words, STDERR_FILENO) >= 0)
            execv(argv[0], (char *const *)argv);
    }
    _exit(127);
}

cw_status cli_child_start(cli_child *c, const char *const *argv, const char *folder,
                          double limit_s, cw_error *err)
{
    int to[2] = {-1, -1}, from[2] = {-1, -1};
    *c = (cli_child){.folder = folder, .limit_s = limit_s};
    if (pipe2(to, O_CLOEXEC) == 0 && pipe2(from, O_CLOEXEC) == 0)
        c->pid = fork();
    if (c->pid == 0 && from[0] >= 0)
        exec_child(argv, folder, to[0], from[1]);
    const int why = errno;
    close(to[0]);
    close(from[1]);
    c->in = to[1];
    c->out = from[0];
    if (c->pid > 0) {
        setpgid(c->pid, c->pid); /* whoever comes first */
        return CW_OK;
    }
    close(c->in);
    close(c->out);
    *c = (cli_child){0};
    return cwi_fail(err, CW_ERR_BACKEND, "no process could be started: %s", strerror(why));
}

void cli_child_stop(cli_child *c)
{
    if (!c->pid)
        return;
    kill(-c->pid, SIGKILL);
    waitpid(c->pid, NULL, 0);
    close(c->in);
    close(c->out);
    *c = (cli_child){0};
}

enum { WORDS = 200 };

/* Returns the last line of its error output. Other than printable ASCII is replaced by '?',
 * because the text is untrusted input. */
static void last_words(const cli_child *c, char words[WORDS])
{
    char path[4096], line[180];
    snprintf(path, sizeof path, "%s/words", c->folder);
    FILE *f = fopen(path, "r");
    *words = '\0';
    while (f && fgets(line, sizeof line, f)) {
        line[strcspn(line, "\n")] = '\0';
        if (*line)
            snprintf(words, WORDS, ": %s", line);
    }
    if (f)
        fclose(f);
    for (char *w = words; *w; w++)
        if (*w < 0x20 || *w >= 0x7f)
            *w = '?';
}

/* It has closed its output: how it ends is soon known, or it is ended. */
static int end_of(cli_child *c)
{
    int status = 0;
    const double deadline = cli_seconds() + 1;
    int ended = 0;
    while ((ended = waitpid(c->pid, &status, WNOHANG)) == 0 && cli_seconds() < deadline)
        usleep(1000);
    if (ended == 0)
        return -1;
    kill(-c->pid, SIGKILL); /* what it leaves behind */
    close(c->in);
    close(c->out);
    c->pid = 0;
    return status;
}

static cw_status how_it_ended(cli_child *c, cw_error *err)
{
    char words[WORDS];
    const int status = end_of(c);
    last_words(c, words);
    cli_child_stop(c);
    if (status == 0)
        return CW_OK;
    if (status == -1)
        return cwi_fail(err, CW_ERR_BACKEND, "it closed its output but did not end");
    if (WIFSIGNALED(status))
        return cwi_fail(err, CW_ERR_BACKEND, "it was ended by signal %d (%s)%s",
                        WTERMSIG(status), strsignal(WTERMSIG(status)), words);
    return cwi_fail(err, CW_ERR_BACKEND, "it ended with exit code %d%s", WEXITSTATUS(status),
                    words);
}

static cw_status fail_ended(cli_child *c, cw_error *err)
{
    const cw_status st = how_it_ended(c, err);
    return st == CW_OK ? cwi_fail(err, CW_ERR_BACKEND, "it ended without an answer") : st;
}

/* Waits for bytes of it. count  how many; 0: it has closed its output */
static cw_status wait_for_bytes(cli_child *c, double deadline, char *bytes, size_t room,
                                size_t *count, cw_error *err)
{
    struct pollfd p = {.fd = c->out, .events = POLLIN};
    int ready = 0;
    while (ready <= 0) {
        const double limit = c->limit_s;
        if (cli_interrupted() || cli_seconds() >= deadline) {
            cli_child_stop(c);
            return cli_interrupted()
                       ? cwi_fail(err, CW_ERR_CANCELLED, "interrupted")
                       : cwi_fail(err, CW_ERR_BACKEND, "it gave no answer in %g s", limit);
        }
        ready = poll(&p, 1, 50);
    }
    const ssize_t got = read(c->out, bytes, room);
    *count = got > 0 ? (size_t)got : 0;
    return CW_OK;
}

cw_status cli_child_ask(cli_child *c, const char *line, char *answer, size_t room,
                        cw_error *err)
{
    const double deadline = cli_seconds() + c->limit_s;
    size_t have = 0, more = 1;
    if (line && dprintf(c->in, "%s\n", line) < 0)
        return fail_ended(c, err);
    for (;;) {
        cw_status st = wait_for_bytes(c, deadline, answer + have, room - 1 - have, &more, err);
        if (st != CW_OK)
            return st;
        if (more == 0)
            return fail_ended(c, err);
        have += more;
        answer[have] = '\0';
        char *end = strchr(answer, '\n');
        if (end) {
            *end = '\0';
            return CW_OK;
        }
        if (have + 1 == room) {
            cli_child_stop(c);
            return cwi_fail(err, CW_ERR_BACKEND, "its answer is not understood");
        }
    }
}

cw_status cli_child_wait(cli_child *c, cw_error *err)
{
    const double deadline = cli_seconds() + c->limit_s;
    char bytes[4096];
    for (size_t count = 1; count > 0;) {
        cw_status st = wait_for_bytes(c, deadline, bytes, sizeof bytes, &count, err);
        if (st != CW_OK)
            return st;
    }
    return how_it_ended(c, err);
}
