/* DICOM read: tables that turn stored pixels into values. */
#include "support/files/dicom_multiframe.h"

/* Entries of words and bytes, in the order of a little-endian file. */
static const uint16_t words[4] = {0, 100, 40000, 7};
static const uint8_t bytes[4] = {0, 100, 250, 7};

/* The value of a pixel whose table begins at `first`. */
static double word_at(int pixel, int first)
{
    const int at = pixel - first;
    return words[at < 0 ? 0 : at > 3 ? 3 : at];
}

static void tables_replace_slope_and_intercept(void **state)
{
    (void)state;
    for (int syntax = TEST_DICOM_EXPLICIT; syntax <= TEST_DICOM_IMPLICIT; syntax++)
        for (int way = 0; way < 3; way++) {
            static const int firsts[] = {0, 3, -2};
            const test_lookup table = {{4, (uint16_t)firsts[way], 16},
                                       way ? "HU" : NULL,
                                       way == 2 ? "OW" : "US",
                                       words,
                                       sizeof words};
            int16_t pixels[PIXELS];
            double expected[PIXELS];
            for (int n = 0; n < PIXELS; n++) {
                pixels[n] = (int16_t)(n - 4);
                expected[n] = word_at(n - 4, firsts[way]);
            }
            const test_image image = {.syntax = (test_dicom_syntax)syntax,
                                      .is_signed = true,
                                      .slope = "2",
                                      .intercept = "-1000",
                                      .lookup = &table,
                                      .pixels = pixels};
            assert_pixels(&image, expected, CW_U16);
            cw_volume v = read_all(NULL);
            assert_true(v.slope == 1 && v.intercept == 0);
            assert_int_equal(v.known & CW_KNOWN_HOUNSFIELD, way ? CW_KNOWN_HOUNSFIELD : 0);
            cw_volume_free(&v);
        }
}

/* Entries of 8 bits are packed, or have a word each; 0 entries stand for 65536. */
static void entries_of_a_table_have_8_or_16_bits(void **state)
{
    (void)state;
    static const uint16_t spread[4] = {0, 100, 250, 7};
    static uint16_t whole[65536];
    const test_lookup tables[] = {{{4, 1, 8}, NULL, "OW", bytes, sizeof bytes},
                                  {{4, 1, 8}, NULL, "US", spread, sizeof spread},
                                  {{0, 0, 16}, NULL, "OW", whole, sizeof whole}};
    double expected[PIXELS];
    for (int way = 0; way < 3; way++) {
        for (int n = 0; n < PIXELS; n++)
            expected[n] = way == 2 ? 65535 - n : bytes[n < 1 ? 0 : n > 4 ? 3 : n - 1];
        for (int n = 0; n < 65536; n++)
            whole[n] = (uint16_t)(65535 - n);
        assert_pixels(&(test_image){.bits = way == 1 ? 8 : 16, .lookup = &tables[way]},
                      expected, way == 2 ? CW_U16 : CW_U8);
    }
}

/* Padding is a stored pixel: it has no value, whatever the table has for it. */
static void padding_is_looked_up_in_no_table(void **state)
{
    (void)state;
    static const char *const limits[] = {NULL, "3", "0"};
    const test_lookup table = {{4, 0, 16}, NULL, "US", words, sizeof words};
    for (int way = 0; way < 3; way++) {
        test_image_write(
            &(test_image){.lookup = &table, .padding = "2", .padding_limit = limits[way]},
            "p.dcm");
        cw_volume v = read_all(NULL);
        for (int n = 0; n < PIXELS; n++) {
            const bool lost = n == 2 || (way == 1 && n == 3) || (way == 2 && n < 2);
            const double value =
                cw_volume_value(&v, (size_t)(n % COLUMNS), (size_t)(n / COLUMNS), 0);
            assert_true(v.has_nodata && (value == v.nodata) == lost);
            assert_true(lost || value == word_at(n, 0));
        }
        cw_volume_free(&v);
    }
}

/* Slices of one series may have tables of their own, scales, or neither. */
static void slices_with_and_without_tables_are_one_series(void **state)
{
    (void)state;
    const test_lookup narrow = {{4, 0, 8}, NULL, "OW", bytes, sizeof bytes},
                      wide = {{4, 2, 16}, NULL, "US", words, sizeof words};
    test_image_write(&(test_image){.instance = 1, .lookup = &narrow}, "1.dcm");
    test_image_write(&(test_image){.instance = 2, .position = "0\\0\\2", .lookup = &wide},
                     "2.dcm");
    test_image_write(&(test_image){.instance = 3, .position = "0\\0\\4", .is_signed = true},
                     "3.dcm");
    cw_volume v = read_all(NULL);
    assert_int_equal(v.dim[2], 3);
    for (int n = 0; n < PIXELS; n++) {
        const size_t x = (size_t)(n % COLUMNS), y = (size_t)(n / COLUMNS);
        assert_near(cw_volume_value(&v, x, y, 0), bytes[n < 3 ? n : 3], 0);
        assert_near(cw_volume_value(&v, x, y, 1), word_at(n, 2), 0);
        assert_near(cw_volume_value(&v, x, y, 2), n, 0);
    }
    cw_volume_free(&v);
    check_regions("", NULL);
    test_image_write(&(test_image){.instance = 3, .position = "0\\0\\4", .slope = "0.5"},
                     "3.dcm");
    v = read_all(NULL);
    assert_near(cw_volume_value(&v, 2, 0, 1), 0, 0);
    assert_near(cw_volume_value(&v, 1, 1, 2), 2.5, 0);
    cw_volume_free(&v);
}

/* Frames of one object: the table of all, one of its own, or a scale. */
static void frames_have_tables_of_their_own(void **state)
{
    (void)state;
    const test_lookup all = {{4, 0, 8}, NULL, "OW", bytes, sizeof bytes},
                      own = {{4, 0, 16}, NULL, "US", words, sizeof words};
    for (int with_all = 0; with_all < 2; with_all++) {
        test_dicom d;
        uint8_t pixels[3 * PIXELS];
        for (int n = 0; n < 3 * PIXELS; n++)
            pixels[n] = (uint8_t)(n % PIXELS);
        test_dicom_begin(&d, TEST_DICOM_EXPLICIT);
        test_dicom_text(&d, 0x00080016, "UI", ENHANCED_CT);
        test_dicom_text(&d, 0x0020000e, "UI", "1.2.3");
        put_place(&d, NULL, "1\\0\\0\\0\\1\\0");
        put_sizes(&d, "3", (const uint32_t[MAX_VECTORS]){0}, "1\\1");
        if (with_all)
            test_dicom_put_lookup(&d, &all);
        test_dicom_open_sequence(&d, 0x52009230);
        for (int f = 0; f < 3; f++) {
            static const char *const places[] = {"0\\0\\0", "0\\0\\2", "0\\0\\4"};
            test_dicom_open_item(&d);
            test_dicom_open_sequence(&d, 0x00209113);
            test_dicom_open_item(&d);
            put_place(&d, places[f], NULL);
            test_dicom_close_item(&d);
            test_dicom_close_sequence(&d);
            test_dicom_open_sequence(&d, 0x00289145);
            test_dicom_open_item(&d);
            if (f == 1)
                test_dicom_put_lookup(&d, &own);
            test_dicom_close_item(&d);
            test_dicom_close_sequence(&d);
            test_dicom_close_item(&d);
        }
        test_dicom_close_sequence(&d);
        test_dicom_bytes(&d, 0x7fe00010, "OB", pixels, sizeof pixels);
        test_file_write(test_path("f.dcm"), d.bytes, d.size);
        test_dicom_free(&d);
        cw_volume v = read_all(NULL);
        assert_int_equal(v.type, with_all ? CW_U16 : CW_I32);
        for (int n = 0; n < PIXELS; n++)
            for (size_t k = 0; k < 3; k++)
                assert_near(
                    cw_volume_value(&v, (size_t)(n % COLUMNS), (size_t)(n / COLUMNS), k),
                    k == 1     ? word_at(n, 0)
                    : with_all ? bytes[n < 3 ? n : 3]
                               : n,
                    0);
        cw_volume_free(&v);
    }
}

static void tables_that_cannot_be_read_are_refused(void **state)
{
    (void)state;
    const struct {
        test_lookup table;
        unsigned samples;
        const char *text;
    } rows[] = {
        {{{5, 0, 16}, NULL, "US", words, sizeof words},
         1,
         "fewer entries than LUTDescriptor states"},
        {{{5, 0, 8}, NULL, "OW", bytes, sizeof bytes},
         1,
         "fewer entries than LUTDescriptor states"},
        {{{0, 0, 8}, NULL, "OW", bytes, sizeof bytes},
         1,
         "fewer entries than LUTDescriptor states"},
        {{{4, 0, 4}, NULL, "US", words, sizeof words}, 1, "fewer than 8 or more than 16 bits"},
        {{{4, 0, 32}, NULL, "US", words, sizeof words}, 1, "fewer than 8 or more than 16 bits"},
        {{{4, 0, 16}, NULL, "US", words, sizeof words}, 3, "whole numbers of one sample"},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        test_image_write(&(test_image){.samples = rows[n].samples,
                                       .bits = rows[n].samples > 1 ? 8 : 16,
                                       .lookup = &rows[n].table},
                         "bad.dcm");
        assert_refused(NULL, CW_ERR_FORMAT, rows[n].text);
    }
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(tables_replace_slope_and_intercept),
        TEST(entries_of_a_table_have_8_or_16_bits),
        TEST(padding_is_looked_up_in_no_table),
        TEST(slices_with_and_without_tables_are_one_series),
        TEST(frames_have_tables_of_their_own),
        TEST(tables_that_cannot_be_read_are_refused),
    };
    if (!cwi_module_present("dicom")) {
        print_message("this build reads no DICOM\n");
        return 0;
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
