/* TIFF read: what libtiff compressed. */
#include "support/files/tiff_cases.h"

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

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(compressed_pixels_are_what_was_compressed),
        TEST(damaged_pixels_are_no_voxels),
        TEST(floats_are_predicted_alike_in_either_order),
        TEST(planes_may_be_larger_than_what_crosses_at_once),
        TEST(a_wrong_checksum_is_damage),
        TEST(jpeg_in_ycbcr_arrives_as_rgb),
        TEST(webp_without_loss_is_what_was_compressed),
        TEST(a_cut_of_compressed_pages_is_never_a_volume),
    };
    if (!cwi_module_present("tiff")) {
        puts("this build reads no TIFF");
        return 0;
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
#else
int main(void)
{
    puts("without libtiff nothing compresses what is to be read");
    return 0;
}
#endif
