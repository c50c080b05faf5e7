/* Finds the elements of an irregular grid: the cells that its surface is made of. */
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/box.h"
#include "core/volume/cell_shapes.h"
#include "extract/irregular/cell_surface.h"

#include <float.h>
#include <math.h>
#include <pthread.h>
#include <string.h>

/* --- samples ----------------------------------------------------------------------------- */

enum { SAMPLE_CHUNK = 1 << 15 };

typedef struct sampling {
    cwi_cells *g;
    pthread_mutex_t lock; /* for what follows, and for the grid's largest value */
    double low[3], high[3];
    size_t bad; /* the first sample whose point is not finite */
} sampling;

static uint8_t side_of(const cwi_cells *g, double x)
{
    if (isnan(x) || (g->volume.has_nodata && x == g->volume.nodata))
        return CWI_ABSENT;
    const bool above = g->level.strict ? x > g->level.at : x >= g->level.at;
    return above != g->level.invert ? CWI_INSIDE : CWI_OUTSIDE;
}

static void look_at_samples(void *context, size_t chunk)
{
    sampling *s = context;
    cwi_cells *g = s->g;
    const size_t begin = chunk * SAMPLE_CHUNK, last = g->volume.dim[0];
    const size_t end = begin + SAMPLE_CHUNK < last ? begin + SAMPLE_CHUNK : last;
    double largest = 0, low[3], high[3];
    size_t bad = SIZE_MAX;
    cwi_box_clear(low, high);
    for (size_t n = begin; n < end; n++) {
        const double x = cwi_stored_at(g, (uint32_t)n), *p = g->volume.cells->points + 3 * n;
        g->sides[n] = side_of(g, x);
        if (isfinite(x) && fabs(x) > largest)
            largest = fabs(x);
        cwi_box_add(low, high, p);
        for (int a = 0; a < 3; a++)
            bad = !isfinite(p[a]) && n < bad ? n : bad;
    }
    pthread_mutex_lock(&s->lock);
    g->largest = fmax(g->largest, largest);
    cwi_box_join(s->low, s->high, low, high);
    s->bad = bad < s->bad ? bad : s->bad;
    pthread_mutex_unlock(&s->lock);
}

/* Sets the origin and checks the range. Positions are floats: they have to reach from the
 * middle to the farthest point, and to distinguish it from the middle. */
static cw_status set_frame(cwi_cells *g, const sampling *s, cw_error *err)
{
    double far = 0;
    for (int a = 0; a < 3; a++) {
        g->centre[a] = 0.5 * s->low[a] + 0.5 * s->high[a];
        g->reach = fmax(g->reach, s->high[a] - s->low[a]);
    }
    for (int i = 0; i < 9; i++)
        far = fmax(far, fabs(g->volume.affine[i / 3][i % 3]) * g->reach * 3);
    if (far > (double)FLT_MAX || (g->reach > 0 && far < (double)FLT_MIN))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "a grid %g mm wide is beyond what positions can hold", far / 3);
    return CW_OK;
}

static cw_status compare_samples(cwi_cells *g, cw_error *err)
{
    const size_t samples = g->volume.dim[0];
    sampling s = {.g = g, .lock = PTHREAD_MUTEX_INITIALIZER, .bad = SIZE_MAX};
    cwi_box_clear(s.low, s.high);
    g->sides = cwi_alloc_array(samples, sizeof *g->sides);
    if (!g->sides)
        return cwi_fail_memory(err);
    cw_status st = cwi_parallel_for((samples + SAMPLE_CHUNK - 1) / SAMPLE_CHUNK, SAMPLE_CHUNK,
                                    g->desc->threads, &g->desc->progress, "classifying",
                                    look_at_samples, &s, err);
    pthread_mutex_destroy(&s.lock);
    if (st == CW_OK && s.bad != SIZE_MAX)
        st = cwi_fail(err, CW_ERR_ARGUMENT, "the point of sample %zu is not finite", s.bad);
    return st == CW_OK ? set_frame(g, &s, err) : st;
}

/* --- cells ------------------------------------------------------------------------------- */

/* Counts for every chunk: first the elements in it, then those before it. */
typedef struct gathering {
    cwi_cells *g;
    size_t *elements;
    pthread_mutex_t lock; /* for bad */
    size_t bad;           /* the first cell with a corner that is not a sample */
} gathering;

static void take_corners(cwi_element *e, const uint32_t *corners)
{
    const int count = cwi_shape_of(e)->corner_count;
    for (int c = 0; c < count; c++)
        e->corners[c] = corners[cwi_listed_corner(e->shape, c)];
}

static bool repeats_a_corner(const cwi_element *e)
{
    const int count = cwi_shape_of(e)->corner_count;
    for (int c = 1; c < count; c++)
        for (int d = 0; d < c; d++)
            if (e->corners[c] == e->corners[d])
                return true;
    return false;
}

static void find_case(const cwi_cells *g, cwi_element *e)
{
    const cwi_shape *s = cwi_shape_of(e);
    for (int c = 0; c < s->corner_count; c++)
        e->inside |= (uint8_t)((g->sides[e->corners[c]] == CWI_INSIDE) << c);
    for (int n = 0; n < s->edge_count; n++)
        e->crossed |= (uint16_t)((cwi_corner_inside(e, s->edges[n][0]) !=
                                  cwi_corner_inside(e, s->edges[n][1]))
                                 << n);
}

/* Makes the element of a cell; returns false if it is not one. Cells without a value at some
 * corner count as absent. */
static bool take_element(const cwi_cells *g, uint8_t shape, const uint32_t *corners,
                         cwi_element *e)
{
    const int count = cwi_shapes[shape].corner_count;
    uint8_t sides = 0;
    for (int c = 0; c < count; c++)
        sides |= g->sides[corners[c]];
    if (sides == CWI_OUTSIDE || sides & CWI_ABSENT ||
        (sides == CWI_INSIDE && g->desc->leave_open))
        return false;
    *e = (cwi_element){.shape = shape};
    take_corners(e, corners);
    if (repeats_a_corner(e) && !cwi_element_collapse(e))
        return false;
    find_case(g, e);
    return true;
}

static bool corners_exist(const cwi_cells *g, const uint32_t *corners, int count)
{
    bool exist = true;
    for (int c = 0; c < count; c++)
        exist = exist && corners[c] < g->volume.dim[0];
    return exist;
}

/* Counts a chunk's elements, or puts them where they belong. */
static void gather_chunk(gathering *w, size_t chunk, bool keep)
{
    cwi_cells *g = w->g;
    const cw_cells *cells = g->volume.cells;
    const size_t begin = chunk * CWI_CELL_CHUNK, last = cells->count;
    const size_t end = begin + CWI_CELL_CHUNK < last ? begin + CWI_CELL_CHUNK : last;
    const uint32_t *corners = cells->corners + g->chunk_corners[chunk];
    size_t count = keep ? w->elements[chunk] : 0;
    for (size_t n = begin; n < end; n++) {
        const uint8_t shape = cells->shapes[n];
        const int size = cwi_shapes[shape].corner_count;
        cwi_element e;
        if (!keep && !corners_exist(g, corners, size)) {
            pthread_mutex_lock(&w->lock);
            w->bad = n < w->bad ? n : w->bad;
            pthread_mutex_unlock(&w->lock);
            return;
        }
        if (take_element(g, shape, corners, &e)) {
            if (keep)
                g->elements[count] = e;
            count++;
        }
        corners += size;
    }
    if (!keep)
        w->elements[chunk] = count;
}

static void count_chunk(void *context, size_t chunk)
{
    gather_chunk(context, chunk, false);
}

static void keep_chunk(void *context, size_t chunk)
{
    gather_chunk(context, chunk, true);
}

static cw_status refuse_corners(const cwi_cells *g, size_t bad, cw_error *err)
{
    const cw_cells *cells = g->volume.cells;
    const uint32_t *corners = cells->corners + g->chunk_corners[bad / CWI_CELL_CHUNK];
    for (size_t n = bad - bad % CWI_CELL_CHUNK; n < bad; n++)
        corners += cwi_shapes[cells->shapes[n]].corner_count;
    while (*corners < g->volume.dim[0])
        corners++;
    return cwi_fail(err, CW_ERR_ARGUMENT, "cell %zu has a corner at sample %u of %zu", bad,
                    *corners, g->volume.dim[0]);
}

static cw_status place_elements(gathering *w, cw_error *err)
{
    cwi_cells *g = w->g;
    for (size_t c = 0; c < g->chunks; c++) {
        const size_t count = w->elements[c];
        w->elements[c] = g->count;
        g->count += count;
    }
    if (g->count > INT32_MAX / CWI_CELL_FACES) /* a bit of a face's number is needed */
        return cwi_fail(err, CW_ERR_LIMIT, "the surface meets %zu cells; at most %d can be",
                        g->count, INT32_MAX / CWI_CELL_FACES);
    g->elements = cwi_alloc_large(g->count, sizeof *g->elements);
    if (!g->elements)
        return cwi_fail_memory(err);
    return cwi_parallel_for(g->chunks, CWI_CELL_CHUNK * 16, g->desc->threads,
                            &g->desc->progress, "gathering", keep_chunk, w, err);
}

cw_status cwi_cells_gather(cwi_cells *g, cw_error *err)
{
    gathering w = {.g = g, .lock = PTHREAD_MUTEX_INITIALIZER, .bad = SIZE_MAX};
    const cw_cells *cells = g->volume.cells;
    g->chunks = (cells->count + CWI_CELL_CHUNK - 1) / CWI_CELL_CHUNK;
    cw_status st = cwi_cell_chunks(cells, CWI_CELL_CHUNK, &g->chunk_corners, err);
    if (st != CW_OK)
        return st;
    w.elements = cwi_alloc_array(g->chunks, sizeof *w.elements);
    if (!w.elements)
        return cwi_fail_memory(err);
    st = cwi_parallel_for(g->chunks, CWI_CELL_CHUNK * 16, g->desc->threads, &g->desc->progress,
                          "counting", count_chunk, &w, err);
    if (st == CW_OK && w.bad != SIZE_MAX)
        st = refuse_corners(g, w.bad, err);
    if (st == CW_OK)
        st = place_elements(&w, err);
    cwi_free(w.elements);
    pthread_mutex_destroy(&w.lock);
    return st;
}

/* ----------------------------------------------------------------------------------------- */

cw_status cwi_cells_init(cwi_cells *g, const cw_volume *volume, const cw_extract_desc *desc,
                         cw_error *err)
{
    memset(g, 0, sizeof *g);
    g->desc = desc;
    cw_status st = cw_volume_select(volume, 0, 0, &g->volume, err);
    if (st == CW_OK && desc->snap != 0)
        st = cwi_volume_expect_even(&g->volume, "snap", err);
    if (st == CW_OK && desc->cubic_placement)
        st = cwi_volume_expect_even(&g->volume, "cubic placement", err);
    if (st == CW_OK)
        st = cwi_level_find(&g->volume, desc, &g->level, err);
    return st == CW_OK ? compare_samples(g, err) : st;
}

void cwi_cells_free(cwi_cells *g)
{
    cwi_free(g->sides);
    cwi_free(g->chunk_corners);
    cwi_free(g->elements);
    cwi_free(g->across);
    cwi_free(g->crossings);
    cwi_free(g->border);
    memset(g, 0, sizeof *g);
}
