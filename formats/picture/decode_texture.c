/* Decodes the pictures of textures: PNG, by libpng in a sandboxed process. */
#define _GNU_SOURCE /* memfd_create */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/picture/picture.h"
#include "formats/picture/picture_format.h"

#include <cubewright/formats.h>

#include <errno.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

enum { MAX_TEXELS = 16384 }; /* along a side, as of images */

/* Puts the bytes into a file in memory, which the sandboxed process gets. */
static cw_status put_into_file(const cw_texture *texture, int *fd, cw_error *err)
{
    *fd = memfd_create("cubewright", MFD_CLOEXEC);
    if (*fd < 0)
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no file in memory for a picture: %s",
                        strerror(errno));
    for (size_t at = 0; at < texture->size;) {
        const ssize_t n = write(*fd, texture->bytes + at, texture->size - at);
        if (n <= 0)
            return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for a picture of %zu bytes",
                            texture->size);
        at += (size_t)n;
    }
    return CW_OK;
}

/* Checks the facts, which are untrusted: libpng's process may have been taken over. */
static cw_status check_facts(const cwi_picture_facts *f, cw_error *err)
{
    const bool is_sane = f->columns > 0 && f->rows > 0 && f->samples >= 1 &&
                         f->samples <= CWI_PICTURE_SAMPLES &&
                         (f->type == CW_U8 || f->type == CW_U16);
    if (!is_sane)
        return cwi_fail(err, CW_ERR_BACKEND, "libpng's answer is not valid");
    if (f->columns > MAX_TEXELS || f->rows > MAX_TEXELS)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "a picture of %u x %u texels; at most %d are decoded", f->columns,
                        f->rows, MAX_TEXELS);
    if (f->has_palette)
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "a picture with a palette of colours is not decoded: save it as RGB");
    return CW_OK;
}

/* Widens packed samples to red, green, blue and opacity of 8 bits: greys are the same in all three. */
static void widen_row(const cwi_picture_facts *f, const uint8_t *row, uint8_t *pixels)
{
    const bool is_grey = f->samples < 3, has_alpha = f->samples % 2 == 0;
    for (size_t x = 0; x < f->columns; x++)
        for (size_t c = 0; c < 4; c++) {
            const size_t n = c == 3 ? f->samples - 1 : is_grey ? 0 : c;
            uint16_t wide = 255;
            if (c == 3 && !has_alpha)
                ;
            else if (f->type == CW_U8)
                wide = row[x * f->samples + n];
            else {
                memcpy(&wide, row + 2 * (x * f->samples + n), sizeof wide);
                wide = (uint16_t)((wide * 255U + 32767) / 65535);
            }
            pixels[4 * x + c] = (uint8_t)wide;
        }
}

static cw_status read_rows(cwi_planes *planes, const cwi_picture_facts *f, cw_image *image,
                           cw_error *err)
{
    const size_t row = (size_t)f->columns * f->samples * cw_type_size(f->type),
                 most = (4U << 20) / row + 1;
    uint8_t *rows = cwi_alloc_array(most, row);
    cw_status st =
        rows ? cw_image_alloc(image, f->columns, f->rows, err) : cwi_fail_memory(err);
    for (size_t y = 0; y < f->rows && st == CW_OK; y += most) {
        const size_t count = f->rows - y < most ? f->rows - y : most;
        st = cwi_planes_read(planes, 0, y, count, row, rows, err);
        for (size_t n = 0; n < count && st == CW_OK; n++)
            widen_row(f, rows + n * row, image->pixels + 4 * (y + n) * f->columns);
    }
    cwi_free(rows);
    return st;
}

static cw_status decode_png(const cw_texture *texture, const cw_read_desc *desc,
                            cw_image *image, cw_error *err)
{
    cwi_planes planes = {0};
    cwi_picture_facts facts;
    const void *shared;
    int fd = -1;
    cw_status st = put_into_file(texture, &fd, err);
    if (st == CW_OK)
        st = cwi_planes_open(&planes, "picture", "libpng", desc, err);
    if (st == CW_OK)
        st = cwi_planes_facts(&planes, fd, texture->size, &shared, err);
    if (st == CW_OK) {
        memcpy(&facts, shared, sizeof facts);
        st = check_facts(&facts, err);
    }
    if (st == CW_OK)
        st = read_rows(&planes, &facts, image, err);
    cwi_planes_close(&planes);
    if (fd >= 0)
        close(fd);
    return st;
}

cw_status cw_texture_decode(const cw_texture *texture, const cw_mesh_read_desc *desc,
                            cw_image *image, cw_error *err)
{
    CWI_REQUIRE(err, texture, image);
    CWI_REQUIRE_VERSION(err, desc, 0);
    const cw_mesh_read_desc given = desc ? *desc : (cw_mesh_read_desc){0};
    const cw_read_desc reading = {.max_bytes = given.max_bytes,
                                  .no_sandbox = given.no_sandbox,
                                  .timeout_s = given.timeout_s,
                                  .progress = given.progress};
    *image = (cw_image){0};
    if (!texture->bytes || !texture->size)
        return cwi_fail(err, CW_ERR_ARGUMENT, "there is no picture to decode");
    if (texture->size >= 3 && memcmp(texture->bytes, "\xff\xd8\xff", 3) == 0)
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "a picture in JPEG is not decoded: save it as PNG");
    if (!cwi_png_sniff(texture->bytes, texture->size))
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "a picture that is no PNG is not decoded: save it as PNG");
    const cw_status st = decode_png(texture, &reading, image, err);
    if (st != CW_OK)
        cw_image_free(image);
    return st;
}
