/* The kinds of options: the size of a field, how its text is parsed and printed, and the words for
 * what is expected. Kinds of one room stand there, such as the filters of cli/inputs. */
#include "cli/framework/options.h"

#include "cli/framework/quantity.h"

#include <string.h>

/* --- parsing ------------------------------------------------------------------------------ */

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

static bool parse_weight(const char *names, char *item, cli_weights *out)
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

static bool parse_weights(const cli_option *o, const char *text, void *field)
{
    cli_weights *out = field;
    *out = (cli_weights){.given = true};
    for (;; text++) {
        char item[64];
        const size_t length = strcspn(text, ",");
        if (length >= sizeof item)
            return false;
        memcpy(item, text, length);
        item[length] = '\0';
        if (!parse_weight(o->value, item, out))
            return false;
        text += length;
        if (!*text)
            return true;
    }
}

static bool parse_text(const cli_option *o, const char *text, void *field)
{
    (void)o;
    *(const char **)field = text;
    return *text != '\0';
}

static bool parse_choice(const cli_option *o, const char *text, void *field)
{
    return (*(int *)field = find_choice(o->value, text)) >= 0;
}

static bool parse_count(const cli_option *o, const char *text, void *field)
{
    return cli_parse_count(text, o->kind == CLI_BYTES ? 1024 : 1000, field);
}

/* "off/L": whether a text is the word before the slash. */
static bool is_word(const cli_option *o, const char *text)
{
    const char *slash = o->value ? strchr(o->value, '/') : NULL;
    const size_t length = slash ? (size_t)(slash - o->value) : 0;
    return slash && strlen(text) == length && strncmp(text, o->value, length) == 0;
}

static bool parse_length(const cli_option *o, const char *text, void *field)
{
    cli_length *out = field;
    if (!is_word(o, text))
        return cli_parse_length(text, o->kind->units, out);
    *out = (cli_length){.given = true, .is_word = true};
    return true;
}

static bool parse_number(const cli_option *o, const char *text, void *field)
{
    cli_number *out = field;
    if (!is_word(o, text))
        return cli_parse_number(text, out);
    *out = (cli_number){.given = true, .is_word = true};
    return true;
}

/* Defines parse_NAME(), which calls cli_parse_NAME(). */
#define PARSER(name)                                                                           \
    static bool parse_##name(const cli_option *o, const char *text, void *field)               \
    {                                                                                          \
        (void)o;                                                                               \
        return cli_parse_##name(text, field);                                                  \
    }
PARSER(numbers)
PARSER(level)
PARSER(levels)
PARSER(counts)
PARSER(lengths)
PARSER(amount)
PARSER(array)
PARSER(component)
PARSER(sizes)
PARSER(ranges)
PARSER(crop)
PARSER(reduction)
PARSER(steps)

/* --- printing ----------------------------------------------------------------------------- */

static void print_list(const double *n, size_t count, char *text, size_t size)
{
    size_t used = 0;
    *text = '\0';
    for (size_t i = 0; i < count && used < size; i++)
        used += (size_t)snprintf(text + used, size - used, "%s%.17g", i ? "," : "", n[i]);
}

static void print_box(const cli_ranges *r, char *text, size_t size)
{
    const char *unit = r->world ? "mm" : "";
    size_t used = 0;
    for (int a = 0; a < 3 && used < size; a++)
        used += (size_t)snprintf(text + used, size - used, "%s%.17g%s:%.17g%s", a ? "," : "",
                                 r->low[a], unit, r->high[a], unit);
}

/* Prints the word of "off/L". */
static void print_word(const cli_option *o, char *text, size_t size)
{
    snprintf(text, size, "%.*s", (int)strcspn(o->value, "/"), o->value);
}

static void print_text(const cli_option *o, const void *field, char *text, size_t size)
{
    const char *value = *(const char *const *)field;
    (void)o;
    snprintf(text, size, "%s", value ? value : "");
}

/* Prints the n-th of "above/below". */
static void print_choice(const cli_option *o, const void *field, char *text, size_t size)
{
    const char *choices = o->value;
    for (int n = *(const int *)field; n > 0 && choices; n--) {
        choices = strchr(choices, '/');
        choices = choices ? choices + 1 : NULL;
    }
    snprintf(text, size, "%.*s", choices ? (int)strcspn(choices, "/") : 0, choices);
}

static void print_number(const cli_option *o, const void *field, char *text, size_t size)
{
    const cli_number *n = field;
    if (n->given && n->is_word)
        print_word(o, text, size);
    else
        print_list(&n->value, n->given, text, size);
}

static void print_numbers(const cli_option *o, const void *field, char *text, size_t size)
{
    const cli_numbers *n = field;
    (void)o;
    print_list(n->value, n->count, text, size);
}

static void print_level(const cli_option *o, const void *field, char *text, size_t size)
{
    const cli_number *n = field;
    (void)o;
    if (n->given)
        snprintf(text, size, "%s", cli_level_text(n->level, n->value));
}

static void print_levels(const cli_option *o, const void *field, char *text, size_t size)
{
    const cli_numbers *n = field;
    size_t used = 0;
    (void)o;
    for (size_t i = 0; i < n->count && used < size; i++)
        used += (size_t)snprintf(text + used, size - used, "%s%s", i ? "," : "",
                                 cli_level_text(n->level[i], n->value[i]));
}

static void print_lengths(const cli_option *o, const void *field, char *text, size_t size)
{
    const cli_lengths *l = field;
    (void)o;
    if (l->given)
        snprintf(text, size, "%.17gx%.17gx%.17gmm", l->mm[0], l->mm[1], l->mm[2]);
}

static void print_length(const cli_option *o, const void *field, char *text, size_t size)
{
    const cli_length *length = field;
    if (length->given && length->is_word)
        print_word(o, text, size);
    else if (length->given)
        snprintf(text, size, "%s", cli_length_text(length));
}

static void print_count(const cli_option *o, const void *field, char *text, size_t size)
{
    (void)o;
    snprintf(text, size, "%zu", *(const size_t *)field);
}

static void print_ranges(const cli_option *o, const void *field, char *text, size_t size)
{
    const cli_ranges *r = field;
    (void)o;
    if (r->is_auto)
        snprintf(text, size, "auto:%zu", r->margin);
    else if (r->given)
        print_box(r, text, size);
}

static void print_component(const cli_option *o, const void *field, char *text, size_t size)
{
    const cli_component *c = field;
    (void)o;
    if (c->magnitude)
        snprintf(text, size, "mag");
    else
        snprintf(text, size, "%zu", c->number);
}

/* The component that was chosen with an array is printed as one chosen by itself. */
static void print_array(const cli_option *o, const void *field, char *text, size_t size)
{
    const cli_array *array = field;
    (void)o;
    snprintf(text, size, "%s", array->name);
}

/* Rules of units, for the manual page. */
#define PERCENT "% of the box's diagonal"
#define VOXELS  "vox"
#define RANGES                                                                                 \
    "places with " CLI_UNITS_MM " are of the world (LPS), others are numbers of voxels"

/* --- the kinds ---------------------------------------------------------------------------- */

/* clang-format off */
const cli_kind cli_kind_flag = {sizeof(bool), NULL, NULL, "true or false"};
const cli_kind cli_kind_text = {sizeof(const char *), parse_text, print_text, "a text that is not empty"};
const cli_kind cli_kind_choice = {sizeof(int), parse_choice, print_choice, NULL};
const cli_kind cli_kind_number = {sizeof(cli_number), parse_number, print_number, "a number"};
const cli_kind cli_kind_numbers = {sizeof(cli_numbers), parse_numbers, print_numbers,
    "a number, or up to 64 by comma such as 50,300"};
const cli_kind cli_kind_level = {sizeof(cli_number), parse_level, print_level,
    "an isovalue such as 300, 40% (of the range), otsu or bone (of a CT)"};
const cli_kind cli_kind_levels = {sizeof(cli_numbers), parse_levels, print_levels,
    "up to 64 isovalues by comma, such as 50,300, 40% (of the range), otsu or bone (of a CT)"};
const cli_kind cli_kind_count = {sizeof(size_t), parse_count, print_count,
    "a whole number such as 500, 50k or 2M"};
const cli_kind cli_kind_counts = {sizeof(cli_counts), parse_counts, NULL,
    "up to 16 whole numbers by comma such as 50k,12k,3k"};
const cli_kind cli_kind_bytes = {sizeof(size_t), parse_count, print_count, "a size such as 512M or 8G"};
const cli_kind cli_kind_lengths = {sizeof(cli_lengths), parse_lengths, print_lengths,
    "a length above 0 with its unit, such as 0.5mm or 12um, or three of them such as 1x1x2mm", CLI_UNITS_MM, CLI_IN_MM};
const cli_kind cli_kind_length = {sizeof(cli_length), parse_length, print_length,
    "a length above 0 with its unit, such as 0.1mm, 0.05% (of the box's diagonal) or 0.5vox",
    CLI_UNITS_MM ", " PERCENT ", or " VOXELS, CLI_IN_MM | CLI_IN_PERCENT | CLI_IN_VOXELS};
const cli_kind cli_kind_mesh_length = {sizeof(cli_length), parse_length, print_length,
    "a length above 0 with its unit, such as 0.1mm or 0.05% (of the box's diagonal)", CLI_UNITS_MM " or " PERCENT,
    CLI_IN_MM | CLI_IN_PERCENT};
const cli_kind cli_kind_voxel_length = {sizeof(cli_length), parse_length, print_length,
    "a length above 0 with its unit, such as 0.5mm or 1vox", CLI_UNITS_MM " or " VOXELS, CLI_IN_MM | CLI_IN_VOXELS};
const cli_kind cli_kind_print_length = {sizeof(cli_length), parse_length, print_length,
    "a length above 0 with its unit, such as 0.8mm", CLI_UNITS_MM, CLI_IN_MM};
const cli_kind cli_kind_shift = {sizeof(cli_length), parse_length, print_length,
    "a length with its unit, such as 1mm, -0.5mm or 0.5% (of the box's diagonal), or 0",
    CLI_UNITS_MM " or " PERCENT "; 0 needs none", CLI_IN_MM | CLI_IN_PERCENT | CLI_SIGNED};
const cli_kind cli_kind_volume = {sizeof(cli_amount), parse_amount, NULL,
    "a volume above 0 with its unit, such as 500mm3, 0.5ml or 30vox", "um3, mm3, cm3, ml, m3 or vox"};
const cli_kind cli_kind_sizes = {sizeof(cli_sizes), parse_sizes, NULL,
    "whole numbers above 0 joined by x or comma"};
const cli_kind cli_kind_ranges = {sizeof(cli_ranges), parse_ranges, print_ranges,
    "three ranges such as 10:50,0:99,20:40 (voxels) or -30mm:30mm,... (world)", RANGES};
const cli_kind cli_kind_crop = {sizeof(cli_ranges), parse_crop, print_ranges,
    "three ranges such as 10:50,0:99,20:40 (voxels) or -30mm:30mm,... (world), auto, or auto with "
    "a margin in voxels such as auto:3", RANGES "; a margin counts voxels"};
const cli_kind cli_kind_reduction = {sizeof(cli_reduction), parse_reduction, NULL,
    "an error limit with its unit, such as 0.1mm or 0.5vox, or a number of triangles such as 50k", CLI_UNITS_MM " or " VOXELS "; a number of triangles has none",
    CLI_IN_MM | CLI_IN_VOXELS};
const cli_kind cli_kind_steps = {sizeof(cli_steps), parse_steps, NULL,
    "steps in ascending order such as 0:20:2 (ends included), 0,3,7 or all"};
const cli_kind cli_kind_weights = {sizeof(cli_weights), parse_weights, NULL,
    "weights above 0, each once, such as normal:0.5,color:1,scalar:1"};
const cli_kind cli_kind_array = {sizeof(cli_array), parse_array, print_array,
    "a name, also with a component of it such as velocity:mag or velocity:1"};
const cli_kind cli_kind_component = {sizeof(cli_component), parse_component, print_component,
    "a whole number from 0, or mag"};
const cli_kind cli_kind_louder = {sizeof(int), NULL, NULL, NULL};
const cli_kind cli_kind_heading = {0, NULL, NULL, NULL};
/* clang-format on */
