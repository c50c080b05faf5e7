/* Reads zip archives: finds entries by the directory, checks their records, and inflates
 * them. */
#include "formats/bytes/zip_read.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <string.h>
#include <strings.h>

/* Sizes of the fixed records, and the maximum bytes of the directory and of a comment behind
 * it. */
enum { LOCAL = 30, CENTRAL = 46, END = 22, END64 = 56, LOCATOR = 20 };
enum { MAX_BYTES = 4 << 20, MAX_COMMENT = 65535, BUFFER_BYTES = 1 << 16 };
enum { STORED = 0, DEFLATED = 8, ENCRYPTED = 1, MAX_RATIO = 1032 };

static const uint32_t FULL = UINT32_MAX; /* the true number is in a field of 64 bits */

static uint64_t read_number(const unsigned char *at, size_t size)
{
    uint64_t value = 0;
    while (size > 0)
        value = value << 8 | at[--size];
    return value;
}

static cw_status fail_damaged(const char *what, cw_error *err)
{
    return cwi_fail(err, CW_ERR_FORMAT, "the zip archive is damaged: %s", what);
}

/* Reads exactly `size` bytes. */
static cw_status read_at(const cwi_input *in, uint64_t at, void *to, size_t size,
                         const char *what, cw_error *err)
{
    size_t got;
    cw_status st = cwi_input_read_at(in->fd, at, to, size, &got, err);
    return st == CW_OK && got < size ? fail_damaged(what, err) : st;
}

/* --- the directory ----------------------------------------------------------------------- */

/* Finds the start of the last record. Only a comment of the stated length may follow it. */
static cw_status find_end(const cwi_input *in, uint64_t *end, unsigned char record[END],
                          cw_error *err)
{
    const size_t max = END + MAX_COMMENT;
    const size_t size = in->size < max ? (size_t)in->size : max;
    unsigned char *tail = cwi_alloc_array(size, 1);
    if (!tail)
        return cwi_fail_memory(err);
    cw_status st = read_at(in, in->size - size, tail, size, "its end cannot be read", err);
    size_t at = size >= END ? size - END + 1 : 0;
    bool found = false;
    while (st == CW_OK && at > 0 && !found) {
        at--;
        found = read_number(tail + at, 4) == 0x06054b50 &&
                read_number(tail + at + 20, 2) == size - at - END;
    }
    if (found)
        memcpy(record, tail + at, END);
    *end = in->size - size + at;
    cwi_free(tail);
    return st == CW_OK && !found ? fail_damaged("it has no directory; it may be cut off", err)
                                 : st;
}

/* Reads the same record with fields of 64 bits; a locator before the last record names its
 * place. */
static cw_status read_end64(const cwi_input *in, uint64_t *end, uint64_t *count,
                            uint64_t *bytes, uint64_t *start, cw_error *err)
{
    unsigned char locator[LOCATOR], record[END64];
    if (*end < LOCATOR)
        return fail_damaged("sizes of 64 bits are missing", err);
    cw_status st = read_at(in, *end - LOCATOR, locator, LOCATOR, "its end", err);
    if (st == CW_OK && read_number(locator, 4) != 0x07064b50)
        return fail_damaged("sizes of 64 bits are missing", err);
    const uint64_t at = read_number(locator + 8, 8);
    if (st == CW_OK && (*end < LOCATOR + END64 || at > *end - LOCATOR - END64))
        return fail_damaged("sizes of 64 bits are missing", err);
    if (st == CW_OK)
        st = read_at(in, at, record, END64, "its end", err);
    if (st == CW_OK && read_number(record, 4) != 0x06064b50)
        return fail_damaged("sizes of 64 bits are missing", err);
    *end = at;
    *count = read_number(record + 32, 8);
    *bytes = read_number(record + 40, 8);
    *start = read_number(record + 48, 8);
    return st;
}

cw_status cwi_unzip_open(cwi_unzip *z, const cwi_input *in, cw_error *err)
{
    unsigned char record[END];
    uint64_t end = 0;
    *z = (cwi_unzip){.in = in};
    cw_status st = find_end(in, &end, record, err);
    if (st != CW_OK)
        return st;
    uint64_t count = read_number(record + 10, 2), bytes = read_number(record + 12, 4);
    uint64_t start = read_number(record + 16, 4);
    if (count == UINT16_MAX || bytes == FULL || start == FULL)
        st = read_end64(in, &end, &count, &bytes, &start, err);
    if (st == CW_OK && (start > end || bytes > end - start))
        return fail_damaged("its directory does not fit into the file", err);
    if (st == CW_OK && (bytes > MAX_BYTES || count > UINT16_MAX || count > bytes / CENTRAL))
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "the zip archive has %llu entries in %llu bytes; at most %d in %d are read",
            (unsigned long long)count, (unsigned long long)bytes, UINT16_MAX, MAX_BYTES);
    if (st == CW_OK && !(z->directory = cwi_alloc_array((size_t)bytes, 1)))
        return cwi_fail_memory(err);
    z->start = start;
    z->bytes = (size_t)bytes;
    z->count = (size_t)count;
    return st == CW_OK ? read_at(in, start, z->directory, z->bytes, "its directory", err) : st;
}

void cwi_unzip_close(cwi_unzip *z)
{
    cwi_free(z->directory);
    *z = (cwi_unzip){0};
}

/* --- entries ----------------------------------------------------------------------------- */

/* Reads the extra field. It holds the numbers that are FULL in the record, in this order. */
static bool read_extra(const unsigned char *extra, size_t size, cwi_unzip_entry *e)
{
    uint64_t *const wide[3] = {&e->size, &e->packed, &e->start};
    size_t length = 0;
    for (; size >= 4; size -= 4 + length, extra += 4 + length) {
        length = (size_t)read_number(extra + 2, 2);
        if (length > size - 4)
            return false;
        if (read_number(extra, 2) == 1)
            break;
    }
    const unsigned char *at = extra + 4, *end = size >= 4 ? at + length : at;
    for (int i = 0; i < 3; i++)
        if (*wide[i] == FULL) {
            if (end - at < 8)
                return false;
            *wide[i] = read_number(at, 8);
            at += 8;
        }
    return true;
}

static bool same_name(const unsigned char *text, size_t length, const char *name)
{
    return length == strlen(name) && strncasecmp((const char *)text, name, length) == 0;
}

/* Moves to the next record of the directory. Returns false where it does not fit in. length: of its name */
static bool next_record(const cwi_unzip *z, const unsigned char **at,
                        const unsigned char **record, size_t *length)
{
    const size_t left = (size_t)(z->directory + z->bytes - *at);
    if (left < CENTRAL || read_number(*at, 4) != 0x02014b50)
        return false;
    *length = (size_t)read_number(*at + 28, 2);
    const size_t rest =
        *length + (size_t)read_number(*at + 30, 2) + (size_t)read_number(*at + 32, 2);
    if (left - CENTRAL < rest)
        return false;
    *record = *at;
    *at += CENTRAL + rest;
    return true;
}

/* Finds the record of a name; NULL when there is none. *whole: all records fit into the
 * directory. */
static const unsigned char *find_record(const cwi_unzip *z, const char *name, bool *whole)
{
    const unsigned char *at = z->directory, *record;
    size_t length;
    *whole = true;
    for (size_t i = 0; i < z->count; i++) {
        *whole = next_record(z, &at, &record, &length);
        if (!*whole)
            return NULL;
        if (same_name(record + CENTRAL, length, name))
            return record;
    }
    return NULL;
}

bool cwi_unzip_next(const cwi_unzip *z, size_t *offset, char name[256])
{
    const unsigned char *at = z->directory + *offset, *record;
    size_t length;
    if (!next_record(z, &at, &record, &length))
        return false;
    length = length < 256 ? length : 0;
    memcpy(name, record + CENTRAL, length);
    name[length] = '\0';
    *offset = (size_t)(at - z->directory);
    return true;
}

bool cwi_unzip_has(const cwi_unzip *z, const char *name)
{
    bool whole;
    return find_record(z, name + (*name == '/'), &whole);
}

/* Checks the header before an entry against the record; the sizes may be missing there. */
static cw_status check_local(const cwi_unzip *z, cwi_unzip_entry *e, cw_error *err)
{
    unsigned char head[LOCAL];
    char name[sizeof e->name];
    const size_t length = strlen(e->name);
    if (e->start > z->start || z->start - e->start < LOCAL + length)
        return fail_damaged("an entry is not where the directory says", err);
    cw_status st = read_at(z->in, e->start, head, LOCAL, "an entry's header", err);
    if (st == CW_OK)
        st = read_at(z->in, e->start + LOCAL, name, length, "an entry's header", err);
    if (st != CW_OK)
        return st;
    if (read_number(head, 4) != 0x04034b50 || read_number(head + 26, 2) != length ||
        memcmp(name, e->name, length) != 0 ||
        read_number(head + 8, 2) != (e->deflated ? DEFLATED : STORED))
        return fail_damaged("an entry is not where the directory says", err);
    e->start += LOCAL + length + read_number(head + 28, 2);
    if (e->start > z->start || e->packed > z->start - e->start)
        return fail_damaged("an entry is larger than the file", err);
    return CW_OK;
}

cw_status cwi_unzip_find(const cwi_unzip *z, const char *name, cwi_unzip_entry *entry,
                         cw_error *err)
{
    bool whole = true;
    name += *name == '/';
    const size_t length = strlen(name);
    const unsigned char *at = length < sizeof entry->name ? find_record(z, name, &whole) : NULL;
    if (!whole)
        return fail_damaged("its directory breaks off", err);
    if (!at)
        return cwi_fail(err, CW_ERR_FORMAT, "the zip archive has no '%.200s'", name);
    const uint64_t method = read_number(at + 10, 2);
    *entry = (cwi_unzip_entry){.deflated = method == DEFLATED,
                               .crc = (uint32_t)read_number(at + 16, 4),
                               .packed = read_number(at + 20, 4),
                               .size = read_number(at + 24, 4),
                               .start = read_number(at + 42, 4)};
    memcpy(entry->name, at + CENTRAL, length);
    if (read_number(at + 8, 2) & ENCRYPTED)
        return cwi_fail(err, CW_ERR_FORMAT, "'%s' in the zip archive is encrypted",
                        entry->name);
    if (method != STORED && method != DEFLATED)
        return cwi_fail(err, CW_ERR_FORMAT, "'%s' is packed by method %u; deflate is read",
                        entry->name, (unsigned)method);
    if (!read_extra(at + CENTRAL + length, (size_t)read_number(at + 30, 2), entry))
        return fail_damaged("sizes of 64 bits are missing", err);
    if (entry->deflated ? entry->size / MAX_RATIO > entry->packed
                        : entry->size != entry->packed)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'%s' cannot have %llu bytes; %llu are in the archive", entry->name,
                        (unsigned long long)entry->size, (unsigned long long)entry->packed);
    return check_local(z, entry, err);
}

/* --- the bytes of an entry --------------------------------------------------------------- */

cw_status cwi_unzip_start(cwi_unzip_stream *s, const cwi_unzip *z, const cwi_unzip_entry *entry,
                          cw_error *err)
{
    *s = (cwi_unzip_stream){.in = z->in, .entry = *entry};
    if (!entry->deflated)
        return CW_OK;
    cwi_zlib_use_memory(&s->z);
    s->buffer = cwi_alloc_array(BUFFER_BYTES, 1);
    s->inflates = s->buffer && inflateInit2(&s->z, -MAX_WBITS) == Z_OK;
    if (s->inflates)
        return CW_OK;
    cwi_unzip_end(s);
    return cwi_fail_memory(err);
}

void cwi_unzip_end(cwi_unzip_stream *s)
{
    if (s->inflates)
        inflateEnd(&s->z);
    cwi_free(s->buffer);
    *s = (cwi_unzip_stream){0};
}

/* Reads the next bytes of the entry as they are in the file; none beyond its end. */
static cw_status fetch_bytes(cwi_unzip_stream *s, void *to, size_t size, size_t *got,
                             cw_error *err)
{
    const uint64_t left = s->entry.packed - s->taken;
    size = size < left ? size : (size_t)left;
    cw_status st =
        read_at(s->in, s->entry.start + s->taken, to, size, "an entry breaks off", err);
    *got = st == CW_OK ? size : 0;
    s->taken += *got;
    return st;
}

static cw_status fail_entry(const cwi_unzip_stream *s, const char *what, cw_error *err)
{
    return cwi_fail(err, CW_ERR_FORMAT, "'%s' in the zip archive is damaged: %s", s->entry.name,
                    what);
}

static cw_status inflate_some(cwi_unzip_stream *s, void *to, size_t size, size_t *got,
                              cw_error *err)
{
    cw_status st = CW_OK;
    s->z.next_out = to;
    s->z.avail_out = (uInt)size;
    while (st == CW_OK && s->z.avail_out > 0 && !s->ended) {
        size_t more = 0;
        if (s->z.avail_in == 0) {
            st = fetch_bytes(s, s->buffer, BUFFER_BYTES, &more, err);
            s->z.next_in = s->buffer;
            s->z.avail_in = (uInt)more;
        }
        if (st != CW_OK)
            break;
        const uInt before = s->z.avail_out, input = s->z.avail_in;
        const int code = inflate(&s->z, Z_NO_FLUSH);
        s->ended = code == Z_STREAM_END;
        if (code == Z_MEM_ERROR)
            return cwi_fail_memory(err);
        if (code != Z_OK && code != Z_STREAM_END && code != Z_BUF_ERROR)
            return fail_entry(s, s->z.msg ? s->z.msg : "it is no deflated data", err);
        if (!s->ended && s->z.avail_out == before && s->z.avail_in == input)
            return fail_entry(s, "it breaks off", err);
    }
    *got = size - s->z.avail_out;
    return st;
}

/* Checks size and checksum at the end. */
static cw_status check_whole(const cwi_unzip_stream *s, cw_error *err)
{
    if (s->given != s->entry.size)
        return fail_entry(s, "it has another size than the directory says", err);
    if (s->crc != s->entry.crc)
        return fail_entry(s, "its checksum is another", err);
    return CW_OK;
}

cw_status cwi_unzip_some(void *stream, void *to, size_t size, size_t *got, cw_error *err)
{
    cwi_unzip_stream *s = stream;
    cw_status st = s->entry.deflated ? inflate_some(s, to, size, got, err)
                                     : fetch_bytes(s, to, size, got, err);
    if (st != CW_OK)
        return st;
    s->given += *got;
    s->crc = (uint32_t)crc32_z(s->crc, to, *got);
    if (s->given > s->entry.size)
        return fail_entry(s, "it has another size than the directory says", err);
    return *got == 0 && size > 0 ? check_whole(s, err) : CW_OK;
}
