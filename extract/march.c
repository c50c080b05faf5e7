/* Counting and writing a layer of cells, from bit planes. Compiled for each engine. */
#include "extract/ambiguous.h"
#include "extract/cell_bits.h"
#include "extract/cell_word.h"
#include "extract/cube.h"

#include <string.h>

static inline int popcount(uint64_t x)
{
    return __builtin_popcountll(x);
}

/* What some words of a layer come to; after a row's last word comes the next row's first. */
typedef struct word_counts {
    unsigned busy; /* words with cells whose corners are on both sides: word n, bit n */
    cwi_words mixed, ambiguous; /* these cells, and those whose signs do not settle the rest */
    cwi_words counts;           /* fields of COUNT_BITS: edges that are crossed along each axis,
                                   and triangles of cells that are not ambiguous */
} word_counts;

enum { COUNT_BITS = 16 }; /* 64 cells have 320 triangles at most, and eight words are summed */

/* Finds out about the cells that matter, and counts. */
static inline void count_cells(const cwi_grid *g, size_t first, const cwi_words corner[8],
                               word_counts *c)
{
    cwi_words crossed[12], cells = c->mixed, count = {0};
    cwi_cross_edges(corner, crossed);
    cwi_find_ambiguous(crossed, &c->ambiguous);
    if (g->live) {
        cwi_load_words(g->live + first, &cells);
        cells &= c->mixed;
    }
    c->ambiguous &= cells;
    cells &= ~c->ambiguous;
    cwi_add_triangles(crossed, &cells, &count);
    for (int axis = 2; axis >= 0; axis--) {
        count <<= COUNT_BITS;
        cwi_add_set(&crossed[4 * axis], &count);
    }
    c->counts = count;
}

/* Counts the words from one of layer k on, those that are wanted: word n, bit n. */
static inline void count_words(const cwi_grid *g, size_t k, size_t word, unsigned wanted,
                               word_counts *c)
{
    const size_t layer = g->rows_y * g->words, first = k * layer + word;
    const size_t row[4] = {0, g->words, layer, layer + g->words};
    cwi_words corner[8], any = {0}, none = {0};
    for (int n = 0; n < 4; n++) {
        cwi_words after;
        cwi_load_words(g->inside + first + row[n], &corner[2 * n]);
        cwi_load_words(g->inside + first + row[n] + 1, &after);
        corner[2 * n + 1] = corner[2 * n] >> 1 | after << 63;
        any |= corner[2 * n] | corner[2 * n + 1];
        none |= ~corner[2 * n] | ~corner[2 * n + 1];
    }
    c->mixed = any & none;
    if (g->window) {
        cwi_load_words(g->window + k * g->rows_y + word, &any);
        c->mixed &= any;
    }
    cwi_keep_words(wanted, &c->mixed);
    c->busy = cwi_words_set(&c->mixed);
    if (c->busy) {
        count_cells(g, first, corner, c);
        cwi_keep_words(c->busy, &c->counts);
    }
}

/* Counts what becomes of the ambiguous cells in word w of row (j, k). */
static void count_ambiguous(const cwi_grid *g, uint64_t ambiguous, size_t j, size_t k, size_t w,
                            cwi_row *row)
{
    const cell_rows rows = rows_around(g, j, k);
    const cell_word c = load_cells(&rows, w);
    uint8_t cases[64];
    store_cases(&c, ambiguous, cases);
    for (; ambiguous; ambiguous &= ambiguous - 1) {
        const int i = __builtin_ctzll(ambiguous);
        cwi_cell_plan plan;
        if (g->simple) {
            row->triangle += cwi_case_count[cases[i]];
            continue;
        }
        cwi_ambiguous_plan(g, (const size_t[3]){64 * w + (size_t)i, j, k}, cases[i], &plan);
        row->triangle += (size_t)plan.triangle_count;
        row->first[3] += (uint32_t)plan.vertex_count;
    }
}

/* The first so many of CWI_WORDS words. */
static inline unsigned first_words(size_t count)
{
    return count < CWI_WORDS ? (1u << count) - 1 : (1u << CWI_WORDS) - 1;
}

/* Some of the cells of so many words from word w of row (j, k) on, the n-th that were counted,
 * are, in part, padding: there the solid meets the border. */
static bool meets_border(const cwi_grid *g, const word_counts *c, int n, int count, size_t j,
                         size_t k, size_t w)
{
    const size_t *dim = g->volume.dim, last = dim[0] / 64;
    if (j == 0 || k == 0 || j == dim[1] || k == dim[2])
        return true;
    return (w == 0 && (c->mixed[n] & 1)) ||
           (last - w < (size_t)count && (c->mixed[n + (int)(last - w)] >> dim[0] % 64 & 1));
}

/* Vertices on edges of live cells, along each axis, in the busy words from word w of row (j, k)
 * on, packed like counts. */
static uint64_t count_live_edges(const cwi_grid *g, unsigned busy, size_t j, size_t k, size_t w)
{
    uint64_t count = 0;
    for (; busy; busy &= busy - 1)
        for (int axis = 0; axis < 3; axis++)
            count += (uint64_t)popcount(
                         cwi_edge_vertices(g, axis, j, k, w + (size_t)__builtin_ctz(busy)))
                     << COUNT_BITS * axis;
    return count;
}

/* Adds so many words from word w of row (j, k) on, the n-th that were counted, to their row's
 * counts. An edge that is crossed belongs to a cell whose corners differ, as the last samples
 * of every row, and the last rows, are padding. */
static inline void take_words(const cwi_grid *g, const word_counts *c, int n, int count,
                              size_t j, size_t k, size_t w, cwi_row *row)
{
    const unsigned busy = c->busy >> n & first_words((size_t)count);
    const uint64_t field = (UINT64_C(1) << COUNT_BITS) - 1;
    uint64_t sums = 0;
    if (!busy)
        return;
    g->busy[(k * g->rows_y + j) * g->masks + w / 64] |= (uint64_t)busy << w % 64;
    for (int i = n; i < n + count; i++)
        sums += c->counts[i];
    row->triangle += sums >> 3 * COUNT_BITS;
    if (g->live)
        sums = count_live_edges(g, busy, j, k, w);
    for (int axis = 0; axis < 3; axis++)
        row->first[axis] += (uint32_t)(sums >> COUNT_BITS * axis & field);
    for (int i = n; i < n + count; i++)
        if (c->ambiguous[i])
            count_ambiguous(g, c->ambiguous[i], j, k, w + (size_t)(i - n), row);
    if (!g->layers[k].at_border)
        g->layers[k].at_border = meets_border(g, c, n, count, j, k, w);
}

/* Counts the wanted ones of CWI_WORDS words of layer k, from word w of row j on. Leaves counts,
 * not yet first numbers, in the layer's rows. */
static void count_group(const cwi_grid *g, size_t j, size_t k, size_t w, unsigned wanted,
                        cwi_row *rows)
{
    word_counts c;
    count_words(g, k, j * g->words + w, wanted, &c);
    for (int n = 0, count; n < CWI_WORDS && c.busy >> n; n += count) {
        /* those in the same row and word of its mask */
        const size_t end = (w | 63) + 1 < g->words ? (w | 63) + 1 : g->words;
        count = end - w < (size_t)(CWI_WORDS - n) ? (int)(end - w) : CWI_WORDS - n;
        take_words(g, &c, n, count, j, k, w, rows + j);
        w = end < g->words ? end : 0;
        j += w == 0;
    }
}

/* Some sample in the rows of samples around these rows of cells of layer k is inside, or it is
 * not known. */
static bool any_filled(const cwi_grid *g, size_t j, size_t last, size_t k)
{
    const bool *filled = g->filled + k * g->rows_y;
    bool any = g->window != NULL;
    for (; j <= last + 1 && !any; j++)
        any = filled[j] || filled[g->rows_y + j];
    return any;
}

static void count_all(const cwi_grid *g, size_t k, cwi_row *rows)
{
    const size_t last = g->rows_y - 2;
    for (size_t j = 0, w = 0; j <= last;) {
        const size_t left = (last + 1 - j) * g->words - w;
        size_t end = j, after = w + CWI_WORDS;
        for (; after >= g->words; after -= g->words)
            end++;
        if (any_filled(g, j, end < last ? end : last, k))
            count_group(g, j, k, w, first_words(left), rows);
        j = end;
        w = after;
    }
}

static void count_wanted(const cwi_grid *g, size_t k, cwi_row *rows)
{
    for (size_t j = 0; j + 1 < g->rows_y; j++) {
        const uint64_t *wanted = cwi_grid_wanted(g, j, k);
        for (size_t w = cwi_next_word(wanted, 0, g->words); w < g->words;) {
            const size_t end = (w | 63) + 1, here = end - w < CWI_WORDS ? end - w : CWI_WORDS;
            count_group(g, j, k, w, wanted[w / 64] >> w % 64 & first_words(here), rows);
            w = cwi_next_word(wanted, w + here, g->words);
        }
    }
}

/* Turns the counts of a layer's rows into first numbers within the layer. */
static void sum_layer(cwi_row *rows, size_t count, cwi_layer *layer)
{
    uint32_t vertex = 0;
    size_t triangle = 0;
    for (size_t j = 0; j < count; j++) {
        const size_t triangles_here = rows[j].triangle;
        for (int kind = 0; kind < 4; kind++) {
            const uint32_t here = rows[j].first[kind];
            rows[j].first[kind] = vertex;
            vertex += here;
        }
        rows[j].triangle = triangle;
        triangle += triangles_here;
    }
    layer->vertices = vertex;
    layer->triangles = triangle;
}

void cwi_count_layer(const cwi_grid *g, size_t k, cwi_row *rows)
{
    cwi_layer *layer = &g->layers[k];
    const size_t first = k * g->rows_y;
    layer->plan_count = 0;
    layer->at_border = false;
    memset(rows + first, 0, g->rows_y * sizeof *rows);
    memset(g->busy + first * g->masks, 0, g->rows_y * g->masks * sizeof *g->busy);
    if (k + 1 < g->rows_z && g->everything)
        count_all(g, k, rows + first);
    else if (k + 1 < g->rows_z)
        count_wanted(g, k, rows + first);
    sum_layer(rows + first, g->rows_y, layer);
}

/* Of the mixed cells of a word, those that are live. */
static inline uint64_t active_cells(const cwi_grid *g, uint64_t mixed, size_t j, size_t k,
                                    size_t w)
{
    return g->live ? mixed & cwi_live_cells(g, j, k, w) : mixed;
}

/* The rows of edges around half a word of cells, with what ranks need. Rows of y- and z-edges
 * stand twice, for the edges at i and at i + 1: lane n is edge n of the cube. */
typedef struct edge_half {
    _Alignas(64) uint32_t crossed[16];
    _Alignas(64) uint32_t first[16]; /* number of the first vertex in the half word */
} edge_half;

enum { HALF = 32 };

/* The vertices on the 12 edges of cell i of a half word: where they would be numbered if
 * crossed. */
static inline void cell_vertices(const edge_half *e, size_t i, uint32_t vertex[12])
{
    const uint32_t here = UINT32_C(1) << i, before = here - 1, with = here | before;
    for (int n = 0; n < 12; n++)
        vertex[n] = e->first[n] + (uint32_t)__builtin_popcount(
                                      e->crossed[n] & (n >= 4 && n & 1 ? with : before));
}

/* The rows of edges a cube's 12 edges lie in: axis, and which of the four rows of samples. */
static const struct {
    uint8_t axis, j, k;
} edge_rows[12] = {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 1, 1}, {1, 0, 0}, {1, 0, 0},
                   {1, 0, 1}, {1, 0, 1}, {2, 0, 0}, {2, 0, 0}, {2, 1, 0}, {2, 1, 0}};

/* Crossings of one row of edges around a word of cells. */
static inline void set_edges(edge_half e[2], int n, uint64_t crossed)
{
    e[0].crossed[n] = (uint32_t)crossed;
    e[1].crossed[n] = (uint32_t)(crossed >> HALF);
}

/* Crossings of the edges around word w of the cells in row (j, k). */
static inline void load_edges(edge_half e[2], const cwi_grid *g, const cell_word *c, size_t j,
                              size_t k, size_t w)
{
    if (g->live && !g->window) {
        for (int n = 0; n < 12; n++)
            set_edges(e, n,
                      cwi_edge_vertices(g, edge_rows[n].axis, j + edge_rows[n].j,
                                        k + edge_rows[n].k, w));
        return;
    }
#if CWI_WIDE
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
#else
    for (int n = 0; n < 12; n++) {
        const int axis = edge_rows[n].axis;
        const int corner = cwi_edge_corner(n); /* 5, 7, 9 and 11 stand at i + 1 */
        uint64_t crossed = c->corner[axis ? corner & ~1 : corner] ^
                           c->corner[(axis ? corner & ~1 : corner) | 1 << axis];
        if (g->window)
            crossed &= *cwi_window(g, axis, j + edge_rows[n].j, k + edge_rows[n].k);
        set_edges(e, n, crossed);
    }
#endif
}

/* The edges of the next half word: numbers go on after those of this one. */
static inline void number_edges(edge_half *e, const edge_half *before)
{
#if CWI_WIDE
    _mm512_store_si512(
        e->first, _mm512_add_epi32(_mm512_load_si512(before->first),
                                   _mm512_popcnt_epi32(_mm512_load_si512(before->crossed))));
#else
    for (int n = 0; n < 12; n++)
        e->first[n] = before->first[n] + (uint32_t)__builtin_popcount(before->crossed[n]);
#endif
}

/* Words whose cells are listed before they are written, so that no loop is as short as the
 * cells in a word: its end cannot be foreseen. */
enum { WORDS = 16, LIST = 64 * WORDS, AMBIGUOUS = 1 << 15 };

typedef struct cell_list {
    edge_half edges[2 * WORDS + 1];
    size_t word[WORDS];
    uint16_t cell[LIST + 64]; /* 64 times the number of its word in the list, its bit, and
                                 whether it is ambiguous */
    uint8_t cases[LIST + 64];
} cell_list;

/* Lists the active cells of a word after n others and so many words; simple: none is ambiguous.
 * Returns how many cells there are then. */
static inline size_t list_cells(cell_list *l, size_t words, size_t n, const cell_word *c,
                                uint64_t active, bool simple)
{
    const size_t first = 64 * words, after = n + (size_t)popcount(active);
#if CWI_WIDE
    const __m512i iota = _mm512_load_si512(cwi_iota);
    const __m512i bits = _mm512_maskz_compress_epi8(active, iota);
    const uint64_t flags = simple ? 0 : _pext_u64(ambiguous_cells(c, active), active);
    const __m512i base = _mm512_set1_epi16((int16_t)first), flag = _mm512_set1_epi16(INT16_MIN);
    const __m512i low =
        _mm512_or_si512(base, _mm512_cvtepu8_epi16(_mm512_castsi512_si256(bits)));
    _mm512_storeu_si512(l->cases + n, _mm512_maskz_compress_epi8(active, c->cases));
    _mm512_storeu_si512(l->cell + n, _mm512_mask_add_epi16(low, (__mmask32)flags, low, flag));
    if (after > n + 32) {
        const __m512i high =
            _mm512_or_si512(base, _mm512_cvtepu8_epi16(_mm512_extracti64x4_epi64(bits, 1)));
        _mm512_storeu_si512(l->cell + n + 32,
                            _mm512_mask_add_epi16(high, (__mmask32)(flags >> 32), high, flag));
    }
#else
    uint8_t cases[64];
    store_cases(c, active, cases);
    for (size_t at = n; active; active &= active - 1, at++) {
        const size_t i = (size_t)__builtin_ctzll(active);
        const bool ambiguous = !simple && cwi_case_is_ambiguous[cases[i]];
        l->cases[at] = cases[i];
        l->cell[at] = (uint16_t)(first + i + (ambiguous ? AMBIGUOUS : 0));
    }
#endif
    return after;
}

#if CWI_WIDE

/* The vertices on the edges of a cell, from their ranks: lane n is edge n. */
typedef __m512i cell_numbers;

static inline cell_numbers number_cell(const edge_half *e, unsigned i)
{
    /* edges 5, 7, 9 and 11 stand at i + 1 */
    const __m512i ones =
        _mm512_set_epi32(-1, -1, -1, -1, -2, -1, -2, -1, -2, -1, -2, -1, -1, -1, -1, -1);
    const __m512i not_before = _mm512_sllv_epi32(ones, _mm512_set1_epi32((int)i));
    const __m512i before =
        _mm512_andnot_si512(not_before, _mm512_load_si512((const void *)e->crossed));
    return _mm512_add_epi32(_mm512_load_si512((const void *)e->first),
                            _mm512_popcnt_epi32(before));
}

/* Writes the vertices at up to 16 edges; what is too much, before end, the next cells write
 * over. */
static inline uint32_t *put(const cell_numbers *c, const uint8_t *edge, unsigned count,
                            uint32_t *out, const uint32_t *end)
{
    const __m128i edges = _mm_loadu_si128((const __m128i *)(const void *)edge);
    const __m512i all = _mm512_permutexvar_epi32(_mm512_cvtepu8_epi32(edges), *c);
    if (end - out >= 16)
        _mm512_storeu_si512(out, all);
    else
        _mm512_mask_storeu_epi32(out, (__mmask16)((1u << count) - 1), all);
    return out + count;
}

#else

typedef struct cell_numbers {
    uint32_t vertex[12];
} cell_numbers;

static inline cell_numbers number_cell(const edge_half *e, unsigned i)
{
    cell_numbers c;
    cell_vertices(e, i, c.vertex);
    return c;
}

static inline uint32_t *put(const cell_numbers *c, const uint8_t *edge, unsigned count,
                            uint32_t *out, const uint32_t *end)
{
    (void)end;
    for (unsigned n = 0; n < count; n++)
        out[n] = c->vertex[edge[n]];
    return out + count;
}

#endif

/* What writing a row of cells goes on with. */
typedef struct cwi_cursor {
    uint32_t *out;
    const uint32_t *end;
    uint32_t inner; /* number of the next vertex inside a cell */
    size_t plan;    /* of the next ambiguous cell, in its layer */
} cwi_cursor;

/* The triangles of an ambiguous cell that has vertices inside, and these. */
static void emit_inner(const cwi_grid *g, const size_t at[3], const edge_half *e, unsigned cube,
                       bool flip, cwi_vertex_sink *sink, cwi_cursor *to)
{
    uint32_t vertex[12 + CWI_CELL_MAX_VERTICES];
    cwi_cell_plan plan;
    cwi_cell cell;
    cell_vertices(e, at[0] % HALF, vertex);
    cwi_ambiguous_build(g, at, cube, to->plan, sink, to->inner, &plan, &cell);
    for (int n = 0; n < plan.vertex_count; n++)
        vertex[CWI_CELL_INNER + n] = to->inner++;
    const uint8_t *corner = cell.triangles;
    for (int t = 0; t < plan.triangle_count; t++, corner += 3, to->out += 3) {
        to->out[0] = vertex[corner[0]];
        to->out[1] = vertex[corner[flip ? 2 : 1]];
        to->out[2] = vertex[corner[flip ? 1 : 2]];
    }
}

/* The triangles of an ambiguous cell. */
__attribute__((noinline)) static void emit_ambiguous(const cwi_grid *g, const size_t at[3],
                                                     const edge_half *e, unsigned cube,
                                                     const cwi_emission *emission,
                                                     cwi_vertex_sink *sink, cwi_cursor *to)
{
    const cwi_layer *layer = &g->layers[at[2]];
    const uint32_t plan = layer->plans_lost ? UINT32_MAX : layer->plans[to->plan];
    const unsigned edges = plan < CWI_CASE_CONFIGS ? emission->config_edges[plan] : 0;
    if (edges) {
        const cell_numbers c = number_cell(e, at[0] % HALF);
        const uint8_t *edge = emission->config_edge[plan];
        const unsigned now = edges < 16 ? edges : 16;
        to->out = put(&c, edge, now, to->out, to->end);
        to->out = put(&c, edge + now, edges - now, to->out, to->end);
    } else {
        emit_inner(g, at, e, cube, emission->flip, sink, to);
    }
    to->plan++;
}

/* Writes the triangles of listed cells: the one place where a cell's case becomes triangles. */
static void emit_cells(const cwi_grid *g, size_t j, size_t k, const cell_list *l, size_t count,
                       const cwi_emission *emission, cwi_vertex_sink *sink, cwi_cursor *to)
{
    const uint32_t *end = to->end;
    uint32_t *out = to->out;
    for (size_t n = 0; n < count; n++) {
        const unsigned cell = l->cell[n], cube = l->cases[n], place = cell % LIST;
        const edge_half *e = &l->edges[place / HALF];
        if (cell & AMBIGUOUS) {
            to->out = out;
            emit_ambiguous(g, (const size_t[3]){64 * l->word[place / 64] + place % 64, j, k}, e,
                           cube, emission, sink, to);
            out = to->out;
        } else {
            const cell_numbers c = number_cell(e, place % HALF);
            out = put(&c, emission->edge[cube], 3u * cwi_case_count[cube], out, end);
        }
    }
    to->out = out;
}

static void write_triangles(const cwi_grid *g, size_t j, size_t k, const cwi_row *rows,
                            const cwi_emission *emission, cwi_vertex_sink *sink,
                            cell_list *list, cwi_cursor *to)
{
    const cell_rows samples = rows_around(g, j, k);
    const uint64_t *busy = cwi_grid_busy(g, k * g->rows_y + j);
    for (int n = 0; n < 12; n++)
        list->edges[0].first[n] = rows[(k + edge_rows[n].k) * g->rows_y + j + edge_rows[n].j]
                                      .first[edge_rows[n].axis];
    for (size_t w = cwi_next_word(busy, 0, g->words); w < g->words;) {
        size_t words = 0, cells = 0;
        for (; w < g->words && words < WORDS; w = cwi_next_word(busy, w + 1, g->words)) {
            const cell_word c = load_cells(&samples, w);
            const uint64_t active = active_cells(g, c.mixed, j, k, w);
            edge_half *e = &list->edges[2 * words];
            load_edges(e, g, &c, j, k, w);
            number_edges(e + 1, e);
            number_edges(e + 2, e + 1);
            cells = list_cells(list, words, cells, &c, active, g->simple);
            list->word[words++] = w;
        }
        emit_cells(g, j, k, list, cells, emission, sink, to);
        memcpy(list->edges[0].first, list->edges[2 * words].first, sizeof list->edges[0].first);
    }
}

void cwi_write_layers(const cwi_grid *g, size_t begin, size_t end, size_t cells,
                      const cwi_row *rows, const cwi_emission *emission, cwi_vertex_sink *sink,
                      uint32_t *triangles)
{
    cell_list list;
    memset(&list.edges, 0, sizeof list.edges); /* lanes that are no edges */
    cwi_write_vertices(g, begin, end, rows, sink);
    for (size_t k = begin; k < cells; k++) {
        cwi_cursor to = {.plan = 0};
        for (size_t j = 0; j + 1 < g->rows_y; j++) {
            const cwi_row *row = rows + k * g->rows_y + j;
            if (row[0].triangle == row[1].triangle)
                continue;
            to.out = triangles + 3 * row[0].triangle;
            to.end = triangles + 3 * row[1].triangle;
            to.inner = row[0].first[3];
            write_triangles(g, j, k, rows, emission, sink, &list, &to);
        }
    }
}
