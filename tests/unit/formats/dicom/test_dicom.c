#define _GNU_SOURCE /* symlink */
#include "support/files/dicom.h"
#include "support/files/reading.h"
#include "support/files/regions.h"

#include "core/base/module.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { COLUMNS = 4, ROWS = 3, PIXELS = COLUMNS * ROWS };

static cw_status read_folder(const cw_read_desc *desc, cw_volume *v, cw_error *err)
{
    return cw_volume_read(test_path(""), desc, v, NULL, err);
}

static cw_volume read_all(const cw_read_desc *desc)
{
    cw_volume v;
    cw_error err = {0};
    assert_ok(read_folder(desc, &v, &err), err);
    return v;
}

static void assert_refused(const cw_read_desc *desc, cw_status wanted, const char *words)
{
    cw_volume v;
    cw_error err = {0};
    assert_fails(read_folder(desc, &v, &err), wanted, words, err);
    assert_null(v.data);
}

/* --- fields: what is read must be a value at a place ------------------------------------- */

/* A field that is linear in the world: trilinear samples of it are exact wherever they are. */
static double field_at(const double p[3])
{
    return 100 + 3 * p[0] - 2 * p[1] + 5 * p[2];
}

typedef struct slice_frame {
    double x[3], y[3]; /* directions of rows and columns */
    double spacing[2]; /* between columns, between rows */
} slice_frame;

static const slice_frame upright = {{1, 0, 0}, {0, 1, 0}, {2, 3}};
static const slice_frame oblique = {{0, 0.6, -0.8}, {1, 0, 0}, {2, 3}};

/* Writes a slice that samples the field. */
static void write_field_slice(const char *name, int instance, const slice_frame *f,
                              const double position[3])
{
    char place[80], turn[120], spacing[40];
    int16_t pixels[PIXELS];
    for (int n = 0; n < PIXELS; n++) {
        double p[3];
        for (int r = 0; r < 3; r++)
            p[r] = position[r] + n % COLUMNS * f->spacing[0] * f->x[r] +
                   n / COLUMNS * f->spacing[1] * f->y[r];
        pixels[n] = (int16_t)lrint(10 * field_at(p));
    }
    snprintf(place, sizeof place, "%.10g\\%.10g\\%.10g", position[0], position[1], position[2]);
    snprintf(turn, sizeof turn, "%.10g\\%.10g\\%.10g\\%.10g\\%.10g\\%.10g", f->x[0], f->x[1],
             f->x[2], f->y[0], f->y[1], f->y[2]);
    snprintf(spacing, sizeof spacing, "%.10g\\%.10g", f->spacing[1], f->spacing[0]);
    test_image_write(&(test_image){.instance = instance,
                                   .position = place,
                                   .orientation = turn,
                                   .spacing = spacing,
                                   .is_signed = true,
                                   .slope = "0.1",
                                   .pixels = pixels},
                     name);
}

/* Every voxel is the field's value at its place, to the rounding of pixels. */
static void assert_is_field(const cw_volume *v)
{
    for (size_t k = 0; k < v->dim[2]; k++)
        for (size_t j = 0; j < v->dim[1]; j++)
            for (size_t i = 0; i < v->dim[0]; i++) {
                double p[3];
                cw_volume_to_world(v, (const double[3]){(double)i, (double)j, (double)k}, p);
                assert_near(cw_volume_value(v, i, j, k), field_at(p), 0.1501);
            }
}

/* Slices along the normal of a frame, at these distances, named and numbered the other way. */
static void write_row(const slice_frame *f, const double *distances, int count, double shear)
{
    const double n[3] = {f->x[1] * f->y[2] - f->x[2] * f->y[1],
                         f->x[2] * f->y[0] - f->x[0] * f->y[2],
                         f->x[0] * f->y[1] - f->x[1] * f->y[0]};
    for (int s = 0; s < count; s++) {
        char name[32];
        double p[3];
        for (int r = 0; r < 3; r++)
            p[r] = 7 + distances[s] * (n[r] + shear * f->y[r]);
        snprintf(name, sizeof name, "%d.dcm", 90 - s);
        write_field_slice(name, count - s, f, p);
    }
}

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
    assert_refused(NULL, CW_ERR_UNSAFE, "unevenly, by up to 1.5 mm; --tilt keep");
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
            char name[16], place[32];
            snprintf(name, sizeof name, "%d.dcm", s);
            snprintf(place, sizeof place, "%s\\0\\%d", s == 1 ? "0.2" : "0", 2 * s);
            test_image_write(
                &(test_image){.instance = s, .position = place, .spacing = spacings[way]},
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

static void write_at(const char *name, int number, int instance, double z, const char *series)
{
    char place[40];
    snprintf(place, sizeof place, "0\\0\\%.6g", z);
    test_image_write(
        &(test_image){
            .number = number, .instance = instance, .position = place, .series = series},
        name);
}

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
            char name[16], place[16], trigger[16];
            uint16_t pixels[PIXELS];
            for (int i = 0; i < PIXELS; i++)
                pixels[i] = (uint16_t)(10 * n);
            snprintf(name, sizeof name, "%d", n);
            snprintf(place, sizeof place, "0\\0\\%d", n % 3);
            snprintf(trigger, sizeof trigger, "%d", 100 - n / 3);
            test_image_write(&(test_image){.instance = n + 1,
                                           .position = place,
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

/* --- pixels ------------------------------------------------------------------------------ */

static void assert_pixels(const test_image *m, const double *wanted, cw_type type)
{
    cw_volume v;
    cw_error err = {0};
    test_image_write(m, "one.dcm");
    assert_ok(read_back("one.dcm", &v, &err), err);
    assert_int_equal(v.type, type);
    for (size_t n = 0; n < PIXELS; n++)
        for (size_t c = 0; c < v.components; c++) {
            cw_volume one;
            assert_int_equal(cw_volume_select(&v, c, 0, &one, NULL), CW_OK);
            assert_near(cw_volume_value(&one, n % COLUMNS, n / COLUMNS, 0),
                        wanted[n * v.components + c], 0);
        }
    cw_volume_free(&v);
}

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
        char name[16], place[16];
        snprintf(name, sizeof name, "%d", n);
        snprintf(place, sizeof place, "0\\0\\%d", n);
        test_image_write(&(test_image){.instance = n,
                                       .position = place,
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
    static const int places[] = {0, 1, 3, 4};
    static const uint8_t padded[] = {99, 5, 6, 99}; /* the pixel; 99: none */
    for (int n = 0; n < 4; n++) {
        char name[16], place[16];
        uint16_t pixels[PIXELS];
        for (unsigned i = 0; i < PIXELS; i++)
            pixels[i] = i == padded[n] ? 1000 : 10;
        snprintf(name, sizeof name, "%d", n);
        snprintf(place, sizeof place, "0\\0\\%d", places[n]);
        test_image_write(
            &(test_image){
                .instance = n, .position = place, .padding = "1000", .pixels = pixels},
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

static void notes_keep(void *user, const char *text);

/* Two images at each of two places, which are known to a thousandth of a pixel. The first key
 * is the same for all and so orders nothing. */
static void a_key_that_is_the_same_for_all_orders_nothing(void **state)
{
    (void)state;
    static const char *const places[] = {"0\\0\\0", "0\\0\\0.0004", "0\\0\\2.0004", "0\\0\\2"};
    char notes[512] = "";
    const cw_read_desc desc = {.note = notes_keep, .note_user = notes};
    for (int n = 0; n < 4; n++) {
        char name[16];
        snprintf(name, sizeof name, "%d", n);
        test_image_write(&(test_image){.instance = n, .position = places[n], .trigger = "7"},
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

/* --- objects of several frames ----------------------------------------------------------- */

static void put_frame(test_dicom *d, const char *position, const char *slope, int segment)
{
    test_dicom_open_item(d);
    test_dicom_open_sequence(d, 0x00209113); /* PlanePositionSequence */
    test_dicom_open_item(d);
    test_dicom_text(d, 0x00200032, "DS", position);
    test_dicom_close_item(d);
    test_dicom_close_sequence(d);
    if (slope) {
        test_dicom_open_sequence(d, 0x00289145); /* PixelValueTransformationSequence */
        test_dicom_open_item(d);
        test_dicom_text(d, 0x00281052, "DS", "1");
        test_dicom_text(d, 0x00281053, "DS", slope);
        test_dicom_close_item(d);
        test_dicom_close_sequence(d);
    }
    if (segment) {
        test_dicom_open_sequence(d, 0x0062000a); /* SegmentIdentificationSequence */
        test_dicom_open_item(d);
        test_dicom_u16(d, 0x0062000b, (unsigned)segment);
        test_dicom_close_item(d);
        test_dicom_close_sequence(d);
    }
    test_dicom_close_item(d);
}

typedef struct frame {
    const char *position, *slope;
    int segment;
} frame;

static const char ENHANCED_CT[] = "1.2.840.10008.5.1.4.1.1.2.1",
                  SEGMENTATION[] = "1.2.840.10008.5.1.4.1.1.66.4",
                  LABEL_MAP[] = "1.2.840.10008.5.1.4.1.1.66.7";

static void put_head(test_dicom *d, const char *sop_class, const char *frames, unsigned bits)
{
    test_dicom_text(d, 0x00080016, "UI", sop_class);
    test_dicom_text(d, 0x00080018, "UI", "1.2.3.9");
    test_dicom_text(d, 0x0020000e, "UI", "1.2.3");
    test_dicom_u16(d, 0x00280002, 1);
    test_dicom_text(d, 0x00280004, "CS",
                    sop_class == LABEL_MAP ? "PALETTE COLOR" : "MONOCHROME2");
    test_dicom_text(d, 0x00280008, "IS", frames);
    test_dicom_u16(d, 0x00280010, ROWS);
    test_dicom_u16(d, 0x00280011, COLUMNS);
    test_dicom_u16(d, 0x00280100, bits);
    test_dicom_u16(d, 0x00280101, bits);
    test_dicom_u16(d, 0x00280102, bits - 1);
    test_dicom_u16(d, 0x00280103, 0);
    if (sop_class == LABEL_MAP)
        test_dicom_u16(d, 0x00280120, 7);
    test_dicom_open_sequence(d, 0x52009229); /* SharedFunctionalGroupsSequence */
    test_dicom_open_item(d);
    test_dicom_open_sequence(d, 0x00209116);
    test_dicom_open_item(d);
    test_dicom_text(d, 0x00200037, "DS", "1\\0\\0\\0\\1\\0");
    test_dicom_close_item(d);
    test_dicom_close_sequence(d);
    test_dicom_open_sequence(d, 0x00289110);
    test_dicom_open_item(d);
    test_dicom_text(d, 0x00180050, "DS", "2");
    test_dicom_text(d, 0x00280030, "DS", "0.5\\0.25");
    test_dicom_close_item(d);
    test_dicom_close_sequence(d);
    test_dicom_close_item(d);
    test_dicom_close_sequence(d);
}

/* All but the pixels. */
static void begin_frames(test_dicom *d, test_dicom_syntax syntax, const char *sop_class,
                         const frame *frames, int count)
{
    char number[8];
    snprintf(number, sizeof number, "%d", count);
    test_dicom_begin(d, syntax);
    put_head(d, sop_class, number, sop_class == SEGMENTATION ? 1 : 8);
    test_dicom_open_sequence(d, 0x52009230); /* PerFrameFunctionalGroupsSequence */
    for (int n = 0; n < count; n++)
        put_frame(d, frames[n].position, frames[n].slope, frames[n].segment);
    test_dicom_close_sequence(d);
}

static void write_frames(const char *name, const char *sop_class, const frame *frames,
                         int count, const void *pixels, size_t bytes)
{
    test_dicom d;
    begin_frames(&d, TEST_DICOM_EXPLICIT, sop_class, frames, count);
    test_dicom_bytes(&d, 0x7fe00010, "OB", pixels, bytes);
    test_file_write(test_path(name), d.bytes, d.size);
    test_dicom_free(&d);
}

static void frames_have_a_place_each(void **state)
{
    (void)state;
    const frame frames[] = {{"0\\0\\6", "2", 0}, {"0\\0\\2", "2", 0}, {"0\\0\\4", "2", 0}};
    uint8_t pixels[3 * PIXELS];
    for (int n = 0; n < 3 * PIXELS; n++)
        pixels[n] = (uint8_t)n;
    write_frames("frames.dcm", ENHANCED_CT, frames, 3, pixels, sizeof pixels);
    cw_volume v = read_all(NULL);
    static const int order[] = {1, 2, 0};
    assert_true(v.dim[2] == 3 && v.type == CW_U8 && v.slope == 2 && v.intercept == 1);
    check_affine(&v, (const double[]){0.25, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 2, 2});
    for (size_t k = 0; k < 3; k++)
        assert_near(cw_volume_value(&v, 1, 0, k), 2 * (order[k] * PIXELS + 1) + 1, 0);
    cw_volume_free(&v);
}

/* Bits follow each other without a gap: 12 a frame. Two segments, one slice between
 * left out. */
static void segments_become_labels(void **state)
{
    (void)state;
    const frame frames[] = {
        {"0\\0\\0", NULL, 3}, {"0\\0\\6", NULL, 3}, {"0\\0\\0", NULL, 1}, {"0\\0\\2", NULL, 1}};
    const uint8_t bits[6] = {0x0f, 0xf0, 0xff, 0xff, 0x01, 0x00};
    write_frames("seg.dcm", SEGMENTATION, frames, 4, bits, sizeof bits);
    cw_volume v = read_all(NULL);
    assert_true(v.dim[2] == 4 && v.type == CW_U8);
    for (size_t k = 0; k < 4; k++)
        for (size_t n = 0; n < PIXELS; n++) {
            int label = 0;
            for (int f = 0; f < 4; f++) { /* the higher one stays */
                const size_t bit = (size_t)f * PIXELS + n;
                const int place = frames[f].position[4] - '0';
                if (place == 2 * (int)k && bits[bit / 8] >> bit % 8 & 1 &&
                    frames[f].segment > label)
                    label = frames[f].segment;
            }
            assert_near(cw_volume_value(&v, n % COLUMNS, n / COLUMNS, k), label, 0);
        }
    cw_volume_free(&v);
}

/* Pixels are numbers of segments, whatever colours a palette has for them; the slice between is
 * left out, and padding. */
static void label_maps_have_their_slices(void **state)
{
    (void)state;
    const frame frames[] = {{"0\\0\\4", NULL, 0}, {"0\\0\\0", NULL, 0}};
    uint8_t pixels[2 * PIXELS];
    for (int n = 0; n < 2 * PIXELS; n++)
        pixels[n] = (uint8_t)(n % 5);
    write_frames("map.dcm", LABEL_MAP, frames, 2, pixels, sizeof pixels);
    cw_volume v = read_all(NULL);
    assert_true(v.dim[2] == 3 && v.type == CW_U8);
    check_affine(&v, (const double[]){0.25, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 2, 0});
    assert_true(v.has_nodata && v.nodata == 7);
    for (size_t k = 0; k < 3; k++)
        for (size_t n = 0; n < PIXELS; n++)
            assert_int_equal(((const uint8_t *)v.data)[k * PIXELS + n],
                             k == 1 ? 7 : pixels[n + (k == 0) * PIXELS]);
    cw_volume_free(&v);

    const frame twice[] = {{"0\\0\\0", NULL, 0}, {"0\\0\\0", NULL, 0}};
    write_frames("map.dcm", LABEL_MAP, twice, 2, pixels, sizeof pixels);
    assert_refused(NULL, CW_ERR_UNSAFE, "two frames of the label map stand at 0 mm");
}

/* Twelve bits a frame, packed into two bytes, and those as run lengths. */
static void runs_of_bits_are_read(void **state)
{
    (void)state;
    const frame frames[] = {{"0\\0\\0", NULL, 1}, {"0\\0\\2", NULL, 2}};
    const uint8_t bits[2][2] = {{0xa5, 0x09}, {0x3c, 0x3c}};
    for (int short_by = 0; short_by < 2; short_by++) {
        test_dicom d;
        uint8_t rle[64 + 4] = {1, 0, 0, 0, 64};
        begin_frames(&d, TEST_DICOM_RLE, SEGMENTATION, frames, 2);
        test_dicom_open_fragments(&d);
        rle[64] = 1; /* two bytes as they are */
        memcpy(rle + 65, bits[0], 2);
        test_dicom_fragment(&d, rle, sizeof rle);
        rle[64] = 257 - 2; /* one of them twice */
        rle[65] = bits[1][0];
        test_dicom_fragment(&d, rle, sizeof rle - 2 - 2 * (size_t)short_by);
        test_dicom_close_sequence(&d);
        test_file_write(test_path("rle.dcm"), d.bytes, d.size);
        test_dicom_free(&d);
        if (short_by) {
            assert_refused(NULL, CW_ERR_FORMAT, "its run lengths end early");
            continue;
        }
        cw_volume v = read_all(NULL);
        assert_int_equal(v.dim[2], 2);
        for (size_t k = 0; k < 2; k++)
            for (size_t n = 0; n < PIXELS; n++)
                assert_near(cw_volume_value(&v, n % COLUMNS, n / COLUMNS, k),
                            (bits[k][n / 8] >> n % 8 & 1) * (int)(k + 1), 0);
        cw_volume_free(&v);
    }
}

/* --- mosaics ----------------------------------------------------------------------------- */

typedef struct csa {
    unsigned char bytes[1024];
    size_t size;
    bool newer;
} csa;

static void put_csa(csa *c, const void *bytes, size_t size)
{
    assert_true(c->size + size <= sizeof c->bytes);
    memcpy(c->bytes + c->size, bytes, size);
    c->size += size;
}

static void put_csa_number(csa *c, uint32_t n)
{
    const unsigned char b[4] = {(unsigned char)n, (unsigned char)(n >> 8),
                                (unsigned char)(n >> 16), (unsigned char)(n >> 24)};
    put_csa(c, b, sizeof b);
}

/* Six items, as scanners write them; those behind the first `count` are empty. */
static void put_csa_tag(csa *c, const char *name, const char *const *texts, uint32_t count)
{
    enum { ITEMS = 6 };
    char field[64] = {0};
    snprintf(field, sizeof field, "%s", name);
    put_csa(c, field, sizeof field);
    put_csa_number(c, count);
    put_csa(c, "FD\0", 4);
    put_csa_number(c, 4);
    put_csa_number(c, ITEMS);
    put_csa_number(c, 77);
    for (uint32_t n = 0; n < ITEMS; n++) {
        const uint32_t size = n < count ? (uint32_t)strlen(texts[n]) + 1 : 0;
        put_csa_number(c, c->newer ? size : size + ITEMS);
        put_csa_number(c, size);
        put_csa_number(c, 77);
        put_csa_number(c, size);
        if (size)
            put_csa(c, texts[n], size);
        put_csa(c, "\0\0\0", (4 - size % 4) % 4);
    }
}

static csa make_csa(bool newer, const char *slices, const char *const normal[3])
{
    csa c = {.newer = newer};
    if (newer)
        put_csa(&c, "SV10\4\3\2\1", 8);
    put_csa_number(&c, 3);
    put_csa_number(&c, 77);
    put_csa_tag(&c, "EchoLinePosition", (const char *const[]){"64"}, 1);
    put_csa_tag(&c, "NumberOfImagesInMosaic", &slices, 1);
    put_csa_tag(&c, "SliceNormalVector", normal, 3);
    return c;
}

/* Three slices, 2.5 mm apart, in a mosaic of two by two, whose pixels are the
 * field's values. */
static void write_mosaic(const char *name, int instance, const csa *header, double up)
{
    enum { ACROSS = 2, SLICES = 3, WIDE = ACROSS * COLUMNS, HIGH = ACROSS * ROWS };
    const slice_frame *f = &oblique; /* its normal is 0, -0.8, -0.6 */
    const double normal[3] = {0, -0.8 * up, -0.6 * up}, corner[3] = {7, -3, 11};
    int16_t pixels[WIDE * HIGH] = {0};
    char place[80];
    double p[3];
    for (int n = 0; n < SLICES * PIXELS; n++) {
        const int k = n / PIXELS, i = n % COLUMNS, j = n / COLUMNS % ROWS;
        for (int r = 0; r < 3; r++)
            p[r] = corner[r] + i * f->spacing[0] * f->x[r] + j * f->spacing[1] * f->y[r] +
                   2.5 * k * normal[r];
        pixels[(k / ACROSS * ROWS + j) * WIDE + k % ACROSS * COLUMNS + i] =
            (int16_t)lrint(10 * field_at(p));
    }
    for (int r = 0; r < 3; r++)
        p[r] = corner[r] - (WIDE - COLUMNS) / 2.0 * f->spacing[0] * f->x[r] -
               (HIGH - ROWS) / 2.0 * f->spacing[1] * f->y[r];
    snprintf(place, sizeof place, "%.10g\\%.10g\\%.10g", p[0], p[1], p[2]);
    test_image_write(&(test_image){.instance = instance,
                                   .columns = WIDE,
                                   .rows = HIGH,
                                   .type = "ORIGINAL\\PRIMARY\\M\\MOSAIC",
                                   .between = "2.5",
                                   .csa = header ? header->bytes : NULL,
                                   .csa_bytes = header ? header->size : 0,
                                   .position = place,
                                   .orientation = "0\\0.6\\-0.8\\1\\0\\0",
                                   .spacing = "3\\2",
                                   .is_signed = true,
                                   .slope = "0.1",
                                   .pixels = pixels},
                     name);
}

static void mosaics_are_unfolded(void **state)
{
    (void)state;
    static const char *const normals[2][3] = {{"0.0", " 0.80000000", "0.60000000"},
                                              {"0.0", "-0.80000000", "-0.60000000"}};
    for (int n = 0; n < 4; n++) {
        const csa header = make_csa(n / 2, "3", normals[n % 2]);
        write_mosaic("m.dcm", 1, &header, n % 2 ? 1 : -1);
        cw_volume v = read_all(NULL);
        double spacing[3];
        cw_volume_spacing(&v, spacing);
        assert_true(v.dim[0] == COLUMNS && v.dim[1] == ROWS && v.dim[2] == 3 && v.steps == 1);
        assert_near(spacing[2], 2.5, 1e-9);
        assert_is_field(&v);
        cw_volume_free(&v);
    }
    const csa header = make_csa(true, "3", normals[1]);
    write_mosaic("n.dcm", 2, &header, 1);
    cw_volume v = read_all(NULL); /* two moments */
    assert_true(v.dim[2] == 3 && v.steps == 2);
    assert_is_field(&v);
    cw_volume_free(&v);
    check_regions("", NULL);
}

static void mosaics_of_unknown_places_are_refused(void **state)
{
    (void)state;
    static const char *const normal[3] = {"0", "-0.8", "-0.6"}, *const other[3] = {"1", "0",
                                                                                   "0"};
    write_mosaic("m.dcm", 1, NULL, 1);
    assert_refused(NULL, CW_ERR_FORMAT, "mosaic of slices, and has no CSA header (0029,1010)");
    csa header = make_csa(true, "3", other);
    write_mosaic("m.dcm", 1, &header, 1);
    assert_refused(NULL, CW_ERR_FORMAT, "not normal to ImageOrientationPatient");
    header = make_csa(true, "70", normal);
    write_mosaic("m.dcm", 1, &header, 1);
    assert_refused(NULL, CW_ERR_FORMAT, "no multiples of a slice's");
    header = make_csa(true, "-1", normal);
    write_mosaic("m.dcm", 1, &header, 1);
    assert_refused(NULL, CW_ERR_FORMAT, "not from 1 to 4096");
    for (int newer = 0; newer < 2; newer++) {
        header = make_csa(newer, "3", normal);
        const size_t whole = header.size;
        for (size_t i = 0; i < whole / 4; i++) { /* a length or a count that lies */
            csa damaged = header;
            cw_volume v;
            memset(damaged.bytes + 4 * i, 0xff, 4);
            write_mosaic("m.dcm", 1, &damaged, 1);
            const cw_read_desc desc = {.no_sandbox = true};
            if (cw_volume_read(test_path("m.dcm"), &desc, &v, NULL, NULL) == CW_OK)
                cw_volume_free(&v);
        }
        for (header.size = 100; header.size < 600; header.size += 100) {
            write_mosaic("m.dcm", 1, &header, 1);
            assert_refused(NULL, CW_ERR_FORMAT, "CSA header (0029,1010) is damaged");
        }
    }
}

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

static void notes_keep(void *user, const char *text)
{
    snprintf((char *)user + strlen(user), 512 - strlen(user), "%s\n", text);
}

/* Somebody else's file beside it is no reason to refuse the one that was named. */
static void damaged_neighbours_are_left_out(void **state)
{
    (void)state;
    const double even[] = {0, 2.5, 5};
    char notes[512] = "";
    const cw_read_desc desc = {.note = notes_keep, .note_user = notes};
    write_row(&upright, even, 3, 0);
    size_t size;
    char *bytes = test_file_read(test_path("90.dcm"), &size);
    test_file_write(test_path("10.dcm"), bytes, size / 2);
    free(bytes);
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_volume_read(test_path("89.dcm"), &desc, &v, NULL, &err), err);
    assert_int_equal(v.dim[2], 3);
    cw_volume_free(&v);
    assert_non_null(strstr(
        notes, "left out, because they cannot be read: 1 files beside it, the first 10.dcm: "));
    assert_refused(NULL, CW_ERR_FORMAT, "10.dcm: its elements are damaged or cut off");
    assert_fails(read_back("10.dcm", &v, &err), CW_ERR_FORMAT, "damaged or cut off", err);
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
    assert_refused(NULL, CW_ERR_FORMAT, "; 1 links were left out, --allow-external follows");
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
    assert_string_equal(notes, "left out: 1 links; --allow-external follows them\n");
    assert_int_equal(unlink(test_path("89.dcm")), 0);
    assert_int_equal(unlink(test_path("88.dcm")), 0);
    assert_refused(NULL, CW_ERR_IO, "no file, only 1 links; --allow-external follows them");
    test_file_write(test_path("readme.md"), "hello", 5);
    assert_refused(NULL, CW_ERR_FORMAT,
                   "none of its 1 files is a slice in a format that is read (DICOM, TIFF); 1 "
                   "links were left out, --allow-external follows them");
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
        char name[16], place[16];
        snprintf(name, sizeof name, "%d", n);
        snprintf(place, sizeof place, "0\\0\\%d", n % 3);
        test_image_write(&(test_image){.instance = n,
                                       .samples = 3,
                                       .bits = 8,
                                       .position = place,
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
        TEST(every_kind_of_pixel_is_read),
        TEST(slices_with_a_scale_each_become_values),
        TEST(padding_is_no_data),
        TEST(padding_of_either_neighbour_is_no_data),
        TEST(a_key_that_is_the_same_for_all_orders_nothing),
        TEST(values_of_long_pixels_are_doubles),
        TEST(runs_are_read),
        TEST(frames_have_a_place_each),
        TEST(segments_become_labels),
        TEST(label_maps_have_their_slices),
        TEST(runs_of_bits_are_read),
        TEST(mosaics_are_unfolded),
        TEST(mosaics_of_unknown_places_are_refused),
        TEST(every_cut_is_an_error),
        TEST(sizes_are_held_against_the_file),
        TEST(deep_nesting_is_survived),
        TEST(deflated_files_are_walked_over),
        TEST(unknown_syntaxes_are_named),
        TEST(frames_are_counted_from_one),
        TEST(files_without_a_preamble_are_read),
        TEST(damaged_neighbours_are_left_out),
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
