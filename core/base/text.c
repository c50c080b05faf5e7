/* Parses and prints numbers independently of the locale, checks UTF-8, and prints text into
 * memory. */
#define _GNU_SOURCE /* strtod_l, newlocale, fopencookie */
#include "core/base/text.h"

#include <errno.h>
#include <locale.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static locale_t c_locale;
static pthread_once_t c_locale_once = PTHREAD_ONCE_INIT;

static void make_c_locale(void)
{
    c_locale = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
}

/* Returns the C locale, which always exists. (locale_t)0, after memory ran out, leaves the
 * program's own. */
static locale_t get_c_locale(void)
{
    pthread_once(&c_locale_once, make_c_locale);
    return c_locale;
}

/* The digits and the exponent of a decimal number. */
typedef struct decimal {
    uint64_t digits; /* without the point */
    int count;       /* number of digits, including leading zeros */
    int exponent;    /* power of ten */
} decimal;

static const char *read_digits(const char *s, decimal *d, int exponent_step)
{
    for (; *s >= '0' && *s <= '9' && d->count < 19; s++) {
        d->digits = 10 * d->digits + (uint64_t)(*s - '0');
        d->exponent += exponent_step;
        d->count++;
    }
    return s;
}

/* Reads up to three digits behind an 'e'; returns NULL for anything else. */
static const char *read_exponent(const char *s, decimal *d)
{
    const bool negative = *s == '-';
    decimal e = {0};
    s = read_digits(s + (*s == '-' || *s == '+'), &e, 0);
    d->exponent += negative ? -(int)e.digits : (int)e.digits;
    return e.count >= 1 && e.count <= 3 ? s : NULL;
}

/* Parses the most frequent numbers. Digits below 2^53 and powers of ten up to 22 are exact, so
 * their product or quotient is rounded once, as it must be. Returns false for all others and
 * for unusual forms: they are left to strtod, which takes five times as long. */
static bool parse_short(const char **text, double *value)
{
    static const double powers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                    1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                    1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    decimal d = {0};
    const char *s = *text;
    while (*s == ' ' || (*s >= '\t' && *s <= '\r'))
        s++;
    const bool negative = *s == '-';
    s = read_digits(s + (*s == '-' || *s == '+'), &d, 0);
    if (*s == '.')
        s = read_digits(s + 1, &d, -1);
    if (d.count && (*s | 32) == 'e')
        s = read_exponent(s + 1, &d);
    if (!s || !d.count || (*s >= '0' && *s <= '9') || *s == '.' || (*s | 32) == 'x')
        return false;
    if (d.digits > (uint64_t)1 << 53 || d.exponent < -22 || d.exponent > 22)
        return false;
    const double whole = (double)d.digits;
    const double size =
        d.exponent < 0 ? whole / powers[-d.exponent] : whole * powers[d.exponent];
    *value = negative ? -size : size;
    *text = s;
    return true;
}

bool cwi_parse_double(const char **text, double *value)
{
    char *end;
    if (parse_short(text, value))
        return true;
    const locale_t c = get_c_locale();
    const double v = c ? strtod_l(*text, &end, c) : strtod(*text, &end);
    if (end == *text)
        return false;
    *text = end;
    *value = v;
    return true;
}

bool cwi_parse_int(const char **text, int64_t *value)
{
    char *end;
    errno = 0;
    const long long v = strtoll(*text, &end, 10);
    if (end == *text || errno == ERANGE)
        return false;
    *text = end;
    *value = v;
    return true;
}

bool cwi_next_item(const char **text, char *separator, char item[CWI_ITEM_BYTES])
{
    const char *start = *text, *end = start + strcspn(start, ",x;");
    const size_t length = (size_t)(end - start);
    const char found = *end == ';' ? '\0' : *end, before = *separator;
    if (length >= CWI_ITEM_BYTES || (before && found && found != before))
        return false;
    memcpy(item, start, length);
    item[length] = '\0';
    *text = end + (found != '\0');
    *separator = found;
    return true;
}

/* Returns the length of the unit that a text begins with, and what it is in mm; 0: none. */
static size_t match_unit(const char *text, double *mm)
{
    static const struct {
        const char *name;
        double mm;
    } units[] = {{"mm", 1},   {"um", 1e-3}, {"nm", 1e-6}, {"cm", 10},
                 {"m", 1000}, {"in", 25.4}, {"ft", 304.8}};
    for (size_t u = 0; u < sizeof units / sizeof *units; u++)
        if (strncmp(text, units[u].name, strlen(units[u].name)) == 0) {
            *mm = units[u].mm;
            return strlen(units[u].name);
        }
    return 0;
}

bool cwi_parse_length(const char **text, double *mm, bool *unit)
{
    const char *end = *text;
    double factor = 1;
    if (!cwi_parse_double(&end, mm))
        return false;
    const size_t length = match_unit(end, &factor);
    *unit = length > 0;
    *mm *= factor;
    if (!isfinite(*mm))
        return false;
    *text = end + length;
    return true;
}

bool cwi_parse_lengths(const char *text, double mm[3])
{
    char item[CWI_ITEM_BYTES], separator = 0;
    bool has_unit[3];
    double last = 0; /* mm of the last unit */
    int count = 0;
    do {
        const char *at = item;
        if (count == 3 || !cwi_next_item(&text, &separator, item) ||
            !cwi_parse_double(&at, &mm[count]))
            return false;
        const size_t length = match_unit(at, &last);
        has_unit[count] = length > 0;
        mm[count] *= has_unit[count] ? last : 1;
        if (at[length] != '\0' || !isfinite(mm[count]) || !(mm[count] > 0))
            return false;
        count++;
    } while (separator);
    if (*text != '\0' || count == 2 || !has_unit[count - 1])
        return false;
    for (int a = 0; a < count; a++)
        mm[a] *= has_unit[a] ? 1 : last;
    for (int a = count; a < 3; a++)
        mm[a] = mm[0];
    return true;
}

void *cwi_locale_c(void)
{
    const locale_t c = get_c_locale();
    return c ? (void *)uselocale(c) : NULL;
}

void cwi_locale_restore(void *before)
{
    if (before)
        uselocale((locale_t)before);
}

size_t cwi_utf8_length(const char *text)
{
    static const uint32_t lowest[5] = {0, 0, 0x80, 0x800, 0x10000};
    const unsigned char *s = (const unsigned char *)text;
    const size_t n = s[0] < 0x80       ? 1
                     : s[0] >> 5 == 6  ? 2
                     : s[0] >> 4 == 14 ? 3
                     : s[0] >> 3 == 30 ? 4
                                       : 0;
    uint32_t code = n > 1 ? s[0] & (0x7fu >> n) : s[0];
    for (size_t i = 1; i < n; i++) {
        if (s[i] >> 6 != 2)
            return 0;
        code = code << 6 | (s[i] & 0x3f);
    }
    const bool surrogate = code >= 0xd800 && code < 0xe000;
    return n && code >= lowest[n] && code < 0x110000 && !surrogate ? n : 0;
}

/* Text that is written to memory: *text has room for a terminating zero. */
typedef struct text_sink {
    char **text;
    size_t *size, capacity;
} text_sink;

static ssize_t put_text(void *to, const char *bytes, size_t size)
{
    text_sink *sink = to;
    if (size >= sink->capacity - *sink->size) {
        const size_t capacity = 2 * (sink->capacity + size);
        char *more = realloc(*sink->text, capacity);
        if (!more)
            return 0;
        *sink->text = more;
        sink->capacity = capacity;
    }
    memcpy(*sink->text + *sink->size, bytes, size);
    *sink->size += size;
    (*sink->text)[*sink->size] = '\0';
    return (ssize_t)size;
}

static int free_sink(void *sink)
{
    free(sink);
    return 0;
}

/* Replaces open_memstream(), which drops text without an error when memory runs out. */
FILE *cwi_text_open(char **text, size_t *size)
{
    static const cookie_io_functions_t functions = {.write = put_text, .close = free_sink};
    enum { FIRST_CAPACITY = 256 };
    text_sink *sink = malloc(sizeof *sink);
    FILE *stream = sink ? fopencookie(sink, "w", functions) : NULL;
    *size = 0;
    *text = stream ? malloc(FIRST_CAPACITY) : NULL;
    if (!stream)
        free(sink);
    if (stream)
        *sink = (text_sink){text, size, *text ? FIRST_CAPACITY : 0};
    if (*text)
        **text = '\0';
    return stream;
}

bool cwi_text_close(FILE *stream, char **text)
{
    bool good = stream && !ferror(stream);
    if (stream && fclose(stream) != 0)
        good = false;
    if (good && *text)
        return true;
    free(*text);
    *text = NULL;
    return false;
}

void cwi_print_memory(uint64_t bytes, char text[CWI_MEMORY_TEXT])
{
    static const char *const units[] = {"bytes", "KiB", "MiB", "GiB", "TiB"};
    double value = (double)bytes;
    size_t unit = 0;
    for (; value >= 1000 && unit + 1 < sizeof units / sizeof *units; unit++)
        value /= 1024;
    void *before = cwi_locale_c();
    snprintf(text, CWI_MEMORY_TEXT, "%.3g %s", value, units[unit]);
    cwi_locale_restore(before);
}
