/* Fills rows of partial volumes: triangles are cut along the faces of voxels' cells, and the volume between
 * each piece and the high end of its row is added up. */
#include "extract/voxelize/voxelize_state.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The change of the covered volume at a piece: `cover` in all voxels behind it, `partial` in its own. */
typedef struct piece {
    uint32_t row, mesh;
    int64_t at; /* its voxel; -1: before the grid */
    double cover, partial;
} piece;

/* A convex polygon: a triangle that at most six planes cut, by one more corner each. */
typedef struct polygon {
    int count;
    double p[12][3];
} polygon;

/* Fractions are rounded to this, so that sums which should be 0 or 1 are. */
static const double FRACTION = 1.0 / (1 << 20);

static void add_corner(polygon *to, const double p[3])
{
    memcpy(to->p[to->count++], p, sizeof *to->p);
}

/* Parts a polygon at the plane x[axis] = at. Both sides get the same corners on it. */
static void split_polygon(const polygon *in, int axis, double at, polygon *below,
                          polygon *above)
{
    below->count = above->count = 0;
    for (int n = 0; n < in->count; n++) {
        const double *a = in->p[n], *b = in->p[n + 1 < in->count ? n + 1 : 0];
        const double from = a[axis] - at, to = b[axis] - at;
        if (from <= 0)
            add_corner(below, a);
        if (from >= 0)
            add_corner(above, a);
        if (!((from < 0 && to > 0) || (from > 0 && to < 0)))
            continue;
        double p[3];
        /* the same point for both directions of an edge, as the neighbour cuts it, too */
        const double *low = from < 0 ? a : b, *high = from < 0 ? b : a;
        const double t = (at - low[axis]) / (high[axis] - low[axis]);
        for (int k = 0; k < 3; k++)
            p[k] = low[k] + t * (high[k] - low[k]);
        p[axis] = at;
        add_corner(below, p);
        add_corner(above, p);
    }
}

/* Finds the cells along an axis that a polygon is in, within those from first to last. Returns false if it is in
 * none. */
static bool find_cells(const polygon *g, int axis, int64_t first, int64_t last, int64_t *low,
                       int64_t *high)
{
    double min = g->p[0][axis], max = min;
    for (int n = 1; n < g->count; n++) {
        min = cwi_lesser(min, g->p[n][axis]);
        max = cwi_greater(max, g->p[n][axis]);
    }
    min = cwi_greater(floor(min + 0.5), (double)first);
    max = cwi_lesser(floor(max + 0.5), (double)last);
    if (g->count < 3 || min > max)
        return false;
    *low = (int64_t)min;
    *high = (int64_t)max;
    return true;
}

/* Stores a piece that is in one voxel, or before the grid. */
static void add_piece(cwi_block_rows *r, const polygon *g, uint32_t row, size_t mesh, int64_t i)
{
    double area = 0, moment = 0; /* twice; along x */
    for (int n = 2; n < g->count; n++) {
        const double *a = g->p[0], *b = g->p[n - 1], *c = g->p[n];
        const double twice = (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1]);
        area += twice;
        moment += twice * (a[0] + b[0] + c[0]) / 3;
    }
    if (area == 0)
        return;
    const double cover = -0.5 * area * r->v->turn[mesh],
                 reach = (double)i + 0.5 - moment / area;
    piece *e = cwi_row_events_add(&r->events, sizeof *e);
    if (e)
        *e = (piece){row, (uint32_t)mesh, i, cover,
                     i < 0 ? 0 : cover * cwi_lesser(cwi_greater(reach, 0), 1)};
}

/* Cuts the part in a cell off a polygon; the rest stays in it. Returns that part, which is the polygon itself
 * in the last cell. */
static polygon *cut_cell(polygon *rest, int axis, int64_t cell, bool is_last, polygon *part)
{
    polygon above;
    if (is_last)
        return rest;
    split_polygon(rest, axis, (double)cell + 0.5, part, &above);
    rest->count = above.count;
    memcpy(rest->p, above.p, (size_t)above.count * sizeof *above.p);
    return part;
}

/* Leaves out what is below the first cell, and above the last. */
static void clip_cells(polygon *g, int axis, int64_t low, int64_t high)
{
    polygon below, above;
    split_polygon(g, axis, (double)low - 0.5, &below, &above);
    split_polygon(&above, axis, (double)high + 0.5, g, &below);
}

static void cover_row(cwi_block_rows *r, polygon *rest, uint32_t row, size_t mesh)
{
    const int64_t end = (int64_t)r->v->volume->dim[0];
    int64_t low, high;
    polygon part;
    if (!find_cells(rest, 0, INT32_MIN, INT32_MAX, &low, &high) || low >= end)
        return;
    low = low < 0 ? -1 : low;
    high = high < 0 ? -1 : high;
    for (int64_t i = low; i <= high && i < end; i++) {
        add_piece(r, cut_cell(rest, 0, i, i == high, &part), row, mesh, i);
    }
}

static void cover_layer(cwi_block_rows *r, polygon *rest, size_t layer, size_t mesh)
{
    const int64_t last = (int64_t)r->v->volume->dim[1] - 1;
    int64_t low, high;
    polygon part;
    if (!find_cells(rest, 1, 0, last, &low, &high))
        return;
    if (low == 0 || high == last)
        clip_cells(rest, 1, low, high);
    for (int64_t j = low; j <= high; j++) {
        polygon *g = cut_cell(rest, 1, j, j == high, &part);
        cover_row(r, g, (uint32_t)((layer - r->low) * (size_t)(last + 1) + (size_t)j), mesh);
    }
}

static void cover_triangle(cwi_block_rows *r, size_t triangle, size_t mesh)
{
    const double *points[3];
    polygon rest = {.count = 3}, part;
    int64_t low, high;
    cwi_voxelize_corners(r->v, triangle, mesh, points);
    for (int n = 0; n < 3; n++)
        memcpy(rest.p[n], points[n], sizeof rest.p[n]);
    if (!find_cells(&rest, 2, (int64_t)r->low, (int64_t)r->high - 1, &low, &high))
        return;
    if (low == (int64_t)r->low || high == (int64_t)r->high - 1)
        clip_cells(&rest, 2, low, high);
    for (int64_t k = low; k <= high; k++) {
        cover_layer(r, cut_cell(&rest, 2, k, k == high, &part), (size_t)k, mesh);
    }
}

static int compare_pieces(const void *a, const void *b)
{
    const piece *p = *(const piece *const *)a, *q = *(const piece *const *)b;
    if (p->at != q->at)
        return (p->at > q->at) - (p->at < q->at);
    return (p > q) - (p < q); /* sums are made in one order */
}

/* Sorts pointers to the pieces of a row by voxel, then as they came. */
static void sort_row(const piece **order, size_t count)
{
    enum { FEW = 24 };
    if (count > FEW) {
        qsort(order, count, sizeof *order, compare_pieces);
        return;
    }
    for (size_t n = 1; n < count; n++) {
        const piece *next = order[n];
        size_t m = n;
        for (; m > 0 && order[m - 1]->at > next->at; m--)
            order[m] = order[m - 1];
        order[m] = next;
    }
}

static float to_fraction(double covered)
{
    const double steps = rint(covered / FRACTION);
    return (float)(fmin(fmax(steps, 0), 1 / FRACTION) * FRACTION);
}

/* Fills a row with running sums of what its pieces change. */
static void fill_row(const piece *const *order, size_t count, size_t dim, float *voxels)
{
    double sum = 0;
    size_t i = 0;
    for (size_t n = 0; n < count;) {
        const int64_t at = order[n]->at;
        const float before = to_fraction(sum);
        double partial = 0, cover = 0;
        for (; n < count && order[n]->at == at; n++) {
            partial += order[n]->partial;
            cover += order[n]->cover;
        }
        if (before > 0)
            for (; (int64_t)i < at; i++)
                voxels[i] = before;
        if (at >= 0) {
            voxels[at] = to_fraction(sum + partial);
            i = (size_t)at + 1;
        }
        sum += cover;
    }
    const float after = to_fraction(sum);
    if (after > 0)
        for (; i < dim; i++)
            voxels[i] = after;
}

/* Adds what each mesh covers of a block. */
static void sum_meshes(const piece *pieces, size_t count, size_t dim,
                       cwi_voxelize_counts *counts)
{
    for (size_t n = 0; n < count; n++)
        counts[pieces[n].mesh].covered +=
            pieces[n].partial + pieces[n].cover * (double)((int64_t)dim - 1 - pieces[n].at);
}

void cwi_voxelize_coverage(void *state, size_t block)
{
    cwi_voxelize *v = state;
    const size_t *dim = v->volume->dim;
    cwi_block_rows r;
    bool ok = cwi_block_rows_fill(&r, v, block, sizeof(piece), cover_triangle);
    const piece *sorted = r.sorted, **order = cwi_alloc_array(r.events.count, sizeof *order);
    float *voxels = (float *)cw_volume_voxels(v->volume) + r.low * dim[1] * dim[0];
    ok = ok && order;
    if (!ok)
        cwi_set_flag(&v->no_memory);
    for (size_t row = 0; row < r.count && ok; row++) {
        const size_t count = r.first[row + 1] - r.first[row];
        for (size_t n = 0; n < count; n++)
            order[n] = sorted + r.first[row] + n;
        sort_row(order, count);
        fill_row(order, count, dim[0], voxels + row * dim[0]);
    }
    if (sorted)
        sum_meshes(sorted, r.events.count, dim[0], v->counts + block * v->count);
    cwi_free(order);
    cwi_block_rows_free(&r);
}
