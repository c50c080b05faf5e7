/* DICOM read: every kind of pixel. */
#include "support/files/dicom_cases.h"

/* --- pixels ------------------------------------------------------------------------------ */

static void every_kind_of_pixel_is_read(void **state)
{
    (void)state;
    uint16_t words[PIXELS];
    uint8_t bytes[3 * PIXELS];
    uint32_t longs[PIXELS];
    double signed_words[PIXELS], twelve[PIXELS], plain[3 * PIXELS], turned[3 * PIXELS],
        bits32[PIXELS];
    for (int n = 0; n < PIXELS; n++) {
        words[n] =
            (uint16_t)(0xf000u + 300u * (unsigned)n); /* overlays on top of twelve bits */
        signed_words[n] = (int16_t)words[n];
        twelve[n] = (words[n] & 0xfff) - (words[n] & 0x800 ? 0x1000 : 0);
        longs[n] = 70000u * (unsigned)n;
        bits32[n] = longs[n];
    }
    for (int n = 0; n < 3 * PIXELS; n++) {
        bytes[n] = (uint8_t)(7 * n);
        plain[n] = bytes[n];
        turned[3 * (n % PIXELS) + n / PIXELS] = bytes[n];
    }
    for (int s = TEST_DICOM_EXPLICIT; s <= TEST_DICOM_BIG_ENDIAN; s++) {
        const test_dicom_syntax syntax = (test_dicom_syntax)s;
        assert_pixels(&(test_image){.syntax = syntax, .is_signed = true, .pixels = words},
                      signed_words, CW_I16);
        assert_pixels(
            &(test_image){.syntax = syntax, .is_signed = true, .stored = 12, .pixels = words},
            twelve, CW_I16);
    }
    assert_pixels(&(test_image){.bits = 8, .pixels = bytes}, plain, CW_U8);
    assert_pixels(&(test_image){.bits = 32, .pixels = longs}, bits32, CW_U32);
    assert_pixels(&(test_image){.bits = 8, .samples = 3, .pixels = bytes}, plain, CW_U8);
    assert_pixels(&(test_image){.bits = 8, .samples = 3, .by_plane = true, .pixels = bytes},
                  turned, CW_U8);
}

static void slices_with_a_scale_each_become_values(void **state)
{
    (void)state;
    static const char *const slopes[] = {"0.5", "0.25", "2.125"};
    const double factor[] = {0.5, 0.25, 2.125};
    for (int n = 0; n < 3; n++) {
        char name[16], position[16];
        snprintf(name, sizeof name, "%d", n);
        snprintf(position, sizeof position, "0\\0\\%d", n);
        test_image_write(&(test_image){.instance = n,
                                       .position = position,
                                       .slope = slopes[n],
                                       .intercept = "-3",
                                       .padding = "11"},
                         name);
    }
    cw_volume v = read_all(NULL);
    assert_int_equal(v.type, CW_F32);
    for (size_t k = 0; k < 3; k++)
        for (size_t n = 0; n < PIXELS; n++) {
            const double value = cw_volume_value(&v, n % COLUMNS, n / COLUMNS, k);
            if (n == 11)
                assert_true(isnan(value));
            else
                assert_near(value, factor[k] * (double)n - 3, 0);
        }
    cw_volume_free(&v);
}

/* Two slices are missing between slices of different scales: values are interpolated, not pixels. */
static void slices_between_scales_are_made_of_values(void **state)
{
    (void)state;
    static const char *const slopes[] = {"0.5", "0.25", "2.125"}, *const intercepts[] = {
                                                                      "-3", "8", "-100"};
    static const int positions[] = {0, 1, 4};
    const double factor[] = {0.5, 0.25, 2.125}, start[] = {-3, 8, -100};
    for (int n = 0; n < 3; n++) {
        char name[16], position[16];
        snprintf(name, sizeof name, "%d", n);
        snprintf(position, sizeof position, "0\\0\\%d", positions[n]);
        test_image_write(&(test_image){.instance = n,
                                       .position = position,
                                       .slope = slopes[n],
                                       .intercept = intercepts[n],
                                       .padding = "11"},
                         name);
    }
    const cw_read_desc desc = {.gaps = CW_GAPS_INTERPOLATE};
    cw_volume v = read_all(&desc);
    assert_int_equal(v.dim[2], 5);
    for (size_t k = 0; k < 5; k++)
        for (size_t n = 0; n < PIXELS; n++) {
            const double value = cw_volume_value(&v, n % COLUMNS, n / COLUMNS, k);
            const size_t low = k < 1 ? k : 1;
            const double share = k < 1 ? 0 : (double)(k - 1) / 3,
                         below = factor[low] * (double)n + start[low],
                         above = factor[2] * (double)n + start[2];
            if (n == 11)
                assert_true(isnan(value));
            else
                assert_near(value, below + share * (above - below), 1e-4);
        }
    cw_volume_free(&v);
    check_regions("", &desc);
}

static void padding_is_no_data(void **state)
{
    (void)state;
    cw_volume v;
    cw_statistics s;
    cw_error err = {0};
    test_image_write(&(test_image){.is_signed = true, .padding = "2", .padding_limit = "5"},
                     "p");
    assert_ok(read_back("p", &v, &err), err);
    assert_true(v.has_nodata);
    assert_ok(cw_volume_statistics(&v, 0, 1, &s, &err), err);
    assert_int_equal(s.nodata, 4);
    assert_int_equal(s.finite, 8);
    cw_volume_free(&v);
}

/* A slice between two others has no value where one of them has none. */
static void padding_of_either_neighbour_is_no_data(void **state)
{
    (void)state;
    static const int positions[] = {0, 1, 3, 4};
    static const uint8_t padded[] = {99, 5, 6, 99}; /* the pixel; 99: none */
    for (int n = 0; n < 4; n++) {
        char name[16], position[16];
        uint16_t pixels[PIXELS];
        for (unsigned i = 0; i < PIXELS; i++)
            pixels[i] = i == padded[n] ? 1000 : 10;
        snprintf(name, sizeof name, "%d", n);
        snprintf(position, sizeof position, "0\\0\\%d", positions[n]);
        test_image_write(
            &(test_image){
                .instance = n, .position = position, .padding = "1000", .pixels = pixels},
            name);
    }
    cw_volume v = read_all(&(cw_read_desc){.gaps = CW_GAPS_INTERPOLATE});
    assert_int_equal(v.dim[2], 5);
    for (size_t i = 0; i < PIXELS; i++) {
        const double value = cw_volume_value(&v, i % COLUMNS, i / COLUMNS, 2);
        const bool lost = v.has_nodata ? value == v.nodata : isnan(value);
        assert_true(lost ? i == 5 || i == 6 : value == 10);
        assert_true(lost || (i != 5 && i != 6));
    }
    cw_volume_free(&v);
}

/* Two images at each of two places, which are known to a thousandth of a pixel. The first key
 * is the same for all and so orders nothing. */
static void a_key_that_is_the_same_for_all_orders_nothing(void **state)
{
    (void)state;
    static const char *const positions[] = {"0\\0\\0", "0\\0\\0.0004", "0\\0\\2.0004",
                                            "0\\0\\2"};
    char notes[512] = "";
    const cw_read_desc desc = {.note = notes_keep, .note_user = notes};
    for (int n = 0; n < 4; n++) {
        char name[16];
        snprintf(name, sizeof name, "%d", n);
        test_image_write(&(test_image){.instance = n, .position = positions[n], .trigger = "7"},
                         name);
    }
    cw_volume v = read_all(&desc);
    assert_int_equal(v.steps, 2);
    assert_int_equal(v.dim[2], 2);
    assert_non_null(strstr(notes, "in the order of InstanceNumber"));
    cw_volume_free(&v);
}

/* Slices with scales of their own: 32 bits need doubles, 16 bits fit floats. */
static void values_of_long_pixels_are_doubles(void **state)
{
    (void)state;
    for (unsigned bits = 16; bits <= 32; bits += 16) {
        uint32_t pixels[PIXELS];
        for (unsigned i = 0; i < PIXELS; i++)
            pixels[i] = 16777217;
        for (int n = 0; n < 2; n++)
            test_image_write(&(test_image){.instance = n,
                                           .bits = bits,
                                           .position = n ? "0\\0\\1" : "0\\0\\0",
                                           .slope = n ? "2" : "1",
                                           .intercept = "0",
                                           .pixels = bits == 32 ? pixels : NULL},
                             n ? "1" : "0");
        cw_volume v = read_all(NULL);
        assert_int_equal(v.type, bits == 32 ? CW_F64 : CW_F32);
        assert_true(cw_volume_value(&v, 1, 0, 1) == (bits == 32 ? 2 * 16777217.0 : 2));
        cw_volume_free(&v);
    }
}

/* A byte n > 128 repeats the next one 257 - n times. */
static void runs_are_read(void **state)
{
    (void)state;
    test_dicom d;
    unsigned char rle[64 + 4] = {1, 0, 0, 0, 64}; /* one segment, behind 64 bytes */
    const unsigned char runs[4] = {257 - 10, 200, 257 - 2, 7};
    cw_volume v;
    cw_error err = {0};
    memcpy(rle + 64, runs, 4);
    test_image_make(&(test_image){.syntax = TEST_DICOM_RLE, .bits = 8}, &d);
    test_dicom_open_fragments(&d);
    test_dicom_fragment(&d, rle, sizeof rle);
    test_dicom_close_sequence(&d);
    test_file_write(test_path("rle.dcm"), d.bytes, d.size);
    test_dicom_free(&d);
    assert_ok(read_back("rle.dcm", &v, &err), err);
    for (size_t n = 0; n < PIXELS; n++)
        assert_near(cw_volume_value(&v, n % COLUMNS, n / COLUMNS, 0), n < 10 ? 200 : 7, 0);
    cw_volume_free(&v);
}

/* Encodes the bytes of a frame: a segment for each byte of a sample, the highest first. Returns the size. */
static size_t encode_runs(const unsigned char *pixels, size_t segments, size_t bytes,
                          unsigned char *rle)
{
    size_t size = 64;
    memset(rle, 0, 64);
    rle[0] = (unsigned char)segments;
    for (size_t s = 0; s < segments; s++) {
        const size_t at = s / bytes * bytes + bytes - 1 - s % bytes;
        rle[4 * (s + 1)] = (unsigned char)size;
        rle[4 * (s + 1) + 1] = (unsigned char)(size >> 8);
        rle[size++] = PIXELS - 3; /* as they are, all but two */
        for (size_t n = 0; n < PIXELS - 2; n++)
            rle[size++] = pixels[n * segments + at];
        rle[size++] = 128;                             /* nothing */
        for (size_t n = PIXELS - 2; n < PIXELS; n++) { /* one byte once */
            rle[size++] = 0;
            rle[size++] = pixels[n * segments + at];
        }
        size += size % 2;
    }
    return size;
}

static void write_encoded(unsigned bits, unsigned samples, const unsigned char *rle,
                          size_t size)
{
    test_dicom d;
    test_image_make(&(test_image){.syntax = TEST_DICOM_RLE, .bits = bits, .samples = samples},
                    &d);
    test_dicom_open_fragments(&d);
    test_dicom_fragment(&d, rle, size);
    test_dicom_close_sequence(&d);
    test_file_write(test_path("rle.dcm"), d.bytes, d.size);
    test_dicom_free(&d);
}

static void runs_of_every_layout_are_read(void **state)
{
    (void)state;
    static const unsigned layouts[][2] = {{8, 1}, {16, 1}, {32, 1}, {8, 3}, {16, 3}};
    for (size_t row = 0; row < sizeof layouts / sizeof *layouts; row++) {
        const unsigned bits = layouts[row][0], samples = layouts[row][1];
        const size_t bytes = bits / 8, segments = bytes * samples;
        unsigned char pixels[12 * PIXELS], rle[1024] = {0};
        cw_volume v;
        cw_error err = {0};
        for (size_t n = 0; n < segments * PIXELS; n++)
            pixels[n] = (unsigned char)(37 * n + 11);
        const size_t size = encode_runs(pixels, segments, bytes, rle);
        write_encoded(bits, samples, rle, size);
        assert_ok(read_back("rle.dcm", &v, &err), err);
        assert_memory_equal(v.data, pixels, segments * PIXELS);
        cw_volume_free(&v);
        for (int way = 0; way < 4; way++) { /* a head that lies, and runs that end early */
            unsigned char bad[1024];
            memcpy(bad, rle, sizeof bad);
            if (way == 0)
                bad[0]++;
            else if (way == 1)
                bad[4 * segments] = bad[4 * segments + 1] = 0xff;
            else if (way == 2)
                bad[4] = 60;
            write_encoded(bits, samples, bad, way == 3 ? size - 6 : size);
            assert_fails(read_back("rle.dcm", &v, &err), CW_ERR_FORMAT,
                         way == 3 ? "its run lengths end early"
                                  : "does not count and place its segments",
                         err);
        }
    }
}

/* Writes a slice of runs, with too many segments if it is damaged. */
static void write_runs(int instance, bool damaged)
{
    test_dicom d;
    unsigned char rle[64 + 2] = {1, 0, 0, 0, 64, [64] = 257 - PIXELS, 9};
    char name[16], position[32];
    snprintf(name, sizeof name, "%d.dcm", instance);
    snprintf(position, sizeof position, "0\\0\\%d", instance);
    test_image_make(
        &(test_image){
            .syntax = TEST_DICOM_RLE, .bits = 8, .instance = instance, .position = position},
        &d);
    if (damaged)
        rle[0] = 20;
    test_dicom_open_fragments(&d);
    test_dicom_fragment(&d, rle, sizeof rle);
    test_dicom_close_sequence(&d);
    test_file_write(test_path(name), d.bytes, d.size);
    test_dicom_free(&d);
}

/* The head of a file says nothing of damage within compressed pixels. */
static void damaged_runs_are_left_out_if_that_is_asked_for(void **state)
{
    (void)state;
    for (int n = 0; n < 5; n++)
        write_runs(n, n == 2);
    assert_refused(NULL, CW_ERR_FORMAT, "2.dcm: ");
    assert_refused(NULL, CW_ERR_FORMAT, "; desc->skip_damaged leaves such files out");
    assert_refused(&(cw_read_desc){.skip_damaged = true}, CW_ERR_UNSAFE, "1 slice is missing");
    cw_volume v = read_all(&(cw_read_desc){.skip_damaged = true, .gaps = CW_GAPS_INTERPOLATE});
    assert_int_equal(v.dim[2], 5);
    assert_near(cw_volume_value(&v, 3, 2, 2), 9, 0);
    cw_volume_free(&v);
}

/* Deflated pixels, from less than a block of a megabyte to several, dull ones and noise. */
static void deflated_pixels_of_any_size_are_read(void **state)
{
    (void)state;
    static const unsigned sides[] = {5, 1023, 1024, 1500};
    for (size_t n = 0; n < sizeof sides / sizeof *sides; n++)
        for (int noisy = 0; noisy < 2; noisy++) {
            const size_t count = (size_t)sides[n] * sides[n];
            uint16_t *pixels = malloc(count * sizeof *pixels);
            uint32_t seed = 1;
            test_dicom d;
            cw_error err = {0};
            cw_volume v;
            assert_non_null(pixels);
            for (size_t i = 0; i < count; i++) {
                seed = seed * 1664525 + 1013904223;
                pixels[i] = (uint16_t)(noisy ? seed >> 16 : i >> 10);
            }
            test_image_make(&(test_image){.syntax = TEST_DICOM_DEFLATED,
                                          .columns = sides[n],
                                          .rows = sides[n],
                                          .pixels = pixels},
                            &d);
            test_dicom_deflate(&d);
            test_file_write(test_path("d.dcm"), d.bytes, d.size);
            test_dicom_free(&d);
            assert_ok(read_back("d.dcm", &v, &err), err);
            assert_memory_equal(v.data, pixels, count * sizeof *pixels);
            cw_volume_free(&v);
            free(pixels);
        }
}

/* --- slices whose pixels have other types ------------------------------------------------- */

typedef struct typed_slice {
    unsigned bits, stored;
    bool is_signed;
    long first; /* pixel n is first + n */
    const char *slope, *padding;
} typed_slice;

static void write_typed(int n, const typed_slice *t)
{
    char name[16], position[16];
    unsigned char pixels[4 * PIXELS];
    for (int i = 0; i < PIXELS; i++) {
        const uint32_t value = (uint32_t)(t->first + i);
        memcpy(pixels + (size_t)i * t->bits / 8, &value, t->bits / 8);
    }
    snprintf(name, sizeof name, "%d", n);
    snprintf(position, sizeof position, "0\\0\\%d", 2 * n);
    test_image_write(&(test_image){.instance = n,
                                   .position = position,
                                   .bits = t->bits,
                                   .stored = t->stored,
                                   .is_signed = t->is_signed,
                                   .slope = t->slope,
                                   .padding = t->padding,
                                   .pixels = pixels},
                     name);
}

/* Sign, bits and padding may change from slice to slice: numbers are what they are. */
static void slices_of_other_types_are_one_series(void **state)
{
    (void)state;
    static const struct {
        typed_slice slices[3];
        cw_type type;
    } rows[] = {
        {{{16, 16, false, 10, 0, 0}, {16, 16, true, -7, 0, 0}, {16, 16, false, 65000, 0, 0}},
         CW_I32},
        {{{16, 12, false, 4000, 0, 0}, {16, 16, true, -3000, 0, 0}, {16, 12, false, 0, 0, 0}},
         CW_I16},
        {{{8, 8, false, 200, 0, 0}, {16, 10, false, 900, 0, 0}, {8, 8, false, 3, 0, 0}},
         CW_U16},
        {{{8, 8, false, 200, 0, 0}, {8, 8, true, -100, 0, 0}, {8, 8, false, 3, 0, 0}}, CW_I16},
        {{{8, 7, false, 100, 0, 0}, {8, 8, true, -100, 0, 0}, {8, 7, false, 3, 0, 0}}, CW_I8},
        {{{32, 32, false, 4000000000, 0, 0},
          {16, 16, true, -5, 0, 0},
          {32, 32, false, 1, 0, 0}},
         CW_F64},
        {{{16, 16, false, 10, "2", 0}, {16, 16, true, -7, "0.5", 0}, {8, 8, false, 3, "1", 0}},
         CW_F32},
        {{{16, 16, false, 10, 0, "12"}, {16, 16, true, -7, 0, "-3"}, {16, 16, false, 9, 0, 0}},
         CW_F32},
        {{{16, 16, true, 10, 0, "12"}, {16, 16, true, -7, 0, 0}, {16, 16, true, 5, 0, "12"}},
         CW_F32},
        {{{16, 16, true, 10, 0, "12"}, {8, 8, true, -7, 0, "12"}, {16, 16, true, 5, 0, "12"}},
         CW_I16},
    };
    for (size_t row = 0; row < sizeof rows / sizeof *rows; row++) {
        for (int n = 0; n < 3; n++)
            write_typed(n, &rows[row].slices[n]);
        cw_volume v = read_all(NULL);
        if (v.type != rows[row].type || v.dim[2] != 3)
            fail_msg("row %zu: %zu slices of %s, not 3 of %s", row, v.dim[2],
                     cw_type_name(v.type), cw_type_name(rows[row].type));
        for (size_t k = 0; k < 3; k++)
            for (size_t n = 0; n < PIXELS; n++) {
                const typed_slice *t = &rows[row].slices[k];
                const double value = cw_volume_value(&v, n % COLUMNS, n / COLUMNS, k);
                const long pixel = t->first + (long)n;
                if (!t->padding || atol(t->padding) != pixel)
                    assert_near(value, (double)pixel * (t->slope ? atof(t->slope) : 1), 0);
                else if (v.type == CW_F32)
                    assert_true(isnan(value));
                else
                    assert_true(v.has_nodata && value == v.nodata);
            }
        cw_volume_free(&v);
        check_regions("", NULL);
    }
}

/* A slice made between others of other types is a blend of their numbers. */
static void slices_between_types_are_made_of_values(void **state)
{
    (void)state;
    write_typed(0, &(typed_slice){16, 12, false, 4000, 0, 0});
    write_typed(1, &(typed_slice){16, 16, true, -4000, 0, 0});
    write_typed(3, &(typed_slice){8, 8, false, 0, 0, 0});
    const cw_read_desc desc = {.gaps = CW_GAPS_INTERPOLATE};
    cw_volume v = read_all(&desc);
    assert_int_equal(v.dim[2], 4);
    for (size_t n = 0; n < PIXELS; n++)
        assert_near(cw_volume_value(&v, n % COLUMNS, n / COLUMNS, 2), -2000 + (double)n, 0.5);
    cw_volume_free(&v);
    check_regions("", &desc);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(every_kind_of_pixel_is_read),
        TEST(slices_with_a_scale_each_become_values),
        TEST(slices_between_scales_are_made_of_values),
        TEST(padding_is_no_data),
        TEST(padding_of_either_neighbour_is_no_data),
        TEST(a_key_that_is_the_same_for_all_orders_nothing),
        TEST(values_of_long_pixels_are_doubles),
        TEST(slices_of_other_types_are_one_series),
        TEST(slices_between_types_are_made_of_values),
        TEST(deflated_pixels_of_any_size_are_read),
        TEST(runs_are_read),
        TEST(runs_of_every_layout_are_read),
        TEST(damaged_runs_are_left_out_if_that_is_asked_for),
    };
    if (!cwi_module_present("dicom")) {
        print_message("this build reads no DICOM\n");
        return 0;
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
