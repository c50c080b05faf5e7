/* Walks over the elements of a DICOM file without recursion, to find their depth and number. */
#include "formats/dicom/dicom_nesting.h"

#include "core/base/status.h"
#include "formats/bytes/input_file.h"

#include <string.h>
#include <zlib.h>

enum { WINDOW = 4096, PREAMBLE = 128, MAX_ELEMENTS = 1 << 23 };
static const uint64_t MAX_INFLATED = (uint64_t)1 << 33;
static const uint32_t UNDEFINED = 0xffffffff;

/* A sequence or an item that was entered. */
typedef struct level {
    uint64_t end;  /* UINT64_MAX: it ends at a mark */
    bool implicit; /* its elements state no value representation */
} level;

typedef struct walk {
    int fd;
    uint64_t size, at;
    unsigned char bytes[WINDOW];
    uint64_t start; /* of the bytes in the file, or in the inflated data */
    size_t held;
    bool deflated; /* then: */
    z_stream inflater;
    unsigned char packed[WINDOW];
    uint64_t packed_at; /* place in the file of the next compressed bytes */
    bool big_endian;
    level levels[CWI_DICOM_DEEPEST + 1];
    int depth; /* index of the last level; 0: the file itself */
} walk;

typedef struct element {
    uint32_t tag, length;
    char vr[3];
    uint64_t value; /* place of the value */
} element;

/* Inflates until the buffer is full, or the data end. */
static void inflate_more(walk *w, cw_error *err)
{
    z_stream *z = &w->inflater;
    int code = Z_OK;
    z->next_out = w->bytes + w->held;
    z->avail_out = (uInt)(WINDOW - w->held);
    while (z->avail_out > 0 && code == Z_OK) {
        size_t got = z->avail_in;
        if (got == 0 &&
            cwi_input_read_at(w->fd, w->packed_at, w->packed, WINDOW, &got, err) == CW_OK) {
            z->next_in = w->packed;
            z->avail_in = (uInt)got;
            w->packed_at += got;
        }
        code = got ? inflate(z, Z_NO_FLUSH) : Z_BUF_ERROR;
    }
    w->held = WINDOW - z->avail_out;
}

/* Returns bytes as peek_bytes(); the bytes before them are discarded. */
static const unsigned char *peek_inflated(walk *w, uint64_t at, size_t count, cw_error *err)
{
    size_t before = SIZE_MAX;
    while (at + count > w->start + w->held && w->held != before && at <= MAX_INFLATED) {
        const uint64_t end = w->start + w->held;
        const size_t passed = (size_t)((at < end ? at : end) - w->start);
        w->held -= passed;
        w->start += passed;
        memmove(w->bytes, w->bytes + passed, w->held);
        before = w->held;
        inflate_more(w, err);
    }
    return at >= w->start && at + count <= w->start + w->held ? w->bytes + (at - w->start)
                                                              : NULL;
}

/* Returns the next bytes; NULL where the file ends first. */
static const unsigned char *peek_bytes(walk *w, uint64_t at, size_t count, cw_error *err)
{
    if (w->deflated)
        return peek_inflated(w, at, count, err);
    if (at > w->size || w->size - at < count)
        return NULL;
    if (at < w->start || at + count > w->start + w->held) {
        w->start = at;
        if (cwi_input_read_at(w->fd, at, w->bytes, WINDOW, &w->held, err) != CW_OK)
            w->held = 0;
    }
    return w->held >= at - w->start + count ? w->bytes + (at - w->start) : NULL;
}

static uint32_t read_number(const walk *w, const unsigned char *b, int count)
{
    uint32_t n = 0;
    for (int i = 0; i < count; i++)
        n |= (uint32_t)b[w->big_endian ? count - 1 - i : i] << 8 * i;
    return n;
}

static bool is_wide(const char *vr)
{
    static const char wide[] = "OB OD OF OL OV OW SQ SV UC UN UR UT UV";
    return strstr(wide, vr) != NULL;
}

static bool read_element(walk *w, bool implicit, element *e, cw_error *err)
{
    const unsigned char *b = peek_bytes(w, w->at, 8, err);
    if (!b)
        return false;
    e->tag = read_number(w, b, 2) << 16 | read_number(w, b + 2, 2);
    memcpy(e->vr, b + 4, 2);
    e->vr[2] = '\0';
    if (implicit || e->tag >> 16 == 0xfffe) {
        e->vr[0] = '\0';
        e->length = read_number(w, b + 4, 4);
        e->value = w->at + 8;
        return true;
    }
    if (!is_wide(e->vr)) {
        e->length = read_number(w, b + 6, 2);
        e->value = w->at + 8;
        return true;
    }
    b = peek_bytes(w, w->at, 12, err);
    e->length = b ? read_number(w, b + 8, 4) : 0;
    e->value = w->at + 12;
    return b != NULL;
}

static bool starts_with_item(walk *w, uint64_t at, cw_error *err)
{
    const unsigned char *b = peek_bytes(w, at, 4, err);
    return b && read_number(w, b, 2) == 0xfffe && read_number(w, b + 2, 2) == 0xe000;
}

/* Returns true if an element contains elements: sequences, items other than those of pixels,
 * and elements without a representation that look like a sequence. */
static bool is_nest(walk *w, const element *e, bool in_pixels, cw_error *err)
{
    if (e->tag == 0xfffee000)
        return !in_pixels;
    if (e->tag == 0x7fe00010)
        return e->length == UNDEFINED;
    const bool may_be = e->vr[0] == '\0' || strcmp(e->vr, "UN") == 0;
    return strcmp(e->vr, "SQ") == 0 || (may_be && e->length == UNDEFINED) ||
           (may_be && e->length >= 8 && starts_with_item(w, e->value, err));
}

static cw_status walk_elements(walk *w, cw_error *err)
{
    int pixels = 0; /* the depth at which pixels begin; 0: not inside them */
    element e;
    for (int count = 0;; count++) {
        if (count == MAX_ELEMENTS)
            return cwi_fail(err, CW_ERR_FORMAT,
                            "it has more than %d elements; it is damaged or hostile",
                            MAX_ELEMENTS);
        while (w->depth > 0 && w->at >= w->levels[w->depth].end)
            w->depth--;
        pixels = pixels > w->depth ? 0 : pixels;
        const level *here = &w->levels[w->depth];
        if (!read_element(w, here->implicit, &e, err))
            return CW_OK;
        w->at = e.value;
        if (e.tag == 0xfffee00d || e.tag == 0xfffee0dd) {
            w->depth -= w->depth > 0;
            continue;
        }
        if (!is_nest(w, &e, pixels > 0, err)) {
            w->at += e.length;
            continue;
        }
        if (w->depth == CWI_DICOM_DEEPEST)
            return cwi_fail(err, CW_ERR_FORMAT,
                            "sequences are nested deeper than %d at byte %llu",
                            CWI_DICOM_DEEPEST, (unsigned long long)e.value);
        const bool unknown = strcmp(e.vr, "UN") == 0; /* their content is implicit */
        w->levels[++w->depth] =
            (level){.end = e.length == UNDEFINED ? UINT64_MAX : e.value + e.length,
                    .implicit = here->implicit || unknown};
        if (e.tag == 0x7fe00010)
            pixels = w->depth;
    }
}

/* Continues with the inflated bytes from here on; returns false without memory. */
static bool begin_inflating(walk *w)
{
    w->packed_at = w->at;
    w->at = w->start = w->held = 0;
    w->deflated = inflateInit2(&w->inflater, -MAX_WBITS) == Z_OK;
    return w->deflated;
}

/* Reads the meta header, for the syntax of the rest; returns false if the rest cannot be walked
 * over. */
static bool read_meta(walk *w, cw_error *err)
{
    static const char implicit[] = "1.2.840.10008.1.2", big[] = "1.2.840.10008.1.2.2",
                      deflated[] = "1.2.840.10008.1.2.1.99";
    const unsigned char *b = peek_bytes(w, PREAMBLE, 4, err);
    char syntax[32] = "";
    element e;
    w->at = b && memcmp(b, "DICM", 4) == 0 ? PREAMBLE + 4 : 0;
    b = peek_bytes(w, w->at, 6, err);
    if (w->at == 0 && b && b[0] != 2) { /* no meta header; elements are usually implicit */
        w->levels[0].implicit = !(b[4] >= 'A' && b[5] >= 'A');
        return true;
    }
    while (read_element(w, false, &e, err) && e.tag >> 16 == 2) {
        const unsigned char *value = peek_bytes(w, e.value, e.length < 31 ? e.length : 0, err);
        if (e.tag == 0x00020010 && value && e.length < 31)
            memcpy(syntax, value, e.length);
        w->at = e.value + e.length;
    }
    w->levels[0].implicit = strcmp(syntax, implicit) == 0;
    w->big_endian = strcmp(syntax, big) == 0;
    return strcmp(syntax, deflated) != 0 || begin_inflating(w);
}

cw_status cwi_dicom_check_depth(int fd, uint64_t size, cw_error *err)
{
    walk w = {.fd = fd, .size = size};
    w.levels[0].end = UINT64_MAX;
    cw_status st = read_meta(&w, err) ? walk_elements(&w, err) : CW_OK;
    if (w.deflated)
        inflateEnd(&w.inflater);
    if (st == CW_OK && w.deflated && w.at > MAX_INFLATED)
        st = cwi_fail(err, CW_ERR_LIMIT, "its data inflate to more than %llu bytes",
                      (unsigned long long)MAX_INFLATED);
    return st;
}
