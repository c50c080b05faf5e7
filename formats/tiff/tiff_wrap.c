/* Wraps libtiff behind plain C: opens files, and finds the layouts of pages. */
#define _GNU_SOURCE /* pread */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/tiff/tiff_file.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { MAX_SAMPLES = 4, AT_ONCE = 1 << 30 };

/* --- libtiff's access to the file --------------------------------------------------------- */

static tmsize_t on_read(thandle_t handle, void *to, tmsize_t size)
{
    cwi_tiff_file *f = handle;
    tmsize_t got = 0;
    while (got < size) {
        const ssize_t n = pread(f->fd, (char *)to + got, (size_t)(size - got), (off_t)f->at);
        if (n <= 0)
            break;
        got += n;
        f->at += (uint64_t)n;
    }
    return got;
}

static tmsize_t on_write(thandle_t handle, void *from, tmsize_t size)
{
    (void)handle, (void)from, (void)size;
    return -1;
}

static toff_t on_seek(thandle_t handle, toff_t to, int from)
{
    cwi_tiff_file *f = handle;
    f->at = to + (from == SEEK_CUR ? f->at : from == SEEK_END ? f->size : 0);
    return f->at;
}

static int on_close(thandle_t handle)
{
    (void)handle;
    return 0;
}

static toff_t on_size(thandle_t handle)
{
    return ((cwi_tiff_file *)handle)->size;
}

/* Keeps a complaint: the first error, else the first warning. */
CW_PRINTF(3, 0)
static int keep_complaint(cwi_tiff_file *f, int how, const char *format, va_list arguments)
{
    if (how > f->complained)
        vsnprintf(f->complaint, sizeof f->complaint, format, arguments);
    if (how > f->complained)
        f->complained = how;
    return 1; /* and no other handler is called */
}

CW_PRINTF(4, 0)
static int on_error(TIFF *tiff, void *user, const char *module, const char *format,
                    va_list arguments)
{
    (void)tiff, (void)module;
    return keep_complaint(user, 2, format, arguments);
}

/* Handles a warning. Files with an LZW form from before TIFF 6 are accepted. Where
 * 'StripByteCounts' are wrong, libtiff makes up others. */
CW_PRINTF(4, 0)
static int on_warning(TIFF *tiff, void *user, const char *module, const char *format,
                      va_list arguments)
{
    (void)tiff, (void)module;
    if (strstr(format, "Old-style LZW"))
        return 1;
    return keep_complaint(user, strstr(format, "field, ignoring and calculating") ? 2 : 1,
                          format, arguments);
}

static void close_file(cwi_tiff_file *f)
{
    if (f->tiff)
        TIFFClose(f->tiff);
    if (f->fd >= 0)
        close(f->fd);
    cwi_free(f->offsets);
    cwi_free(f->pages);
    cwi_free(f->pixels);
    cwi_free(f->tile);
    cwi_free(f->line);
    *f = (cwi_tiff_file){.fd = -1, .page = -1, .band = -1};
}

/* Opens the file: no mapping into memory (m), strips unchanged (c), no directory read yet
 * (h). */
static cw_status open_file(cwi_tiff_file *f, int fd, uint64_t size, cw_error *err)
{
    close_file(f);
    f->fd = fd;
    f->size = size;
    cw_status st = cwi_tiff_walk(f, err);
    if (st != CW_OK)
        return st;
    TIFFOpenOptions *options = TIFFOpenOptionsAlloc();
    f->pages = cwi_alloc_array(f->offset_count, sizeof *f->pages);
    if (!options || !f->pages) {
        TIFFOpenOptionsFree(options);
        return cwi_fail_memory(err);
    }
    TIFFOpenOptionsSetMaxSingleMemAlloc(options, AT_ONCE);
    TIFFOpenOptionsSetErrorHandlerExtR(options, on_error, f);
    TIFFOpenOptionsSetWarningHandlerExtR(options, on_warning, f);
    f->tiff = TIFFClientOpenExt("", "rmch", f, on_read, on_write, on_seek, on_close, on_size,
                                NULL, NULL, options);
    TIFFOpenOptionsFree(options);
    return f->tiff ? CW_OK
                   : cwi_fail(err, CW_ERR_FORMAT, "it cannot be opened: %s", f->complaint);
}

cw_status cwi_tiff_open_directory(cwi_tiff_file *f, uint32_t n, cw_error *err)
{
    f->page = f->band = -1;
    cwi_tiff_listen(f);
    const bool opened = TIFFSetSubDirectory(f->tiff, f->offsets[n]);
    f->guessed = opened && f->complained == 2;
    return opened ? CW_OK
                  : cwi_fail(err, CW_ERR_FORMAT, "directory %u cannot be read: %s", n + 1,
                             f->complaint);
}

/* --- layouts ------------------------------------------------------------------------------ */

static uint16_t short_of(TIFF *tiff, uint32_t tag, uint16_t otherwise)
{
    uint16_t value;
    return TIFFGetFieldDefaulted(tiff, tag, &value) == 1 ? value : otherwise;
}

static uint32_t long_of(TIFF *tiff, uint32_t tag, uint32_t otherwise)
{
    uint32_t value;
    return TIFFGetFieldDefaulted(tiff, tag, &value) == 1 ? value : otherwise;
}

static cw_status find_type(cwi_tiff_layout *l, cw_error *err)
{
    static const struct {
        uint16_t bits, format;
        cw_type type;
        cwi_stored stored;
    } types[] = {{1, SAMPLEFORMAT_UINT, CW_U8, 0},
                 {8, SAMPLEFORMAT_UINT, CW_U8, 0},
                 {16, SAMPLEFORMAT_UINT, CW_U16, 0},
                 {32, SAMPLEFORMAT_UINT, CW_U32, 0},
                 {64, SAMPLEFORMAT_UINT, CW_U32, CWI_STORED_U64},
                 {8, SAMPLEFORMAT_INT, CW_I8, 0},
                 {16, SAMPLEFORMAT_INT, CW_I16, 0},
                 {32, SAMPLEFORMAT_INT, CW_I32, 0},
                 {64, SAMPLEFORMAT_INT, CW_I32, CWI_STORED_I64},
                 {16, SAMPLEFORMAT_IEEEFP, CW_F32, CWI_STORED_F16},
                 {32, SAMPLEFORMAT_IEEEFP, CW_F32, 0},
                 {64, SAMPLEFORMAT_IEEEFP, CW_F64, 0}};
    static const char *const formats[] = {
        "no format",    "unsigned integers", "signed integers", "floats",
        "nothing said", "complex integers",  "complex floats"};
    const uint16_t format = l->format == SAMPLEFORMAT_VOID ? SAMPLEFORMAT_UINT : l->format;
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (types[i].bits == l->bits && types[i].format == format) {
            l->type = types[i].type;
            l->stored = types[i].stored;
            return CW_OK;
        }
    return cwi_fail(err, CW_ERR_FORMAT,
                    "'BitsPerSample' is %u and 'SampleFormat' %u (%s); what is read is 1 bit, "
                    "integers of 8, 16, 32 and 64, and floats of 16, 32 and 64",
                    l->bits, l->format, l->format < 7 ? formats[l->format] : "unknown");
}

/* Refuses JBIG: libjbig allocates as much memory as a stream states, and aborts where there is
 * none. */
static cw_status check_compression(const cwi_tiff_layout *l, cw_error *err)
{
    const uint16_t c = l->compression;
    const char *name = c == COMPRESSION_OJPEG      ? " (JPEG as of TIFF 6)"
                       : c == COMPRESSION_PIXARLOG ? " (PixarLog)"
                       : c == COMPRESSION_SGILOG   ? " (LogLuv)"
                       : c == COMPRESSION_SGILOG24 ? " (LogLuv)"
                       : c == COMPRESSION_JBIG     ? " (JBIG)"
                                                   : NULL;
    if (name || !TIFFIsCODECConfigured(c))
        return cwi_fail(err, CW_ERR_FORMAT, "'Compression' is %u%s, which is not read", c,
                        name ? name : "");
    if (l->low_bit_first && cwi_tiff_is_deflated(l))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'FillOrder' is 2 and 'Compression' %u (deflate), which is not read",
                        c);
    return CW_OK;
}

/* Finds the colours. libjpeg converts YCbCr to RGB; nothing else is converted. */
static cw_status find_colours(TIFF *tiff, cwi_tiff_layout *l, cw_error *err)
{
    static const struct {
        uint16_t value;
        const char *name;
    } refused[] = {{PHOTOMETRIC_SEPARATED, " (CMYK)"}, {PHOTOMETRIC_YCBCR, " (YCbCr)"},
                   {PHOTOMETRIC_CIELAB, " (CIELab)"},  {PHOTOMETRIC_ICCLAB, " (ICCLab)"},
                   {PHOTOMETRIC_ITULAB, " (ITULab)"},  {PHOTOMETRIC_CFA, " (a colour filter)"},
                   {PHOTOMETRIC_LOGL, " (LogL)"},      {PHOTOMETRIC_LOGLUV, " (LogLuv)"}};
    const char *name = "";
    const bool white_is_zero = l->photometric == PHOTOMETRIC_MINISWHITE;
    if (white_is_zero && (l->format == SAMPLEFORMAT_IEEEFP || l->stored))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'PhotometricInterpretation' is 0 (white is 0), and how to invert "
                        "floats or integers of 64 bits is not defined");
    l->turned = white_is_zero;
    if (l->photometric <= PHOTOMETRIC_PALETTE)
        return CW_OK;
    if (l->photometric == PHOTOMETRIC_YCBCR && l->compression == COMPRESSION_JPEG &&
        l->samples == 3 && l->planes == 1 &&
        TIFFSetField(tiff, TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB) == 1)
        return CW_OK;
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++)
        if (refused[i].value == l->photometric)
            name = refused[i].name;
    return cwi_fail(err, CW_ERR_FORMAT,
                    "'PhotometricInterpretation' is %u%s; read are grey, RGB, palettes and "
                    "YCbCr in JPEG",
                    l->photometric, name);
}

/* Finds strips and rows of tiles, and checks that libtiff's sizes of them agree with ours. */
static cw_status find_bands(TIFF *tiff, cwi_tiff_layout *l, cw_error *err)
{
    const uint64_t samples = l->planes > 1 ? 1 : l->samples;
    l->tiled = TIFFIsTiled(tiff) != 0;
    l->tile_width = l->tiled ? long_of(tiff, TIFFTAG_TILEWIDTH, 0) : l->columns;
    l->band_rows = long_of(tiff, l->tiled ? TIFFTAG_TILELENGTH : TIFFTAG_ROWSPERSTRIP, 0);
    if (l->band_rows > l->rows && !l->tiled)
        l->band_rows = l->rows;
    if (l->band_rows == 0 || l->tile_width == 0 || (l->tiled && l->tile_width % 8))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'TileWidth' %u and 'TileLength' %u are not valid sizes", l->tile_width,
                        l->band_rows);
    const uint64_t row = (l->tile_width * samples * l->bits + 7) / 8;
    const uint64_t theirs = l->tiled ? TIFFTileRowSize64(tiff) : TIFFScanlineSize64(tiff);
    if (theirs != row)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "a row of %u pixels takes %llu bytes; libtiff makes them %llu",
                        l->tile_width, (unsigned long long)row, (unsigned long long)theirs);
    l->bands = (l->rows - 1) / l->band_rows + 1;
    l->stored_row = (l->columns * samples * l->bits + 7) / 8;
    return CW_OK;
}

static cw_status check_sizes(TIFF *tiff, cwi_tiff_layout *l, cw_error *err)
{
    if (l->columns < 1 || l->columns > INT32_MAX || l->rows < 1 || l->rows > INT32_MAX)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'ImageWidth' %u and 'ImageLength' %u are not valid sizes", l->columns,
                        l->rows);
    if (l->samples < 1 || l->samples > MAX_SAMPLES)
        return cwi_fail(err, CW_ERR_FORMAT, "'SamplesPerPixel' is %u; 1 to %d are read",
                        l->samples, MAX_SAMPLES);
    if (long_of(tiff, TIFFTAG_IMAGEDEPTH, 1) != 1)
        return cwi_fail(err, CW_ERR_FORMAT, "'ImageDepth' is %u; only 1 is read",
                        long_of(tiff, TIFFTAG_IMAGEDEPTH, 1));
    if (l->orientation < ORIENTATION_TOPLEFT || l->orientation > ORIENTATION_BOTLEFT)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'Orientation' is %u; 1 to 4 are read, which do not swap rows and "
                        "columns",
                        l->orientation);
    return CW_OK;
}

/* Finds the layout of the open directory. */
cw_status cwi_tiff_find_layout(cwi_tiff_file *f, cw_error *err)
{
    TIFF *t = f->tiff;
    const bool fax = short_of(t, TIFFTAG_COMPRESSION, 1) >= COMPRESSION_CCITTRLE &&
                     short_of(t, TIFFTAG_COMPRESSION, 1) <= COMPRESSION_CCITTFAX4;
    cwi_tiff_layout *l = &f->layout;
    *l = (cwi_tiff_layout){
        .columns = long_of(t, TIFFTAG_IMAGEWIDTH, 0),
        .rows = long_of(t, TIFFTAG_IMAGELENGTH, 0),
        .samples = short_of(t, TIFFTAG_SAMPLESPERPIXEL, 1),
        .bits = short_of(t, TIFFTAG_BITSPERSAMPLE, 1),
        .format = short_of(t, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT),
        .compression = short_of(t, TIFFTAG_COMPRESSION, COMPRESSION_NONE),
        .photometric = short_of(t, TIFFTAG_PHOTOMETRIC,
                                fax ? PHOTOMETRIC_MINISWHITE : PHOTOMETRIC_MINISBLACK),
        .orientation = short_of(t, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT),
        .low_bit_first = short_of(t, TIFFTAG_FILLORDER, FILLORDER_MSB2LSB) == FILLORDER_LSB2MSB,
        .predictor = 1,
        .planes = 1};
    TIFFGetField(t, TIFFTAG_PREDICTOR, &l->predictor);
    if (short_of(t, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) == PLANARCONFIG_SEPARATE)
        l->planes = l->samples;
    cw_status st = check_sizes(t, l, err);
    if (st == CW_OK)
        st = find_type(l, err);
    if (st == CW_OK)
        st = check_compression(l, err);
    if (st == CW_OK)
        st = find_colours(t, l, err);
    if (st == CW_OK)
        st = find_bands(t, l, err);
    if (st != CW_OK)
        return st;
    l->row = (size_t)l->columns * l->samples * cw_type_size(l->type);
    return l->row <= CWI_PLANES_SHARED
               ? CW_OK
               : cwi_fail(err, CW_ERR_LIMIT, "a row takes %zu bytes; the most are %d", l->row,
                          CWI_PLANES_SHARED);
}

cw_status cwi_tiff_turn_to(cwi_tiff_file *f, uint32_t page, cw_error *err)
{
    if (f->page != page && (f->page < 0 || !f->behind)) {
        cw_status st =
            cwi_tiff_open_directory(f, f->pages[f->behind ? 0 : page].directory, err);
        if (st == CW_OK)
            st = cwi_tiff_find_layout(f, err);
        if (st != CW_OK)
            return st;
    }
    f->page = page;
    return CW_OK;
}

/* --- work --------------------------------------------------------------------------------- */

static cw_status copy_rows(cwi_tiff_file *f, const cwi_plane_request *q, void *shared,
                           cw_error *err)
{
    const cwi_tiff_layout *l = &f->layout;
    if (!f->tiff || q->plane >= f->page_count)
        return cwi_fail(err, CW_ERR_FORMAT, "there is no page %u", q->plane + 1);
    cw_status st = cwi_tiff_turn_to(f, q->plane, err);
    if (st != CW_OK)
        return st;
    if (q->first_row > l->rows || q->row_count > l->rows - q->first_row ||
        q->row_count > CWI_PLANES_SHARED / l->row)
        return cwi_fail(err, CW_ERR_FORMAT, "page %u has no rows %u to %u", q->plane + 1,
                        q->first_row, q->first_row + q->row_count);
    return cwi_tiff_rows(f, q->first_row, q->row_count, shared, err);
}

static cw_status work_on_request(void *state, int fd, const void *request, void *shared,
                                 cw_error *err)
{
    cwi_tiff_file *f = state;
    cwi_plane_request q;
    memcpy(&q, request, sizeof q);
    if (q.op == CWI_PLANE_PIXELS)
        return copy_rows(f, &q, shared, err);
    cw_status st = open_file(f, fd, q.file_bytes, err);
    return st == CW_OK ? cwi_tiff_take_facts(f, q.image, shared, err) : st;
}

static void *state_new(void)
{
    cwi_tiff_file *f = cwi_alloc_zeroed(1, sizeof *f);
    if (f)
        *f = (cwi_tiff_file){.fd = -1, .page = -1, .band = -1};
    return f;
}

static void state_free(void *state)
{
    close_file(state);
    cwi_free(state);
}

const cwi_plane_functions cwi_module_tiff = {state_new, state_free, NULL, work_on_request};
