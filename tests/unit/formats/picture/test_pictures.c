/* Slices in PNG and BMP files: every kind of pixels, written byte by byte, and damaged files. */
#include "core/base/module.h"
#include "support/files/reading.h"
#include "support/files/regions.h"

#include <stdio.h>
#include <sys/stat.h>

enum { COLUMNS = 5, ROWS = 3, NOTES = 600 };

static char notes[NOTES];

static void take_note(void *user, const char *text)
{
    (void)user;
    strncat(notes, text, NOTES - strlen(notes) - 2);
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

static double value_at(const cw_volume *v, size_t x, size_t y, size_t component)
{
    cw_volume one;
    cw_error err = {0};
    assert_ok(cw_volume_select(v, component, 0, &one, &err), err);
    return cw_volume_value(&one, x, y, 0);
}

/* --- PNG ---------------------------------------------------------------------------------- */

/* A picture of COLUMNS x ROWS pixels; samples as they are stored. */
typedef struct png {
    int bits, color, channels;
    bool interlaced;
    const unsigned char *palette; /* 3 a colour */
    int colors;
    uint32_t per_metre; /* 0: not stated */
    unsigned (*sample)(size_t x, size_t y, size_t channel);
} png;

typedef struct bytes {
    unsigned char at[4096];
    size_t size;
} bytes;

static void put_big(bytes *b, uint32_t value)
{
    for (int i = 3; i >= 0; i--)
        b->at[b->size++] = (unsigned char)(value >> 8 * i);
}

static void put_chunk(bytes *b, const char *name, const void *data, size_t size)
{
    put_big(b, (uint32_t)size);
    const size_t start = b->size;
    memcpy(b->at + start, name, 4);
    if (size)
        memcpy(b->at + start + 4, data, size);
    b->size += 4 + size;
    put_big(b, (uint32_t)crc32(0, b->at + start, (uInt)(4 + size)));
}

/* Puts the pixels of a pass: columns from x0 on by dx, rows from y0 on by dy. */
static void put_pass(bytes *b, const png *p, size_t x0, size_t dx, size_t y0, size_t dy)
{
    for (size_t y = y0; y < ROWS && x0 < COLUMNS; y += dy) {
        unsigned held = 0;
        int bits = 0;
        b->at[b->size++] = 0; /* no filter */
        for (size_t x = x0; x < COLUMNS; x += dx)
            for (size_t c = 0; c < (size_t)p->channels; c++) {
                held = held << p->bits | p->sample(x, y, c);
                for (bits += p->bits; bits >= 8; bits -= 8)
                    b->at[b->size++] = (unsigned char)(held >> (bits - 8));
            }
        if (bits > 0)
            b->at[b->size++] = (unsigned char)(held << (8 - bits));
    }
}

static void put_png(const char *name, const png *p)
{
    static const size_t passes[7][4] = {{0, 8, 0, 8}, {4, 8, 0, 8}, {0, 4, 4, 8}, {2, 4, 0, 4},
                                        {0, 2, 2, 4}, {1, 2, 0, 2}, {0, 1, 1, 2}};
    const unsigned char head[13] = {0,
                                    0,
                                    0,
                                    COLUMNS,
                                    0,
                                    0,
                                    0,
                                    ROWS,
                                    (unsigned char)p->bits,
                                    (unsigned char)p->color,
                                    0,
                                    0,
                                    p->interlaced};
    bytes b = {.size = 8}, raw = {.size = 0}, phys = {.size = 0};
    size_t packed_size;
    memcpy(b.at, "\x89PNG\r\n\x1a\n", 8);
    put_chunk(&b, "IHDR", head, sizeof head);
    if (p->per_metre) {
        put_big(&phys, p->per_metre);
        put_big(&phys, p->per_metre);
        phys.at[phys.size++] = 1;
        put_chunk(&b, "pHYs", phys.at, phys.size);
    }
    if (p->colors)
        put_chunk(&b, "PLTE", p->palette, 3 * (size_t)p->colors);
    for (int n = 0; n < 7 && p->interlaced; n++)
        put_pass(&raw, p, passes[n][0], passes[n][1], passes[n][2], passes[n][3]);
    if (!p->interlaced)
        put_pass(&raw, p, 0, 1, 0, 1);
    unsigned char *packed = pack_bytes(raw.at, raw.size, false, &packed_size);
    put_chunk(&b, "IDAT", packed, packed_size);
    put_chunk(&b, "IEND", NULL, 0);
    put_file(name, "", b.at, b.size);
    free(packed);
}

static unsigned mixed(size_t x, size_t y, size_t c)
{
    return (unsigned)((x + 1) * 2654435761u + (y + 1) * 40503u + c * 7919u);
}

static unsigned sample_1(size_t x, size_t y, size_t c)
{
    return mixed(x, y, c) >> 9 & 1;
}

static unsigned sample_2(size_t x, size_t y, size_t c)
{
    return mixed(x, y, c) >> 9 & 3;
}

static unsigned sample_4(size_t x, size_t y, size_t c)
{
    return mixed(x, y, c) >> 9 & 15;
}

static unsigned sample_8(size_t x, size_t y, size_t c)
{
    return mixed(x, y, c) >> 9 & 255;
}

static unsigned sample_16(size_t x, size_t y, size_t c)
{
    return mixed(x, y, c) >> 9 & 65535;
}

static const struct {
    int bits, color, channels;
    unsigned (*sample)(size_t x, size_t y, size_t c);
    unsigned scale;
} kinds[] = {{1, 0, 1, sample_1, 255}, {2, 0, 1, sample_2, 85},  {4, 0, 1, sample_4, 17},
             {8, 0, 1, sample_8, 1},   {16, 0, 1, sample_16, 1}, {8, 2, 3, sample_8, 1},
             {16, 2, 3, sample_16, 1}, {8, 4, 2, sample_8, 1},   {16, 4, 2, sample_16, 1},
             {8, 6, 4, sample_8, 1},   {16, 6, 4, sample_16, 1}};

static void png_of_every_kind_gives_its_samples(void **state)
{
    (void)state;
    for (size_t n = 0; n < 2 * sizeof kinds / sizeof *kinds; n++) {
        const size_t k = n / 2;
        const png p = {.bits = kinds[k].bits,
                       .color = kinds[k].color,
                       .channels = kinds[k].channels,
                       .interlaced = n % 2,
                       .sample = kinds[k].sample};
        cw_volume v;
        put_png("a.png", &p);
        read_good("a.png", &v);
        assert_string_equal(notes, "");
        assert_true(v.dim[0] == COLUMNS && v.dim[1] == ROWS && v.dim[2] == 1);
        assert_true(v.type == (p.bits == 16 ? CW_U16 : CW_U8) && v.known == 0);
        assert_int_equal(v.components, p.channels);
        for (size_t i = 0; i < COLUMNS * ROWS * v.components; i++) {
            const size_t c = i % v.components, x = i / v.components % COLUMNS,
                         y = i / v.components / COLUMNS;
            assert_true(value_at(&v, x, y, c) == p.sample(x, y, c) * kinds[k].scale);
        }
        cw_volume_free(&v);
    }
}

static void palettes_are_greys_or_numbers(void **state)
{
    (void)state;
    static const unsigned char greys[12] = {0, 0, 0, 40, 40, 40, 90, 90, 90, 200, 200, 200};
    static const unsigned char colors[12] = {0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0, 255};
    png p = {.bits = 2,
             .color = 3,
             .channels = 1,
             .colors = 4,
             .palette = greys,
             .sample = sample_2,
             .per_metre = 5000};
    cw_volume v;
    put_png("a.png", &p);
    read_good("a.png", &v);
    assert_non_null(strstr(notes, "'pHYs' states pixels of 0.2 x 0.2 mm"));
    for (size_t i = 0; i < COLUMNS * ROWS; i++)
        assert_true(value_at(&v, i % COLUMNS, i / COLUMNS, 0) ==
                    greys[3 * sample_2(i % COLUMNS, i / COLUMNS, 0)]);
    cw_volume_free(&v);
    p.palette = colors;
    p.per_metre = 3780;
    put_png("a.png", &p);
    read_good("a.png", &v);
    assert_string_equal(notes, "the palette has colours: values are their numbers in it\n");
    for (size_t i = 0; i < COLUMNS * ROWS; i++)
        assert_true(value_at(&v, i % COLUMNS, i / COLUMNS, 0) ==
                    sample_2(i % COLUMNS, i / COLUMNS, 0));
    cw_volume_free(&v);
    p.colors = 2;
    put_png("a.png", &p);
    check_told("a.png", 0, "a pixel has the colour");
}

/* Decodes the bytes of a file as a texture. */
static cw_status decode(const char *name, cw_image *image, cw_error *err)
{
    size_t size;
    char *all = test_file_read(test_path(name), &size);
    const cw_texture texture = {.bytes = (const uint8_t *)all, .size = size};
    const cw_status st = cw_texture_decode(&texture, NULL, image, err);
    free(all);
    return st;
}

static void textures_have_four_bytes_a_texel(void **state)
{
    (void)state;
    for (size_t n = 0; n < 2 * sizeof kinds / sizeof *kinds; n++) {
        const size_t k = n / 2, channels = (size_t)kinds[k].channels;
        const png p = {.bits = kinds[k].bits,
                       .color = kinds[k].color,
                       .channels = kinds[k].channels,
                       .interlaced = n % 2,
                       .sample = kinds[k].sample};
        cw_image image;
        cw_error err = {0};
        put_png("a.png", &p);
        assert_ok(decode("a.png", &image, &err), err);
        assert_true(image.width == COLUMNS && image.height == ROWS);
        for (size_t i = 0; i < (size_t)COLUMNS * ROWS * 4; i++) {
            const size_t c = i % 4, x = i / 4 % COLUMNS, y = i / 4 / COLUMNS;
            const size_t from = c == 3 ? channels - 1 : channels < 3 ? 0 : c;
            const unsigned value = p.sample(x, y, from) * kinds[k].scale;
            const double wide = p.bits == 16 ? value / 257.0 : value;
            assert_near(image.pixels[i], c == 3 && channels % 2 ? 255 : wide, 0.5001);
        }
        cw_image_free(&image);
    }
}

static void textures_that_cannot_be_decoded_are_told(void **state)
{
    (void)state;
    static const unsigned char colors[6] = {255, 0, 0, 0, 0, 255};
    static const uint8_t jpeg[] = {0xff, 0xd8, 0xff, 0xe0}, other[] = "RIFF....WEBP";
    cw_image image;
    cw_error err = {0};
    const png palette = {.bits = 1,
                         .color = 3,
                         .channels = 1,
                         .colors = 2,
                         .palette = colors,
                         .sample = sample_1};
    put_png("a.png", &palette);
    assert_int_equal(decode("a.png", &image, &err), CW_ERR_UNSUPPORTED);
    assert_non_null(strstr(err.message, "palette"));
    const cw_texture none = {0}, of_jpeg = {jpeg, sizeof jpeg},
                     of_other = {other, sizeof other};
    assert_fails(cw_texture_decode(&none, NULL, &image, &err), CW_ERR_ARGUMENT, "no picture",
                 err);
    assert_fails(cw_texture_decode(&of_jpeg, NULL, &image, &err), CW_ERR_UNSUPPORTED, "JPEG",
                 err);
    assert_fails(cw_texture_decode(&of_other, NULL, &image, &err), CW_ERR_UNSUPPORTED, "no PNG",
                 err);
    put_png("a.png", &(png){.bits = 8, .color = 2, .channels = 3, .sample = sample_8});
    size_t size;
    char *all = test_file_read(test_path("a.png"), &size);
    for (size_t cut = 8; cut + 12 < size; cut += 7) { /* the last chunk may be missing */
        const cw_texture part = {(const uint8_t *)all, cut};
        assert_int_equal(cw_texture_decode(&part, NULL, &image, &err), CW_ERR_FORMAT);
        assert_null(image.pixels);
    }
    memcpy(all + 16, "\0\0\x4e\x20\0\0\x4e\x20", 8); /* 20000 x 20000 */
    const cw_texture huge = {(const uint8_t *)all, size};
    assert_true(cw_texture_decode(&huge, NULL, &image, &err) != CW_OK && !image.pixels);
    for (long n = 0;; n++) {
        put_png("a.png", &(png){.bits = 16, .color = 6, .channels = 4, .sample = sample_16});
        char *whole = test_file_read(test_path("a.png"), &size);
        const cw_texture texture = {(const uint8_t *)whole, size};
        cwi_alloc_fail_after(n);
        const cw_status st =
            cw_texture_decode(&texture, &(cw_mesh_read_desc){.no_sandbox = true}, &image, &err);
        free(whole);
        if (!cwi_alloc_fail_after(-1)) {
            assert_ok(st, err);
            cw_image_free(&image);
            break;
        }
        assert_int_equal(st, CW_ERR_NO_MEMORY);
    }
    free(all);
}

/* --- BMP ---------------------------------------------------------------------------------- */

static void put_small(bytes *b, uint32_t value, int size)
{
    for (int i = 0; i < size; i++)
        b->at[b->size++] = (unsigned char)(value >> 8 * i);
}

/* Writes a picture of mixed pixels. */
static void put_bmp(const char *name, int bits, uint32_t header, bool from_top,
                    const uint32_t *masks, const unsigned char *palette)
{
    const bool is_old = header == 12;
    const size_t colors = bits <= 8 ? (size_t)1 << bits : 0, step = is_old ? 3 : 4;
    const size_t start = 14 + header + (masks && header == 40 ? 12 : 0) + colors * step;
    bytes b = {.size = 0};
    memcpy(b.at, "BM", 2);
    b.size = 10;
    put_small(&b, (uint32_t)start, 4);
    put_small(&b, header, 4);
    put_small(&b, COLUMNS, is_old ? 2 : 4);
    put_small(&b, from_top ? (uint32_t)-ROWS : ROWS, is_old ? 2 : 4);
    put_small(&b, 1, 2);
    put_small(&b, (uint32_t)bits, 2);
    if (!is_old)
        put_small(&b, masks ? 3 : 0, 4);
    b.size = 54;
    for (int c = 0; masks && c < 4; c++)
        put_small(&b, masks[c], 4);
    b.size = 14 + header + (masks && header == 40 ? 12 : 0);
    for (size_t i = 0; i < colors; i++, b.size += step)
        for (size_t c = 0; c < 3; c++)
            b.at[b.size + 2 - c] =
                palette ? palette[3 * i + c] : (unsigned char)(i * 255 / (colors - 1));
    assert_true(b.size == start);
    for (size_t row = 0; row < ROWS; row++) {
        const size_t y = from_top ? row : ROWS - 1 - row, line = b.size;
        for (size_t x = 0; x < COLUMNS; x++) {
            const uint32_t pixel = mixed(x, y, 0) >> 3;
            if (bits >= 8)
                put_small(&b, pixel, bits / 8);
            else
                b.at[line + x * (size_t)bits / 8] |=
                    (unsigned char)((pixel & ((1u << bits) - 1))
                                    << (8 - (size_t)bits * (x % (8 / (size_t)bits) + 1)));
        }
        b.size = line + ((size_t)COLUMNS * (size_t)bits + 31) / 32 * 4;
    }
    put_file(name, "", b.at, b.size);
}

static void bmp_of_every_kind_gives_its_samples(void **state)
{
    (void)state;
    static const uint32_t usual_16[4] = {0x7c00, 0x3e0, 0x1f},
                          usual_32[4] = {0xff0000, 0xff00, 0xff};
    static const uint32_t wide[4] = {0xf800, 0x7e0, 0x1f, 0},
                          ten[4] = {0x3ff, 0xffc00, 0x3ff00000, 0xc0000000};
    static const struct {
        int bits;
        uint32_t header;
        const uint32_t *masks; /* in the file */
        const uint32_t *means; /* NULL: a palette of greys */
        size_t samples;
    } cases[] = {{1, 12, NULL, NULL, 1},       {4, 40, NULL, NULL, 1},
                 {8, 40, NULL, NULL, 1},       {8, 124, NULL, NULL, 1},
                 {16, 40, NULL, usual_16, 3},  {16, 40, wide, wide, 3},
                 {24, 12, NULL, usual_32, 3},  {24, 40, NULL, usual_32, 3},
                 {32, 108, NULL, usual_32, 3}, {32, 40, usual_32, usual_32, 3},
                 {32, 124, ten, ten, 4}};
    for (size_t n = 0; n < 2 * sizeof cases / sizeof *cases; n++) {
        const size_t k = n / 2;
        const bool from_top = n % 2 && cases[k].header > 12;
        cw_volume v;
        put_bmp("a.bmp", cases[k].bits, cases[k].header, from_top, cases[k].masks, NULL);
        read_good("a.bmp", &v);
        assert_true(v.dim[0] == COLUMNS && v.dim[1] == ROWS && v.type == CW_U8);
        assert_int_equal(v.components, cases[k].samples);
        for (size_t i = 0; i < COLUMNS * ROWS * v.components; i++) {
            const size_t c = i % v.components, x = i / v.components % COLUMNS,
                         y = i / v.components / COLUMNS;
            const uint32_t pixel = mixed(x, y, 0) >> 3;
            const uint32_t mask =
                cases[k].means ? cases[k].means[c] : (uint32_t)((1ULL << cases[k].bits) - 1);
            const int shift = __builtin_ctz(mask);
            const uint64_t expected =
                (uint64_t)((pixel & mask) >> shift) * 255 / (mask >> shift);
            if (value_at(&v, x, y, c) != (double)expected)
                fail_msg("case %zu: pixel %zu, %zu, %zu is %g, not %d", k, x, y, c,
                         value_at(&v, x, y, c), (int)expected);
        }
        cw_volume_free(&v);
    }
    static const unsigned char colors[6] = {255, 0, 0, 0, 0, 255};
    cw_volume v;
    put_bmp("a.bmp", 1, 40, false, NULL, colors);
    read_good("a.bmp", &v);
    assert_non_null(strstr(notes, "values are their numbers"));
    assert_true(value_at(&v, 2, 1, 0) == (mixed(2, 1, 0) >> 3 & 1));
    cw_volume_free(&v);
}

/* --- slices ------------------------------------------------------------------------------- */

static unsigned tens;

static unsigned sample_tens(size_t x, size_t y, size_t c)
{
    (void)y, (void)c;
    return tens + (unsigned)x;
}

static const png slice = {.bits = 8, .color = 0, .channels = 1, .sample = sample_tens};

static void files_are_slices_in_the_order_of_their_numbers(void **state)
{
    (void)state;
    static const char *const names[] = {"s/z_-1.png", "s/z_0.png", "s/z_1.png", "s/z_2.png"};
    cw_volume v;
    cw_error err = {0};
    mkdir(test_path("s"), 0700);
    for (unsigned n = 0; n < 4; n++) {
        tens = 10 * n;
        put_png(names[n], &slice);
    }
    put_file("s/about.txt", "no picture", NULL, 0);
    read_good("s", &v);
    assert_string_equal(notes, "left out, because they are not PNG: 1 of its files\n");
    assert_true(v.dim[2] == 4 && cw_volume_value(&v, 3, 2, 2) == 23);
    cw_volume_free(&v);
    check_regions("s", NULL);
    assert_ok(read_with("s/z_*.png", (cw_read_desc){.spacing_mm = {1, 1, 2}}, &v, &err), err);
    check_affine(&v, (const double[12]){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2, 0});
    cw_volume_free(&v);
    assert_int_equal(remove(test_path("s/z_1.png")), 0);
    assert_fails(read_with("s", (cw_read_desc){0}, &v, &err), CW_ERR_UNSAFE, "", err);
    assert_ok(read_with("s", (cw_read_desc){.gaps = CW_GAPS_INTERPOLATE}, &v, &err), err);
    assert_true(v.dim[2] == 4 && cw_volume_value(&v, 0, 0, 2) == 20);
    cw_volume_free(&v);
    const png other = {.bits = 16, .color = 0, .channels = 1, .sample = sample_16};
    put_png("s/z_1.png", &other);
    assert_fails(read_with("s", (cw_read_desc){0}, &v, &err), CW_ERR_FORMAT,
                 "z_1.png: it is 5 x 3, 1 x u16; the first is 5 x 3, 1 x u8", err);
}

/* Checks both formats cut behind every byte; and sizes that no file can hold. */
static void damaged_files_are_told(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    size_t size;
    put_png("a.png", &(png){.bits = 8, .color = 2, .channels = 3, .sample = sample_8});
    check_every_cut("a.png");
    char *all = test_file_read(test_path("a.png"), &size);
    all[50] ^= 1; /* in the pixels */
    test_file_write(test_path("a.png"), all, size);
    check_told("a.png", 0, "the PNG cannot be read");
    bytes b = {.size = 8};
    memcpy(b.at, "\x89PNG\r\n\x1a\n", 8);
    put_chunk(&b, "IHDR", "\0\0\xff\xff\0\0\xff\xff\x08\0\0\0\0", 13);
    put_chunk(&b, "IDAT", "", 0);
    put_file("a.png", "", b.at, b.size);
    check_told("a.png", 1, "65535 x 65535 pixels are more than");
    put_bmp("a.bmp", 24, 40, false, NULL, NULL);
    char *bmp = test_file_read(test_path("a.bmp"), &size);
    for (size_t cut = 26; cut < size; cut += 3) {
        test_file_write(test_path("a.bmp"), bmp, cut);
        assert_int_equal(read_back("a.bmp", &v, &err), CW_ERR_FORMAT);
    }
    const struct {
        size_t at;
        const char *bytes, *words;
    } cases[] = {
        {18, "\xff\xff\xff\x7f", "the file has"}, {18, "\0\0\0\0", "it has 0 x 3"},
        {28, "\x05\0\0\0", "it has 5 bits"},      {30, "\x01\0\0\0", "compression is 1 (run"},
        {10, "\xff\xff\xff\xff", "the file has"}, {22, "\0\0\0\x80", "pixels"}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        char copy[200];
        assert_true(size < sizeof copy);
        memcpy(copy, bmp, size);
        memcpy(copy + cases[n].at, cases[n].bytes, cases[n].at == 28 ? 2 : 4);
        test_file_write(test_path("a.bmp"), copy, size);
        check_told("a.bmp", 2 + n, cases[n].words);
    }
    free(all);
    free(bmp);
}

static void running_out_of_memory_is_an_error(void **state)
{
    (void)state;
    put_png(
        "a.png",
        &(png){.bits = 8, .color = 6, .channels = 4, .interlaced = true, .sample = sample_8});
    check_starved("a.png", &(cw_read_desc){.no_sandbox = true});
    put_bmp("a.bmp", 24, 40, false, NULL, NULL);
    check_starved("a.bmp", &(cw_read_desc){.no_sandbox = true});
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)

int main(void)
{
    static const struct CMUnitTest tests[] = {
        TEST(png_of_every_kind_gives_its_samples),
        TEST(palettes_are_greys_or_numbers),
        TEST(textures_have_four_bytes_a_texel),
        TEST(textures_that_cannot_be_decoded_are_told),
        TEST(bmp_of_every_kind_gives_its_samples),
        TEST(files_are_slices_in_the_order_of_their_numbers),
        TEST(damaged_files_are_told),
        TEST(running_out_of_memory_is_an_error),
    };
    if (!cwi_module_present("picture")) {
        puts("this build reads no pictures");
        return 0;
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
