/* Writes zip archives: headers, deflated entries and the directory, with 64-bit fields where
 * needed. */
#include "formats/bytes/zip_write.h"

#include "core/base/status.h"
#include "formats/bytes/little_endian.h"

#include <assert.h>
#include <string.h>

/* Sizes of the fixed records, and the place of the sums in an entry's header. */
enum { LOCAL = 30, CENTRAL = 46, END = 22, END64 = 56, LOCATOR = 20, EXTRA = 20, SUMS_AT = 14 };

/* Fields of the headers. Version 4.5 allows sizes of 64 bits. All entries have the earliest
 * possible time, so that two runs write the same bytes. */
enum { VERSION = 20, VERSION64 = 45, DEFLATED = 8, TIME = 0, DAY = 1 << 5 | 1 };

static const uint32_t FULL = UINT32_MAX; /* the true number is in a field of 64 bits */

static uint32_t clip_to_32_bits(uint64_t number)
{
    return number < FULL ? (uint32_t)number : FULL;
}

/* Writes the sizes of an entry in 64 bits each, and its start if that is not NULL. */
static unsigned char *put_extra(unsigned char *to, uint64_t size, uint64_t packed,
                                const uint64_t *start)
{
    to = cwi_put_u16(to, 1);
    to = cwi_put_u16(to, start ? 24 : 16);
    to = cwi_put_u64(to, size);
    to = cwi_put_u64(to, packed);
    return start ? cwi_put_u64(to, *start) : to;
}

/* Writes the common part of both headers of an entry. */
static unsigned char *put_common(unsigned char *to, const cwi_zip_entry *e, bool wide)
{
    to = cwi_put_u16(to, wide ? VERSION64 : VERSION);
    to = cwi_put_u16(to, 0); /* flags */
    to = cwi_put_u16(to, DEFLATED);
    to = cwi_put_u16(to, TIME);
    to = cwi_put_u16(to, DAY);
    to = cwi_put_u32(to, e->crc);
    to = cwi_put_u32(to, wide ? FULL : (uint32_t)e->packed);
    to = cwi_put_u32(to, wide ? FULL : (uint32_t)e->size);
    return cwi_put_u16(to, (uint16_t)strlen(e->name));
}

/* Writes the header before the entry: first without sums, and again when they are known. */
static unsigned char *put_local(unsigned char *to, const cwi_zip_entry *e)
{
    to = cwi_put_u32(to, 0x04034b50);
    to = put_common(to, e, e->huge);
    to = cwi_put_u16(to, e->huge ? EXTRA : 0);
    memcpy(to, e->name, strlen(e->name));
    to += strlen(e->name);
    return e->huge ? put_extra(to, e->size, e->packed, NULL) : to;
}

static unsigned char *put_central(unsigned char *to, const cwi_zip_entry *e)
{
    const bool wide = e->size >= FULL || e->packed >= FULL || e->start >= FULL;
    to = cwi_put_u32(to, 0x02014b50);
    to = cwi_put_u16(to, wide ? VERSION64 : VERSION);
    to = put_common(to, e, wide);
    to = cwi_put_u16(to, wide ? EXTRA + 8 : 0);
    to = cwi_put_u16(to, 0); /* comment */
    to = cwi_put_u16(to, 0); /* disk */
    to = cwi_put_u16(to, 0);
    to = cwi_put_u32(to, 0); /* attributes */
    to = cwi_put_u32(to, wide ? FULL : (uint32_t)e->start);
    memcpy(to, e->name, strlen(e->name));
    to += strlen(e->name);
    return wide ? put_extra(to, e->size, e->packed, &e->start) : to;
}

/* Writes the directory's place in 64 bits, and a locator for it. */
static unsigned char *put_end64(unsigned char *to, size_t count, uint64_t start, uint64_t size)
{
    to = cwi_put_u32(to, 0x06064b50);
    to = cwi_put_u64(to, END64 - 12);
    to = cwi_put_u16(to, VERSION64);
    to = cwi_put_u16(to, VERSION64);
    to = cwi_put_u64(to, 0); /* disks */
    to = cwi_put_u64(to, count);
    to = cwi_put_u64(to, count);
    to = cwi_put_u64(to, size);
    to = cwi_put_u64(to, start);
    to = cwi_put_u32(to, 0x07064b50);
    to = cwi_put_u32(to, 0);
    to = cwi_put_u64(to, start + size);
    return cwi_put_u32(to, 1);
}

static unsigned char *put_end(unsigned char *to, size_t count, uint64_t start, uint64_t size)
{
    if (start >= FULL)
        to = put_end64(to, count, start, size);
    to = cwi_put_u32(to, 0x06054b50);
    to = cwi_put_u32(to, 0); /* disks */
    to = cwi_put_u16(to, (uint16_t)count);
    to = cwi_put_u16(to, (uint16_t)count);
    to = cwi_put_u32(to, (uint32_t)size);
    to = cwi_put_u32(to, clip_to_32_bits(start));
    return cwi_put_u16(to, 0);
}

cw_status cwi_zip_begin(cwi_zip *z, const char *name, bool huge, cw_error *err)
{
    unsigned char head[LOCAL + EXTRA + 64];
    assert(z->count < CWI_ZIP_ENTRIES && strlen(name) < 64);
    cwi_zip_entry *e = &z->entries[z->count++];
    *e = (cwi_zip_entry){.name = name, .huge = huge, .start = cwi_outfile_size(z->file)};
    const unsigned char *end = put_local(head, e);
    cw_status st = cwi_outfile_write(z->file, head, (size_t)(end - head), err);
    return st == CW_OK ? cwi_sink_open(&z->sink, z->file, CWI_DEFLATE, err) : st;
}

cw_status cwi_zip_put(void *zip, const void *bytes, size_t size, cw_error *err)
{
    cwi_zip *z = zip;
    cwi_zip_entry *e = &z->entries[z->count - 1];
    e->size += size;
    e->crc = (uint32_t)crc32_z(e->crc, bytes, size);
    return cwi_sink_write(&z->sink, bytes, size, err);
}

cw_status cwi_zip_end(cwi_zip *z, cw_error *err)
{
    unsigned char head[LOCAL + EXTRA + 64];
    cwi_zip_entry *e = &z->entries[z->count - 1];
    cw_status st = cwi_sink_finish(&z->sink, err);
    e->packed = z->sink.written;
    cwi_sink_close(&z->sink);
    if (st == CW_OK && !e->huge && (e->size >= FULL || e->packed >= FULL))
        st = cwi_fail(err, CW_ERR_LIMIT, "'%s' in the archive has more than 4 GiB", e->name);
    if (st != CW_OK)
        return st;
    const unsigned char *end = put_local(head, e);
    return cwi_outfile_patch(z->file, e->start + SUMS_AT, head + SUMS_AT,
                             (size_t)(end - head) - SUMS_AT, err);
}

cw_status cwi_zip_text(cwi_zip *z, const char *name, const char *text, cw_error *err)
{
    cw_status st = cwi_zip_begin(z, name, false, err);
    if (st == CW_OK)
        st = cwi_zip_put(z, text, strlen(text), err);
    return st == CW_OK ? cwi_zip_end(z, err) : st;
}

cw_status cwi_zip_finish(cwi_zip *z, cw_error *err)
{
    unsigned char record[CENTRAL + EXTRA + 8 + 64 + END64 + LOCATOR + END];
    const uint64_t start = cwi_outfile_size(z->file);
    cw_status st = CW_OK;
    for (size_t i = 0; i < z->count && st == CW_OK; i++) {
        const unsigned char *end = put_central(record, &z->entries[i]);
        st = cwi_outfile_write(z->file, record, (size_t)(end - record), err);
    }
    const unsigned char *end =
        put_end(record, z->count, start, cwi_outfile_size(z->file) - start);
    return st == CW_OK ? cwi_outfile_write(z->file, record, (size_t)(end - record), err) : st;
}

void cwi_zip_close(cwi_zip *z)
{
    cwi_sink_close(&z->sink);
    *z = (cwi_zip){0};
}
