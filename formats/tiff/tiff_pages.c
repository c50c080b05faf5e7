/* Finds the pages of a TIFF file, and collects the facts of those that make up its image. */
#include "core/base/status.h"
#include "core/base/text.h"
#include "formats/tiff/tiff_file.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { GDAL_NODATA = 42113 };

void cwi_tiff_note(cwi_tiff_facts *facts, const char *format, ...)
{
    const size_t used = strlen(facts->note);
    const size_t start = used && used + 3 < sizeof facts->note ? used + 2 : used;
    va_list arguments;
    if (start > used)
        memcpy(facts->note + used, "; ", 2);
    va_start(arguments, format);
    vsnprintf(facts->note + start, sizeof facts->note - start, format, arguments);
    va_end(arguments);
}

static size_t strile_bytes(const cwi_tiff_file *f, const cwi_tiff_layout *l, uint32_t n)
{
    const uint32_t band = n % l->bands, left = l->rows - band * l->band_rows;
    if (l->tiled)
        return (size_t)TIFFTileSize64(f->tiff);
    return (left < l->band_rows ? left : l->band_rows) * l->stored_row;
}

/* Checks that all strips and tiles lie in the file, and that uncompressed ones are long
 * enough. */
static cw_status check_striles(const cwi_tiff_file *f, uint32_t page, cw_error *err)
{
    const cwi_tiff_layout *l = &f->layout;
    const char *what = l->tiled ? "tile" : "strip";
    const uint32_t across = (l->columns - 1) / l->tile_width + 1;
    const uint32_t count = l->tiled ? TIFFNumberOfTiles(f->tiff) : TIFFNumberOfStrips(f->tiff);
    if (count != (uint64_t)l->bands * across * l->planes)
        return cwi_fail(err, CW_ERR_FORMAT, "page %u has %u %ss, which are not all of it", page,
                        count, what);
    if (f->guessed)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'StripByteCounts' of page %u are too few for its pixels, or more than "
                        "the file has",
                        page);
    for (uint32_t n = 0; n < count; n++) {
        int bad[2] = {0, 0};
        const uint64_t at = TIFFGetStrileOffsetWithErr(f->tiff, n, &bad[0]);
        const uint64_t bytes = TIFFGetStrileByteCountWithErr(f->tiff, n, &bad[1]);
        if (bad[0] || bad[1] || at == 0 || bytes == 0 || at > f->size || bytes > f->size - at)
            return cwi_fail(err, CW_ERR_FORMAT,
                            "%s %u of page %u has %llu bytes at %llu; the file has %llu bytes",
                            what, n + 1, page, (unsigned long long)bytes,
                            (unsigned long long)at, (unsigned long long)f->size);
        if (l->compression == COMPRESSION_NONE && bytes < strile_bytes(f, l, n))
            return cwi_fail(err, CW_ERR_FORMAT, "%s %u of page %u has %llu bytes; it needs %zu",
                            what, n + 1, page, (unsigned long long)bytes,
                            strile_bytes(f, l, n));
    }
    return CW_OK;
}

/* Returns true for a page, not for a thumbnail or a mask. */
static bool is_page(const cwi_tiff_file *f, uint32_t directory)
{
    uint32_t kind;
    uint16_t photometric;
    if (TIFFGetField(f->tiff, TIFFTAG_SUBFILETYPE, &kind) != 1)
        kind = cwi_tiff_short(f, directory, TIFFTAG_OSUBFILETYPE) == OFILETYPE_REDUCEDIMAGE
                   ? FILETYPE_REDUCEDIMAGE
                   : 0;
    return !(kind & (FILETYPE_REDUCEDIMAGE | FILETYPE_MASK)) &&
           (TIFFGetFieldDefaulted(f->tiff, TIFFTAG_PHOTOMETRIC, &photometric) != 1 ||
            photometric != PHOTOMETRIC_MASK);
}

static cw_status check_alike(const cwi_tiff_page *a, const cwi_tiff_page *b, uint32_t page,
                             cw_error *err)
{
    if (a->columns == b->columns && a->rows == b->rows && a->samples == b->samples &&
        a->type == b->type && a->bits == b->bits)
        return CW_OK;
    return cwi_fail(err, CW_ERR_FORMAT,
                    "page %u is %u x %u, %u x %u bits (%s); the first is %u x %u, %u x %u bits "
                    "(%s)",
                    page, b->columns, b->rows, b->samples, b->bits, cw_type_name(b->type),
                    a->columns, a->rows, a->samples, a->bits, cw_type_name(a->type));
}

/* Checks the page of the open directory, and finds its layout. */
static cw_status check_page(cwi_tiff_file *f, uint32_t number, cw_error *err)
{
    cw_status st = cwi_tiff_find_layout(f, err);
    return st == CW_OK ? check_striles(f, number, err) : st;
}

/* Walks through all directories. A page that cannot be read is kept: another image may have it. */
static cw_status find_pages(cwi_tiff_file *f, cwi_tiff_layout *first, cw_error *err)
{
    cw_status st = CW_OK;
    for (uint32_t n = 0; st == CW_OK && n < f->offset_count; n++) {
        st = cwi_tiff_open_directory(f, n, err);
        if (st != CW_OK || !is_page(f, n))
            continue;
        const bool is_first = f->page_count == 0;
        const bool good = check_page(f, f->page_count + 1, is_first ? err : NULL) == CW_OK;
        const cwi_tiff_layout *l = &f->layout;
        if (is_first && !good)
            return CW_ERR_FORMAT;
        if (is_first)
            *first = *l;
        f->pages[f->page_count++] =
            (cwi_tiff_page){.directory = n,
                            .columns = l->columns,
                            .rows = l->rows,
                            .samples = l->samples,
                            .bits = l->bits,
                            .type = l->type,
                            .good = good,
                            .compressed = l->compression != COMPRESSION_NONE,
                            .turned = l->turned};
    }
    if (st == CW_OK && f->page_count == 0)
        return cwi_fail(err, CW_ERR_FORMAT, "no page has full resolution");
    return st;
}

/* Checks the pages of the image: all have the layout of the first one. */
static cw_status check_pages(cwi_tiff_file *f, cwi_tiff_facts *facts, const uint32_t *order,
                             cw_error *err)
{
    const size_t count = (size_t)facts->slices * facts->channels * facts->steps;
    cw_status st = CW_OK;
    for (size_t i = 0; st == CW_OK && i < count; i++) {
        const uint32_t number = f->behind ? 0 : order[i];
        const cwi_tiff_page *page = &f->pages[number];
        if (!page->good) {
            st = cwi_tiff_open_directory(f, page->directory, err);
            st = st == CW_OK ? check_page(f, number + 1, err) : st;
            return st == CW_OK
                       ? cwi_fail(err, CW_ERR_FORMAT, "page %u cannot be read", number + 1)
                       : st;
        }
        st = check_alike(&f->pages[f->behind ? 0 : order[0]], page, number + 1, err);
        facts->compressed |= page->compressed;
        facts->turned |= page->turned;
    }
    return st;
}

/* Reads the value of no data, as GDAL states it. One that no pixel can have is left out. */
static void find_nodata(const cwi_tiff_file *f, cwi_tiff_facts *facts)
{
    static const struct {
        double low, high;
    } ranges[CW_TYPE_COUNT] = {
        [CW_U8] = {0, UINT8_MAX},   [CW_I8] = {INT8_MIN, INT8_MAX},
        [CW_U16] = {0, UINT16_MAX}, [CW_I16] = {INT16_MIN, INT16_MAX},
        [CW_U32] = {0, UINT32_MAX}, [CW_I32] = {INT32_MIN, INT32_MAX},
    };
    char text[64];
    const char *at = text;
    double value;
    if (!cwi_tiff_text(f, GDAL_NODATA, text, sizeof text) || !cwi_parse_double(&at, &value) ||
        !isfinite(value))
        return;
    const double low = ranges[facts->type].low, high = ranges[facts->type].high;
    const bool is_real = facts->type == CW_F32 || facts->type == CW_F64;
    if (facts->type == CW_F32)
        value = (double)(float)value;
    if (!is_real && !(value >= low && value <= high && value == floor(value)))
        return;
    facts->has_nodata = 1;
    facts->nodata = facts->turned && !is_real ? low + high - value : value;
}

cw_status cwi_tiff_take_facts(cwi_tiff_file *f, uint32_t image, cwi_tiff_facts *facts,
                              cw_error *err)
{
    cwi_tiff_layout first;
    const char *description = NULL;
    uint32_t *order = (uint32_t *)(facts + 1);
    *facts = (cwi_tiff_facts){.slope = 1};
    cw_status st = find_pages(f, &first, err);
    if (st == CW_OK)
        st = cwi_tiff_open_directory(f, 0, err);
    if (st != CW_OK)
        return st;
    if (TIFFGetField(f->tiff, TIFFTAG_IMAGEDESCRIPTION, &description) != 1)
        description = "";
    facts->columns = first.columns;
    facts->rows = first.rows;
    facts->samples = first.samples;
    f->layout = first;
    st = cwi_tiff_describe(f, description, image, facts, order, err);
    facts->page_count = f->page_count;
    if (st == CW_OK)
        st = check_pages(f, facts, order, err);
    if (st != CW_OK)
        return st;
    const cwi_tiff_page *page = &f->pages[f->behind ? 0 : order[0]];
    facts->columns = page->columns;
    facts->rows = page->rows;
    facts->samples = page->samples;
    facts->bits = page->bits;
    facts->type = page->type;
    find_nodata(f, facts);
    return CW_OK;
}
