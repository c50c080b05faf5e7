/* Prints messages, the progress bar and results, and ends a run on signals. */
#define _GNU_SOURCE /* sigaction */
#include "cli/framework/console.h"

#include "cli/framework/field_names.h"
#include "cli/framework/quantity.h"
#include "core/base/clock.h"
#include "core/files/atomic_file.h"

#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

static struct {
    bool quiet, bar, color, drawn, results_to_stderr;
    int verbose;
    cli_progress_mode mode;
    double total; /* of the step's units */
    const char *unit;
    char step[32];
    double step_start, last_drawn;
    cli_listener listener;
} console;

static volatile sig_atomic_t interrupted;

void cli_console_start(const cli_common *common, cli_progress_mode mode)
{
    const char *no_color = getenv("NO_COLOR");
    const bool terminal = isatty(STDERR_FILENO);
    console.quiet = common->quiet;
    console.verbose = common->verbose;
    console.mode = mode;
    console.bar = terminal && mode == CLI_PROGRESS_AUTO && !common->quiet;
    console.color = terminal && !(no_color && *no_color);
}

void cli_console_listen(const cli_listener *listener)
{
    console.listener = listener ? *listener : (cli_listener){0};
}

CW_PRINTF(1, 0) static void notify_listener(const char *format, va_list args)
{
    char line[1024];
    vsnprintf(line, sizeof line, format, args);
    console.listener.print_line(console.listener.user, line);
}

CW_PRINTF(1, 0) static void print_line(const char *format, va_list args)
{
    if (console.listener.print_line) {
        va_list copy;
        va_copy(copy, args);
        notify_listener(format, copy);
        va_end(copy);
    }
    cli_progress_end();
    vfprintf(stderr, format, args);
    fputc('\n', stderr);
}

void cli_say(const char *format, ...)
{
    va_list args;
    va_start(args, format);
    if (!console.quiet)
        print_line(format, args);
    va_end(args);
}

void cli_say_v(const char *format, ...)
{
    va_list args;
    va_start(args, format);
    if (!console.quiet && console.verbose > 0)
        print_line(format, args);
    va_end(args);
}

void cli_say_vv(const char *format, ...)
{
    va_list args;
    va_start(args, format);
    if (!console.quiet && console.verbose > 1)
        print_line(format, args);
    va_end(args);
}

void cli_say_step(const char *name, double seconds)
{
    if (console.verbose < 1)
        return;
    cli_progress_end();
    fprintf(stderr, "%-10s %8.3f s, peak %s\n", name, seconds,
            cli_bytes((double)cli_peak_bytes()));
}

void cli_end_step(const char *name, double *start)
{
    const double now = cli_seconds();
    cli_say_step(name, now - *start);
    *start = now;
}

/* Names of files come from outside: nothing in them may move the terminal's cursor. */
void cli_say_error(const char *message)
{
    char text[CLI_MESSAGE];
    cli_progress_end();
    fputs(console.color ? "\033[31mcubewright:\033[0m " : "cubewright: ", stderr);
    for (const unsigned char *c = (const unsigned char *)cli_name_options(message, text); *c;
         c++)
        fputc(*c < 0x20 || *c == 0x7f ? '?' : *c, stderr);
    fputc('\n', stderr);
}

void cli_console_reserve_stdout(const char *output)
{
    if (output && strcmp(output, "-") == 0)
        console.results_to_stderr = true;
}

void cli_result(const char *format, ...)
{
    va_list args;
    va_start(args, format);
    cli_progress_end();
    if (!console.quiet)
        vfprintf(console.results_to_stderr ? stderr : stdout, format, args);
    va_end(args);
}

static void draw_bar(double done, double rate, double left)
{
    enum { WIDTH = 24 };
    char bar[WIDTH + 1] = {0};
    memset(bar, '.', WIDTH);
    memset(bar, '#', (size_t)(done * WIDTH));
    fprintf(stderr, "\r%-12s [%s] %3.0f %%  %.3g %s/s  %d:%02d left \033[K", console.step, bar,
            100 * done, rate, console.unit, (int)left / 60, (int)left % 60);
    console.drawn = true;
}

static void draw_progress(double done, double now)
{
    const double spent = now - console.step_start;
    const double rate = spent > 0 ? done * console.total / spent : 0;
    const double left = done > 0 ? spent * (1 - done) / done : 0;
    if (console.bar)
        draw_bar(done, rate, left);
    else if (console.mode == CLI_PROGRESS_PLAIN)
        fprintf(stderr, "%s %.0f %%, %.3g %s/s, %.0f s left\n", console.step, 100 * done, rate,
                console.unit, left);
    else if (console.mode == CLI_PROGRESS_JSON)
        fprintf(stderr, "{\"step\": \"%s\", \"done\": %.4f, \"seconds_left\": %.1f}\n",
                console.step, done, left);
}

/* Seconds that a run has to hear of a signal, and then to end by itself and remove what it made. */
static struct timeval to_hear = {.tv_usec = 600000}, to_end = {.tv_sec = 10};

/* Returns true after a signal. From then on the run knows of it. */
static bool hear_interrupt(void)
{
    static bool is_known;
    if (interrupted && !is_known) {
        is_known = true;
        setitimer(ITIMER_REAL, &(struct itimerval){.it_value = to_end}, NULL);
    }
    return interrupted;
}

#if CW_TEST_HOOKS
/* Waits for a signal in the step that CUBEWRIGHT_TEST_STEP names, for ever with
 * CUBEWRIGHT_TEST_DEAF. The file of CUBEWRIGHT_TEST_STEP_FILE tells a test that the step is there. */
static void await_signal_in(const char *step)
{
    const char *name = getenv("CUBEWRIGHT_TEST_STEP");
    const char *path = getenv("CUBEWRIGHT_TEST_STEP_FILE");
    if (interrupted || !name || !path || strcmp(name, step) != 0)
        return;
    FILE *file = fopen(path, "w");
    if (file)
        fclose(file);
    while (!interrupted || getenv("CUBEWRIGHT_TEST_DEAF"))
        nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
}
#endif

/* Drawn five times a second at most, and not at all for steps that take less than that. */
static bool report_progress(void *user, const char *step, double done)
{
    (void)user;
    const double now = cli_seconds();
    if (strcmp(step, console.step) != 0) {
        snprintf(console.step, sizeof console.step, "%s", step);
        console.step_start = console.last_drawn = now;
    }
    if (now - console.last_drawn >= 0.2) {
        console.last_drawn = now;
        draw_progress(done < 0 ? 0 : done > 1 ? 1 : done, now);
    }
#if CW_TEST_HOOKS
    await_signal_in(step);
#endif
    const cli_listener *l = &console.listener;
    return !hear_interrupt() && (!l->progress || l->progress(l->user, step, done));
}

bool cli_interrupted(void)
{
    return hear_interrupt();
}

cw_progress cli_progress(double total, const char *unit)
{
    console.total = total;
    console.unit = unit;
    return (cw_progress){.report = report_progress};
}

void cli_progress_end(void)
{
    if (console.drawn)
        fputs("\r\033[K", stderr);
    console.drawn = false;
}

static void end_now(int number)
{
    static const char words[] = "cubewright: interrupted; partial files are removed\n";
    (void)number;
    cwi_outfile_remove_all();
    if (write(STDERR_FILENO, words, sizeof words - 1) < 0) {
        /* there is nobody to tell */
    }
    _exit(cw_status_exit_code(CW_ERR_CANCELLED));
}

/* Steps that ask often end by themselves. Work inside a library may not ask for long: after
 * some time, or at a second signal, it is ended from outside. */
static void on_signal(int number)
{
    if (interrupted)
        end_now(number);
    setitimer(ITIMER_REAL, &(struct itimerval){.it_value = to_hear}, NULL);
    interrupted = 1;
}

void cli_catch_signals(void)
{
    static const int ends[] = {SIGINT, SIGTERM, SIGHUP};
    struct sigaction action = {.sa_handler = on_signal};
#if CW_TEST_HOOKS /* a slow machine needs longer */
    const char *seconds = getenv("CUBEWRIGHT_TEST_GRACE");
    if (seconds)
        to_hear = to_end = (struct timeval){.tv_sec = atol(seconds)};
#endif
    sigemptyset(&action.sa_mask);
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        struct sigaction before;
        sigaction(ends[i], NULL, &before);
        if (before.sa_handler != SIG_IGN) /* nohup */
            sigaction(ends[i], &action, NULL);
    }
    signal(SIGALRM, end_now);
    signal(SIGPIPE, SIG_IGN); /* a failed write is reported where it happens */
    signal(SIGXFSZ, SIG_IGN);
}

double cli_seconds(void)
{
    return cwi_now_s();
}

size_t cli_peak_bytes(void)
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return (size_t)usage.ru_maxrss * 1024;
}

static bool is_plain(const char *word)
{
    return *word && word[strspn(word, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                      "0123456789._/,:=+@%-")] == '\0';
}

void cli_put_word(FILE *out, const char *word)
{
    if (is_plain(word)) {
        fputs(word, out);
        return;
    }
    fputc('\'', out);
    for (; *word; word++)
        if (*word == '\'')
            fputs("'\\''", out);
        else
            fputc(*word, out);
    fputc('\'', out);
}
