/* TIFF read: every way to store pixels, pages, and hostile files. */
#include "support/files/tiff_cases.h"

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
        {{.bits = 24}, "'BitsPerSample' is 24 and 'SampleFormat' 1 (unsigned integers); what"},
        {{.bits = 24, .format = 3}, "24 and 'SampleFormat' 3 (floats)"},
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
        {{.description = "{\"shape\": [2, 3, 4"}, "the 'shape' of tifffile was expected"},
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
        check_some_cuts("a.tif", "a.tif", 0, test_is_short() ? 7 : 1);
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
        TEST(thumbnails_and_masks_are_no_slices),
        TEST(pages_that_differ_are_named),
        TEST(what_is_not_read_is_refused_by_name),
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
