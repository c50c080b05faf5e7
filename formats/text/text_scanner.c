/* Scans the bytes of a mesh file in a buffer: words, numbers and lines of text, or binary
 * records. */
#include "formats/text/text_scanner.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"

#include <string.h>

enum { HELD = 256 << 10 };

cw_status cwi_scan_open(cwi_scan *s, const cwi_input *in, uint64_t offset,
                        const cw_progress *progress, cw_error *err)
{
    *s = (cwi_scan){.in = in, .progress = progress, .offset = offset, .line = 1};
    s->text = cwi_alloc_array(HELD + 1, 1);
    if (!s->text)
        return cwi_fail_memory(err);
    s->text[0] = '\0';
    return CW_OK;
}

void cwi_scan_close(cwi_scan *s)
{
    cwi_free(s->text);
    *s = (cwi_scan){0};
}

uint64_t cwi_scan_left(const cwi_scan *s)
{
    const uint64_t behind = s->in->size > s->offset ? s->in->size - s->offset : 0;
    return behind + (s->end - s->next);
}

/* Returns true if the first line of a text ends with a carriage return alone. */
static bool has_cr_lines(const char *text, size_t size)
{
    const char *cr = memchr(text, '\r', size);
    const size_t at = cr ? (size_t)(cr - text) : 0;
    return cr && !memchr(text, '\n', at) && !(at + 1 < size && cr[1] == '\n');
}

cw_status cwi_scan_open_text(cwi_scan *s, const cwi_input *in, uint64_t offset,
                             const cw_progress *progress, cw_error *err)
{
    size_t got = 0;
    cw_status st = cwi_scan_open(s, in, offset, progress, err);
    if (st == CW_OK)
        st = cwi_input_read_at(in->fd, offset, s->text, HELD, &got, err);
    if (st != CW_OK)
        return st;
    s->cr_lines = has_cr_lines(s->text, got);
    s->text[0] = '\0';
    return CW_OK;
}

/* Turns the carriage returns that end lines into line feeds, from an index on. One at the very
 * end is given back while the file has more, since a line feed may follow. */
static void turn_line_ends(cwi_scan *s, size_t from)
{
    char *at = s->text + from, *end = s->text + s->end;
    for (; (at = memchr(at, '\r', (size_t)(end - at))); at++) {
        if (at + 1 == end && s->offset < s->in->size) {
            s->end--;
            s->offset--;
            return;
        }
        if (at + 1 == end || at[1] != '\n')
            *at = '\n';
    }
}

static cw_status refill_buffer(cwi_scan *s, cw_error *err)
{
    size_t got;
    s->end -= s->next;
    memmove(s->text, s->text + s->next, s->end);
    s->next = 0;
    cw_status st =
        cwi_input_read_at(s->in->fd, s->offset, s->text + s->end, HELD - s->end, &got, err);
    s->end += got;
    s->offset += got;
    if (s->cr_lines)
        turn_line_ends(s, s->end - got);
    s->text[s->end] = '\0';
    if (st == CW_OK && got < HELD - CWI_SCAN_AHEAD && s->offset < s->in->size)
        return cwi_fail(err, CW_ERR_IO, "the file became shorter while it was read");
    if (st == CW_OK)
        st = cwi_progress(s->progress, "reading", (double)s->offset / (double)s->in->size, err);
    return st;
}

/* Makes sure that `size` bytes are in memory behind next, unless the file has no more. */
static inline cw_status hold_bytes(cwi_scan *s, size_t size, cw_error *err)
{
    const bool enough = s->end - s->next >= size || s->offset >= s->in->size;
    return enough ? CW_OK : refill_buffer(s, err);
}

cw_status cwi_scan_take(cwi_scan *s, size_t size, const char *what, const unsigned char **bytes,
                        cw_error *err)
{
    cw_status st = hold_bytes(s, size, err);
    if (st == CW_OK && s->end - s->next < size)
        return cwi_fail(err, CW_ERR_FORMAT, "the file ends within %s, after %llu bytes", what,
                        (unsigned long long)s->offset);
    *bytes = (const unsigned char *)s->text + s->next;
    s->next += st == CW_OK ? size : 0;
    return st;
}

static inline bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

/* Returns the bytes of a backslash that ends its line, including that end; 0 when there is
 * none. */
static inline size_t joint_size(const cwi_scan *s, const char *at)
{
    if (!s->by_line || at[0] != '\\')
        return 0;
    return at[1] == '\n' ? 2 : at[1] == '\r' && at[2] == '\n' ? 3 : 0;
}

/* Returns the bytes of anything that may precede a word; 0 at a word or an end. */
static inline size_t blank_size(const cwi_scan *s, const char *at)
{
    if (is_blank(*at) || (*at == '\n' && !s->by_line))
        return 1;
    return joint_size(s, at);
}

static cw_status skip_to_line_end(cwi_scan *s, cw_error *err)
{
    cw_status st = hold_bytes(s, 1, err);
    while (st == CW_OK && s->next < s->end) {
        const char *from = s->text + s->next, *end = memchr(from, '\n', s->end - s->next);
        s->next = end ? (size_t)(end - s->text) : s->end;
        if (end)
            break;
        st = hold_bytes(s, 1, err);
    }
    return st;
}

static cw_status skip_blanks(cwi_scan *s, cw_error *err)
{
    cw_status st = hold_bytes(s, CWI_SCAN_AHEAD, err);
    while (st == CW_OK && s->next < s->end) {
        const char *at = s->text + s->next;
        const size_t size = blank_size(s, at);
        s->line += size && at[size - 1] == '\n';
        s->next += size;
        if (!size && !(s->comments && *at == '#'))
            break;
        if (!size)
            st = skip_to_line_end(s, err);
        if (st == CW_OK)
            st = hold_bytes(s, CWI_SCAN_AHEAD, err);
    }
    return st;
}

cw_status cwi_scan_word(cwi_scan *s, cwi_word *word, cw_error *err)
{
    cw_status st = skip_blanks(s, err);
    if (st != CW_OK)
        return st;
    const char *text = s->text + s->next;
    const size_t max = s->end - s->next < CWI_SCAN_AHEAD ? s->end - s->next : CWI_SCAN_AHEAD;
    size_t n = 0;
    while (n < max && !is_blank(text[n]) && text[n] != '\n' && !joint_size(s, text + n))
        n++;
    if (n == CWI_SCAN_AHEAD)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "line %zu: '%.20s...' is a word of more than %d bytes", s->line, text,
                        CWI_SCAN_AHEAD - 1);
    *word = (cwi_word){text, n};
    s->next += n;
    return CW_OK;
}

bool cwi_word_is(const cwi_word *word, const char *text)
{
    return strlen(text) == word->size && memcmp(word->text, text, word->size) == 0;
}

cw_status cwi_scan_rest(cwi_scan *s, char text[CWI_REST_BYTES], cw_error *err)
{
    size_t used = 0;
    cw_status st = hold_bytes(s, 1, err);
    while (st == CW_OK && s->next < s->end && s->text[s->next] != '\n') {
        const char c = s->text[s->next++];
        if (used + 1 < CWI_REST_BYTES && (used || !is_blank(c)))
            text[used++] = c;
        st = hold_bytes(s, 1, err);
    }
    while (used && is_blank(text[used - 1]))
        used--;
    text[used] = '\0';
    return st;
}

cw_status cwi_scan_end_line(cwi_scan *s, cw_error *err)
{
    cw_status st = skip_to_line_end(s, err);
    if (st == CW_OK && s->next < s->end) {
        s->next++;
        s->line++;
    }
    return st;
}

cw_status cwi_scan_next_line(cwi_scan *s, bool *found, cw_error *err)
{
    cw_status st = skip_blanks(s, err);
    while (st == CW_OK && s->next < s->end && s->text[s->next] == '\n') {
        st = cwi_scan_end_line(s, err);
        if (st == CW_OK)
            st = skip_blanks(s, err);
    }
    *found = st == CW_OK && s->next < s->end;
    return st;
}

cw_status cwi_scan_fail(const cwi_scan *s, const cwi_word *word, const char *what,
                        const char *expected, cw_error *err)
{
    if (word->size == 0)
        return cwi_fail(err, CW_ERR_FORMAT, "line %zu: the %s ends before %s; %s was expected",
                        s->line, s->by_line ? "line" : "file", what, expected);
    return cwi_fail(err, CW_ERR_FORMAT, "line %zu: %s is '%.*s'; %s was expected", s->line,
                    what, word->size < 40 ? (int)word->size : 40, word->text, expected);
}

bool cwi_word_double(const cwi_word *word, double *value)
{
    const char *end = word->text;
    return word->size && cwi_parse_double(&end, value) && end == word->text + word->size;
}

bool cwi_word_integer(const cwi_word *word, int64_t *value)
{
    const char *end = word->text;
    return word->size && cwi_parse_int(&end, value) && end == word->text + word->size;
}

cw_status cwi_scan_double(cwi_scan *s, const char *what, double *value, cw_error *err)
{
    cwi_word word = {0};
    cw_status st = cwi_scan_word(s, &word, err);
    if (st == CW_OK && !cwi_word_double(&word, value))
        return cwi_scan_fail(s, &word, what, "a number", err);
    return st;
}

cw_status cwi_scan_integer(cwi_scan *s, const char *what, int64_t *value, cw_error *err)
{
    cwi_word word = {0};
    cw_status st = cwi_scan_word(s, &word, err);
    if (st == CW_OK && !cwi_word_integer(&word, value))
        return cwi_scan_fail(s, &word, what, "a whole number", err);
    return st;
}
