/* Counting and writing a layer of cells, from bit planes. Compiled for each engine. */
#include "extract/ambiguous.h"
#include "extract/cases.h"
#include "extract/crossings.h"
#include "extract/engine.h"

#include <string.h>

#if CWI_WIDE
#include <immintrin.h>
#endif

static inline int popcount(uint64_t x)
{
    return __builtin_popcountll(x);
}

/* The four rows of samples around a row of cells, one word of them. */
typedef struct cell_word {
    uint64_t corner[8]; /* bit i: corner n of cell i is inside */
    uint64_t mixed;     /* cells whose corners are not all alike */
    uint64_t active;    /* of these, the live ones */
} cell_word;

static inline cell_word load_cells(const cwi_grid *g, size_t j, size_t k, size_t w)
{
    cell_word c;
    uint64_t any = 0, all = ~UINT64_C(0);
    for (size_t n = 0; n < 4; n++) {
        const uint64_t *row = cwi_grid_row(g, (k + (n >> 1)) * g->rows_y + j + (n & 1));
        c.corner[2 * n] = row[w];
        c.corner[2 * n + 1] = cwi_next_samples(row, w);
        any |= c.corner[2 * n] | c.corner[2 * n + 1];
        all &= c.corner[2 * n] & c.corner[2 * n + 1];
    }
    c.mixed = c.active = any & ~all;
    if (g->live)
        c.active &= cwi_live_cells(g, j, k, w);
    return c;
}

#if CWI_WIDE

/* From registers: a wide load of what was just stored word by word would wait for it. */
static inline __m512i corners(const cell_word *c)
{
    const uint64_t *n = c->corner;
    return _mm512_set_epi64((long long)n[7], (long long)n[6], (long long)n[5], (long long)n[4],
                            (long long)n[3], (long long)n[2], (long long)n[1], (long long)n[0]);
}

/* The cases of 64 cells: an 8 x 64 matrix of bits, turned. */
static inline __m512i turned(const cell_word *c)
{
    /* byte 8 b + 7 - n: bits of cells 8 b to 8 b + 7 for corner n */
    const __m512i gather = _mm512_set_epi64(
        0x070f171f272f373f, 0x060e161e262e363e, 0x050d151d252d353d, 0x040c141c242c343c,
        0x030b131b232b333b, 0x020a121a222a323a, 0x0109111921293139, 0x0008101820283038);
    const __m512i bytes = _mm512_permutexvar_epi8(gather, corners(c));
    return _mm512_gf2p8affine_epi64_epi8(_mm512_set1_epi64((long long)0x8040201008040201),
                                         bytes, 0);
}

static inline void cell_cases(const cell_word *c, uint8_t cases[64])
{
    _mm512_storeu_si512(cases, turned(c));
}

/* What a table of 256 bytes says of each of 64 cases. */
static inline __m512i look_up(const void *table, const uint8_t cases[64])
{
    const char *t = table;
    const __m512i c = _mm512_loadu_si512(cases);
    const __m512i low =
        _mm512_permutex2var_epi8(_mm512_loadu_si512(t), c, _mm512_loadu_si512(t + 64));
    const __m512i high =
        _mm512_permutex2var_epi8(_mm512_loadu_si512(t + 128), c, _mm512_loadu_si512(t + 192));
    return _mm512_mask_mov_epi8(low, _mm512_movepi8_mask(c), high);
}

static inline size_t count_triangles(const cell_word *c, const uint8_t cases[64])
{
    const __m512i counts = _mm512_maskz_mov_epi8(c->active, look_up(cwi_case_count, cases));
    return (size_t)_mm512_reduce_add_epi64(_mm512_sad_epu8(counts, _mm512_setzero_si512()));
}

/* Bit i: cell i is active, and its signs alone do not settle its surface. */
static inline uint64_t ambiguous_cells(const cell_word *c, const uint8_t cases[64])
{
    const __m512i ambiguous = look_up(cwi_case_is_ambiguous, cases);
    return c->active & _mm512_test_epi8_mask(ambiguous, ambiguous);
}

#else

/* Eight bytes as an 8 x 8 matrix of bits, transposed [Warren2013, 7-3]. */
static inline uint64_t transpose8(uint64_t x)
{
    uint64_t t = (x ^ x >> 7) & UINT64_C(0x00aa00aa00aa00aa);
    x ^= t ^ t << 7;
    t = (x ^ x >> 14) & UINT64_C(0x0000cccc0000cccc);
    x ^= t ^ t << 14;
    t = (x ^ x >> 28) & UINT64_C(0x00000000f0f0f0f0);
    return x ^ t ^ t << 28;
}

/* The cases of 64 cells; those of inactive ones may be left out. */
static inline void cell_cases(const cell_word *c, uint8_t cases[64])
{
    for (int b = 0; b < 64; b += 8) {
        uint64_t eight = 0;
        if (!(c->active >> b & 255))
            continue;
        for (int n = 0; n < 8; n++)
            eight |= (c->corner[n] >> b & 255) << 8 * n;
        eight = transpose8(eight);
        for (int n = 0; n < 8; n++)
            cases[b + n] = (uint8_t)(eight >> 8 * n);
    }
}

static inline size_t count_triangles(const cell_word *c, const uint8_t cases[64])
{
    size_t count = 0;
    for (uint64_t left = c->active; left; left &= left - 1)
        count += cwi_case_count[cases[__builtin_ctzll(left)]];
    return count;
}

/* Bit i: cell i is active, and its signs alone do not settle its surface. */
static inline uint64_t ambiguous_cells(const cell_word *c, const uint8_t cases[64])
{
    uint64_t ambiguous = 0;
    for (uint64_t left = c->active; left; left &= left - 1)
        if (cwi_case_is_ambiguous[cases[__builtin_ctzll(left)]])
            ambiguous |= left & -left;
    return ambiguous;
}

#endif

/* Counts what the field's topology makes of the ambiguous cells in word w of row (j, k), in
 * place of what the table counted for them. */
static void count_ambiguous(const cwi_grid *g, const cell_word *c, const uint8_t cases[64],
                            size_t j, size_t k, size_t w, size_t *triangles, unsigned *inner)
{
    for (uint64_t left = ambiguous_cells(c, cases); left; left &= left - 1) {
        const int i = __builtin_ctzll(left);
        const unsigned cube = cases[i];
        cwi_ambiguous cell;
        cwi_ambiguous_plan(g, (const size_t[3]){64 * w + (size_t)i, j, k}, cube, &cell);
        *triangles += (size_t)cell.plan.triangle_count;
        *triangles -= cwi_case_count[cube];
        *inner += (unsigned)cell.plan.vertex_count;
    }
}

/* Of up to 8 words of a row of cells from rows[0][w] on: bit n is set where word w + n has a
 * cell with corners on both sides. Such a word, or the bit after it, is not all alike in all
 * four rows of samples. */
static inline uint64_t busy_words(const uint64_t *const rows[4], size_t w)
{
#if CWI_WIDE
    __m512i any = _mm512_setzero_si512(), all = _mm512_set1_epi64(-1);
    __m512i any_next = any, all_next = all;
    for (int n = 0; n < 4; n++) {
        const __m512i here = _mm512_loadu_si512(rows[n] + w);
        const __m512i next = _mm512_loadu_si512(rows[n] + w + 1);
        any = _mm512_or_si512(any, here);
        all = _mm512_and_si512(all, here);
        any_next = _mm512_or_si512(any_next, next);
        all_next = _mm512_and_si512(all_next, next);
    }
    const __m512i alike = _mm512_srai_epi64(all, 63);
    const __m512i rest =
        _mm512_or_si512(_mm512_xor_si512(any, alike), _mm512_xor_si512(all, alike));
    const __m512i last =
        _mm512_or_si512(_mm512_xor_si512(any_next, alike), _mm512_xor_si512(all_next, alike));
    return _mm512_test_epi64_mask(rest, rest) |
           _mm512_test_epi64_mask(last, _mm512_set1_epi64(1));
#else
    uint64_t busy = 0;
    for (size_t i = w; i < w + 8; i++) {
        uint64_t any = 0, all = ~UINT64_C(0), any_next = 0, all_next = ~UINT64_C(0);
        for (int n = 0; n < 4; n++) {
            any |= rows[n][i];
            all &= rows[n][i];
            any_next |= rows[n][i + 1];
            all_next &= rows[n][i + 1];
        }
        const uint64_t alike = all >> 63 ? ~UINT64_C(0) : 0;
        const uint64_t mixed =
            (any ^ alike) | (all ^ alike) | (((any_next ^ alike) | (all_next ^ alike)) & 1);
        busy |= (uint64_t)(mixed != 0) << (i - w);
    }
    return busy;
#endif
}

/* Finds the busy words of a row of cells; false when there are none. */
static bool find_busy(const cwi_grid *g, size_t j, size_t k)
{
    const uint64_t *rows[4];
    uint64_t *busy = g->busy + (k * g->rows_y + j) * g->masks, any = 0;
    for (size_t n = 0; n < 4; n++)
        rows[n] = cwi_grid_row(g, (k + (n >> 1)) * g->rows_y + j + (n & 1));
    if (g->window) {
        const uint64_t window = g->window[k * g->rows_y + j];
        *busy = window && load_cells(g, j, k, 0).mixed & window;
        return *busy;
    }
    const uint64_t *wanted = g->everything ? NULL : cwi_grid_wanted(g, j, k);
    const bool *filled = g->filled + k * g->rows_y + j;
    memset(busy, 0, g->masks * sizeof *busy);
    if (!wanted && !filled[0] && !filled[1] && !filled[g->rows_y] && !filled[g->rows_y + 1])
        return false;
    for (size_t w = 0; w < g->words; w += 8) {
        uint64_t within = g->words - w < 8 ? (UINT64_C(1) << (g->words - w)) - 1 : 255;
        if (wanted)
            within &= wanted[w / 64] >> w % 64;
        const uint64_t found = within ? busy_words(rows, w) & within : 0;
        busy[w / 64] |= found << w % 64;
        any |= found;
    }
    return any != 0;
}

/* The cells of word w that are, in part, padding: in these the solid meets the border. */
static inline uint64_t border_cells(const cwi_grid *g, size_t w, bool side)
{
    const size_t n = g->volume.dim[0];
    if (side)
        return ~UINT64_C(0);
    return (uint64_t)(w == 0) | (uint64_t)(w == n / 64) << n % 64;
}

/* Leaves counts, not yet first numbers, in the row. An edge that is crossed belongs to a cell
 * whose corners differ, as the last samples of every row, and the last rows, are padding. */
static void count_row(const cwi_grid *g, size_t j, size_t k, cwi_row *row)
{
    unsigned count[4] = {0, 0, 0, 0};
    size_t triangles = 0;
    memset(row, 0, sizeof *row);
    if (!find_busy(g, j, k))
        return;
    const size_t *n = g->volume.dim;
    const bool side =
        j == 0 || k == 0 || j == n[1] || k == n[2]; /* a row of cells in the padding */
    uint64_t at_border = 0;
    const uint64_t *busy = cwi_grid_busy(g, k * g->rows_y + j);
    for (size_t w = cwi_next_word(busy, 0, g->words); w < g->words;
         w = cwi_next_word(busy, w + 1, g->words)) {
        const cell_word c = load_cells(g, j, k, w);
        if (side || w == 0 || w == n[0] / 64)
            at_border |= c.mixed & border_cells(g, w, side);
        if (g->window) {
            for (int axis = 0; axis < 3; axis++)
                count[axis] += (unsigned)popcount((c.corner[0] ^ c.corner[1 << axis]) &
                                                  *cwi_window(g, axis, j, k));
        } else if (g->live) {
            for (int axis = 0; axis < 3; axis++)
                count[axis] += (unsigned)popcount(cwi_edge_vertices(g, axis, j, k, w));
        } else {
            count[0] += (unsigned)popcount(c.corner[0] ^ c.corner[1]);
            count[1] += (unsigned)popcount(c.corner[0] ^ c.corner[2]);
            count[2] += (unsigned)popcount(c.corner[0] ^ c.corner[4]);
        }
        uint8_t cases[64];
        cell_cases(&c, cases);
        triangles += count_triangles(&c, cases);
        if (!g->simple)
            count_ambiguous(g, &c, cases, j, k, w, &triangles, &count[3]);
    }
    for (int kind = 0; kind < 4; kind++)
        row->first[kind] = count[kind];
    row->triangle = triangles;
    if (at_border)
        g->layers[k].at_border = true;
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

/* Something is wanted in the row of bricks that row (j, k) of cells lies in. */
static bool brick_is_wanted(const cwi_grid *g, size_t j, size_t k)
{
    if (g->everything)
        return true;
    const uint64_t *wanted = cwi_grid_wanted(g, j, k);
    return cwi_next_word(wanted, 0, g->words) < g->words;
}

void cwi_count_layer(const cwi_grid *g, size_t k, cwi_row *rows)
{
    cwi_layer *layer = &g->layers[k];
    const bool cells = k + 1 < g->rows_z;
    layer->plan_count = 0;
    layer->at_border = false;
    for (size_t j = 0; j + 1 < g->rows_y && cells;) {
        if (j % CWI_BRICK == 0 && !brick_is_wanted(g, j, k)) {
            const size_t row = k * g->rows_y + j,
                         end = j + CWI_BRICK < g->rows_y ? j + CWI_BRICK : g->rows_y - 1;
            memset(rows + row, 0, (end - j) * sizeof *rows);
            memset(g->busy + row * g->masks, 0, (end - j) * g->masks * sizeof *g->busy);
            j = end;
        } else {
            count_row(g, j, k, rows + k * g->rows_y + j);
            j++;
        }
    }
    const size_t left = cells ? 1 : g->rows_y, first = (k + 1) * g->rows_y - left;
    memset(rows + first, 0, left * sizeof *rows);
    memset(g->busy + first * g->masks, 0, left * g->masks * sizeof *g->busy);
    sum_layer(rows + k * g->rows_y, g->rows_y, layer);
}

/* The rows of edges around a word of cells, with what ranks need. Rows of y- and z-edges stand
 * twice, for the edges at i and at i + 1: lane n is edge n of the cube. */
typedef struct edge_word {
    uint64_t crossed[16];
    uint64_t first[16]; /* number of the first vertex in the word */
} edge_word;

/* The vertices on the 12 edges of cell i: where they would be numbered if crossed. */
static inline void cell_vertices(const edge_word *e, int i, uint32_t vertex[12])
{
    const uint64_t here = UINT64_C(1) << i, before = here - 1, with = here | before;
    for (int n = 0; n < 12; n++)
        vertex[n] = (uint32_t)e->first[n] +
                    (uint32_t)popcount(e->crossed[n] & (n >= 4 && n & 1 ? with : before));
}

/* The rows of edges a cube's 12 edges lie in: axis, and which of the four rows of samples. */
static const struct {
    uint8_t axis, j, k;
} edge_rows[12] = {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 1, 1}, {1, 0, 0}, {1, 0, 0},
                   {1, 0, 1}, {1, 0, 1}, {2, 0, 0}, {2, 0, 0}, {2, 1, 0}, {2, 1, 0}};

/* Crossings of the edges around word w of the cells in row (j, k). */
static inline void load_edges(edge_word *e, const cwi_grid *g, const cell_word *c, size_t j,
                              size_t k, size_t w)
{
    if (g->live && !g->window) {
        for (int n = 0; n < 12; n++)
            e->crossed[n] = cwi_edge_vertices(g, edge_rows[n].axis, j + edge_rows[n].j,
                                              k + edge_rows[n].k, w);
        return;
    }
    for (int n = 0; n < 4; n++)
        e->crossed[n] = c->corner[2 * n] ^ c->corner[2 * n + 1];
    e->crossed[4] = e->crossed[5] = c->corner[0] ^ c->corner[2];
    e->crossed[6] = e->crossed[7] = c->corner[4] ^ c->corner[6];
    e->crossed[8] = e->crossed[9] = c->corner[0] ^ c->corner[4];
    e->crossed[10] = e->crossed[11] = c->corner[2] ^ c->corner[6];
    for (int n = 0; n < 12 && g->window; n++)
        e->crossed[n] &=
            *cwi_window(g, edge_rows[n].axis, j + edge_rows[n].j, k + edge_rows[n].k);
}

/* Goes on to the next word. */
static inline void skip_word(edge_word *e)
{
    for (int n = 0; n < 12; n++)
        e->first[n] += (uint64_t)popcount(e->crossed[n]);
}

#if CWI_WIDE

/* The triangles of a cell: the ranks of its 12 vertices at once, then one shuffle by the case.
 */
static inline uint32_t *emit(const edge_word *e, int i, unsigned cube,
                             const cwi_emission *emission, uint32_t *out, const uint32_t *end)
{
    const uint64_t before = (UINT64_C(1) << i) - 1, with = before << 1 | 1;
    const __m512i b = _mm512_set1_epi64((long long)before),
                  c = _mm512_set1_epi64((long long)with);
    __m512i ranks[2];
    for (int n = 0; n < 2; n++) { /* edges 5, 7, 9 and 11 stand at i + 1 */
        const __m512i below = _mm512_mask_mov_epi64(b, n ? 0x0a : 0xa0, c);
        const __m512i crossed = _mm512_loadu_si512(e->crossed + 8 * n);
        ranks[n] = _mm512_add_epi64(_mm512_loadu_si512(e->first + 8 * n),
                                    _mm512_popcnt_epi64(_mm512_and_si512(crossed, below)));
    }
    const __m128i edges = _mm_loadu_si128((const __m128i *)(const void *)emission->edge[cube]);
    const __m512i lanes = _mm512_slli_epi32(_mm512_cvtepu8_epi32(edges), 1);
    const __m512i all = _mm512_permutex2var_epi32(ranks[0], lanes, ranks[1]);
    const unsigned count = 3u * cwi_case_count[cube];
    if (end - out >= 16) /* what is too much, the next cells write over */
        _mm512_storeu_si512(out, all);
    else
        _mm512_mask_storeu_epi32(out, (__mmask16)((1u << count) - 1), all);
    return out + count;
}

#else

static inline uint32_t *emit(const edge_word *e, int i, unsigned cube,
                             const cwi_emission *emission, uint32_t *out, const uint32_t *end)
{
    uint32_t vertex[12];
    const uint8_t *edge = emission->edge[cube];
    const int count = 3 * cwi_case_count[cube];
    cell_vertices(e, i, vertex);
    (void)end;
    for (int n = 0; n < count; n++)
        out[n] = vertex[edge[n]];
    return out + count;
}

#endif

/* What writing a row of cells goes on with. */
typedef struct cwi_cursor {
    uint32_t *out;
    uint32_t inner; /* number of the next vertex inside a cell */
    size_t plan;    /* of the next ambiguous cell, in its layer */
} cwi_cursor;

/* The triangles of an ambiguous cell, and its inner vertices. */
static void emit_ambiguous(const cwi_grid *g, const size_t at[3], const edge_word *e,
                           unsigned cube, bool flip, cwi_vertex_sink *sink, cwi_cursor *to)
{
    uint32_t vertex[12 + CWI_CELL_MAX_VERTICES];
    cwi_cell_plan plan;
    cwi_cell cell;
    cell_vertices(e, (int)(at[0] % 64), vertex);
    cwi_ambiguous_build(g, at, cube, to->plan++, sink, to->inner, &plan, &cell);
    for (int n = 0; n < plan.vertex_count; n++)
        vertex[CWI_CELL_INNER + n] = to->inner++;
    const uint8_t *corner = cell.triangles;
    for (int t = 0; t < plan.triangle_count; t++, corner += 3, to->out += 3) {
        to->out[0] = vertex[corner[0]];
        to->out[1] = vertex[corner[flip ? 2 : 1]];
        to->out[2] = vertex[corner[flip ? 1 : 2]];
    }
}

/* Writes the triangles of a row of cells: the one place where a cell's case becomes triangles.
 */
static void write_triangles(const cwi_grid *g, size_t j, size_t k, const cwi_row *rows,
                            const cwi_emission *emission, cwi_vertex_sink *sink, cwi_cursor *to,
                            const uint32_t *end)
{
    edge_word e;
    memset(&e, 0, sizeof e);
    for (int n = 0; n < 12; n++)
        e.first[n] = rows[(k + edge_rows[n].k) * g->rows_y + j + edge_rows[n].j]
                         .first[edge_rows[n].axis];
    const uint64_t *busy = cwi_grid_busy(g, k * g->rows_y + j);
    for (size_t w = cwi_next_word(busy, 0, g->words); w < g->words;
         w = cwi_next_word(busy, w + 1, g->words)) {
        const cell_word c = load_cells(g, j, k, w);
        uint8_t cases[64];
        load_edges(&e, g, &c, j, k, w);
        cell_cases(&c, cases);
        const uint64_t ambiguous = g->simple ? 0 : ambiguous_cells(&c, cases);
        for (uint64_t left = c.active; left; left &= left - 1) {
            const int i = __builtin_ctzll(left);
            if (ambiguous >> i & 1) {
                const size_t at[3] = {64 * w + (size_t)i, j, k};
                emit_ambiguous(g, at, &e, cases[i], emission->flip, sink, to);
            } else {
                to->out = emit(&e, i, cases[i], emission, to->out, end);
            }
        }
        skip_word(&e);
    }
}

void cwi_write_layers(const cwi_grid *g, size_t begin, size_t end, size_t cells,
                      const cwi_row *rows, const cwi_emission *emission, cwi_vertex_sink *sink,
                      uint32_t *triangles)
{
    cwi_write_vertices(g, begin, end, rows, sink);
    for (size_t k = begin; k < cells; k++) {
        cwi_cursor to = {.plan = 0};
        for (size_t j = 0; j + 1 < g->rows_y; j++) {
            const cwi_row *row = rows + k * g->rows_y + j;
            if (row[0].triangle == row[1].triangle)
                continue;
            to.out = triangles + 3 * row[0].triangle;
            to.inner = row[0].first[3];
            write_triangles(g, j, k, rows, emission, sink, &to,
                            triangles + 3 * row[1].triangle);
        }
    }
}
