/* Parses the words of the command line by a command's table of options, and prints its help. */
#include "cli/framework/options.h"

#include "cli/framework/commands.h"
#include "core/base/status.h"
#include "core/base/text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const cli_option cli_common_options[] = {
    {"quiet", 'q', CLI_FLAG, NULL, "Print errors only", offsetof(cli_common, quiet)},
    {"verbose", 'v', CLI_LOUDER, NULL,
     "Print the time and memory of each step; -vv also the settings",
     offsetof(cli_common, verbose)},
    {"config", 0, CLI_TEXT, "FILE",
     "Read the options of a run from a file of --save-config or --json; the command line comes first "
     "(none)",
     offsetof(cli_common, config), CLI_VALUES_JSON_INPUT},
    {"save-config", 0, CLI_TEXT, "FILE",
     "Write the inputs and options as JSON when the run is done, to repeat it (none)",
     offsetof(cli_common, save_config), CLI_VALUES_FILE},
    {"help", 'h', CLI_FLAG, NULL, "Print the options of the command",
     offsetof(cli_common, help)},
};
const size_t cli_common_option_count = sizeof cli_common_options / sizeof *cli_common_options;

/* Edits between two words: a letter put in, left out, changed, or two swapped. */
static size_t edit_distance(const char *a, const char *b)
{
    enum { LONGEST = 32 };
    size_t d[LONGEST + 1][LONGEST + 1];
    const size_t n = strlen(a), m = strlen(b);
    if (n > LONGEST || m > LONGEST)
        return LONGEST;
    for (size_t i = 0; i <= n; i++)
        for (size_t j = 0; j <= m; j++) {
            if (i == 0 || j == 0) {
                d[i][j] = i + j;
                continue;
            }
            size_t best = d[i - 1][j - 1] + (a[i - 1] != b[j - 1]);
            best = d[i - 1][j] + 1 < best ? d[i - 1][j] + 1 : best;
            best = d[i][j - 1] + 1 < best ? d[i][j - 1] + 1 : best;
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] &&
                d[i - 2][j - 2] + 1 < best)
                best = d[i - 2][j - 2] + 1;
            d[i][j] = best;
        }
    return d[n][m];
}

const char *cli_nearest(const char *word, const char *const *names)
{
    const char *nearest = NULL;
    size_t best = strlen(word) / 3 + 1; /* a third of the letters may be wrong */
    for (; *names; names++) {
        const bool begins = strlen(word) >= 2 && strncmp(word, *names, strlen(word)) == 0;
        const size_t d = begins ? 0 : edit_distance(word, *names);
        if ((d < best || (d == best && !nearest)) && d < strlen(*names)) {
            best = d;
            nearest = *names;
        }
    }
    return nearest;
}

cli_word_finder *cli_find_word;

/* Returns true for a word that is one slip of the fingers away from the name, or its beginning. */
static bool is_slip(const char *word, const char *name)
{
    return edit_distance(word, name) <= 1 || strncmp(word, name, strlen(word)) == 0;
}

void cli_hint(const cli_command *command, const char *word, const char *const *names,
              char hint[CLI_HINT_BYTES])
{
    char found[CLI_HINT_BYTES / 2];
    const char *nearest = cli_nearest(word, names);
    const char *mark = command ? "--" : "'", *end = command ? "" : "'";
    const bool is_found =
        cli_find_word && !(nearest && is_slip(word, nearest)) &&
        (cli_find_word(command, word, false, found, sizeof found) ||
         (!nearest && cli_find_word(command, word, true, found, sizeof found)));
    if (is_found)
        snprintf(hint, CLI_HINT_BYTES, "'cubewright help --search %s' finds %s", word, found);
    else if (nearest)
        snprintf(hint, CLI_HINT_BYTES, "did you mean %s%s%s?", mark, nearest, end);
    else if (command)
        snprintf(hint, CLI_HINT_BYTES, "'cubewright %s -h' lists them", command->name);
    else
        snprintf(hint, CLI_HINT_BYTES, "'cubewright help' lists them");
}

/* Row n of a command's options, the common ones last; NULL behind the end. */
const cli_option *cli_option_at(const cli_command *command, size_t n)
{
    if (n < command->option_count)
        return &command->options[n];
    n -= command->option_count;
    return n < cli_common_option_count ? &cli_common_options[n] : NULL;
}

static const cli_option *find_long(const cli_command *command, const char *name, size_t length)
{
    const cli_option *o;
    for (size_t n = 0; (o = cli_option_at(command, n)); n++)
        if (o->kind != CLI_HEADING && strlen(o->name) == length &&
            strncmp(o->name, name, length) == 0)
            return o;
    return NULL;
}

static const cli_option *find_short(const cli_command *command, char letter)
{
    const cli_option *o;
    for (size_t n = 0; (o = cli_option_at(command, n)); n++)
        if (o->letter == letter)
            return o;
    return NULL;
}

/* Names the commands that have an option, such as "'convert' and 'simplify'"; false: none has. */
static bool name_owners(const char *option, char *text, size_t size)
{
    const char *owners[3];
    size_t count = 0;
    for (size_t n = 0; cli_commands && cli_commands[n] && count < 3; n++)
        if (find_long(cli_commands[n], option, strlen(option)))
            owners[count++] = cli_commands[n]->name;
    if (count == 1)
        snprintf(text, size, "'%s'", owners[0]);
    else if (count == 2)
        snprintf(text, size, "'%s' and '%s'", owners[0], owners[1]);
    return count == 1 || count == 2;
}

static cw_status unknown_option(const cli_command *command, const char *name, size_t length,
                                cw_error *err)
{
    char word[64], itself[68], hint[CLI_HINT_BYTES], owners[96];
    const char *names[CLI_MAX_OPTIONS + 1] = {0};
    const cli_option *o;
    size_t count = 0;
    snprintf(word, sizeof word, "%.*s", (int)(length < 63 ? length : 63), name);
    for (size_t n = 0; (o = cli_option_at(command, n)) && count < CLI_MAX_OPTIONS; n++)
        if (o->kind != CLI_HEADING)
            names[count++] = o->name;
    cli_hint(command, word, names, hint);
    snprintf(itself, sizeof itself, "--%s", word);
    const bool is_elsewhere = !strstr(hint, itself) && name_owners(word, owners, sizeof owners);
    return cwi_fail(err, CW_ERR_ARGUMENT, "%s has no option %s; %s%s%s%s", command->name,
                    itself, hint, is_elsewhere ? "; " : "", is_elsewhere ? owners : "",
                    !is_elsewhere             ? ""
                    : strstr(owners, " and ") ? " have it"
                                              : " has it");
}

bool cli_is_given(const cli_command *command, const cli_common *args, const char *name)
{
    const cli_option *o = find_long(command, name, strlen(name));
    return o >= command->options && o < command->options + command->option_count &&
           args->given[o - command->options];
}

bool cli_option_text(const cli_option *o, const void *args, char *text, size_t size)
{
    *text = '\0';
    if (o->kind->print)
        o->kind->print(o, (const char *)args + o->offset, text, size);
    return *text != '\0';
}

const char *cli_expected(const cli_option *o)
{
    static char text[256];
    const size_t word = o->value ? strcspn(o->value, "/") : 0;
    if (!o->kind->expected)
        return o->value;
    if ((!o->kind->units && o->kind != CLI_NUMBER) || !word || !o->value[word])
        return o->kind->expected;
    snprintf(text, sizeof text, "%.*s, or %s", (int)word, o->value, o->kind->expected);
    return text;
}

/* Says what an option expects, and why its value is not that: quantities without a unit, and % where
 * it has two meanings, look right to people. */
static cw_status refuse_value(const cli_option *o, const char *value, cw_error *err)
{
    const char *end = value, *why = "";
    double number;
    const bool is_range = o->kind == CLI_RANGES || o->kind == CLI_CROP; /* of voxels, too */
    if (o->kind->unit_rule && !is_range && cwi_parse_double(&end, &number)) {
        if (*end == '\0' && isfinite(number) && number != 0)
            why = " names no unit";
        else if (o->kind == CLI_REDUCTION && strcmp(end, "%") == 0)
            why =
                " could mean a part of the triangles, as 'simplify --ratio' takes it, or of the size";
    }
    return cwi_fail(err, CW_ERR_ARGUMENT, "--%s '%s'%s: expected %s", o->name, value, why,
                    cli_expected(o));
}

typedef struct parser {
    const cli_command *command;
    int count, next;
    char **words;
    cli_common *args;
} parser;

/* Returns true if a word is an option of the command: it is no value, then. */
static bool is_option(const cli_command *command, const char *word)
{
    if (word[0] != '-' || !word[1])
        return false;
    return word[1] == '-' ? find_long(command, word + 2, strlen(word + 2)) != NULL
                          : !word[2] && find_short(command, word[1]) != NULL;
}

/* value is what stood behind '=' or the letter; NULL: take the next word. */
static cw_status take_option(parser *p, const cli_option *o, const char *value, bool off,
                             cw_error *err)
{
    void *field = (char *)p->args + o->offset;
    const cli_command *c = p->command;
    if (o >= c->options && o < c->options + c->option_count)
        p->args->given[o - c->options] = true;
    if (o->kind == CLI_LOUDER)
        ++*(int *)field;
    if (o->kind == CLI_FLAG)
        *(bool *)field = !off;
    if (o->kind == CLI_FLAG && p->args->given_options)
        p->args->given_options[p->args->given_count++] =
            (cli_given_option){.option = o, .off = off};
    if (!o->kind->parse)
        return value ? cwi_fail(err, CW_ERR_ARGUMENT, "--%s takes no value", o->name) : CW_OK;
    if (!value && p->next == p->count)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--%s needs a value: %s", o->name,
                        cli_expected(o));
    if (!value && is_option(p->command, p->words[p->next]))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--%s needs a value (%s), and %s is an option",
                        o->name, o->value, p->words[p->next]);
    value = value ? value : p->words[p->next++];
    if (p->args->given_options)
        p->args->given_options[p->args->given_count++] =
            (cli_given_option){.option = o, .value = value};
    if (!o->kind->parse(o, value, field))
        return refuse_value(o, value, err);
    return CW_OK;
}

static cw_status take_long(parser *p, const char *word, cw_error *err)
{
    const char *name = word + 2, *equals = strchr(name, '=');
    const size_t length = equals ? (size_t)(equals - name) : strlen(name);
    const char *value = equals ? equals + 1 : NULL;
    const cli_option *o = find_long(p->command, name, length);
    if (o)
        return take_option(p, o, value, false, err);
    if (length > 3 && strncmp(name, "no-", 3) == 0) {
        o = find_long(p->command, name + 3, length - 3);
        if (o && o->kind == CLI_FLAG)
            return take_option(p, o, value, true, err);
    }
    return unknown_option(p->command, name, length, err);
}

/* -o FILE, -oFILE, and letters of flags together: -qv. */
static cw_status take_short(parser *p, const char *word, cw_error *err)
{
    for (const char *c = word + 1; *c; c++) {
        const cli_option *o = find_short(p->command, *c);
        if (!o)
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "%s has no option -%c; 'cubewright %s -h' lists them",
                            p->command->name, *c, p->command->name);
        if (o->kind->parse)
            return take_option(p, o, c[1] ? c + 1 : NULL, false, err);
        cw_status st = take_option(p, o, NULL, false, err);
        if (st != CW_OK)
            return st;
    }
    return CW_OK;
}

static cw_status check_inputs(const cli_command *c, const cli_common *args, cw_error *err)
{
    if (args->help ||
        (args->input_count >= c->min_inputs && args->input_count <= c->max_inputs))
        return CW_OK;
    if (args->input_count < c->min_inputs)
        return cwi_fail(err, CW_ERR_ARGUMENT, "too few arguments; usage: cubewright %s %s",
                        c->name, c->usage);
    return cwi_fail(err, CW_ERR_ARGUMENT,
                    "'%s' is one argument too many%s; usage: cubewright %s %s",
                    args->inputs[c->max_inputs],
                    c->slices ? " (for slices in separate files, name their folder or put "
                                "quotes around a pattern)"
                              : "",
                    c->name, c->usage);
}

static cw_status take_words(parser *p, cw_error *err)
{
    bool options_end = false;
    cw_status st = CW_OK;
    while (p->next < p->count && st == CW_OK) {
        const char *word = p->words[p->next++];
        if (options_end || word[0] != '-' || word[1] == '\0')
            p->args->inputs[p->args->input_count++] = word;
        else if (strcmp(word, "--") == 0)
            options_end = true;
        else if (word[1] == '-')
            st = take_long(p, word, err);
        else
            st = take_short(p, word, err);
    }
    return st;
}

cw_status cli_parse(const cli_command *command, int count, char **words, void *args,
                    const char **inputs, cw_error *err)
{
    parser p = {command, count, 0, words, args};
    p.args->inputs = inputs;
    cw_status st = take_words(&p, err);
    if (p.args->input_count == 0)
        for (size_t n = 0; n < p.args->config_input_count; n++)
            inputs[p.args->input_count++] = p.args->config_inputs[n];
    return st == CW_OK ? check_inputs(command, p.args, err) : st;
}

const cli_option *cli_find_option(const cli_command *command, const char *name, cw_error *err)
{
    const cli_option *o = find_long(command, name, strlen(name));
    if (!o && err && unknown_option(command, name, strlen(name), err) != CW_OK)
        return NULL;
    return o;
}

bool cli_value_fits(const cli_option *option, const char *value)
{
    void *field = calloc(1, option->kind->size);
    const bool fits =
        !field || option->kind->parse(option, value, field); /* else parsing will say it */
    free(field);
    return fits;
}
