/* Measures irregular grids: checks shapes and corners, and sums up the volumes of cells, in
 * parallel chunks that are joined in order. */
#include "viewer/scene/cells_size.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/box.h"
#include "core/geometry/triangle.h"
#include "core/geometry/vec3.h"
#include "core/volume/cell_shapes.h"

#include <math.h>

enum { CHUNK = 8192 };

typedef struct chunk_size {
    cwi_cells_size size;
    size_t bad; /* the first cell with a corner that is not a sample; SIZE_MAX: none */
} chunk_size;

typedef struct job {
    const cw_volume *volume;
    const size_t *starts;
    chunk_size *chunks;
} job;

static const double boxes_of[CW_SHAPE_COUNT] = {1.0 / 6, 1.0 / 3, 1.0 / 2, 1};

/* Computes a cell's volume by the divergence theorem; faces of four corners are two
 * triangles. */
static double cell_volume(const cwi_cell_shape *s, const double *points,
                          const uint32_t *corners)
{
    const double *p[CWI_SHAPE_CORNERS];
    double sum = 0;
    for (int c = 0; c < s->corner_count; c++)
        p[c] = points + 3 * (size_t)corners[c];
    for (int f = 0; f < s->face_count; f++)
        for (int n = 2; n < s->face_size[f]; n++)
            sum += cwi_tetrahedron_sixfold(p[0], p[s->faces[f][0]], p[s->faces[f][n - 1]],
                                           p[s->faces[f][n]]);
    return fabs(sum) / 6;
}

static void add_cell(const cwi_cell_shape *s, double boxes, const double *points,
                     const uint32_t *corners, cwi_cells_size *size)
{
    const double volume = cell_volume(s, points, corners);
    if (!isfinite(volume))
        return;
    size->volume += volume;
    size->boxes += boxes;
    for (int c = 0; c < s->corner_count; c++)
        cwi_box_add(size->low, size->high, points + 3 * (size_t)corners[c]);
}

static cwi_cells_size empty_size(void)
{
    cwi_cells_size size = {0};
    cwi_box_clear(size.low, size.high);
    return size;
}

static bool corners_exist(const cwi_cell_shape *s, const uint32_t *corners, size_t samples)
{
    for (int c = 0; c < s->corner_count; c++)
        if (corners[c] >= samples)
            return false;
    return true;
}

static void measure_chunk(void *context, size_t chunk)
{
    const job *work = context;
    const cw_cells *cells = work->volume->cells;
    const uint32_t *corners = cells->corners + work->starts[chunk];
    const size_t begin = chunk * CHUNK, last = cells->count;
    chunk_size *c = &work->chunks[chunk];
    *c = (chunk_size){empty_size(), SIZE_MAX};
    for (size_t n = begin; n < begin + CHUNK && n < last; n++) {
        const cwi_cell_shape *s = &cwi_cell_shapes[cells->shapes[n]];
        if (!corners_exist(s, corners, work->volume->dim[0])) {
            c->bad = n;
            return;
        }
        add_cell(s, boxes_of[cells->shapes[n]], cells->points, corners, &c->size);
        corners += s->corner_count;
    }
}

static cw_status join_chunks(const job *work, size_t count, cwi_cells_size *size, cw_error *err)
{
    *size = empty_size();
    for (size_t n = 0; n < count; n++) {
        const chunk_size *c = &work->chunks[n];
        if (c->bad != SIZE_MAX)
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "cell %zu has a corner beyond the %zu samples", c->bad,
                            work->volume->dim[0]);
        size->volume += c->size.volume;
        size->boxes += c->size.boxes;
        cwi_box_join(size->low, size->high, c->size.low, c->size.high);
    }
    for (int a = 0; a < 3 && size->boxes == 0; a++)
        size->low[a] = size->high[a] = 0;
    return CW_OK;
}

cw_status cwi_cells_measure(const cw_volume *volume, int threads, cwi_cells_size *size,
                            cw_error *err)
{
    static const cw_progress unreported = {0};
    size_t *starts;
    const size_t chunks = (volume->cells->count + CHUNK - 1) / CHUNK;
    cw_status st = cwi_cell_chunks(volume->cells, CHUNK, &starts, err);
    if (st != CW_OK)
        return st;
    job work = {volume, starts, cwi_alloc_array(chunks, sizeof *work.chunks)};
    if (!work.chunks)
        st = cwi_fail_memory(err);
    if (st == CW_OK)
        st = cwi_parallel_for(chunks, (size_t)CHUNK * 16, threads, &unreported, "measuring",
                              measure_chunk, &work, err);
    if (st == CW_OK)
        st = join_chunks(&work, chunks, size, err);
    cwi_free(work.chunks);
    cwi_free(starts);
    return st;
}
