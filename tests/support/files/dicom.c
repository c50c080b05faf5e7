/* Writes DICOM files: elements, sequences, fragments, and whole images in several transfer
 * syntaxes. */
#include "support/files/dicom.h"

#include "support/support.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

static void put(test_dicom *d, const void *bytes, size_t size)
{
    if (d->size + size > d->room) {
        d->room = 2 * (d->size + size) + 1024;
        d->bytes = realloc(d->bytes, d->room);
        assert_non_null(d->bytes);
    }
    if (size)
        memcpy(d->bytes + d->size, bytes, size);
    d->size += size;
}

static void put_number(test_dicom *d, uint32_t value, int bytes)
{
    unsigned char b[4];
    for (int i = 0; i < bytes; i++)
        b[d->syntax == TEST_DICOM_BIG_ENDIAN ? bytes - 1 - i : i] =
            (unsigned char)(value >> 8 * i);
    put(d, b, (size_t)bytes);
}

static void put_tag(test_dicom *d, uint32_t tag)
{
    put_number(d, tag >> 16, 2);
    put_number(d, tag & 0xffff, 2);
}

/* Some representations have a length of 32 bits, and two bytes in front of it. */
static void put_head(test_dicom *d, uint32_t tag, const char *vr, uint32_t size)
{
    const bool wide = strstr("OB OW OF OD SQ UN UT", vr) != NULL;
    put_tag(d, tag);
    if (d->syntax == TEST_DICOM_IMPLICIT) {
        put_number(d, size, 4);
        return;
    }
    put(d, vr, 2);
    if (wide)
        put_number(d, 0, 2);
    put_number(d, size, wide ? 4 : 2);
}

void test_dicom_bytes(test_dicom *d, uint32_t tag, const char *vr, const void *bytes,
                      size_t size)
{
    put_head(d, tag, vr, (uint32_t)(size + size % 2));
    put(d, bytes, size);
    if (size % 2)
        put(d, strcmp(vr, "UI") == 0 || vr[0] == 'O' ? "\0" : " ", 1);
}

void test_dicom_text(test_dicom *d, uint32_t tag, const char *vr, const char *text)
{
    test_dicom_bytes(d, tag, vr, text, strlen(text));
}

void test_dicom_u16(test_dicom *d, uint32_t tag, unsigned value)
{
    put_head(d, tag, "US", 2);
    put_number(d, value, 2);
}

void test_dicom_open_sequence(test_dicom *d, uint32_t tag)
{
    put_head(d, tag, "SQ", 0xffffffff);
}

static void put_mark(test_dicom *d, uint32_t tag, uint32_t size)
{
    put_tag(d, tag);
    put_number(d, size, 4);
}

void test_dicom_open_item(test_dicom *d)
{
    put_mark(d, 0xfffee000, 0xffffffff);
}

void test_dicom_close_item(test_dicom *d)
{
    put_mark(d, 0xfffee00d, 0);
}

void test_dicom_close_sequence(test_dicom *d)
{
    put_mark(d, 0xfffee0dd, 0);
}

void test_dicom_open_fragments(test_dicom *d)
{
    put_head(d, 0x7fe00010, "OB", 0xffffffff);
    put_mark(d, 0xfffee000, 0); /* no table of offsets */
}

void test_dicom_fragment(test_dicom *d, const void *bytes, size_t size)
{
    put_mark(d, 0xfffee000, (uint32_t)size);
    put(d, bytes, size);
}

void test_dicom_begin(test_dicom *d, test_dicom_syntax syntax)
{
    static const char *const names[] = {"1.2.840.10008.1.2.1",    "1.2.840.10008.1.2",
                                        "1.2.840.10008.1.2.2",    "1.2.840.10008.1.2.5",
                                        "1.2.840.10008.1.2.1.99", "1.2.840.10008.1.2.4.201",
                                        "1.2.840.10008.1.2.8.1",  "1.2.3.4.5"};
    static const char zeros[128];
    *d = (test_dicom){0};
    put(d, zeros, sizeof zeros);
    put(d, "DICM", 4);
    test_dicom_text(d, 0x00020002, "UI", "1.2.840.10008.5.1.4.1.1.2");
    test_dicom_text(d, 0x00020003, "UI", "1.2.3.4");
    test_dicom_text(d, 0x00020010, "UI", names[syntax]);
    d->syntax = syntax;
    d->head = d->size;
}

void test_dicom_deflate(test_dicom *d)
{
    z_stream z = {0};
    const size_t size = d->size - d->head;
    unsigned char *packed = malloc(size + size / 500 + 1024);
    assert_non_null(packed);
    assert_int_equal(deflateInit2(&z, 1, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY), Z_OK);
    z.next_in = d->bytes + d->head;
    z.avail_in = (uInt)size;
    z.next_out = packed;
    z.avail_out = (uInt)(size + size / 500) + 1024;
    assert_int_equal(deflate(&z, Z_FINISH), Z_STREAM_END);
    d->size = d->head;
    put(d, packed, z.total_out);
    deflateEnd(&z);
    free(packed);
}

void test_dicom_free(test_dicom *d)
{
    free(d->bytes);
    *d = (test_dicom){0};
}

void test_dicom_put_lookup(test_dicom *d, const test_lookup *l)
{
    test_dicom_open_sequence(d, 0x00283000);
    test_dicom_open_item(d);
    put_head(d, 0x00283002, "US", 6);
    for (int n = 0; n < 3; n++)
        put_number(d, l->descriptor[n], 2);
    if (l->type)
        test_dicom_text(d, 0x00283004, "LO", l->type);
    test_dicom_bytes(d, 0x00283006, l->vr, l->data, l->bytes);
    test_dicom_close_item(d);
    test_dicom_close_sequence(d);
}

static const char *or_else(const char *text, const char *otherwise)
{
    return text ? text : otherwise;
}

static void put_text_unless(test_dicom *d, uint32_t tag, const char *vr, const char *text)
{
    if (text && text[0])
        test_dicom_text(d, tag, vr, text);
}

static void put_identity(const test_image *m, test_dicom *d)
{
    char text[96];
    const char *series = or_else(m->series, "1.2.3");
    snprintf(text, sizeof text, "%s.%d", series, m->instance);
    put_text_unless(d, 0x00080008, "CS", m->type);
    test_dicom_text(d, 0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2");
    test_dicom_text(d, 0x00080018, "UI", or_else(m->identity, text));
    test_dicom_text(d, 0x00080020, "DA", "19700102");
    test_dicom_text(d, 0x00080060, "CS", "CT");
    test_dicom_text(d, 0x00100010, "PN", "DOE^JANE");
    test_dicom_text(d, 0x00100020, "LO", "SECRET-4711");
    put_text_unless(d, 0x00180088, "DS", m->between);
    put_text_unless(d, 0x00181060, "DS", m->trigger);
    test_dicom_text(d, 0x0020000e, "UI", series);
    snprintf(text, sizeof text, "%d", m->number);
    test_dicom_text(d, 0x00200011, "IS", text);
    snprintf(text, sizeof text, "%d", m->instance);
    test_dicom_text(d, 0x00200013, "IS", text);
    put_text_unless(d, 0x00200032, "DS", or_else(m->position, "0\\0\\0"));
    put_text_unless(d, 0x00200037, "DS", or_else(m->orientation, "1\\0\\0\\0\\1\\0"));
}

static void put_pixels(const test_image *m, test_dicom *d, size_t count, unsigned bits)
{
    const size_t bytes = m->pixel_bytes ? m->pixel_bytes : count * bits / 8;
    unsigned char *pixels = malloc(bytes + 8);
    assert_non_null(pixels);
    for (size_t i = 0; i * bits / 8 < bytes; i++) {
        const uint32_t n = (uint32_t)i;
        memcpy(pixels + i * bits / 8, &n, bits / 8);
    }
    if (m->pixels)
        memcpy(pixels, m->pixels, bytes);
    for (size_t i = 0; m->syntax == TEST_DICOM_BIG_ENDIAN && bits == 16 && i + 1 < bytes;
         i += 2) {
        const unsigned char low = pixels[i];
        pixels[i] = pixels[i + 1];
        pixels[i + 1] = low;
    }
    if (m->syntax == TEST_DICOM_HTJ2K || m->syntax == TEST_DICOM_FRAMES_DEFLATED) {
        test_dicom_open_fragments(d); /* as the standard wants compressed pixels */
        test_dicom_fragment(d, pixels, bytes + bytes % 2);
        test_dicom_close_sequence(d);
    } else {
        test_dicom_bytes(d, 0x7fe00010, bits > 8 ? "OW" : "OB", pixels, bytes);
    }
    free(pixels);
}

void test_image_make(const test_image *m, test_dicom *d)
{
    const unsigned columns = m->columns ? m->columns : 4, rows = m->rows ? m->rows : 3;
    const unsigned bits = m->bits ? m->bits : 16, samples = m->samples ? m->samples : 1;
    const unsigned stored = m->stored ? m->stored : bits;
    test_dicom_begin(d, m->syntax);
    put_identity(m, d);
    test_dicom_u16(d, 0x00280002, samples);
    test_dicom_text(d, 0x00280004, "CS", samples == 3 ? "RGB" : "MONOCHROME2");
    if (samples > 1)
        test_dicom_u16(d, 0x00280006, m->by_plane);
    test_dicom_u16(d, 0x00280010, rows);
    test_dicom_u16(d, 0x00280011, columns);
    put_text_unless(d, 0x00280030, "DS", or_else(m->spacing, "1\\1"));
    test_dicom_u16(d, 0x00280100, bits);
    test_dicom_u16(d, 0x00280101, stored);
    test_dicom_u16(d, 0x00280102, stored - 1);
    test_dicom_u16(d, 0x00280103, m->is_signed);
    if (m->padding)
        test_dicom_u16(d, 0x00280120, (unsigned)atoi(m->padding) & 0xffff);
    if (m->padding_limit)
        test_dicom_u16(d, 0x00280121, (unsigned)atoi(m->padding_limit) & 0xffff);
    put_text_unless(d, 0x00281052, "DS", m->intercept);
    put_text_unless(d, 0x00281053, "DS", m->slope);
    if (m->lookup)
        test_dicom_put_lookup(d, m->lookup);
    if (m->csa) {
        test_dicom_text(d, 0x00290011, "LO", "SIEMENS CSA HEADER");
        test_dicom_bytes(d, 0x00291110, "OB", m->csa, m->csa_bytes);
    }
    if (m->syntax != TEST_DICOM_RLE)
        put_pixels(m, d, (size_t)columns * rows * samples, bits);
}

void test_image_write(const test_image *m, const char *name)
{
    test_dicom d;
    test_image_make(m, &d);
    test_file_write(test_path(name), d.bytes, d.size);
    test_dicom_free(&d);
}
