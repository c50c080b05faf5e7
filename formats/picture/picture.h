/* Facts of a picture in a PNG or BMP file, which the module "picture" (libpng, in a sandboxed process)
 * puts into the shared memory. Nothing in here has been checked. */
#ifndef FORMATS_PICTURE_PICTURE_H
#define FORMATS_PICTURE_PICTURE_H

#include "formats/volume/sandboxed_planes.h"

enum { CWI_PICTURE_SAMPLES = 4 };

typedef struct cwi_picture_facts {
    uint32_t columns, rows, samples;
    uint32_t bits;        /* of a stored sample, or of an index of the palette */
    cw_type type;         /* of samples as they are returned */
    uint32_t max_ratio;   /* bytes that one byte of the file may stand for */
    uint32_t has_palette; /* values are numbers of colours */
    double pixel_mm[2];   /* 0: not stated */
} cwi_picture_facts;

extern CW_API const cwi_plane_functions cwi_module_picture;

#endif
