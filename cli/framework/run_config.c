/* Reads and writes runs as a part of TOML: keys with texts, numbers, true or false, and lists of
 * these; sections; comments. Keys become words of the command line, and are parsed as such. */
#include "cli/framework/run_config.h"

#include "core/base/atomic_file.h"
#include "core/base/status.h"
#include "core/base/text.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Larger files are no runs. */
enum { MOST_BYTES = 1 << 20 };

/* A file as it is read. */
typedef struct config {
    const cli_command *command;
    const char *path;
    char *text;
    const char *at; /* in the text */
    size_t line;
    bool is_other; /* in a section of another command */
    cli_words *out;
    char **inputs; /* they go last */
    size_t input_count;
} config;

/* An error that tells of the file and the line. */
static cw_status fail_line(const config *c, cw_status st, const char *what, cw_error *err)
{
    return cwi_fail(err, st, "%s:%zu: %s", c->path, c->line, what);
}

/* --- words -------------------------------------------------------------------------------- */

static bool keep_word(char ***list, size_t *count, char *word)
{
    char **longer = word ? realloc(*list, (*count + 1) * sizeof *longer) : NULL;
    if (!longer) {
        free(word);
        return false;
    }
    longer[(*count)++] = word;
    *list = longer;
    return true;
}

static char *join_texts(const char *a, const char *b, const char *c)
{
    const size_t size = strlen(a) + strlen(b) + strlen(c) + 1;
    char *joined = malloc(size);
    if (joined)
        snprintf(joined, size, "%s%s%s", a, b, c);
    return joined;
}

/* --- values ------------------------------------------------------------------------------- */

static void skip_blanks(config *c)
{
    c->at += strspn(c->at, " \t\r");
}

/* Skips blanks, comments and ends of lines: between the items of a list. */
static void skip_lines(config *c)
{
    for (;;) {
        skip_blanks(c);
        if (*c->at == '#')
            c->at += strcspn(c->at, "\n");
        if (*c->at != '\n')
            return;
        c->at++;
        c->line++;
    }
}

/* Reads a text in quotes: "..." with escapes, or '...' without. */
static cw_status read_quoted(config *c, char *out, size_t size, cw_error *err)
{
    static const char escapes[] = "\"\\nt", meant[] = "\"\\\n\t";
    const char quote = *c->at++;
    size_t used = 0;
    while (*c->at && *c->at != '\n' && *c->at != quote && used + 1 < size) {
        const char *escape =
            quote == '"' && *c->at == '\\' && c->at[1] ? strchr(escapes, c->at[1]) : NULL;
        if (quote == '"' && *c->at == '\\' && !escape)
            return fail_line(c, CW_ERR_FORMAT,
                             "expected \\\", \\\\, \\n or \\t behind a backslash, or a text in "
                             "single quotes",
                             err);
        out[used++] = escape ? meant[escape - escapes] : *c->at;
        c->at += escape ? 2 : 1;
    }
    out[used] = '\0';
    if (*c->at != quote)
        return fail_line(c, CW_ERR_FORMAT, "a text in quotes has no end", err);
    c->at++;
    return CW_OK;
}

/* Reads a text, or a number or word without quotes. */
static cw_status read_item(config *c, char *out, size_t size, cw_error *err)
{
    if (*c->at == '"' || *c->at == '\'')
        return read_quoted(c, out, size, err);
    const size_t length = strcspn(c->at, " \t\r\n,]#\"'");
    if (length == 0 || length >= size)
        return fail_line(c, CW_ERR_FORMAT,
                         "expected a value: a text in quotes, a number, true "
                         "or false, or a list of these",
                         err);
    memcpy(out, c->at, length);
    out[length] = '\0';
    c->at += length;
    return CW_OK;
}

typedef cw_status take_item(config *c, void *user, const char *item, cw_error *err);

/* Reads a value, and hands on each item of a list. */
static cw_status read_value(config *c, take_item *take, void *user, cw_error *err)
{
    char item[8192];
    cw_status st = CW_OK;
    if (*c->at != '[') {
        st = read_item(c, item, sizeof item, err);
        return st == CW_OK ? take(c, user, item, err) : st;
    }
    c->at++;
    for (skip_lines(c); st == CW_OK && *c->at != ']'; skip_lines(c)) {
        st = read_item(c, item, sizeof item, err);
        if (st == CW_OK)
            st = take(c, user, item, err);
        if (st != CW_OK)
            return st;
        skip_lines(c);
        if (*c->at != ',' && *c->at != ']')
            return fail_line(c, CW_ERR_FORMAT, "expected ',' or ']' in a list", err);
        c->at += *c->at == ',';
    }
    c->at++;
    return st;
}

static cw_status take_input(config *c, void *user, const char *item, cw_error *err)
{
    (void)user;
    return keep_word(&c->inputs, &c->input_count, join_texts(item, "", ""))
               ? CW_OK
               : cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for the arguments");
}

/* Joins the items of a list by commas, as the command line has them. */
static cw_status take_text(config *c, void *user, const char *item, cw_error *err)
{
    char **text = user;
    (void)c;
    char *longer = *text ? join_texts(*text, ",", item) : join_texts(item, "", "");
    free(*text);
    *text = longer;
    return longer ? CW_OK : cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for a value");
}

/* --- lines -------------------------------------------------------------------------------- */

/* Makes a word of a key and its value. */
static cw_status take_option(config *c, const cli_option *o, const char *value, cw_error *err)
{
    const bool is_on = strcmp(value, "true") == 0;
    cw_error why = {0};
    char *word;
    if (o->kind == CLI_LOUDER)
        return fail_line(c, CW_ERR_ARGUMENT, "verbose is for the command line alone", err);
    if (o->kind == CLI_FLAG) {
        if (!is_on && strcmp(value, "false") != 0) {
            cwi_fail(&why, CW_ERR_ARGUMENT, "%s: expected true or false", o->name);
            return fail_line(c, CW_ERR_ARGUMENT, why.message, err);
        }
        word = join_texts(is_on ? "--" : "--no-", o->name, "");
    } else {
        cw_status st = cli_check_value(o, value, &why);
        if (st != CW_OK)
            return fail_line(c, st, why.message, err);
        char *head = join_texts("--", o->name, "=");
        word = head ? join_texts(head, value, "") : NULL;
        free(head);
    }
    return keep_word(&c->out->owned, &c->out->owned_count, word)
               ? CW_OK
               : cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for the arguments");
}

static cw_status check_command(const config *c, const char *name, cw_error *err)
{
    cw_error why = {0};
    if (strcmp(name, c->command->name) == 0)
        return CW_OK;
    cwi_fail(&why, CW_ERR_ARGUMENT, "it is a run of '%s', not of '%s'", name, c->command->name);
    return fail_line(c, CW_ERR_ARGUMENT, why.message, err);
}

static cw_status take_key(config *c, const char *key, const char *value, cw_error *err)
{
    cw_error why = {0};
    if (strcmp(key, "command") == 0)
        return check_command(c, value, err);
    if (strcmp(key, "config") == 0 || strcmp(key, "save-config") == 0)
        return fail_line(c, CW_ERR_ARGUMENT, "config and save-config are for the command line",
                         err);
    const cli_option *o = cli_find_option(c->command, key, &why);
    return o ? take_option(c, o, value, err) : fail_line(c, CW_ERR_ARGUMENT, why.message, err);
}

/* Reads `key = value`. */
static cw_status read_key(config *c, cw_error *err)
{
    char key[64], *value = NULL;
    const size_t length = strspn(c->at, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                        "0123456789-_");
    if (length == 0 || length >= sizeof key)
        return fail_line(c, CW_ERR_FORMAT, "expected a line such as iso = \"bone\"", err);
    memcpy(key, c->at, length);
    key[length] = '\0';
    c->at += length;
    skip_blanks(c);
    if (*c->at != '=')
        return fail_line(c, CW_ERR_FORMAT, "expected '=' behind a key", err);
    c->at++;
    skip_blanks(c);
    const bool is_input = strcmp(key, "inputs") == 0 && !c->is_other;
    cw_status st =
        is_input ? read_value(c, take_input, NULL, err) : read_value(c, take_text, &value, err);
    if (st == CW_OK && !is_input && !c->is_other)
        st = take_key(c, key, value ? value : "", err);
    free(value);
    return st;
}

/* Reads [section], a command's name. */
static cw_status read_section(config *c, cw_error *err)
{
    const size_t length = strcspn(c->at, "]\n");
    if (c->at[length] != ']')
        return fail_line(c, CW_ERR_FORMAT, "expected ']' behind the name of a section", err);
    c->is_other = strlen(c->command->name) != length - 1 ||
                  strncmp(c->at + 1, c->command->name, length - 1) != 0;
    c->at += length + 1;
    return CW_OK;
}

static cw_status read_lines(config *c, cw_error *err)
{
    cw_status st = CW_OK;
    c->line = 1;
    for (skip_lines(c); *c->at && st == CW_OK; skip_lines(c)) {
        st = *c->at == '[' ? read_section(c, err) : read_key(c, err);
        skip_blanks(c);
        if (st == CW_OK && *c->at && *c->at != '\n' && *c->at != '#')
            st =
                fail_line(c, CW_ERR_FORMAT, "expected the end of the line behind a value", err);
    }
    return st;
}

/* --- files -------------------------------------------------------------------------------- */

static cw_status read_text(config *c, cw_error *err)
{
    FILE *file = fopen(c->path, "rb");
    if (!file)
        return cwi_fail(err, CW_ERR_IO, "%s: cannot be opened: %s", c->path, strerror(errno));
    c->text = malloc(MOST_BYTES + 1);
    const size_t size = c->text ? fread(c->text, 1, MOST_BYTES + 1, file) : 0;
    const bool failed = ferror(file) != 0;
    fclose(file);
    if (!c->text)
        return cwi_fail(err, CW_ERR_NO_MEMORY, "%s: no memory to read it", c->path);
    if (failed)
        return cwi_fail(err, CW_ERR_IO, "%s: cannot be read", c->path);
    if (size > MOST_BYTES || memchr(c->text, 0, size))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "%s: no run: it has a zero byte, or more than a megabyte", c->path);
    c->text[size] = '\0';
    c->at = c->text + (strncmp(c->text, "\xef\xbb\xbf", 3) == 0 ? 3 : 0);
    return CW_OK;
}

/* Returns the file that the words name, or NULL. `view` has an option of that name itself. */
static const char *find_path(const cli_command *command, int count, char **words)
{
    static const char name[] = "--config=";
    for (size_t n = 0; n < command->option_count; n++)
        if (strcmp(command->options[n].name, "config") == 0)
            return NULL;
    for (int n = 0; n < count && strcmp(words[n], "--") != 0; n++) {
        if (strncmp(words[n], name, sizeof name - 1) == 0)
            return words[n] + sizeof name - 1;
        if (n + 1 < count && strncmp(words[n], name, sizeof name - 2) == 0 &&
            words[n][sizeof name - 2] == '\0')
            return words[n + 1];
    }
    return NULL;
}

/* Lists the words of the file, those of the command line, and then the inputs. */
static cw_status list_words(config *c, int count, char **words, cw_error *err)
{
    cli_words *out = c->out;
    size_t said = 0;
    const size_t options = out->owned_count;
    cw_status st = cli_count_inputs(c->command, count, words, &said, err);
    const bool adds = st == CW_OK && said == 0;
    out->words = calloc((size_t)count + options + c->input_count + 2, sizeof *out->words);
    if (st != CW_OK || !out->words)
        return st != CW_OK ? st
                           : cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for the arguments");
    for (size_t n = 0; n < options; n++)
        out->words[out->count++] = out->owned[n];
    for (int n = 0; n < count; n++)
        out->words[out->count++] = words[n];
    if (adds && c->input_count) {
        char *end = join_texts("--", "", "");
        if (!keep_word(&out->owned, &out->owned_count, end))
            return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for the arguments");
        out->words[out->count++] = end;
    }
    for (size_t n = 0; n < c->input_count; n++) {
        char *input = c->inputs[n];
        c->inputs[n] = NULL;
        if (!keep_word(&out->owned, &out->owned_count, input))
            return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for the arguments");
        if (adds)
            out->words[out->count++] = input;
    }
    return CW_OK;
}

cw_status cli_read_config(const cli_command *command, int count, char **words, cli_words *out,
                          cw_error *err)
{
    config c = {.command = command, .path = find_path(command, count, words), .out = out};
    *out = (cli_words){0};
    cw_status st = c.path ? read_text(&c, err) : CW_OK;
    if (st == CW_OK && c.path)
        st = read_lines(&c, err);
    if (st == CW_OK)
        st = list_words(&c, count, words, err);
    for (size_t n = 0; n < c.input_count; n++)
        free(c.inputs[n]);
    free(c.inputs);
    free(c.text);
    return st;
}

void cli_free_words(cli_words *words)
{
    for (size_t n = 0; n < words->owned_count; n++)
        free(words->owned[n]);
    free(words->owned);
    free(words->words);
    *words = (cli_words){0};
}

/* --- writing ------------------------------------------------------------------------------ */

static void put_quoted(FILE *out, const char *text)
{
    fputc('"', out);
    for (; *text; text++) {
        const char *escape = *text == '"' || *text == '\\' ? "\\" : "";
        if (*text == '\n')
            fputs("\\n", out);
        else if (*text == '\t')
            fputs("\\t", out);
        else
            fprintf(out, "%s%c", escape, *text);
    }
    fputc('"', out);
}

/* Returns true for options that are saved: all but those of the output on the screen. */
static bool is_saved(const cli_option *o)
{
    static const char *const not_saved[] = {"quiet", "help", "config", "save-config"};
    for (size_t n = 0; n < sizeof not_saved / sizeof *not_saved; n++)
        if (strcmp(o->name, not_saved[n]) == 0)
            return false;
    return true;
}

/* Returns true if an option was said again later, which counts. */
static bool is_said_again(const cli_said *said, size_t count, size_t n)
{
    for (size_t later = n + 1; later < count; later++)
        if (said[later].option == said[n].option)
            return true;
    return false;
}

static void put_run(FILE *out, const cli_command *command, const cli_common *args,
                    const cli_said *all)
{
    fprintf(out, "# cubewright %s %s --config FILE repeats this run.\ncommand = \"%s\"\n",
            cw_version(), command->name, command->name);
    if (args->input_count) {
        fputs("inputs = [", out);
        for (size_t n = 0; n < args->input_count; n++) {
            fputs(n ? ", " : "", out);
            put_quoted(out, args->inputs[n]);
        }
        fputs("]\n", out);
    }
    for (size_t n = 0; n < args->said_count; n++) {
        const cli_said *said = &all[n];
        if (!is_saved(said->option) || is_said_again(all, args->said_count, n))
            continue;
        fprintf(out, "%s = ", said->option->name);
        if (said->value)
            put_quoted(out, said->value);
        else
            fputs(said->off ? "false" : "true", out);
        fputc('\n', out);
    }
}

cw_status cli_save_config(const cli_command *command, const cli_common *args,
                          const cli_said *said, cw_error *err)
{
    char *text;
    size_t size;
    FILE *out = cwi_text_open(&text, &size);
    if (out)
        put_run(out, command, args, said);
    if (!cwi_text_close(out, &text))
        return cwi_fail(err, CW_ERR_NO_MEMORY, "%s: no memory to write it", args->save_config);
    cw_status st = cwi_outfile_save(args->save_config, text, size, err);
    free(text);
    return st;
}
