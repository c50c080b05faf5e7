/* Files triangles under ranges of vertices: a counting sort on threads. */
#include "simplify/quality/vertex_ranges.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"

/* Shares of the triangles that threads file: at most, and of how many triangles at least. Each
 * share counts each range. */
enum { MAX_CHUNKS = 64, MIN_CHUNK = 1 << 14 };

typedef struct work {
    const uint32_t *triangles;
    size_t triangle_count, chunk; /* triangles of a share */
    uint32_t begin, size;         /* the vertices */
    cwi_vertex_ranges *ranges;
    uint32_t *counts; /* of each share: triangles of each range, later the next one's index */
} work;

/* Finds the ranges of a triangle's corners, each once; returns how many. */
static unsigned find_ranges(const work *w, size_t triangle, uint32_t found[3])
{
    const uint32_t *corner = w->triangles + 3 * triangle;
    unsigned count = 0;
    for (int n = 0; n < 3; n++) {
        const uint32_t slot = corner[n] - w->begin; /* wraps round below the vertices */
        const uint32_t range = slot / CWI_RANGE_VERTICES;
        const bool again = (count > 0 && found[0] == range) || (count > 1 && found[1] == range);
        if (slot < w->size && !again)
            found[count++] = range;
    }
    return count;
}

static size_t end_of(const work *w, size_t chunk)
{
    const size_t end = (chunk + 1) * w->chunk;
    return end < w->triangle_count ? end : w->triangle_count;
}

static void count_chunk(void *context, size_t k)
{
    const work *w = context;
    uint32_t *counts = w->counts + k * w->ranges->count, found[3];
    for (size_t t = k * w->chunk; t < end_of(w, k); t++)
        for (unsigned n = find_ranges(w, t, found); n > 0; n--)
            counts[found[n - 1]]++;
}

static void file_chunk(void *context, size_t k)
{
    const work *w = context;
    uint32_t *next = w->counts + k * w->ranges->count, found[3];
    for (size_t t = k * w->chunk; t < end_of(w, k); t++)
        for (unsigned n = find_ranges(w, t, found); n > 0; n--)
            w->ranges->triangle[next[found[n - 1]]++] = (uint32_t)t;
}

/* Turns counts into start indices: by range, then by share. */
static void sum_counts(const work *w, size_t chunks)
{
    uint32_t start = 0;
    for (size_t r = 0; r < w->ranges->count; r++) {
        w->ranges->begin[r] = start;
        for (size_t k = 0; k < chunks; k++) {
            uint32_t *count = w->counts + k * w->ranges->count + r;
            const uint32_t next = start + *count;
            *count = start;
            start = next;
        }
    }
    w->ranges->begin[w->ranges->count] = start;
}

static bool run_chunks(work *w, size_t chunks, int threads, void (*run)(void *, size_t))
{
    const cw_progress silent = {0};
    return cwi_parallel_for(chunks, w->chunk * 8, threads, &silent, NULL, run, w, NULL) ==
           CW_OK;
}

bool cwi_vertex_ranges_init(cwi_vertex_ranges *ranges, const uint32_t *triangles, size_t count,
                            uint32_t begin, uint32_t end, int threads)
{
    const size_t even = (count + MAX_CHUNKS - 1) / MAX_CHUNKS;
    work w = {.triangles = triangles,
              .triangle_count = count,
              .chunk = even > MIN_CHUNK ? even : MIN_CHUNK,
              .begin = begin,
              .size = end - begin,
              .ranges = ranges};
    const size_t chunks = (count + w.chunk - 1) / w.chunk;
    *ranges = (cwi_vertex_ranges){.count = ((size_t)w.size + CWI_RANGE_VERTICES - 1) /
                                           CWI_RANGE_VERTICES};
    w.counts = cwi_alloc_zeroed(chunks * ranges->count, sizeof *w.counts);
    ranges->begin = cwi_alloc_array(ranges->count + 1, sizeof *ranges->begin);
    bool ok = w.counts && ranges->begin && run_chunks(&w, chunks, threads, count_chunk);
    if (ok) {
        sum_counts(&w, chunks);
        ranges->triangle =
            cwi_alloc_array(ranges->begin[ranges->count], sizeof *ranges->triangle);
        ok = ranges->triangle && run_chunks(&w, chunks, threads, file_chunk);
    }
    cwi_free(w.counts);
    if (!ok)
        cwi_vertex_ranges_free(ranges);
    return ok;
}

void cwi_vertex_ranges_free(cwi_vertex_ranges *ranges)
{
    cwi_free(ranges->begin);
    cwi_free(ranges->triangle);
    *ranges = (cwi_vertex_ranges){0};
}
