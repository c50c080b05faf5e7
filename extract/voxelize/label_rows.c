/* Fills rows of a label map: where they cross the meshes is decided by whole numbers. */
#include "extract/voxelize/voxelize_state.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/geometry/triangle.h"
#include "core/volume/volume.h"

#include <math.h>
#include <stdlib.h>

/* Products of coordinates and areas. Without integers of 128 bits, planes that pass a centre by
 * less than rounding may be on the wrong side of it. */
#ifdef __SIZEOF_INT128__
__extension__ typedef __int128 wide;
#else
typedef double wide;
#endif

typedef struct crossing {
    uint32_t row, mesh;
    uint32_t at; /* the first voxel behind it */
    int32_t turn;
} crossing;

typedef struct corner {
    int64_t x, yz[2];
} corner;

static int64_t min_of_three(int64_t a, int64_t b, int64_t c)
{
    const int64_t low = a < b ? a : b;
    return low < c ? low : c;
}

static int64_t ceil_divide(int64_t a, int64_t b)
{
    return a > 0 ? (a + b - 1) / b : -(-a / b);
}

static int64_t clamp(double x, int64_t low, int64_t high)
{
    return x <= (double)low ? low : x >= (double)high ? high : (int64_t)x;
}

/* Returns the first voxel at or behind the place sum / area, in steps of the lattice. */
static size_t voxel_behind(const cwi_voxelize *v, wide sum, int64_t area)
{
    const int64_t end = (int64_t)v->volume->dim[0];
    const double place = (double)sum / (double)area / (double)v->lattice;
    const wide step = (wide)v->lattice * area;
    int64_t i = clamp(ceil(place), 0, end);
    while (i > 0 && (wide)(i - 1) * step >= sum)
        i--;
    while (i < end && (wide)i * step < sum)
        i++;
    return (size_t)i;
}

/* Narrows the rows of layer z that a triangle may cross: from low to high. */
static void narrow_rows(const corner c[3], int64_t z, int64_t lattice, int64_t *low,
                        int64_t *high)
{
    double from = INFINITY, to = -INFINITY;
    for (int n = 0; n < 3; n++) {
        const int64_t *a = c[n].yz, *b = c[(n + 1) % 3].yz;
        if ((a[1] < z && b[1] < z) || (a[1] > z && b[1] > z))
            continue;
        const double t = a[1] == b[1] ? 0 : (double)(z - a[1]) / (double)(b[1] - a[1]);
        const double y = (double)a[0] + t * (double)(b[0] - a[0]);
        from = fmin(from, fmin(y, a[1] == b[1] ? (double)b[0] : y));
        to = fmax(to, fmax(y, a[1] == b[1] ? (double)b[0] : y));
    }
    const double margin = 1e-4; /* rounding is far below it */
    *low = clamp(ceil(from / (double)lattice - margin), *low, *high + 1);
    *high = clamp(floor(to / (double)lattice + margin), *low - 1, *high);
}

/* Stores the crossings of a triangle with the rows of one layer. */
static void cross_layer(cwi_block_rows *r, const corner c[3], size_t mesh, int turn,
                        int64_t layer, int64_t low, int64_t high)
{
    const cwi_voxelize *v = r->v;
    const int64_t z = layer * v->lattice;
    if (high - low > 3)
        narrow_rows(c, z, v->lattice, &low, &high);
    for (int64_t j = low; j <= high; j++) {
        int64_t side[3];
        bool in = true;
        for (int n = 0; n < 3 && in; n++) {
            const int64_t *from = c[(n + 1) % 3].yz, *to = c[(n + 2) % 3].yz;
            side[n] = cwi_row_area(from, to, j * v->lattice, z);
            in = cwi_row_is_left(side[n], from, to);
        }
        if (!in)
            continue;
        const wide sum =
            (wide)side[0] * c[0].x + (wide)side[1] * c[1].x + (wide)side[2] * c[2].x;
        const size_t at = voxel_behind(v, sum, side[0] + side[1] + side[2]);
        crossing *e = at < v->volume->dim[0] ? cwi_row_events_add(&r->events, sizeof *e) : NULL;
        if (e)
            *e =
                (crossing){(uint32_t)(((size_t)layer - r->low) * v->volume->dim[1] + (size_t)j),
                           (uint32_t)mesh, (uint32_t)at, turn};
    }
}

static void cross_triangle(cwi_block_rows *r, size_t triangle, size_t mesh)
{
    const cwi_voxelize *v = r->v;
    const double *points[3];
    corner c[3];
    cwi_voxelize_corners(v, triangle, mesh, points);
    for (int n = 0; n < 3; n++)
        c[n] = (corner){llrint(points[n][0] * (double)v->lattice),
                        {llrint(points[n][1] * (double)v->lattice),
                         llrint(points[n][2] * (double)v->lattice)}};
    const int64_t twice = cwi_row_area(c[0].yz, c[1].yz, c[2].yz[0], c[2].yz[1]);
    if (twice == 0)
        return;
    if (twice < 0) {
        const corner swap = c[1];
        c[1] = c[2];
        c[2] = swap;
    }
    int64_t low[2], high[2];
    const int64_t first[2] = {0, (int64_t)r->low},
                  last[2] = {(int64_t)v->volume->dim[1] - 1, (int64_t)r->high - 1};
    for (int a = 0; a < 2; a++) {
        low[a] = ceil_divide(min_of_three(c[0].yz[a], c[1].yz[a], c[2].yz[a]), v->lattice);
        high[a] = -ceil_divide(min_of_three(-c[0].yz[a], -c[1].yz[a], -c[2].yz[a]), v->lattice);
        low[a] = low[a] > first[a] ? low[a] : first[a];
        high[a] = high[a] < last[a] ? high[a] : last[a];
    }
    for (int64_t k = low[1]; k <= high[1]; k++)
        cross_layer(r, c, mesh, twice > 0 ? -v->turn[mesh] : v->turn[mesh], k, low[0], high[0]);
}

static int compare_crossings(const void *a, const void *b)
{
    const crossing *p = a, *q = b;
    return p->mesh != q->mesh ? (p->mesh > q->mesh) - (p->mesh < q->mesh)
                              : (p->at > q->at) - (p->at < q->at);
}

/* Sorts the crossings of a row by mesh, then by place: most rows have few. */
static void sort_row(crossing *row, size_t count)
{
    enum { FEW = 24 };
    if (count > FEW) {
        qsort(row, count, sizeof *row, compare_crossings);
        return;
    }
    for (size_t n = 1; n < count; n++) {
        const crossing next = row[n];
        size_t m = n;
        for (; m > 0 && compare_crossings(&row[m - 1], &next) > 0; m--)
            row[m] = row[m - 1];
        row[m] = next;
    }
}

/* Sets voxels to a label; returns how many had another one. */
static size_t fill_run(cw_type type, void *voxels, size_t from, size_t to, uint32_t label)
{
    size_t overlapped = 0;
#define FILL(ctype)                                                                            \
    for (size_t i = from; i < to; i++) {                                                       \
        overlapped += ((const ctype *)voxels)[i] != 0;                                         \
        ((ctype *)voxels)[i] = (ctype)label;                                                   \
    }
    if (type == CW_U8)
        FILL(uint8_t)
    else if (type == CW_U16)
        FILL(uint16_t)
    else
        FILL(uint32_t)
#undef FILL
    return overlapped;
}

/* Fills a row from its sorted crossings. Behind the last one the mesh may go on to the border. */
static void fill_row(const cwi_voxelize *v, const crossing *row, size_t count, void *voxels,
                     cwi_voxelize_counts *counts)
{
    const size_t end = v->volume->dim[0];
    int winding = 0;
    for (size_t n = 0; n < count; n++) {
        const size_t mesh = row[n].mesh;
        const bool is_last = n + 1 == count || row[n + 1].mesh != mesh;
        const size_t from = row[n].at, to = is_last ? end : row[n + 1].at;
        winding += row[n].turn;
        if (winding > 0 && to > from) {
            counts[mesh].overlapped +=
                fill_run(v->volume->type, voxels, from, to, v->label[mesh]);
            counts[mesh].voxels += to - from;
        }
        counts[mesh].repeated += winding > 1 ? to - from : 0;
        counts[mesh].negative += winding < 0 ? to - from : 0;
        if (is_last)
            winding = 0;
    }
}

void cwi_voxelize_labels(void *state, size_t block)
{
    cwi_voxelize *v = state;
    const size_t *dim = v->volume->dim, bytes = cw_type_size(v->volume->type);
    cwi_block_rows r;
    const bool ok = cwi_block_rows_fill(&r, v, block, sizeof(crossing), cross_triangle);
    crossing *sorted = r.sorted;
    char *voxels = (char *)cw_volume_voxels(v->volume) + r.low * dim[1] * dim[0] * bytes;
    if (!ok)
        cwi_set_flag(&v->no_memory);
    for (size_t row = 0; row < r.count && ok; row++) {
        const size_t count = r.first[row + 1] - r.first[row];
        sort_row(sorted + r.first[row], count);
        fill_row(v, sorted + r.first[row], count, voxels + row * dim[0] * bytes,
                 v->counts + block * v->count);
    }
    cwi_block_rows_free(&r);
}
