/* Pictures of floats as drawn, images of bytes as shown, comparisons of two, and PNG files. */
#ifndef CUBEWRIGHT_PICTURE_H
#define CUBEWRIGHT_PICTURE_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A picture as a renderer draws it, in floats. A zeroed struct is a valid empty picture. */
typedef struct cw_picture {
    size_t width, height; /* pixels */
    float *pixels; /* height x width x 4, top row first: red, green, blue as displayed (sRGB; 1
                      is full), times the fourth, opacity */
} cw_picture;

/* Allocates zeroed pixels. Returns CW_ERR_ARGUMENT for a size of 0 or above 16384,
 * CW_ERR_NO_MEMORY. */
CW_NODISCARD CW_API cw_status cw_picture_alloc(cw_picture *picture, size_t width, size_t height,
                                               cw_error *err);

/* Frees the pixels and zeroes the picture. Harmless on a zeroed or already freed one. */
CW_API void cw_picture_free(cw_picture *picture);

/* An image as it is shown, in bytes. A zeroed struct is a valid empty image. */
typedef struct cw_image {
    size_t width, height; /* pixels */
    uint8_t *pixels; /* height x width x 4: sRGB and alpha, not premultiplied; top row first */
    uint16_t *deep;  /* the same in 16 bits, for PNG files of these; NULL: there are only 8 */
} cw_image;

/* Allocates zeroed pixels.
 * image    filled on success; free it with cw_image_free()
 * Returns  as cw_picture_alloc() */
CW_NODISCARD CW_API cw_status cw_image_alloc(cw_image *image, size_t width, size_t height,
                                             cw_error *err);

/* Frees the pixels and zeroes the image. Harmless on a zeroed or already freed one. */
CW_API void cw_image_free(cw_image *image);

/* Blends a picture over a background that changes from top to bottom, and rounds it to bytes.
 * background  top and bottom, sRGB and alpha
 * image       allocated and filled on success; free it with cw_image_free()
 * Returns     CW_ERR_ARGUMENT for an empty picture; CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_picture_show(const cw_picture *picture,
                                              const uint8_t background[2][4], cw_image *image,
                                              cw_error *err);

/* Errors of a picture against its reference, over the pixels that the reference covers (opacity
 * above 1e-4). Both are blended over one background. Errors are in 1/255. */
typedef struct cw_comparison {
    size_t pixels;          /* number of pixels compared; 0: the reference is empty, and all
                               below is 0 */
    double rmse, max, bias; /* of red, green and blue; bias: average excess of brightness */
    double delta_e_mean, delta_e_p99, delta_e_max; /* CIEDE2000; p99: 99 of 100 pixels are at
                                                      most this */
    double ssim; /* structural similarity of luma, Gaussian window of 11 pixels; 1: equal */
} cw_comparison;

/* Compares two pictures of one size.
 * reference   borrowed
 * background  top and bottom, sRGB
 * out         filled on success
 * Returns     CW_ERR_ARGUMENT for empty pictures or different sizes; CW_ERR_NO_MEMORY
 * Source      [Sharma2005], [Wang2004] */
CW_NODISCARD CW_API cw_status cw_picture_compare(const cw_picture *picture,
                                                 const cw_picture *reference,
                                                 const float background[2][3],
                                                 cw_comparison *out, cw_error *err);

/* Makes a picture of the amplified difference of two, per channel, over black or white,
 * whichever shows more of it.
 * a, b        borrowed
 * amplify     factor of the difference
 * difference  filled on success; free it with cw_picture_free()
 * Returns     CW_ERR_ARGUMENT as above and for a factor that is not above 0;
 *             CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_picture_difference(const cw_picture *a, const cw_picture *b,
                                                    double amplify, cw_picture *difference,
                                                    cw_error *err);

/* Makes a picture with one on the left, another on the right, and a thin white line between
 * them.
 * left, right    borrowed
 * left_fraction  of the width for the left picture, 0 to 1
 * both           filled on success; free it with cw_picture_free()
 * Returns        CW_ERR_ARGUMENT as above; CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_picture_split(const cw_picture *left, const cw_picture *right,
                                               double left_fraction, cw_picture *both,
                                               cw_error *err);

/* Counts the pixels whose red, green or blue differ by more than a tolerance, of 255.
 * a, b       borrowed
 * tolerance  0 to 255
 * differ     set to the number of pixels
 * Returns    CW_ERR_ARGUMENT for images of different sizes. */
CW_NODISCARD CW_API cw_status cw_image_compare(const cw_image *a, const cw_image *b,
                                               int tolerance, size_t *differ, cw_error *err);

/* Writes a PNG, tagged as sRGB; without an alpha channel when nothing is translucent. The file
 * appears only when it is complete. Returns CW_ERR_OUTPUT, CW_ERR_NO_MEMORY, CW_ERR_BACKEND
 * (with libpng's message), or CW_ERR_ARGUMENT for an empty picture. */
CW_NODISCARD CW_API cw_status cw_image_write(const char *path, const cw_image *image,
                                             cw_error *err);

/* Makes the bytes of a PNG file in memory.
 * image     borrowed
 * is_color  it is tagged as sRGB; numbers such as normals are not
 * bytes     set to the bytes; free them with cw_bytes_free()
 * size      set to their number
 * Returns   as cw_image_write() */
CW_NODISCARD CW_API cw_status cw_image_encode(const cw_image *image, bool is_color,
                                              uint8_t **bytes, size_t *size, cw_error *err);

/* Decodes the bytes of a PNG or JPEG file. Greys become colours, 16 bits 8; without alpha all is opaque.
 * bytes    borrowed
 * size     their number
 * image    allocated and filled on success; free it with cw_image_free()
 * Returns  CW_ERR_UNSUPPORTED  another format, a JPEG that is not grey or of three colours, or this build
 *                              lacks their libraries
 *          CW_ERR_FORMAT for a damaged file; CW_ERR_LIMIT beyond 16384 pixels a side; CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_image_decode(const uint8_t *bytes, size_t size,
                                              cw_image *image, cw_error *err);

/* Frees the bytes of a file in memory.
 * bytes  those of cw_image_encode(), or NULL */
CW_API void cw_bytes_free(uint8_t *bytes);

#ifdef __cplusplus
}
#endif

#endif
