#include "extract/typed.h"

#include "core/volume.h"
#include "extract/crossing.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* 64 bytes of 0 or 1 to bits; byte i to bit i. The product of 8 such bytes with the constant
 * gathers their lowest bits in its top byte. */
static inline uint64_t pack_bits(const unsigned char bytes[64])
{
    uint64_t bits = 0;
    for (int i = 0; i < 8; i++) {
        uint64_t eight = 0;
        for (int b = 0; b < 8; b++)
            eight |= (uint64_t)bytes[8 * i + b] << 8 * b;
        bits |= (eight * UINT64_C(0x0102040810204080) >> 56) << 8 * i;
    }
    return bits;
}

/* ORs 64 voxels into a padded row: voxel i is sample i + 1. */
static inline void store_shifted(uint64_t *row, size_t w, size_t words, uint64_t bits)
{
    row[w] |= bits << 1;
    if (w + 1 < words)
        row[w + 1] |= bits >> 63;
}

/* Scales by the largest component first: squares of tiny or huge ones do not survive. */
static bool normalise(double d[3])
{
    const double largest = fmax(fmax(fabs(d[0]), fabs(d[1])), fabs(d[2]));
    if (!(largest > 0) || !isfinite(largest))
        return false;
    for (int a = 0; a < 3; a++)
        d[a] /= largest;
    const double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    for (int a = 0; a < 3; a++)
        d[a] /= length;
    return true;
}

/* A zero normal where the gradient vanishes: the caller mends those from triangles. */
static inline void store_normal(const cwi_vertex_sink *sink, double g[3], size_t n)
{
    double d[3] = {0, 0, 0};
    if (normalise(g))
        for (int r = 0; r < 3; r++)
            d[r] = sink->cofactor[r][0] * g[0] + sink->cofactor[r][1] * g[1] +
                   sink->cofactor[r][2] * g[2];
    const bool known = normalise(d);
    for (int r = 0; r < 3; r++)
        sink->normals[3 * n + (size_t)r] = known ? (float)d[r] : 0;
}

void cwi_sink_vertex(const cwi_vertex_sink *sink, const size_t at[3], const double p[3],
                     double g[3], size_t n)
{
    double x[3];
    for (int a = 0; a < 3; a++)
        x[a] = (double)at[a] - 1 - sink->centre[a] + p[a];
    for (int r = 0; r < 3; r++)
        sink->positions[3 * n + (size_t)r] =
            (float)(sink->affine[r][0] * x[0] + sink->affine[r][1] * x[1] +
                    sink->affine[r][2] * x[2]);
    if (sink->normals)
        store_normal(sink, g, n);
}

/* clang-format off */
#define VOXEL uint8_t
#define NAME(x) x##_u8
#define IS_FLOAT false
#define LOWEST 0
#define HIGHEST UINT8_MAX
#include "extract/typed.inc"

#define VOXEL int8_t
#define NAME(x) x##_i8
#define IS_FLOAT false
#define LOWEST INT8_MIN
#define HIGHEST INT8_MAX
#include "extract/typed.inc"

#define VOXEL uint16_t
#define NAME(x) x##_u16
#define IS_FLOAT false
#define LOWEST 0
#define HIGHEST UINT16_MAX
#include "extract/typed.inc"

#define VOXEL int16_t
#define NAME(x) x##_i16
#define IS_FLOAT false
#define LOWEST INT16_MIN
#define HIGHEST INT16_MAX
#include "extract/typed.inc"

#define VOXEL uint32_t
#define NAME(x) x##_u32
#define IS_FLOAT false
#define LOWEST 0
#define HIGHEST UINT32_MAX
#include "extract/typed.inc"

#define VOXEL int32_t
#define NAME(x) x##_i32
#define IS_FLOAT false
#define LOWEST INT32_MIN
#define HIGHEST INT32_MAX
#include "extract/typed.inc"

#define VOXEL float
#define NAME(x) x##_f32
#define IS_FLOAT true
#define LOWEST -FLT_MAX
#define HIGHEST FLT_MAX
#include "extract/typed.inc"

#define VOXEL double
#define NAME(x) x##_f64
#define IS_FLOAT true
#define LOWEST -DBL_MAX
#define HIGHEST DBL_MAX
#include "extract/typed.inc"
/* clang-format on */

const cwi_typed *cwi_typed_of(cw_type type)
{
    static const cwi_typed table[CW_TYPE_COUNT] = {
        [CW_U8] = {classify_u8, vertex_u8},    [CW_I8] = {classify_i8, vertex_i8},
        [CW_U16] = {classify_u16, vertex_u16}, [CW_I16] = {classify_i16, vertex_i16},
        [CW_U32] = {classify_u32, vertex_u32}, [CW_I32] = {classify_i32, vertex_i32},
        [CW_F32] = {classify_f32, vertex_f32}, [CW_F64] = {classify_f64, vertex_f64},
    };
    return &table[type];
}
