/* Several words of bits at a time, of 64 cells each: finds crossed edges, and from them
 * triangles and ambiguous cells. Included by the files that are compiled for each engine. */
#ifndef EXTRACT_DENSE_CELL_BITS_H
#define EXTRACT_DENSE_CELL_BITS_H

#include <stdint.h>

#ifdef __AVX2__
#include <immintrin.h>
#endif

/* The number of words that a register holds: compilers split wider vectors by way of memory. */
#ifdef __AVX512VPOPCNTDQ__
enum { CWI_WORDS = 8 };
#elif defined __AVX2__
enum { CWI_WORDS = 4 };
#else
enum { CWI_WORDS = 2 };
#endif

typedef uint64_t cwi_words __attribute__((vector_size(8 * CWI_WORDS)));

/* Loads words without memcpy, which compiles to loads of half a register. */
static inline void cwi_load_words(const uint64_t *from, cwi_words *to)
{
    typedef cwi_words anywhere __attribute__((aligned(sizeof *from)));
    *to = *(const anywhere *)(const void *)from;
}

#if defined __AVX2__ && !defined __AVX512VPOPCNTDQ__
/* Counts the bits set in each byte: the sum of its two groups of four bits, looked up
 * [Mula2018]. */
static inline __m256i cwi_set_in_bytes(__m256i bits)
{
    const __m256i four = _mm256_set1_epi8(15),
                  set = _mm256_setr_epi8(0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4, 0, 1,
                                         1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4);
    const __m256i low = _mm256_and_si256(bits, four),
                  high = _mm256_and_si256(_mm256_srli_epi16(bits, 4), four);
    return _mm256_add_epi8(_mm256_shuffle_epi8(set, low), _mm256_shuffle_epi8(set, high));
}
#endif

/* Adds to each sum the number of bits set in its word of `count` vectors, up to 31. */
static inline void cwi_add_set(const cwi_words *bits, int count, cwi_words *sums)
{
#ifdef __AVX512VPOPCNTDQ__
    for (int b = 0; b < count; b++)
        *sums += (cwi_words)_mm512_popcnt_epi64((__m512i)bits[b]);
#elif defined __AVX2__
    __m256i bytes = _mm256_setzero_si256();
    for (int b = 0; b < count; b++)
        bytes = _mm256_add_epi8(bytes, cwi_set_in_bytes((__m256i)bits[b]));
    *sums += (cwi_words)_mm256_sad_epu8(bytes, _mm256_setzero_si256());
#else
    for (int b = 0; b < count; b++)
        for (int n = 0; n < CWI_WORDS; n++)
            (*sums)[n] += (uint64_t)__builtin_popcountll(bits[b][n]);
#endif
}

/* Returns the words that have bits set: word n, bit n. */
static inline unsigned cwi_words_set(const cwi_words *bits)
{
#ifdef __AVX512VPOPCNTDQ__
    return _mm512_test_epi64_mask((__m512i)*bits, (__m512i)*bits);
#elif defined __AVX2__
    const __m256i none = _mm256_cmpeq_epi64((__m256i)*bits, _mm256_setzero_si256());
    return 15u & ~(unsigned)_mm256_movemask_pd((__m256d)none);
#else
    unsigned set = 0;
    for (int n = 0; n < CWI_WORDS; n++)
        set |= (unsigned)((*bits)[n] != 0) << n;
    return set;
#endif
}

/* Clears the words whose bits in `active` are not set. */
static inline void cwi_keep_words(unsigned active, cwi_words *words)
{
#ifdef __AVX512VPOPCNTDQ__
    *words = (cwi_words)_mm512_maskz_mov_epi64((__mmask8)active, (__m512i)*words);
#elif defined __AVX2__
    const __m256i bit = _mm256_setr_epi64x(1, 2, 4, 8),
                  here = _mm256_and_si256(_mm256_set1_epi64x((long long)active), bit);
    *words &= (cwi_words)_mm256_cmpeq_epi64(here, bit);
#else
    for (int n = 0; n < CWI_WORDS; n++)
        (*words)[n] = active >> n & 1 ? (*words)[n] : 0;
#endif
}

/* Returns the sum of the wanted words: word n, bit n. */
static inline uint64_t cwi_sum_words(unsigned active, const cwi_words *words)
{
#ifdef __AVX512VPOPCNTDQ__
    return (uint64_t)_mm512_mask_reduce_add_epi64((__mmask8)active, (__m512i)*words);
#else
    cwi_words kept = *words;
    cwi_keep_words(active, &kept);
#ifdef __AVX2__
    const __m128i two = _mm_add_epi64(_mm256_castsi256_si128((__m256i)kept),
                                      _mm256_extracti128_si256((__m256i)kept, 1));
    return (uint64_t)_mm_cvtsi128_si64(two) + (uint64_t)_mm_extract_epi64(two, 1);
#else
    uint64_t sum = 0;
    for (int n = 0; n < CWI_WORDS; n++)
        sum += kept[n];
    return sum;
#endif
#endif
}

/* Finds the 12 edges of cubes, as in cube_numbering.h, that are crossed, from the bits of their
 * 8 corners. */
static inline void cwi_cross_edges(const cwi_words corner[8], cwi_words crossed[12])
{
    for (int n = 0; n < 4; n++) {
        const int y = (n & 2) << 1 | (n & 1);
        crossed[n] = corner[2 * n] ^ corner[2 * n + 1];
        crossed[4 + n] = corner[y] ^ corner[y + 2];
        crossed[8 + n] = corner[n] ^ corner[n + 4];
    }
}

/* Finds the cells whose signs alone do not settle their surface, as cwi_case_is_ambiguous.
 * These have all edges of a face crossed, of which three are tested, or all edges at two
 * opposite corners. */
static inline void cwi_find_ambiguous(const cwi_words crossed[12], cwi_words *ambiguous)
{
    const cwi_words *x = crossed, *y = crossed + 4, *z = crossed + 8;
    *ambiguous =
        (x[0] & x[1] & y[0]) | (x[2] & x[3] & y[2]) | (x[0] & x[2] & z[0]) |
        (x[1] & x[3] & z[2]) | (y[0] & y[2] & z[0]) | (y[1] & y[3] & z[1]) |
        (x[0] & y[0] & z[0] & x[3] & y[3] & z[3]) | (x[0] & y[1] & z[1] & x[3] & y[2] & z[2]) |
        (x[1] & y[0] & z[2] & x[2] & y[3] & z[1]) | (x[1] & y[1] & z[3] & x[2] & y[2] & z[0]);
}

/* Adds, word by word, the triangles of some cells, none of them ambiguous. Each cell has one
 * loop of its crossed edges, and two triangles less than edges. */
static inline void cwi_add_triangles(const cwi_words crossed[12], const cwi_words *cells,
                                     cwi_words *sums)
{
    cwi_words loops = {0}, here[12];
    for (int n = 0; n < 12; n++)
        here[n] = crossed[n] & *cells;
    cwi_add_set(here, 12, sums);
    cwi_add_set(cells, 1, &loops);
    *sums -= 2 * loops;
}

#endif
