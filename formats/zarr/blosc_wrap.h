/* The module "blosc": decodes buffers of Blosc 1. The library brings C++ with it, which only files
 * that need it load. */
#ifndef FORMATS_ZARR_BLOSC_WRAP_H
#define FORMATS_ZARR_BLOSC_WRAP_H

#include <cubewright/core.h>

typedef struct cwi_blosc_functions {
    /* Decodes a buffer of at most `capacity` bytes. Returns false if it is damaged, or (starved)
     * memory is out. */
    bool (*decode)(const unsigned char *packed, size_t packed_size, void *to, size_t capacity,
                   size_t *got, bool *starved);
} cwi_blosc_functions;

extern CW_API const cwi_blosc_functions cwi_module_blosc;

#endif
