/* Replaces lz4.c where liblz4-dev is missing, or with -DCUBEWRIGHT_LZ4=OFF. */
#include "formats/bytes/block_reader.h"

bool cwi_lz4_present(void)
{
    return false;
}

bool cwi_lz4_decode(const unsigned char *packed, size_t packed_size, unsigned char *to,
                    size_t size)
{
    (void)packed, (void)packed_size, (void)to, (void)size;
    return false;
}
