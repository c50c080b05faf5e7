/* Allocates pictures of floats, composites them over a background into bytes, and compares
 * images. */
#include <cubewright/picture.h>

#include "core/base/memory.h"
#include "core/base/status.h"

#include <math.h>
#include <stdlib.h>

enum { MAX_SIZE = 16384 };

cw_status cw_picture_alloc(cw_picture *picture, size_t width, size_t height, cw_error *err)
{
    CWI_REQUIRE(err, picture);
    *picture = (cw_picture){0};
    if (width < 1 || width > MAX_SIZE || height < 1 || height > MAX_SIZE)
        return cwi_fail(err, CW_ERR_ARGUMENT, "a picture of %zu x %zu: expected 1 to %d pixels",
                        width, height, MAX_SIZE);
    picture->pixels = cwi_alloc_zeroed(width * height, 4 * sizeof(float));
    if (!picture->pixels)
        return cwi_fail_memory(err);
    picture->width = width;
    picture->height = height;
    return CW_OK;
}

void cw_picture_free(cw_picture *picture)
{
    if (!picture)
        return;
    cwi_free(picture->pixels);
    *picture = (cw_picture){0};
}

static uint8_t to_byte(double fraction)
{
    return (uint8_t)lround(255 * fmin(fmax(fraction, 0), 1));
}

/* Composites one pixel over a background, whose colours are not premultiplied. */
static void show_pixel(const float *pixel, const double background[4], uint8_t *out)
{
    const double through = fmax(1 - (double)pixel[3], 0) * background[3];
    const double alpha = (double)pixel[3] + through;
    for (int c = 0; c < 3; c++)
        out[c] = alpha > 0 ? to_byte(((double)pixel[c] + through * background[c]) / alpha) : 0;
    out[3] = to_byte(alpha);
}

cw_status cw_picture_show(const cw_picture *picture, const uint8_t background[2][4],
                          cw_image *image, cw_error *err)
{
    CWI_REQUIRE(err, picture, background, image);
    const size_t w = picture->width, h = picture->height;
    cw_status st = cw_image_alloc(image, w, h, err);
    for (size_t y = 0; y < h && st == CW_OK; y++) {
        double row[4];
        const double fraction = ((double)y + 0.5) / (double)h;
        for (int c = 0; c < 4; c++)
            row[c] = ((1 - fraction) * background[0][c] + fraction * background[1][c]) / 255;
        for (size_t x = 0; x < w; x++)
            show_pixel(picture->pixels + 4 * (y * w + x), row, image->pixels + 4 * (y * w + x));
    }
    return st;
}

cw_status cw_image_compare(const cw_image *a, const cw_image *b, int tolerance, size_t *differ,
                           cw_error *err)
{
    CWI_REQUIRE(err, a, b, differ);
    *differ = 0;
    if (a->width != b->width || a->height != b->height)
        return cwi_fail(err, CW_ERR_ARGUMENT, "images of %zu x %zu and %zu x %zu pixels",
                        a->width, a->height, b->width, b->height);
    for (size_t n = 0; n < a->width * a->height; n++) {
        int largest = 0;
        for (size_t k = 0; k < 3; k++) {
            const int d = abs((int)a->pixels[4 * n + k] - (int)b->pixels[4 * n + k]);
            largest = d > largest ? d : largest;
        }
        *differ += largest > tolerance;
    }
    return CW_OK;
}
