/* Eight words of bits at a time, of 64 cells each: which edges are crossed, and what that makes
 * of the cells. Included by what is compiled for each engine. */
#ifndef EXTRACT_CELL_BITS_H
#define EXTRACT_CELL_BITS_H

#include <stdint.h>
#include <string.h>

#ifdef __AVX512VPOPCNTDQ__
#include <immintrin.h>
#endif

enum { CWI_WORDS = 8 };

typedef uint64_t cwi_words __attribute__((vector_size(8 * CWI_WORDS)));

static inline void cwi_load_words(const uint64_t *from, cwi_words *to)
{
    memcpy(to, from, sizeof *to);
}

/* Adds, word by word, how many bits are set. */
static inline void cwi_add_set(const cwi_words *bits, cwi_words *sums)
{
#ifdef __AVX512VPOPCNTDQ__
    *sums += (cwi_words)_mm512_popcnt_epi64((__m512i)*bits);
#else
    for (int n = 0; n < CWI_WORDS; n++)
        (*sums)[n] += (uint64_t)__builtin_popcountll((*bits)[n]);
#endif
}

/* Which words have bits set: word n, bit n. */
static inline unsigned cwi_words_set(const cwi_words *bits)
{
#ifdef __AVX512VPOPCNTDQ__
    return _mm512_test_epi64_mask((__m512i)*bits, (__m512i)*bits);
#else
    unsigned set = 0;
    for (int n = 0; n < CWI_WORDS; n++)
        set |= (unsigned)((*bits)[n] != 0) << n;
    return set;
#endif
}

/* Leaves only the words whose bits are set. */
static inline void cwi_keep_words(unsigned wanted, cwi_words *words)
{
#ifdef __AVX512VPOPCNTDQ__
    *words = (cwi_words)_mm512_maskz_mov_epi64((__mmask8)wanted, (__m512i)*words);
#else
    for (int n = 0; n < CWI_WORDS; n++)
        (*words)[n] = wanted >> n & 1 ? (*words)[n] : 0;
#endif
}

/* The 12 edges of cubes, as in cube.h, that are crossed, from the bits of their 8 corners. */
static inline void cwi_cross_edges(const cwi_words corner[8], cwi_words crossed[12])
{
    for (int n = 0; n < 4; n++) {
        const int y = (n & 2) << 1 | (n & 1);
        crossed[n] = corner[2 * n] ^ corner[2 * n + 1];
        crossed[4 + n] = corner[y] ^ corner[y + 2];
        crossed[8 + n] = corner[n] ^ corner[n + 4];
    }
}

/* The cells whose signs alone do not settle their surface, as cwi_case_is_ambiguous: those with
 * all edges of a face crossed, of which three tell, or all edges at two opposite corners. */
static inline void cwi_find_ambiguous(const cwi_words crossed[12], cwi_words *ambiguous)
{
    const cwi_words *x = crossed, *y = crossed + 4, *z = crossed + 8;
    *ambiguous =
        (x[0] & x[1] & y[0]) | (x[2] & x[3] & y[2]) | (x[0] & x[2] & z[0]) |
        (x[1] & x[3] & z[2]) | (y[0] & y[2] & z[0]) | (y[1] & y[3] & z[1]) |
        (x[0] & y[0] & z[0] & x[3] & y[3] & z[3]) | (x[0] & y[1] & z[1] & x[3] & y[2] & z[2]) |
        (x[1] & y[0] & z[2] & x[2] & y[3] & z[1]) | (x[1] & y[1] & z[3] & x[2] & y[2] & z[0]);
}

/* Adds, word by word, the triangles of some cells, none of them ambiguous: each has one loop,
 * of its crossed edges, and two triangles less than these. */
static inline void cwi_add_triangles(const cwi_words crossed[12], const cwi_words *cells,
                                     cwi_words *sums)
{
    cwi_words loops = {0};
    for (int n = 0; n < 12; n++) {
        const cwi_words here = crossed[n] & *cells;
        cwi_add_set(&here, sums);
    }
    cwi_add_set(cells, &loops);
    *sums -= 2 * loops;
}

#endif
