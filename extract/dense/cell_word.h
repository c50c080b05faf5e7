/* Loads 64 cells of a row at a time, and finds their cases and which of them are mixed.
 * Included by the files that are compiled for each engine. */
#ifndef EXTRACT_DENSE_CELL_WORD_H
#define EXTRACT_DENSE_CELL_WORD_H

#include "extract/dense/crossed_edges.h"
#include "extract/dense/isa_dispatch.h"

#ifdef __AVX2__
#include <immintrin.h>
#endif

/* Returns the place of the lowest bit that is set; any place when none is. */
static inline unsigned cwi_lowest(uint64_t bits)
{
#ifdef __BMI__
    return (unsigned)_tzcnt_u64(bits);
#else
    return (unsigned)__builtin_ctzll(bits | UINT64_C(1) << 63);
#endif
}

/* The four rows of samples around a row of cells. */
typedef struct cell_rows {
    const uint64_t *row[4];
} cell_rows;

static inline cell_rows rows_around(const cwi_bit_grid *g, size_t j, size_t k)
{
    cell_rows r;
    for (size_t n = 0; n < 4; n++)
        r.row[n] = cwi_grid_row(g, (k + (n >> 1)) * g->rows_y + j + (n & 1));
    return r;
}

#if CWI_WIDE

typedef struct cell_word {
    __m512i cases;  /* byte i: which corners of cell i are inside */
    uint64_t mixed; /* cells whose corners are not all alike */
} cell_word;

static inline __m512i four_words(const cell_rows *r, size_t w)
{
    return _mm512_castsi256_si512(
        _mm256_set_epi64x((long long)r->row[3][w], (long long)r->row[2][w],
                          (long long)r->row[1][w], (long long)r->row[0][w]));
}

/* Computes the cases of 64 cells, whose corners n are the bits of lane n: transposes an 8 x 64
 * matrix of bits. */
static inline __m512i turn_corner(__m512i corner)
{
    /* byte 8 b + 7 - n: bits of cells 8 b to 8 b + 7 for corner n */
    const __m512i gather = _mm512_set_epi64(
        0x070f171f272f373f, 0x060e161e262e363e, 0x050d151d252d353d, 0x040c141c242c343c,
        0x030b131b232b333b, 0x020a121a222a323a, 0x0109111921293139, 0x0008101820283038);
    const __m512i bytes = _mm512_permutexvar_epi8(gather, corner);
    return _mm512_gf2p8affine_epi64_epi8(_mm512_set1_epi64((long long)0x8040201008040201),
                                         bytes, 0);
}

static inline cell_word load_cells(const cell_rows *r, size_t w)
{
    const __m512i here = four_words(r, w), one = _mm512_set1_epi8(1);
    const __m512i moved = _mm512_shrdi_epi64(here, four_words(r, w + 1), 1);
    const __m512i by_turns = _mm512_set_epi64(11, 3, 10, 2, 9, 1, 8, 0);
    cell_word c = {.cases = turn_corner(_mm512_permutex2var_epi64(here, by_turns, moved))};
    c.mixed = _mm512_cmpgt_epu8_mask(_mm512_add_epi8(c.cases, one), one);
    return c;
}

/* Stores the cases of active cells; those of others may be left out. */
static inline void store_cases(const cell_word *c, uint64_t active, uint8_t cases[64])
{
    (void)active;
    _mm512_storeu_si512(cases, c->cases);
}

_Alignas(64) static const uint8_t cwi_iota[64] = {
    0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21,
    22, 23, 24, 25, 26, 27, 28, 29, 30, 31, 32, 33, 34, 35, 36, 37, 38, 39, 40, 41, 42, 43,
    44, 45, 46, 47, 48, 49, 50, 51, 52, 53, 54, 55, 56, 57, 58, 59, 60, 61, 62, 63};

#elif defined __AVX2__

typedef struct cell_word {
    __m256i even, odd; /* lane n, bit i: corner 2 n, or 2 n + 1, of cell i is inside */
    uint64_t mixed;    /* cells whose corners are not all alike */
} cell_word;

static inline __m256i four_words(const cell_rows *r, size_t w)
{
    return _mm256_set_epi64x((long long)r->row[3][w], (long long)r->row[2][w],
                             (long long)r->row[1][w], (long long)r->row[0][w]);
}

static inline cell_word load_cells(const cell_rows *r, size_t w)
{
    cell_word c = {.even = four_words(r, w)};
    c.odd = _mm256_or_si256(_mm256_srli_epi64(c.even, 1),
                            _mm256_slli_epi64(four_words(r, w + 1), 63));
    const __m256i any = _mm256_or_si256(c.even, c.odd), all = _mm256_and_si256(c.even, c.odd);
    const __m128i any2 = _mm_or_si128(_mm256_castsi256_si128(any),
                                      _mm256_extracti128_si256(any, 1)),
                  all2 = _mm_and_si128(_mm256_castsi256_si128(all),
                                       _mm256_extracti128_si256(all, 1));
    c.mixed = (uint64_t)((_mm_cvtsi128_si64(any2) | _mm_extract_epi64(any2, 1)) &
                         ~(_mm_cvtsi128_si64(all2) & _mm_extract_epi64(all2, 1)));
    return c;
}

/* Transposes, in each eight bytes, an 8 x 8 matrix of bits [Warren2013, 7-3]. */
static inline __m256i transpose8(__m256i x)
{
    const __m256i by_one = _mm256_set1_epi64x(0x00aa00aa00aa00aa),
                  by_two = _mm256_set1_epi64x(0x0000cccc0000cccc),
                  by_four = _mm256_set1_epi64x(0x00000000f0f0f0f0);
    __m256i t = _mm256_and_si256(_mm256_xor_si256(x, _mm256_srli_epi64(x, 7)), by_one);
    x = _mm256_xor_si256(x, _mm256_xor_si256(t, _mm256_slli_epi64(t, 7)));
    t = _mm256_and_si256(_mm256_xor_si256(x, _mm256_srli_epi64(x, 14)), by_two);
    x = _mm256_xor_si256(x, _mm256_xor_si256(t, _mm256_slli_epi64(t, 14)));
    t = _mm256_and_si256(_mm256_xor_si256(x, _mm256_srli_epi64(x, 28)), by_four);
    return _mm256_xor_si256(x, _mm256_xor_si256(t, _mm256_slli_epi64(t, 28)));
}

/* Stores the cases of active cells; those of others may be left out. */
static inline void store_cases(const cell_word *c, uint64_t active, uint8_t cases[64])
{
    /* byte b of corners 0 to 3 side by side, and in the upper half of 4 to 7; b up to 3, then
     * the others */
    const __m256i low = _mm256_unpacklo_epi8(c->even, c->odd),
                  high = _mm256_unpackhi_epi8(c->even, c->odd),
                  join = _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7);
    const __m256i first = _mm256_unpacklo_epi16(low, high),
                  last = _mm256_unpackhi_epi16(low, high);
    (void)active;
    _mm256_storeu_si256((__m256i *)(void *)cases,
                        transpose8(_mm256_permutevar8x32_epi32(first, join)));
    _mm256_storeu_si256((__m256i *)(void *)(cases + 32),
                        transpose8(_mm256_permutevar8x32_epi32(last, join)));
}

#else

typedef struct cell_word {
    uint64_t corner[8];
    uint64_t mixed;
} cell_word;

static inline cell_word load_cells(const cell_rows *r, size_t w)
{
    cell_word c;
    uint64_t any = 0, all = ~UINT64_C(0);
    for (size_t n = 0; n < 4; n++) {
        c.corner[2 * n] = r->row[n][w];
        c.corner[2 * n + 1] = cwi_next_samples(r->row[n], w);
        any |= c.corner[2 * n] | c.corner[2 * n + 1];
        all &= c.corner[2 * n] & c.corner[2 * n + 1];
    }
    c.mixed = any & ~all;
    return c;
}

/* Transposes eight bytes as an 8 x 8 matrix of bits [Warren2013, 7-3]. */
static inline uint64_t transpose8(uint64_t x)
{
    uint64_t t = (x ^ x >> 7) & UINT64_C(0x00aa00aa00aa00aa);
    x ^= t ^ t << 7;
    t = (x ^ x >> 14) & UINT64_C(0x0000cccc0000cccc);
    x ^= t ^ t << 14;
    t = (x ^ x >> 28) & UINT64_C(0x00000000f0f0f0f0);
    return x ^ t ^ t << 28;
}

static inline void store_cases(const cell_word *c, uint64_t active, uint8_t cases[64])
{
    for (int b = 0; b < 64; b += 8) {
        uint64_t eight = 0;
        if (!(active >> b & 255))
            continue;
        for (int n = 0; n < 8; n++)
            eight |= (c->corner[n] >> b & 255) << 8 * n;
        eight = transpose8(eight);
        for (int n = 0; n < 8; n++)
            cases[b + n] = (uint8_t)(eight >> 8 * n);
    }
}

#endif

#endif
