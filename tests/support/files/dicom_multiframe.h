/* DICOM files of several frames, for the tests of their order: the pixels of frame n are n. */
#ifndef TESTS_DICOM_MULTIFRAME_H
#define TESTS_DICOM_MULTIFRAME_H

#include "support/files/dicom_cases.h"

#define SOP               "1.2.840.10008.5.1.4.1.1."
#define NUCLEAR           SOP "20"
#define DOSE              SOP "481.2"
#define ULTRASOUND_VOLUME SOP "6.2"
#define ENHANCED_MR       SOP "4.1"

enum { MAX_FRAMES = 24, MAX_VECTORS = 4 };

/* A vector that counts frames, and its tag. */
typedef struct test_vector {
    uint32_t tag;
    uint16_t numbers[MAX_FRAMES];
} test_vector;

/* A file whose frames are counted by vectors; zero fields and NULL texts are left out. */
typedef struct test_counted {
    const char *sop_class, *modality, *type; /* ImageType */
    const char *between, *thickness;
    const char *position, *orientation;
    bool by_detector; /* position and orientation are in the DetectorInformationSequence */
    int frames;
    uint32_t pointers[MAX_VECTORS];   /* FrameIncrementPointer */
    test_vector vectors[MAX_VECTORS]; /* by tag, rising */
    int vector_length;                /* default: frames */
    const char *offsets;              /* GridFrameOffsetVector */
    const char *frame_time;
    bool is_unknown; /* vectors and offsets are stored as UN, as long ones have to be */
} test_counted;

static inline void put_optional(test_dicom *d, uint32_t tag, const char *vr, const char *text)
{
    if (text)
        test_dicom_text(d, tag, vr, text);
}

static inline void put_words(test_dicom *d, uint32_t tag, const char *vr, const uint16_t *words,
                             int count)
{
    test_dicom_bytes(d, tag, vr, words, (size_t)count * sizeof *words);
}

static inline void put_doubles(test_dicom *d, uint32_t tag, const double *numbers, int count)
{
    test_dicom_bytes(d, tag, "FD", numbers, (size_t)count * sizeof *numbers);
}

static inline void put_tags(test_dicom *d, uint32_t tag, const uint32_t *tags)
{
    uint16_t words[2 * MAX_VECTORS];
    int count = 0;
    for (; count < MAX_VECTORS && tags[count]; count++) {
        words[2 * count] = (uint16_t)(tags[count] >> 16);
        words[2 * count + 1] = (uint16_t)tags[count];
    }
    if (count)
        put_words(d, tag, "AT", words, 2 * count);
}

static inline void put_place(test_dicom *d, const char *position, const char *orientation)
{
    put_optional(d, 0x00200032, "DS", position);
    put_optional(d, 0x00200037, "DS", orientation);
}

/* Sizes of 8 bits a pixel, 4 x 3. */
static inline void put_sizes(test_dicom *d, const char *frames, const uint32_t *pointers,
                             const char *spacing)
{
    test_dicom_u16(d, 0x00280002, 1);
    test_dicom_text(d, 0x00280004, "CS", "MONOCHROME2");
    test_dicom_text(d, 0x00280008, "IS", frames);
    put_tags(d, 0x00280009, pointers);
    test_dicom_u16(d, 0x00280010, ROWS);
    test_dicom_u16(d, 0x00280011, COLUMNS);
    put_optional(d, 0x00280030, "DS", spacing);
    test_dicom_u16(d, 0x00280100, 8);
    test_dicom_u16(d, 0x00280101, 8);
    test_dicom_u16(d, 0x00280102, 7);
    test_dicom_u16(d, 0x00280103, 0);
}

static inline void put_numbered_pixels(test_dicom *d, int frames)
{
    uint8_t pixels[MAX_FRAMES * PIXELS];
    for (int n = 0; n < frames * PIXELS; n++)
        pixels[n] = (uint8_t)(n / PIXELS);
    test_dicom_bytes(d, 0x7fe00010, "OB", pixels, (size_t)frames * PIXELS);
}

static inline void put_counted(test_dicom *d, const test_counted *c)
{
    char frames[16];
    snprintf(frames, sizeof frames, "%d", c->frames);
    put_optional(d, 0x00080008, "CS", c->type);
    put_optional(d, 0x00080016, "UI", c->sop_class);
    test_dicom_text(d, 0x00080018, "UI", "1.2.3.9");
    put_optional(d, 0x00080060, "CS", c->modality);
    put_optional(d, 0x00180050, "DS", c->thickness);
    put_optional(d, 0x00180088, "DS", c->between);
    put_optional(d, 0x00181063, "DS", c->frame_time);
    test_dicom_text(d, 0x0020000e, "UI", "1.2.3");
    test_dicom_text(d, 0x00200013, "IS", "1");
    if (!c->by_detector)
        put_place(d, c->position, c->orientation);
    put_sizes(d, frames, c->pointers, "3\\2");
    for (int v = 0; v < MAX_VECTORS && c->vectors[v].tag && c->vectors[v].tag < 0x00540022; v++)
        put_words(d, c->vectors[v].tag, c->is_unknown ? "UN" : "US", c->vectors[v].numbers,
                  c->vector_length ? c->vector_length : c->frames);
    if (c->by_detector) {
        test_dicom_open_sequence(d, 0x00540022); /* DetectorInformationSequence */
        test_dicom_open_item(d);
        put_place(d, c->position, c->orientation);
        test_dicom_close_item(d);
        test_dicom_close_sequence(d);
    }
    for (int v = 0; v < MAX_VECTORS; v++)
        if (c->vectors[v].tag > 0x00540022)
            put_words(d, c->vectors[v].tag, c->is_unknown ? "UN" : "US", c->vectors[v].numbers,
                      c->vector_length ? c->vector_length : c->frames);
    put_optional(d, 0x3004000c, c->is_unknown ? "UN" : "DS", c->offsets);
    put_numbered_pixels(d, c->frames);
}

static inline void write_counted(const char *name, const test_counted *c)
{
    test_dicom d;
    test_dicom_begin(&d, TEST_DICOM_EXPLICIT);
    put_counted(&d, c);
    test_file_write(test_path(name), d.bytes, d.size);
    test_dicom_free(&d);
}

/* The frames of a volume are these, slice by slice, then step by step. */
static inline void assert_frames(const cw_volume *v, size_t slices, size_t steps,
                                 const int *frames)
{
    if (v->dim[2] != slices || v->steps != steps)
        fail_msg("%zu slices in %zu steps, not %zu in %zu", v->dim[2], v->steps, slices, steps);
    for (size_t n = 0; n < slices * steps; n++) {
        cw_volume step;
        assert_int_equal(cw_volume_select(v, 0, n / slices, &step, NULL), CW_OK);
        const double found = cw_volume_value(&step, 1, 1, n % slices);
        if (found != frames[n])
            fail_msg("slice %zu of step %zu is frame %g, not %d", n % slices, n / slices, found,
                     frames[n]);
    }
}

/* Column c of the affine is this vector. */
static inline void assert_column(const cw_volume *v, int c, double x, double y, double z)
{
    assert_near(v->affine[0][c], x, 1e-9);
    assert_near(v->affine[1][c], y, 1e-9);
    assert_near(v->affine[2][c], z, 1e-9);
}

#endif
