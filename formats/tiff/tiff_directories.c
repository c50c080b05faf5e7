/* Walks along the directories of a TIFF file before libtiff does. libtiff treats a broken chain
 * as complete, and leaves out values beyond the file's end. */
#define _GNU_SOURCE /* pread */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/tiff/tiff_file.h"

#include <string.h>
#include <unistd.h>

enum {
    CLASSIC = 42,
    BIG = 43,
    MAX_ENTRIES = 4096, /* libtiff's own limit */
    ENTRIES_AT_ONCE = 64,
    ENTRY = 12,
    BIG_ENTRY = 20,
    ASCII = 2,
    SHORT = 3,
    RATIONAL = 5,
    FIRST_PRIVATE_TAG = 32768,
    UIC2_TAG = 33629 /* MetaMorph's: its count is the number of planes in one directory */
};

static cw_status fail_cut(const char *what, uint32_t directory, cw_error *err)
{
    return cwi_fail(err, CW_ERR_FORMAT, "the file ends before %s of directory %u does", what,
                    directory);
}

static bool read_at(const cwi_tiff_file *f, uint64_t offset, void *to, size_t size)
{
    size_t got = 0;
    if (offset > f->size || f->size - offset < size)
        return false;
    while (got < size) {
        const ssize_t n =
            pread(f->fd, (char *)to + got, size - got, (off_t)(offset + (uint64_t)got));
        if (n <= 0)
            return false;
        got += (size_t)n;
    }
    return true;
}

static uint64_t read_number(const cwi_tiff_file *f, const unsigned char *p, size_t size)
{
    uint64_t n = 0;
    for (size_t i = 0; i < size; i++)
        n = n << 8 | p[f->high_first ? i : size - 1 - i];
    return n;
}

static size_t bytes_of_type(uint64_t type)
{
    static const unsigned char sizes[] = {0, 1, 1, 2, 4, 8, 1, 1, 2, 4,
                                          8, 4, 8, 4, 0, 0, 8, 8, 8};
    return type < sizeof sizes ? sizes[type] : 0;
}

/* Checks an entry; private tags of other programs are not checked. */
static cw_status check_entry(const cwi_tiff_file *f, const unsigned char *entry,
                             uint32_t directory, cw_error *err)
{
    const size_t word = f->big ? 8 : 4;
    const uint64_t tag = read_number(f, entry, 2), type = read_number(f, entry + 2, 2);
    const uint64_t count = read_number(f, entry + 4, word);
    uint64_t bytes, end;
    if (tag == UIC2_TAG && count > 1)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'UIC2Tag' says that directory %u has %llu planes, as a MetaMorph "
                        "stack's; such are not read",
                        directory, (unsigned long long)count);
    if (tag >= FIRST_PRIVATE_TAG)
        return CW_OK;
    if (!__builtin_mul_overflow(count, bytes_of_type(type), &bytes) &&
        (bytes <= word ||
         (!__builtin_add_overflow(bytes, read_number(f, entry + 4 + word, word), &end) &&
          end <= f->size)))
        return CW_OK;
    return cwi_fail(err, CW_ERR_FORMAT,
                    "tag %llu of directory %u has %llu values at %llu; the file has %llu bytes",
                    (unsigned long long)tag, directory, (unsigned long long)count,
                    (unsigned long long)read_number(f, entry + 4 + word, word),
                    (unsigned long long)f->size);
}

/* A list of tags, read a few at a time. */
typedef struct tags {
    uint64_t at, count, next;
    unsigned char bytes[ENTRIES_AT_ONCE * BIG_ENTRY];
} tags;

/* Returns the next tag; NULL: there is none, or the file ends. */
static const unsigned char *next_tag(const cwi_tiff_file *f, tags *t)
{
    const size_t size = f->big ? BIG_ENTRY : ENTRY, n = t->next % ENTRIES_AT_ONCE;
    const uint64_t left = t->count - t->next;
    if (left == 0 ||
        (n == 0 && !read_at(f, t->at + t->next * size, t->bytes,
                            (left < ENTRIES_AT_ONCE ? left : ENTRIES_AT_ONCE) * size)))
        return NULL;
    t->next++;
    return t->bytes + n * size;
}

static cw_status check_entries(const cwi_tiff_file *f, uint64_t at, uint64_t count,
                               uint32_t directory, cw_error *err)
{
    tags t = {.at = at, .count = count};
    cw_status st = CW_OK;
    for (const unsigned char *entry; st == CW_OK && (entry = next_tag(f, &t));)
        st = check_entry(f, entry, directory, err);
    return st == CW_OK && t.next < count ? fail_cut("a tag", directory, err) : st;
}

/* Checks the directory at an offset, and moves that to the next one. */
static cw_status pass_directory(const cwi_tiff_file *f, uint64_t *offset, uint32_t directory,
                                cw_error *err)
{
    unsigned char bytes[8];
    const size_t head = f->big ? 8 : 2, word = f->big ? 8 : 4;
    if (!read_at(f, *offset, bytes, head))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "directory %u should be at %llu; the file has %llu bytes", directory,
                        (unsigned long long)*offset, (unsigned long long)f->size);
    const uint64_t count = read_number(f, bytes, head), at = *offset + head;
    if (count == 0 || count > MAX_ENTRIES)
        return cwi_fail(err, CW_ERR_FORMAT, "directory %u has %llu tags; it must be 1 to %d",
                        directory, (unsigned long long)count, MAX_ENTRIES);
    cw_status st = check_entries(f, at, count, directory, err);
    if (st == CW_OK && !read_at(f, at + count * (f->big ? BIG_ENTRY : ENTRY), bytes, word))
        st = fail_cut("the end", directory, err);
    *offset = read_number(f, bytes, word);
    return st;
}

static cw_status read_header(cwi_tiff_file *f, uint64_t *first, cw_error *err)
{
    unsigned char h[16];
    if (!read_at(f, 0, h, 8))
        return cwi_fail(err, CW_ERR_FORMAT, "the file ends within its header");
    f->high_first = h[0] == 'M';
    const uint64_t version = read_number(f, h + 2, 2);
    if (h[0] != h[1] || (h[0] != 'I' && h[0] != 'M') || (version != CLASSIC && version != BIG))
        return cwi_fail(err, CW_ERR_FORMAT, "it does not start as a TIFF file does");
    f->big = version == BIG;
    *first = read_number(f, h + 4, 4);
    if (f->big &&
        (!read_at(f, 0, h, 16) || read_number(f, h + 4, 2) != 8 || read_number(f, h + 6, 2)))
        return cwi_fail(err, CW_ERR_FORMAT, "the header of this BigTIFF file is damaged");
    if (f->big)
        *first = read_number(f, h + 8, 8);
    return *first ? CW_OK : cwi_fail(err, CW_ERR_FORMAT, "the file has no directory");
}

static bool add_offset(cwi_tiff_file *f, uint64_t offset, uint32_t *capacity)
{
    if (f->offset_count == *capacity) {
        const uint32_t more = *capacity ? 2 * *capacity : 64;
        uint64_t *offsets = cwi_realloc_array(f->offsets, more, sizeof *offsets);
        if (!offsets)
            return false;
        f->offsets = offsets;
        *capacity = more;
    }
    f->offsets[f->offset_count++] = offset;
    return true;
}

/* Finds the entry of a tag of a type; NULL where there is none. */
static const unsigned char *find_tag(const cwi_tiff_file *f, uint32_t directory, uint16_t tag,
                                     uint16_t type, tags *t)
{
    const size_t head = f->big ? 8 : 2;
    unsigned char bytes[8];
    const uint64_t at = f->offsets[directory];
    *t = (tags){.at = at + head};
    if (!read_at(f, at, bytes, head))
        return NULL;
    t->count = read_number(f, bytes, head);
    for (const unsigned char *entry; (entry = next_tag(f, t));)
        if (read_number(f, entry, 2) == tag && read_number(f, entry + 2, 2) == type)
            return entry;
    return NULL;
}

/* Finds the field of a single value: that itself, or its place. */
static const unsigned char *find_value(const cwi_tiff_file *f, uint32_t directory, uint16_t tag,
                                       uint16_t type, tags *t)
{
    const size_t word = f->big ? 8 : 4;
    const unsigned char *entry = find_tag(f, directory, tag, type, t);
    return entry && read_number(f, entry + 4, word) == 1 ? entry + 4 + word : NULL;
}

bool cwi_tiff_text(const cwi_tiff_file *f, uint16_t tag, char *text, size_t size)
{
    const size_t word = f->big ? 8 : 4;
    tags t;
    const unsigned char *entry = find_tag(f, 0, tag, ASCII, &t);
    if (!entry)
        return false;
    const uint64_t count = read_number(f, entry + 4, word);
    const size_t kept = count < size - 1 ? (size_t)count : size - 1;
    text[kept] = '\0';
    if (count <= word)
        memcpy(text, entry + 4 + word, kept);
    return count <= word || read_at(f, read_number(f, entry + 4 + word, word), text, kept);
}

uint16_t cwi_tiff_short(const cwi_tiff_file *f, uint32_t directory, uint16_t tag)
{
    tags t;
    const unsigned char *value = find_value(f, directory, tag, SHORT, &t);
    return value ? (uint16_t)read_number(f, value, 2) : 0;
}

bool cwi_tiff_rational(const cwi_tiff_file *f, uint16_t tag, double *value)
{
    tags t;
    unsigned char bytes[8];
    const unsigned char *at = find_value(f, 0, tag, RATIONAL, &t);
    if (at && !f->big)
        at = read_at(f, read_number(f, at, 4), bytes, 8) ? bytes : NULL;
    if (at)
        *value = (double)read_number(f, at, 4) / (double)read_number(f, at + 4, 4);
    return at != NULL;
}

/* Walks along the chain. A circle is detected by a mark, which moves at every power of two. */
cw_status cwi_tiff_walk(cwi_tiff_file *f, cw_error *err)
{
    uint64_t at = 0, mark = 0;
    uint32_t capacity = 0;
    cw_status st = read_header(f, &at, err);
    while (st == CW_OK && at) {
        if (at == mark)
            return cwi_fail(err, CW_ERR_FORMAT,
                            "the chain of directories runs in a circle, through %llu",
                            (unsigned long long)at);
        if (f->offset_count == CWI_TIFF_MAX_PAGES)
            return cwi_fail(err, CW_ERR_LIMIT, "more than %d pages", CWI_TIFF_MAX_PAGES);
        if (!add_offset(f, at, &capacity))
            return cwi_fail_memory(err);
        if ((f->offset_count & (f->offset_count - 1)) == 0)
            mark = at;
        st = pass_directory(f, &at, f->offset_count, err);
    }
    return st;
}
