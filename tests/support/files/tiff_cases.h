/* TIFF files that tests of the reader share: pages of counted bytes, and pixels of every kind. */
#ifndef TESTS_TIFF_CASES_H
#define TESTS_TIFF_CASES_H

#include "core/base/module.h"
#include "support/files/reading.h"
#include "support/files/regions.h"
#include "support/files/tiffs.h"

#include <stdio.h>
#include <sys/stat.h>
#if CW_TEST_LIBTIFF
#include <tiffio.h>
#endif

static char notes[1024];

static inline void take_note(void *user, const char *text)
{
    (void)user;
    strncat(notes, text, sizeof notes - strlen(notes) - 2);
    strcat(notes, "\n");
}

static inline cw_status read_with(const char *name, cw_read_desc desc, cw_volume *v,
                                  cw_error *err)
{
    notes[0] = '\0';
    desc.note = take_note;
    return cw_volume_read(test_path(name), &desc, v, NULL, err);
}

static inline void read_good(const char *name, cw_volume *v)
{
    cw_error err = {0};
    assert_ok(read_with(name, (cw_read_desc){0}, v, &err), err);
}

static inline void save(test_tiff *t, const char *name)
{
    test_tiff_save(t, test_path(name));
}

static inline double value_at(const cw_volume *v, const size_t at[3], size_t component,
                              size_t step)
{
    cw_volume one;
    cw_error err = {0};
    assert_ok(cw_volume_select(v, component, step, &one, &err), err);
    return cw_volume_value(&one, at[0], at[1], at[2]);
}

/* A page of bytes that count up from a number on. */
enum { COLUMNS = 4, ROWS = 3, PIXELS = COLUMNS * ROWS };

static inline void add_bytes(test_tiff *t, test_page page, unsigned char first)
{
    unsigned char pixels[PIXELS];
    for (size_t i = 0; i < PIXELS; i++)
        pixels[i] = (unsigned char)(first + i);
    page.columns = COLUMNS;
    page.rows = ROWS;
    page.pixels = pixels;
    test_tiff_add(t, &page);
}

/* One file of one page. */
static inline void save_slice(const char *name, unsigned char first)
{
    test_tiff t = {0};
    add_bytes(&t, (test_page){0}, first);
    save(&t, name);
}
static const struct {
    uint16_t bits, format;
    cw_type type;
} kinds[] = {{1, 1, CW_U8},   {8, 1, CW_U8},   {16, 1, CW_U16}, {32, 1, CW_U32}, {8, 2, CW_I8},
             {16, 2, CW_I16}, {32, 2, CW_I32}, {32, 3, CW_F32}, {64, 3, CW_F64}};
enum { KINDS = sizeof kinds / sizeof *kinds, WIDE = 37, HIGH = 21, PAGES = 3, SAMPLES = 4 };

/* A number that a pixel of the kind may have: it fills all its bytes. */
static inline double number_of(size_t kind, size_t index)
{
    const uint32_t mixed = (uint32_t)index * 2654435761u;
    switch (kinds[kind].type) {
    case CW_I8:
        return (int8_t)(mixed >> 24);
    case CW_U16:
        return mixed >> 16;
    case CW_I16:
        return (int16_t)(mixed >> 16);
    case CW_U32:
        return mixed;
    case CW_I32:
        return (int32_t)mixed;
    case CW_F32:
        return (float)mixed / 7;
    case CW_F64:
        return (double)mixed / 7;
    default:
        return kinds[kind].bits == 1 ? mixed >> 31 : mixed >> 24;
    }
}

static inline void put_value(void *to, cw_type type, size_t index, double value)
{
#define CASE(name, ctype, text)                                                                \
    if (type == name)                                                                          \
        ((ctype *)to)[index] = (ctype)value;
    CW_TYPE_TABLE(CASE)
#undef CASE
}

/* The pages of a stack, one behind another. */
static inline void *make_pixels(size_t kind, size_t samples)
{
    const size_t count = (size_t)WIDE * HIGH * samples * PAGES;
    void *pixels = malloc(count * 8);
    assert_non_null(pixels);
    for (size_t i = 0; i < count; i++)
        put_value(pixels, kinds[kind].type, i, number_of(kind, i));
    return pixels;
}

static inline void check_pixels(const cw_volume *v, size_t kind, size_t samples)
{
    assert_int_equal(v->type, kinds[kind].type);
    assert_int_equal(v->dim[0], WIDE);
    assert_int_equal(v->dim[1], HIGH);
    assert_int_equal(v->dim[2], PAGES);
    assert_int_equal(v->components, samples);
    for (size_t c = 0; c < samples; c++) {
        cw_volume one;
        cw_error err = {0};
        assert_ok(cw_volume_select(v, c, 0, &one, &err), err);
        for (size_t i = 0; i < (size_t)WIDE * HIGH * PAGES; i++) {
            const double got =
                cw_volume_value(&one, i % WIDE, i / WIDE % HIGH, i / WIDE / HIGH);
            const double expected = (float)number_of(kind, i * samples + c);
            if ((float)got != (float)expected)
                fail_msg("voxel %zu of component %zu is %g, not %g", i, c, got, expected);
        }
    }
}
static const uint32_t per_unit[2][2] = {{5, 1}, {4, 1}}; /* pixels: 0.2 and 0.25 of a unit */

/* Saves `pages` pages, the first of them described. */
static inline void save_described(const char *name, const char *description, size_t pages)
{
    test_tiff t = {.high_first = true};
    for (size_t p = 0; p < pages; p++)
        add_bytes(&t,
                  (test_page){.description = p ? NULL : description,
                              .tags = {{282, 5, 1, per_unit[0]}, {283, 5, 1, per_unit[1]}}},
                  (unsigned char)(10 * p));
    save(&t, name);
}

#define OME_HEAD                                                                               \
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?><!-- OME-XML: do not edit -->"                  \
    "<OME xmlns=\"http://www.openmicroscopy.org/Schemas/OME/2016-06\"><Image ID=\"Image:0\">"
#define OME_SIZES                                                                              \
    "<Pixels DimensionOrder=\"XYZCT\" Type=\"uint8\" SizeX=\"4\" SizeY=\"3\" SizeZ=\"3\" "     \
    "SizeC=\"2\" SizeT=\"2\" "
#define OME_TAIL "</Pixels></Image></OME>"

static inline void make_folder(const char *name)
{
    assert_int_equal(mkdir(test_path(name), 0700), 0);
}

/* Of strips, tiles, rows that run backwards, channels and frames, and slices in files. */

#endif
