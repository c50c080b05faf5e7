/* Decodes pictures of textures: PNG as such, JPEG as the strip of a TIFF. */
#define _GNU_SOURCE /* memfd_create */
#include <cubewright/formats.h>
#include <cubewright/picture.h>

#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/bytes/little_endian.h"

#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

enum { MAX_SIDE = 16384, TIFF_HEAD = 160, ENTRY = 12 };

/* The frame of a JPEG. */
typedef struct jpeg_frame {
    unsigned width, height, components;
    bool is_rgb; /* it is not turned to luma and chroma */
} jpeg_frame;

static unsigned get_big(const uint8_t *p)
{
    return (unsigned)p[0] << 8 | p[1];
}

/* Finds the frame among the segments of a JPEG. */
static bool find_frame(const uint8_t *b, size_t size, jpeg_frame *frame)
{
    *frame = (jpeg_frame){0};
    for (size_t at = 2; at + 10 < size && b[at] == 0xff;) {
        const unsigned marker = b[at + 1];
        if (marker == 0xff) {
            at++;
            continue;
        }
        const size_t length = get_big(b + at + 2);
        if (marker == 0xee && length >= 14 && at + 16 <= size &&
            memcmp(b + at + 4, "Adobe", 5) == 0)
            frame->is_rgb = b[at + 15] == 0;
        if (marker >= 0xc0 && marker <= 0xc2) {
            frame->height = get_big(b + at + 5);
            frame->width = get_big(b + at + 7);
            frame->components = b[at + 9];
            return frame->width && frame->height;
        }
        at += 2 + length;
    }
    return false;
}

static unsigned char *put_entry(unsigned char *to, unsigned tag, unsigned type, unsigned count,
                                uint32_t value)
{
    const uint32_t head = tag | type << 16;
    cwi_put_u32(to, head);
    cwi_put_u32(to + 4, count);
    cwi_put_u32(to + 8, value);
    return to + ENTRY;
}

/* Makes the head of a TIFF whose only strip is the JPEG behind it. */
static void make_tiff(const jpeg_frame *f, size_t size, unsigned char head[TIFF_HEAD])
{
    enum { SHORT = 3, LONG = 4, JPEG = 7, GREY = 1, RGB = 2, YCBCR = 6 };
    const bool is_ycbcr = f->components == 3 && !f->is_rgb;
    const uint32_t bits_at = TIFF_HEAD - 8;
    memset(head, 0, TIFF_HEAD);
    memcpy(head, "II*\0\x8\0\0\0", 8);
    unsigned char *to = head + 10;
    to = put_entry(to, 256, LONG, 1, f->width);
    to = put_entry(to, 257, LONG, 1, f->height);
    to = put_entry(to, 258, SHORT, f->components, f->components == 1 ? 8 : bits_at);
    to = put_entry(to, 259, SHORT, 1, JPEG);
    to = put_entry(to, 262, SHORT, 1, f->components == 1 ? GREY : is_ycbcr ? YCBCR : RGB);
    to = put_entry(to, 273, LONG, 1, TIFF_HEAD);
    to = put_entry(to, 277, SHORT, 1, f->components);
    to = put_entry(to, 278, LONG, 1, f->height);
    to = put_entry(to, 279, LONG, 1, (uint32_t)size);
    to = put_entry(to, 284, SHORT, 1, 1);
    if (is_ycbcr)
        to = put_entry(to, 530, SHORT, 2, 2 | 2 << 16);
    head[8] = (unsigned char)((to - head - 10) / ENTRY);
    for (size_t n = 0; n < 3; n++)
        head[bits_at + 2 * n] = 8;
}

static bool write_all(int fd, const void *bytes, size_t size)
{
    for (size_t at = 0; at < size;) {
        const ssize_t wrote = write(fd, (const char *)bytes + at, size - at);
        if (wrote <= 0)
            return false;
        at += (size_t)wrote;
    }
    return true;
}

/* Reads a file of pictures that lies in memory. */
static cw_status read_memory(const void *head, size_t head_size, const uint8_t *bytes,
                             size_t size, const char *reader, cw_volume *volume, cw_error *err)
{
    char path[40];
    const int fd = memfd_create("picture", MFD_CLOEXEC);
    if (fd < 0)
        return cwi_fail_memory(err);
    snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
    const cw_read_desc desc = {.reader = reader};
    cw_status st = write_all(fd, head, head_size) && write_all(fd, bytes, size)
                       ? cw_volume_read(path, &desc, volume, NULL, err)
                       : cwi_fail_memory(err);
    close(fd);
    return st;
}

static uint8_t sample_at(const cw_volume *v, size_t at)
{
    return v->type == CW_U16
               ? (uint8_t)((((const uint16_t *)v->data)[at] * 255u + 32767) / 65535)
               : ((const uint8_t *)v->data)[at];
}

/* The palette of a PNG: 3 bytes a colour, and opacity of the first ones. */
typedef struct png_palette {
    const uint8_t *colors, *opacity;
    size_t count, opacity_count;
} png_palette;

/* Finds the palette among the chunks of a PNG. One of greys alone is none: its pixels are greys already. */
static png_palette find_palette(const uint8_t *b, size_t size)
{
    png_palette p = {0};
    bool is_grey = true;
    for (size_t at = 8; at + 12 <= size;) {
        const size_t length = (size_t)get_big(b + at) << 16 | get_big(b + at + 2);
        if (length > size - at - 12)
            break;
        if (memcmp(b + at + 4, "PLTE", 4) == 0) {
            p.colors = b + at + 8;
            p.count = length / 3;
        } else if (memcmp(b + at + 4, "tRNS", 4) == 0) {
            p.opacity = b + at + 8;
            p.opacity_count = length;
        }
        at += 12 + length;
    }
    for (size_t n = 0; n < 3 * p.count; n++)
        is_grey = is_grey && p.colors[n] == p.colors[n - n % 3];
    return is_grey ? (png_palette){0} : p;
}

/* Replaces numbers of colours, which are greys so far. */
static void apply_palette(const png_palette *p, cw_image *image)
{
    for (size_t n = 0; p->count && n < image->width * image->height; n++) {
        uint8_t *pixel = image->pixels + 4 * n;
        const size_t color = pixel[0] < p->count ? pixel[0] : 0;
        memcpy(pixel, p->colors + 3 * color, 3);
        pixel[3] = color < p->opacity_count ? p->opacity[color] : 255;
    }
}

/* Copies pixels of 1 to 4 samples: grey, grey and alpha, colour, colour and alpha. */
static cw_status copy_pixels(const cw_volume *v, cw_image *image, cw_error *err)
{
    const size_t samples = v->components ? v->components : 1;
    if ((v->type != CW_U8 && v->type != CW_U16) || samples > 4 || v->dim[2] > 1)
        return cwi_fail(err, CW_ERR_UNSUPPORTED, "a picture of %zu samples", samples);
    cw_status st = cw_image_alloc(image, v->dim[0], v->dim[1], err);
    for (size_t n = 0; st == CW_OK && n < v->dim[0] * v->dim[1]; n++) {
        const bool is_grey = samples < 3, has_alpha = samples % 2 == 0;
        for (size_t c = 0; c < 3; c++)
            image->pixels[4 * n + c] = sample_at(v, samples * n + (is_grey ? 0 : c));
        image->pixels[4 * n + 3] = has_alpha ? sample_at(v, samples * n + samples - 1) : 255;
    }
    return st;
}

cw_status cw_image_decode(const uint8_t *bytes, size_t size, cw_image *image, cw_error *err)
{
    CWI_REQUIRE(err, bytes, image);
    enum { COLOR_TYPE = 25, PALETTE = 3 };
    unsigned char head[TIFF_HEAD];
    const bool is_png = size > COLOR_TYPE && memcmp(bytes, "\x89PNG", 4) == 0;
    jpeg_frame frame = {0};
    cw_volume volume = {0};
    *image = (cw_image){0};
    if (!is_png && (size < 4 || bytes[0] != 0xff || bytes[1] != 0xd8))
        return cwi_fail(err, CW_ERR_UNSUPPORTED, "a picture that is neither PNG nor JPEG");
    if (!is_png && !find_frame(bytes, size, &frame))
        return cwi_fail(err, CW_ERR_FORMAT, "a JPEG without a frame");
    if (!is_png && frame.components != 1 && frame.components != 3)
        return cwi_fail(err, CW_ERR_UNSUPPORTED, "a JPEG of %u components", frame.components);
    if (frame.width > MAX_SIDE || frame.height > MAX_SIDE || size > UINT32_MAX - TIFF_HEAD)
        return cwi_fail(err, CW_ERR_LIMIT, "a picture of %u x %u pixels; each side may have %d",
                        frame.width, frame.height, MAX_SIDE);
    if (!is_png)
        make_tiff(&frame, size, head);
    cw_status st = read_memory(head, is_png ? 0 : TIFF_HEAD, bytes, size,
                               is_png ? "png" : "tiff", &volume, err);
    if (st == CW_OK)
        st = copy_pixels(&volume, image, err);
    if (st == CW_OK && is_png && bytes[COLOR_TYPE] == PALETTE) {
        const png_palette palette = find_palette(bytes, size);
        apply_palette(&palette, image);
    }
    cw_volume_free(&volume);
    return st;
}
