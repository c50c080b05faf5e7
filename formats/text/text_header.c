/* Reads the lines of text headers, and parses their fields: words, numbers and sizes. */
#include "formats/text/text_header.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"

#include <ctype.h>
#include <string.h>

enum { MAX_HEADER = 1 << 20, MAX_LINE = 1 << 16 };

/* Finds the character that ends lines: a line feed, or a carriage return, as on an old
 * Macintosh, where it alone ends the first line. */
static char find_line_end(const char *text, size_t size)
{
    const char *feed = memchr(text, '\n', size);
    const char *cr = memchr(text, '\r', feed ? (size_t)(feed - text) : size);
    const bool alone = cr && cr + 1 < text + size && cr[1] != '\n' && cr[1] != '\r';
    return alone ? '\r' : '\n';
}

cw_status cwi_lines_open(cwi_lines *lines, const cwi_input *in, cw_error *err)
{
    *lines = (cwi_lines){.cut = in->size > MAX_HEADER};
    const size_t size = lines->cut ? MAX_HEADER : (size_t)in->size;
    lines->text = cwi_alloc_array(size + 1, 1);
    if (!lines->text)
        return cwi_fail_memory(err);
    cw_status st = cwi_input_read_at(in->fd, 0, lines->text, size, &lines->size, err);
    lines->end = find_line_end(lines->text, lines->size);
    return st;
}

void cwi_lines_close(cwi_lines *lines)
{
    cwi_free(lines->text);
    *lines = (cwi_lines){0};
}

static cw_status check_line(const cwi_lines *lines, const char *line, size_t length, bool ends,
                            cw_error *err)
{
    if (length > MAX_LINE)
        return cwi_fail(err, CW_ERR_FORMAT, "line %zu of the header is longer than 64 KiB",
                        lines->number);
    if (!ends && lines->cut)
        return cwi_fail(err, CW_ERR_FORMAT, "the header is longer than 1 MiB");
    if (memchr(line, '\0', length))
        return cwi_fail(err, CW_ERR_FORMAT, "line %zu of the header holds a zero byte",
                        lines->number);
    return CW_OK;
}

cw_status cwi_lines_next(cwi_lines *lines, char **line, cw_error *err)
{
    char *start = lines->text + lines->next;
    const size_t left = lines->size - lines->next;
    char *end = memchr(start, lines->end, left < MAX_LINE + 1 ? left : MAX_LINE + 1);
    size_t length = end ? (size_t)(end - start) : left;
    *line = NULL;
    if (left == 0 && !lines->cut)
        return CW_OK;
    lines->number++;
    cw_status st = check_line(lines, start, length, end, err);
    if (st != CW_OK)
        return st;
    lines->next += length + (end ? 1 : 0);
    while (length > 0 && isspace((unsigned char)start[length - 1]))
        length--;
    start[length] = '\0';
    *line = start;
    return CW_OK;
}

cw_status cwi_lines_names(cwi_lines *lines, cwi_names *names, cw_error *err)
{
    char *line;
    cw_status st = cwi_lines_next(lines, &line, err);
    while (st == CW_OK && line) {
        if (*line)
            st = cwi_names_add(names, line, err);
        if (st == CW_OK)
            st = cwi_lines_next(lines, &line, err);
    }
    return st;
}

/* Returns true if a row's name ("axismins") is the key ("Axis Mins"). */
static bool same_name(const char *name, size_t name_length, const char *key, size_t key_length)
{
    size_t n = 0;
    for (size_t k = 0; k < key_length; k++) {
        if (key[k] == ' ' || key[k] == '\t')
            continue;
        if (n == name_length || tolower((unsigned char)key[k]) != name[n++])
            return false;
    }
    return n == name_length;
}

int cwi_field_find(const char *const *rows, int count, const char *key, size_t length)
{
    for (int i = 0; i < count; i++)
        for (const char *name = rows[i]; name; name = strchr(name, '|')) {
            name += *name == '|';
            if (same_name(name, strcspn(name, "|"), key, length))
                return i;
        }
    return -1;
}

bool cwi_next_text_word(const char **text, char word[CWI_WORD_BYTES])
{
    const char *s = *text + strspn(*text, " \t");
    if (!*s)
        return false;
    const bool quoted = *s == '"';
    s += quoted;
    const size_t length = strcspn(s, quoted ? "\"" : " \t");
    const size_t kept = length < CWI_WORD_BYTES ? length : CWI_WORD_BYTES - 1;
    memcpy(word, s, kept);
    word[kept] = '\0';
    s += length;
    *text = s + (quoted && *s == '"');
    return true;
}

/* Reports an error in the text at which reading stopped, after `got` numbers: too few, too
 * many, or something that is no number. Reports nothing when all went well. */
static cw_status check_end(const char *field, const char *text, size_t got, size_t expected,
                           const char *by, const char *kind, cw_error *err)
{
    double more;
    const char *s = text + strspn(text, " \t");
    if (!*s && got == expected)
        return CW_OK;
    size_t count = got;
    while (got == expected && cwi_parse_double(&s, &more))
        count++;
    s += strspn(s, " \t");
    if (*s)
        return cwi_fail(err, CW_ERR_FORMAT, "'%s' holds '%.40s' where %s was expected", field,
                        s, kind);
    return cwi_fail(err, CW_ERR_FORMAT, "'%s' lists %zu numbers; '%s' says %zu", field, count,
                    by, expected);
}

cw_status cwi_field_doubles(const char *field, const char *text, size_t expected,
                            const char *by, double *out, cw_error *err)
{
    size_t got = 0;
    while (got < expected && cwi_parse_double(&text, &out[got]))
        got++;
    return check_end(field, text, got, expected, by, "a number", err);
}

/* Parses a whole number; leaves *text at one such as "2.5" or one that is too large. */
static bool parse_whole(const char **text, int64_t *value)
{
    const char *s = *text;
    if (!cwi_parse_int(&s, value) || (*s && *s != ' ' && *s != '\t'))
        return false;
    *text = s;
    return true;
}

cw_status cwi_field_sizes(const char *field, const char *text, size_t expected, const char *by,
                          size_t *out, cw_error *err)
{
    size_t got = 0;
    int64_t size;
    for (; got < expected && parse_whole(&text, &size); got++) {
        if (size < 1 || size > INT32_MAX)
            return cwi_fail(err, CW_ERR_FORMAT, "'%s' holds %lld; sizes are 1 to 2147483647",
                            field, (long long)size);
        out[got] = (size_t)size;
    }
    return check_end(field, text, got, expected, by, "a whole number", err);
}

cw_status cwi_field_integer(const char *field, const char *text, int64_t low, int64_t high,
                            int64_t *out, cw_error *err)
{
    const char *s = text;
    if (cwi_parse_int(&s, out) && !s[strspn(s, " \t")] && *out >= low && *out <= high)
        return CW_OK;
    return cwi_fail(err, CW_ERR_FORMAT,
                    "'%s' is '%.40s'; it must be a whole number from %lld to %lld", field, text,
                    (long long)low, (long long)high);
}
