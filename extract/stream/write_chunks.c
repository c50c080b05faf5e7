/* Writes layers in chunks of about the same size: whole layers where few cells are crossed,
 * some rows of a layer where many are. Threads share the rows of a chunk. */
#include "extract/stream/write_chunks.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/volume/volume.h"
#include "extract/common/field_normals.h"
#include "extract/stream/chunk_normals.h"

#include <assert.h>
#include <string.h>

/* Bytes of a span, which one thread writes. Two spans that follow each other have more, except
 * around the end of a layer: so a chunk has no more than MAX_SPANS. */
enum { SPAN_BYTES = CWI_CHUNK_BYTES / 16, MAX_SPANS = 64 };

/* Vertices that one thread shades at a time. */
enum { SHADED_VERTICES = 4096 };

/* A row of the surface: of cells, edges and vertices. */
typedef struct place {
    size_t layer, row;
} place;

void cwi_chunks_init(cwi_chunk_writer *c, cwi_slice_window *window, cw_chunk_sink sink)
{
    const cw_volume *whole = &window->whole;
    *c = (cwi_chunk_writer){.window = window, .sink = sink};
    c->emission = cwi_make_emission(whole, window->desc.simple_topology);
    c->vertices = cwi_make_sink(whole, window->plan.grid.invert, &c->frame);
    memcpy(c->frame.affine, whole->affine, sizeof c->frame.affine);
    c->by_position = cwi_is_rectilinear(whole) && !window->desc.no_normals;
    if (c->by_position)
        cwi_shading_set_field(&c->shading, whole, window->plan.grid.invert);
}

void cwi_chunks_free(cwi_chunk_writer *c)
{
    cwi_free(c->positions);
    cwi_free(c->normals);
    cwi_free(c->corners);
    *c = (cwi_chunk_writer){0};
}

/* Returns a row in the window; one after the last row of a layer is the next layer's first. */
static const cwi_row *row_at(const cwi_chunk_writer *c, place at)
{
    return cwi_slice_window_layer(c->window, at.layer) + at.row;
}

static size_t bytes_between(const cwi_chunk_writer *c, place from, place to)
{
    const cwi_row *a = row_at(c, from), *b = row_at(c, to);
    const size_t vertex = (c->window->desc.no_normals ? 3 : 6) * sizeof(float);
    return (b->first[0] - a->first[0]) * vertex +
           (b->triangle - a->triangle) * 3 * sizeof(uint32_t);
}

/* Returns how far some bytes reach from a place on, but no farther than `last`: to the end of a
 * layer, or, in a layer with more bytes, to the end of a row. */
static place end_of_bytes(const cwi_chunk_writer *c, place from, place last, size_t bytes)
{
    const size_t rows = c->window->plan.grid.rows_y;
    const size_t end = from.layer < last.layer ? rows : last.row;
    place to = from;
    while (to.layer < last.layer && bytes_between(c, from, (place){to.layer + 1, 0}) <= bytes)
        to = (place){to.layer + 1, 0};
    if (to.layer > from.layer || to.row == end)
        return to;
    do
        to.row++;
    while (to.row < end && bytes_between(c, from, (place){to.layer, to.row + 1}) <= bytes);
    return to.row == rows ? (place){to.layer + 1, 0} : to;
}

/* --- a chunk -------------------------------------------------------------------------------- */

typedef struct chunk_work {
    cwi_chunk_writer *writer;
    cwi_vertex_sink sink; /* which each span copies */
    bool lacks_normals;
    cwi_row_span spans[MAX_SPANS];
    size_t count;
} chunk_work;

static void write_span(void *context, size_t n)
{
    chunk_work *work = context;
    const cwi_slice_window *w = work->writer->window;
    cwi_vertex_sink sink = work->sink;
    w->plan.engine->write_span(&w->plan.grid, &work->spans[n], w->plan.rows,
                               &work->writer->emission, &sink, work->writer->corners);
    if (sink.missing)
        cwi_set_flag(&work->lacks_normals);
}

static void shade_vertices(void *context, size_t n)
{
    const cwi_shading *s = context;
    const size_t begin = n * SHADED_VERTICES, end = begin + SHADED_VERTICES,
                 last = s->mesh->vertex_count;
    for (size_t v = begin; v < (end < last ? end : last); v++)
        cwi_shade_vertex(s, v);
}

/* Finds the normals of a chunk at its vertices. Those that the field does not give stay zero. */
static cw_status shade_chunk(cwi_chunk_writer *c, cw_mesh_chunk *chunk, cw_error *err)
{
    const size_t vertices = chunk->mesh.vertex_count;
    memset(c->normals, 0, 3 * vertices * sizeof *c->normals);
    c->shading.mesh = &chunk->mesh;
    c->shading.normals = c->normals;
    c->shading.first = c->window->first;
    return cwi_parallel_for((vertices + SHADED_VERTICES - 1) / SHADED_VERTICES, SHADED_VERTICES,
                            c->window->desc.threads, &(cw_progress){0}, "shading",
                            shade_vertices, &c->shading, err);
}

/* Returns the part of the surface between two places of one layer, or between two layers. */
static cwi_row_span make_span(const cwi_chunk_writer *c, place from, place to, size_t triangle)
{
    const cwi_bit_grid *g = &c->window->plan.grid;
    const size_t layer = from.layer - c->window->first;
    const size_t end = to.row ? layer + 1 : to.layer - c->window->first;
    return (cwi_row_span){.begin = layer,
                          .end = end,
                          .cells = end,
                          .row = from.row,
                          .row_end = to.row ? to.row : g->rows_y,
                          .plan = g->row_plans[layer * g->rows_y + from.row],
                          .first_triangle = triangle};
}

static cw_status ensure_capacity(cwi_chunk_writer *c, size_t vertices, size_t triangles,
                                 cw_error *err)
{
    const bool normals = !c->window->desc.no_normals;
    if (!c->positions || vertices > c->vertex_capacity) {
        c->positions = cwi_renew_large(c->positions, 3 * vertices, sizeof *c->positions);
        if (normals)
            c->normals = cwi_renew_large(c->normals, 3 * vertices, sizeof *c->normals);
        c->vertex_capacity = c->positions && (c->normals || !normals) ? vertices : 0;
    }
    if (!c->corners || triangles > c->triangle_capacity) {
        c->corners = cwi_renew_large(c->corners, 3 * triangles, sizeof *c->corners);
        c->triangle_capacity = c->corners ? triangles : 0;
    }
    return c->positions && c->corners && vertices <= c->vertex_capacity &&
                   triangles <= c->triangle_capacity
               ? CW_OK
               : cwi_fail_memory(err);
}

static cw_status write_chunk(cwi_chunk_writer *c, place from, place to, cw_error *err)
{
    const cwi_slice_window *w = c->window;
    const cwi_row *first = row_at(c, from), *after = row_at(c, to);
    const size_t vertices = after->first[0] - first->first[0],
                 triangles = after->triangle - first->triangle;
    cw_mesh_chunk chunk = {
        .mesh = c->frame, .first_vertex = first->first[0], .first_triangle = first->triangle};
    cw_status st = ensure_capacity(c, vertices, triangles, err);
    if (st != CW_OK)
        return st;
    chunk_work work = {.writer = c, .sink = c->vertices};
    work.sink.positions = chunk.mesh.positions = c->positions;
    chunk.mesh.normals = c->normals;
    work.sink.normals = c->by_position ? NULL : c->normals;
    work.sink.first = chunk.first_vertex;
    for (place at = from; at.layer != to.layer || at.row != to.row;) {
        /* a span has rows of one layer, or whole layers */
        const place limit = at.row && to.layer > at.layer ? (place){at.layer + 1, 0} : to;
        const place end = end_of_bytes(c, at, limit, SPAN_BYTES);
        assert(work.count < MAX_SPANS);
        work.spans[work.count++] = make_span(c, at, end, chunk.first_triangle);
        at = end;
    }
    const size_t samples = bytes_between(c, from, to);
    st = cwi_parallel_for(work.count, samples, w->desc.threads, &(cw_progress){0}, "marching",
                          write_span, &work, err);
    chunk.mesh.triangles = c->corners;
    chunk.mesh.vertex_count = vertices;
    chunk.mesh.triangle_count = triangles;
    if (st == CW_OK && c->by_position)
        st = shade_chunk(c, &chunk, err);
    if (st == CW_OK && (work.lacks_normals || c->by_position))
        st = cwi_chunk_mend_normals(c, &chunk, from.layer, to.row ? to.layer + 1 : to.layer,
                                    err);
    if (st != CW_OK)
        return st;
    for (size_t n = 0; w->first_vertex && n < 3 * triangles; n++)
        c->corners[n] -= (uint32_t)w->first_vertex;
    chunk.first_vertex -= w->first_vertex;
    chunk.first_triangle -= w->first_triangle;
    return c->sink.take(c->sink.user, &chunk, err);
}

cw_status cwi_chunks_write(cwi_chunk_writer *c, size_t begin, size_t end, cw_error *err)
{
    const cwi_slice_window *w = c->window;
    const place last = {end, 0};
    cw_status st = CW_OK;
    c->vertices.grid = &w->plan.grid.volume;
    const double centre = c->vertices.centre[2];
    if (!cwi_is_rectilinear(&w->whole))
        c->vertices.centre[2] = centre - (double)w->first;
    for (place at = {begin, 0}; at.layer < end && st == CW_OK;) {
        const place to = end_of_bytes(c, at, last, CWI_CHUNK_BYTES);
        if (bytes_between(c, at, to))
            st = write_chunk(c, at, to, err);
        at = to;
    }
    c->vertices.centre[2] = centre;
    return st;
}
