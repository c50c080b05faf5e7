/* Parses commands of view from text and runs them. Blanks separate words; a ; or the end of
 * a line separates commands. */
#include "cli/session/view.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_BYTES = 1 << 20 };

/* Behind a command, what looks like a colour is one: #ffeedd. */
static bool is_comment(const char *c, bool is_first)
{
    return *c == '#' && (is_first || !isxdigit((unsigned char)c[1]));
}

/* Takes the next word off the text into out, which has room for all of it, as a shell would:
 * quotes hold blanks. false: the command ends here. *bad: a quote is not closed. */
static bool next_word(const char **text, bool is_first, char *out, bool *bad)
{
    const char *c = *text + strspn(*text, " \t\r");
    *bad = false;
    *text = c;
    if (*c == '\0' || *c == ';' || *c == '\n' || is_comment(c, is_first))
        return false;
    while (*c && !strchr(" \t\r;\n", *c)) {
        if (*c == '\'' || *c == '"') {
            const char *end = strchr(c + 1, *c);
            if (!end) {
                *bad = true;
                return false;
            }
            memcpy(out, c + 1, (size_t)(end - c - 1));
            out += end - c - 1;
            c = end + 1;
        } else {
            c += *c == '\\' && c[1] ? 1 : 0;
            *out++ = *c++;
        }
    }
    *out = '\0';
    *text = c;
    return true;
}

/* Runs the first command of a text, and moves behind it. words, room: as large as the text. */
static cw_status run_first(view *v, const char **text, char **words, char *words_text,
                           cw_error *err)
{
    int count = 0;
    bool bad = false;
    while (next_word(text, count == 0, words_text, &bad)) {
        words[count++] = words_text;
        words_text += strlen(words_text) + 1;
    }
    if (bad)
        return cwi_fail(err, CW_ERR_ARGUMENT, "a quote is not closed: %.60s", *text);
    if (**text == '#')
        *text += strcspn(*text, "\n");
    *text += **text != '\0';
    return count ? view_run(v, count, words, err) : CW_OK;
}

cw_status view_exec(view *v, const char *text, cw_error *err)
{
    const size_t size = strlen(text) + 1;
    char *words_text = malloc(2 * size), **words = malloc(size * sizeof *words);
    cw_status st = words_text && words ? CW_OK : cwi_fail_memory(err);
    while (st == CW_OK && *text)
        st = run_first(v, &text, words, words_text, err);
    free(words);
    free(words_text);
    return st;
}

cw_status view_read_text(const char *path, char **text, cw_error *err)
{
    FILE *in = fopen(path, "rb");
    *text = in ? calloc(1, MAX_BYTES + 1) : NULL;
    if (!*text) {
        if (in)
            fclose(in);
        return cwi_fail(err, CW_ERR_IO, "%s: cannot be read", path);
    }
    const size_t size = fread(*text, 1, MAX_BYTES + 1, in);
    const bool whole = !ferror(in) && size <= MAX_BYTES && strlen(*text) == size;
    fclose(in);
    return whole ? CW_OK
                 : cwi_fail(err, CW_ERR_FORMAT,
                            "%s: commands in a text of up to 1 MiB were expected", path);
}

cw_status view_exec_file(view *v, const char *path, cw_error *err)
{
    char *text;
    cw_status st = view_read_text(path, &text, err);
    if (st == CW_OK) {
        st = view_exec(v, text, err);
        st = st == CW_OK ? st : cwi_fail_in(err, st, path);
    }
    free(text);
    return st;
}

void view_run_queued(view *v)
{
    char **queued = v->script.queued; /* what they ask for is for the next frame */
    const size_t count = v->script.queued_count;
    v->script.queued = NULL;
    v->script.queued_count = 0;
    v->script.is_queued = true;
    for (size_t n = 0; n < count; n++) {
        cw_error err = {0};
        const cw_status st = view_exec(v, queued[n], &err);
        if (st != CW_OK)
            view_say(v, st != CW_ERR_CANCELLED, err.message);
        free(queued[n]);
    }
    v->script.is_queued = false;
    free(queued);
}
