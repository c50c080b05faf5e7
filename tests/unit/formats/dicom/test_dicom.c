/* DICOM read: hostile and damaged files, folders, and files of one frame. */
#define _GNU_SOURCE /* symlink */
#include "support/files/dicom_cases.h"

/* --- hostile and damaged ----------------------------------------------------------------- */

static void every_cut_is_an_error(void **state)
{
    (void)state;
    test_image_write(&(test_image){.instance = 1}, "cut.dcm");
    size_t size;
    char *bytes = test_file_read(test_path("cut.dcm"), &size);
    for (int sandbox = 0; sandbox < 2; sandbox++)
        for (size_t cut = 0; cut < size; cut += sandbox ? 37 : 1) {
            const cw_read_desc desc = {.reader = "dicom", .no_sandbox = !sandbox};
            cw_volume v;
            cw_error err = {0};
            test_file_write(test_path("cut.dcm"), bytes, cut);
            if (cw_volume_read(test_path("cut.dcm"), &desc, &v, NULL, &err) == CW_OK)
                fail_msg("%zu of %zu bytes were read", cut, size);
            assert_null(v.data);
        }
    free(bytes);
}

static void sizes_are_held_against_the_file(void **state)
{
    (void)state;
    test_image_write(&(test_image){.rows = 6000, .columns = 6000, .pixel_bytes = 24}, "big");
    assert_refused(NULL, CW_ERR_FORMAT, "'PixelData' holds 24 bytes");
    test_image_write(&(test_image){.rows = 3, .columns = 5, .pixel_bytes = 24}, "big");
    assert_refused(NULL, CW_ERR_FORMAT, "1 frames of 30 bytes");
    const frame one = {"0\\0\\0", NULL, 0};
    uint8_t pixels[PIXELS] = {0};
    write_frames("big", ENHANCED_CT, &one, 1, pixels, sizeof pixels);
    size_t size;
    char *bytes = test_file_read(test_path("big"), &size);
    for (size_t i = 0; i + 10 < size; i++) /* NumberOfFrames */
        if (memcmp(bytes + i, "\x28\0\x08\0IS\x02\0", 8) == 0)
            memcpy(bytes + i + 8, "99", 2);
    test_file_write(test_path("big"), bytes, size);
    free(bytes);
    assert_refused(NULL, CW_ERR_FORMAT, "ask for 99 frames of 12 bytes");
}

/* Sequences within sequences: whoever follows them on a stack, dies. */
static void deep_nesting_is_survived(void **state)
{
    (void)state;
    test_dicom d;
    cw_volume v;
    cw_error err = {0};
    test_dicom_begin(&d, TEST_DICOM_EXPLICIT);
    for (int n = 0; n < 200000; n++) {
        test_dicom_open_sequence(&d, 0x00081140);
        test_dicom_open_item(&d);
    }
    test_file_write(test_path("deep.dcm"), d.bytes, d.size);
    test_dicom_free(&d);
    for (int sandbox = 0; sandbox < 2; sandbox++) {
        const cw_read_desc desc = {.reader = "dicom", .no_sandbox = !sandbox};
        assert_fails(cw_volume_read(test_path("deep.dcm"), &desc, &v, NULL, &err),
                     CW_ERR_FORMAT, "nested", err);
    }
}

/* Zeros make elements of twelve bytes each, and hardly anything when they are deflated. */
static void deflated_files_are_walked_over(void **state)
{
    (void)state;
    test_dicom d;
    cw_volume v;
    cw_error err = {0};
    test_image_make(&(test_image){.syntax = TEST_DICOM_DEFLATED}, &d);
    test_dicom_deflate(&d);
    test_file_write(test_path("d.dcm"), d.bytes, d.size);
    test_dicom_free(&d);
    assert_ok(read_back("d.dcm", &v, &err), err);
    assert_near(cw_volume_value(&v, 3, 1, 0), 7, 0);
    cw_volume_free(&v);

    test_dicom_begin(&d, TEST_DICOM_DEFLATED);
    for (int n = 0; n < 1000; n++) {
        test_dicom_open_sequence(&d, 0x00081140);
        test_dicom_open_item(&d);
    }
    test_dicom_deflate(&d);
    test_file_write(test_path("d.dcm"), d.bytes, d.size);
    test_dicom_free(&d);
    assert_fails(read_back("d.dcm", &v, &err), CW_ERR_FORMAT, "nested deeper than 64", err);

    const size_t many = (size_t)13 << 23;
    test_dicom_begin(&d, TEST_DICOM_DEFLATED);
    d.bytes = realloc(d.bytes, d.size + many);
    assert_non_null(d.bytes);
    memset(d.bytes + d.size, 0, many);
    d.size = d.room = d.size + many;
    test_dicom_deflate(&d);
    test_file_write(test_path("d.dcm"), d.bytes, d.size);
    test_dicom_free(&d);
    assert_fails(read_back("d.dcm", &v, &err), CW_ERR_FORMAT, "more than 8388608 elements",
                 err);
}

static void unknown_syntaxes_are_named(void **state)
{
    (void)state;
    static const struct {
        test_dicom_syntax syntax;
        const char *words;
    } rows[] = {
        {TEST_DICOM_HTJ2K, "syntax 1.2.840.10008.1.2.4.201 (HTJ2K lossless) is not read"},
        {TEST_DICOM_FRAMES_DEFLATED, "1.2.840.10008.1.2.8.1 (frames deflated one by one)"},
        {TEST_DICOM_STRANGE, "syntax 1.2.3.4.5 (unknown) is not read"},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        test_image_write(&(test_image){.syntax = rows[n].syntax}, "u");
        assert_refused(NULL, CW_ERR_FORMAT, rows[n].words);
    }
}

static void frames_are_counted_from_one(void **state)
{
    (void)state;
    static const char *const counts[] = {"-3", "0 ", "1.5", "x "};
    const frame one = {"0\\0\\0", NULL, 0};
    uint8_t pixels[PIXELS] = {0};
    for (size_t n = 0; n < sizeof counts / sizeof *counts; n++) {
        test_dicom d;
        test_dicom_begin(&d, TEST_DICOM_EXPLICIT);
        put_head(&d, ENHANCED_CT, counts[n], 8);
        test_dicom_open_sequence(&d, 0x52009230);
        put_frame(&d, one.position, NULL, 0);
        test_dicom_close_sequence(&d);
        test_dicom_bytes(&d, 0x7fe00010, "OB", pixels, sizeof pixels);
        test_file_write(test_path("n"), d.bytes, d.size);
        test_dicom_free(&d);
        assert_refused(NULL, CW_ERR_FORMAT, "NumberOfFrames is no whole number above 0");
    }
}

/* Explicit or not, and with a meta header or the bare elements. */
static void files_without_a_preamble_are_read(void **state)
{
    (void)state;
    for (int n = 0; n < 4; n++) {
        const test_dicom_syntax syntax = n % 2 ? TEST_DICOM_IMPLICIT : TEST_DICOM_EXPLICIT;
        test_dicom d;
        test_image_make(&(test_image){.syntax = syntax}, &d);
        const size_t left_out = n < 2 ? 132 : d.head;
        test_file_write(test_path("bare"), d.bytes + left_out, d.size - left_out);
        test_dicom_free(&d);
        cw_volume v = read_all(NULL);
        assert_near(cw_volume_value(&v, 3, 1, 0), 7, 0);
        cw_volume_free(&v);
    }
    unsigned char noise[64] = {8,   0, 8, 0, 'C', 'S', 2,   0, 'A',
                               'B', 8, 0, 5, 0,   'C', 'S', 0, 0};
    test_file_write(test_path("bare"), noise, sizeof noise); /* tags that go back */
    assert_refused(NULL, CW_ERR_FORMAT, "none of its 1 files is a slice");
}

/* Writes five slices of a series, of which the first `kept` bytes of the middle one stay; from
 * the end if that is below 0. */
static void write_damaged_row(long kept)
{
    const double even[] = {0, 2.5, 5, 7.5, 10};
    write_row(&upright, even, 5, 0);
    size_t size;
    char *bytes = test_file_read(test_path("88.dcm"), &size);
    test_file_write(test_path("88.dcm"), bytes, kept < 0 ? size - (size_t)-kept : (size_t)kept);
    free(bytes);
}

/* Cut within the pixels or within the head, where the series is not known, or empty. */
static void a_damaged_slice_is_left_out_if_that_is_asked_for(void **state)
{
    (void)state;
    const long kept[] = {-5, 300, 0};
    for (size_t n = 0; n < sizeof kept / sizeof *kept; n++) {
        char notes[512] = "";
        cw_read_desc desc = {.skip_damaged = true, .note = notes_keep, .note_user = notes};
        write_damaged_row(kept[n]);
        assert_refused(NULL, kept[n] ? CW_ERR_FORMAT : CW_ERR_IO, "88.dcm: ");
        assert_refused(NULL, kept[n] ? CW_ERR_FORMAT : CW_ERR_IO,
                       "; desc->skip_damaged leaves such files out");
        assert_refused(&desc, CW_ERR_UNSAFE, "1 slice is missing; the first gap is from 9.5");
        desc.gaps = CW_GAPS_INTERPOLATE;
        *notes = '\0';
        cw_volume v = read_all(&desc);
        assert_int_equal(v.dim[2], 5);
        assert_is_field(&v);
        cw_volume_free(&v);
        assert_non_null(strstr(notes, "left out, because they cannot be read: 88.dcm; "));
    }
}

/* A damaged file counts where it is known to be of the chosen series, or none was chosen. */
static void a_damaged_file_of_another_series_blocks_nothing(void **state)
{
    (void)state;
    cw_series *series;
    size_t count;
    cw_error err = {0};
    for (int known = 0; known < 2; known++) {
        char notes[512] = "";
        const cw_read_desc desc = {.series = "7", .note = notes_keep, .note_user = notes};
        write_damaged_row(known ? -5 : 300);
        for (int n = 0; n < 3; n++) {
            char name[16];
            snprintf(name, sizeof name, "b%d", n);
            write_at(name, 7, n, 2 * n, "1.7");
        }
        cw_volume v = read_all(&desc);
        assert_int_equal(v.dim[2], 3);
        cw_volume_free(&v);
        assert_non_null(strstr(notes, "left out, because they cannot be read: 88.dcm; "));
        assert_refused(&(cw_read_desc){.series = "1.2.3"},
                       known ? CW_ERR_FORMAT : CW_ERR_UNSAFE,
                       known ? "88.dcm: " : "1 slice is missing");
        assert_fails(read_back("89.dcm", &v, &err), known ? CW_ERR_FORMAT : CW_ERR_UNSAFE,
                     known ? "88.dcm: " : "1 slice is missing", err);
        *notes = '\0';
        assert_ok(cw_series_list(test_path(""), &desc, &series, &count, &err), err);
        assert_int_equal(count, 2);
        for (size_t n = 0; n < count; n++)
            assert_int_equal(series[n].status, strcmp(series[n].label, "7") == 0 ? CW_OK
                                               : known                           ? CW_ERR_FORMAT
                                                       : CW_ERR_UNSAFE);
        cw_series_free(series);
        assert_non_null(strstr(notes, "cannot be read: 88.dcm; "));
    }
}

static void folders_without_slices_tell_what_they_hold(void **state)
{
    (void)state;
    static const char nrrd[] = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 1 1 1\n"
                               "encoding: raw\n\n";
    test_file_write(test_path("a.nrrd"), nrrd, sizeof nrrd);
    test_file_write(test_path("b.nrrd"), nrrd, sizeof nrrd);
    test_file_write(test_path("c.txt"), "hello", 5);
    assert_refused(NULL, CW_ERR_FORMAT,
                   "none of its 3 files is a slice; volumes by themselves: 2 (nrrd), name one "
                   "of them, or the steps of a series by a pattern in quotes, '");
    assert_int_equal(symlink("c.txt", test_path("d.dcm")), 0);
    assert_refused(NULL, CW_ERR_FORMAT,
                   "; 1 links were left out, desc->allow_external follows");
}

static void what_is_no_image_is_told(void **state)
{
    (void)state;
    test_dicom d;
    cw_volume v;
    cw_error err = {0};
    test_dicom_begin(&d, TEST_DICOM_EXPLICIT);
    test_dicom_text(&d, 0x00080060, "CS", "SR");
    test_file_write(test_path("report.dcm"), d.bytes, d.size);
    test_dicom_free(&d);
    assert_fails(read_back("report.dcm", &v, &err), CW_ERR_FORMAT, "DICOM without an image",
                 err);
    assert_refused(NULL, CW_ERR_FORMAT, "it holds no DICOM image");
    test_image_write(&(test_image){.samples = 2, .bits = 8}, "report.dcm");
    assert_refused(NULL, CW_ERR_FORMAT, "not stored as RGB");
    test_image_write(&(test_image){.bits = 24}, "report.dcm");
    assert_refused(NULL, CW_ERR_FORMAT, "BitsAllocated is none of 1, 8, 16, 32");
    test_image_write(&(test_image){.slope = "0"}, "report.dcm");
    assert_refused(NULL, CW_ERR_FORMAT, "'RescaleSlope' is 0");
    test_image_write(&(test_image){.orientation = "1\\0\\0\\1\\0\\0"}, "report.dcm");
    assert_refused(NULL, CW_ERR_FORMAT, "right angles");
}

static void links_are_left_out(void **state)
{
    (void)state;
    const double even[] = {0, 2.5, 5};
    write_row(&upright, even, 3, 0);
    assert_int_equal(rename(test_path("90.dcm"), test_path("hidden")), 0);
    assert_int_equal(symlink("hidden", test_path("link.dcm")), 0);
    assert_int_equal(rename(test_path("hidden"), test_path(".hidden")), 0);
    assert_int_equal(unlink(test_path("link.dcm")), 0);
    assert_int_equal(symlink(".hidden", test_path("link.dcm")), 0);
    cw_volume v = read_all(NULL);
    assert_int_equal(v.dim[2], 2);
    cw_volume_free(&v);
    v = read_all(&(cw_read_desc){.allow_external = true});
    assert_int_equal(v.dim[2], 3);
    cw_volume_free(&v);
    char notes[512] = "";
    const cw_read_desc desc = {.note = notes_keep, .note_user = notes};
    cw_error err = {0};
    assert_ok(cw_volume_read(test_path("link.dcm"), &desc, &v, NULL, &err), err); /* named */
    assert_int_equal(v.dim[2], 3);
    cw_volume_free(&v);
    assert_ok(cw_volume_read(test_path("89.dcm"), &desc, &v, NULL, &err), err);
    assert_int_equal(v.dim[2], 2);
    cw_volume_free(&v);
    assert_string_equal(notes, "left out: 1 links; desc->allow_external follows them\n");
    assert_int_equal(unlink(test_path("89.dcm")), 0);
    assert_int_equal(unlink(test_path("88.dcm")), 0);
    assert_refused(NULL, CW_ERR_IO, "no file, only 1 links; desc->allow_external follows them");
    test_file_write(test_path("readme.md"), "hello", 5);
    assert_refused(
        NULL, CW_ERR_FORMAT,
        "none of its 1 files is a slice in a format that is read (DICOM, TIFF, PNG, BMP); 1 "
        "links were left out, desc->allow_external follows them");
}

static void here_or_in_a_sandbox_is_the_same(void **state)
{
    (void)state;
    const double even[] = {0, 2.5, 5};
    write_row(&oblique, even, 3, 0.1);
    cw_volume a = read_all(NULL), b = read_all(&(cw_read_desc){.no_sandbox = true});
    assert_memory_equal(a.data, b.data, 3 * PIXELS * sizeof(int16_t));
    assert_memory_equal(a.affine, b.affine, sizeof a.affine);
    cw_volume_free(&a);
    cw_volume_free(&b);
}

/* Of plain slices, made ones, values, steps and labels. */
static void regions_are_crops(void **state)
{
    (void)state;
    const double gap[] = {0, 2.5, 7.5, 10};
    write_row(&oblique, gap, 4, 0.1);
    check_regions("", &(cw_read_desc){.gaps = CW_GAPS_ALLOW});
    check_regions("", &(cw_read_desc){.gaps = CW_GAPS_INTERPOLATE, .spacing_mm = {1, 2, 3}});
    test_folder_remove(NULL);
    test_folder_make(NULL);
    for (int n = 0; n < 6; n++) {
        char name[16], position[16];
        snprintf(name, sizeof name, "%d", n);
        snprintf(position, sizeof position, "0\\0\\%d", n % 3);
        test_image_write(&(test_image){.instance = n,
                                       .samples = 3,
                                       .bits = 8,
                                       .position = position,
                                       .slope = n ? "0.5" : "0.25"},
                         name);
    }
    check_regions("", NULL);
    test_folder_remove(NULL);
    test_folder_make(NULL);
    const frame frames[] = {{"0\\0\\0", NULL, 3}, {"0\\0\\6", NULL, 3}, {"0\\0\\2", NULL, 1}};
    const uint8_t bits[5] = {0x5f, 0xf0, 0xa7, 0x3c, 0x81};
    write_frames("seg.dcm", SEGMENTATION, frames, 3, bits, sizeof bits);
    check_regions("", NULL);
}

static void starved_reads_fail_cleanly(void **state)
{
    (void)state;
    const double even[] = {0, 2.5, 5};
    write_row(&upright, even, 3, 0);
    check_starved_reads("");
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(every_cut_is_an_error),
        TEST(sizes_are_held_against_the_file),
        TEST(deep_nesting_is_survived),
        TEST(deflated_files_are_walked_over),
        TEST(unknown_syntaxes_are_named),
        TEST(frames_are_counted_from_one),
        TEST(files_without_a_preamble_are_read),
        TEST(a_damaged_slice_is_left_out_if_that_is_asked_for),
        TEST(a_damaged_file_of_another_series_blocks_nothing),
        TEST(folders_without_slices_tell_what_they_hold),
        TEST(what_is_no_image_is_told),
        TEST(links_are_left_out),
        TEST(here_or_in_a_sandbox_is_the_same),
        TEST(regions_are_crops),
        TEST(starved_reads_fail_cleanly),
    };
    if (!cwi_module_present("dicom")) {
        print_message("this build reads no DICOM\n");
        return 0;
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
