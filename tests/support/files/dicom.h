/* DICOM files put together byte by byte, for the tests of its reader. */
#ifndef TESTS_DICOM_H
#define TESTS_DICOM_H

#include <cubewright/volume.h>

typedef enum test_dicom_syntax {
    TEST_DICOM_EXPLICIT,
    TEST_DICOM_IMPLICIT,
    TEST_DICOM_BIG_ENDIAN,
    TEST_DICOM_RLE,
    TEST_DICOM_DEFLATED, /* written as explicit: deflate it with test_dicom_deflate() */
    TEST_DICOM_HTJ2K,
    TEST_DICOM_FRAMES_DEFLATED,
    TEST_DICOM_STRANGE /* a syntax that nobody knows */
} test_dicom_syntax;

/* Bytes that grow. Zero is empty; free with test_dicom_free(). */
typedef struct test_dicom {
    unsigned char *bytes;
    size_t size, room;
    size_t head; /* bytes of preamble and meta header */
    test_dicom_syntax syntax;
} test_dicom;

/* Begins a file: preamble and meta header. */
void test_dicom_begin(test_dicom *d, test_dicom_syntax syntax);
void test_dicom_free(test_dicom *d);

/* Deflates all behind the meta header. */
void test_dicom_deflate(test_dicom *d);

/* One element: text (or backslash-parted numbers), 16-bit numbers, bytes as they are. Elements
 * must come in the order of their tags. */
void test_dicom_text(test_dicom *d, uint32_t tag, const char *vr, const char *text);
void test_dicom_u16(test_dicom *d, uint32_t tag, unsigned value);
void test_dicom_bytes(test_dicom *d, uint32_t tag, const char *vr, const void *bytes,
                      size_t size);

/* Sequences and their items, of undefined length. */
void test_dicom_open_sequence(test_dicom *d, uint32_t tag);
void test_dicom_open_item(test_dicom *d);
void test_dicom_close_item(test_dicom *d);
void test_dicom_close_sequence(test_dicom *d);

/* Pixels in fragments: opens the element, then one fragment after another. */
void test_dicom_open_fragments(test_dicom *d);
void test_dicom_fragment(test_dicom *d, const void *bytes, size_t size);

/* A Modality LUT. */
typedef struct test_lookup {
    uint16_t descriptor[3]; /* number of entries, first pixel, bits of an entry */
    const char *type;       /* ModalityLUTType; NULL: left out */
    const char *vr;         /* of the data: "US" or "OW" */
    const void *data;       /* as they lie in the file */
    size_t bytes;
} test_lookup;

/* Puts its sequence. */
void test_dicom_put_lookup(test_dicom *d, const test_lookup *lookup);

/* An image as scanners write them; zero fields are the defaults named beside them, NULL texts
 * leave an element out where it says so. */
typedef struct test_image {
    test_dicom_syntax syntax;
    const char *series;     /* UID; "1.2.3" */
    const char *identity;   /* SOPInstanceUID; made of series and instance */
    int number, instance;   /* SeriesNumber, InstanceNumber */
    unsigned columns, rows; /* 4, 3 */
    unsigned bits, stored;  /* 16, bits */
    bool is_signed;
    unsigned samples; /* 1; 3 for RGB */
    bool by_plane;
    const char *position;          /* "0\\0\\0"; "" leaves it out */
    const char *orientation;       /* "1\\0\\0\\0\\1\\0"; "" leaves it out */
    const char *spacing;           /* between rows, between columns: "1\\1"; "" leaves it out */
    const char *slope, *intercept; /* NULL: left out */
    const char *padding, *padding_limit;
    const char *trigger;       /* TriggerTime, NULL: left out */
    const char *type;          /* ImageType, NULL: left out */
    const char *between;       /* SpacingBetweenSlices, NULL: left out */
    const test_lookup *lookup; /* NULL: left out */
    const void *csa;           /* Siemens' CSA header, NULL: left out */
    size_t csa_bytes;
    const void *pixels; /* columns x rows x samples; NULL: counting from 0 */
    size_t pixel_bytes; /* 0: as many as the sizes ask for */
} test_image;

/* Makes such a file in memory, or under a name in the test's folder. */
void test_image_make(const test_image *image, test_dicom *d);
void test_image_write(const test_image *image, const char *name);

#endif
