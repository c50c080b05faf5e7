/* Extracts slabs of a surface from slices, in two passes: the first counts, the second writes. */
#include "extract/stream/extract_stream.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/mesh/mesh.h"
#include "core/volume/volume.h"
#include "extract/common/extract_limits.h"
#include "extract/dense/slab_cuts.h"

#include <string.h>

/* The window of slices has at most one third of the memory: the largest slab, which needs the
 * rest, is known after the first pass. */
enum { WINDOW_PART = 3 };

/* The work of the second pass. */
typedef struct slab_writer {
    cwi_slice_window *window;
    size_t layers;      /* that the window is moved by, at most */
    cwi_layer *counted; /* of the first pass: what is before each layer */
    cwi_layer_sums sums;
    cwi_border_loops loops;
    cwi_emission emission;
    cwi_vertex_sink sink; /* of the vertices of the slab at hand */
    cw_mesh mesh;
    uint8_t *seam;
    size_t begin, end;          /* layers of the slab at hand */
    size_t vertices, triangles; /* before it */
    size_t from;                /* the layer of write_layer()'s number 0 */
} slab_writer;

static void free_writer(slab_writer *s)
{
    cw_mesh_free(&s->mesh);
    cwi_free(s->seam);
    cwi_free(s->counted);
    cwi_border_loops_free(&s->loops);
}

/* --- the first pass -------------------------------------------------------------------------- */

static void add_layer(slab_writer *s, size_t layer)
{
    const cwi_slice_window *w = s->window;
    const cwi_layer *counts = &w->plan.grid.layers[layer - w->first];
    s->counted[layer] =
        (cwi_layer){.vertices = s->sums.vertices, .triangles = s->sums.triangles};
    s->sums.vertices += counts->vertices;
    s->sums.triangles += counts->triangles;
}

/* Counts the vertices and triangles of each layer, and the loops of the border. */
static cw_status count_surface(slab_writer *s, cw_error *err)
{
    cwi_slice_window *w = s->window;
    const size_t last = w->whole.dim[2] + 1;
    cw_status st = CW_OK;
    s->counted = cwi_alloc_zeroed(last + 1, sizeof *s->counted);
    if (!s->counted)
        return cwi_fail_memory(err);
    s->sums = (cwi_layer_sums){.layers = s->counted, .count = last + 1};
    st = cwi_border_loops_init(&s->loops, w->whole.dim, err);
    cwi_slice_window_start(w, 0);
    for (size_t begin = 0, end; begin < last && st == CW_OK; begin = end) {
        end = begin + s->layers < last ? begin + s->layers : last;
        st = cwi_progress(&w->desc.progress, "counting", (double)begin / (double)last, err);
        if (st == CW_OK)
            st = cwi_slice_window_move(w, begin, end, err);
        if (st == CW_OK)
            cwi_slice_window_add_border(w, &s->loops);
        for (size_t layer = begin; layer < end && st == CW_OK; layer++)
            add_layer(s, layer);
    }
    if (st == CW_OK)
        add_layer(s, last);
    if (st == CW_OK && !(w->in && w->out)) /* all of it is one side: no surface */
        s->sums.vertices = s->sums.triangles = 0;
    return st;
}

/* --- the second pass ------------------------------------------------------------------------- */

/* Writes the n-th layer of the window: its vertices and, below the slab's end, its triangles. */
static void write_layer(void *context, size_t n)
{
    const slab_writer *s = context;
    const cwi_slice_window *w = s->window;
    const size_t layer = s->from + n, local = layer - w->first, rows = w->plan.grid.rows_y;
    const bool has_cells = layer < s->end;
    cwi_vertex_sink sink = s->sink;
    /* numbers after the last row, which is padding, are not known without cells */
    const cwi_row_span span = {.begin = local,
                               .end = local + 1,
                               .cells = has_cells ? local + 1 : local,
                               .row_end = has_cells ? rows : rows - 1,
                               .first_triangle = s->triangles};
    w->plan.engine->write_span(&w->plan.grid, &span, w->plan.rows, &s->emission, &sink,
                               s->mesh.triangles);
}

/* Writes layers begin to end - 1 of the slab, and the layer of samples that ends it. */
static cw_status write_layers(slab_writer *s, size_t begin, size_t end, cw_error *err)
{
    cwi_slice_window *w = s->window;
    const size_t rows = w->plan.grid.rows_y, last = w->whole.dim[2] + 1;
    const bool has_seam = end == s->end && end < last;
    const double centre = s->sink.centre[2];
    cw_status st =
        cwi_progress(&w->desc.progress, "extracting", (double)begin / (double)last, err);
    if (st == CW_OK)
        st = cwi_slice_window_move(w, begin, end, err);
    if (st != CW_OK)
        return st;
    s->from = begin;
    if (!cwi_is_rectilinear(&w->whole))
        s->sink.centre[2] = centre - (double)w->first;
    st = cwi_parallel_for(end - begin + has_seam, rows * w->plan.grid.words * 64,
                          w->desc.threads, &(cw_progress){0}, "marching", write_layer, s, err);
    s->sink.centre[2] = centre;
    if (begin == s->begin && begin)
        cwi_mark_seam(cwi_slice_window_layer(w, begin), rows, s->vertices, 1, s->seam);
    if (has_seam) {
        const cwi_row *row = cwi_slice_window_layer(w, end);
        cwi_mark_seam(row, rows, s->vertices, 2, s->seam);
        cwi_clear_beyond_seam(row, rows, s->vertices, s->mesh.positions);
    }
    return st;
}

/* Writes the slab of layers begin to end - 1, and gives it to the sink. */
static cw_status write_slab(slab_writer *s, cw_slab_sink sink, cw_error *err)
{
    const cwi_layer_sums *sums = &s->sums;
    cw_mesh *mesh = &s->mesh;
    cw_slab slab = {.mesh = mesh,
                    .seam = s->seam,
                    .triangles = sums->triangles,
                    .last = s->end + 1 == sums->count};
    cw_status st = CW_OK;
    s->vertices = s->sink.first = cwi_vertices_before(sums, s->begin);
    s->triangles = sums->layers[s->begin].triangles;
    mesh->vertex_count = cwi_vertices_before(sums, s->end + 1) - s->vertices;
    mesh->triangle_count = sums->layers[s->end].triangles - s->triangles;
    memset(s->seam, 0, mesh->vertex_count);
    for (size_t begin = s->begin, end; begin < s->end && st == CW_OK; begin = end) {
        end = begin + s->layers < s->end ? begin + s->layers : s->end;
        st = write_layers(s, begin, end, err);
    }
    for (size_t c = 0; c < 3 * mesh->triangle_count && st == CW_OK; c++)
        mesh->triangles[c] -= (uint32_t)s->vertices;
    cwi_set_slab_planes(&s->window->whole, s->sink.centre, s->begin, s->end, &slab);
    return st == CW_OK ? sink.take(sink.user, &slab, err) : st;
}

/* Allocates the largest slab, if it is within the limits. */
static cw_status ensure_capacity(slab_writer *s, const cw_extract_desc *d, size_t triangles,
                                 cw_extract_counts *counts, cw_error *err)
{
    const cw_volume *whole = &s->window->whole;
    const cw_extract_counts max = cwi_largest_slab(&s->sums, triangles);
    cw_mesh mesh;
    counts->bytes = cwi_extract_mesh_bytes(&max, false) + max.vertices +
                    cwi_slice_window_bytes(whole, d, s->window->sweeps, s->layers) +
                    cwi_border_loops_bytes(whole->dim) + s->sums.count * sizeof *s->counted;
    cw_status st = cwi_extract_check_limits(d, counts, err);
    if (st == CW_OK)
        st = cwi_mesh_alloc(&mesh, max.vertices, max.triangles, false, err);
    if (st != CW_OK)
        return st;
    memcpy(mesh.affine, whole->affine, sizeof mesh.affine);
    s->sink = cwi_make_sink(whole, s->window->plan.grid.invert, &mesh);
    s->sink.grid = &s->window->plan.grid.volume;
    s->mesh = mesh;
    s->seam = cwi_alloc_array(max.vertices, 1);
    return s->seam ? CW_OK : cwi_fail_memory(err);
}

static cw_status write_slabs(slab_writer *s, const cw_extract_desc *d, size_t triangles,
                             cw_slab_sink sink, cw_extract_counts *counts, cw_error *err)
{
    cw_status st = ensure_capacity(s, d, triangles, counts, err);
    if (st != CW_OK)
        return st;
    s->emission = cwi_make_emission(&s->window->whole, d->simple_topology);
    cwi_slice_window_start(s->window, 0);
    for (; s->begin + 1 < s->sums.count && st == CW_OK; s->begin = s->end) {
        s->end = cwi_end_of_slab(&s->sums, s->begin, triangles);
        st = write_slab(s, sink, err);
    }
    return st;
}

/* --- the public call ------------------------------------------------------------------------- */

/* Leaves the window a part of the memory, or what a single layer needs. */
static size_t limit_window(const cw_slice_source *source, const cw_stream_desc *d)
{
    const size_t limit = d->extract.max_bytes, part = limit / WINDOW_PART,
                 min = cw_extract_stream_bytes(&source->shape, d, true);
    return part > min ? part : min < limit ? min : limit;
}

cw_status cw_extract_stream_slabs(const cw_slice_source *source, const cw_stream_desc *desc,
                                  size_t triangles, cw_slab_sink sink,
                                  cw_extract_counts *counts, cw_error *err)
{
    CWI_REQUIRE(err, source);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cw_stream_desc d = desc ? *desc : (cw_stream_desc){0};
    cwi_slice_window window = {0};
    slab_writer s = {.window = &window};
    cw_extract_counts made = {0};
    d.extract.no_normals = true;
    cw_stream_desc slices = d;
    slices.extract.max_bytes = limit_window(source, &d);
    cw_status st = cwi_open_slices(&window, cwi_engine_best(), source, &slices, &s.layers, err);
    if (st == CW_OK)
        st = count_surface(&s, err);
    made.vertices = s.sums.vertices;
    made.triangles = s.sums.triangles;
    if (st == CW_OK && window.in && window.out)
        made.border_loops = cwi_border_loops_count(&s.loops);
    if (st == CW_OK && made.triangles)
        st = write_slabs(&s, &d.extract, triangles, sink, &made, err);
    if (st == CW_OK && counts)
        *counts = made;
    free_writer(&s);
    cwi_slice_window_free(&window);
    return st;
}
