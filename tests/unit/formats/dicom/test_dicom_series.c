/* DICOM read: slices in their place, and series to choose from. */
#include "support/files/dicom_cases.h"

static void slices_are_ordered_by_place(void **state)
{
    (void)state;
    const slice_frame *frames[] = {&upright, &oblique};
    const double even[] = {0, 2.5, 5, 7.5, 10};
    for (int f = 0; f < 2; f++) {
        write_row(frames[f], even, 5, 0);
        cw_volume v = read_all(NULL);
        double spacing[3];
        cw_volume_spacing(&v, spacing);
        assert_true(v.dim[0] == COLUMNS && v.dim[1] == ROWS && v.dim[2] == 5);
        assert_near(spacing[0], 2, 1e-9);
        assert_near(spacing[1], 3, 1e-9);
        assert_near(spacing[2], 2.5, 1e-9);
        assert_int_equal(v.known, CW_KNOWN_UNIT | CW_KNOWN_FRAME);
        assert_is_field(&v);
        cw_volume_free(&v);
    }
}

static void any_file_stands_for_its_series(void **state)
{
    (void)state;
    const double even[] = {0, 2.5, 5};
    write_row(&upright, even, 3, 0);
    test_image_write(&(test_image){.series = "9.9"}, "other.dcm");
    cw_volume v;
    cw_error err = {0};
    assert_ok(read_back("89.dcm", &v, &err), err);
    assert_int_equal(v.dim[2], 3);
    assert_is_field(&v);
    cw_volume_free(&v);
    assert_ok(read_back("other.dcm", &v, &err), err);
    assert_int_equal(v.dim[2], 1);
    cw_volume_free(&v);
    assert_ok(read_back("8*.dcm", &v, &err), err); /* a pattern: only what matches */
    assert_int_equal(v.dim[2], 2);
    cw_volume_free(&v);
}

static void a_tilted_gantry_leaves_a_sheared_frame(void **state)
{
    (void)state;
    const double even[] = {0, 2.5, 5, 7.5};
    cw_series *series;
    size_t count;
    cw_error err = {0};
    write_row(&oblique, even, 4, tan(18.5 * PI / 180));
    cw_volume v = read_all(NULL);
    assert_is_field(&v);
    cw_volume_free(&v);
    assert_ok(cw_series_list(test_path(""), NULL, &series, &count, &err), err);
    assert_int_equal(count, 1);
    assert_near(series[0].tilt_degrees, 18.5, 1e-6);
    cw_series_free(series);

    v = read_all(&(cw_read_desc){.tilt = CW_TILT_KEEP});
    double product = 0; /* of slice direction and column direction */
    for (int r = 0; r < 3; r++)
        product += v.affine[r][2] * v.affine[r][1];
    assert_near(product, 0, 1e-9);
    cw_volume_free(&v);
}

static void slices_shifted_unevenly_are_refused(void **state)
{
    (void)state;
    for (int s = 0; s < 4; s++) {
        char name[16];
        const double p[3] = {s == 2 ? 1.5 : 0, 0, 2.5 * s};
        snprintf(name, sizeof name, "%d.dcm", s);
        write_field_slice(name, s, &upright, p);
    }
    assert_refused(NULL, CW_ERR_UNSAFE, "unevenly, by up to 1.5 mm; desc->tilt = CW_TILT_KEEP");
    cw_volume v = read_all(&(cw_read_desc){.tilt = CW_TILT_KEEP});
    assert_int_equal(v.dim[2], 4);
    cw_volume_free(&v);
}

/* A tenth of the smaller spacing, which pixels may have along either axis. */
static void the_smaller_spacing_says_what_is_uneven(void **state)
{
    (void)state;
    static const char *const spacings[] = {"1\\4", "4\\1"};
    for (int way = 0; way < 2; way++) {
        for (int s = 0; s < 3; s++) {
            char name[16], position[32];
            snprintf(name, sizeof name, "%d.dcm", s);
            snprintf(position, sizeof position, "%s\\0\\%d", s == 1 ? "0.2" : "0", 2 * s);
            test_image_write(
                &(test_image){.instance = s, .position = position, .spacing = spacings[way]},
                name);
        }
        assert_refused(NULL, CW_ERR_UNSAFE, "unevenly, by up to 0.2 mm");
    }
}

static void missing_slices_stop_or_are_made(void **state)
{
    (void)state;
    const double gap[] = {0, 2.5, 5, 12.5, 15, 17.5};
    write_row(&oblique, gap, 6, 0.2);
    assert_refused(NULL, CW_ERR_UNSAFE,
                   "2 slices are missing; the first gap is from -4.8 to 2.7 mm");
    cw_volume v = read_all(&(cw_read_desc){.gaps = CW_GAPS_INTERPOLATE});
    assert_int_equal(v.dim[2], 8);
    assert_is_field(&v);
    cw_volume_free(&v);
    v = read_all(&(cw_read_desc){.gaps = CW_GAPS_ALLOW});
    assert_int_equal(v.dim[2], 6);
    cw_volume_free(&v);
}

static void uneven_slices_stop_or_are_made_even(void **state)
{
    (void)state;
    const double uneven[] = {0, 4, 8, 12, 13.08, 20.08, 27.08, 34.08};
    write_row(&upright, uneven, 8, 0.3346);
    assert_refused(NULL, CW_ERR_UNSAFE, "vary from 1.08 to 7 mm");
    cw_volume v = read_all(&(cw_read_desc){.gaps = CW_GAPS_INTERPOLATE});
    double spacing[3];
    cw_volume_spacing(&v, spacing);
    assert_int_equal(v.dim[2], 33);
    assert_is_field(&v);
    cw_volume_free(&v);
}

/* Rounded to a tenth of a millimetre, as some scanners write places. */
static void rounded_places_are_even(void **state)
{
    (void)state;
    const double rounded[] = {0, 1.3, 2.5, 3.8, 5, 6.3, 7.5};
    write_row(&upright, rounded, 7, 0);
    cw_volume v = read_all(NULL);
    assert_int_equal(v.dim[2], 7);
    cw_volume_free(&v);
}

/* --- series ------------------------------------------------------------------------------ */

static void several_series_have_to_be_chosen_from(void **state)
{
    (void)state;
    cw_series *series;
    size_t count;
    cw_error err = {0};
    for (int n = 0; n < 3; n++) {
        char name[16];
        snprintf(name, sizeof name, "a%d", n);
        write_at(name, 3, n, 2 * n, "1.3");
        snprintf(name, sizeof name, "b%d", n);
        write_at(name, 4, n, n, "1.4");
    }
    test_image_write(&(test_image){.number = 4, .series = "1.4", .rows = 5}, "scout");
    test_file_write(test_path("readme.txt"), "hello", 5);
    assert_refused(NULL, CW_ERR_UNSAFE,
                   "it holds 3 series: 3 (CT, 3 of 4 x 3), 4.1 (CT, 3 of 4 x 3), 4.2 (CT, ");
    assert_refused(&(cw_read_desc){.series = "4"}, CW_ERR_ARGUMENT, "no series '4'");
    assert_ok(cw_series_list(test_path(""), NULL, &series, &count, &err), err);
    assert_int_equal(count, 3);
    assert_string_equal(series[0].label, "3");
    assert_string_equal(series[0].modality, "CT");
    assert_int_equal(series[0].images, 3);
    for (size_t n = 0; n < count; n++) {
        cw_volume v = read_all(&(cw_read_desc){.series = series[n].label});
        assert_int_equal(v.dim[1], series[n].shape.dim[1]);
        assert_int_equal(v.dim[2], series[n].shape.dim[2]);
        cw_volume_free(&v);
    }
    cw_series_free(series);
    cw_volume v = read_all(&(cw_read_desc){.series = "1.3"});
    assert_near(v.affine[2][2], 2, 1e-9);
    cw_volume_free(&v);
}

static void copies_of_a_file_are_left_out(void **state)
{
    (void)state;
    for (int n = 0; n < 3; n++)
        for (int copy = 0; copy < 2; copy++) {
            char name[16];
            snprintf(name, sizeof name, "%d-%d", n, copy);
            write_at(name, 1, n, n, "1.2");
        }
    cw_volume v = read_all(NULL);
    assert_int_equal(v.dim[2], 3);
    assert_int_equal(v.steps, 1);
    cw_volume_free(&v);
}

/* Two versions of one image under one identity: a name means its own. */
static void of_copies_the_named_one_is_read(void **state)
{
    (void)state;
    for (int n = 0; n < 2; n++) {
        char name[16];
        uint16_t pixels[PIXELS];
        cw_volume v;
        cw_error err = {0};
        for (int i = 0; i < PIXELS; i++)
            pixels[i] = (uint16_t)(50 + n);
        snprintf(name, sizeof name, "%d", n);
        test_image_write(&(test_image){.pixels = pixels}, name);
        assert_ok(read_back(name, &v, &err), err);
        assert_near(cw_volume_value(&v, 0, 0, 0), 50 + n, 0);
        cw_volume_free(&v);
    }
}

static void two_images_at_some_places_are_refused(void **state)
{
    (void)state;
    for (int n = 0; n < 4; n++) {
        char name[16];
        snprintf(name, sizeof name, "%d", n);
        write_at(name, 1, n, n < 3 ? n : 1, "1.2");
    }
    assert_refused(NULL, CW_ERR_UNSAFE,
                   "1 of 3 places hold more than one image, the first at 1 mm");
    cw_volume v = read_all(&(cw_read_desc){.gaps = CW_GAPS_ALLOW});
    assert_int_equal(v.dim[2], 3);
    cw_volume_free(&v);
}

/* Trigger times run against the instance numbers: they are the better key. */
static void as_many_images_everywhere_are_steps(void **state)
{
    (void)state;
    for (int keyed = 0; keyed < 2; keyed++) {
        for (int n = 0; n < 6; n++) {
            char name[16], position[16], trigger[16];
            uint16_t pixels[PIXELS];
            for (int i = 0; i < PIXELS; i++)
                pixels[i] = (uint16_t)(10 * n);
            snprintf(name, sizeof name, "%d", n);
            snprintf(position, sizeof position, "0\\0\\%d", n % 3);
            snprintf(trigger, sizeof trigger, "%d", 100 - n / 3);
            test_image_write(&(test_image){.instance = n + 1,
                                           .position = position,
                                           .trigger = keyed ? trigger : NULL,
                                           .pixels = pixels},
                             name);
        }
        cw_volume v = read_all(NULL), step;
        assert_true(v.dim[2] == 3 && v.steps == 2);
        for (size_t t = 0; t < 2; t++)
            for (size_t k = 0; k < 3; k++) {
                const size_t n = 3 * (keyed ? 1 - t : t) + k;
                assert_int_equal(cw_volume_select(&v, 0, t, &step, NULL), CW_OK);
                assert_near(cw_volume_value(&step, 1, 1, k), 10.0 * (double)n, 0);
            }
        cw_volume_free(&v);
    }
}

static void geometry_that_is_missing_is_asked_for(void **state)
{
    (void)state;
    const cw_read_desc stated = {.spacing_mm = {0.5, 0.25, 2}};
    for (int n = 0; n < 2; n++)
        test_image_write(
            &(test_image){.instance = n, .spacing = "", .position = n ? "0\\0\\3" : NULL},
            n ? "b" : "a");
    assert_refused(NULL, CW_ERR_UNSAFE, "no 'PixelSpacing'");
    cw_volume v = read_all(&stated);
    assert_near(v.affine[0][0], 0.5, 1e-12);
    assert_near(v.affine[1][1], 0.25, 1e-12);
    assert_near(v.affine[2][2], 2, 1e-12);
    cw_volume_free(&v);

    for (int n = 0; n < 2; n++)
        test_image_write(&(test_image){.instance = 9 - n, .position = "", .orientation = ""},
                         n ? "b" : "a");
    assert_refused(NULL, CW_ERR_UNSAFE, "2 of 2 images have no 'ImagePositionPatient'");
    v = read_all(&stated);
    assert_int_equal(v.dim[2], 2);
    assert_int_equal(v.known, CW_KNOWN_UNIT);
    cw_volume_free(&v);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(slices_are_ordered_by_place),
        TEST(any_file_stands_for_its_series),
        TEST(a_tilted_gantry_leaves_a_sheared_frame),
        TEST(slices_shifted_unevenly_are_refused),
        TEST(the_smaller_spacing_says_what_is_uneven),
        TEST(missing_slices_stop_or_are_made),
        TEST(uneven_slices_stop_or_are_made_even),
        TEST(rounded_places_are_even),
        TEST(several_series_have_to_be_chosen_from),
        TEST(copies_of_a_file_are_left_out),
        TEST(of_copies_the_named_one_is_read),
        TEST(two_images_at_some_places_are_refused),
        TEST(as_many_images_everywhere_are_steps),
        TEST(geometry_that_is_missing_is_asked_for),
    };
    if (!cwi_module_present("dicom")) {
        print_message("this build reads no DICOM\n");
        return 0;
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
