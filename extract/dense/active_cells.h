/* The cells of a row that the surface crosses, and the vertices around them. Included by the
 * files that are compiled for each engine. */
#ifndef EXTRACT_DENSE_ACTIVE_CELLS_H
#define EXTRACT_DENSE_ACTIVE_CELLS_H

#include "core/cases/cube_numbering.h"
#include "extract/dense/cell_word.h"

#include <string.h>

/* Words whose cells are listed before they are written. A loop over the cells of one word would
 * be too short: its end cannot be predicted. */
enum { WORDS = 16, LIST = 64 * WORDS };

/* The eight rows of edges around a row of cells, in the order of cwi_row_edge(): their axis,
 * and the row of samples, out of four, in which they begin. */
static const struct {
    uint8_t axis, j, k;
} edge_rows[CWI_EDGE_ROWS] = {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 1, 1},
                              {1, 0, 0}, {1, 0, 1}, {2, 0, 0}, {2, 1, 0}};

typedef uint32_t edge_lanes __attribute__((vector_size(4 * CWI_EDGE_ROWS)));

/* Numbers of the first vertices in each row: from a cell's i on, and from i + 1 on. */
typedef struct cell_numbers {
    edge_lanes here, next;
} cell_numbers;

typedef struct cell_list {
    cell_numbers numbers; /* of the cell before */
    struct {
        _Alignas(64) uint64_t crossed[CWI_EDGE_ROWS];
        uint32_t first[CWI_EDGE_ROWS]; /* number of the first vertex in the word */
    } edges[WORDS + 1];                /* known where numbers are ranks */
    size_t word[WORDS];
    uint16_t cell[LIST + 64]; /* 64 times the number of its word here, and its bit */
    uint8_t cases[LIST];      /* of all cells in these words */
} cell_list;

static inline void begin_row(cell_list *l, const cwi_bit_grid *g, const cwi_row *rows, size_t j,
                             size_t k)
{
    for (int n = 0; n < CWI_EDGE_ROWS; n++) {
        const size_t row = (k + edge_rows[n].k) * g->rows_y + j + edge_rows[n].j;
        l->numbers.next[n] = l->edges[0].first[n] = rows[row].first[edge_rows[n].axis];
    }
}

/* Continues the lists in the same row, after a list of `words` words. */
static inline void go_on(cell_list *l, size_t words)
{
    memcpy(l->edges[0].first, l->edges[words].first, sizeof l->edges[0].first);
}

/* Loads the vertices on the edges around a word of cells some of which are not live. */
static inline void load_edges(cell_list *l, size_t words, const cwi_bit_grid *g,
                              const cell_rows *samples, size_t j, size_t k, size_t w)
{
    uint64_t own[4], *crossed = l->edges[words].crossed;
    for (int n = 0; n < 4; n++) {
        own[n] = samples->row[n][w];
        crossed[n] = own[n] ^ cwi_next_samples(samples->row[n], w);
    }
    crossed[4] = own[0] ^ own[1]; /* along y */
    crossed[5] = own[2] ^ own[3];
    crossed[6] = own[0] ^ own[2]; /* along z */
    crossed[7] = own[1] ^ own[3];
    for (int n = 0; n < CWI_EDGE_ROWS; n++) {
        crossed[n] &=
            cwi_edge_mask(g, edge_rows[n].axis, j + edge_rows[n].j, k + edge_rows[n].k, w);
        l->edges[words + 1].first[n] =
            l->edges[words].first[n] + (uint32_t)__builtin_popcountll(crossed[n]);
    }
}

/* Lists the numbers of the cells whose bits are set, `count` of them. */
static inline void list_bits(uint64_t bits, size_t count, size_t word, uint16_t *cell)
{
#if CWI_WIDE
    const __m512i bit_numbers = _mm512_maskz_compress_epi8(bits, _mm512_load_si512(cwi_iota)),
                  base = _mm512_set1_epi16((int16_t)(64 * word));
    _mm512_storeu_si512(
        cell, _mm512_or_si512(base, _mm512_cvtepu8_epi16(_mm512_castsi512_si256(bit_numbers))));
    if (count > 32)
        _mm512_storeu_si512(
            cell + 32, _mm512_or_si512(base, _mm512_cvtepu8_epi16(
                                                 _mm512_extracti64x4_epi64(bit_numbers, 1))));
#else
    for (size_t n = 0; n < count; n += 4) /* several at a time: see list_edges */
        for (size_t m = n; m < n + 4; m++, bits &= bits - 1)
            cell[m] = (uint16_t)(64 * word + cwi_lowest(bits));
#endif
}

/* Returns true if each crossed edge around row (j, k) of cells that has a vertex belongs to a
 * live cell. Numbers then only count on from cell to cell. */
static inline bool counts_on(const cwi_bit_grid *g, size_t j, size_t k)
{
    return !g->live || cwi_is_whole(g, j, k);
}

/* Lists the active cells of word w, after n other cells and `words` other words. Returns the
 * number of cells listed then. */
static inline size_t list_cells(cell_list *l, size_t words, size_t n, const cwi_bit_grid *g,
                                const cell_rows *samples, size_t j, size_t k, size_t w)
{
    const cell_word c = load_cells(samples, w);
    const uint64_t active = g->live ? c.mixed & cwi_live_cells(g, j, k, w) : c.mixed;
    const size_t count = (size_t)__builtin_popcountll(active);
    store_cases(&c, active, l->cases + 64 * words);
    l->word[words] = w;
    if (!counts_on(g, j, k))
        load_edges(l, words, g, samples, j, k, w);
    list_bits(active, count, words, l->cell + n);
    return n + count;
}

/* Finds the numbers of the first vertices from a cell on, from their ranks. */
static inline void rank_cell(const cell_list *l, size_t slot, edge_lanes *lanes)
{
    const uint64_t before = (UINT64_C(1) << slot % 64) - 1;
#if CWI_WIDE
    const __m512i crossed = _mm512_load_si512((const void *)l->edges[slot / 64].crossed);
    const __m512i ranks =
        _mm512_popcnt_epi64(_mm512_and_si512(crossed, _mm512_set1_epi64((long long)before)));
    memcpy(lanes, l->edges[slot / 64].first, sizeof *lanes);
    *lanes += (edge_lanes)_mm512_cvtepi64_epi32(ranks);
#else
    uint32_t first[CWI_EDGE_ROWS];
    for (int n = 0; n < CWI_EDGE_ROWS; n++)
        first[n] = l->edges[slot / 64].first[n] +
                   (uint32_t)__builtin_popcountll(l->edges[slot / 64].crossed[n] & before);
    memcpy(lanes, first, sizeof *lanes);
#endif
}

/* Goes on to the next cell of a list, whose numbers are counted on, see counts_on(), or are
 * ranks. crossed: the cell's case as in cwi_emission. No lane is named here and below: all may
 * stay in registers. */
static inline void number_cell(const cell_list *l, bool count_on, size_t slot,
                               const uint8_t *crossed, cell_numbers *numbers)
{
    numbers->here = numbers->next;
    if (!count_on)
        rank_cell(l, slot, &numbers->here);
#ifdef __AVX2__
    numbers->next = numbers->here + (edge_lanes)_mm256_cvtepu8_epi32(_mm_loadu_si64(crossed));
#else
    uint32_t step[CWI_EDGE_ROWS];
    edge_lanes lanes;
    for (int n = 0; n < CWI_EDGE_ROWS; n++)
        step[n] = crossed[n];
    memcpy(&lanes, step, sizeof lanes);
    numbers->next = numbers->here + lanes;
#endif
}

static inline void cell_vertices(const cell_numbers *numbers, uint32_t vertex[12])
{
    uint32_t here[CWI_EDGE_ROWS], next[CWI_EDGE_ROWS];
    memcpy(here, &numbers->here, sizeof here);
    memcpy(next, &numbers->next, sizeof next);
    for (int n = 0; n < 12; n++)
        vertex[n] = n < 4 ? here[n] : n & 1 ? next[2 + n / 2] : here[2 + n / 2];
}

/* Writes the vertices at some edges, and no more. It is not inline: it is seldom called where
 * larger writes are possible, and would slow the loop around it. */
__attribute__((noinline)) static void put_few(const cell_numbers *numbers, const uint8_t *edge,
                                              unsigned count, uint32_t *out)
{
    uint32_t vertex[12];
    cell_vertices(numbers, vertex);
    for (unsigned n = 0; n < count; n++)
        out[n] = vertex[edge[n]];
}

/* Writes the vertices at up to 16 edges. Those in excess, before end, are overwritten by the
 * next cells. */
static inline uint32_t *put_triangles(const cell_numbers *numbers, const uint8_t *edge,
                                      unsigned count, uint32_t *out, const uint32_t *end)
{
#ifdef __AVX2__
    /* an edge's row; and 8, and the sign, where it stands at i + 1 */
    enum { NEXT = 8 - 128 };
    const __m128i rows = _mm_setr_epi8(0, 1, 2, 3, 4, 4 + NEXT, 5, 5 + NEXT, 6, 6 + NEXT, 7,
                                       7 + NEXT, 0, 0, 0, 0);
    __m128i at = _mm_shuffle_epi8(rows, _mm_loadu_si128((const __m128i *)(const void *)edge));
    if (__builtin_expect(end - out < 16, 0)) {
        const cell_numbers copy = *numbers; /* so that they may stay in registers */
        put_few(&copy, edge, count, out);
        return out + count;
    }
#if CWI_WIDE
    const __m512i both = _mm512_inserti64x4(_mm512_castsi256_si512((__m256i)numbers->here),
                                            (__m256i)numbers->next, 1);
    _mm512_storeu_si512(out, _mm512_permutexvar_epi32(_mm512_cvtepu8_epi32(at), both));
#else
    for (int n = 0; n < 16; n += 8, at = _mm_srli_si128(at, 8)) {
        const __m256i lane = _mm256_cvtepi8_epi32(at);
        const __m256i here = _mm256_permutevar8x32_epi32((__m256i)numbers->here, lane),
                      next = _mm256_permutevar8x32_epi32((__m256i)numbers->next, lane);
        _mm256_storeu_ps((float *)(void *)(out + n),
                         _mm256_blendv_ps((__m256)here, (__m256)next, (__m256)lane));
    }
#endif
#else
    (void)end;
    put_few(numbers, edge, count, out);
#endif
    return out + count;
}

#endif
