/* Replaces blosc.c where libblosc-dev is missing, or with -DCUBEWRIGHT_BLOSC=OFF. */
#include "formats/zarr/zarr_decode.h"

bool cwi_zarr_blosc_present(void)
{
    return false;
}

bool cwi_zarr_blosc_decode(const unsigned char *packed, size_t packed_size, void *to,
                           size_t capacity, size_t *got, bool *starved)
{
    (void)packed, (void)packed_size, (void)to, (void)capacity;
    *got = 0;
    *starved = false;
    return false;
}
