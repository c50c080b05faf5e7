/* Decodes buffers of Blosc 1 by libblosc. */
#include "formats/zarr/blosc_wrap.h"

#include "core/base/memory.h"

#include <blosc.h>
#include <limits.h>

/* The library takes memory for three blocks. Its context is our own, so that threads do not wait
 * for each other. */
static bool decode_buffer(const unsigned char *packed, size_t packed_size, void *to,
                          size_t capacity, size_t *got, bool *starved)
{
    size_t packed_stated, block;
    *got = 0;
    *starved = false;
    if (packed_size < BLOSC_MIN_HEADER_LENGTH || packed_size > INT_MAX ||
        blosc_cbuffer_validate(packed, packed_size, got) != 0 || *got > capacity)
        return false;
    blosc_cbuffer_sizes(packed, got, &packed_stated, &block);
    if (block > *got)
        return false;
    if (!cwi_memory_take(3 * block)) {
        *starved = true;
        return false;
    }
    const int size = blosc_decompress_ctx(packed, to, *got, 1);
    cwi_memory_give(3 * block);
    return size >= 0 && (size_t)size == *got;
}

const cwi_blosc_functions cwi_module_blosc = {.decode = decode_buffer};
