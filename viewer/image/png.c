/* Writes images of bytes as PNG files by libpng. */
#include <cubewright/picture.h>

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/files/atomic_file.h"

#include <png.h>
#include <setjmp.h>
#include <string.h>

/* Data for libpng's callbacks. The status outlives the jump by which they leave. */
typedef struct writer {
    cwi_outfile *file; /* NULL: into memory */
    uint8_t *bytes;
    size_t size, room;
    bool is_color;
    cw_error *err;
    cw_status status;
    bool starved; /* libpng itself reports this in many different words */
} writer;

static cw_status add_bytes(writer *w, const uint8_t *bytes, size_t size)
{
    if (size > w->room - w->size) {
        const size_t room = 2 * (w->size + size);
        uint8_t *longer = cwi_realloc_array(w->bytes, room, 1);
        if (!longer)
            return cwi_fail_memory(w->err);
        w->bytes = longer;
        w->room = room;
    }
    memcpy(w->bytes + w->size, bytes, size);
    w->size += size;
    return CW_OK;
}

static void on_bytes(png_structp png, png_bytep bytes, size_t size)
{
    writer *w = png_get_io_ptr(png);
    w->status =
        w->file ? cwi_outfile_write(w->file, bytes, size, w->err) : add_bytes(w, bytes, size);
    if (w->status != CW_OK)
        png_longjmp(png, 1);
}

static void on_flush(png_structp png)
{
    (void)png; /* the commit flushes */
}

static void on_error(png_structp png, png_const_charp words)
{
    writer *w = png_get_error_ptr(png);
    w->status = w->starved ? cwi_fail_memory(w->err)
                           : cwi_fail(w->err, CW_ERR_BACKEND, "libpng failed: %s", words);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp words)
{
    (void)png, (void)words; /* about the picture's metadata; we write none */
}

static png_voidp on_malloc(png_structp png, png_alloc_size_t size)
{
    writer *w = png_get_mem_ptr(png);
    void *memory = cwi_alloc_array(size, 1);
    w->starved = w->starved || !memory;
    return memory;
}

static void on_free(png_structp png, png_voidp memory)
{
    (void)png;
    cwi_free(memory);
}

static bool is_opaque(const cw_image *image)
{
    for (size_t i = 0; i < image->width * image->height; i++)
        if (image->pixels[4 * i + 3] != 255)
            return false;
    return true;
}

static bool is_little_endian(void)
{
    return *(const uint8_t *)&(const uint16_t){1} == 1;
}

/* Writes the image; leaves by libpng's jump on any error, so nothing here may own memory. */
static void put_image(png_structp png, png_infop info, const cw_image *image, bool is_color)
{
    const bool opaque = is_opaque(image);
    png_set_IHDR(png, info, (png_uint_32)image->width, (png_uint_32)image->height,
                 image->deep ? 16 : 8, opaque ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGBA,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (is_color)
        png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(png, info);
    if (opaque)
        png_set_filler(png, 0, PNG_FILLER_AFTER); /* pixels stay 4 channels apart in memory */
    if (image->deep && is_little_endian())
        png_set_swap(png);
    for (size_t y = 0; y < image->height; y++)
        png_write_row(png, image->deep ? (const uint8_t *)(image->deep + 4 * image->width * y)
                                       : image->pixels + 4 * image->width * y);
    png_write_end(png, info);
}

static cw_status encode_image(writer *w, const cw_image *image)
{
    png_structp png = png_create_write_struct_2(PNG_LIBPNG_VER_STRING, w, on_error, on_warning,
                                                w, on_malloc, on_free);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    if (!info) {
        png_destroy_write_struct(&png, &info);
        return w->status != CW_OK ? w->status : cwi_fail_memory(w->err);
    }
    if (setjmp(png_jmpbuf(png)) == 0) {
        png_set_write_fn(png, w, on_bytes, on_flush);
        put_image(png, info, image, w->is_color);
    }
    png_destroy_write_struct(&png, &info);
    return w->status;
}

cw_status cw_image_write(const char *path, const cw_image *image, cw_error *err)
{
    CWI_REQUIRE(err, path, image);
    writer w = {.err = err, .is_color = true};
    cw_status st = image->pixels
                       ? cwi_outfile_open(&w.file, path, false, err)
                       : cwi_fail(err, CW_ERR_ARGUMENT, "there is no picture to write");
    if (st == CW_OK)
        st = encode_image(&w, image);
    if (st == CW_OK)
        st = cwi_outfile_commit(&w.file, err);
    cwi_outfile_abort(&w.file);
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, path);
}

cw_status cw_image_encode(const cw_image *image, bool is_color, uint8_t **bytes, size_t *size,
                          cw_error *err)
{
    CWI_REQUIRE(err, image, bytes, size);
    writer w = {.err = err, .is_color = is_color};
    *bytes = NULL;
    *size = 0;
    if (!image->pixels)
        return cwi_fail(err, CW_ERR_ARGUMENT, "there is no picture to write");
    const cw_status st = encode_image(&w, image);
    if (st == CW_OK) {
        *bytes = w.bytes;
        *size = w.size;
    } else {
        cwi_free(w.bytes);
    }
    return st;
}

void cw_bytes_free(uint8_t *bytes)
{
    cwi_free(bytes);
}
