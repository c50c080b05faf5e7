/* Parses numbers, lengths, ranges, steps and counts of the command line, and formats numbers
 * for messages. */
#include "cli/framework/quantity.h"

#include "core/base/status.h"
#include "core/base/text.h"

#include <cubewright/filter.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { LONGEST = 32 }; /* number as text */

bool cli_parse_number(const char *text, cli_number *out)
{
    out->given = cwi_parse_double(&text, &out->value) && *text == '\0' && isfinite(out->value);
    return out->given;
}

bool cli_parse_numbers(const char *text, cli_numbers *out)
{
    for (out->count = 0; out->count < CLI_MAX_NUMBERS; text++) {
        double *value = &out->value[out->count++];
        if (!cwi_parse_double(&text, value) || !isfinite(*value))
            return false;
        *value += 0.0; /* -0 is 0 */
        if (*text != ',')
            return *text == '\0';
    }
    return false;
}

/* Names of levels without a number of their own. */
static const struct {
    const char *name;
    cli_level level;
} level_names[] = {
    {"otsu", CLI_LEVEL_OTSU},     {"dark", CLI_LEVEL_DARK}, {"medium", CLI_LEVEL_MEDIUM},
    {"bright", CLI_LEVEL_BRIGHT}, {"bone", CLI_LEVEL_BONE}, {"skin", CLI_LEVEL_SKIN},
    {"soft", CLI_LEVEL_SOFT},     {"lung", CLI_LEVEL_LUNG}, {"metal", CLI_LEVEL_METAL},
};

enum { LEVEL_NAMES = sizeof level_names / sizeof *level_names };

static bool skip_word(const char **text, const char *word)
{
    const size_t length = strlen(word);
    const bool found = strncmp(*text, word, length) == 0;
    *text += found ? length : 0;
    return found;
}

/* Parses what follows half: nothing, or the two values that the level is between. */
static bool parse_half(const char **text, double *value, cli_level *level)
{
    double a, b;
    *value = 50;
    *level = CLI_LEVEL_PERCENT;
    if (**text != ':')
        return true;
    ++*text;
    if (!cwi_parse_double(text, &a) || !skip_word(text, ":") || !cwi_parse_double(text, &b))
        return false;
    *value = a / 2 + b / 2;
    *level = CLI_LEVEL_NUMBER;
    return isfinite(*value);
}

static bool parse_one_level(const char **text, double *value, cli_level *level)
{
    *value = 0;
    *level = CLI_LEVEL_NUMBER;
    for (size_t n = 0; n < LEVEL_NAMES; n++)
        if (skip_word(text, level_names[n].name)) {
            *level = level_names[n].level;
            return true;
        }
    if (skip_word(text, "half"))
        return parse_half(text, value, level);
    if (!cwi_parse_double(text, value) || !isfinite(*value))
        return false;
    *value += 0.0; /* -0 is 0 */
    if (skip_word(text, "%"))
        *level = CLI_LEVEL_PERCENT;
    return *level == CLI_LEVEL_NUMBER || (*value >= 0 && *value <= 100);
}

bool cli_parse_level(const char *text, cli_number *out)
{
    out->given = parse_one_level(&text, &out->value, &out->level) && *text == '\0';
    return out->given;
}

bool cli_parse_levels(const char *text, cli_numbers *out)
{
    for (out->count = 0; out->count < CLI_MAX_NUMBERS; text++) {
        const size_t n = out->count++;
        if (!parse_one_level(&text, &out->value[n], &out->level[n]))
            return false;
        if (*text != ',')
            return *text == '\0';
    }
    return false;
}

bool cli_parse_lengths(const char *text, cli_lengths *out)
{
    return out->given = cwi_parse_lengths(text, out->mm);
}

bool cli_parse_length(const char *text, unsigned units, cli_length *out)
{
    bool is_mm;
    *out = (cli_length){0};
    if (!cwi_parse_length(&text, &out->value, &is_mm))
        return false;
    out->unit = is_mm                      ? CLI_MM
                : strcmp(text, "%") == 0   ? CLI_PERCENT
                : strcmp(text, "vox") == 0 ? CLI_VOXELS
                                           : CLI_MM;
    const bool is_signed = units & CLI_SIGNED;
    const bool is_whole =
        *text == '\0' ? is_mm || (is_signed && out->value == 0) : out->unit != CLI_MM;
    return out->given = is_whole && (units & 1u << out->unit) && (is_signed || out->value > 0);
}

bool cli_parse_amount(const char *text, cli_amount *out)
{
    static const struct {
        const char *name;
        double mm3;
    } units[] = {{"mm3", 1}, {"um3", 1e-9}, {"cm3", 1e3}, {"ml", 1e3}, {"m3", 1e9}, {"vox", 1}};
    if (!cwi_parse_double(&text, &out->value) || !(out->value > 0))
        return false;
    out->voxels = strcmp(text, "vox") == 0;
    for (size_t u = 0; u < sizeof units / sizeof *units && !out->given; u++) {
        out->given = strcmp(text, units[u].name) == 0;
        out->value *= out->given ? units[u].mm3 : 1;
    }
    return out->given && isfinite(out->value) && out->value > 0;
}

bool cli_parse_component(const char *text, cli_component *out)
{
    *out = (cli_component){.given = true, .magnitude = strcmp(text, "mag") == 0};
    return out->magnitude || cli_parse_count(text, 1000, &out->number);
}

bool cli_parse_array(const char *text, cli_array *out)
{
    const char *colon = strrchr(text, ':');
    cli_component component;
    const bool has_component = colon && cli_parse_component(colon + 1, &component);
    const size_t length = has_component ? (size_t)(colon - text) : strlen(text);
    if (length == 0 || length >= sizeof out->name)
        return false;
    memcpy(out->name, text, length);
    out->name[length] = '\0';
    if (has_component)
        out->component = component;
    return true;
}

bool cli_parse_reduction(const char *text, cli_reduction *out)
{
    *out = (cli_reduction){0};
    if (cli_parse_count(text, 1000, &out->triangles))
        return out->triangles > 0;
    return cli_parse_length(text, CLI_IN_MM | CLI_IN_VOXELS, &out->error);
}

double cli_length_mm(const cli_length *length, double diagonal_mm, double voxel_mm)
{
    return length->value * (length->unit == CLI_PERCENT  ? diagonal_mm / 100
                            : length->unit == CLI_VOXELS ? voxel_mm
                                                         : 1);
}

cw_status cli_check_error_limit(const char *option, double error_mm, double diagonal_mm,
                                const char *why, cw_error *err)
{
    static const double LARGE = 0.05; /* as large as details of the shape */
    const double fraction = error_mm / diagonal_mm;
    if (!(fraction > LARGE))
        return CW_OK;
    return cwi_fail(err, CW_ERR_ARGUMENT,
                    "%s %.6g mm is %.3g %% of the diagonal of the box, %.6g mm: little of the "
                    "shape would be left%s; --force does it all the same",
                    option, error_mm, 100 * fraction, diagonal_mm, why ? why : "");
}

bool cli_parse_sizes(const char *text, cli_sizes *out)
{
    char item[CWI_ITEM_BYTES], separator = 0;
    out->count = 0;
    do {
        const char *at = item;
        int64_t n;
        if (out->count == 3 || !cwi_next_item(&text, &separator, item) ||
            !cwi_parse_int(&at, &n) || *at || n < 1 || n > INT32_MAX)
            return false;
        out->n[out->count++] = (size_t)n;
    } while (separator);
    return *text == '\0';
}

/* "10:50" or "-30mm:30mm". *world: with units, which both ends have or none. */
static bool parse_range(const char *text, double *low, double *high, bool *world)
{
    bool unit;
    return cwi_parse_length(&text, low, world) && *text++ == ':' &&
           cwi_parse_length(&text, high, &unit) && unit == *world && *text == '\0' &&
           *low <= *high;
}

/* Three ranges, all with units or all bare. */
bool cli_parse_ranges(const char *text, cli_ranges *out)
{
    char item[CWI_ITEM_BYTES], separator = 0;
    for (int a = 0; a < 3; a++) {
        bool world;
        if (!cwi_next_item(&text, &separator, item) ||
            !parse_range(item, &out->low[a], &out->high[a], &world) ||
            (a > 0 && world != out->world) || (separator != 0) != (a < 2))
            return false;
        out->world = world;
    }
    return out->given = *text == '\0';
}

bool cli_parse_crop(const char *text, cli_ranges *out)
{
    enum { MARGIN = 2 };
    *out = (cli_ranges){.margin = MARGIN};
    if (!skip_word(&text, "auto"))
        return cli_parse_ranges(text, out);
    out->is_auto = true;
    return *text == '\0' || (skip_word(&text, ":") &&
                             cli_parse_count(text, 1000, &out->margin) && out->margin > 0);
}

static bool parse_step(const char **text, size_t *step)
{
    int64_t n;
    if (!cwi_parse_int(text, &n) || n < 0 || n > INT32_MAX)
        return false;
    *step = (size_t)n;
    return true;
}

/* "a", "a:b" or "a:b:by". */
static bool parse_row(const char **text, size_t *first, size_t *last, size_t *by)
{
    *by = 1;
    if (!parse_step(text, first))
        return false;
    *last = *first;
    if (**text != ':')
        return true;
    ++*text;
    if (!parse_step(text, last) || *last < *first)
        return false;
    if (**text != ':')
        return true;
    ++*text;
    return parse_step(text, by) && *by > 0;
}

bool cli_parse_steps(const char *text, cli_steps *out)
{
    *out = (cli_steps){.given = true, .all = strcmp(text, "all") == 0};
    if (out->all)
        return true;
    for (; out->count < CLI_MAX_STEPS; text++) {
        const size_t n = out->count++;
        if (!parse_row(&text, &out->rows[n].first, &out->rows[n].last, &out->rows[n].by) ||
            (n > 0 && out->rows[n].first <= out->rows[n - 1].last))
            return false;
        if (*text != ',')
            return *text == '\0';
    }
    return false;
}

bool cli_parse_count(const char *text, double thousand, size_t *out)
{
    static const char prefixes[] = "kMGT";
    double value;
    if (!cwi_parse_double(&text, &value))
        return false;
    const char *prefix = *text ? strchr(prefixes, *text == 'K' ? 'k' : *text) : NULL;
    if (prefix) {
        value *= pow(thousand, (double)(prefix - prefixes + 1));
        text++;
    }
    if (thousand == 1024 && prefix && *text == 'i') /* GiB: the unit is 1024 anyway */
        text++;
    if (thousand == 1024 && (*text == 'B' || *text == 'b'))
        text++;
    if (*text != '\0' || !(value >= 0) || value > 0x1p62 || value != floor(value))
        return false;
    *out = (size_t)value;
    return true;
}

bool cli_parse_counts(const char *text, cli_counts *out)
{
    for (out->count = 0; out->count < CLI_MAX_COUNTS;) {
        char number[LONGEST];
        const size_t length = strcspn(text, ",");
        if (length >= sizeof number)
            return false;
        memcpy(number, text, length);
        number[length] = '\0';
        if (!cli_parse_count(number, 1000, &out->n[out->count++]))
            return false;
        if (text[length] == '\0')
            return true;
        text += length + 1;
    }
    return false;
}

enum { KEPT = 8 };

static char *next_buffer(void)
{
    static char kept[KEPT][LONGEST];
    static int next;
    next = (next + 1) % KEPT;
    return kept[next];
}

const char *cli_bytes(double bytes)
{
    static const char *const units[] = {"bytes", "kB", "MB", "GB", "TB"};
    char *text = next_buffer();
    int unit = 0;
    for (; bytes >= 1000 && unit < 4; unit++)
        bytes /= 1000;
    snprintf(text, LONGEST, unit ? "%.1f %s" : "%.0f %s", bytes, units[unit]);
    return text;
}

const char *cli_count(size_t count)
{
    char digits[LONGEST], *text = next_buffer();
    const int length = snprintf(digits, sizeof digits, "%zu", count);
    int n = 0;
    for (int i = 0; i < length; i++) {
        if (i > 0 && (length - i) % 3 == 0)
            text[n++] = ' ';
        text[n++] = digits[i];
    }
    text[n] = '\0';
    return text;
}

const char *cli_number_text(double value)
{
    char *text = next_buffer();
    const char *end = text;
    double same;
    if (value == floor(value) && fabs(value) < 1e15) {
        snprintf(text, LONGEST, "%.0f", value);
        return text;
    }
    for (int digits = 1; digits <= 17; digits++, end = text) {
        snprintf(text, LONGEST, "%.*g", digits, value);
        if (cwi_parse_double(&end, &same) && same == value)
            break;
    }
    return text;
}

const char *cli_length_text(const cli_length *length)
{
    static const char *const units[] = {"mm", "%", "vox"};
    char *text = next_buffer();
    snprintf(text, LONGEST, "%s%s", cli_number_text(length->value), units[length->unit]);
    return text;
}

const char *cli_level_text(cli_level level, double value)
{
    if (level == CLI_LEVEL_PERCENT) {
        char *text = next_buffer();
        snprintf(text, LONGEST, "%s%%", cli_number_text(value));
        return text;
    }
    for (size_t n = 0; n < LEVEL_NAMES; n++)
        if (level_names[n].level == level)
            return level_names[n].name;
    return cli_number_text(value);
}
