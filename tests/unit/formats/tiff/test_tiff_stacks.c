/* TIFF read: slices in files of their own, and regions. */
#include "support/files/tiff_cases.h"

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

/* A minus is a sign where something other than a letter or a digit is in front, or where the names are
 * alike only then. */
static void numbers_in_names_may_be_negative(void **state)
{
    (void)state;
    static const struct {
        const char *names[4]; /* from low to high */
    } cases[] = {{{"s_-2.tif", "s_-1.tif", "s_0.tif", "s_1.tif"}},
                 {{"z-10.tif", "z-9.tif", "z-8.tif", "z-7.tif"}},
                 {{"(-4).tif", "(-3).tif", "(-2).tif", "(-1).tif"}},
                 {{"z-2.tif", "z-1.tif", "z0.tif", "z1.tif"}},
                 {{"2026-05-1.tif", "2026-05-2.tif", "2026-05-3.tif", "2026-05-4.tif"}},
                 {{"cut-1.tif", "cut-2.tif", "cut-3.tif", "cut-4.tif"}}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        char folder[16], name[64];
        cw_volume v;
        snprintf(folder, sizeof folder, "minus%zu", n);
        make_folder(folder);
        for (size_t k = 0; k < 4; k++) {
            snprintf(name, sizeof name, "%s/%s", folder, cases[n].names[k]);
            save_slice(name, (unsigned char)(10 + k));
        }
        read_good(folder, &v);
        assert_string_equal(notes, "");
        const bool falls = n == 1; /* alike without a sign, so the minus is none */
        for (size_t z = 0; z < 4; z++)
            assert_true(cw_volume_value(&v, 0, 0, z) == 10 + (double)(falls ? 3 - z : z));
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
    assert_fails(cw_steps_list(series[0], 0, NULL, &files, &count, &err), CW_ERR_ARGUMENT,
                 "path_count is 0", err);
    assert_fails(cw_steps_list(mixed, 2, NULL, &files, &count, &err), CW_ERR_ARGUMENT,
                 "cut_8.tif: is a slice, and of several files each must be a volume", err);
    assert_fails(cw_steps_list(series[1], 2, &raw, &files, &count, &err), CW_ERR_ARGUMENT,
                 "2 files with one layout", err);
    assert_ok(cw_steps_list(series[0], 1, &raw, &files, &count, &err), err);
    assert_int_equal(count, 0);
}

/* The first file too: its facts are those of the stack. */
static void damaged_slices_are_left_out_if_that_is_asked_for(void **state)
{
    (void)state;
    static const unsigned char broken[] = {'I', 'I', '*', 0, 255, 255, 0, 0};
    const cw_read_desc skip = {.skip_damaged = true};
    const cw_read_desc both = {.skip_damaged = true, .gaps = CW_GAPS_INTERPOLATE};
    cw_volume v;
    cw_error err = {0};
    make_folder("s");
    for (int n = 1; n <= 7; n++) {
        char name[32];
        snprintf(name, sizeof name, "s/cut_%d.tif", n);
        if (n == 1 || n == 4)
            put_file(name, "", broken, sizeof broken);
        else
            save_slice(name, (unsigned char)(10 * n));
    }
    assert_fails(read_with("s", (cw_read_desc){0}, &v, &err), CW_ERR_FORMAT,
                 "cut_1.tif: ", err);
    assert_non_null(strstr(err.message, "; desc->skip_damaged leaves such files out"));
    assert_fails(read_with("s", skip, &v, &err), CW_ERR_UNSAFE,
                 "1 slice is missing; the first gap is from 3 to 5 in their numbers", err);
    assert_ok(read_with("s", both, &v, &err), err);
    assert_int_equal(v.dim[2], 6);
    for (size_t z = 0; z < 6; z++)
        assert_true(cw_volume_value(&v, 0, 0, z) == 10 * (double)(z + 2));
    cw_volume_free(&v);
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

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(regions_are_crops),
        TEST(regions_may_cross_rows_of_tiles),
        TEST(numbers_in_names_count_as_numbers),
        TEST(numbers_in_names_may_be_negative),
        TEST(slices_are_one_volume_and_stacks_are_steps),
        TEST(damaged_slices_are_left_out_if_that_is_asked_for),
        TEST(missing_slices_are_for_gaps_to_decide),
        TEST(names_that_are_no_row_are_taken_in_their_order),
        TEST(slices_that_do_not_belong_together_are_named),
        TEST(a_folder_of_one_stack_is_that_stack),
    };
    if (!cwi_module_present("tiff")) {
        puts("this build reads no TIFF");
        return 0;
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
