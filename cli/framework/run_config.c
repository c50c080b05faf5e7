/* Runs as JSON: --config reads what --save-config and reports write of a run. Its options become
 * words of the command line, and are parsed as such. */
#include "cli/framework/run_config.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/files/atomic_file.h"

#include <errno.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>

/* Returns true for options that a run holds: all but those of the output on the screen. */
static bool is_saved(const cli_option *o)
{
    static const char *const not_saved[] = {"quiet", "verbose", "help", "config",
                                            "save-config"};
    for (size_t n = 0; n < sizeof not_saved / sizeof *not_saved; n++)
        if (strcmp(o->name, not_saved[n]) == 0)
            return false;
    return true;
}

/* --- reading ------------------------------------------------------------------------------ */

typedef struct config {
    const cli_command *command;
    const char *path;
    cli_words *out;
} config;

/* Fails with the file, the field, its value and the expected one. */
static cw_status fail_value(const config *c, const char *field, const json_t *found,
                            const char *expected, cw_error *err)
{
    char *text = json_dumps(found, JSON_ENCODE_ANY | JSON_COMPACT);
    cw_status st = cwi_fail(err, CW_ERR_ARGUMENT, "%s: %s: found %.80s, expected %s", c->path,
                            field, text ? text : "a value", expected);
    free(text);
    return st;
}

/* Prints a text, a number, or a list of these by comma. Returns false for other values. */
static bool print_value(FILE *out, const json_t *value, bool in_list)
{
    size_t n;
    json_t *item;
    if (json_is_string(value))
        fputs(json_string_value(value), out);
    else if (json_is_integer(value))
        fprintf(out, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
    else if (json_is_real(value))
        cli_json_number(&(cli_json){.out = out, .first = true}, NULL, json_real_value(value));
    else if (!json_is_array(value) || in_list)
        return false;
    json_array_foreach(value, n, item)
    {
        fputs(n ? "," : "", out);
        if (!print_value(out, item, true))
            return false;
    }
    return true;
}

/* Prints the word of an option. Returns NULL without memory; *fits: the value is of its kind */
static char *make_word(const cli_option *o, const json_t *value, bool *fits)
{
    char *word;
    size_t size;
    FILE *out = cwi_text_open(&word, &size);
    if (!out)
        return NULL;
    *fits = o->kind == CLI_FLAG ? json_is_boolean(value) : true;
    fprintf(out, o->kind == CLI_FLAG && !json_is_true(value) ? "--no-%s" : "--%s", o->name);
    if (o->kind != CLI_FLAG) {
        fputc('=', out);
        *fits = print_value(out, value, false);
    }
    if (!cwi_text_close(out, &word))
        return NULL;
    *fits = *fits && (o->kind == CLI_FLAG || cli_value_fits(o, word + strlen(o->name) + 3));
    return word;
}

static cw_status take_option(const config *c, const char *name, const json_t *value,
                             cw_error *err)
{
    char field[96];
    bool fits = false;
    cw_error why = {0};
    snprintf(field, sizeof field, "options.%.80s", name);
    const cli_option *o = cli_find_option(c->command, name, &why);
    if (!o)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s: %s: %s", c->path, field, why.message);
    if (!is_saved(o))
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s: %s: it is for the command line alone",
                        c->path, field);
    char *word = make_word(o, value, &fits);
    if (!word)
        return cwi_fail_memory(err);
    c->out->words[c->out->count++] = word;
    c->out->owned_count++;
    return fits ? CW_OK : fail_value(c, field, value, cli_expected(o), err);
}

static cw_status take_options(const config *c, json_t *options, cw_error *err)
{
    const char *name;
    json_t *value;
    if (!json_is_object(options))
        return fail_value(c, "options", options, "an object with names of options", err);
    json_object_foreach(options, name, value)
    {
        cw_status st = take_option(c, name, value, err);
        if (st != CW_OK)
            return st;
    }
    return CW_OK;
}

static cw_status take_inputs(const config *c, const json_t *inputs, cw_error *err)
{
    size_t n;
    json_t *input;
    if (!json_is_array(inputs))
        return fail_value(c, "inputs", inputs, "a list of texts", err);
    c->out->inputs = calloc(json_array_size(inputs) + 1, sizeof *c->out->inputs);
    if (!c->out->inputs)
        return cwi_fail_memory(err);
    json_array_foreach(inputs, n, input)
    {
        if (!json_is_string(input))
            return fail_value(c, "inputs", input, "a text", err);
        c->out->inputs[c->out->input_count++] = json_string_value(input);
    }
    return CW_OK;
}

static cw_status take_run(const config *c, json_t *run, cw_error *err)
{
    const char *key;
    json_t *value;
    cw_status st = CW_OK;
    if (!json_is_object(run))
        return fail_value(c, run == c->out->root ? "the file" : "run", run,
                          "an object with command, inputs and options", err);
    json_object_foreach(run, key, value)
    {
        if (strcmp(key, "options") == 0)
            st = take_options(c, value, err);
        else if (strcmp(key, "inputs") == 0)
            st = take_inputs(c, value, err);
        else if (strcmp(key, "command") != 0)
            st = cwi_fail(err, CW_ERR_ARGUMENT,
                          "%s: %.80s: a run has the fields command, inputs and options",
                          c->path, key);
        else if (!json_is_string(value) ||
                 strcmp(json_string_value(value), c->command->name) != 0)
            st = fail_value(c, key, value, c->command->name, err);
        if (st != CW_OK)
            return st;
    }
    return st;
}

/* Reads the file, which the words keep: they point to its texts. */
static cw_status read_root(const config *c, cw_error *err)
{
    json_error_t why;
    FILE *file = fopen(c->path, "rb");
    if (!file)
        return cwi_fail(err, CW_ERR_IO, "%s: cannot be opened: %s", c->path, strerror(errno));
    c->out->root = json_loadf(file, JSON_REJECT_DUPLICATES, &why);
    fclose(file);
    return c->out->root
               ? CW_OK
               : cwi_fail(err, CW_ERR_FORMAT, "%s:%d: %s", c->path, why.line, why.text);
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

cw_status cli_read_config(const cli_command *command, int count, char **words, cli_words *out,
                          cw_error *err)
{
    const config c = {command, find_path(command, count, words), out};
    *out = (cli_words){0};
    cw_status st = c.path ? read_root(&c, err) : CW_OK;
    json_t *run = json_object_get(out->root, "run"); /* of a report */
    const size_t max_count =
        json_object_size(json_object_get(run ? run : out->root, "options"));
    out->words = calloc((size_t)count + max_count + 1, sizeof *out->words);
    if (!out->words)
        return cwi_fail_memory(err);
    if (st == CW_OK && c.path)
        st = take_run(&c, run ? run : out->root, err);
    for (int n = 0; n < count; n++)
        out->words[out->count++] = words[n];
    return st;
}

void cli_free_words(cli_words *words)
{
    for (size_t n = 0; n < words->owned_count; n++)
        free(words->words[n]);
    free(words->words);
    free(words->inputs);
    json_decref(words->root);
    *words = (cli_words){0};
}

/* --- writing ------------------------------------------------------------------------------ */

/* The run of this process. */
static struct {
    const cli_command *command;
    const cli_common *args;
    const cli_given_option *options;
} kept;

void cli_keep_run(const cli_command *command, const cli_common *args,
                  const cli_given_option *options)
{
    kept.command = command;
    kept.args = args;
    kept.options = options;
}

/* Returns true if an option is given again later: the last one counts. */
static bool is_given_again(size_t n)
{
    for (size_t later = n + 1; later < kept.args->given_count; later++)
        if (kept.options[later].option == kept.options[n].option)
            return true;
    return false;
}

static void put_run(cli_json *j, const char *key)
{
    cli_json_open(j, key, '{');
    cli_json_text(j, "command", kept.command->name);
    cli_json_open(j, "inputs", '[');
    for (size_t n = 0; n < kept.args->input_count; n++)
        cli_json_text(j, NULL, kept.args->inputs[n]);
    cli_json_close(j, ']');
    cli_json_open(j, "options", '{');
    for (size_t n = 0; n < kept.args->given_count; n++) {
        const cli_given_option *option = &kept.options[n];
        if (!is_saved(option->option) || is_given_again(n))
            continue;
        if (option->value)
            cli_json_text(j, option->option->name, option->value);
        else
            cli_json_bool(j, option->option->name, !option->off);
    }
    cli_json_close(j, '}');
    cli_json_close(j, '}');
}

void cli_json_begin(cli_json *j, const char *schema)
{
    cli_json_open(j, NULL, '{');
    cli_json_text(j, "schema", schema);
    cli_json_text(j, "tool", "cubewright");
    cli_json_text(j, "version", cw_version());
    put_run(j, "run");
}

cw_status cli_save_config(const char *path, cw_error *err)
{
    char *text;
    size_t size;
    FILE *out = cwi_text_open(&text, &size);
    if (out)
        put_run(&(cli_json){.out = out}, NULL);
    if (!cwi_text_close(out, &text))
        return cwi_fail_in(err, cwi_fail_memory(err), path);
    cw_status st = cwi_outfile_save(path, text, size, err);
    free(text);
    return st;
}
