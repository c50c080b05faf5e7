/* Parses the words of the command line by a command's table of options, and prints its help. */
#include "cli/framework/options.h"

#include "cli/framework/filter_options.h"
#include "cli/framework/quantity.h"
#include "core/base/status.h"

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
        if (d < best || (d == best && !nearest)) {
            best = d;
            nearest = *names;
        }
    }
    return nearest;
}

/* Row n of a command's options, the common ones last; NULL behind the end. */
static const cli_option *option_at(const cli_command *command, size_t n)
{
    if (n < command->option_count)
        return &command->options[n];
    n -= command->option_count;
    return n < cli_common_option_count ? &cli_common_options[n] : NULL;
}

static const cli_option *find_long(const cli_command *command, const char *name, size_t length)
{
    const cli_option *o;
    for (size_t n = 0; (o = option_at(command, n)); n++)
        if (o->kind != CLI_HEADING && strlen(o->name) == length &&
            strncmp(o->name, name, length) == 0)
            return o;
    return NULL;
}

static const cli_option *find_short(const cli_command *command, char letter)
{
    const cli_option *o;
    for (size_t n = 0; (o = option_at(command, n)); n++)
        if (o->letter == letter)
            return o;
    return NULL;
}

static cw_status unknown_option(const cli_command *command, const char *name, size_t length,
                                cw_error *err)
{
    char word[64];
    const char *names[CLI_MAX_OPTIONS + 1] = {0};
    const cli_option *o;
    size_t count = 0;
    snprintf(word, sizeof word, "%.*s", (int)(length < 63 ? length : 63), name);
    for (size_t n = 0; (o = option_at(command, n)) && count < CLI_MAX_OPTIONS; n++)
        if (o->kind != CLI_HEADING)
            names[count++] = o->name;
    const char *nearest = cli_nearest(word, names);
    if (nearest)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s has no option --%s; did you mean --%s?",
                        command->name, word, nearest);
    return cwi_fail(err, CW_ERR_ARGUMENT,
                    "%s has no option --%s; 'cubewright %s -h' lists them", command->name, word,
                    command->name);
}

bool cli_is_given(const cli_command *command, const cli_common *args, const char *name)
{
    const cli_option *o = find_long(command, name, strlen(name));
    return o >= command->options && o < command->options + command->option_count &&
           args->given[o - command->options];
}

static bool takes_value(const cli_option *o)
{
    return o->kind != CLI_FLAG && o->kind != CLI_LOUDER;
}

/* "above/below": the position of a word in it, or -1. */
static int find_choice(const char *choices, const char *word)
{
    const size_t length = strlen(word);
    for (int n = 0; choices; n++) {
        const char *slash = strchr(choices, '/');
        const size_t here = slash ? (size_t)(slash - choices) : strlen(choices);
        if (here == length && strncmp(choices, word, length) == 0)
            return n;
        choices = slash ? slash + 1 : NULL;
    }
    return -1;
}

static bool store_weight(const char *names, char *item, cli_weights *out)
{
    cli_number weight;
    char *colon = strchr(item, ':');
    if (!colon || !cli_parse_number(colon + 1, &weight) || !(weight.value > 0))
        return false;
    *colon = '\0';
    const int n = find_choice(names, item);
    if (n < 0 || out->of[n] > 0)
        return false;
    out->of[n] = weight.value;
    return true;
}

static bool store_weights(const char *names, const char *text, cli_weights *out)
{
    *out = (cli_weights){.given = true};
    for (;; text++) {
        char item[64];
        const size_t length = strcspn(text, ",");
        if (length >= sizeof item)
            return false;
        memcpy(item, text, length);
        item[length] = '\0';
        if (!store_weight(names, item, out))
            return false;
        text += length;
        if (!*text)
            return true;
    }
}

size_t cli_option_size(const cli_option *o)
{
    static const size_t sizes[] = {
        [CLI_FLAG] = sizeof(bool),
        [CLI_TEXT] = sizeof(const char *),
        [CLI_CHOICE] = sizeof(int),
        [CLI_NUMBER] = sizeof(cli_number),
        [CLI_NUMBERS] = sizeof(cli_numbers),
        [CLI_LEVEL] = sizeof(cli_number),
        [CLI_RESAMPLE] = sizeof(cli_resample),
        [CLI_DENOISE] = sizeof(cli_denoise),
        [CLI_SMOOTHING] = sizeof(cli_smoothing),
        [CLI_PLANE] = sizeof(cli_plane),
        [CLI_LEVELS] = sizeof(cli_numbers),
        [CLI_COUNT] = sizeof(size_t),
        [CLI_COUNTS] = sizeof(cli_counts),
        [CLI_BYTES] = sizeof(size_t),
        [CLI_LENGTHS] = sizeof(cli_lengths),
        [CLI_LENGTH] = sizeof(cli_length),
        [CLI_VOLUME] = sizeof(cli_amount),
        [CLI_SIZES] = sizeof(cli_sizes),
        [CLI_RANGES] = sizeof(cli_ranges),
        [CLI_CROP] = sizeof(cli_ranges),
        [CLI_REDUCTION] = sizeof(cli_reduction),
        [CLI_STEPS] = sizeof(cli_steps),
        [CLI_WEIGHTS] = sizeof(cli_weights),
        [CLI_COMPONENT] = sizeof(cli_component),
        [CLI_LOUDER] = sizeof(int),
        [CLI_HEADING] = 0,
    };
    return sizes[o->kind];
}

/* The n-th of "above/below". */
static void print_choice(const char *choices, int n, char *text, size_t size)
{
    for (; n > 0 && choices; n--) {
        choices = strchr(choices, '/');
        choices = choices ? choices + 1 : NULL;
    }
    snprintf(text, size, "%.*s", choices ? (int)strcspn(choices, "/") : 0, choices);
}

static void print_ranges(const cli_ranges *r, char *text, size_t size)
{
    const char *unit = r->world ? "mm" : "";
    size_t used = 0;
    for (int a = 0; a < 3 && used < size; a++)
        used += (size_t)snprintf(text + used, size - used, "%s%.17g%s:%.17g%s", a ? "," : "",
                                 r->low[a], unit, r->high[a], unit);
}

static void print_numbers(const double *n, size_t count, char *text, size_t size)
{
    size_t used = 0;
    *text = '\0';
    for (size_t i = 0; i < count && used < size; i++)
        used += (size_t)snprintf(text + used, size - used, "%s%.17g", i ? "," : "", n[i]);
}

static void print_levels(const cli_numbers *n, char *text, size_t size)
{
    size_t used = 0;
    for (size_t i = 0; i < n->count && used < size; i++)
        used += (size_t)snprintf(text + used, size - used, "%s%s", i ? "," : "",
                                 cli_level_text(n->level[i], n->value[i]));
}

bool cli_option_text(const cli_option *o, const void *args, char *text, size_t size)
{
    const void *field = (const char *)args + o->offset;
    *text = '\0';
    switch (o->kind) {
    case CLI_TEXT:
        snprintf(text, size, "%s",
                 *(const char *const *)field ? *(const char *const *)field : "");
        break;
    case CLI_CHOICE:
        print_choice(o->value, *(const int *)field, text, size);
        break;
    case CLI_NUMBER:
        print_numbers(&((const cli_number *)field)->value, ((const cli_number *)field)->given,
                      text, size);
        break;
    case CLI_NUMBERS:
        print_numbers(((const cli_numbers *)field)->value, ((const cli_numbers *)field)->count,
                      text, size);
        break;
    case CLI_LEVEL:
        if (((const cli_number *)field)->given)
            snprintf(text, size, "%s",
                     cli_level_text(((const cli_number *)field)->level,
                                    ((const cli_number *)field)->value));
        break;
    case CLI_LEVELS:
        print_levels(field, text, size);
        break;
    case CLI_RESAMPLE:
        if (((const cli_resample *)field)->given)
            snprintf(text, size, "%s", cli_resample_text(field));
        break;
    case CLI_DENOISE:
        if (((const cli_denoise *)field)->given)
            snprintf(text, size, "%s", cli_denoise_text(field));
        break;
    case CLI_PLANE:
        if (((const cli_plane *)field)->given)
            snprintf(text, size, "%s", cli_plane_text(field));
        break;
    case CLI_SMOOTHING:
        if (((const cli_smoothing *)field)->given)
            snprintf(text, size, "%s", cli_smoothing_text(field));
        break;
    case CLI_LENGTHS:
        print_numbers(((const cli_lengths *)field)->mm,
                      ((const cli_lengths *)field)->given ? 3 : 0, text, size);
        break;
    case CLI_COUNT:
    case CLI_BYTES:
        snprintf(text, size, "%zu", *(const size_t *)field);
        break;
    case CLI_RANGES:
    case CLI_CROP:
        if (((const cli_ranges *)field)->is_auto)
            snprintf(text, size, "auto:%zu", ((const cli_ranges *)field)->margin);
        else if (((const cli_ranges *)field)->given)
            print_ranges(field, text, size);
        break;
    case CLI_COMPONENT:
        if (((const cli_component *)field)->magnitude)
            snprintf(text, size, "mag");
        else
            snprintf(text, size, "%zu", ((const cli_component *)field)->number);
        break;
    default:
        break;
    }
    return *text != '\0';
}

static bool store_component(const char *text, cli_component *out)
{
    *out = (cli_component){.given = true, .magnitude = strcmp(text, "mag") == 0};
    return out->magnitude || cli_parse_count(text, 1000, &out->number);
}

/* Stores a value in its field; false when the text is not one of its kind. */
static bool store_value(const cli_option *o, const char *text, void *field)
{
    switch (o->kind) {
    case CLI_TEXT:
        *(const char **)field = text;
        return *text != '\0';
    case CLI_CHOICE:
        return (*(int *)field = find_choice(o->value, text)) >= 0;
    case CLI_NUMBER:
        return cli_parse_number(text, field);
    case CLI_NUMBERS:
        return cli_parse_numbers(text, field);
    case CLI_LEVEL:
        return cli_parse_level(text, field);
    case CLI_LEVELS:
        return cli_parse_levels(text, field);
    case CLI_RESAMPLE:
        return cli_parse_resample(text, field);
    case CLI_DENOISE:
        return cli_parse_denoise(text, field);
    case CLI_SMOOTHING:
        return cli_parse_smoothing(text, field);
    case CLI_PLANE:
        return cli_parse_plane(text, field);
    case CLI_COUNT:
        return cli_parse_count(text, 1000, field);
    case CLI_COUNTS:
        return cli_parse_counts(text, field);
    case CLI_BYTES:
        return cli_parse_count(text, 1024, field);
    case CLI_LENGTHS:
        return cli_parse_lengths(text, field);
    case CLI_LENGTH:
        return cli_parse_length(text, field);
    case CLI_VOLUME:
        return cli_parse_amount(text, field);
    case CLI_REDUCTION:
        return cli_parse_reduction(text, field);
    case CLI_SIZES:
        return cli_parse_sizes(text, field);
    case CLI_RANGES:
        return cli_parse_ranges(text, field);
    case CLI_CROP:
        return cli_parse_crop(text, field);
    case CLI_STEPS:
        return cli_parse_steps(text, field);
    case CLI_WEIGHTS:
        return store_weights(o->value, text, field);
    case CLI_COMPONENT:
        return store_component(text, field);
    default:
        return false;
    }
}

const char *cli_expected(const cli_option *o)
{
    switch (o->kind) {
    case CLI_FLAG:
        return "true or false";
    case CLI_CHOICE:
        return o->value;
    case CLI_NUMBER:
        return "a number";
    case CLI_NUMBERS:
        return "a number, or up to 64 by comma such as 50,300";
    case CLI_LEVEL:
        return "an isovalue such as 300, 40% (of the range), otsu or bone (of a CT)";
    case CLI_LEVELS:
        return "up to 64 isovalues by comma, such as 50,300, 40% (of the range), otsu or bone "
               "(of a CT)";
    case CLI_RESAMPLE:
        return "iso, or a length above 0 such as 0.5mm or 1x1x2mm; then a kernel, if not linear: "
               "0.5mm:cubic, iso:lanczos";
    case CLI_DENOISE:
        return "nlm or nlm:NOISE, aniso or aniso:STEPS (1 to 100) or aniso:STEPS:CONTRAST, "
               "gauss:L such as gauss:0.7vox or gauss:0.5mm, bilateral:L or bilateral:L:VALUES, or "
               "median:N (1 to 3 voxels)";
    case CLI_PLANE:
        return "an axis with a place, such as z=5mm, z=10% of the box, or -z=5mm to keep the other "
               "side; or a point and a normal such as 0,0,5:0,0.1,1";
    case CLI_SMOOTHING:
        return "taubin or hc, with their iterations from 1 to 1000 such as taubin:10, or fair, with "
               "a length such as fair:4vox or fair:2mm";
    case CLI_COUNT:
        return "a whole number such as 500, 50k or 2M";
    case CLI_COUNTS:
        return "up to 16 whole numbers by comma such as 50k,12k,3k";
    case CLI_BYTES:
        return "a size such as 512M or 8G";
    case CLI_LENGTHS:
        return "a length above 0 such as 0.5mm or 12um, or three of them by comma or x";
    case CLI_LENGTH:
        return "a length above 0 such as 0.1mm, 0.05% (of the box's diagonal) or 0.5vox";
    case CLI_VOLUME:
        return "a volume above 0 such as 500mm3, 0.5ml or 30vox";
    case CLI_REDUCTION:
        return "an error with its unit such as 0.1mm, 0.05% (of the box's diagonal) or 0.5vox, "
               "or a number of triangles such as 50k";
    case CLI_SIZES:
        return "whole numbers above 0 joined by x or comma";
    case CLI_RANGES:
        return "three ranges such as 10:50,0:99,20:40 (voxels) or -30mm:30mm,... (world)";
    case CLI_CROP:
        return "three ranges such as 10:50,0:99,20:40 (voxels) or -30mm:30mm,... (world), auto, or "
               "auto with a margin in voxels such as auto:3";
    case CLI_STEPS:
        return "steps in ascending order such as 0:20:2 (ends included), 0,3,7 or all";
    case CLI_WEIGHTS:
        return "weights above 0, each once, such as normal:0.5,color:1,scalar:1";
    case CLI_COMPONENT:
        return "a whole number from 0, or mag";
    default:
        return "a text that is not empty";
    }
}

typedef struct parser {
    const cli_command *command;
    int count, next;
    char **words;
    cli_common *args;
} parser;

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
    if (o->kind == CLI_FLAG && p->args->said)
        p->args->said[p->args->said_count++] = (cli_said){.option = o, .off = off};
    if (!takes_value(o))
        return value ? cwi_fail(err, CW_ERR_ARGUMENT, "--%s takes no value", o->name) : CW_OK;
    if (!value && p->next == p->count)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--%s needs a value: %s", o->name,
                        cli_expected(o));
    value = value ? value : p->words[p->next++];
    if (p->args->said)
        p->args->said[p->args->said_count++] = (cli_said){.option = o, .value = value};
    if (!store_value(o, value, field))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--%s '%s': expected %s", o->name, value,
                        cli_expected(o));
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
        if (takes_value(o))
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
    if (!o && unknown_option(command, name, strlen(name), err) != CW_OK)
        return NULL;
    return o;
}

bool cli_value_fits(const cli_option *option, const char *value)
{
    void *field = calloc(1, cli_option_size(option));
    const bool fits =
        !field || store_value(option, value, field); /* else parsing will say it */
    free(field);
    return fits;
}

/* Width of the help, and the column where the texts of options begin. */
enum { HELP_WIDTH = 96, TEXT_COLUMN = 32 };

void cli_print_wrapped(FILE *out, const char *text, size_t from)
{
    size_t column = from;
    for (bool first = true; *text; first = false) {
        const size_t length = strcspn(text, " ");
        if (!first && column + 1 + length > HELP_WIDTH) {
            fprintf(out, "\n%*s", (int)from, "");
            column = from;
        } else if (!first) {
            fputc(' ', out);
            column++;
        }
        fprintf(out, "%.*s", (int)length, text);
        column += length;
        text += length + (text[length] == ' ');
    }
    fputc('\n', out);
}

/* Prints "--mode a/b/c", after a '/' in a new line where it would be too long; returns its
 * length, or HELP_WIDTH where it took several lines. */
static size_t print_head(const cli_option *o)
{
    const int start =
        printf("  %c%c%s--%s%s", o->letter ? '-' : ' ', o->letter ? o->letter : ' ',
               o->letter ? ", " : "  ", o->name, o->value ? " " : "");
    size_t column = (size_t)start;
    bool broken = false;
    for (const char *v = o->value ? o->value : ""; *v;) {
        const size_t length = strcspn(v, "/") + (strchr(v, '/') != NULL);
        if (column + length > HELP_WIDTH) {
            printf("\n%*s", start, "");
            column = (size_t)start;
            broken = true;
        }
        printf("%.*s", (int)length, v);
        column += length;
        v += length;
    }
    return broken ? HELP_WIDTH : column;
}

static void print_option(const cli_option *o)
{
    if (o->kind == CLI_HEADING) {
        printf("\n%s\n", o->name);
        return;
    }
    const size_t length = print_head(o);
    if (length > TEXT_COLUMN - 2)
        printf("\n%*s", TEXT_COLUMN, "");
    else
        printf("%*s", (int)(TEXT_COLUMN - length), "");
    cli_print_wrapped(stdout, o->about, TEXT_COLUMN);
}

void cli_print_help(const cli_command *command, bool long_form)
{
    const cli_option *o;
    printf("cubewright %s%s%s\n", command->name, *command->usage ? " " : "", command->usage);
    if (long_form)
        printf("\n%s", command->page);
    else
        printf("%s\n", command->about);
    puts("\nOptions (the default in brackets)");
    for (size_t n = 0; (o = option_at(command, n)); n++)
        print_option(o);
    if (long_form && command->print_more)
        command->print_more(stdout);
    if (!long_form)
        printf("\n'cubewright help %s' explains more, with examples.\n", command->name);
}
