/* Allocates images of bytes. */
#include <cubewright/picture.h>

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

void cw_image_free(cw_image *image)
{
    if (!image)
        return;
    cwi_free(image->pixels);
    *image = (cw_image){0};
}
