/* Repairs the normals of a chunk, row by row. Around a row of vertices lie the cells of two rows
 * in two layers; their corners are in three rows of three layers. */
#include "extract/stream/chunk_normals.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "extract/common/field_normals.h"

/* The layers around a row's cells. */
enum { LAYERS = 3 };

/* The surface around a row of vertices. */
typedef struct surroundings {
    float *positions[LAYERS];
    size_t first[LAYERS], count[LAYERS]; /* vertices */
    uint32_t *triangles[LAYERS - 1];
    size_t triangle_count[LAYERS - 1];
} surroundings;

static void free_surroundings(surroundings *s)
{
    for (int n = 0; n < LAYERS; n++)
        cwi_free(s->positions[n]);
    for (int n = 0; n < LAYERS - 1; n++)
        cwi_free(s->triangles[n]);
}

/* Makes the vertices of three rows of a layer, from row `low` on, and the triangles of the first
 * two of them. n: the layer's number in s */
static cw_status make_layer(const cwi_chunk_writer *c, size_t layer, size_t low, size_t row,
                            int n, surroundings *s, cw_error *err)
{
    const cwi_slice_window *w = c->window;
    const bool has_cells = n < LAYERS - 1;
    /* the last row is padding, without vertices: the number after it may not be known */
    const size_t end = row + 2 < w->plan.grid.rows_y ? row + 2 : row + 1;
    const cwi_row *first = cwi_slice_window_layer(w, layer) + low,
                  *last = cwi_slice_window_layer(w, layer) + end;
    const size_t local = layer - w->first, triangles = last->triangle - first->triangle;
    s->first[n] = first->first[0];
    s->count[n] = last->first[0] - first->first[0];
    s->positions[n] = cwi_alloc_array(3 * s->count[n], sizeof **s->positions);
    uint32_t *corners = has_cells ? cwi_alloc_array(3 * triangles, sizeof *corners) : NULL;
    if (has_cells) {
        s->triangles[n] = corners;
        s->triangle_count[n] =
            cwi_slice_window_layer(w, layer)[row + 1].triangle - first->triangle;
    }
    if (!s->positions[n] || (has_cells && !corners))
        return cwi_fail_memory(err);
    cwi_vertex_sink sink = c->vertices;
    sink.positions = s->positions[n];
    sink.normals = NULL;
    sink.first = s->first[n];
    const cwi_row_span span = {.begin = local,
                               .end = local + 1,
                               .cells = has_cells ? local + 1 : local,
                               .row = low,
                               .row_end = end,
                               .plan =
                                   w->plan.grid.row_plans[local * w->plan.grid.rows_y + low],
                               .first_triangle = first->triangle};
    w->plan.engine->write_span(&w->plan.grid, &span, w->plan.rows, &c->emission, &sink,
                               corners);
    return CW_OK;
}

static const float *find_position(const surroundings *s, uint32_t vertex)
{
    int n = 0;
    while (vertex < s->first[n] || vertex - s->first[n] >= s->count[n])
        n++;
    return s->positions[n] + 3 * (vertex - s->first[n]);
}

/* Adds the normals of triangles to the missing ones of `count` vertices from `first` on. */
static void add_triangles(const surroundings *s, int n, double scale, const bool *missing,
                          size_t first, size_t count, float *normals)
{
    for (size_t t = 0; t < s->triangle_count[n]; t++) {
        const uint32_t *corner = s->triangles[n] + 3 * t;
        for (int v = 0; v < 3; v++) {
            const size_t at = corner[v] - first; /* huge for vertices before */
            if (at >= count || !missing[at])
                continue;
            const float *p[3];
            for (int e = 0; e < 3; e++)
                p[e] = find_position(s, corner[e]);
            cwi_add_facet_normal(p, scale, normals + 3 * at);
        }
    }
}

static bool is_missing(const float normal[3])
{
    return normal[0] == 0 && normal[1] == 0 && normal[2] == 0;
}

/* Repairs the normals of `count` vertices from number `first` on, which are those of a row. */
static cw_status mend_row(const cwi_chunk_writer *c, size_t layer, size_t row, size_t first,
                          size_t count, float *normals, cw_error *err)
{
    const double scale = cwi_voxel_scale(&c->window->whole);
    const size_t low = row ? row - 1 : 0;
    surroundings s = {.first = {0}};
    bool *missing = cwi_alloc_array(count, sizeof *missing);
    cw_status st = missing ? CW_OK : cwi_fail_memory(err);
    for (size_t v = 0; v < count && missing; v++)
        missing[v] = is_missing(normals + 3 * v);
    for (int n = layer ? 0 : 1; n < LAYERS && st == CW_OK; n++)
        st = make_layer(c, layer + (size_t)n - 1, low, row, n, &s, err);
    for (int n = 0; n < LAYERS - 1 && st == CW_OK; n++)
        add_triangles(&s, n, scale, missing, first, count, normals);
    for (size_t v = 0; v < count && st == CW_OK; v++)
        if (missing[v])
            cwi_finish_normal(normals + 3 * v);
    free_surroundings(&s);
    cwi_free(missing);
    return st;
}

static bool any_missing(const float *normals, size_t count)
{
    for (size_t v = 0; v < count; v++)
        if (is_missing(normals + 3 * v))
            return true;
    return false;
}

cw_status cwi_chunk_mend_normals(const cwi_chunk_writer *c, cw_mesh_chunk *chunk, size_t begin,
                                 size_t end, cw_error *err)
{
    const size_t rows = c->window->plan.grid.rows_y;
    const size_t last = chunk->first_vertex + chunk->mesh.vertex_count;
    cw_status st = CW_OK;
    for (size_t layer = begin; layer < end; layer++)
        for (size_t j = 0; j + 1 < rows && st == CW_OK; j++) {
            const cwi_row *row = cwi_slice_window_layer(c->window, layer) + j;
            const size_t first = row[0].first[0], count = row[1].first[0] - first;
            if (first < chunk->first_vertex || first >= last)
                continue;
            float *normals = chunk->mesh.normals + 3 * (first - chunk->first_vertex);
            if (any_missing(normals, count))
                st = mend_row(c, layer, j, first, count, normals, err);
        }
    return st;
}
