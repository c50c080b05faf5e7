/* Images with 16 bits a channel. */
#ifndef CORE_COLOR_DEEP_IMAGE_H
#define CORE_COLOR_DEEP_IMAGE_H

#include <cubewright/picture.h>

/* Gives an image that has none zeroed pixels of 16 bits. cw_image_free() frees them. CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_image_deepen(cw_image *image, cw_error *err);

#endif
