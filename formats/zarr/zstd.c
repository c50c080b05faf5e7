/* Decodes Zstandard frames by libzstd. */
#include "formats/zarr/zarr_decode.h"

#include <zstd.h>
#include <zstd_errors.h>

bool cwi_zarr_zstd_present(void)
{
    return true;
}

bool cwi_zarr_zstd_decode(const unsigned char *packed, size_t packed_size, void *to,
                          size_t capacity, size_t *got, bool *starved)
{
    *got = ZSTD_decompress(to, capacity, packed, packed_size);
    *starved = ZSTD_isError(*got) && ZSTD_getErrorCode(*got) == ZSTD_error_memory_allocation;
    return !ZSTD_isError(*got);
}
