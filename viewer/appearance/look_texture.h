/* Pictures on surfaces: sampled between texels and between sizes. */
#ifndef VIEWER_APPEARANCE_LOOK_TEXTURE_H
#define VIEWER_APPEARANCE_LOOK_TEXTURE_H

#include <cubewright/picture.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { CWI_LOOK_LEVELS = 15 }; /* of a picture of 16384 texels: 2^14 */

/* A picture and its smaller copies, each half as large as the one before it. */
typedef struct cwi_look_texture {
    uint8_t *texels[CWI_LOOK_LEVELS]; /* height x width x 3; owned */
    uint32_t width[CWI_LOOK_LEVELS], height[CWI_LOOK_LEVELS];
    int count;    /* of levels; 0: no picture */
    bool repeats; /* coordinates beyond 0 to 1 repeat the picture; else its border goes on */
    float value[256];
} cwi_look_texture;

/* Texture coordinates at a pixel, and how they change to its right and upward. */
typedef struct cwi_look_place {
    double uv[2], dx[2], dy[2];
} cwi_look_place;

/* Makes a texture of an image.
 * is_color  bytes are sRGB, and blended in linear light; else they are blended as they are
 * Returns   CW_ERR_ARGUMENT for an empty image or one of more than 16384 texels along a side;
 *           CW_ERR_NO_MEMORY; free the texture in any case */
CW_NODISCARD cw_status cwi_look_texture_make(const cw_image *image, bool is_color, bool repeats,
                                             cwi_look_texture *texture, cw_error *err);
void cwi_look_texture_free(cwi_look_texture *texture);

/* Samples the texture: linear between texels and between levels, at up to 16 places along the longer side of
 * the pixel's footprint [Williams1983, McCormack1999].
 * rgb  each from 0 to 1, linear light of colours */
void cwi_look_texture_sample(const cwi_look_texture *texture, const cwi_look_place *place,
                             double rgb[3]);

#ifdef __cplusplus
}
#endif

#endif
