/* Computes CRC-32C (Castagnoli), the checksum of Zarr's chunks and shard indexes. */
#include "formats/zarr/zarr_decode.h"

#include <pthread.h>

enum { SLICES = 8 };

/* table[0] is that of one byte; table[n] advances it by n more zero bytes. */
static uint32_t table[SLICES][256];
static pthread_once_t table_once = PTHREAD_ONCE_INIT;

static void fill_table(void)
{
    const uint32_t POLYNOMIAL = 0x82f63b78; /* 0x1edc6f41 with its bits reversed */
    for (uint32_t n = 0; n < 256; n++) {
        uint32_t value = n;
        for (int bit = 0; bit < 8; bit++)
            value = value >> 1 ^ (value & 1 ? POLYNOMIAL : 0);
        table[0][n] = value;
    }
    for (uint32_t n = 0; n < 256; n++)
        for (int s = 1; s < SLICES; s++)
            table[s][n] = table[s - 1][n] >> 8 ^ table[0][table[s - 1][n] & 255];
}

uint32_t cwi_crc32c(const void *bytes, size_t size)
{
    const unsigned char *p = bytes;
    uint32_t value = UINT32_MAX;
    pthread_once(&table_once, fill_table);
    for (; size >= SLICES; size -= SLICES, p += SLICES) {
        const uint32_t low = value ^ ((uint32_t)p[0] | (uint32_t)p[1] << 8 |
                                      (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24);
        value = table[7][low & 255] ^ table[6][low >> 8 & 255] ^ table[5][low >> 16 & 255] ^
                table[4][low >> 24] ^ table[3][p[4]] ^ table[2][p[5]] ^ table[1][p[6]] ^
                table[0][p[7]];
    }
    for (; size > 0; size--)
        value = value >> 8 ^ table[0][(value ^ *p++) & 255];
    return ~value;
}
