/* Extracts a surface from slices: the public calls. */
#include "extract/stream/extract_stream.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/volume/volume.h"
#include "extract/common/extract_limits.h"
#include "extract/stream/write_chunks.h"

#include <string.h>

/* Limits of the layers that are extracted together, and the memory that their number is chosen
 * for: BASE_BYTES, and SAMPLE_BYTES for each sample of a slice. */
enum { MIN_LAYERS = 4, MAX_LAYERS = 64, BASE_BYTES = 8 << 20, SAMPLE_BYTES = 24 };

static size_t bytes_with(const cw_volume *whole, const cw_extract_desc *d, size_t sweeps,
                         size_t layers)
{
    return cwi_slice_window_bytes(whole, d, sweeps, layers) +
           cwi_border_loops_bytes(whole->dim) + CWI_CHUNK_BYTES;
}

static size_t choose_layers(const cw_volume *whole, const cw_stream_desc *d, size_t sweeps)
{
    const size_t samples = whole->dim[0] * whole->dim[1];
    const size_t limit = d->extract.max_bytes, needed = BASE_BYTES + SAMPLE_BYTES * samples;
    size_t layers = d->layers ? d->layers : MIN_LAYERS;
    while (!d->layers && layers < MAX_LAYERS &&
           bytes_with(whole, &d->extract, sweeps, layers + 1) <= needed)
        layers++;
    while (limit && layers > 1 && bytes_with(whole, &d->extract, sweeps, layers) > limit)
        layers--;
    return layers;
}

size_t cw_extract_stream_bytes(const cw_volume *shape, const cw_stream_desc *desc, bool minimum)
{
    if (!shape)
        return 0;
    const cw_stream_desc d = desc ? *desc : (cw_stream_desc){0};
    cw_volume whole;
    if (cwi_volume_resolve_shape(shape, &whole, NULL) != CW_OK)
        return 0;
    return bytes_with(&whole, &d.extract, 0, minimum ? 1 : choose_layers(&whole, &d, 0));
}

static cw_status check_desc(const cw_volume *whole, const cw_extract_desc *d, cw_error *err)
{
    if (d->snap != 0)
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "snap is %g; a surface made slice by slice is not snapped", d->snap);
    return d->cubic_placement ? cwi_volume_expect_even(whole, "cubic placement", err) : CW_OK;
}

static cw_status check_memory(const cw_volume *whole, const cw_extract_desc *d, size_t sweeps,
                              size_t layers, cw_error *err)
{
    const size_t bytes = bytes_with(whole, d, sweeps, layers);
    if (!d->max_bytes || bytes <= d->max_bytes)
        return CW_OK;
    char needed[CWI_MEMORY_TEXT], left[CWI_MEMORY_TEXT];
    cwi_print_memory(bytes, needed);
    cwi_print_memory(d->max_bytes, left);
    return cwi_fail(
        err, CW_ERR_LIMIT,
        "slices of %zu x %zu voxels need %s, a layer of cells at a time; %s are left "
        "(desc->max_bytes)",
        whole->dim[0], whole->dim[1], needed, left);
}

/* Looks ahead where the surface depends on slices far away: see cw_extract_stream(). */
static cw_status look_ahead(cwi_slice_window *w, cw_error *err)
{
    const cw_type type = w->whole.type;
    const bool has_floats = type == CW_F32 || type == CW_F64;
    const bool all = w->whole.has_nodata || (w->desc.leave_open && has_floats);
    cw_status st = all ? cwi_slice_window_scan(w, true, err) : CW_OK;
    if (st != CW_OK || !all)
        return st;
    cwi_bit_grid *g = &w->plan.grid;
    w->in = w->out = false; /* of the layers that are written */
    if (!g->has_gaps) {     /* then no value is sought, as in a volume in memory */
        g->volume.has_nodata = g->find_values = false;
        cwi_free(g->has);
        g->has = NULL;
    }
    return CW_OK;
}

/* Layers of cells to write. A part of a volume leaves it open if there is a surface: only all
 * parts together tell. */
typedef struct layer_range {
    size_t begin, end;
    bool is_part;
} layer_range;

/* Checks a volume that is inside from the start: if it is inside everywhere there is no surface. */
static cw_status look_for_outside(cwi_slice_window *w, size_t end, cw_error *err)
{
    cw_status st = cwi_slice_window_scan(w, false, err);
    if (st != CW_OK || !w->out)
        return st;
    cwi_slice_window_start(w, 0);
    return cwi_slice_window_move(w, 0, end, err);
}

/* loops: counted unless the range is a part */
static cw_status write_layers(cwi_slice_window *w, cwi_chunk_writer *c, const layer_range *r,
                              size_t layers, cwi_border_loops *loops, cw_error *err)
{
    cw_status st = CW_OK;
    cwi_slice_window_start(w, r->begin);
    for (size_t begin = 0, end; w->sweeps && begin < r->begin && st == CW_OK; begin = end) {
        end = begin + layers < r->begin ? begin + layers : r->begin;
        st = cwi_progress(&w->desc.progress, "scanning", (double)begin / (double)r->begin, err);
        if (st == CW_OK)
            st = cwi_slice_window_pass(w, begin, end, err);
    }
    for (size_t begin = r->begin, end; begin < r->end && st == CW_OK; begin = end) {
        end = begin + layers < r->end ? begin + layers : r->end;
        st = cwi_progress(&w->desc.progress, "extracting",
                          (double)(begin - r->begin) / (double)(r->end - r->begin), err);
        if (st == CW_OK)
            st = cwi_slice_window_move(w, begin, end, err);
        if (st == CW_OK && !r->is_part && begin == 0 && w->in && !w->out) {
            st = look_for_outside(w, end, err);
            if (st == CW_OK && !w->out)
                return CW_OK;
        }
        if (st == CW_OK && !r->is_part)
            cwi_slice_window_add_border(w, loops);
        if (st == CW_OK && w->desc.max_triangles &&
            w->triangles - w->first_triangle > w->desc.max_triangles)
            st = cwi_fail(err, CW_ERR_LIMIT,
                          "the surface has more triangles than the limit of %zu "
                          "(desc->max_triangles); layer %zu of %zu was reached",
                          w->desc.max_triangles, end, w->whole.dim[2] + 1);
        if (st == CW_OK)
            st = cwi_chunks_write(c, begin, end, err);
    }
    return st;
}

/* Sets up a window for the volume of `w`, in place of the one that it has. */
static cw_status open_window(cwi_slice_window *w, const cwi_engine *engine,
                             const cw_slice_source *source, const cw_stream_desc *d,
                             size_t sweeps, size_t *layers, cw_error *err)
{
    cw_volume whole = w->whole;
    whole.data = NULL;
    cwi_slice_window_free(w);
    w->whole = whole;
    w->sweeps = sweeps;
    *layers = choose_layers(&whole, d, sweeps);
    cw_status st = check_memory(&whole, &d->extract, sweeps, *layers, err);
    return st == CW_OK ? cwi_slice_window_init(w, engine, source, &d->extract, *layers, err)
                       : st;
}

cw_status cwi_open_slices(cwi_slice_window *w, const cwi_engine *engine,
                          const cw_slice_source *source, const cw_stream_desc *d,
                          size_t *layers, cw_error *err)
{
    cw_status st = cwi_volume_resolve_shape(&source->shape, &w->whole, err);
    if (st == CW_OK)
        st = check_desc(&w->whole, &d->extract, err);
    if (st != CW_OK)
        return st;
    st = open_window(w, engine, source, d, 0, layers, err);
    if (st == CW_OK)
        st = look_ahead(w, err);
    return st == CW_OK && w->plan.grid.has_gaps && d->extract.leave_open
               ? open_window(w, engine, source, d, CWI_SWEEPS, layers, err)
               : st;
}

/* whole: counts of a surface in one part; may be NULL */
static cw_status extract_layers(const cwi_engine *engine, const cw_slice_source *source,
                                const cw_stream_desc *d, size_t part, size_t parts,
                                cw_chunk_sink sink, cw_part_counts *counts,
                                cw_extract_counts *whole, cw_error *err)
{
    cwi_slice_window w = {0};
    cwi_chunk_writer c = {0};
    cwi_border_loops loops = {0};
    size_t layers = 0;
    cw_status st = cwi_open_slices(&w, engine, source, d, &layers, err);
    const size_t all = w.whole.dim[2] + 1;
    const layer_range range = {all * part / parts, all * (part + 1) / parts, parts > 1};
    *counts = (cw_part_counts){0};
    if (st == CW_OK && !range.is_part)
        st = cwi_border_loops_init(&loops, w.whole.dim, err);
    if (st == CW_OK) {
        cwi_chunks_init(&c, &w, sink);
        st = write_layers(&w, &c, &range, layers, &loops, err);
    }
    if (st == CW_OK && range.begin < range.end) {
        counts->has_inside = w.in;
        counts->has_outside = w.out;
    }
    if (st == CW_OK && range.begin < range.end && (range.is_part || (w.in && w.out))) {
        const cwi_row *end = cwi_slice_window_layer(&w, range.end);
        counts->vertices = end->first[0] - w.first_vertex;
        counts->triangles = end->triangle - w.first_triangle;
    }
    if (st == CW_OK && whole)
        *whole = (cw_extract_counts){
            .vertices = counts->vertices,
            .triangles = counts->triangles,
            .bytes = bytes_with(&w.whole, &d->extract, w.sweeps, layers),
            .border_loops = w.in && w.out ? cwi_border_loops_count(&loops) : 0};
    cwi_border_loops_free(&loops);
    cwi_chunks_free(&c);
    cwi_slice_window_free(&w);
    return st;
}

cw_status cwi_extract_stream_with(const cwi_engine *engine, const cw_slice_source *source,
                                  const cw_stream_desc *desc, cw_chunk_sink sink,
                                  cw_extract_counts *counts, cw_error *err)
{
    const cw_stream_desc d = desc ? *desc : (cw_stream_desc){0};
    cw_part_counts made;
    return extract_layers(engine, source, &d, 0, 1, sink, &made, counts, err);
}

cw_status cw_extract_stream_part(const cw_slice_source *source, const cw_stream_desc *desc,
                                 size_t part, size_t parts, cw_chunk_sink sink,
                                 cw_part_counts *counts, cw_error *err)
{
    CWI_REQUIRE(err, source);
    CWI_REQUIRE_VERSION(err, desc, 0);
    const cw_stream_desc d = desc ? *desc : (cw_stream_desc){0};
    cw_part_counts made;
    if (part >= parts)
        return cwi_fail(err, CW_ERR_ARGUMENT, "part %zu of %zu; they count from 0", part,
                        parts);
    return extract_layers(cwi_engine_best(), source, &d, part, parts, sink,
                          counts ? counts : &made, NULL, err);
}

cw_status cw_extract_stream(const cw_slice_source *source, const cw_stream_desc *desc,
                            cw_chunk_sink sink, cw_extract_counts *counts, cw_error *err)
{
    CWI_REQUIRE(err, source);
    CWI_REQUIRE_VERSION(err, desc, 0);
    return cwi_extract_stream_with(cwi_engine_best(), source, desc, sink, counts, err);
}
