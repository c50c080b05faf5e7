/* Decodes deflated strips and tiles of TIFF, and their predictors. libtiff does not do it, for
 * two reasons. It accepts partial data where a damaged stream needs more room than there is.
 * And it verifies no checksum of a strip that it reads by zlib. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/bytes/byte_order.h"
#include "formats/bytes/inflate_stream.h"
#include "formats/tiff/tiff_file.h"

#include <string.h>

enum { NO_PREDICTOR = 1, DIFFERENCES = 2, FLOATS = 3, MAX_AT_ONCE = 1 << 30 };

/* Replaces numbers by their running sums, separately for each sample. */
static void add_up(void *row, size_t count, size_t stride, size_t size)
{
    uint8_t *u8 = row;
    uint16_t *u16 = row;
    uint32_t *u32 = row;
    uint64_t *u64 = row;
    for (size_t i = stride; size == 1 && i < count; i++)
        u8[i] = (uint8_t)(u8[i] + u8[i - stride]);
    for (size_t i = stride; size == 2 && i < count; i++)
        u16[i] = (uint16_t)(u16[i] + u16[i - stride]);
    for (size_t i = stride; size == 4 && i < count; i++)
        u32[i] += u32[i - stride];
    for (size_t i = stride; size == 8 && i < count; i++)
        u64[i] += u64[i - stride];
}

/* Joins the bytes of floats: they are stored as all high bytes, then all the next ones, ..., in
 * any byte order of the file. */
static void join_floats(unsigned char *row, unsigned char *copy, size_t count, size_t size)
{
    memcpy(copy, row, count * size);
    for (size_t b = 0; b < size; b++) {
        const size_t to = cwi_machine_is_big_endian() ? b : size - 1 - b;
        for (size_t i = 0; i < count; i++)
            row[i * size + to] = copy[b * count + i];
    }
}

/* Converts deflated rows into numbers of this machine. */
static void undo_predictor(const cwi_tiff_file *f, unsigned char *row, size_t bytes,
                           unsigned char *copy)
{
    const cwi_tiff_layout *l = &f->layout;
    const size_t size = l->bits < 8 ? 1 : l->bits / 8;
    const size_t stride = l->planes > 1 ? 1 : l->samples;
    if (l->predictor == FLOATS) {
        add_up(row, bytes, stride, 1);
        join_floats(row, copy, bytes / size, size);
        return;
    }
    if (TIFFIsByteSwapped(f->tiff))
        cwi_swap_bytes(row, bytes / size, size);
    if (l->predictor == DIFFERENCES)
        add_up(row, bytes / size, stride, size);
}

static cw_status check_predictor(const cwi_tiff_layout *l, cw_error *err)
{
    const bool good = l->predictor == NO_PREDICTOR ||
                      (l->predictor == DIFFERENCES && l->bits >= 8) ||
                      (l->predictor == FLOATS && l->format == SAMPLEFORMAT_IEEEFP);
    return good ? CW_OK
                : cwi_fail(err, CW_ERR_FORMAT, "'Predictor' is %u, with %u bits a sample",
                           l->predictor, l->bits);
}

/* Reads on to the checksum, past rows that some writers put after those of a short strip.
 * Further bytes of the strip are ignored. */
static cw_status finish_stream(cwi_stream *s, size_t bytes, cw_error *err)
{
    unsigned char waste[4096];
    cw_status st = CW_OK;
    for (size_t n = 0, got; st == CW_OK && !s->ended && n <= bytes; n += got)
        st = cwi_stream_some(s, waste, sizeof waste, &got, err);
    if (st == CW_OK && s->truncated)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the compressed data break off before their checksum");
    return st;
}

cw_status cwi_tiff_ensure_capacity(unsigned char **buffer, size_t *capacity, uint64_t bytes,
                                   cw_error *err)
{
    if (bytes > MAX_AT_ONCE)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "a strip or row of tiles takes %llu bytes; the most are %d",
                        (unsigned long long)bytes, MAX_AT_ONCE);
    if (bytes <= *capacity)
        return CW_OK;
    cwi_free(*buffer);
    *buffer = cwi_alloc_array(bytes, 1);
    *capacity = *buffer ? bytes : 0;
    return *buffer ? CW_OK : cwi_fail_memory(err);
}

cw_status cwi_tiff_inflate(cwi_tiff_file *f, uint32_t strile, unsigned char *to, size_t bytes,
                           size_t row_bytes, cw_error *err)
{
    const uint64_t at = TIFFGetStrileOffset(f->tiff, strile);
    cwi_stream stream = {0};
    cw_status st = check_predictor(&f->layout, err);
    if (st == CW_OK)
        st = cwi_stream_open(&stream, f->fd, at, true, err);
    if (st == CW_OK) {
        cwi_stream_end_at(&stream, at + TIFFGetStrileByteCount(f->tiff, strile));
        st = cwi_stream_read(&stream, to, bytes, err);
        if (st == CW_OK)
            st = finish_stream(&stream, bytes, err);
        cwi_stream_close(&stream);
    }
    if (st == CW_OK && f->layout.predictor == FLOATS)
        st = cwi_tiff_ensure_capacity(&f->line, &f->line_capacity, row_bytes, err);
    for (size_t r = 0; st == CW_OK && r < bytes; r += row_bytes)
        undo_predictor(f, to + r, row_bytes, f->line);
    return st;
}
