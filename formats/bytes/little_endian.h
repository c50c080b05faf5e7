/* Numbers as little-endian bytes on any machine; each cwi_put function returns the end of
 * the bytes it wrote. */
#ifndef FORMATS_BYTES_LITTLE_ENDIAN_H
#define FORMATS_BYTES_LITTLE_ENDIAN_H

#include <stdint.h>
#include <string.h>

static inline uint32_t cwi_get_u32(const unsigned char *from)
{
    return from[0] | (uint32_t)from[1] << 8 | (uint32_t)from[2] << 16 | (uint32_t)from[3] << 24;
}

static inline unsigned char *cwi_put_u16(unsigned char *to, uint16_t value)
{
    to[0] = (unsigned char)(value & 255);
    to[1] = (unsigned char)(value >> 8);
    return to + 2;
}

static inline unsigned char *cwi_put_u32(unsigned char *to, uint32_t value)
{
    return cwi_put_u16(cwi_put_u16(to, (uint16_t)(value & 65535)), (uint16_t)(value >> 16));
}

static inline unsigned char *cwi_put_u64(unsigned char *to, uint64_t value)
{
    return cwi_put_u32(cwi_put_u32(to, (uint32_t)(value & 0xffffffff)),
                       (uint32_t)(value >> 32));
}

static inline unsigned char *cwi_put_f32(unsigned char *to, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return cwi_put_u32(to, bits);
}

static inline unsigned char *cwi_put_f32x3(unsigned char *to, const float value[3])
{
    for (int a = 0; a < 3; a++)
        to = cwi_put_f32(to, value[a]);
    return to;
}

#endif
