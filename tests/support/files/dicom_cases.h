/* Series of DICOM files that tests of the reader share. */
#ifndef TESTS_DICOM_CASES_H
#define TESTS_DICOM_CASES_H

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

static inline cw_status read_folder(const cw_read_desc *desc, cw_volume *v, cw_error *err)
{
    return cw_volume_read(test_path(""), desc, v, NULL, err);
}

static inline cw_volume read_all(const cw_read_desc *desc)
{
    cw_volume v;
    cw_error err = {0};
    assert_ok(read_folder(desc, &v, &err), err);
    return v;
}

static inline void assert_refused(const cw_read_desc *desc, cw_status expected,
                                  const char *words)
{
    cw_volume v;
    cw_error err = {0};
    assert_fails(read_folder(desc, &v, &err), expected, words, err);
    assert_null(v.data);
}

/* A field that is linear in the world: trilinear samples of it are exact wherever they are. */
static inline double field_at(const double p[3])
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
static inline void write_field_slice(const char *name, int instance, const slice_frame *f,
                                     const double position[3])
{
    char origin[80], turn[120], spacing[40];
    int16_t pixels[PIXELS];
    for (int n = 0; n < PIXELS; n++) {
        double p[3];
        for (int r = 0; r < 3; r++)
            p[r] = position[r] + n % COLUMNS * f->spacing[0] * f->x[r] +
                   n / COLUMNS * f->spacing[1] * f->y[r];
        pixels[n] = (int16_t)lrint(10 * field_at(p));
    }
    snprintf(origin, sizeof origin, "%.10g\\%.10g\\%.10g", position[0], position[1],
             position[2]);
    snprintf(turn, sizeof turn, "%.10g\\%.10g\\%.10g\\%.10g\\%.10g\\%.10g", f->x[0], f->x[1],
             f->x[2], f->y[0], f->y[1], f->y[2]);
    snprintf(spacing, sizeof spacing, "%.10g\\%.10g", f->spacing[1], f->spacing[0]);
    test_image_write(&(test_image){.instance = instance,
                                   .position = origin,
                                   .orientation = turn,
                                   .spacing = spacing,
                                   .is_signed = true,
                                   .slope = "0.1",
                                   .pixels = pixels},
                     name);
}

/* Every voxel is the field's value at its place, to the rounding of pixels. */
static inline void assert_is_field(const cw_volume *v)
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
static inline void write_row(const slice_frame *f, const double *distances, int count,
                             double shear)
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

static inline void write_at(const char *name, int number, int instance, double z,
                            const char *series)
{
    char origin[40];
    snprintf(origin, sizeof origin, "0\\0\\%.6g", z);
    test_image_write(
        &(test_image){
            .number = number, .instance = instance, .position = origin, .series = series},
        name);
}

static inline void assert_pixels(const test_image *m, const double *expected, cw_type type)
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
                        expected[n * v.components + c], 0);
        }
    cw_volume_free(&v);
}

static inline void put_frame(test_dicom *d, const char *position, const char *slope,
                             int segment)
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

static inline void put_code(test_dicom *d, uint32_t tag, const char *value, const char *meaning)
{
    test_dicom_open_sequence(d, tag);
    test_dicom_open_item(d);
    test_dicom_text(d, 0x00080100, "SH", value);
    test_dicom_text(d, 0x00080102, "SH", "SCT");
    test_dicom_text(d, 0x00080104, "LO", meaning);
    test_dicom_close_item(d);
    test_dicom_close_sequence(d);
}

/* Two segments: 1 is red and has codes, 3 has a name alone. */
static inline void put_segments(test_dicom *d)
{
    static const uint16_t red[3] = {35579, 53663, 50858};
    test_dicom_open_sequence(d, 0x00620002); /* SegmentSequence */
    test_dicom_open_item(d);
    put_code(d, 0x00620003, "85756007", "Tissue");
    test_dicom_u16(d, 0x00620004, 1);
    test_dicom_text(d, 0x00620005, "LO", "left\tlung");
    test_dicom_bytes(d, 0x0062000d, "US", red, sizeof red);
    put_code(d, 0x0062000f, "10200004", "Liver");
    test_dicom_close_item(d);
    test_dicom_open_item(d);
    test_dicom_u16(d, 0x00620004, 3);
    test_dicom_text(d, 0x00620005, "LO", "rest");
    test_dicom_close_item(d);
    test_dicom_close_sequence(d);
}

static const char ENHANCED_CT[] = "1.2.840.10008.5.1.4.1.1.2.1",
                  SEGMENTATION[] = "1.2.840.10008.5.1.4.1.1.66.4",
                  LABEL_MAP[] = "1.2.840.10008.5.1.4.1.1.66.7",
                  FRACTIONS[] = "1.2.840.10008.5.1.4.1.1.66.4",
                  APART[] = "1.2.840.10008.5.1.4.1.1.66.4"; /* segments, which do not overlap */

static inline void put_head(test_dicom *d, const char *sop_class, const char *frames,
                            unsigned bits)
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
    if (sop_class == FRACTIONS)
        test_dicom_text(d, 0x00620001, "CS", "FRACTIONAL");
    if (sop_class != ENHANCED_CT)
        put_segments(d);
    if (sop_class == FRACTIONS)
        test_dicom_u16(d, 0x0062000e, 200); /* MaximumFractionalValue */
    if (sop_class == APART)
        test_dicom_text(d, 0x00620013, "CS", "NO");
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
static inline void begin_frames(test_dicom *d, test_dicom_syntax syntax, const char *sop_class,
                                const frame *frames, int count)
{
    char number[8];
    snprintf(number, sizeof number, "%d", count);
    test_dicom_begin(d, syntax);
    put_head(d, sop_class, number, sop_class == SEGMENTATION || sop_class == APART ? 1 : 8);
    test_dicom_open_sequence(d, 0x52009230); /* PerFrameFunctionalGroupsSequence */
    for (int n = 0; n < count; n++)
        put_frame(d, frames[n].position, frames[n].slope, frames[n].segment);
    test_dicom_close_sequence(d);
}

static inline void write_frames(const char *name, const char *sop_class, const frame *frames,
                                int count, const void *pixels, size_t bytes)
{
    test_dicom d;
    begin_frames(&d, TEST_DICOM_EXPLICIT, sop_class, frames, count);
    test_dicom_bytes(&d, 0x7fe00010, "OB", pixels, bytes);
    test_file_write(test_path(name), d.bytes, d.size);
    test_dicom_free(&d);
}

static inline void notes_keep(void *user, const char *text)
{
    snprintf((char *)user + strlen(user), 512 - strlen(user), "%s\n", text);
}

#endif
