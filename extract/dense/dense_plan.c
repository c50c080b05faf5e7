/* Numbers the rows of a dense grid after counting, and writes its layers in parallel. */
#include "extract/dense/dense_plan.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/base/thread_pool.h"
#include "core/cases/case_tables.h"
#include "core/geometry/affine.h"
#include "core/volume/surface_frame.h"
#include "core/volume/volume.h"

#include <string.h>

static void count_layer(void *context, size_t k)
{
    cwi_plan *p = context;
    p->engine->count_layer(&p->grid, k, p->rows);
}

/* Turns first numbers within a layer into those within the mesh. */
static void number_layer(void *context, size_t k)
{
    cwi_plan *p = context;
    const size_t rows = p->grid.rows_y;
    for (cwi_row *row = p->rows + k * rows; row < p->rows + (k + 1) * rows; row++) {
        for (int kind = 0; kind < 4; kind++)
            row->first[kind] += (uint32_t)p->grid.layers[k].vertices;
        row->triangle += p->grid.layers[k].triangles;
    }
}

static cw_status number_rows(cwi_plan *p, int threads, cw_error *err)
{
    const cwi_bit_grid *g = &p->grid;
    size_t v = 0, t = 0;
    for (size_t k = 0; k < g->rows_z; k++) {
        cwi_layer *layer = &g->layers[k];
        const size_t vertices = layer->vertices, triangles = layer->triangles;
        layer->vertices = v; /* from now on: the number before the layer */
        layer->triangles = t;
        v += vertices;
        t += triangles;
    }
    p->rows[g->rows] = (cwi_row){.first = {(uint32_t)v}, .triangle = t};
    p->counts.vertices = v;
    p->counts.triangles = t;
    if (v > UINT32_MAX)
        return cwi_fail(err, CW_ERR_LIMIT, "the surface has %zu vertices; a mesh holds %u", v,
                        UINT32_MAX);
    return cwi_parallel_for(g->rows_z, g->rows_y * g->words * 64, threads, &(cw_progress){0},
                            "numbering", number_layer, p, err);
}

cw_status cwi_plan_count(cwi_plan *p, int threads, const cw_progress *progress, cw_error *err)
{
    const cwi_bit_grid *g = &p->grid;
    if (!p->rows)
        p->rows = cwi_alloc_large(g->rows + 1, sizeof *p->rows);
    if (!p->rows)
        return cwi_fail_memory(err);
    cw_status st = cwi_parallel_for(g->rows_z, g->rows_y * g->words * 64, threads, progress,
                                    "counting", count_layer, p, err);
    return st == CW_OK ? number_rows(p, threads, err) : st;
}

void cwi_plan_free(cwi_plan *p)
{
    cwi_grid_free(&p->grid);
    cwi_octree_free(&p->tree);
    cwi_free(p->rows);
    cw_mesh_free(&p->spare);
}

cwi_vertex_sink cwi_make_sink(const cw_volume *v, bool invert, cw_mesh *mesh)
{
    cwi_vertex_sink sink = {.positions = mesh->positions, .normals = mesh->normals, .grid = v};
    cwi_surface_frame frame;
    cwi_surface_frame_make(v, invert, &frame);
    sink.diagonal = frame.is_diagonal;
    memcpy(sink.cofactor, frame.cofactor, sizeof sink.cofactor);
    memcpy(sink.centre, frame.center, sizeof sink.centre);
    memcpy(sink.cap, frame.cap, sizeof sink.cap);
    for (int r = 0; r < 3; r++)
        memcpy(sink.affine[r], v->affine[r], sizeof sink.affine[r]);
    cwi_affine_apply(v->affine[0], sink.centre, mesh->origin);
    return sink;
}

/* Copies triangles. A mirroring affine turns them inside out: two corners change places. */
static void turn_triangles(const uint8_t *from, int count, bool flip, uint8_t *to)
{
    for (int n = 0; n < 3 * count; n++)
        to[n] = from[flip && n % 3 ? n - n % 3 + 3 - n % 3 : n];
}

cwi_emission cwi_make_emission(const cw_volume *v, bool simple)
{
    const bool flip = cwi_affine_determinant(v->affine[0]) < 0;
    cwi_emission emission = {.flip = flip};
    for (unsigned c = 0; c < 256; c++) {
        cwi_case_emission *of = &emission.of_case[c];
        turn_triangles(cwi_case_triangles[c], cwi_case_count[c], flip, of->edge);
        of->edges = simple || !cwi_case_is_ambiguous[c] ? 3 * cwi_case_count[c] : 0;
        for (int n = 0; n < CWI_EDGE_ROWS; n++)
            of->crossed[n] = cwi_edge_is_crossed(c, cwi_row_edge(n));
    }
    for (int n = 0; n < CWI_CASE_CONFIGS; n++) {
        const cwi_config *config = &cwi_configs[n];
        const int count = config->vertex_count ? 0 : config->triangle_count;
        turn_triangles(config->triangles, count, flip, emission.config_edge[n]);
        emission.config_edges[n] = (uint8_t)(3 * count);
    }
    return emission;
}

/* Number of layers that a thread writes at a time: many at first, as neighbouring shares both
 * read some samples; few at last, so that no thread waits for long. */
enum { LARGE_CHUNK = 32, SMALL_CHUNK = 8 };

static size_t begin_of_chunk(const cwi_writing *w, size_t chunk)
{
    const size_t large = chunk < w->large ? chunk : w->large;
    return w->begin + large * LARGE_CHUNK + (chunk - large) * SMALL_CHUNK;
}

static void write_chunk(void *context, size_t chunk)
{
    cwi_writing *w = context;
    const size_t begin = begin_of_chunk(w, chunk), end = begin_of_chunk(w, chunk + 1);
    const bool last = end >= w->end;
    const cwi_row_span span = {.begin = begin,
                               .end = last ? w->end + 1 : end,
                               .cells = last ? w->end : end,
                               .row_end = w->plan->grid.rows_y};
    w->plan->engine->write_span(&w->plan->grid, &span, w->plan->rows, &w->emission, &w->sink,
                                w->triangles);
}

cw_status cwi_write_dense_layers(cwi_writing *w, const cw_extract_desc *d, cw_error *err)
{
    const cwi_bit_grid *g = &w->plan->grid;
    const size_t layers = w->end - w->begin, threads = (size_t)cwi_threads(d->threads);
    /* two for each thread are left for small ones */
    const size_t large = layers / LARGE_CHUNK;
    w->large = large > 2 * threads ? large - 2 * threads : 0;
    const size_t rest = layers - w->large * LARGE_CHUNK;
    return cwi_parallel_for(w->large + (rest + SMALL_CHUNK - 1) / SMALL_CHUNK,
                            SMALL_CHUNK * g->rows_y * g->words * 64, d->threads, &d->progress,
                            "marching", write_chunk, w, err);
}
