/* The order of bytes of this machine, and numbers that are stored in the other one. */
#ifndef FORMATS_BYTES_BYTE_ORDER_H
#define FORMATS_BYTES_BYTE_ORDER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Returns true if this machine stores the high byte first. */
static inline bool cwi_machine_is_big_endian(void)
{
    const uint16_t one = 1;
    return *(const unsigned char *)&one == 0;
}

/* Reverses the bytes of each of count numbers; for size 1 it does nothing. */
static inline void cwi_swap_bytes(void *numbers, size_t count, size_t size)
{
    uint16_t *u16 = numbers;
    uint32_t *u32 = numbers;
    uint64_t *u64 = numbers;
    for (size_t i = 0; size == 2 && i < count; i++)
        u16[i] = __builtin_bswap16(u16[i]);
    for (size_t i = 0; size == 4 && i < count; i++)
        u32[i] = __builtin_bswap32(u32[i]);
    for (size_t i = 0; size == 8 && i < count; i++)
        u64[i] = __builtin_bswap64(u64[i]);
}

#endif
