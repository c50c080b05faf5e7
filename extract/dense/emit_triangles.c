/* Writes the vertices and triangles of layers, from bit planes. Compiled for each engine. */
#include "extract/dense/active_cells.h"
#include "extract/dense/ambiguous_cells.h"

#include <string.h>

/* Number of triangle corners by which memory is prefetched before it is written. */
enum { AHEAD = 1024 };

/* State that writing a row of cells carries from cell to cell. */
typedef struct cwi_cursor {
    uint32_t *out;
    const uint32_t *end;
    uint32_t inner; /* number of the next vertex inside a cell */
    size_t plan;    /* of the next ambiguous cell, in its layer */
} cwi_cursor;

/* Writes the triangles of an ambiguous cell that has inner vertices, and these vertices. */
static void emit_inner(const cwi_bit_grid *g, const size_t at[3], const cell_numbers *numbers,
                       unsigned cube, bool flip, cwi_vertex_sink *sink, cwi_cursor *to)
{
    uint32_t vertex[12 + CWI_CELL_MAX_VERTICES];
    cwi_cell_plan plan;
    cwi_cell cell;
    cell_vertices(numbers, vertex);
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

/* Writes the triangles of an ambiguous cell. */
__attribute__((noinline)) static void emit_ambiguous(const cwi_bit_grid *g, const size_t at[3],
                                                     const cell_numbers *numbers, unsigned cube,
                                                     const cwi_emission *emission,
                                                     cwi_vertex_sink *sink, cwi_cursor *to)
{
    const cwi_layer *layer = &g->layers[at[2]];
    const uint32_t plan = layer->plans_lost ? UINT32_MAX : layer->plans[to->plan];
    const unsigned edges = plan < CWI_CASE_CONFIGS ? emission->config_edges[plan] : 0;
    if (edges) {
        const uint8_t *edge = emission->config_edge[plan];
        const unsigned now = edges < 16 ? edges : 16;
        to->out = put_triangles(numbers, edge, now, to->out, to->end);
        to->out = put_triangles(numbers, edge + now, edges - now, to->out, to->end);
    } else {
        emit_inner(g, at, numbers, cube, emission->flip, sink, to);
    }
    to->plan++;
}

/* Writes the triangles of listed cells: the one place where a cell's case becomes triangles.
 * Not inline: it needs all registers. */
__attribute__((noinline)) static void emit_cells(const cwi_bit_grid *g, size_t j, size_t k,
                                                 cell_list *l, size_t count,
                                                 const cwi_emission *emission,
                                                 cwi_vertex_sink *sink, cwi_cursor *to)
{
    const uint32_t *end = to->end;
    uint32_t *out = to->out;
    const bool count_on = counts_on(g, j, k);
    cell_numbers numbers = l->numbers;
    for (size_t n = 0; n < count; n++) {
        const size_t slot = l->cell[n];
        const unsigned cube = l->cases[slot];
        const cwi_case_emission *of = &emission->of_case[cube];
        __builtin_prefetch(out + AHEAD, 1);
        number_cell(l, count_on, slot, of->crossed, &numbers);
        if (of->edges) {
            out = put_triangles(&numbers, of->edge, of->edges, out, end);
        } else {
            const cell_numbers copy = numbers; /* so that they may stay in registers */
            to->out = out;
            emit_ambiguous(g, (const size_t[3]){64 * l->word[slot / 64] + slot % 64, j, k},
                           &copy, cube, emission, sink, to);
            out = to->out;
        }
    }
    l->numbers = numbers;
    to->out = out;
}

static void write_row(const cwi_bit_grid *g, size_t j, size_t k, const cwi_row *rows,
                      const cwi_emission *emission, cwi_vertex_sink *sink, cell_list *list,
                      cwi_cursor *to)
{
    const cell_rows samples = rows_around(g, j, k);
    const uint64_t *busy = cwi_grid_busy(g, k * g->rows_y + j);
    begin_row(list, g, rows, j, k);
    for (size_t w = cwi_next_marked_word(busy, 0, g->words); w < g->words;) {
        size_t words = 0, cells = 0;
        for (; w < g->words && words < WORDS; w = cwi_next_marked_word(busy, w + 1, g->words))
            cells = list_cells(list, words++, cells, g, &samples, j, k, w);
        emit_cells(g, j, k, list, cells, emission, sink, to);
        go_on(list, words);
    }
}

void cwi_write_span(const cwi_bit_grid *g, const cwi_row_span *span, const cwi_row *rows,
                    const cwi_emission *emission, cwi_vertex_sink *sink, uint32_t *triangles)
{
    /* the row after the span; without cells there are no triangles */
    const size_t after = span->row_end < g->rows_y && span->cells > span->begin
                             ? (span->cells - 1) * g->rows_y + span->row_end
                             : span->cells * g->rows_y;
    /* excess writes are overwritten by the next rows, but not those of other threads */
    cwi_cursor to = {0};
    if (span->cells > span->begin)
        to.end = triangles + 3 * (rows[after].triangle - span->first_triangle);
    cell_list list;
    memset(&list.edges, 0, sizeof list.edges); /* not known where numbers count on */
    cwi_place_vertices(g, span, rows, sink);
    for (size_t k = span->begin; k < span->cells; k++) {
        const cwi_row *layer = rows + k * g->rows_y;
        to.plan = k == span->begin ? span->plan : 0;
        if (layer[0].triangle == layer[g->rows_y].triangle)
            continue;
        for (size_t j = span->row; j < span->row_end && j + 1 < g->rows_y; j++) {
            const cwi_row *row = layer + j;
            if (row[0].triangle == row[1].triangle)
                continue;
            to.out = triangles + 3 * (row[0].triangle - span->first_triangle);
            to.inner = row[0].first[3];
            write_row(g, j, k, rows, emission, sink, &list, &to);
        }
    }
}
