/* The cells of a row that the surface crosses, and the vertices around them. Included by what
 * is compiled for each engine. */
#ifndef EXTRACT_CELL_LIST_H
#define EXTRACT_CELL_LIST_H

#include "extract/cell_word.h"
#include "extract/cube.h"

#include <string.h>

/* Words whose cells are listed before they are written, so that no loop is as short as the
 * cells in a word: its end cannot be foreseen. */
enum { WORDS = 16, LIST = 64 * WORDS };

/* The rows of edges a cube's 12 edges lie in: axis, and which of the four rows of samples. */
static const struct {
    uint8_t axis, j, k;
} edge_rows[12] = {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 1, 1}, {1, 0, 0}, {1, 0, 0},
                   {1, 0, 1}, {1, 0, 1}, {2, 0, 0}, {2, 0, 0}, {2, 1, 0}, {2, 1, 0}};

/* The number of the first vertex in the row that edge n of row (j, k)'s cubes lies in. */
static inline uint32_t first_vertex(const cwi_grid *g, const cwi_row *rows, int n, size_t j,
                                    size_t k)
{
    const size_t row = (k + edge_rows[n].k) * g->rows_y + j + edge_rows[n].j;
    return rows[row].first[edge_rows[n].axis];
}

/* Bit i: there is a vertex on the edge at i, of word w, in the row that edge n of row (j, k)'s
 * cubes lies in. */
static inline uint64_t edge_vertices(const cwi_grid *g, int n, size_t j, size_t k, size_t w)
{
    return cwi_edge_vertices(g, edge_rows[n].axis, j + edge_rows[n].j, k + edge_rows[n].k, w);
}

/* Of the mixed cells of a word, those that are live. */
static inline uint64_t active_cells(const cwi_grid *g, uint64_t mixed, size_t j, size_t k,
                                    size_t w)
{
    return g->live ? mixed & cwi_live_cells(g, j, k, w) : mixed;
}

#if CWI_WIDE

/* The rows of edges around half a word of cells, with what ranks need. Rows of y- and z-edges
 * stand twice, for the edges at i and at i + 1: lane n is edge n of the cube. */
typedef struct edge_half {
    _Alignas(64) uint32_t crossed[16];
    _Alignas(64) uint32_t first[16]; /* number of the first vertex in the half word */
} edge_half;

enum { HALF = 32 };

/* The vertices on the edges of a cell: lane n is edge n. */
typedef __m512i cell_numbers;

typedef struct cell_list {
    edge_half edges[2 * WORDS + 1];
    cell_numbers numbers; /* not used between cells */
    size_t word[WORDS];
    uint16_t cell[LIST + 64]; /* 64 times the number of its word here, and its bit */
    uint8_t cases[LIST];      /* of all cells in these words */
} cell_list;

static inline void begin_row(cell_list *l, const cwi_grid *g, const cwi_row *rows, size_t j,
                             size_t k)
{
    for (int n = 0; n < 12; n++)
        l->edges[0].first[n] = first_vertex(g, rows, n, j, k);
}

/* Lists go on, in the same row, after one of so many words. */
static inline void go_on(cell_list *l, size_t words)
{
    memcpy(l->edges[0].first, l->edges[2 * words].first, sizeof l->edges[0].first);
}

/* Crossings of the edges around word w of the cells in row (j, k). */
static inline void load_edges(edge_half e[2], const cwi_grid *g, const cell_word *c, size_t j,
                              size_t k, size_t w)
{
    if (g->live && !g->window) {
        for (int n = 0; n < 12; n++) {
            const uint64_t crossed = edge_vertices(g, n, j, k, w);
            e[0].crossed[n] = (uint32_t)crossed;
            e[1].crossed[n] = (uint32_t)(crossed >> HALF);
        }
        return;
    }
    const __m512i low = _mm512_set_epi64(4, 4, 0, 0, 6, 4, 2, 0),
                  high = _mm512_set_epi64(6, 6, 2, 2, 7, 5, 3, 1),
                  up = _mm512_set_epi64(4, 4, 4, 4, 6, 6, 4, 4),
                  below = _mm512_set_epi64(0, 0, 0, 0, 2, 2, 0, 0);
    __m512i along_xy = _mm512_xor_si512(_mm512_permutexvar_epi64(low, c->corner),
                                        _mm512_permutexvar_epi64(high, c->corner));
    __m512i along_z = _mm512_maskz_xor_epi64(15, _mm512_permutexvar_epi64(below, c->corner),
                                             _mm512_permutexvar_epi64(up, c->corner));
    if (g->window) {
        long long live[12];
        for (int n = 0; n < 12; n++)
            live[n] = (long long)*cwi_window(g, edge_rows[n].axis, j + edge_rows[n].j,
                                             k + edge_rows[n].k);
        along_xy =
            _mm512_and_si512(along_xy, _mm512_set_epi64(live[7], live[6], live[5], live[4],
                                                        live[3], live[2], live[1], live[0]));
        along_z = _mm512_and_si512(
            along_z, _mm512_set_epi64(0, 0, 0, 0, live[11], live[10], live[9], live[8]));
    }
    const __m512i even = _mm512_set_epi32(30, 28, 26, 24, 22, 20, 18, 16, 14, 12, 10, 8, 6, 4,
                                          2, 0),
                  odd = _mm512_or_si512(even, _mm512_set1_epi32(1));
    _mm512_store_si512(e[0].crossed, _mm512_permutex2var_epi32(along_xy, even, along_z));
    _mm512_store_si512(e[1].crossed, _mm512_permutex2var_epi32(along_xy, odd, along_z));
}

/* The edges of the next half word: numbers go on after those of this one. */
static inline void number_edges(edge_half *e, const edge_half *before)
{
    _mm512_store_si512(
        e->first, _mm512_add_epi32(_mm512_load_si512(before->first),
                                   _mm512_popcnt_epi32(_mm512_load_si512(before->crossed))));
}

/* Lists the active cells of word w after n others and so many words. Returns how many cells
 * there are then. */
static inline size_t list_cells(cell_list *l, size_t words, size_t n, const cwi_grid *g,
                                const cell_rows *samples, size_t j, size_t k, size_t w)
{
    const cell_word c = load_cells(samples, w);
    const uint64_t active = active_cells(g, c.mixed, j, k, w);
    const size_t after = n + (size_t)__builtin_popcountll(active);
    edge_half *e = &l->edges[2 * words];
    load_edges(e, g, &c, j, k, w);
    number_edges(e + 1, e);
    number_edges(e + 2, e + 1);
    l->word[words] = w;
    const __m512i iota = _mm512_load_si512(cwi_iota);
    const __m512i bits = _mm512_maskz_compress_epi8(active, iota);
    const __m512i base = _mm512_set1_epi16((int16_t)(64 * words));
    store_cases(&c, active, l->cases + 64 * words);
    _mm512_storeu_si512(
        l->cell + n, _mm512_or_si512(base, _mm512_cvtepu8_epi16(_mm512_castsi512_si256(bits))));
    if (after > n + 32)
        _mm512_storeu_si512(
            l->cell + n + 32,
            _mm512_or_si512(base, _mm512_cvtepu8_epi16(_mm512_extracti64x4_epi64(bits, 1))));
    return after;
}

/* The vertices around a listed cell, from their ranks. */
static inline void number_cell(const cell_list *l, bool all_live, size_t place,
                               const uint8_t *crossed, cell_numbers *numbers)
{
    /* edges 5, 7, 9 and 11 stand at i + 1 */
    const __m512i ones =
        _mm512_set_epi32(-1, -1, -1, -1, -2, -1, -2, -1, -2, -1, -2, -1, -1, -1, -1, -1);
    const edge_half *e = &l->edges[place / HALF];
    const __m512i not_before = _mm512_sllv_epi32(ones, _mm512_set1_epi32((int)(place % HALF)));
    const __m512i before =
        _mm512_andnot_si512(not_before, _mm512_load_si512((const void *)e->crossed));
    (void)all_live, (void)crossed;
    *numbers = _mm512_add_epi32(_mm512_load_si512((const void *)e->first),
                                _mm512_popcnt_epi32(before));
}

static inline void cell_vertices(const cell_numbers *numbers, uint32_t vertex[12])
{
    _mm512_mask_storeu_epi32(vertex, 0xfff, *numbers);
}

/* Writes the vertices at up to 16 edges; what is too much, before end, the next cells write
 * over. */
static inline uint32_t *put(const cell_numbers *numbers, const uint8_t *edge, unsigned count,
                            uint32_t *out, const uint32_t *end)
{
    const __m128i edges = _mm_loadu_si128((const __m128i *)(const void *)edge);
    const __m512i all = _mm512_permutexvar_epi32(_mm512_cvtepu8_epi32(edges), *numbers);
    if (end - out >= 16)
        _mm512_storeu_si512(out, all);
    else
        _mm512_mask_storeu_epi32(out, (__mmask16)((1u << count) - 1), all);
    return out + count;
}

#else

/* Rows of edges around a row of cells: four along x, and two along each of y and z, at i. Edges
 * at i + 1 are those at i of the next cell. */
typedef uint32_t edge_lanes __attribute__((vector_size(4 * CWI_EDGE_ROWS)));

/* The numbers of the first vertices in each row from a cell's i on, and from i + 1 on. */
typedef struct cell_numbers {
    edge_lanes here, next;
} cell_numbers;

typedef struct cell_list {
    cell_numbers numbers; /* of the cell before */
    struct {
        uint64_t crossed[CWI_EDGE_ROWS];
        uint32_t first[CWI_EDGE_ROWS]; /* number of the first vertex in the word */
    } edges[WORDS + 1];                /* known where some cells are not live */
    size_t word[WORDS];
    uint16_t cell[LIST + 4]; /* 64 times the number of its word here, and its bit */
    uint8_t cases[LIST];     /* of all cells in these words */
} cell_list;

static inline void begin_row(cell_list *l, const cwi_grid *g, const cwi_row *rows, size_t j,
                             size_t k)
{
    for (int n = 0; n < CWI_EDGE_ROWS; n++)
        l->numbers.next[n] = l->edges[0].first[n] =
            first_vertex(g, rows, cwi_row_edge(n), j, k);
}

/* Lists go on, in the same row, after one of so many words. */
static inline void go_on(cell_list *l, size_t words)
{
    memcpy(l->edges[0].first, l->edges[words].first, sizeof l->edges[0].first);
}

/* Crossings of the edges around a word of cells some of which are not live. */
static void load_edges(cell_list *l, size_t words, const cwi_grid *g, size_t j, size_t k,
                       size_t w)
{
    for (int n = 0; n < CWI_EDGE_ROWS; n++) {
        const uint64_t crossed = edge_vertices(g, cwi_row_edge(n), j, k, w);
        l->edges[words].crossed[n] = crossed;
        l->edges[words + 1].first[n] =
            l->edges[words].first[n] + (uint32_t)__builtin_popcountll(crossed);
    }
}

/* Lists the active cells of word w after n others and so many words. Returns how many cells
 * there are then. */
static inline size_t list_cells(cell_list *l, size_t words, size_t n, const cwi_grid *g,
                                const cell_rows *samples, size_t j, size_t k, size_t w)
{
    const cell_word c = load_cells(samples, w);
    uint64_t active = active_cells(g, c.mixed, j, k, w);
    const size_t after = n + (size_t)__builtin_popcountll(active);
    store_cases(&c, active, l->cases + 64 * words);
    l->word[words] = w;
    if (g->live)
        load_edges(l, words, g, j, k, w);
    for (; active; n += 4) /* several at a time: see list_edges */
        for (size_t m = n; m < n + 4; m++, active &= active - 1)
            l->cell[m] = (uint16_t)(64 * words + cwi_lowest(active));
    return after;
}

/* The numbers of the first vertices from a cell on, from their ranks. */
static inline void rank_cell(const cell_list *l, size_t place, edge_lanes *lanes)
{
    const uint64_t before = (UINT64_C(1) << place % 64) - 1;
    uint32_t first[CWI_EDGE_ROWS];
    for (int n = 0; n < CWI_EDGE_ROWS; n++)
        first[n] = l->edges[place / 64].first[n] +
                   (uint32_t)__builtin_popcountll(l->edges[place / 64].crossed[n] & before);
    memcpy(lanes, first, sizeof *lanes);
}

/* Goes on to the next cell of a list. Where all cells are live each crossed edge is one of a
 * listed cell's, and numbers need but be counted on; else they are ranks. crossed: the cell's
 * case as in cwi_emission. No lane is named here and below: all may stay in registers. */
static inline void number_cell(const cell_list *l, bool all_live, size_t place,
                               const uint8_t *crossed, cell_numbers *numbers)
{
    numbers->here = numbers->next;
    if (!all_live)
        rank_cell(l, place, &numbers->here);
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

/* Writes the vertices at some edges, and no more. Not inline: where larger writes are at hand
 * this is seldom called, and a burden on the loop around. */
__attribute__((noinline)) static void put_few(const cell_numbers *numbers, const uint8_t *edge,
                                              unsigned count, uint32_t *out)
{
    uint32_t vertex[12];
    cell_vertices(numbers, vertex);
    for (unsigned n = 0; n < count; n++)
        out[n] = vertex[edge[n]];
}

/* Writes the vertices at up to 16 edges; what is too much, before end, the next cells write
 * over. */
static inline uint32_t *put(const cell_numbers *numbers, const uint8_t *edge, unsigned count,
                            uint32_t *out, const uint32_t *end)
{
#ifdef __AVX2__
    /* an edge's row, and the sign where it stands at i + 1 */
    const __m128i rows =
        _mm_setr_epi8(0, 1, 2, 3, 4, 4 - 128, 5, 5 - 128, 6, 6 - 128, 7, 7 - 128, 0, 0, 0, 0);
    __m128i at = _mm_shuffle_epi8(rows, _mm_loadu_si128((const __m128i *)(const void *)edge));
    if (__builtin_expect(end - out < 16, 0)) {
        const cell_numbers copy = *numbers; /* so that they may stay in registers */
        put_few(&copy, edge, count, out);
        return out + count;
    }
    for (int n = 0; n < 16; n += 8, at = _mm_srli_si128(at, 8)) {
        const __m256i lane = _mm256_cvtepi8_epi32(at);
        const __m256i here = _mm256_permutevar8x32_epi32((__m256i)numbers->here, lane),
                      next = _mm256_permutevar8x32_epi32((__m256i)numbers->next, lane);
        _mm256_storeu_ps((float *)(void *)(out + n),
                         _mm256_blendv_ps((__m256)here, (__m256)next, (__m256)lane));
    }
#else
    (void)end;
    put_few(numbers, edge, count, out);
#endif
    return out + count;
}

#endif

#endif
