/* Finds by exact integer arithmetic where rows of a grid cross a mesh, and counts windings
 * along them. */
#include "extract/level_set/winding_rows.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/triangle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Vertices are moved, across the rows, to a grid so fine that the change is invisible, and so
 * coarse that integers decide exactly which triangles a row meets. Then no row slips through
 * between two triangles, and the mesh is left as often as it is entered. */
enum { FINE = 1 << 14 };

typedef struct corner {
    double x;
    int64_t yz[2];
} corner;

typedef struct mapping {
    const cw_mesh *mesh;
    const double *first;
    double voxel_mm;
} mapping;

static corner corner_of(const mapping *m, uint32_t vertex)
{
    const float *p = m->mesh->positions + 3 * (size_t)vertex;
    double at[3];
    for (int a = 0; a < 3; a++)
        at[a] = ((double)p[a] - m->first[a]) / m->voxel_mm;
    return (corner){at[0], {llrint(at[1] * FINE), llrint(at[2] * FINE)}};
}

static int64_t ceil_div(int64_t a)
{
    return a > 0 ? (a + FINE - 1) / FINE : a / FINE;
}

static int64_t min_of_three(int64_t a, int64_t b, int64_t c)
{
    const int64_t low = a < b ? a : b;
    return low < c ? low : c;
}

/* Finds the rows that a triangle crosses: counts the crossings, or, with `keep`, stores
 * them. */
static void cross_rows(cwi_winding *w, const corner c[3], int turn, bool keep)
{
    const int64_t low_y = ceil_div(min_of_three(c[0].yz[0], c[1].yz[0], c[2].yz[0])),
                  low_z = ceil_div(min_of_three(c[0].yz[1], c[1].yz[1], c[2].yz[1])),
                  high_y = -ceil_div(min_of_three(-c[0].yz[0], -c[1].yz[0], -c[2].yz[0])),
                  high_z = -ceil_div(min_of_three(-c[0].yz[1], -c[1].yz[1], -c[2].yz[1]));
    for (int64_t k = low_z; k <= high_z; k++)
        for (int64_t j = low_y; j <= high_y; j++) {
            int64_t side[3];
            bool in = true;
            for (int n = 0; n < 3 && in; n++) {
                const int64_t *from = c[(n + 1) % 3].yz, *to = c[(n + 2) % 3].yz;
                side[n] = cwi_row_area(from, to, j * FINE, k * FINE);
                in = cwi_row_is_left(side[n], from, to);
            }
            if (!in)
                continue;
            size_t *slot = &w->first[(size_t)k * w->rows_y + (size_t)j];
            if (keep) {
                const double all = (double)side[0] + (double)side[1] + (double)side[2];
                w->cross[*slot].x = ((double)side[0] * c[0].x + (double)side[1] * c[1].x +
                                     (double)side[2] * c[2].x) /
                                    all;
                w->cross[*slot].turn = turn;
            }
            ++*slot;
        }
}

/* Visits all triangles. Rows leave the mesh through those that run counter-clockwise, seen from
 * high x. */
static void each_triangle(cwi_winding *w, const mapping *m, bool keep)
{
    for (size_t t = 0; t < m->mesh->triangle_count; t++) {
        corner c[3];
        for (int n = 0; n < 3; n++)
            c[n] = corner_of(m, m->mesh->triangles[3 * t + (size_t)n]);
        const int64_t twice = cwi_row_area(c[0].yz, c[1].yz, c[2].yz[0], c[2].yz[1]);
        if (twice < 0) {
            const corner swap = c[1];
            c[1] = c[2];
            c[2] = swap;
        }
        if (twice != 0)
            cross_rows(w, c, twice > 0 ? -1 : 1, keep);
    }
}

/* Turns counts into first numbers; the last is the total. */
static size_t sum_rows(cwi_winding *w, size_t rows)
{
    size_t sum = 0;
    for (size_t n = 0; n <= rows; n++) {
        const size_t count = n < rows ? w->first[n] : 0;
        w->first[n] = sum;
        sum += count;
    }
    return sum;
}

static int compare_crossings(const void *a, const void *b)
{
    const double x = ((const cwi_row_crossing *)a)->x, y = ((const cwi_row_crossing *)b)->x;
    return (x > y) - (x < y);
}

cw_status cwi_winding_init(cwi_winding *w, const cw_mesh *mesh, const double first[3],
                           double voxel_mm, const size_t dim[3], cw_error *err)
{
    const mapping m = {mesh, first, voxel_mm};
    const size_t rows = dim[1] * dim[2];
    *w = (cwi_winding){.rows_y = dim[1], .rows_z = dim[2]};
    w->first = cwi_alloc_zeroed(rows + 1, sizeof *w->first);
    if (!w->first)
        return cwi_fail_memory(err);
    each_triangle(w, &m, false);
    const size_t all = sum_rows(w, rows);
    w->cross = cwi_alloc_array(all, sizeof *w->cross);
    if (!w->cross)
        return cwi_fail_memory(err);
    each_triangle(w, &m, true);
    memmove(w->first + 1, w->first, rows * sizeof *w->first); /* each is now where the next row
                                                                 began */
    w->first[0] = 0;
    for (size_t n = 0; n < rows; n++)
        if (w->first[n + 1] - w->first[n] > 1)
            qsort(w->cross + w->first[n], w->first[n + 1] - w->first[n], sizeof *w->cross,
                  compare_crossings);
    return CW_OK;
}

void cwi_winding_free(cwi_winding *w)
{
    cwi_free(w->first);
    cwi_free(w->cross);
    *w = (cwi_winding){0};
}

void cwi_winding_row(const cwi_winding *w, size_t i, size_t j, size_t k, size_t count,
                     bool *inside)
{
    memset(inside, 0, count * sizeof *inside);
    if (j >= w->rows_y || k >= w->rows_z)
        return;
    const cwi_row_crossing *c = w->cross + w->first[k * w->rows_y + j],
                           *end = w->cross + w->first[k * w->rows_y + j + 1];
    int around = 0;
    for (size_t n = 0; n < count; n++) {
        for (; c < end && c->x < (double)(i + n); c++)
            around += c->turn;
        inside[n] = around > 0;
    }
}
