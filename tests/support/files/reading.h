/* Helpers that the tests of the readers share: files put together from text and voxels, and
 * checks of the volumes read back from them. */
#ifndef TESTS_READING_H
#define TESTS_READING_H

#include "core/base/memory.h"
#include "support/support.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

/* A file of a header and the bytes behind it. */
static inline void put_file(const char *name, const char *text, const void *bytes, size_t size)
{
    const size_t length = strlen(text);
    char *all = malloc(length + size + 1);
    assert_non_null(all);
    memcpy(all, text, length);
    if (size)
        memcpy(all + length, bytes, size);
    test_file_write(test_path(name), all, length + size);
    free(all);
}

/* The bytes as gzip or zlib data; free them. */
static inline unsigned char *pack_bytes(const void *bytes, size_t size, bool gzip,
                                        size_t *packed)
{
    z_stream z = {0};
    assert_int_equal(deflateInit2(&z, 6, Z_DEFLATED, MAX_WBITS + (gzip ? 16 : 0), 8, 0), Z_OK);
    const size_t room = size + 1000;
    unsigned char *out = malloc(room);
    assert_non_null(out);
    z.next_in = (Bytef *)(uintptr_t)bytes;
    z.avail_in = (uInt)size;
    z.next_out = out;
    z.avail_out = (uInt)room;
    assert_int_equal(deflate(&z, Z_FINISH), Z_STREAM_END);
    *packed = room - z.avail_out;
    deflateEnd(&z);
    return out;
}

static inline cw_status read_back(const char *name, cw_volume *volume, cw_error *err)
{
    return cw_volume_read(test_path(name), NULL, volume, NULL, err);
}

/* An index stands at a place of the world. */
static inline void assert_place(const cw_volume *v, double i, double j, double k, double x,
                                double y, double z)
{
    double world[3];
    cw_volume_to_world(v, (double[3]){i, j, k}, world);
    assert_near(world[0], x, 1e-12);
    assert_near(world[1], y, 1e-12);
    assert_near(world[2], z, 1e-12);
}

/* The affine is these 12 numbers, row by row, to the bit. */
static inline void check_affine(const cw_volume *volume, const double *expected)
{
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++)
            if (volume->affine[r][c] != expected[4 * r + c])
                fail_msg("affine[%d][%d] is %.17g, not %.17g", r, c, volume->affine[r][c],
                         expected[4 * r + c]);
}

/* Checks a file that the header named, cut behind every `step`-th byte, from byte `from` on: it
 * gives an error and no volume. Libraries run in this process, at every sixteenth cut in one of
 * their own: starting that takes a hundred times as long as reading such a file. */
static inline void check_some_cuts(const char *header, const char *data, size_t from,
                                   size_t step)
{
    size_t size;
    char *bytes = test_file_read(test_path(data), &size);
    for (size_t cut = from, n = 0; cut < size; cut += step, n++) {
        const cw_read_desc desc = {.no_sandbox = n % 16 != 0};
        cw_volume volume;
        cw_error err = {0};
        test_file_write(test_path(data), bytes, cut);
        const cw_status st = cw_volume_read(test_path(header), &desc, &volume, NULL, &err);
        if (st != (cut ? CW_ERR_FORMAT : CW_ERR_IO))
            fail_msg("%s, %zu of %zu bytes: status %d, %s", data, cut, size, (int)st,
                     st == CW_OK ? "it was read" : err.message);
        assert_null(volume.data);
    }
    test_file_write(test_path(data), bytes, size);
    free(bytes);
}

static inline void check_cuts(const char *header, const char *data, size_t from)
{
    check_some_cuts(header, data, from, 1);
}

static inline void check_every_cut(const char *name)
{
    check_cuts(name, name, 0);
}

/* Checks that compressed data reach to the end of a file that the header named: zeros behind
 * them change nothing, anything else is reported by its place; and their checksum is
 * verified. */
static inline void check_tail(const char *header, const char *data)
{
    size_t size;
    cw_volume none;
    cw_error damaged = {0};
    char words[40], *bytes = test_file_read(test_path(data), &size);
    bytes = realloc(bytes, size + 512);
    assert_non_null(bytes);
    memset(bytes + size, 0, 512);
    for (int spoilt = 0; spoilt < 2; spoilt++) {
        cw_volume volume;
        cw_error err = {0};
        bytes[size + 300] = (char)spoilt;
        snprintf(words, sizeof words, "byte %zu of the file is behind", size + 300);
        test_file_write(test_path(data), bytes, size + 512);
        const cw_status st = read_back(header, &volume, &err);
        if (spoilt)
            assert_fails(st, CW_ERR_FORMAT, words, err);
        else
            assert_ok(st, err);
        cw_volume_free(&volume);
    }
    bytes[size - 2] ^= 1; /* bits of the last byte may be padding */
    test_file_write(test_path(data), bytes, size);
    assert_fails(read_back(header, &none, &damaged), CW_ERR_FORMAT,
                 "the compressed data are damaged", damaged);
    bytes[size - 2] ^= 1;
    test_file_write(test_path(data), bytes, size);
    free(bytes);
}

/* Checks the message about a file that is wrong. */
static inline void check_told(const char *name, size_t index, const char *words)
{
    cw_volume volume;
    cw_error err = {0};
    if (read_back(name, &volume, &err) == CW_OK)
        fail_msg("case %zu was read; not: %s", index, words);
    if (!strstr(err.message, words))
        fail_msg("case %zu says: %s; not: %s", index, err.message, words);
}

/* Whatever allocation fails, the reader says so and leaves nothing behind. */
static inline void check_starved(const char *name, const cw_read_desc *desc)
{
    for (long n = 0;; n++) {
        cw_volume volume;
        cw_error err = {0};
        cwi_alloc_fail_after(n);
        const cw_status st = cw_volume_read(test_path(name), desc, &volume, NULL, &err);
        if (!cwi_alloc_fail_after(-1)) {
            assert_ok(st, err);
            cw_volume_free(&volume);
            assert_true(n > 0);
            return;
        }
        assert_fails(st, CW_ERR_NO_MEMORY, "no memory", err);
        assert_null(volume.data);
    }
}

static inline void check_starved_reads(const char *name)
{
    check_starved(name, NULL);
}

#endif
