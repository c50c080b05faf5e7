/* Classifies samples as bits, set where they are inside. Compiled for each engine; the plain
 * loops of classify.inc serve where an engine has no faster way. */
#include "core/volume/volume.h"
#include "extract/dense/isa_dispatch.h"

#include <float.h>
#include <math.h>
#include <string.h>

#if defined __SSE2__ && !defined CWI_PLAIN
#define SIMD 1
#include <immintrin.h>
#else
#define SIMD 0
#endif

/* Packs eight bytes of 0 or 1 into bits, byte i to bit i. Their product with the constant
 * gathers their lowest bits in its top byte. */
static inline uint64_t pack_eight(uint64_t bytes)
{
    return bytes * UINT64_C(0x0102040810204080) >> 56;
}

/* One byte for each sample of a leaf in a row. */
typedef signed char leaf_bytes __attribute__((vector_size(CWI_BRICK)));

static inline uint64_t leaf_bits(leaf_bytes b)
{
    return pack_eight((uint64_t)b & UINT64_C(0x0101010101010101));
}

/* Packs 64 bytes of 0 or 1 into bits. */
static inline uint64_t pack_bits(const unsigned char bytes[64])
{
    uint64_t bits = 0;
    for (int i = 0; i < 8; i++) {
        uint64_t eight = 0;
        for (int b = 0; b < 8; b++)
            eight |= (uint64_t)bytes[8 * i + b] << 8 * b;
        bits |= pack_eight(eight) << 8 * i;
    }
    return bits;
}

/* Unsigned numbers are compared as signed ones with the top bit flipped: `flip` in
 * every lane. */
#if defined __AVX512BW__ && defined __AVX512VL__

static inline uint64_t above_8(const void *x, int8_t limit, int8_t flip)
{
    const __m512i v = _mm512_xor_si512(_mm512_loadu_si512(x), _mm512_set1_epi8(flip));
    return _mm512_cmpge_epi8_mask(v, _mm512_set1_epi8((int8_t)(limit ^ flip)));
}

static inline uint64_t above_16(const void *x, int16_t limit, int16_t flip)
{
    const __m512i f = _mm512_set1_epi16(flip), l = _mm512_set1_epi16((int16_t)(limit ^ flip));
    const char *p = x;
    const __mmask32 low =
        _mm512_cmpge_epi16_mask(_mm512_xor_si512(_mm512_loadu_si512(p), f), l);
    const __mmask32 high =
        _mm512_cmpge_epi16_mask(_mm512_xor_si512(_mm512_loadu_si512(p + 64), f), l);
    return (uint64_t)high << 32 | low;
}

static inline uint64_t above_f32(const float *x, float limit)
{
    const __m512 l = _mm512_set1_ps(limit);
    uint64_t bits = 0;
    for (int n = 0; n < 4; n++)
        bits |= (uint64_t)_mm512_cmp_ps_mask(_mm512_loadu_ps(x + 16 * n), l, _CMP_GE_OQ)
                << 16 * n;
    return bits;
}

static inline uint64_t ordered_f32(const float *x)
{
    uint64_t bits = 0;
    for (int n = 0; n < 4; n++) {
        const __m512 v = _mm512_loadu_ps(x + 16 * n);
        bits |= (uint64_t)_mm512_cmp_ps_mask(v, v, _CMP_ORD_Q) << 16 * n;
    }
    return bits;
}

#elif defined __AVX2__

static inline uint64_t above_8(const void *x, int8_t limit, int8_t flip)
{
    const __m256i f = _mm256_set1_epi8(flip), l = _mm256_set1_epi8((int8_t)(limit ^ flip));
    uint64_t below = 0;
    for (int n = 0; n < 2; n++) {
        const __m256i v = _mm256_xor_si256(_mm256_loadu_si256((const __m256i *)x + n), f);
        below |= (uint64_t)(uint32_t)_mm256_movemask_epi8(_mm256_cmpgt_epi8(l, v)) << 32 * n;
    }
    return ~below;
}

static inline uint64_t above_16(const void *x, int16_t limit, int16_t flip)
{
    const __m256i f = _mm256_set1_epi16(flip), l = _mm256_set1_epi16((int16_t)(limit ^ flip));
    uint64_t below = 0;
    for (int n = 0; n < 2; n++) {
        const __m256i *p = (const __m256i *)x + 2 * n;
        const __m256i a = _mm256_cmpgt_epi16(l, _mm256_xor_si256(_mm256_loadu_si256(p), f));
        const __m256i b = _mm256_cmpgt_epi16(l, _mm256_xor_si256(_mm256_loadu_si256(p + 1), f));
        /* packing works within halves: swap the middle quarters */
        const __m256i packed = _mm256_permute4x64_epi64(_mm256_packs_epi16(a, b), 0xd8);
        below |= (uint64_t)(uint32_t)_mm256_movemask_epi8(packed) << 32 * n;
    }
    return ~below;
}

static inline uint64_t above_f32(const float *x, float limit)
{
    const __m256 l = _mm256_set1_ps(limit);
    uint64_t bits = 0;
    for (int n = 0; n < 8; n++)
        bits |= (uint64_t)(uint32_t)_mm256_movemask_ps(
                    _mm256_cmp_ps(_mm256_loadu_ps(x + 8 * n), l, _CMP_GE_OQ))
                << 8 * n;
    return bits;
}

static inline uint64_t ordered_f32(const float *x)
{
    uint64_t bits = 0;
    for (int n = 0; n < 8; n++) {
        const __m256 v = _mm256_loadu_ps(x + 8 * n);
        bits |= (uint64_t)(uint32_t)_mm256_movemask_ps(_mm256_cmp_ps(v, v, _CMP_ORD_Q))
                << 8 * n;
    }
    return bits;
}

#elif SIMD

static inline uint64_t above_8(const void *x, int8_t limit, int8_t flip)
{
    const __m128i f = _mm_set1_epi8(flip), l = _mm_set1_epi8((int8_t)(limit ^ flip));
    uint64_t below = 0;
    for (int n = 0; n < 4; n++) {
        const __m128i v = _mm_xor_si128(_mm_loadu_si128((const __m128i *)x + n), f);
        below |= (uint64_t)(unsigned)_mm_movemask_epi8(_mm_cmplt_epi8(v, l)) << 16 * n;
    }
    return ~below;
}

static inline uint64_t above_16(const void *x, int16_t limit, int16_t flip)
{
    const __m128i f = _mm_set1_epi16(flip), l = _mm_set1_epi16((int16_t)(limit ^ flip));
    uint64_t below = 0;
    for (int n = 0; n < 4; n++) {
        const __m128i *p = (const __m128i *)x + 2 * n;
        const __m128i a = _mm_cmplt_epi16(_mm_xor_si128(_mm_loadu_si128(p), f), l);
        const __m128i b = _mm_cmplt_epi16(_mm_xor_si128(_mm_loadu_si128(p + 1), f), l);
        below |= (uint64_t)(unsigned)_mm_movemask_epi8(_mm_packs_epi16(a, b)) << 16 * n;
    }
    return ~below;
}

static inline uint64_t above_f32(const float *x, float limit)
{
    const __m128 l = _mm_set1_ps(limit);
    uint64_t bits = 0;
    for (int n = 0; n < 16; n++)
        bits |= (uint64_t)(unsigned)_mm_movemask_ps(_mm_cmpge_ps(_mm_loadu_ps(x + 4 * n), l))
                << 4 * n;
    return bits;
}

static inline uint64_t ordered_f32(const float *x)
{
    uint64_t bits = 0;
    for (int n = 0; n < 16; n++) {
        const __m128 v = _mm_loadu_ps(x + 4 * n);
        bits |= (uint64_t)(unsigned)_mm_movemask_ps(_mm_cmpord_ps(v, v)) << 4 * n;
    }
    return bits;
}

#endif

#if SIMD
#define above_u8(x, limit)  above_8(x, (int8_t)(limit), INT8_MIN)
#define above_i8(x, limit)  above_8(x, limit, 0)
#define above_u16(x, limit) above_16(x, (int16_t)(limit), INT16_MIN)
#define above_i16(x, limit) above_16(x, limit, 0)
#else
#define above_u8    plain_above_u8
#define above_i8    plain_above_i8
#define above_u16   plain_above_u16
#define above_i16   plain_above_i16
#define above_f32   plain_above_f32
#define ordered_f32 plain_ordered_f32
#endif
#define above_u32   plain_above_u32
#define above_i32   plain_above_i32
#define above_f64   plain_above_f64
#define ordered_f64 plain_ordered_f64
/* integers are never NaN: not called */
#define ordered_u8  plain_ordered_u8
#define ordered_i8  plain_ordered_i8
#define ordered_u16 plain_ordered_u16
#define ordered_i16 plain_ordered_i16
#define ordered_u32 plain_ordered_u32
#define ordered_i32 plain_ordered_i32

/* Returns the bits of the leaves around word w of the row. Leaves that share samples, and are
 * not wanted, have the same bits. */
static cwi_leaf_bits leaves_of_samples(const cwi_bit_grid *g, const cwi_brick_rows *b, size_t w)
{
    cwi_leaf_bits bits = {0, 0};
    for (size_t n = 0; n < b->count; n++) {
        const cwi_leaf_bits here = g->leaves[b->row[n] * g->words + w];
        bits.active |= here.active;
        bits.solid |= here.solid;
    }
    return bits;
}

/* Prefetching, where all samples are compared: AHEAD bytes ahead, a line at a time. That is
 * more than processors do by themselves. It goes to the second cache: the first one has fewer
 * lines on their way to it at a time. */
enum { AHEAD = 4096, LINE = 64, SECOND = 2 };

#define TYPED "extract/dense/classify.inc"
#include "extract/dense/for_each_type.inc"

/* Clears the padding around a layer of bits, or a whole layer of padding. */
static void clear_padding(const cwi_bit_grid *g, uint64_t *plane, size_t k)
{
    const size_t layer = g->rows_y * g->words, row = g->words * sizeof *plane;
    uint64_t *first = plane + k * layer;
    const bool padding = k == 0 || k + 1 == g->rows_z;
    memset(first, 0, padding ? layer * sizeof *first : row);
    memset(first + layer - g->words, 0, row);
}

/* Number of rows of bricks whose samples stay in the cache until they are measured. */
enum { TOGETHER = 4 };

void cwi_classify_rows(const cwi_bit_grid *g, size_t j, size_t k, size_t rows, bool *in,
                       bool *out)
{
    static void (*const classify[CW_TYPE_COUNT])(const cwi_bit_grid *, size_t, size_t, size_t,
                                                 bool *, bool *) = {
        [CW_U8] = classify_u8,   [CW_I8] = classify_i8,   [CW_U16] = classify_u16,
        [CW_I16] = classify_i16, [CW_U32] = classify_u32, [CW_I32] = classify_i32,
        [CW_F32] = classify_f32, [CW_F64] = classify_f64,
    };
    classify[g->volume.type](g, j, k, rows, in, out);
}

/* Classifies the wanted samples of a layer of bricks. */
static void classify_bricks(const cwi_bit_grid *g, size_t b)
{
    static void (*const classify[CW_TYPE_COUNT])(const cwi_bit_grid *, const size_t[2],
                                                 const size_t[2]) = {
        [CW_U8] = classify_bricks_u8,   [CW_I8] = classify_bricks_i8,
        [CW_U16] = classify_bricks_u16, [CW_I16] = classify_bricks_i16,
        [CW_U32] = classify_bricks_u32, [CW_I32] = classify_bricks_i32,
        [CW_F32] = classify_bricks_f32, [CW_F64] = classify_bricks_f64,
    };
    const size_t z = b * CWI_BRICK, last_row = g->rows_y - 2, last_layer = g->rows_z - 2;
    for (size_t y = 0; y <= last_row; y += CWI_BRICK) {
        const size_t first[2] = {y ? y : 1, z ? z : 1}, y_end = y + CWI_BRICK - 1,
                     z_end = z + CWI_BRICK - 1;
        const size_t last[2] = {y_end < last_row ? y_end : last_row,
                                z_end < last_layer ? z_end : last_layer};
        classify[g->volume.type](g, first, last);
    }
}

static void (*const measure[CW_TYPE_COUNT])(const cwi_bit_grid *, const size_t[2], size_t,
                                            size_t, cwi_range *) = {
    [CW_U8] = measure_u8,   [CW_I8] = measure_i8,   [CW_U16] = measure_u16,
    [CW_I16] = measure_i16, [CW_U32] = measure_u32, [CW_I32] = measure_i32,
    [CW_F32] = measure_f32, [CW_F64] = measure_f64,
};

/* Returns the number of leaves along x. */
static size_t count_leaves_x(const cwi_bit_grid *g)
{
    return (g->volume.dim[0] + CWI_BRICK) / CWI_BRICK;
}

void cwi_measure_leaves(const cwi_bit_grid *g, const cwi_leaf_box *box, cwi_range *leaves)
{
    enum { IN_WORD = 64 / CWI_BRICK };
    const size_t words[2] = {box->first[0] / IN_WORD, (box->end[0] + IN_WORD - 1) / IN_WORD};
    for (size_t kb = box->first[2]; kb < box->end[2]; kb++)
        for (size_t jb = box->first[1]; jb < box->end[1]; jb++)
            measure[g->volume.type](g, words, jb, kb,
                                    leaves + (kb * g->bricks_y + jb) * count_leaves_x(g));
}

void cwi_classify_layer(const cwi_bit_grid *g, size_t b, cwi_range *leaves, bool *in, bool *out)
{
    const size_t begin = b * CWI_BRICK;
    const size_t end = b + 1 == g->bricks_z ? g->rows_z : begin + CWI_BRICK;
    const size_t leaves_x = count_leaves_x(g), words[2] = {0, g->volume.dim[0] / 64 + 1};
    if (!g->all_classified) {
        classify_bricks(g, b);
        return;
    }
    for (size_t k = begin; k < end; k++) {
        clear_padding(g, g->inside, k);
        if (g->find_values)
            clear_padding(g, g->has, k);
    }
    if (!leaves) { /* in the order of memory */
        for (size_t k = begin ? begin : 1; k < end && k + 1 < g->rows_z; k++)
            cwi_classify_rows(g, 1, k, g->rows_y - 2, in, out);
        return;
    }
    for (size_t jb = 0; jb < g->bricks_y; jb += TOGETHER) {
        const size_t next = jb + TOGETHER < g->bricks_y ? jb + TOGETHER : g->bricks_y;
        const size_t first = jb ? jb * CWI_BRICK : 1;
        const size_t last = next == g->bricks_y ? g->rows_y - 1 : next * CWI_BRICK;
        for (size_t k = begin ? begin : 1; k < end && k + 1 < g->rows_z; k++)
            cwi_classify_rows(g, first, k, last - first, in, out);
        for (size_t row = jb; row < next && leaves; row++)
            measure[g->volume.type](g, words, row, b, leaves + row * leaves_x);
    }
}

void cwi_find_sides(const cwi_bit_grid *g, const void *voxels, size_t count, bool *in,
                    bool *out)
{
    static void (*const find[CW_TYPE_COUNT])(const cwi_bit_grid *, const void *, size_t, bool *,
                                             bool *) = {
        [CW_U8] = find_sides_u8,   [CW_I8] = find_sides_i8,   [CW_U16] = find_sides_u16,
        [CW_I16] = find_sides_i16, [CW_U32] = find_sides_u32, [CW_I32] = find_sides_i32,
        [CW_F32] = find_sides_f32, [CW_F64] = find_sides_f64,
    };
    find[g->volume.type](g, voxels, count, in, out);
}
