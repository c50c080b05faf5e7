/* Opens the files of a source, checks their sizes, and decodes wanted bytes of them. */
#define _GNU_SOURCE /* close */
#include "formats/volume/voxel_parts.h"

#include "core/base/status.h"
#include "formats/bytes/byte_order.h"
#include "formats/bytes/bzip2.h"
#include "formats/volume/volume_reader.h"

#include <stdio.h>
#include <unistd.h>

enum { SLAB_BYTES = 1 << 20, WORTH_BYTES = 4 << 20 }; /* WORTH_BYTES: decoded, worth a thread */

const char *cwi_source_noun(const cwi_source *src)
{
    return src->noun ? src->noun : "voxels";
}

size_t cwi_source_part_bytes(const cwi_source *src)
{
    return src->files.count ? src->bytes / src->files.count : src->bytes;
}

/* Returns the bytes of voxels in each file, before they are converted to the type in memory. */
static uint64_t stored_part_bytes(const cwi_source *src)
{
    const uint64_t size = cw_type_size(src->shape.type);
    const uint64_t stored =
        src->encoding == CWI_ASCII ? size : cwi_stored_size(src->stored, src->shape.type);
    return cwi_source_part_bytes(src) / size * stored; /* valid: the first factor is < 2^62 */
}

/* Moves *start behind the lines to leave out. */
static cw_status skip_lines(const cwi_part_file *p, uint64_t lines, uint64_t *start,
                            cw_error *err)
{
    char text[4096];
    size_t got = 0, used = 0;
    for (uint64_t line = 0; line < lines; used++, *start += 1) {
        if (used == got) {
            cw_status st = cwi_input_read_at(p->fd, *start, text, sizeof text, &got, err);
            if (st != CW_OK)
                return st;
            if (got == 0)
                return cwi_fail(err, CW_ERR_FORMAT,
                                "the file has %llu lines; %llu are to be skipped",
                                (unsigned long long)line, (unsigned long long)lines);
            used = 0;
        }
        line += text[used] == '\n';
    }
    return CW_OK;
}

/* Returns the bytes to skip after decoding. */
static uint64_t decoded_skip(const cwi_source *src)
{
    const bool packed = src->encoding == CWI_DEFLATED || src->encoding == CWI_BARE ||
                        src->encoding == CWI_BZIP2;
    return packed || src->base64 ? src->skip : 0;
}

/* Returns the bytes of the file, or the maximum that base64 text of that size can hold. */
static uint64_t bytes_of_text(const cwi_source *src, uint64_t encoded)
{
    return src->base64 ? encoded / 4 * 3 + encoded % 4 : encoded;
}

/* Returns the maximum of voxel bytes that the encoded bytes in the file can stand for. Deflate
 * expands data at most 1032 times, bzip2 by its blocks. A number and its blank take two bytes;
 * the last may lack the blank. For CWI_BLOCKS the table states the sizes. */
static uint64_t max_bytes(const cwi_source *src, uint64_t encoded)
{
    const uint64_t voxel = cw_type_size(src->shape.type);
    const uint64_t max_ratio = src->encoding == CWI_ASCII   ? voxel
                               : src->encoding == CWI_BZIP2 ? CWI_BZIP2_BLOCK / CWI_BZIP2_PACKED
                                                            : 1032;
    encoded = bytes_of_text(src, encoded);
    if (src->encoding == CWI_RAW || src->encoding == CWI_HEX)
        return src->encoding == CWI_HEX ? encoded / 2 : encoded;
    if (src->encoding == CWI_ASCII)
        encoded = encoded / 2 + 1;
    return encoded > UINT64_MAX / max_ratio ? UINT64_MAX : encoded * max_ratio;
}

static cw_status check_part_bytes(const cwi_source *src, cwi_part_file *p, cw_error *err)
{
    const uint64_t part_bytes = stored_part_bytes(src);
    uint64_t selected;
    if (src->at_end)
        p->start = p->size > part_bytes ? p->size - part_bytes : 0;
    const uint64_t encoded = p->size > p->start ? p->size - p->start : 0;
    if (!__builtin_add_overflow(decoded_skip(src), part_bytes, &selected) &&
        selected <= max_bytes(src, encoded)) {
        p->left = src->is_last && src->encoding == CWI_RAW ? encoded - part_bytes : 0;
        return CW_OK;
    }
    return cwi_fail(err, CW_ERR_FORMAT,
                    "'%s' asks for %llu bytes of %s%s%s; the file holds %llu bytes behind the "
                    "first %llu",
                    src->size_field, (unsigned long long)part_bytes, cwi_source_noun(src),
                    src->encoding == CWI_RAW ? "" : ", encoded",
                    src->files.count > 1 ? " in each file" : "", (unsigned long long)encoded,
                    (unsigned long long)p->start);
}

/* Opens a stream over the encoded voxels of a part, and the table of their blocks, if any.
 * Close both in any case. */
cw_status cwi_part_open_stream(const cwi_source *src, const cwi_part_file *p,
                               cwi_stream *stream, cwi_packed_blocks *blocks, cw_error *err)
{
    cw_status st =
        src->encoding == CWI_BZIP2 ? cwi_stream_open_bzip2(stream, p->fd, p->start, err)
        : src->encoding == CWI_BARE
            ? cwi_stream_open_bare(stream, p->fd, p->start, src->crc, err)
            : cwi_stream_open(stream, p->fd, p->start, src->encoding == CWI_DEFLATED, err);
    if (st != CW_OK)
        return st;
    cwi_stream_end_at(stream, p->size);
    if (src->base64)
        st = cwi_stream_from_base64(stream, err);
    if (src->encoding == CWI_HEX)
        st = cwi_stream_from_hex(stream, err);
    if (st == CW_OK && stored_part_bytes(src) >= WORTH_BYTES)
        cwi_stream_inflate_ahead(stream);
    if (st == CW_OK)
        st = cwi_stream_skip(stream, decoded_skip(src), err);
    if (st == CW_OK && src->encoding == CWI_BLOCKS)
        st = cwi_blocks_open(blocks, stream, &src->blocks, stored_part_bytes(src),
                             bytes_of_text(src, p->size - p->start), err);
    return st;
}

/* Checks a table of blocks, which states sizes more precisely than the size of the file. */
static cw_status check_blocks(const cwi_source *src, const cwi_part_file *p, cw_error *err)
{
    cwi_stream stream = {0};
    cwi_packed_blocks blocks = {0};
    if (src->encoding != CWI_BLOCKS)
        return CW_OK;
    cw_status st = cwi_part_open_stream(src, p, &stream, &blocks, err);
    cwi_blocks_close(&blocks);
    cwi_stream_close(&stream);
    return st;
}

void cwi_part_close(cwi_part_file *p)
{
    if (p->own)
        close(p->fd);
    *p = (cwi_part_file){0};
}

const char *cwi_part_name(const cwi_source *src, size_t index)
{
    return src->files.count ? src->files.items[index] : NULL;
}

cw_status cwi_part_open(const cwi_source *src, const cwi_input *in, size_t index,
                        cwi_part_file *p, cw_error *err)
{
    const char *name = cwi_part_name(src, index);
    *p = (cwi_part_file){.fd = in->fd, .size = in->size, .start = src->offset};
    cw_status st = name ? cwi_input_open_side(in, name, &p->fd, &p->size, err) : CW_OK;
    p->own = name && st == CW_OK;
    if (st == CW_OK)
        st = skip_lines(p, src->lines, &p->start, err);
    if (__builtin_add_overflow(p->start, src->skip - decoded_skip(src), &p->start))
        p->start = UINT64_MAX;
    if (src->span && p->start < p->size && src->span < p->size - p->start)
        p->size = p->start + src->span;
    if (st == CW_OK && src->packed > p->size - (p->start < p->size ? p->start : p->size))
        st = cwi_fail(err, CW_ERR_FORMAT,
                      "'CompressedDataSize' is %llu; the file holds %llu bytes",
                      (unsigned long long)src->packed,
                      (unsigned long long)(p->start < p->size ? p->size - p->start : 0));
    if (st == CW_OK)
        st = check_part_bytes(src, p, err);
    if (st == CW_OK)
        st = check_blocks(src, p, err);
    if (st != CW_OK)
        cwi_part_close(p);
    return st;
}

/* Decodes whole blocks directly to their place. Their ends need not be those of voxels. */
static cw_status take_blocks(cwi_part_reading *r, size_t max, size_t *got, cw_error *err)
{
    const size_t voxel = cw_type_size(r->src->shape.type);
    size_t n = 0;
    cw_status st = CW_OK;
    for (*got = 0; st == CW_OK && (*got == 0 || *got % voxel); *got += n)
        st = cwi_blocks_some(&r->blocks, r->to + *got, max - *got, &n, err);
    return st;
}

/* Reads decoded bytes, as many as asked for. */
static cw_status read_decoded(cwi_part_reading *r, unsigned char *to, size_t bytes,
                              cw_error *err)
{
    size_t n = 0;
    cw_status st = CW_OK;
    if (r->src->encoding != CWI_BLOCKS)
        return cwi_stream_read(&r->stream, to, bytes, err);
    for (size_t got = 0; st == CW_OK && got < bytes; got += n)
        st = cwi_blocks_some(&r->blocks, to + got, bytes - got, &n, err);
    return st;
}

/* Reads the next voxels, which have a form of their own in the file, and converts them. */
static cw_status take_stored(cwi_part_reading *r, size_t count, cw_error *err)
{
    enum { AT_ONCE = 4096 };
    uint64_t numbers[AT_ONCE];
    const cwi_source *src = r->src;
    const cw_type type = src->shape.type;
    const size_t size = cwi_stored_size(src->stored, type), voxel = cw_type_size(type);
    cw_status st = CW_OK;
    for (size_t at = 0, n; st == CW_OK && at < count; at += n) {
        n = count - at < AT_ONCE ? count - at : AT_ONCE;
        st = read_decoded(r, (unsigned char *)numbers, n * size, err);
        if (st != CW_OK)
            return st;
        if (src->big_endian != cwi_machine_is_big_endian())
            cwi_swap_bytes(numbers, n, size);
        const size_t good =
            cwi_stored_convert(src->stored, type, numbers, size, n, r->to + at * voxel);
        if (good < n) {
            r->needs_u32 = cwi_stored_needs_u32(src->stored, &numbers[good]);
            st = cwi_stored_fail(src->stored, type, &numbers[good], err);
        }
    }
    return st;
}

/* Reads the next voxels to their place: a portion of at most `max` bytes. */
static cw_status take_bytes(cwi_part_reading *r, size_t max, size_t *got, cw_error *err)
{
    const cwi_source *src = r->src;
    const size_t voxel = cw_type_size(src->shape.type);
    cw_status st;
    *got = max < SLAB_BYTES ? max : SLAB_BYTES;
    if (src->encoding == CWI_ASCII)
        return cwi_numbers_read(&r->numbers, src->shape.type, r->to, *got / voxel, err);
    if (src->stored != CWI_STORED_PLAIN)
        return take_stored(r, *got / voxel, err);
    if (src->encoding == CWI_BLOCKS)
        st = take_blocks(r, max, got, err);
    else
        st = cwi_stream_read(&r->stream, r->to, *got, err);
    if (st == CW_OK && src->big_endian != cwi_machine_is_big_endian())
        cwi_swap_bytes(r->to, *got / voxel, voxel);
    return st;
}

/* Skips the next voxels: a portion of at most `max` bytes. */
static cw_status drop_bytes(cwi_part_reading *r, uint64_t max, size_t *got, cw_error *err)
{
    const cw_type type = r->src->shape.type;
    *got = max < SLAB_BYTES ? (size_t)max : SLAB_BYTES;
    const size_t count = *got / cw_type_size(type);
    const size_t stored = count * cwi_stored_size(r->src->stored, type);
    if (r->src->encoding == CWI_ASCII)
        return cwi_numbers_read(&r->numbers, type, NULL, count, err);
    if (r->src->encoding != CWI_BLOCKS)
        return cwi_stream_skip(&r->stream, stored, err);
    cwi_blocks_skip(&r->blocks, stored);
    return CW_OK;
}

/* Reads or skips the next bytes of the part, portion by portion. */
static cw_status pass_bytes(cwi_part_reading *r, uint64_t bytes, bool selected, cw_error *err)
{
    cw_status st = CW_OK;
    while (st == CW_OK && bytes > 0) {
        size_t n = 0;
        st = cwi_progress(r->progress, "reading", (double)r->at / (double)r->runs.end, err);
        if (st == CW_OK)
            st = selected ? take_bytes(r, (size_t)bytes, &n, err)
                          : drop_bytes(r, bytes, &n, err);
        r->at += n;
        bytes -= n;
        if (selected)
            r->to += n;
    }
    return st;
}

/* Checks if compressed data end later than the header states. A stated end that is too far is
 * accepted: there is only padding. So is one that is too near in a file of voxels alone, whose
 * checksum proves it complete: VTK's sample frogtissue.mhd names 260 020 of 262 087 bytes. */
cw_status cwi_part_check_packed(const cwi_part_reading *r, uint64_t start, cw_error *err)
{
    const cwi_stream *s = &r->stream;
    if (!r->src->packed || r->src->files.count || !s->ended || s->truncated ||
        s->packed_end - start <= r->src->packed)
        return CW_OK;
    return cwi_fail(
        err, CW_ERR_FORMAT, "'CompressedDataSize' is %llu; the compressed data take %llu bytes",
        (unsigned long long)r->src->packed, (unsigned long long)(s->packed_end - start));
}

/* Reads compressed data to their end, and counts the decoded bytes behind the voxels. */
static cw_status finish_part(cwi_part_reading *r, cw_error *err)
{
    const uint64_t given = r->stream.given;
    cw_status st = cwi_stream_finish(&r->stream, err);
    if (r->src->is_last)
        r->left += r->stream.given - given;
    return st;
}

void cwi_part_note_left(const cwi_source *src, uint64_t left, const cw_read_desc *desc)
{
    const uint64_t all = stored_part_bytes(src) * (src->files.count ? src->files.count : 1);
    char times[80] = "";
    if (left == 0)
        return;
    if (left % all == 0)
        snprintf(times, sizeof times, ", which makes %llu times as many in all",
                 (unsigned long long)(left / all + 1));
    cwi_note(desc,
             "'%s' and the type %s ask for %llu bytes of %s; behind them %llu more are left "
             "over%s",
             src->size_field,
             src->stored ? cwi_stored_name(src->stored) : cw_type_name(src->shape.type),
             (unsigned long long)all, cwi_source_noun(src), (unsigned long long)left, times);
}

/* Reads the wanted bytes of a part that ends at this offset of all. Bytes behind the last
 * wanted one are not read, so the checksum is verified only where the part was read to its
 * end. */
cw_status cwi_part_read_runs(cwi_part_reading *r, uint64_t end, cw_error *err)
{
    cw_status st = CW_OK;
    while (st == CW_OK && r->runs.left > 0 && r->runs.next < end) {
        const uint64_t rest = end - r->runs.next;
        const uint64_t bytes = r->runs.left < rest ? r->runs.left : rest;
        st = pass_bytes(r, r->runs.next - r->at, false, err);
        if (st == CW_OK)
            st = pass_bytes(r, bytes, true, err);
        cwi_runs_take(&r->runs, bytes);
    }
    return st == CW_OK && r->at == end ? finish_part(r, err) : st;
}
