/* Decodes LZ4 blocks by liblz4. */
#include "formats/bytes/block_reader.h"

#include <limits.h>
#include <lz4.h>

bool cwi_lz4_present(void)
{
    return true;
}

bool cwi_lz4_decode(const unsigned char *packed, size_t packed_size, unsigned char *to,
                    size_t size)
{
    return packed_size <= INT_MAX && size <= INT_MAX &&
           LZ4_decompress_safe((const char *)packed, (char *)to, (int)packed_size, (int)size) ==
               (int)size;
}
