/* Computes normals from slices: sorts the vertices by slice, and moves a window of slices up. */
#include "extract/stream/extract_stream.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/volume/volume.h"
#include "extract/common/field_normals.h"

#include <string.h>

/* Slices around those of a layer of cells, which gradients need; the least in memory, and the
 * memory that more of them may take. */
enum { BELOW = 1, ABOVE = 2, MIN_SLICES = BELOW + 1 + ABOVE, WINDOW_BYTES = 8 << 20 };

/* Vertices that one thread shades at a time. */
enum { CHUNK_VERTICES = 4096 };

typedef struct normal_walk {
    cwi_shading shading;
    const cw_slice_source *source;
    size_t slice;           /* bytes */
    unsigned char *slices;  /* the window */
    size_t capacity, count; /* of it, in slices */
    uint32_t *order;        /* vertices in the volume, by the lower slice of their cell */
    size_t *before;         /* slices + 2: how many of them come before those of a slice */
    size_t begin, end;      /* of `order`: those of the window */
} normal_walk;

static void free_walk(normal_walk *w)
{
    cwi_shading_free(&w->shading);
    cwi_free(w->slices);
    cwi_free(w->order);
    cwi_free(w->before);
}

/* Chooses the size of the window, and checks that all of it fits the limit. */
static cw_status plan_window(normal_walk *w, const cw_volume *whole, const cw_mesh *mesh,
                             size_t max_bytes, cw_error *err)
{
    const size_t slices = whole->dim[2],
                 vertex = sizeof *w->order + 3 * sizeof *w->shading.normals + sizeof(bool),
                 beside = mesh->vertex_count * vertex + (slices + 2) * sizeof *w->before;
    w->slice = (size_t)whole->stride[2];
    w->capacity = WINDOW_BYTES / w->slice;
    if (max_bytes && w->capacity > MIN_SLICES && beside + w->capacity * w->slice > max_bytes)
        w->capacity = max_bytes > beside ? (max_bytes - beside) / w->slice : 0;
    w->capacity = w->capacity < MIN_SLICES ? MIN_SLICES : w->capacity;
    w->capacity = w->capacity < slices ? w->capacity : slices;
    const size_t needed = beside + w->capacity * w->slice;
    if (!max_bytes || needed <= max_bytes)
        return CW_OK;
    char needed_text[CWI_MEMORY_TEXT], left_text[CWI_MEMORY_TEXT];
    cwi_print_memory(needed, needed_text);
    cwi_print_memory(max_bytes, left_text);
    return cwi_fail(err, CW_ERR_LIMIT,
                    "normals of %zu vertices, slice by slice, need %s; %s are left (max_bytes)",
                    mesh->vertex_count, needed_text, left_text);
}

/* Lists the vertices of each slice. */
static cw_status sort_vertices(normal_walk *w, cw_error *err)
{
    const size_t vertices = w->shading.mesh->vertex_count, slices = w->shading.volume.dim[2];
    size_t slice;
    w->slices = cwi_alloc_large(w->capacity, w->slice);
    w->order = cwi_alloc_array(vertices, sizeof *w->order);
    w->before = cwi_alloc_zeroed(slices + 2, sizeof *w->before);
    if (!w->slices || !w->order || !w->before)
        return cwi_fail_memory(err);
    for (size_t v = 0; v < vertices; v++)
        if (cwi_shading_slice(&w->shading, v, &slice))
            w->before[slice + 2]++;
    for (size_t k = 2; k < slices + 2; k++)
        w->before[k] += w->before[k - 1];
    for (size_t v = 0; v < vertices;
         v++) /* a number that reaches its end is the next slice's */
        if (cwi_shading_slice(&w->shading, v, &slice))
            w->order[w->before[slice + 1]++] = (uint32_t)v;
    return CW_OK;
}

/* Brings slices first to end - 1 into memory. */
static cw_status hold_slices(normal_walk *w, size_t first, size_t end, cw_error *err)
{
    cwi_shading *s = &w->shading;
    const size_t last = s->first + w->count, kept = last > first ? last - first : 0;
    memmove(w->slices, w->slices + (kept ? first - s->first : 0) * w->slice, kept * w->slice);
    s->first = first;
    s->volume.data = w->slices;
    w->count = end - first;
    return kept < w->count ? w->source->read(w->source->user, first + kept, w->count - kept,
                                             w->slices + kept * w->slice, err)
                           : CW_OK;
}

static void shade_chunk(void *context, size_t chunk)
{
    const normal_walk *w = context;
    const size_t begin = w->begin + chunk * CHUNK_VERTICES, end = begin + CHUNK_VERTICES;
    for (size_t n = begin; n < (end < w->end ? end : w->end); n++)
        cwi_shade_vertex(&w->shading, w->order[n]);
}

/* Shades the vertices of the cells on slices begin to end - 1. */
static cw_status shade_slices(normal_walk *w, size_t begin, size_t end, int threads,
                              cw_error *err)
{
    const size_t slices = w->shading.volume.dim[2];
    cw_status st = hold_slices(w, begin > BELOW ? begin - BELOW : 0,
                               end + ABOVE < slices ? end + ABOVE : slices, err);
    w->begin = w->before[begin];
    w->end = w->before[end];
    return st == CW_OK
               ? cwi_parallel_for((w->end - w->begin + CHUNK_VERTICES - 1) / CHUNK_VERTICES,
                                  CHUNK_VERTICES, threads, &(cw_progress){0}, "shading",
                                  shade_chunk, w, err)
               : st;
}

/* Slices without vertices near them are not read. */
static cw_status shade_mesh(normal_walk *w, const cw_normals_desc *d, cw_error *err)
{
    const size_t slices = w->shading.volume.dim[2],
                 layers = w->capacity < slices ? w->capacity - BELOW - ABOVE : slices;
    cw_status st = CW_OK;
    for (size_t begin = 0, end; begin < slices && st == CW_OK; begin = end) {
        end = begin + 1;
        if (w->before[begin] == w->before[end])
            continue;
        end = begin + layers < slices ? begin + layers : slices;
        st = cwi_progress(&d->progress, "shading", (double)begin / (double)slices, err);
        if (st == CW_OK)
            st = shade_slices(w, begin, end, d->threads, err);
    }
    return st;
}

cw_status cw_extract_stream_normals(const cw_slice_source *source, const cw_normals_desc *desc,
                                    size_t max_bytes, cw_mesh *mesh, cw_error *err)
{
    CWI_REQUIRE(err, source, mesh);
    CWI_REQUIRE_VERSION(err, desc, 0);
    static const double none = 0;
    const cw_normals_desc d = desc ? *desc : (cw_normals_desc){0};
    normal_walk w = {.source = source};
    cw_volume whole;
    cw_status st = cwi_volume_resolve_shape(&source->shape, &whole, err);
    if (st != CW_OK)
        return st;
    st = plan_window(&w, &whole, mesh, max_bytes, err);
    whole.data = &none; /* only to be present */
    if (st == CW_OK)
        st = cwi_shading_init(&w.shading, &whole, &d, mesh, err);
    if (st == CW_OK)
        st = sort_vertices(&w, err);
    if (st == CW_OK)
        st = shade_mesh(&w, &d, err);
    if (st == CW_OK)
        st = cwi_shading_finish(&w.shading, err);
    free_walk(&w);
    return st;
}
