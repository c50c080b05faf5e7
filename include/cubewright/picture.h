/* Pictures: of floats as they are drawn, of bytes as they are shown, and how far two differ. */
#ifndef CUBEWRIGHT_PICTURE_H
#define CUBEWRIGHT_PICTURE_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What a renderer draws. A zeroed struct is a valid picture of nothing. */
typedef struct cw_picture {
    size_t width, height;
    float *pixels; /* height x width x 4, top row first: red, green, blue as displayed (sRGB; 1
                      is full), times the fourth, opacity */
} cw_picture;

/* Zeroed pixels. Returns CW_ERR_ARGUMENT for a size of 0 or above 16384, CW_ERR_NO_MEMORY. */
CW_API cw_status cw_picture_alloc(cw_picture *picture, size_t width, size_t height,
                                  cw_error *err);
CW_API void cw_picture_free(cw_picture *picture);

/* What is shown. A zeroed struct is a valid image of nothing. */
typedef struct cw_image {
    size_t width, height;
    uint8_t *pixels; /* height x width x 4: sRGB and alpha, not premultiplied; top row first */
} cw_image;

CW_API cw_status cw_image_alloc(cw_image *image, size_t width, size_t height, cw_error *err);
CW_API void cw_image_free(cw_image *image);

/* The picture over a background that blends from top to bottom, rounded to bytes.
 * background  top and bottom, sRGB and alpha
 * image       made anew on success */
CW_API cw_status cw_picture_show(const cw_picture *picture, const uint8_t background[2][4],
                                 cw_image *image, cw_error *err);

/* Writes a PNG, tagged as sRGB; without its alpha channel when nothing is translucent. The file
 * appears only when whole. Returns CW_ERR_OUTPUT, CW_ERR_NO_MEMORY, CW_ERR_BACKEND (libpng's
 * own words); CW_ERR_ARGUMENT for a picture of nothing. */
CW_API cw_status cw_image_write(const char *path, const cw_image *image, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
