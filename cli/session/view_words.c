/* Words of a session: kept, quoted for scripts, asked for by widgets, and said to the user. */
#define _GNU_SOURCE /* vasprintf, strdup */
#include "cli/session/view.h"

#include "cli/framework/field_names.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *view_keep_text(view *v, const char *text)
{
    for (size_t n = 0; n < v->script.word_count; n++)
        if (strcmp(v->script.words[n], text) == 0)
            return v->script.words[n];
    char **words = realloc(v->script.words, (v->script.word_count + 1) * sizeof *words);
    if (!words)
        return NULL;
    v->script.words = words;
    words[v->script.word_count] = strdup(text);
    return words[v->script.word_count] ? words[v->script.word_count++] : NULL;
}

/* Joins the lines of a JSON text to one line, which is one word. */
void view_join_lines(char *text)
{
    for (size_t n = strlen(text); n > 0 && text[n - 1] == '\n'; n--)
        text[n - 1] = '\0';
    for (char *c = text; *c; c++)
        *c = *c == '\n' ? ' ' : *c;
}

void view_ask(view *v, const char *format, ...)
{
    char *text;
    va_list args;
    va_start(args, format);
    const int length = vasprintf(&text, format, args);
    va_end(args);
    char **queued = realloc(v->script.queued, (v->script.queued_count + 1) * sizeof *queued);
    if (queued)
        v->script.queued = queued;
    if (length >= 0 && queued)
        v->script.queued[v->script.queued_count++] = text;
    else if (length >= 0)
        free(text);
}

/* Puts a word in single quotes, so that blanks are part of it. */
void view_ask_open(view *v, const char *path)
{
    char quoted[8192];
    size_t used = 0;
    for (const char *c = path; *c && used + 8 < sizeof quoted; c++)
        used += (size_t)snprintf(quoted + used, sizeof quoted - used,
                                 *c == '\'' ? "'\\''" : "%c", *c);
    quoted[used] = '\0';
    view_ask(v, "open '%s'", quoted);
}

void view_say(view *v, bool is_error, const char *text)
{
    char message[CLI_MESSAGE];
    const double reading_s = is_error ? 30 : 6;
    snprintf(v->message.text, sizeof v->message.text, "%s", cli_name_options(text, message));
    v->message.is_error = is_error;
    v->message.until = v->ui->seconds(v->window) + reading_s;
}
