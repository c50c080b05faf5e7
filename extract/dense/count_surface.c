/* Counts the vertices and triangles of a layer of cells, from bit planes. Compiled for each
 * engine. */
#include "extract/dense/ambiguous_cells.h"
#include "extract/dense/cell_bits.h"
#include "extract/dense/cell_word.h"

#include <string.h>

/* Counts of some words of a layer; after a row's last word comes the next row's first. */
typedef struct word_counts {
    unsigned mixed_words, open; /* bit n: word n has mixed cells; has ambiguous cells */
    cwi_words mixed, ambiguous; /* cells whose corners are on both sides; of these, those whose
                                   signs do not settle the rest */
    cwi_words counts;           /* fields of COUNT_BITS: edges that are crossed along each axis,
                                   and triangles of cells that are not ambiguous */
} word_counts;

/* 64 cells have 320 triangles at most, and up to eight words are summed. */
enum { COUNT_BITS = 16 };

/* Finds the mixed and ambiguous cells of some words, and counts. */
static inline void count_cells(const cwi_bit_grid *g, size_t k, size_t word,
                               const cwi_words corner[8], word_counts *c)
{
    cwi_words crossed[12], cells = c->mixed, count = {0};
    cwi_cross_edges(corner, crossed);
    cwi_find_ambiguous(crossed, &c->ambiguous);
    if (g->live) {
        cwi_load_words(cwi_live_layer(g, k) + word, &cells);
        cells &= c->mixed;
        crossed[0] &= cells; /* of whole rows: see cwi_is_whole() */
    }
    c->ambiguous &= cells;
    cells &= ~c->ambiguous;
    cwi_add_triangles(crossed, &cells, &count);
    for (int axis = 2; axis >= 0; axis--) {
        count <<= COUNT_BITS;
        cwi_add_set(&crossed[4 * axis], 1, &count);
    }
    c->counts = count;
}

/* Counts the wanted ones of successive words of layer k, from `word` on: word n, bit n. */
static inline void count_words(const cwi_bit_grid *g, size_t k, size_t word, unsigned active,
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
    cwi_keep_words(active, &c->mixed);
    c->mixed_words = cwi_words_set(&c->mixed);
    if (c->mixed_words) {
        count_cells(g, k, word, corner, c);
        c->open = cwi_words_set(&c->ambiguous);
    }
}

/* Counts the vertices and triangles of the ambiguous cells in word w of row (j, k). */
static void count_ambiguous(const cwi_bit_grid *g, uint64_t ambiguous, size_t j, size_t k,
                            size_t w, cwi_row *row)
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

/* Returns the bits of the first `count` of CWI_WORDS words. */
static inline unsigned first_words(size_t count)
{
    return count < CWI_WORDS ? (1u << count) - 1 : (1u << CWI_WORDS) - 1;
}

/* Returns true if mixed cells of `count` words are partly padding: there the solid meets the
 * border. The words start at word w of row (j, k), the n-th that was counted. */
static bool meets_border(const cwi_bit_grid *g, const word_counts *c, int n, int count,
                         size_t j, size_t k, size_t w)
{
    const size_t *dim = g->volume.dim, last = dim[0] / 64;
    if (j == 0 || k == 0 || j == dim[1] || k == dim[2])
        return true;
    return (w == 0 && (c->mixed[n] & 1)) ||
           (last - w < (size_t)count && (c->mixed[n + (int)(last - w)] >> dim[0] % 64 & 1));
}

/* Counts vertices on edges of live cells, along each axis, in the busy words from word w of row
 * (j, k) on, packed like `counts`. */
static uint64_t count_live_edges(const cwi_bit_grid *g, unsigned busy, size_t j, size_t k,
                                 size_t w)
{
    uint64_t count = 0;
    for (; busy; busy &= busy - 1)
        for (int axis = 0; axis < 3; axis++)
            count += (uint64_t)__builtin_popcountll(
                         cwi_edge_vertices(g, axis, j, k, w + (size_t)__builtin_ctz(busy)))
                     << COUNT_BITS * axis;
    return count;
}

/* Adds the counts of `count` words to those of their row. The words start at word w of row (j,
 * k), the n-th that was counted. An edge that is crossed belongs to a cell whose corners
 * differ, as the last samples of every row, and the last rows, are padding. */
static inline void take_words(const cwi_bit_grid *g, const word_counts *c, int n, int count,
                              size_t j, size_t k, size_t w, cwi_row *row)
{
    const unsigned here = first_words((size_t)count) << n, busy = (c->mixed_words & here) >> n;
    const uint64_t field = (UINT64_C(1) << COUNT_BITS) - 1;
    if (!busy)
        return;
    g->mixed_words[(k * g->rows_y + j) * g->masks + w / 64] |= (uint64_t)busy << w % 64;
    uint64_t sums = cwi_sum_words(c->mixed_words & here, &c->counts);
    row->triangle += sums >> 3 * COUNT_BITS;
    if (g->live && !cwi_is_whole(g, j, k))
        sums = count_live_edges(g, busy, j, k, w);
    for (int axis = 0; axis < 3; axis++)
        row->first[axis] += (uint32_t)(sums >> COUNT_BITS * axis & field);
    for (unsigned left = c->open & here; left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        count_ambiguous(g, c->ambiguous[i], j, k, w + (size_t)(i - n), row);
    }
    if (g->row_plans && c->open & here)
        g->row_plans[k * g->rows_y + j] = (uint32_t)g->layers[k].plan_count;
    if (!g->layers[k].at_border)
        g->layers[k].at_border = meets_border(g, c, n, count, j, k, w);
}

/* Counts the wanted ones of CWI_WORDS words of layer k, from word w of row j on. Leaves counts,
 * not yet first numbers, in the layer's rows. */
static void count_group(const cwi_bit_grid *g, size_t j, size_t k, size_t w, unsigned active,
                        cwi_row *rows)
{
    word_counts c;
    count_words(g, k, j * g->words + w, active, &c);
    for (int n = 0, count; n < CWI_WORDS && c.mixed_words >> n; n += count) {
        /* those in the same row and word of its mask */
        const size_t end = (w | 63) + 1 < g->words ? (w | 63) + 1 : g->words;
        count = end - w < (size_t)(CWI_WORDS - n) ? (int)(end - w) : CWI_WORDS - n;
        take_words(g, &c, n, count, j, k, w, rows + j);
        w = end < g->words ? end : 0;
        j += w == 0;
    }
}

/* Returns true if some sample in the rows of samples around these rows of cells of layer k is
 * inside, or if that is unknown. */
static bool any_filled(const cwi_bit_grid *g, size_t j, size_t last, size_t k)
{
    const uint8_t *filled = g->filled + k * g->rows_y;
    bool any = g->window != NULL;
    for (; j <= last + 1 && !any; j++)
        any = (filled[j] | filled[g->rows_y + j]) & CWI_ANY_INSIDE;
    return any;
}

static void count_all(const cwi_bit_grid *g, size_t k, cwi_row *rows)
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

static void count_active(const cwi_bit_grid *g, size_t k, cwi_row *rows)
{
    for (size_t j = 0; j + 1 < g->rows_y; j++) {
        const uint64_t *active = cwi_grid_active(g, j, k);
        for (size_t w = cwi_next_marked_word(active, 0, g->words); w < g->words;) {
            const size_t end = (w | 63) + 1, here = end - w < CWI_WORDS ? end - w : CWI_WORDS;
            count_group(g, j, k, w, active[w / 64] >> w % 64 & first_words(here), rows);
            w = cwi_next_marked_word(active, w + here, g->words);
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

/* Returns true if no cell of the layer can be crossed. */
static bool is_unwanted(const cwi_bit_grid *g, size_t k)
{
    if (g->all_classified || k + 1 == g->rows_z)
        return k + 1 == g->rows_z;
    const uint64_t *active = cwi_grid_active(g, 0, k);
    uint64_t any = 0;
    for (size_t n = 0; n < g->bricks_y * g->masks; n++)
        any |= active[n];
    return !any;
}

void cwi_count_layer(const cwi_bit_grid *g, size_t k, cwi_row *rows)
{
    cwi_layer *layer = &g->layers[k];
    const size_t first = k * g->rows_y;
    layer->vertices = layer->triangles = layer->plan_count = 0;
    layer->at_border = layer->plans_lost = false;
    memset(rows + first, 0, g->rows_y * sizeof *rows);
    memset(g->mixed_words + first * g->masks, 0, g->rows_y * g->masks * sizeof *g->mixed_words);
    if (is_unwanted(g, k))
        return;
    if (g->all_classified)
        count_all(g, k, rows + first);
    else
        count_active(g, k, rows + first);
    sum_layer(rows + first, g->rows_y, layer);
}
