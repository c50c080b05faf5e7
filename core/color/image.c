/* Allocates images of bytes. */
#include "core/color/deep_image.h"

#include "core/base/memory.h"
#include "core/base/status.h"

cw_status cw_image_alloc(cw_image *image, size_t width, size_t height, cw_error *err)
{
    CWI_REQUIRE(err, image);
    size_t pixels;
    *image = (cw_image){0};
    if (cwi_size_mul(width, height, &pixels))
        image->pixels = cwi_alloc_zeroed(pixels, 4);
    if (!image->pixels)
        return cwi_fail_memory(err);
    image->width = width;
    image->height = height;
    return CW_OK;
}

cw_status cwi_image_deepen(cw_image *image, cw_error *err)
{
    const size_t pixels = image->width * image->height;
    image->deep = cwi_alloc_zeroed(pixels, 4 * sizeof *image->deep);
    return image->deep ? CW_OK : cwi_fail_memory(err);
}

void cw_image_free(cw_image *image)
{
    if (!image)
        return;
    cwi_free(image->pixels);
    cwi_free(image->deep);
    *image = (cw_image){0};
}
