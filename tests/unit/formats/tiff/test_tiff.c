#include "core/base/module.h"
#include "support/files/reading.h"
#include "support/files/regions.h"
#include "support/files/tiffs.h"

#include <stdio.h>
#include <sys/stat.h>
#if CW_TEST_LIBTIFF
#include <tiffio.h>
#endif

/* --- helpers ------------------------------------------------------------------------------ */

static char notes[1024];

static void take_note(void *user, const char *text)
{
    (void)user;
    strncat(notes, text, sizeof notes - strlen(notes) - 2);
    strcat(notes, "\n");
}

static cw_status read_with(const char *name, cw_read_desc desc, cw_volume *v, cw_error *err)
{
    notes[0] = '\0';
    desc.note = take_note;
    return cw_volume_read(test_path(name), &desc, v, NULL, err);
}

static void read_good(const char *name, cw_volume *v)
{
    cw_error err = {0};
    assert_ok(read_with(name, (cw_read_desc){0}, v, &err), err);
}

static void save(test_tiff *t, const char *name)
{
    test_tiff_save(t, test_path(name));
}

static double value_at(const cw_volume *v, const size_t at[3], size_t component, size_t step)
{
    cw_volume one;
    cw_error err = {0};
    assert_ok(cw_volume_select(v, component, step, &one, &err), err);
    return cw_volume_value(&one, at[0], at[1], at[2]);
}

/* A page of bytes that count up from a number on. */
enum { COLUMNS = 4, ROWS = 3, PIXELS = COLUMNS * ROWS };

static void add_bytes(test_tiff *t, test_page page, unsigned char first)
{
    unsigned char pixels[PIXELS];
    for (size_t i = 0; i < PIXELS; i++)
        pixels[i] = (unsigned char)(first + i);
    page.columns = COLUMNS;
    page.rows = ROWS;
    page.pixels = pixels;
    test_tiff_add(t, &page);
}

/* One file of one page. */
static void save_slice(const char *name, unsigned char first)
{
    test_tiff t = {0};
    add_bytes(&t, (test_page){0}, first);
    save(&t, name);
}

/* --- every way to store pixels ------------------------------------------------------------ */

static const struct {
    uint16_t bits, format;
    cw_type type;
} kinds[] = {{1, 1, CW_U8},   {8, 1, CW_U8},   {16, 1, CW_U16}, {32, 1, CW_U32}, {8, 2, CW_I8},
             {16, 2, CW_I16}, {32, 2, CW_I32}, {32, 3, CW_F32}, {64, 3, CW_F64}};
enum { KINDS = sizeof kinds / sizeof *kinds, WIDE = 37, HIGH = 21, PAGES = 3, SAMPLES = 4 };

/* A number that a pixel of the kind may have: it fills all its bytes. */
static double number_of(size_t kind, size_t index)
{
    const uint32_t mixed = (uint32_t)index * 2654435761u;
    switch (kinds[kind].type) {
    case CW_I8:
        return (int8_t)(mixed >> 24);
    case CW_U16:
        return mixed >> 16;
    case CW_I16:
        return (int16_t)(mixed >> 16);
    case CW_U32:
        return mixed;
    case CW_I32:
        return (int32_t)mixed;
    case CW_F32:
        return (float)mixed / 7;
    case CW_F64:
        return (double)mixed / 7;
    default:
        return kinds[kind].bits == 1 ? mixed >> 31 : mixed >> 24;
    }
}

static void put_value(void *to, cw_type type, size_t index, double value)
{
#define CASE(name, ctype, text)                                                                \
    if (type == name)                                                                          \
        ((ctype *)to)[index] = (ctype)value;
    CW_TYPE_TABLE(CASE)
#undef CASE
}

/* The pages of a stack, one behind another. */
static void *make_pixels(size_t kind, size_t samples)
{
    const size_t count = (size_t)WIDE * HIGH * samples * PAGES;
    void *pixels = malloc(count * 8);
    assert_non_null(pixels);
    for (size_t i = 0; i < count; i++)
        put_value(pixels, kinds[kind].type, i, number_of(kind, i));
    return pixels;
}

static void check_pixels(const cw_volume *v, size_t kind, size_t samples)
{
    assert_int_equal(v->type, kinds[kind].type);
    assert_int_equal(v->dim[0], WIDE);
    assert_int_equal(v->dim[1], HIGH);
    assert_int_equal(v->dim[2], PAGES);
    assert_int_equal(v->components, samples);
    for (size_t c = 0; c < samples; c++) {
        cw_volume one;
        cw_error err = {0};
        assert_ok(cw_volume_select(v, c, 0, &one, &err), err);
        for (size_t i = 0; i < (size_t)WIDE * HIGH * PAGES; i++) {
            const double got =
                cw_volume_value(&one, i % WIDE, i / WIDE % HIGH, i / WIDE / HIGH);
            const double wanted = (float)number_of(kind, i * samples + c);
            if ((float)got != (float)wanted)
                fail_msg("voxel %zu of component %zu is %g, not %g", i, c, got, wanted);
        }
    }
}

static const struct {
    uint32_t rows_per_strip, tile_width;
} layouts[] = {{0, 0}, {1, 0}, {5, 0}, {16, 16}, {16, 48}};
enum { LAYOUTS = sizeof layouts / sizeof *layouts };

static void check_stored(size_t kind, size_t layout, uint16_t samples, bool separate,
                         bool high_first, bool big)
{
    test_tiff t = {.high_first = high_first, .big = big};
    char *pixels = make_pixels(kind, samples);
    cw_volume v;
    cw_error err = {0};
    for (size_t p = 0; p < PAGES; p++)
        test_tiff_add(&t, &(test_page){.columns = WIDE,
                                       .rows = HIGH,
                                       .samples = samples,
                                       .bits = kinds[kind].bits,
                                       .format = kinds[kind].format,
                                       .separate = separate,
                                       .photometric = samples > 2 ? 2 : 1,
                                       .rows_per_strip = layouts[layout].rows_per_strip,
                                       .tile_width = layouts[layout].tile_width,
                                       .pixels = pixels + p * WIDE * HIGH * samples *
                                                              cw_type_size(kinds[kind].type)});
    save(&t, "a.tif");
    assert_ok(read_with("a.tif", (cw_read_desc){.no_sandbox = big}, &v, &err), err);
    assert_int_equal(v.known, 0);
    check_affine(&v, (const double[12]){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0});
    check_pixels(&v, kind, samples);
    cw_volume_free(&v);
    free(pixels);
}

static void types_byte_orders_and_layouts_give_the_same_numbers(void **state)
{
    (void)state;
    for (size_t kind = 0; kind < KINDS; kind++)
        for (size_t layout = 0; layout < LAYOUTS; layout++)
            for (int way = 0; way < 4; way++)
                check_stored(kind, layout, 1, false, way & 1, way & 2);
}

static void samples_are_components_stored_together_or_apart(void **state)
{
    (void)state;
    for (size_t kind = 0; kind < KINDS; kind += 2)
        for (size_t layout = 0; layout < LAYOUTS; layout++)
            for (uint16_t samples = 2; samples <= SAMPLES; samples++)
                for (int way = 0; way < 2; way++)
                    check_stored(kind, layout, samples, way, layout % 2, way);
}

static void bits_may_come_the_low_one_first(void **state)
{
    (void)state;
    for (size_t kind = 0; kind < 4; kind++)
        for (size_t layout = 0; layout < LAYOUTS; layout++) {
            test_tiff t = {.high_first = true};
            char *pixels = make_pixels(kind, 1);
            cw_volume v;
            for (size_t p = 0; p < PAGES; p++)
                test_tiff_add(
                    &t, &(test_page){.columns = WIDE,
                                     .rows = HIGH,
                                     .bits = kinds[kind].bits,
                                     .low_bit_first = true,
                                     .rows_per_strip = layouts[layout].rows_per_strip,
                                     .tile_width = layouts[layout].tile_width,
                                     .pixels = pixels + p * WIDE * HIGH *
                                                            cw_type_size(kinds[kind].type)});
            save(&t, "a.tif");
            read_good("a.tif", &v);
            check_pixels(&v, kind, 1);
            cw_volume_free(&v);
            free(pixels);
        }
}

/* Where white is 0, values are turned round: more is brighter. */
static void white_is_never_0(void **state)
{
    (void)state;
    static const double ends[KINDS] = {1, 255, 65535, 4294967295.0, -1, -1, -1};
    for (size_t kind = 0; kind < 7; kind++) {
        test_tiff t = {0};
        char *pixels = make_pixels(kind, 2);
        cw_volume v;
        test_tiff_add(&t, &(test_page){.columns = WIDE,
                                       .rows = HIGH,
                                       .samples = 2,
                                       .bits = kinds[kind].bits,
                                       .format = kinds[kind].format,
                                       .photometric = 100,
                                       .pixels = pixels});
        save(&t, "a.tif");
        read_good("a.tif", &v);
        assert_non_null(strstr(notes, "inverted, so that larger is brighter"));
        for (size_t i = 0; i < (size_t)WIDE * HIGH; i++) {
            const size_t at[3] = {i % WIDE, i / WIDE, 0};
            assert_true(value_at(&v, at, 0, 0) == ends[kind] - number_of(kind, 2 * i));
            assert_true(value_at(&v, at, 1, 0) == number_of(kind, 2 * i + 1));
        }
        cw_volume_free(&v);
        free(pixels);
    }
}

static void rows_and_columns_may_run_backwards(void **state)
{
    (void)state;
    for (uint16_t orientation = 1; orientation <= 4; orientation++)
        for (int way = 0; way < 4; way++) {
            test_tiff t = {0};
            cw_volume v;
            add_bytes(&t,
                      (test_page){.orientation = orientation,
                                  .rows_per_strip = way & 1   ? 16
                                                    : way & 2 ? 2
                                                              : 0,
                                  .tile_width = way & 1 ? 16 : 0},
                      1);
            save(&t, "a.tif");
            read_good("a.tif", &v);
            for (size_t i = 0; i < PIXELS; i++) {
                size_t x = i % COLUMNS, y = i / COLUMNS;
                x = orientation == 2 || orientation == 3 ? COLUMNS - 1 - x : x;
                y = orientation >= 3 ? ROWS - 1 - y : y;
                assert_true(cw_volume_value(&v, x, y, 0) == 1 + (double)i);
            }
            cw_volume_free(&v);
        }
}

static void palettes_are_read_as_indices(void **state)
{
    (void)state;
    static const uint16_t map[768];
    test_tiff t = {0};
    cw_volume v;
    add_bytes(&t, (test_page){.photometric = 3, .tags = {{320, 3, 768, map}}}, 7);
    save(&t, "a.tif");
    read_good("a.tif", &v);
    assert_true(cw_volume_value(&v, 1, 0, 0) == 8);
    cw_volume_free(&v);
}

/* --- what libtiff compresses -------------------------------------------------------------- */

#if CW_TEST_LIBTIFF
static const struct {
    uint16_t compression, predictor;
    size_t kind;
    const char *mode;
} packed[] = {
    {COMPRESSION_LZW, 1, 1, "w"},           {COMPRESSION_LZW, 2, 2, "wb"},
    {COMPRESSION_LZW, 3, 7, "w8"},          {COMPRESSION_ADOBE_DEFLATE, 1, 4, "w"},
    {COMPRESSION_ADOBE_DEFLATE, 2, 5, "w"}, {COMPRESSION_ADOBE_DEFLATE, 3, 8, "w"},
    {COMPRESSION_DEFLATE, 2, 6, "wb8"},     {COMPRESSION_PACKBITS, 1, 3, "w"},
    {COMPRESSION_LZMA, 1, 2, "w"},          {COMPRESSION_ZSTD, 2, 5, "w"},
    {COMPRESSION_ZSTD, 3, 7, "w"},          {COMPRESSION_LERC, 1, 7, "w"},
    {COMPRESSION_CCITTRLE, 1, 0, "w"},      {COMPRESSION_CCITTFAX3, 1, 0, "w"},
    {COMPRESSION_CCITTFAX4, 1, 0, "wb"},    {COMPRESSION_LZW, 1, 0, "w"},
    {COMPRESSION_ADOBE_DEFLATE, 1, 0, "w"},
};

/* Pixels as libtiff takes them: rows of bits are packed. */
static void write_rows(TIFF *tiff, size_t kind, const char *pixels, uint16_t samples)
{
    const size_t size = cw_type_size(kinds[kind].type), row = (size_t)WIDE * samples;
    unsigned char line[WIDE * SAMPLES * 8];
    for (uint32_t y = 0; y < HIGH; y++) {
        memcpy(line, pixels + y * row * size, row * size);
        if (kinds[kind].bits == 1) {
            memset(line, 0, sizeof line);
            for (size_t i = 0; i < row; i++)
                line[i / 8] |= (unsigned char)(pixels[y * row + i] << (7 - i % 8));
        }
        assert_int_equal(TIFFWriteScanline(tiff, line, y, 0), 1);
    }
}

static void write_tiles(TIFF *tiff, size_t kind, const char *pixels)
{
    const size_t size = cw_type_size(kinds[kind].type);
    char tile[16 * 16 * 8];
    for (uint32_t y = 0; y < HIGH; y += 16)
        for (uint32_t x = 0; x < WIDE; x += 16) {
            memset(tile, 0, sizeof tile);
            for (uint32_t r = 0; r < 16 && y + r < HIGH; r++)
                memcpy(tile + r * 16 * size, pixels + ((y + r) * WIDE + x) * size,
                       (WIDE - x < 16 ? WIDE - x : 16) * size);
            assert_true(TIFFWriteTile(tiff, tile, x, y, 0, 0) > 0);
        }
}

static TIFF *open_tiff(const char *name, const char *mode)
{
    TIFFSetWarningHandler(NULL);
    TIFF *tiff = TIFFOpen(test_path(name), mode);
    assert_non_null(tiff);
    return tiff;
}

static void set_fields(TIFF *tiff, size_t kind, uint16_t samples, uint16_t compression,
                       uint16_t predictor)
{
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, WIDE);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, HIGH);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, samples);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, kinds[kind].bits);
    TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, kinds[kind].format);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC,
                 samples > 2 ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, compression);
    if (predictor > 1)
        TIFFSetField(tiff, TIFFTAG_PREDICTOR, predictor);
}

static void write_packed(const char *name, size_t n, bool tiled)
{
    const size_t kind = packed[n].kind;
    TIFF *tiff = open_tiff(name, packed[n].mode);
    char *pixels = make_pixels(kind, 1);
    for (size_t p = 0; p < PAGES; p++) {
        const char *page = pixels + p * WIDE * HIGH * cw_type_size(kinds[kind].type);
        set_fields(tiff, kind, 1, packed[n].compression, packed[n].predictor);
        if (tiled) {
            TIFFSetField(tiff, TIFFTAG_TILEWIDTH, 16);
            TIFFSetField(tiff, TIFFTAG_TILELENGTH, 16);
            write_tiles(tiff, kind, page);
        } else {
            TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 8);
            write_rows(tiff, kind, page, 1);
        }
        assert_int_equal(TIFFWriteDirectory(tiff), 1);
    }
    TIFFClose(tiff);
    free(pixels);
}

static void compressed_pixels_are_what_was_compressed(void **state)
{
    (void)state;
    for (size_t n = 0; n < sizeof packed / sizeof *packed; n++)
        for (int tiled = 0; tiled <= (kinds[packed[n].kind].bits > 1); tiled++) {
            cw_volume v;
            if (!TIFFIsCODECConfigured(packed[n].compression))
                continue;
            write_packed("a.tif", n, tiled);
            read_good("a.tif", &v);
            check_pixels(&v, packed[n].kind, 1);
            cw_volume_free(&v);
        }
}

/* A decoder that runs out of data, or into nonsense, must not be believed. */
static void damaged_pixels_are_no_voxels(void **state)
{
    (void)state;
    for (size_t n = 0; n < sizeof packed / sizeof *packed; n++) {
        cw_volume v;
        cw_error err = {0};
        size_t size;
        if (!TIFFIsCODECConfigured(packed[n].compression))
            continue;
        write_packed("a.tif", n, false);
        char *bytes = test_file_read(test_path("a.tif"), &size);
        TIFF *tiff = open_tiff("a.tif", "r");
        const size_t at = TIFFGetStrileOffset(tiff, 1), have = TIFFGetStrileByteCount(tiff, 1);
        TIFFClose(tiff);
        memset(bytes + at + have / 4, 0, have - have / 4);
        test_file_write(test_path("a.tif"), bytes, size);
        const cw_status st = read_with("a.tif", (cw_read_desc){0}, &v, &err);
        if (packed[n].compression == COMPRESSION_PACKBITS) /* zeros are good packed bits */
            assert_true(st == CW_OK || st == CW_ERR_FORMAT);
        else if (st != CW_ERR_FORMAT || !strstr(err.message, "the pixels of page 1 cannot"))
            print_message("%zu compression %u: status %d, %s\n", n, packed[n].compression,
                          (int)st, st == CW_OK ? "it was read" : err.message);
        cw_volume_free(&v);
        free(bytes);
    }
}

/* The bytes of predicted floats are sorted from the highest to the lowest in either order, but
 * libtiff's writer gets that wrong in one: so its strips of the other are taken. */
static void floats_are_predicted_alike_in_either_order(void **state)
{
    (void)state;
    for (size_t n = 0; n < sizeof packed / sizeof *packed; n++) {
        unsigned char strip[65536];
        cw_volume v;
        if (packed[n].predictor != 3)
            continue;
        write_packed("a.tif", n, false);
        TIFF *from = open_tiff("a.tif", "r"), *to = open_tiff("b.tif", "wb");
        for (size_t p = 0; p < PAGES; p++) {
            TIFFSetDirectory(from, (tdir_t)p);
            set_fields(to, packed[n].kind, 1, packed[n].compression, 3);
            TIFFSetField(to, TIFFTAG_ROWSPERSTRIP, 8);
            for (uint32_t i = 0; i < TIFFNumberOfStrips(from); i++) {
                const tmsize_t size = TIFFReadRawStrip(from, i, strip, sizeof strip);
                assert_true(TIFFWriteRawStrip(to, i, strip, size) == size);
            }
            assert_int_equal(TIFFWriteDirectory(to), 1);
        }
        TIFFClose(from);
        TIFFClose(to);
        read_good("b.tif", &v);
        check_pixels(&v, packed[n].kind, 1);
        cw_volume_free(&v);
    }
}

/* One strip of 72 MB: it crosses from the other process in two goes, and is inflated once. */
static void planes_may_be_larger_than_what_crosses_at_once(void **state)
{
    (void)state;
    enum { EDGE = 9000, TALL = 8000 };
    for (int way = 0; way < 2; way++) {
        TIFF *tiff = open_tiff("a.tif", "w");
        unsigned char *line = calloc(EDGE, 1);
        cw_volume v;
        set_fields(tiff, 1, 1, way ? COMPRESSION_ADOBE_DEFLATE : COMPRESSION_NONE, 1);
        TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, EDGE);
        TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, TALL);
        TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, TALL);
        for (uint32_t y = 0; y < TALL; y++) {
            line[0] = (unsigned char)(y / 32);
            line[EDGE - 1] = (unsigned char)y;
            assert_int_equal(TIFFWriteScanline(tiff, line, y, 0), 1);
        }
        TIFFClose(tiff);
        free(line);
        read_good("a.tif", &v);
        for (size_t y = 0; y < TALL; y++) {
            assert_true(cw_volume_value(&v, 0, y, 0) == (double)(unsigned char)(y / 32));
            assert_true(cw_volume_value(&v, EDGE - 1, y, 0) == (double)(unsigned char)y);
        }
        cw_volume_free(&v);
    }
}

/* A checksum tells what inflates all the same. */
static void a_wrong_checksum_is_damage(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    size_t size;
    TIFF *tiff = open_tiff("a.tif", "w");
    char *pixels = make_pixels(1, 1);
    set_fields(tiff, 1, 1, COMPRESSION_ADOBE_DEFLATE, 1);
    write_rows(tiff, 1, pixels, 1);
    TIFFClose(tiff);
    free(pixels);
    char *bytes = test_file_read(test_path("a.tif"), &size);
    tiff = open_tiff("a.tif", "r");
    bytes[TIFFGetStrileOffset(tiff, 0) + TIFFGetStrileByteCount(tiff, 0) - 1] ^= 1;
    TIFFClose(tiff);
    test_file_write(test_path("a.tif"), bytes, size);
    free(bytes);
    assert_fails(read_with("a.tif", (cw_read_desc){0}, &v, &err), CW_ERR_FORMAT,
                 "the pixels of page 1 cannot be read: the compressed data are damaged after",
                 err);
}

/* Lossy, so nearly: a slope of colours. */
static void jpeg_in_ycbcr_arrives_as_rgb(void **state)
{
    (void)state;
    for (int ycbcr = 0; ycbcr < 2; ycbcr++) {
        enum { EDGE = 64 };
        unsigned char line[EDGE * 3];
        TIFF *tiff = open_tiff("a.tif", "w");
        cw_volume v;
        set_fields(tiff, 1, 3, COMPRESSION_JPEG, 1);
        TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, EDGE);
        TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, EDGE);
        TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 16);
        if (ycbcr) {
            TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_YCBCR);
            TIFFSetField(tiff, TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB);
        }
        for (uint32_t y = 0; y < EDGE; y++) {
            for (uint32_t x = 0; x < EDGE; x++) {
                line[3 * x] = (unsigned char)(4 * x);
                line[3 * x + 1] = (unsigned char)(4 * y);
                line[3 * x + 2] = 50;
            }
            assert_int_equal(TIFFWriteScanline(tiff, line, y, 0), 1);
        }
        TIFFClose(tiff);
        read_good("a.tif", &v);
        assert_int_equal(v.components, 3);
        for (size_t i = 0; i < 36; i++) {
            const size_t at[3] = {2 + 10 * (i % 6), 2 + 10 * (i / 6), 0};
            assert_near(value_at(&v, at, 0, 0), 4 * (double)at[0], 12);
            assert_near(value_at(&v, at, 1, 0), 4 * (double)at[1], 12);
            assert_near(value_at(&v, at, 2, 0), 50, 12);
        }
        cw_volume_free(&v);
    }
}

static void webp_without_loss_is_what_was_compressed(void **state)
{
    (void)state;
    if (!TIFFIsCODECConfigured(COMPRESSION_WEBP))
        skip();
    for (uint16_t samples = 3; samples <= 4; samples++) {
        TIFF *tiff = open_tiff("a.tif", "w");
        unsigned char pixels[WIDE * HIGH * SAMPLES];
        cw_volume v;
        for (size_t i = 0; i < sizeof pixels; i++)
            pixels[i] = i % samples == 3 ? 255 : (unsigned char)number_of(1, i);
        set_fields(tiff, 1, samples, COMPRESSION_WEBP, 1);
        TIFFSetField(tiff, TIFFTAG_WEBP_LOSSLESS, 1);
        write_rows(tiff, 1, (const char *)pixels, samples);
        TIFFClose(tiff);
        read_good("a.tif", &v);
        for (size_t i = 0; i < (size_t)WIDE * HIGH * samples; i++) {
            const size_t p = i / samples, at[3] = {p % WIDE, p / WIDE, 0};
            assert_true(value_at(&v, at, i % samples, 0) == pixels[i]);
        }
        cw_volume_free(&v);
    }
}

static void a_cut_of_compressed_pages_is_never_a_volume(void **state)
{
    (void)state;
    write_packed("a.tif", 0, true);
    size_t size;
    char *bytes = test_file_read(test_path("a.tif"), &size);
    for (size_t cut = 1; cut < size; cut += 13) {
        cw_volume v;
        cw_error err = {0};
        const cw_read_desc desc = {.no_sandbox = cut / 13 % 16 != 0};
        test_file_write(test_path("a.tif"), bytes, cut);
        assert_fails(read_with("a.tif", desc, &v, &err), CW_ERR_FORMAT, "", err);
    }
    free(bytes);
}
#endif

/* --- pages -------------------------------------------------------------------------------- */

static void thumbnails_and_masks_are_no_slices(void **state)
{
    (void)state;
    test_tiff t = {0};
    cw_volume v;
    const unsigned char small[1] = {99};
    const uint16_t old_kind = 2;
    const test_page thumbnail = {.columns = 1, .rows = 1, .kind = 1, .pixels = small};
    test_tiff_add(&t, &thumbnail);
    add_bytes(&t, (test_page){0}, 10);
    add_bytes(&t, (test_page){.kind = 4}, 20);
    add_bytes(&t, (test_page){.kind = 2}, 30);
    add_bytes(&t, (test_page){.tags = {{255, 3, 1, &old_kind}}}, 40);
    save(&t, "a.tif");
    read_good("a.tif", &v);
    assert_int_equal(v.dim[2], 2);
    assert_true(cw_volume_value(&v, 0, 0, 0) == 10);
    assert_true(cw_volume_value(&v, 0, 0, 1) == 30);
    cw_volume_free(&v);
    test_tiff_add(&t, &thumbnail);
    save(&t, "a.tif");
    check_told("a.tif", 0, "no page has full resolution");
}

static void pages_that_differ_are_named(void **state)
{
    (void)state;
    static const char pixels[64];
    const struct {
        test_page page;
        const char *words;
    } cases[] = {
        {{.columns = 5, .rows = 3}, "page 2 is 5 x 3, 1 x 8 bits (u8); the first is 4 x 3"},
        {{.columns = 4, .rows = 2}, "page 2 is 4 x 2"},
        {{.columns = 4, .rows = 3, .samples = 2}, "page 2 is 4 x 3, 2 x 8 bits (u8)"},
        {{.columns = 4, .rows = 3, .format = 2}, "page 2 is 4 x 3, 1 x 8 bits (i8)"},
        {{.columns = 4, .rows = 3, .bits = 1}, "page 2 is 4 x 3, 1 x 1 bits (u8)"},
        {{.columns = 4, .rows = 3, .bits = 16}, "page 2 is 4 x 3, 1 x 16 bits (u16)"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        test_tiff t = {0};
        test_page page = cases[i].page;
        page.pixels = pixels;
        add_bytes(&t, (test_page){0}, 1);
        test_tiff_add(&t, &page);
        save(&t, "a.tif");
        check_told("a.tif", i, cases[i].words);
    }
}

static void what_is_not_read_is_refused_by_name(void **state)
{
    (void)state;
    static const char pixels[PIXELS * 64];
    const uint32_t two[2] = {2, 2};
    const struct {
        test_page page;
        const char *words;
    } cases[] = {
        {{.bits = 64}, "'BitsPerSample' is 64 and 'SampleFormat' 1 (unsigned integers); what"},
        {{.bits = 64, .format = 2}, "64 and 'SampleFormat' 2 (signed integers)"},
        {{.bits = 16, .format = 3}, "16 and 'SampleFormat' 3 (floats)"},
        {{.bits = 32, .format = 5}, "32 and 'SampleFormat' 5 (complex integers)"},
        {{.bits = 64, .format = 6}, "64 and 'SampleFormat' 6 (complex floats)"},
        {{.samples = 5}, "'SamplesPerPixel' is 5; 1 to 4 are read"},
        {{.photometric = 5, .samples = 4}, "'PhotometricInterpretation' is 5 (CMYK)"},
        {{.photometric = 6, .samples = 3}, "takes"}, /* libtiff expects fewer samples */
        {{.photometric = 8, .samples = 3}, "'PhotometricInterpretation' is 8 (CIELab)"},
        {{.photometric = 32803}, "'PhotometricInterpretation' is 32803 (a colour filter)"},
        {{.photometric = 100, .bits = 32, .format = 3}, "how to invert floats"},
        {{.orientation = 6}, "'Orientation' is 6; 1 to 4 are read"},
        {{.compression = 6}, "'Compression' is 6 (JPEG as of TIFF 6)"},
        {{.compression = 8, .low_bit_first = true}, "'FillOrder' is 2 and 'Compression' 8"},
        {{.compression = 32909}, "'Compression' is 32909 (PixarLog)"},
        {{.compression = 34661}, "'Compression' is 34661 (JBIG)"},
        {{.compression = 12345}, "'Compression' is 12345"},
        {{.tags = {{32997, 4, 1, two}}}, "'ImageDepth' is 2"},
        {{.tags = {{33629, 4, 2, two}}}, "'UIC2Tag' says that directory 1 has 2 planes"},
        {{.description = "{\"shape\": [2, 3, 4], \"truncated\": true}"}, "tifffile wrote one"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        test_tiff t = {0};
        test_page page = cases[i].page;
        page.columns = COLUMNS;
        page.rows = ROWS;
        page.pixels = pixels;
        test_tiff_add(&t, &page);
        save(&t, "a.tif");
        if (strcmp(cases[i].words, "takes") != 0)
            check_told("a.tif", i, cases[i].words);
    }
    for (unsigned bits = 2; bits <= 24; bits += bits < 4 ? 2 : 4) {
        char words[32];
        test_tiff t = {0};
        if (bits == 8 || bits == 16)
            continue;
        add_bytes(&t, (test_page){0}, 1);
        test_tiff_poke(&t, 258, TEST_TAG_VALUE, bits);
        save(&t, "a.tif");
        snprintf(words, sizeof words, "'BitsPerSample' is %u and", bits);
        check_told("a.tif", bits, words);
    }
}

/* --- ImageJ ------------------------------------------------------------------------------- */

static const uint32_t per_unit[2][2] = {{5, 1}, {4, 1}}; /* pixels: 0.2 and 0.25 of a unit */

/* So many pages, the first of them described. */
static void save_described(const char *name, const char *description, size_t pages)
{
    test_tiff t = {.high_first = true};
    for (size_t p = 0; p < pages; p++)
        add_bytes(&t,
                  (test_page){.description = p ? NULL : description,
                              .tags = {{282, 5, 1, per_unit[0]}, {283, 5, 1, per_unit[1]}}},
                  (unsigned char)(10 * p));
    save(&t, name);
}

static void imagej_says_which_page_is_what(void **state)
{
    (void)state;
    cw_volume v;
    save_described("a.tif",
                   "ImageJ=1.53t\nimages=12\nchannels=2\nslices=3\nframes=2\nhyperstack=true\n"
                   "unit=micron\nspacing=1.5\nfinterval=0.5\nloop=false\n",
                   12);
    read_good("a.tif", &v);
    assert_int_equal(v.dim[2], 3);
    assert_int_equal(v.components, 2);
    assert_int_equal(v.steps, 2);
    assert_true(v.step_seconds == 0.5);
    assert_int_equal(v.known, CW_KNOWN_UNIT);
    check_affine(
        &v, (const double[12]){0.2 * 1e-3, 0, 0, 0, 0, 0.25 * 1e-3, 0, 0, 0, 0, 1.5 * 1e-3, 0});
    for (size_t p = 0; p < 12; p++)
        assert_true(value_at(&v, (const size_t[3]){1, 2, p / 2 % 3}, p % 2, p / 6) ==
                    10 * (double)p + 9);
    cw_volume_free(&v);
}

static void imagej_names_units(void **state)
{
    (void)state;
    const struct {
        const char *unit;
        double mm;
    } cases[] = {{"um", 1e-3},     {"\\u00B5m", 1e-3}, {"\xc2\xb5m", 1e-3}, {"\xb5m", 1e-3},
                 {"micron", 1e-3}, {"mm", 1},          {"cm", 10},          {"nm", 1e-6},
                 {"inch", 25.4},   {"m", 1000},        {"pixel", 0},        {"", 0},
                 {"furlong", 0},   {"\xc3\x85", 1e-7}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[128];
        cw_volume v;
        snprintf(text, sizeof text, "ImageJ=1.53t\nimages=2\nunit=%s\nspacing=-3\n",
                 cases[i].unit);
        save_described("a.tif", text, 2);
        read_good("a.tif", &v);
        const double mm = cases[i].mm > 0 ? cases[i].mm : 1;
        assert_int_equal(v.known, cases[i].mm > 0 ? CW_KNOWN_UNIT : 0);
        assert_near(v.affine[0][0], 0.2 * mm, 1e-12 * mm);
        assert_near(v.affine[1][1], 0.25 * mm, 1e-12 * mm);
        assert_near(v.affine[2][2], 3 * mm, 1e-12 * mm);
        cw_volume_free(&v);
    }
}

static void imagej_calibrates_values(void **state)
{
    (void)state;
    cw_volume v;
    save_described("a.tif", "ImageJ=1.53t\nimages=2\ncf=0\nc0=-32768.0\nc1=2.0\n", 2);
    read_good("a.tif", &v);
    assert_true(cw_volume_value(&v, 1, 0, 1) == 2.0 * 11 - 32768);
    cw_volume_free(&v);
    save_described("a.tif", "ImageJ=1.53t\nimages=2\ncf=3\nc0=1\nc1=2\n", 2);
    read_good("a.tif", &v);
    assert_non_null(strstr(notes, "calibration by function 3 is left out"));
    assert_true(cw_volume_value(&v, 1, 0, 1) == 11);
    cw_volume_free(&v);
}

/* Beyond 4 GiB ImageJ writes one directory, and all images behind its first. */
static void imagej_may_leave_directories_out(void **state)
{
    (void)state;
    for (int way = 0; way < 4; way++) {
        test_tiff t = {.high_first = way & 1};
        uint16_t pixels[5 * PIXELS];
        cw_volume v;
        for (size_t i = 0; i < 5 * PIXELS; i++)
            pixels[i] = (uint16_t)(1000 * i);
        const test_page page = {.columns = COLUMNS,
                                .rows = ROWS,
                                .bits = 16,
                                .rows_per_strip = way & 2 ? 1 : 0,
                                .description = "ImageJ=1.53t\nimages=5\n",
                                .pixels = pixels};
        test_tiff_add(&t, &page);
        /* its pixels once more, where others follow */
        const size_t at = test_tiff_put(&t, pixels, 5 * PIXELS, 2);
        if (way & 2) {
            const uint32_t strips[ROWS] = {(uint32_t)at, (uint32_t)at + 2 * COLUMNS,
                                           (uint32_t)at + 4 * COLUMNS};
            const size_t list = test_tiff_put(&t, strips, ROWS, 4);
            test_tiff_poke(&t, 273, TEST_TAG_VALUE, list);
        } else {
            test_tiff_poke(&t, 273, TEST_TAG_VALUE, at);
        }
        save(&t, "a.tif");
        read_good("a.tif", &v);
        assert_int_equal(v.dim[2], 5);
        for (size_t i = 0; i < 5 * PIXELS; i++)
            assert_true(cw_volume_value(&v, i % COLUMNS, i / COLUMNS % ROWS, i / PIXELS) ==
                        pixels[i]);
        cw_volume_free(&v);
    }
}

static void imagej_that_contradicts_the_file_is_not_believed(void **state)
{
    (void)state;
    const struct {
        const char *text;
        size_t pages;
        const char *words;
    } cases[] = {
        {"ImageJ=1\nimages=4\n", 3, "says images=4; the file holds 3 pages"},
        {"ImageJ=1\nimages=2\n", 3, "says images=2; the file holds 3 pages"},
        {"ImageJ=1\nimages=9\n", 1,
         "says images=9, which would be 108 bytes behind the first 8"},
        {"ImageJ=1\nimages=65536\n", 1, "says images=65536, which would be 786432 bytes"},
        {"ImageJ=1\nimages=0\n", 1, "says images=0; it must be 1 to 65536"},
        {"ImageJ=1\nimages=1e9\n", 1, "says images=1e+09; it must be"},
        {"ImageJ=1\nimages=3\nchannels=2\n", 3, "says 2 channels, 1 slices and 1 frames"},
        {"ImageJ=1\nimages=3\nslices=2\nframes=2\n", 3, "says 1 channels, 2 slices and 2"},
        {"ImageJ=1\nchannels=65536\nframes=65536\n", 1, "says 65536 channels, 0 slices"},
        {"ImageJ=1\nchannels=17\n", 17, "17 channels of 1 samples each; at most 16"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        save_described("a.tif", cases[i].text, cases[i].pages);
        check_told("a.tif", i, cases[i].words);
    }
}

static void resolution_alone_says_nothing_of_a_scan(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    save_described("a.tif", "taken on a Tuesday", 2);
    read_good("a.tif", &v);
    assert_int_equal(v.known, 0);
    check_affine(&v, (const double[12]){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0});
    cw_volume_free(&v);
    assert_ok(read_with("a.tif", (cw_read_desc){.spacing_mm = {0.5, 0.5, 2}}, &v, &err), err);
    assert_int_equal(v.known, CW_KNOWN_UNIT);
    check_affine(&v, (const double[12]){0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 2, 0});
    cw_volume_free(&v);
}

/* --- OME ---------------------------------------------------------------------------------- */

#define OME_HEAD                                                                               \
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?><!-- OME-XML: do not edit -->"                  \
    "<OME xmlns=\"http://www.openmicroscopy.org/Schemas/OME/2016-06\"><Image ID=\"Image:0\">"
#define OME_SIZES                                                                              \
    "<Pixels DimensionOrder=\"XYZCT\" Type=\"uint8\" SizeX=\"4\" SizeY=\"3\" SizeZ=\"3\" "     \
    "SizeC=\"2\" SizeT=\"2\" "
#define OME_TAIL "</Pixels></Image></OME>"

static void ome_says_which_page_is_what(void **state)
{
    (void)state;
    static const char *const orders[] = {"XYZCT", "XYZTC", "XYCZT", "XYCTZ", "XYTZC", "XYTCZ"};
    for (size_t n = 0; n < 6; n++) {
        char text[1024];
        cw_volume v;
        snprintf(text, sizeof text,
                 OME_HEAD "<Pixels DimensionOrder=\"%s\" SizeX=\"4\" SizeY=\"3\" SizeZ=\"3\" "
                          "SizeC=\"2\" SizeT=\"2\" PhysicalSizeX=\"0.5\" "
                          "PhysicalSizeY=\"400\" PhysicalSizeYUnit=\"nm\" PhysicalSizeZ=\"2\" "
                          "PhysicalSizeZUnit=\"\xc2\xb5m\" TimeIncrement=\"250\" "
                          "TimeIncrementUnit=\"ms\">%s" OME_TAIL,
                 orders[n], n % 2 ? "<TiffData/>" : "");
        save_described("a.tif", text, 12);
        read_good("a.tif", &v);
        assert_int_equal(v.dim[2], 3);
        assert_int_equal(v.components, 2);
        assert_int_equal(v.steps, 2);
        assert_true(v.step_seconds == 0.25);
        assert_int_equal(v.known, CW_KNOWN_UNIT);
        assert_near(v.affine[0][0], 0.5e-3, 1e-15);
        assert_near(v.affine[1][1], 0.4e-3, 1e-15);
        assert_near(v.affine[2][2], 2e-3, 1e-15);
        for (size_t p = 0; p < 12; p++) {
            size_t rest = p, at[128] = {0};
            for (const char *axis = orders[n] + 2; *axis; axis++) {
                const size_t size = *axis == 'Z' ? 3 : 2;
                at[(int)*axis] = rest % size;
                rest /= size;
            }
            assert_true(value_at(&v, (const size_t[3]){0, 0, at['Z']}, at['C'], at['T']) ==
                        10 * (double)p);
        }
        cw_volume_free(&v);
    }
}

/* Planes may stand in any order, and in fewer pages than there are. */
static void ome_places_pages_one_by_one(void **state)
{
    (void)state;
    cw_volume v;
    save_described("a.tif",
                   OME_HEAD "<Pixels DimensionOrder=\"XYCZT\" SizeX=\"4\" SizeY=\"3\" "
                            "SizeZ=\"3\" SizeC=\"1\" SizeT=\"1\">"
                            "<TiffData IFD=\"3\" FirstZ=\"0\"><UUID FileName=\"a.ome.tif\">u"
                            "</UUID></TiffData>"
                            "<TiffData IFD=\"1\" FirstZ=\"1\" PlaneCount=\"2\"><UUID "
                            "FileName=\"a.ome.tif\">u</UUID></TiffData>" OME_TAIL,
                   5);
    read_good("a.tif", &v);
    assert_int_equal(v.dim[2], 3);
    assert_true(cw_volume_value(&v, 0, 0, 0) == 30);
    assert_true(cw_volume_value(&v, 0, 0, 1) == 10);
    assert_true(cw_volume_value(&v, 0, 0, 2) == 20);
    assert_non_null(strstr(notes, "left out, as the OME-XML has no place for them: 2 pages"));
    assert_int_equal(v.known, 0);
    cw_volume_free(&v);
}

static void ome_without_all_sizes_has_no_unit(void **state)
{
    (void)state;
    cw_volume v;
    save_described("a.tif",
                   OME_HEAD "<Pixels DimensionOrder=\"XYCZT\" SizeX=\"4\" SizeY=\"3\" "
                            "SizeZ=\"3\" SizeC=\"1\" SizeT=\"1\" PhysicalSizeX=\"0.5\" "
                            "PhysicalSizeY=\"0.5\">" OME_TAIL,
                   3);
    read_good("a.tif", &v);
    assert_int_equal(v.known, 0);
    check_affine(&v, (const double[12]){0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1, 0});
    assert_non_null(strstr(notes, "does not say all sizes of a voxel"));
    cw_volume_free(&v);
}

/* A pixel of three samples is one channel of OME's three. */
static void ome_counts_samples_as_channels(void **state)
{
    (void)state;
    test_tiff t = {0};
    unsigned char pixels[3 * PIXELS];
    cw_volume v;
    for (size_t i = 0; i < sizeof pixels; i++)
        pixels[i] = (unsigned char)i;
    test_tiff_add(&t, &(test_page){.columns = COLUMNS,
                                   .rows = ROWS,
                                   .samples = 3,
                                   .photometric = 2,
                                   .description = OME_HEAD
                                   "<Pixels DimensionOrder=\"XYCZT\" SizeX=\"4\" SizeY=\"3\" "
                                   "SizeZ=\"1\" SizeC=\"3\" SizeT=\"1\">" OME_TAIL,
                                   .pixels = pixels});
    save(&t, "a.tif");
    read_good("a.tif", &v);
    assert_int_equal(v.components, 3);
    assert_true(value_at(&v, (const size_t[3]){1, 0, 0}, 2, 0) == 5);
    cw_volume_free(&v);
}

static void ome_that_contradicts_the_file_is_not_believed(void **state)
{
    (void)state;
    static char deep[8192] = OME_HEAD OME_SIZES ">";
    for (int i = 0; i < 100; i++)
        strcat(deep, "<a><!-- -->");
    const struct {
        const char *text, *words;
    } cases[] = {
        {OME_HEAD OME_SIZES ">", "of the OME-XML is not XML: no element found"},
        {OME_HEAD OME_SIZES "><b></a>", "is not XML: mismatched tag"},
        {"<OME>", "is not XML"},
        {"<OME></OME>", "the OME-XML describes no image"},
        {"<!DOCTYPE a [<!ENTITY b \"c\">]><OME></OME>", "document type (<!DOCTYPE>)"},
        {deep, "more than 1048576 elements, or 64 inside each other"},
        {"<OME><BinaryOnly MetadataFile=\"a\"/></OME>", "the OME-XML is in another file"},
        {OME_HEAD OME_SIZES "/></Image><Image/></OME>", "describes several images"},
        {OME_HEAD OME_SIZES "><TiffData><UUID FileName=\"a\"/></TiffData><TiffData>" OME_TAIL,
         "two pages for slice 0, channel 0, step 0"},
        {OME_HEAD OME_SIZES "><TiffData IFD=\"0\"><UUID FileName=\"a\"/></TiffData><TiffData "
                            "IFD=\"1\" FirstZ=\"1\"><UUID FileName=\"b\"/></TiffData>" OME_TAIL,
         "spreads its planes over several files"},
        {OME_HEAD OME_SIZES "><TiffData IFD=\"0\"/>" OME_TAIL,
         "names no page for slice 1, channel 0, step 0"},
        {OME_HEAD OME_SIZES "><TiffData IFD=\"11\" PlaneCount=\"2\"/>" OME_TAIL,
         "has a plane in directory 13; of the file's 12"},
        {OME_HEAD OME_SIZES "><TiffData IFD=\"0\" FirstT=\"2\"/>" OME_TAIL,
         "a plane for slice 0, channel 0, step 2, and sizes of 3, 2, 2"},
        {OME_HEAD OME_SIZES "><TiffData PlaneCount=\"2000000000\"/>" OME_TAIL,
         "a plane for slice 0, channel 0, step 2"},
        {OME_HEAD OME_SIZES "><TiffData IFD=\"-1\"/>" OME_TAIL, "'TiffData' of the OME-XML"},
        {OME_HEAD "<Pixels DimensionOrder=\"XYZZT\" SizeX=\"4\" SizeY=\"3\"/></Image></OME>",
         "'DimensionOrder' of the OME-XML is 'XYZZT'"},
        {OME_HEAD "<Pixels DimensionOrder=\"XYZCT\" SizeX=\"4\" SizeY=\"4\"/></Image></OME>",
         "'SizeX' and 'SizeY' of the OME-XML are 4 x 4; the first page is 4 x 3"},
        {OME_HEAD "<Pixels DimensionOrder=\"XYZCT\" SizeX=\"4\" SizeY=\"3\" SizeZ=\"65536\" "
                  "SizeC=\"65536\" SizeT=\"1\"/></Image></OME>",
         "are 65536, 65536 and 1, pages of 1 samples; at most 65536"},
        {OME_HEAD OME_SIZES "PhysicalSizeX=\"0\"/></Image></OME>",
         "'PhysicalSizeX' of the OME-XML is '0'"},
        {OME_HEAD OME_SIZES "PhysicalSizeX=\"inf\" PhysicalSizeY=\"1\"/></Image></OME>",
         "gives axis 0 a spacing of inf"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        save_described("a.tif", cases[i].text, 12);
        check_told("a.tif", i, cases[i].words);
    }
}

/* --- slices in files of their own --------------------------------------------------------- */

static void make_folder(const char *name)
{
    assert_int_equal(mkdir(test_path(name), 0700), 0);
}

/* Of strips, tiles, rows that run backwards, channels and frames, and slices in files. */
static void regions_are_crops(void **state)
{
    (void)state;
    const cw_read_desc here = {
        .no_sandbox = true, .gaps = CW_GAPS_INTERPOLATE, .spacing_mm = {1, 2, 3}};
    const test_page pages[] = {{.rows_per_strip = 2},
                               {.rows_per_strip = 16, .tile_width = 16},
                               {.orientation = 3, .rows_per_strip = 1},
                               {.orientation = 4, .rows_per_strip = 16, .tile_width = 16},
                               {.photometric = 100}};
    for (size_t i = 0; i < sizeof pages / sizeof *pages; i++) {
        test_tiff t = {0};
        for (unsigned char p = 0; p < 3; p++)
            add_bytes(&t, pages[i], (unsigned char)(20 * p));
        save(&t, "a.tif");
        check_regions("a.tif", &here);
    }
    save_described("a.tif",
                   "ImageJ=1.53t\nimages=12\nchannels=2\nslices=3\nframes=2\nunit=mm\n", 12);
    check_regions("a.tif", NULL);
    make_folder("s");
    save_slice("s/cut_8.tif", 10);
    save_slice("s/cut_9.tif", 20);
    save_slice("s/cut_11.tif", 30);
    check_regions("s", &here);
}

/* Tiles of 16 rows, their planes apart: a region begins within one row of tiles, goes on in the
 * next and ends in the third. */
static void regions_may_cross_rows_of_tiles(void **state)
{
    (void)state;
    enum { TALL = 37, ACROSS = 5 };
    static unsigned char pixels[TALL * ACROSS * 2];
    for (size_t i = 0; i < sizeof pixels; i++)
        pixels[i] = (unsigned char)(i * 37);
    for (uint16_t orientation = 1; orientation <= 4; orientation += 3) {
        test_tiff t = {0};
        cw_error err = {0};
        test_tiff_add(&t, &(test_page){.columns = ACROSS,
                                       .rows = TALL,
                                       .samples = 2,
                                       .separate = true,
                                       .orientation = orientation,
                                       .rows_per_strip = 16,
                                       .tile_width = 16,
                                       .pixels = pixels});
        save(&t, "a.tif");
        cw_volume whole, part, crop;
        assert_ok(read_back("a.tif", &whole, &err), err);
        for (size_t first = 0; first < 20; first++) {
            const cw_box box = {{1, first, 0}, {3, 18, 1}};
            const cw_read_desc desc = {.region = &box};
            assert_ok(cw_volume_read(test_path("a.tif"), &desc, &part, NULL, &err), err);
            assert_ok(cw_volume_crop(&whole, &box, &crop, &err), err);
            for (size_t n = 0; n < 3 * 18 * 2; n++) {
                cw_volume a, b;
                assert_ok(cw_volume_select(&crop, n % 2, 0, &a, &err), err);
                assert_ok(cw_volume_select(&part, n % 2, 0, &b, &err), err);
                assert_true(cw_volume_value(&a, n / 2 % 3, n / 6, 0) ==
                            cw_volume_value(&b, n / 2 % 3, n / 6, 0));
            }
            cw_volume_free(&part);
        }
        cw_volume_free(&whole);
    }
}

static void numbers_in_names_count_as_numbers(void **state)
{
    (void)state;
    cw_volume v;
    make_folder("s");
    save_slice("s/cut_10.tif", 30);
    save_slice("s/cut_8.tif", 10);
    save_slice("s/cut_9.tif", 20);
    put_file("s/about.txt", "no TIFF", NULL, 0);
    const char *const paths[] = {"s", "s/cut_*.tif", "s/*"};
    for (int i = 0; i < 3; i++) {
        read_good(paths[i], &v);
        assert_int_equal(v.dim[2], 3);
        for (size_t z = 0; z < 3; z++)
            assert_true(cw_volume_value(&v, 0, 0, z) == 10 * (double)(z + 1));
        assert_string_equal(
            notes, i == 1 ? "" : "left out, because they are not TIFF: 1 of its files\n");
        cw_volume_free(&v);
    }
}

/* Files of one page are slices, those of several are volumes: the steps of a series. */
static void slices_are_one_volume_and_stacks_are_steps(void **state)
{
    (void)state;
    const cw_raw_layout layout = {.dim = {COLUMNS, ROWS, 2}};
    const cw_read_desc raw = {.raw = &layout};
    char slices[256], slice[256], one[256], other[256], stacks[256], **files;
    size_t count;
    cw_error err = {0};
    save_slice("cut_8.tif", 10);
    save_slice("cut_9.tif", 20);
    for (int n = 2; n <= 10; n += 8) {
        char name[32];
        test_tiff t = {0};
        snprintf(name, sizeof name, "stack%d.tif", n);
        add_bytes(&t, (test_page){0}, 1);
        add_bytes(&t, (test_page){0}, 2);
        save(&t, name);
    }
    snprintf(slices, sizeof slices, "%s", test_path("cut_*.tif"));
    snprintf(slice, sizeof slice, "%s", test_path("cut_8.tif"));
    snprintf(one, sizeof one, "%s", test_path("stack2.tif"));
    snprintf(other, sizeof other, "%s", test_path("stack10.tif"));
    snprintf(stacks, sizeof stacks, "%s", test_path("stack*.tif"));
    const char *const single[] = {slices, one, test_path("."), test_path("nothing*.tif")};
    for (size_t i = 0; i < 4; i++) {
        assert_ok(cw_steps_list(&single[i], 1, NULL, &files, &count, &err), err);
        assert_int_equal(count, 0);
        assert_null(files);
    }
    const char *const series[][2] = {{stacks, NULL}, {other, one}};
    for (size_t i = 0; i < 2; i++) {
        assert_ok(cw_steps_list(series[i], i + 1, NULL, &files, &count, &err), err);
        assert_int_equal(count, 2);
        assert_string_equal(files[0], one);
        assert_string_equal(files[1], other);
        cw_steps_free(files, count);
    }
    const char *const mixed[] = {one, slice};
    assert_fails(cw_steps_list(mixed, 2, NULL, &files, &count, &err), CW_ERR_ARGUMENT,
                 "cut_8.tif: is a slice, and of several files each must be a volume", err);
    assert_fails(cw_steps_list(series[1], 2, &raw, &files, &count, &err), CW_ERR_ARGUMENT,
                 "2 files with one layout", err);
    assert_ok(cw_steps_list(series[0], 1, &raw, &files, &count, &err), err);
    assert_int_equal(count, 0);
}

static void missing_slices_are_for_gaps_to_decide(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    make_folder("s");
    save_slice("s/0.tif", 0);
    save_slice("s/10.tif", 10);
    save_slice("s/20.tif", 20);
    save_slice("s/40.tif", 40);
    assert_fails(read_with("s", (cw_read_desc){0}, &v, &err), CW_ERR_UNSAFE,
                 "1 slice is missing; the first gap is from 20 to 40 in their numbers, where "
                 "others are 10 apart",
                 err);
    assert_ok(read_with("s", (cw_read_desc){.gaps = CW_GAPS_INTERPOLATE}, &v, &err), err);
    assert_int_equal(v.dim[2], 5);
    assert_non_null(strstr(notes, "interpolated to even ones"));
    for (size_t z = 0; z < 5; z++)
        assert_true(cw_volume_value(&v, 1, 0, z) == 10 * (double)z + 1);
    cw_volume_free(&v);
    assert_ok(read_with("s", (cw_read_desc){.gaps = CW_GAPS_ALLOW}, &v, &err), err);
    assert_int_equal(v.dim[2], 4);
    assert_non_null(strstr(notes, "taken as if they were even"));
    assert_true(cw_volume_value(&v, 0, 0, 3) == 40);
    cw_volume_free(&v);
    assert_int_equal(remove(test_path("s/40.tif")), 0);
    read_good("s", &v);
    assert_int_equal(v.dim[2], 3);
    assert_string_equal(notes, "");
    cw_volume_free(&v);
}

static void names_that_are_no_row_are_taken_in_their_order(void **state)
{
    (void)state;
    static const char *const pairs[][2] = {
        {"a.tif", "b.tif"}, {"a1b2.tif", "a2b3.tif"}, {"a1.tif", "a1b.tif"}};
    for (size_t i = 0; i < 3; i++) {
        cw_volume v;
        char folder[8], path[64];
        snprintf(folder, sizeof folder, "s%zu", i);
        make_folder(folder);
        for (int k = 0; k < 2; k++) {
            snprintf(path, sizeof path, "%s/%s", folder, pairs[i][k]);
            save_slice(path, (unsigned char)(10 * k));
        }
        read_good(folder, &v);
        assert_int_equal(v.dim[2], 2);
        assert_true(cw_volume_value(&v, 0, 0, 1) == 10);
        assert_non_null(strstr(notes, "do not differ by one number alone"));
        cw_volume_free(&v);
    }
}

static void slices_that_do_not_belong_together_are_named(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    test_tiff t = {0};
    make_folder("s");
    make_folder("s/deep");
    save_slice("s/1.tif", 1);
    add_bytes(&t, (test_page){0}, 1);
    add_bytes(&t, (test_page){0}, 2);
    save(&t, "s/2.tif");
    assert_fails(read_with("s", (cw_read_desc){0}, &v, &err), CW_ERR_FORMAT,
                 "2.tif: it holds 2 pages; slices in files of their own have one each", err);
    add_bytes(&t, (test_page){.format = 2}, 1);
    save(&t, "s/2.tif");
    assert_fails(read_with("s", (cw_read_desc){0}, &v, &err), CW_ERR_FORMAT,
                 "2.tif: it is 4 x 3, 1 x 8 bits (i8); the first is 4 x 3, 1 x 8 bits (u8)",
                 err);
    save_slice("s/01.tif", 1);
    assert_int_equal(remove(test_path("s/2.tif")), 0);
    assert_fails(read_with("s", (cw_read_desc){0}, &v, &err), CW_ERR_UNSAFE,
                 "'01.tif' and '1.tif' have the same number", err);
    assert_int_equal(remove(test_path("s/01.tif")), 0);
    save_slice("s/deep/2.tif", 1);
    assert_fails(read_with("s", (cw_read_desc){0}, &v, &err), CW_ERR_UNSAFE,
                 "in several folders, as are '1.tif' and 'deep/2.tif'", err);
    put_file("s/2.tif", "", NULL, 0);
    assert_fails(read_with("s/*.tif", (cw_read_desc){0}, &v, &err), CW_ERR_IO,
                 "2.tif: the file is empty", err);
    put_file("s/2.tif", "no TIFF at all", NULL, 0);
    assert_fails(read_with("s/*.tif", (cw_read_desc){0}, &v, &err), CW_ERR_FORMAT,
                 "2.tif: it does not start as a TIFF file does", err);
    put_file("s/deep/2.tif", "II*", "\0", 1);
    assert_fails(read_with("s/deep", (cw_read_desc){0}, &v, &err), CW_ERR_FORMAT,
                 "2.tif: the file ends within its header", err);
}

static void a_folder_of_one_stack_is_that_stack(void **state)
{
    (void)state;
    cw_volume v;
    make_folder("s");
    save_described("s/a.tif", "", 3);
    read_good("s", &v);
    assert_int_equal(v.dim[2], 3);
    cw_volume_free(&v);
}

/* --- hostile files ------------------------------------------------------------------------ */

static void damaged_directories_are_told_field_by_field(void **state)
{
    (void)state;
    const struct {
        uint16_t tag;
        test_tag_part part;
        uint64_t number;
        const char *words;
    } cases[] = {
        {256, TEST_TAG_VALUE, 0, "directory 1 cannot be read"},
        {256, TEST_TAG_VALUE, 5, "'StripByteCounts' of page 1 are too few for its pixels"},
        {256, TEST_TAG_VALUE, 0x7fffffff, ""},
        {257, TEST_TAG_VALUE, 0xffffffff, ""},
        {257, TEST_TAG_VALUE, 4, ""},
        {258, TEST_TAG_VALUE, 16, "'StripByteCounts' of page 1 are too few"},
        {273, TEST_TAG_VALUE, 0, "strip 1 of page 1 has 12 bytes at 0"},
        {273, TEST_TAG_VALUE, 0xfffffff0, "strip 1 of page 1 has 12 bytes at 4294967280"},
        {277, TEST_TAG_VALUE, 0, ""},
        {278, TEST_TAG_VALUE, 0, ""},
        {279, TEST_TAG_VALUE, 11, ""},
        {279, TEST_TAG_VALUE, 0xffffffff, ""},
        {284, TEST_TAG_VALUE, 7, ""},
        {270, TEST_TAG_COUNT, 0xffffffff, "tag 270 of directory 1 has 4294967295 values"},
        {270, TEST_TAG_VALUE, 0xfffffff0, "tag 270 of directory 1 has 16 values at 4294967280"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        test_tiff t = {0};
        cw_volume v;
        cw_error err = {0};
        add_bytes(&t, (test_page){.description = "fifteen letters"}, 1);
        test_tiff_poke(&t, cases[i].tag, cases[i].part, cases[i].number);
        save(&t, "a.tif");
        const cw_status st = read_with("a.tif", (cw_read_desc){0}, &v, &err);
        if (st != CW_ERR_FORMAT && st != CW_ERR_LIMIT && st != CW_OK)
            fail_msg("case %zu: status %d, %s", i, (int)st, err.message);
        if (st == CW_OK) {
            /* libtiff found the value impossible and made another of the rest */
            assert_string_equal(cases[i].words, "");
            assert_int_equal(v.dim[0], COLUMNS);
            assert_int_equal(v.dim[1], ROWS);
            assert_true(cw_volume_value(&v, 3, 2, 0) == 12);
            cw_volume_free(&v);
        } else if (!strstr(err.message, cases[i].words)) {
            fail_msg("case %zu says: %s; not: %s", i, err.message, cases[i].words);
        }
    }
}

static void directories_in_a_circle_are_found_out(void **state)
{
    (void)state;
    for (size_t back = 0; back < 5; back++) {
        test_tiff t = {.big = back % 2};
        size_t starts[5];
        for (size_t p = 0; p < 5; p++) {
            const size_t link = t.size ? t.link : back % 2 ? 8 : 4;
            add_bytes(&t, (test_page){0}, 1);
            memcpy(&starts[p], t.bytes + link, 8);
            starts[p] &= back % 2 ? SIZE_MAX : 0xffffffff;
        }
        memcpy(t.bytes + t.link, &starts[back], back % 2 ? 8 : 4);
        save(&t, "a.tif");
        check_told("a.tif", back, "the chain of directories runs in a circle");
    }
}

static void files_that_are_hardly_any_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *bytes;
        size_t size;
        const char *words;
    } cases[] = {
        {"II*\0", 4, "ends within its header"},
        {"II*\0\0\0\0\0", 8, "has no directory"},
        {"II*\0\x08\0\0\0", 8, "directory 1 should be at 8; the file has 8 bytes"},
        {"MM\0*\xff\xff\xff\xff", 8, "directory 1 should be at 4294967295"},
        {"II*\0\x08\0\0\0\0\0", 10, "directory 1 has 0 tags; it must be 1 to 4096"},
        {"II*\0\x08\0\0\0\xff\xff", 10, "directory 1 has 65535 tags"},
        {"II*\0\x08\0\0\0\1\0", 10, "ends before a tag of directory 1 does"},
        {"II*\0\x08\0\0\0\1\0\0\0\0\0\0\0\0\0\0\0\0\0", 22, "ends before the end of directory"},
        {"II+\0\x08\0\0\0\0\0\0\0", 12, "the header of this BigTIFF file is damaged"},
        {"II+\0\x04\0\0\0\0\0\0\0\0\0\0\0", 16, "the header of this BigTIFF file is damaged"},
        {"MM\0+\0\x08\0\0\xff\xff\xff\xff\xff\xff\xff\xff", 16,
         "should be at 1844674407370955"},
        {"IM*\0\x08\0\0\0", 8, "does not start as a TIFF file does"},
        {"II\x2c\0\x08\0\0\0", 8, "does not start as a TIFF file does"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        put_file("a.tif", "", cases[i].bytes, cases[i].size);
        check_told("a.tif", i, cases[i].words);
    }
}

static void a_cut_is_never_a_volume(void **state)
{
    (void)state;
    for (int way = 0; way < 3; way++) {
        test_tiff t = {.high_first = way & 1, .big = way & 2};
        add_bytes(&t,
                  (test_page){.rows_per_strip = way == 2 ? 16 : 1,
                              .tile_width = way == 2 ? 16 : 0,
                              .description = "some words",
                              .tags = {{282, 5, 1, per_unit[0]}}},
                  1);
        add_bytes(&t, (test_page){.bits = 8}, 2);
        save(&t, "a.tif");
        check_some_cuts("a.tif", "a.tif", 0, TEST_IS_SLOW ? 7 : 1);
    }
}

/* Claims of pixels that no file of that size can hold. */
static void claims_are_held_against_the_file(void **state)
{
    (void)state;
    test_tiff t = {0};
    cw_volume v;
    cw_error err = {0};
    add_bytes(&t, (test_page){.compression = 5}, 1);
    test_tiff_poke(&t, 256, TEST_TAG_VALUE, 60000);
    test_tiff_poke(&t, 257, TEST_TAG_VALUE, 60000);
    test_tiff_poke(&t, 278, TEST_TAG_VALUE, 60000);
    save(&t, "a.tif");
    assert_fails(read_with("a.tif", (cw_read_desc){0}, &v, &err), CW_ERR_FORMAT,
                 "ask for 1 pages of 60000 x 60000 pixels; the file has", err);
    assert_fails(read_with("a.tif", (cw_read_desc){.header_only = true}, &v, &err),
                 CW_ERR_FORMAT, "ask for 1 pages", err);
    save_described("a.tif", "", 2);
    assert_fails(read_with("a.tif", (cw_read_desc){.max_voxels = 23}, &v, &err), CW_ERR_LIMIT,
                 "asks for 24 voxels; the limit is 23", err);
}

/* Where libtiff runs here, so that its memory is this thread's too. */
static void memory_may_run_out_anywhere(void **state)
{
    (void)state;
    static const char *const names[] = {"a.tif", "b.tif", "s"};
    test_tiff t = {0};
    add_bytes(&t, (test_page){.rows_per_strip = 16, .tile_width = 16, .samples = 1}, 1);
    save(&t, "a.tif");
    save_described("b.tif", OME_HEAD OME_SIZES ">" OME_TAIL, 12);
    make_folder("s");
    save_slice("s/1.tif", 1);
    save_slice("s/2.tif", 1);
    save_slice("s/4.tif", 1);
    const cw_read_desc here = {.no_sandbox = true, .gaps = CW_GAPS_INTERPOLATE};
    for (size_t i = 0; i < 3; i++)
        check_starved(names[i], &here);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(types_byte_orders_and_layouts_give_the_same_numbers),
        TEST(samples_are_components_stored_together_or_apart),
        TEST(bits_may_come_the_low_one_first),
        TEST(white_is_never_0),
        TEST(rows_and_columns_may_run_backwards),
        TEST(palettes_are_read_as_indices),
#if CW_TEST_LIBTIFF
        TEST(compressed_pixels_are_what_was_compressed),
        TEST(damaged_pixels_are_no_voxels),
        TEST(floats_are_predicted_alike_in_either_order),
        TEST(planes_may_be_larger_than_what_crosses_at_once),
        TEST(a_wrong_checksum_is_damage),
        TEST(jpeg_in_ycbcr_arrives_as_rgb),
        TEST(webp_without_loss_is_what_was_compressed),
        TEST(a_cut_of_compressed_pages_is_never_a_volume),
#endif
        TEST(thumbnails_and_masks_are_no_slices),
        TEST(pages_that_differ_are_named),
        TEST(what_is_not_read_is_refused_by_name),
        TEST(imagej_says_which_page_is_what),
        TEST(regions_are_crops),
        TEST(regions_may_cross_rows_of_tiles),
        TEST(imagej_names_units),
        TEST(imagej_calibrates_values),
        TEST(imagej_may_leave_directories_out),
        TEST(imagej_that_contradicts_the_file_is_not_believed),
        TEST(resolution_alone_says_nothing_of_a_scan),
        TEST(ome_says_which_page_is_what),
        TEST(ome_places_pages_one_by_one),
        TEST(ome_without_all_sizes_has_no_unit),
        TEST(ome_counts_samples_as_channels),
        TEST(ome_that_contradicts_the_file_is_not_believed),
        TEST(numbers_in_names_count_as_numbers),
        TEST(slices_are_one_volume_and_stacks_are_steps),
        TEST(missing_slices_are_for_gaps_to_decide),
        TEST(names_that_are_no_row_are_taken_in_their_order),
        TEST(slices_that_do_not_belong_together_are_named),
        TEST(a_folder_of_one_stack_is_that_stack),
        TEST(damaged_directories_are_told_field_by_field),
        TEST(directories_in_a_circle_are_found_out),
        TEST(files_that_are_hardly_any_are_refused),
        TEST(a_cut_is_never_a_volume),
        TEST(claims_are_held_against_the_file),
        TEST(memory_may_run_out_anywhere),
    };
    if (!cwi_module_present("tiff")) {
        puts("this build reads no TIFF");
        return 0;
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
