/* A picture in memory, and as a PNG file. */
#ifndef VIEWER_PNG_H
#define VIEWER_PNG_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A zeroed struct is a valid picture of nothing. */
typedef struct cwi_image {
    size_t width, height;
    uint8_t *pixels; /* height x width x 4: sRGB and alpha, not premultiplied; top row first */
} cwi_image;

CW_API cw_status cwi_image_alloc(cwi_image *image, size_t width, size_t height, cw_error *err);
CW_API void cwi_image_free(cwi_image *image);

/* Writes a PNG, tagged as sRGB; without its alpha channel when nothing is translucent. The file
 * appears only when whole. Returns CW_ERR_OUTPUT, CW_ERR_NO_MEMORY, CW_ERR_BACKEND (libpng's
 * own words); CW_ERR_ARGUMENT for a picture of nothing. */
CW_API cw_status cwi_png_write(const char *path, const cwi_image *image, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
