/* Finds voxels within an ellipsoid of others, by exact Euclidean distances [Felzenszwalb2012].
 *
 * Distances along z come first, as bytes. Then each slice is done by itself: along x and y the least
 * of parabolas over all voxels of a row is found in time that does not depend on the radius. */
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/filter/inside.h"

#include <math.h>
#include <string.h>

enum { MAX_RADIUS = 250, FAR = 255 }; /* in voxels; a distance of none */

typedef struct work {
    const uint8_t *from;
    uint8_t *to, value;
    const size_t *dim;
    double weight[3]; /* 1 / radius^2; 0: no reach along the axis */
    bool starved;
} work;

cw_status cwi_check_radius(const double radius[3], cw_error *err)
{
    for (int a = 0; a < 3; a++)
        if (!(radius[a] >= 0 && radius[a] <= MAX_RADIUS))
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "radius_voxels[%d] is %g; 0 to %d were expected", a, radius[a],
                            MAX_RADIUS);
    return CW_OK;
}

/* Sets distances along z to the nearest voxel that counts, for a row of columns. */
static void measure_columns(void *context, size_t j)
{
    const work *k = context;
    const size_t nx = k->dim[0], slice = nx * k->dim[1], nz = k->dim[2];
    for (size_t z = 0; z < nz; z++) {
        const uint8_t *from = k->from + z * slice + j * nx;
        uint8_t *to = k->to + z * slice + j * nx;
        for (size_t i = 0; i < nx; i++) {
            const int before = z ? to[(ptrdiff_t)i - (ptrdiff_t)slice] : FAR;
            to[i] = (uint8_t)(from[i] == k->value ? 0 : before < MAX_RADIUS ? before + 1 : FAR);
        }
    }
    for (size_t z = nz - 1; z-- > 0;) {
        uint8_t *to = k->to + z * slice + j * nx;
        for (size_t i = 0; i < nx; i++) {
            const int behind = to[i + slice];
            if (behind < MAX_RADIUS && behind + 1 < to[i])
                to[i] = (uint8_t)(behind + 1);
        }
    }
}

/* The lowest parabolas of a row: where they stand, and from where on each is the lowest. */
typedef struct envelope {
    size_t *at;
    double *from, *height;
} envelope;

/* Replaces each number f(p) of a row by the least of f(q) + weight (p - q)^2. Numbers above 1 count
 * for none. stride: from one number to the next */
static void spread_row(double *f, size_t stride, size_t count, double weight, const envelope *e)
{
    size_t used = 0;
    if (weight == 0)
        return;
    for (size_t q = 0; q < count; q++) {
        const double height = f[q * stride];
        double from = -INFINITY;
        if (height > 1)
            continue;
        while (used > 0) { /* where the new parabola meets the last one */
            const double a = (double)e->at[used - 1], b = (double)q;
            from = ((height - e->height[used - 1]) / weight + b * b - a * a) / (2 * (b - a));
            if (from > e->from[used - 1])
                break;
            used--;
            from = -INFINITY;
        }
        e->at[used] = q;
        e->from[used] = from;
        e->height[used++] = height;
    }
    for (size_t p = 0, n = 0; p < count && used > 0; p++) {
        while (n + 1 < used && e->from[n + 1] < (double)p)
            n++;
        const double d = (double)p - (double)e->at[n];
        f[p * stride] = e->height[n] + weight * d * d;
    }
}

static void spread_slice(void *context, size_t z)
{
    static const double ROUNDING = 1e-9; /* of a distance in units of the radius */
    work *k = context;
    const size_t nx = k->dim[0], ny = k->dim[1], longest = nx > ny ? nx : ny;
    uint8_t *to = k->to + z * nx * ny;
    double *plane = cwi_alloc_array(nx * ny + 3 * longest, sizeof *plane);
    if (!plane) {
        cwi_set_flag(&k->starved);
        return;
    }
    const envelope e = {.from = plane + nx * ny,
                        .height = plane + nx * ny + longest,
                        .at = (size_t *)(plane + nx * ny + 2 * longest)};
    for (size_t n = 0; n < nx * ny; n++) {
        const double d = to[n];
        plane[n] = to[n] == 0                          ? 0
                   : to[n] == FAR || k->weight[2] == 0 ? 2
                                                       : k->weight[2] * d * d;
        plane[n] = plane[n] > 1 && plane[n] <= 1 + ROUNDING ? 1 : plane[n];
    }
    for (size_t j = 0; j < ny; j++)
        spread_row(plane + j * nx, 1, nx, k->weight[0], &e);
    for (size_t i = 0; i < nx; i++)
        spread_row(plane + i, nx, ny, k->weight[1], &e);
    for (size_t n = 0; n < nx * ny; n++)
        to[n] = plane[n] <= 1 + ROUNDING;
    cwi_free(plane);
}

cw_status cwi_spread_bytes(const uint8_t *from, uint8_t value, const size_t dim[3],
                           const double radius[3], const cw_filter_desc *desc, uint8_t *to,
                           cw_error *err)
{
    work k = {.from = from, .to = to, .value = value, .dim = dim};
    for (int a = 0; a < 3; a++)
        k.weight[a] = radius[a] > 0 ? 1 / (radius[a] * radius[a]) : 0;
    cw_status st = cwi_parallel_for(dim[1], dim[0] * dim[2], desc->threads, &desc->progress,
                                    "measuring distances", measure_columns, &k, err);
    if (st == CW_OK)
        st = cwi_parallel_for(dim[2], 8 * dim[0] * dim[1], desc->threads, &desc->progress,
                              "measuring distances", spread_slice, &k, err);
    if (st == CW_OK && k.starved)
        st = cwi_fail_memory(err);
    return st;
}
