/* Declares the console of a command: messages, steps, the progress bar, interruption. */
#ifndef CLI_FRAMEWORK_CONSOLE_H
#define CLI_FRAMEWORK_CONSOLE_H

#include "cli/framework/options.h"

typedef enum cli_progress_mode {
    CLI_PROGRESS_AUTO, /* a bar when stderr is a terminal */
    CLI_PROGRESS_PLAIN,
    CLI_PROGRESS_JSON,
    CLI_PROGRESS_NONE,
} cli_progress_mode;

/* Sets how loud to be, from the common options. Call it before anything is printed. */
void cli_console_start(const cli_common *common, cli_progress_mode mode);

/* Sends results to stderr when a machine-readable output, such as --json -, goes to stdout. */
void cli_console_reserve_stdout(const char *output);

/* To stderr: always unless quiet; only with -v; only with -vv. */
void cli_say(const char *format, ...) CW_PRINTF(1, 2);
void cli_say_v(const char *format, ...) CW_PRINTF(1, 2);
void cli_say_vv(const char *format, ...) CW_PRINTF(1, 2);

/* The one line of an error, on stderr, in red on a terminal. */
void cli_say_error(const char *message);

/* Prints to stdout, unless quiet; to stderr when stdout is reserved. */
void cli_result(const char *format, ...) CW_PRINTF(1, 2);

/* A desc's progress: draws the bar, whose rate counts units (such as "Mvoxel") of total, and
 * cancels the call after Ctrl-C. */
cw_progress cli_progress(double total, const char *unit);

/* Somebody else who hears what is said and how far things are: a window. */
typedef struct cli_listener {
    void *user;
    void (*print_line)(void *user, const char *line);
    bool (*progress)(void *user, const char *step, double done); /* false: stop */
} cli_listener;

/* NULL: nobody any more. */
void cli_console_listen(const cli_listener *listener);

/* Whether Ctrl-C was pressed. */
bool cli_interrupted(void);

/* Wipes the bar before something else is printed. */
void cli_progress_end(void);

/* Turns SIGINT, SIGTERM and SIGHUP into a flag that progress polls; a second signal removes
 * partial files and ends the program. */
void cli_catch_signals(void);

/* Writes a word as a shell, and a script of the window, takes it: in quotes where needed. */
void cli_put_word(FILE *out, const char *word);

/* Seconds since some fixed moment; and the most memory the process has held so far. */
/* With --verbose, says how long a step took and the peak of memory, on a line of its own, also where the
 * command itself is quiet. */
void cli_say_step(const char *name, double seconds);

/* Says it of the step since *start, and sets that to now. */
void cli_end_step(const char *name, double *start);

double cli_seconds(void);
size_t cli_peak_bytes(void);

#endif
