/* Reads rows of pixels from the pages of a TIFF file. Uncompressed strips are read from the
 * file itself: any rows, of a strip of any length. libtiff decodes the rest, a strip or a row
 * of tiles at a time. */
#define _GNU_SOURCE /* pread */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/tiff/tiff_file.h"

#include <string.h>
#include <unistd.h>

enum { PIECE = 1 << 20, MAX_PIXEL = 4 * 8 };

static cw_status fail_page(const cwi_tiff_file *f, const char *why, cw_error *err)
{
    return cwi_fail(err, CW_ERR_FORMAT, "the pixels of page %u cannot be read: %s",
                    (uint32_t)f->page + 1, why);
}

/* --- uncompressed data -------------------------------------------------------------------- */

static bool is_raw(const cwi_tiff_layout *l)
{
    return !l->tiled && l->compression == COMPRESSION_NONE;
}

/* Finds the place of a row, and the number of wanted rows that follow without a gap. */
static uint64_t find_row(const cwi_tiff_file *f, uint16_t plane, uint32_t row,
                         uint32_t expected, uint32_t *run)
{
    const cwi_tiff_layout *l = &f->layout;
    const uint32_t first = row / l->band_rows, from = row % l->band_rows;
    if (f->behind) {
        *run = l->rows - row;
        return f->behind + ((uint64_t)f->page * l->rows + row) * l->stored_row;
    }
    const uint32_t before = plane * l->bands;
    const uint64_t start = TIFFGetStrileOffset(f->tiff, before + first);
    uint64_t end = start;
    *run = 0;
    for (uint32_t s = first; s < l->bands && *run < from + expected;
         s++, *run += l->band_rows) {
        if (TIFFGetStrileOffset(f->tiff, before + s) != end)
            break;
        end += (uint64_t)l->band_rows * l->stored_row;
    }
    *run -= from;
    return start + (uint64_t)from * l->stored_row;
}

static cw_status read_bytes(const cwi_tiff_file *f, uint64_t at, unsigned char *to, size_t size,
                            cw_error *err)
{
    for (size_t got = 0; got < size;) {
        const ssize_t n = pread(f->fd, to + got, size - got, (off_t)(at + got));
        if (n <= 0)
            return fail_page(f, "the file ends before them", err);
        got += (size_t)n;
    }
    return CW_OK;
}

static void mend_bytes(const cwi_tiff_file *f, unsigned char *bytes, size_t size)
{
    const cwi_tiff_layout *l = &f->layout;
    if (l->low_bit_first)
        TIFFReverseBits(bytes, (tmsize_t)size);
    if (!TIFFIsByteSwapped(f->tiff))
        return;
    if (l->bits == 16)
        TIFFSwabArrayOfShort((void *)bytes, (tmsize_t)(size / 2));
    else if (l->bits == 32)
        TIFFSwabArrayOfLong((void *)bytes, (tmsize_t)(size / 4));
    else if (l->bits == 64)
        TIFFSwabArrayOfLong8((void *)bytes, (tmsize_t)(size / 8));
}

static cw_status read_raw(const cwi_tiff_file *f, uint16_t plane, uint32_t row, uint32_t count,
                          unsigned char *to, cw_error *err)
{
    const size_t stored = f->layout.stored_row;
    cw_status st = CW_OK;
    for (uint32_t run; st == CW_OK && count > 0; row += run, count -= run, to += run * stored) {
        const uint64_t at = find_row(f, plane, row, count, &run);
        run = run < count ? run : count;
        st = read_bytes(f, at, to, run * stored, err);
        if (st == CW_OK)
            mend_bytes(f, to, run * stored);
    }
    return st;
}

/* --- compressed data ---------------------------------------------------------------------- */

/* Checks a result of libtiff, which continues over damage with a warning and returns partial
 * data. */
static cw_status check_decoded(const cwi_tiff_file *f, tmsize_t got, size_t expected,
                               cw_error *err)
{
    if (got == (tmsize_t)expected && !f->complained)
        return CW_OK;
    return fail_page(f, f->complained ? f->complaint : "they are too few", err);
}

/* Decodes a strip or tile. */
static cw_status decode_strip(cwi_tiff_file *f, uint32_t n, unsigned char *to, size_t bytes,
                              size_t row_bytes, cw_error *err)
{
    cw_error why = {0};
    cwi_tiff_listen(f);
    if (cwi_tiff_is_deflated(&f->layout)) {
        cw_status st = cwi_tiff_inflate(f, n, to, bytes, row_bytes, &why);
        return st == CW_ERR_FORMAT ? fail_page(f, why.message, err)
               : st == CW_OK       ? st
                                   : cwi_fail(err, st, "%s", why.message);
    }
    memset(to, 0, bytes);
    const tmsize_t size = (tmsize_t)bytes;
    return check_decoded(f,
                         f->layout.tiled ? TIFFReadEncodedTile(f->tiff, n, to, size)
                                         : TIFFReadEncodedStrip(f->tiff, n, to, size),
                         bytes, err);
}

/* Decodes a row of tiles, as far as they are in the image. */
static cw_status decode_tiles(cwi_tiff_file *f, uint32_t first, uint32_t rows,
                              unsigned char *to, cw_error *err)
{
    const cwi_tiff_layout *l = &f->layout;
    const size_t bytes = (size_t)TIFFTileSize64(f->tiff), tile_row = bytes / l->band_rows;
    const uint32_t across = (l->columns - 1) / l->tile_width + 1;
    cw_status st = cwi_tiff_ensure_capacity(&f->tile, &f->tile_capacity, bytes, err);
    for (uint32_t t = 0; st == CW_OK && t < across; t++) {
        const size_t from = t * tile_row, left = l->stored_row - from;
        cwi_tiff_listen(f);
        memset(f->tile, 0, bytes);
        st = check_decoded(f, TIFFReadEncodedTile(f->tiff, first + t, f->tile, (tmsize_t)bytes),
                           bytes, err);
        for (uint32_t r = 0; st == CW_OK && r < rows; r++)
            memcpy(to + r * l->stored_row + from, f->tile + r * tile_row,
                   left < tile_row ? left : tile_row);
    }
    return st;
}

static uint32_t rows_of_band(const cwi_tiff_layout *l, uint32_t band)
{
    const uint32_t left = l->rows - band * l->band_rows;
    return left < l->band_rows ? left : l->band_rows;
}

/* Decodes the planes of a band into f->pixels. */
static cw_status decode_band(cwi_tiff_file *f, uint32_t band, cw_error *err)
{
    const cwi_tiff_layout *l = &f->layout;
    const uint32_t rows = rows_of_band(l, band);
    const uint32_t across = (l->columns - 1) / l->tile_width + 1;
    const uint64_t plane = (uint64_t)rows * l->stored_row;
    if (f->band == band)
        return CW_OK;
    f->band = -1;
    cw_status st =
        cwi_tiff_ensure_capacity(&f->pixels, &f->pixel_capacity, plane * l->planes, err);
    for (uint16_t p = 0; st == CW_OK && p < l->planes; p++) {
        const uint32_t first = (p * l->bands + band) * across;
        st = l->tiled
                 ? decode_tiles(f, first, rows, f->pixels + p * plane, err)
                 : decode_strip(f, first, f->pixels + p * plane, plane, l->stored_row, err);
    }
    if (st == CW_OK)
        f->band = band;
    return st;
}

/* --- from stored rows to rows ------------------------------------------------------------- */

static bool is_flipped(const cwi_tiff_layout *l)
{
    return l->orientation == ORIENTATION_BOTLEFT || l->orientation == ORIENTATION_BOTRIGHT;
}

static bool is_mirrored(const cwi_tiff_layout *l)
{
    return l->orientation == ORIENTATION_TOPRIGHT || l->orientation == ORIENTATION_BOTRIGHT;
}

/* Returns true if rows are returned as libtiff returns them. */
static bool is_plain(const cwi_tiff_layout *l)
{
    return l->bits > 1 && !l->stored && l->planes == 1 && !l->turned &&
           l->orientation == ORIENTATION_TOPLEFT;
}

static void unpack_bits(const unsigned char *bits, size_t count, unsigned char *to, size_t step)
{
    for (size_t i = 0; i < count; i++)
        to[i * step] = bits[i / 8] >> (7 - i % 8) & 1;
}

static void spread_samples(const unsigned char *from, size_t count, size_t size,
                           unsigned char *to, size_t step)
{
    for (size_t i = 0; i < count; i++)
        memcpy(to + i * step * size, from + i * size, size);
}

/* Converts samples that have a form of their own in the file. */
static cw_status convert_samples(const cwi_tiff_layout *l, const unsigned char *from,
                                 size_t count, unsigned char *to, size_t step, cw_error *err)
{
    const size_t stored = cwi_stored_size(l->stored, l->type), size = cw_type_size(l->type);
    if (step == 1) {
        const size_t good = cwi_stored_convert(l->stored, l->type, from, stored, count, to);
        return good == count ? CW_OK
                             : cwi_stored_fail(l->stored, l->type, from + good * stored, err);
    }
    for (size_t i = 0; i < count; i++)
        if (cwi_stored_convert(l->stored, l->type, from + i * stored, stored, 1,
                               to + i * step * size) != 1)
            return cwi_stored_fail(l->stored, l->type, from + i * stored, err);
    return CW_OK;
}

/* Inverts samples, so that larger is brighter; alpha and other extra samples stay unchanged. */
static void turn_round(const cwi_tiff_layout *l, unsigned char *row)
{
    const size_t size = cw_type_size(l->type);
    const unsigned char mask = l->bits == 1 ? 1 : 0xff;
    for (size_t i = 0; i < l->columns; i++, row += l->samples * size)
        for (size_t b = 0; b < size; b++)
            row[b] ^= mask;
}

static void mirror_row(const cwi_tiff_layout *l, unsigned char *row)
{
    const size_t size = l->samples * cw_type_size(l->type);
    unsigned char kept[MAX_PIXEL];
    for (size_t i = 0, k = l->columns - 1; i < k; i++, k--) {
        memcpy(kept, row + i * size, size);
        memcpy(row + i * size, row + k * size, size);
        memcpy(row + k * size, kept, size);
    }
}

/* Assembles a row. stored: the row of the first plane; each next plane is `plane` bytes
 * further. */
static cw_status put_row(const cwi_tiff_layout *l, const unsigned char *stored, size_t plane,
                         unsigned char *to, cw_error *err)
{
    cw_status st = CW_OK;
    const size_t size = cw_type_size(l->type);
    const size_t count = l->planes > 1 ? l->columns : (size_t)l->columns * l->samples;
    for (uint16_t p = 0; st == CW_OK && p < l->planes; p++, stored += plane) {
        if (l->stored)
            st = convert_samples(l, stored, count, to + p * size, l->planes, err);
        else if (l->bits == 1)
            unpack_bits(stored, count, to + p, l->planes);
        else if (l->planes > 1)
            spread_samples(stored, count, size, to + p * size, l->planes);
        else
            memcpy(to, stored, l->stored_row);
    }
    if (l->turned)
        turn_round(l, to);
    if (is_mirrored(l))
        mirror_row(l, to);
    return st;
}

/* Reads stored rows from one on into memory, as many as one piece holds. */
static cw_status read_piece(cwi_tiff_file *f, uint32_t row, uint32_t max,
                            const unsigned char **stored, size_t *plane, uint32_t *count,
                            cw_error *err)
{
    const cwi_tiff_layout *l = &f->layout;
    cw_status st;
    if (!is_raw(l)) {
        const uint32_t band = row / l->band_rows, from = row % l->band_rows;
        *count = rows_of_band(l, band) - from;
        *plane = rows_of_band(l, band) * l->stored_row;
        st = decode_band(f, band, err);
        if (st == CW_OK)
            *stored = f->pixels + from * l->stored_row;
        return st;
    }
    const size_t fit = PIECE / (l->stored_row * l->planes);
    *count = fit < 1 ? 1 : fit < max ? (uint32_t)fit : max;
    *plane = *count * l->stored_row;
    st = cwi_tiff_ensure_capacity(&f->pixels, &f->pixel_capacity, (uint64_t)*plane * l->planes,
                                  err);
    for (uint16_t p = 0; st == CW_OK && p < l->planes; p++)
        st = read_raw(f, p, row, *count, f->pixels + p * *plane, err);
    *stored = f->pixels;
    return st;
}

/* Returns true for a whole strip without conversion; it goes directly to its place. */
static bool rows_fit(const cwi_tiff_layout *l, uint32_t row, uint32_t end)
{
    return is_plain(l) && !l->tiled && row % l->band_rows == 0 &&
           rows_of_band(l, row / l->band_rows) <= end - row;
}

cw_status cwi_tiff_rows(cwi_tiff_file *f, uint32_t first, uint32_t count, unsigned char *to,
                        cw_error *err)
{
    const cwi_tiff_layout *l = &f->layout;
    const uint32_t from = is_flipped(l) ? l->rows - first - count : first, end = from + count;
    cw_status st = CW_OK;
    if (is_raw(l) && is_plain(l))
        return read_raw(f, 0, from, count, to, err);
    for (uint32_t row = from, n; st == CW_OK && row < end; row += n) {
        const unsigned char *stored;
        size_t plane;
        if (rows_fit(l, row, end)) {
            n = rows_of_band(l, row / l->band_rows);
            st = decode_strip(f, row / l->band_rows, to + (row - from) * l->row, n * l->row,
                              l->row, err);
            continue;
        }
        st = read_piece(f, row, end - row, &stored, &plane, &n, err);
        n = n < end - row ? n : end - row;
        for (uint32_t i = 0; st == CW_OK && i < n; i++, stored += l->stored_row) {
            const uint32_t at = row + i - from;
            st = put_row(l, stored, plane, to + (is_flipped(l) ? count - 1 - at : at) * l->row,
                         err);
        }
    }
    return st;
}
