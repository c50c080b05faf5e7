/* Reads PNG by libpng: greys of fewer bits than 8 become 8 bits, palettes of greys become greys, and
 * other palettes numbers of colours. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/bytes/byte_order.h"
#include "formats/picture/picture_file.h"

#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <string.h>

enum { DEFLATE_RATIO = 1032 };
static const double MM_PER_METRE = 1000;

typedef struct reading {
    cwi_picture_file *file;
    png_structp png;
    png_infop info;
    png_bytep *rows;
    unsigned char greys[256]; /* of a palette of greys */
    int colors;               /* in the palette; 0: none */
    bool is_starved;
    char words[120]; /* of libpng */
} reading;

static void on_error(png_structp png, png_const_charp words)
{
    reading *r = png_get_error_ptr(png);
    snprintf(r->words, sizeof r->words, "%s", words);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp words)
{
    (void)png, (void)words;
}

static png_voidp on_alloc(png_structp png, png_alloc_size_t size)
{
    reading *r = png_get_mem_ptr(png);
    void *memory = cwi_alloc_array(size, 1);
    r->is_starved = r->is_starved || !memory;
    return memory;
}

static void on_free(png_structp png, png_voidp memory)
{
    (void)png;
    cwi_free(memory);
}

static void on_read(png_structp png, png_bytep to, size_t size)
{
    cwi_picture_file *f = ((reading *)png_get_io_ptr(png))->file;
    if (!cwi_picture_read_at(f, f->at, to, size))
        png_error(png, "the file ends too early");
    f->at += size;
}

/* Finds the size of pixels. Programs that know none write 72 or 96 per inch. */
static void find_pixel_size(const reading *r, cwi_picture_facts *facts)
{
    enum { SCREEN = 2835, OTHER_SCREEN = 3780, SLACK = 1 };
    png_uint_32 per_metre[2];
    int unit;
    if (!png_get_pHYs(r->png, r->info, &per_metre[0], &per_metre[1], &unit) ||
        unit != PNG_RESOLUTION_METER || per_metre[0] <= 1 || per_metre[1] <= 1 ||
        per_metre[0] - (SCREEN - SLACK) <= 2 * SLACK ||
        per_metre[0] - (OTHER_SCREEN - SLACK) <= 2 * SLACK)
        return;
    for (int a = 0; a < 2; a++)
        facts->pixel_mm[a] = MM_PER_METRE / per_metre[a];
}

/* Reads the facts, and sets how libpng converts the pixels. */
static void read_facts(reading *r)
{
    cwi_picture_facts *facts = &r->file->facts;
    png_set_read_fn(r->png, r, on_read);
    png_read_info(r->png, r->info);
    const int color = png_get_color_type(r->png, r->info);
    const unsigned depth = png_get_bit_depth(r->png, r->info);
    *facts = (cwi_picture_facts){.columns = png_get_image_width(r->png, r->info),
                                 .rows = png_get_image_height(r->png, r->info),
                                 .samples = png_get_channels(r->png, r->info),
                                 .bits = depth,
                                 .type = depth == 16 ? CW_U16 : CW_U8,
                                 .max_ratio = DEFLATE_RATIO};
    png_colorp palette = NULL;
    if (color == PNG_COLOR_TYPE_PALETTE &&
        png_get_PLTE(r->png, r->info, &palette, &r->colors)) {
        facts->has_palette =
            !cwi_picture_is_grey(&palette->red, (size_t)r->colors, sizeof *palette);
        for (int i = 0; i < r->colors && i < 256; i++)
            r->greys[i] = palette[i].red;
    }
    find_pixel_size(r, facts);
}

static void read_pixels(reading *r)
{
    const cwi_picture_facts *facts = &r->file->facts;
    const size_t row = cwi_picture_row(facts);
    if (facts->bits < 8 && r->colors)
        png_set_packing(r->png);
    else if (facts->bits < 8)
        png_set_expand_gray_1_2_4_to_8(r->png);
    if (facts->bits == 16 && !cwi_machine_is_big_endian())
        png_set_swap(r->png);
    png_set_interlace_handling(r->png);
    png_read_update_info(r->png, r->info);
    if (png_get_rowbytes(r->png, r->info) != row)
        png_error(r->png, "a row has another size than was expected");
    for (uint32_t y = 0; y < facts->rows; y++)
        r->rows[y] = r->file->pixels + y * row;
    png_read_image(r->png, r->rows);
    png_read_end(r->png, NULL);
}

/* Replaces numbers of colours by greys. A number that the palette lacks is an error. */
static cw_status apply_palette(const reading *r, cw_error *err)
{
    const cwi_picture_facts *facts = &r->file->facts;
    unsigned char *pixels = r->file->pixels;
    const size_t count = (size_t)facts->columns * facts->rows;
    for (size_t i = 0; r->colors && i < count; i++) {
        if (pixels[i] >= r->colors)
            return cwi_fail(err, CW_ERR_FORMAT, "a pixel has the colour %d; 'PLTE' has %d",
                            pixels[i], r->colors);
        if (!facts->has_palette)
            pixels[i] = r->greys[pixels[i]];
    }
    return CW_OK;
}

static cw_status fail_reading(const reading *r, cw_error *err)
{
    return r->is_starved ? cwi_fail_memory(err)
                         : cwi_fail(err, CW_ERR_FORMAT, "the PNG cannot be read: %s", r->words);
}

/* Calls a function of libpng's, which comes back by a jump after an error. */
static cw_status run(reading *r, void (*function)(reading *), cw_error *err)
{
    if (setjmp(png_jmpbuf(r->png)))
        return fail_reading(r, err);
    function(r);
    return CW_OK;
}

cw_status cwi_picture_png(cwi_picture_file *f, bool with_pixels, cw_error *err)
{
    reading r = {.file = f};
    r.png = png_create_read_struct_2(PNG_LIBPNG_VER_STRING, &r, on_error, on_warning, &r,
                                     on_alloc, on_free);
    r.info = r.png ? png_create_info_struct(r.png) : NULL;
    cw_status st = r.info ? run(&r, read_facts, err) : cwi_fail_memory(err);
    if (st == CW_OK && with_pixels)
        st = cwi_picture_reserve(f, err);
    if (st == CW_OK && with_pixels &&
        !(r.rows = cwi_alloc_array(f->facts.rows, sizeof *r.rows)))
        st = cwi_fail_memory(err);
    if (st == CW_OK && with_pixels)
        st = run(&r, read_pixels, err);
    if (st == CW_OK && with_pixels)
        st = apply_palette(&r, err);
    if (st != CW_OK) {
        cwi_free(f->pixels);
        f->pixels = NULL;
    }
    cwi_free(r.rows);
    png_destroy_read_struct(&r.png, &r.info, NULL);
    return st;
}
