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
CW_NODISCARD CW_API cw_status cw_picture_alloc(cw_picture *picture, size_t width, size_t height,
                                               cw_error *err);
CW_API void cw_picture_free(cw_picture *picture);

/* What is shown. A zeroed struct is a valid image of nothing. */
typedef struct cw_image {
    size_t width, height;
    uint8_t *pixels; /* height x width x 4: sRGB and alpha, not premultiplied; top row first */
} cw_image;

CW_NODISCARD CW_API cw_status cw_image_alloc(cw_image *image, size_t width, size_t height,
                                             cw_error *err);
CW_API void cw_image_free(cw_image *image);

/* The picture over a background that blends from top to bottom, rounded to bytes.
 * background  top and bottom, sRGB and alpha
 * image       made anew on success */
CW_NODISCARD CW_API cw_status cw_picture_show(const cw_picture *picture,
                                              const uint8_t background[2][4], cw_image *image,
                                              cw_error *err);

/* How far a picture is from its reference, over the pixels that the reference covers (opacity
 * above 1e-4), both over one background. Errors are in 1/255. */
typedef struct cw_comparison {
    size_t pixels;          /* compared; 0: the reference is empty, and all below is 0 */
    double rmse, max, bias; /* of red, green and blue; bias: how much too bright, on average */
    double delta_e_mean, delta_e_p99, delta_e_max; /* CIEDE2000; p99: 99 of 100 are at most */
    double ssim; /* structural similarity of luma, Gaussian window of 11 pixels; 1: the same */
} cw_comparison;

/* Compares two pictures of one size.
 * background  top and bottom, sRGB
 * Returns     CW_ERR_ARGUMENT for pictures of nothing or of different sizes; CW_ERR_NO_MEMORY
 * Source      [Sharma2005], [Wang2004] */
CW_NODISCARD CW_API cw_status cw_picture_compare(const cw_picture *picture,
                                                 const cw_picture *reference,
                                                 const float background[2][3],
                                                 cw_comparison *out, cw_error *err);

/* A picture of how two differ, amplified: per channel, over black or white, whichever shows
 * more of it. Returns CW_ERR_ARGUMENT as above and for a factor that is not above 0;
 * CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_picture_difference(const cw_picture *a, const cw_picture *b,
                                                    double amplify, cw_picture *difference,
                                                    cw_error *err);

/* One picture on the left, another on the right, and a thin white line between them.
 * share    of the width that is the left one's, 0 to 1
 * Returns  CW_ERR_ARGUMENT as above; CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_picture_split(const cw_picture *left, const cw_picture *right,
                                               double share, cw_picture *both, cw_error *err);

/* Counts the pixels whose red, green or blue differ by more than a tolerance, of 255.
 * Returns CW_ERR_ARGUMENT for images of different sizes. */
CW_NODISCARD CW_API cw_status cw_image_compare(const cw_image *a, const cw_image *b,
                                               int tolerance, size_t *differ, cw_error *err);

/* Writes a PNG, tagged as sRGB; without its alpha channel when nothing is translucent. The file
 * appears only when whole. Returns CW_ERR_OUTPUT, CW_ERR_NO_MEMORY, CW_ERR_BACKEND (libpng's
 * own words); CW_ERR_ARGUMENT for a picture of nothing. */
CW_NODISCARD CW_API cw_status cw_image_write(const char *path, const cw_image *image,
                                             cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
