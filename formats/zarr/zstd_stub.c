/* Replaces zstd.c where libzstd-dev is missing, or with -DCUBEWRIGHT_ZSTD=OFF. */
#include "formats/zarr/zarr_decode.h"

bool cwi_zarr_zstd_present(void)
{
    return false;
}

bool cwi_zarr_zstd_decode(const unsigned char *packed, size_t packed_size, void *to,
                          size_t capacity, size_t *got, bool *starved)
{
    (void)packed, (void)packed_size, (void)to, (void)capacity;
    *got = 0;
    *starved = false;
    return false;
}
