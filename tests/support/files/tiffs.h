/* Small TIFF files, byte by byte: of either byte order, classic or Big, in strips or tiles.
 * What is compressed, libtiff writes. */
#ifndef TESTS_TIFFS_H
#define TESTS_TIFFS_H

#include <cubewright/volume.h>

/* A tag that the page's fields have no word for. */
typedef struct test_tag {
    uint16_t tag, type; /* as the file says */
    uint32_t count;
    const void *values; /* numbers of this machine; text */
} test_tag;

enum { TEST_TIFF_MAX_TAGS = 8 };

/* A zero field means what is said beside it. */
typedef struct test_page {
    uint32_t columns, rows; /* required */
    uint16_t samples;       /* 1 */
    uint16_t bits, format;  /* 8, 1 */
    uint16_t compression;   /* 1 */
    uint16_t photometric;   /* 0: black is 0; 100: white is */
    uint16_t orientation;   /* none */
    bool separate;          /* planes of one sample each */
    bool low_bit_first;
    uint32_t rows_per_strip; /* all; tiles: their length */
    uint32_t tile_width;     /* strips */
    uint32_t kind;           /* NewSubfileType */
    const char *description;
    test_tag tags[TEST_TIFF_MAX_TAGS];
    const void *pixels; /* interleaved, packed, of this machine; 1 bit: a byte each */
} test_page;

/* A file that grows; zeroed, it is little end first and classic. */
typedef struct test_tiff {
    bool high_first, big;
    unsigned char *bytes;
    size_t size, room;
    size_t link; /* where the next directory's offset belongs */
} test_tiff;

/* Puts numbers of `size` bytes each at the end; returns where. */
size_t test_tiff_put(test_tiff *t, const void *numbers, size_t count, size_t size);
void test_tiff_add(test_tiff *t, const test_page *page);

/* Overwrites a part of a tag in the first directory. */
typedef enum test_tag_part { TEST_TAG_TYPE, TEST_TAG_COUNT, TEST_TAG_VALUE } test_tag_part;
void test_tiff_poke(test_tiff *t, uint16_t tag, test_tag_part part, uint64_t number);

/* Writes the file and empties it. */
void test_tiff_save(test_tiff *t, const char *path);

#endif
