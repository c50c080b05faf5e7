/* Spreads directions over a half sphere in a golden spiral, and finds the nearest by a map of
 * candidates on an octahedron. */
#include "viewer/proxy/quantized_normals.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"

#include <math.h>

void cwi_directions_free(cwi_directions *d)
{
    cwi_free(d->all);
    cwi_free(d->first);
    cwi_free(d->candidates);
    *d = (cwi_directions){0};
}

static void place_directions(cwi_directions *d)
{
    const double golden = CWI_PI * (3 - sqrt(5));
    for (size_t n = 0; n < d->count; n++) {
        const double z = 1 - ((double)n + 0.5) / (double)d->count, r = sqrt(1 - z * z);
        d->all[n][0] = r * cos(golden * (double)n);
        d->all[n][1] = r * sin(golden * (double)n);
        d->all[n][2] = z;
    }
}

/* Converts a point of the map, 0 to 1 along each side: the upper half of an octahedron, seen
 * from above and turned by 45 degrees. */
static void unfold_octahedron(double u, double v, double out[3])
{
    const double x = u + v - 1, y = u - v;
    out[0] = x;
    out[1] = y;
    out[2] = 1 - fabs(x) - fabs(y);
    const double length = cwi_length(out);
    for (int a = 0; a < 3; a++)
        out[a] /= length;
}

static size_t part_of(double x, size_t edge)
{
    const double part = floor(x * (double)edge);
    return part < 0 ? 0 : part < (double)edge ? (size_t)part : edge - 1;
}

/* Finds the cell of a vector's line; returns false if the vector has no direction. */
static bool cell_of(const cwi_directions *d, const double v[3], size_t *cell)
{
    const double sum = fabs(v[0]) + fabs(v[1]) + fabs(v[2]);
    if (!(sum > 0) || !isfinite(sum))
        return false;
    const double sign = v[2] < 0 ? -1 : 1;
    const double x = sign * v[0] / sum, y = sign * v[1] / sum;
    *cell = part_of((x - y + 1) / 2, d->edge) * d->edge + part_of((x + y + 1) / 2, d->edge);
    return true;
}

/* Returns the angle between lines. */
static double angle_between(const double a[3], const double b[3])
{
    return acos(fmin(fabs(cwi_dot(a, b)), 1));
}

/* Finds a circle around a cell. The map's straight lines become great circles, so a cell is
 * inside the circle around its corners. */
static void circle_of(const cwi_directions *d, size_t cell, double middle[3], double *radius)
{
    const double edge = (double)d->edge;
    const double u = (double)(cell % d->edge), v = (double)(cell / d->edge);
    double corner[3];
    unfold_octahedron((u + 0.5) / edge, (v + 0.5) / edge, middle);
    *radius = 0;
    for (int n = 0; n < 4; n++) {
        unfold_octahedron((u + (n & 1)) / edge, (v + (n >> 1)) / edge, corner);
        *radius = fmax(*radius, angle_between(middle, corner));
    }
}

/* Returns the angle between the middle of a cell and the nearest direction. */
static double nearest_angle(const cwi_directions *d, const double v[3])
{
    double max = 0;
    for (size_t n = 0; n < d->count; n++)
        max = fmax(max, fabs(cwi_dot(d->all[n], v)));
    return acos(fmin(max, 1));
}

/* Lists, or counts when to is NULL, the directions that may be nearest to a point of a cell.
 * None is farther from the cell's middle than the middle's nearest, plus twice the radius:
 * angles between lines add up at most. */
static size_t put_candidates(const cwi_directions *d, size_t cell, uint16_t *to)
{
    double middle[3], radius;
    size_t count = 0;
    circle_of(d, cell, middle, &radius);
    const double min_cosine = cos(fmin(nearest_angle(d, middle) + 2 * radius + 1e-9, acos(0)));
    for (size_t n = 0; n < d->count; n++)
        if (fabs(cwi_dot(d->all[n], middle)) >= min_cosine) {
            if (to)
                to[count] = (uint16_t)n;
            count++;
        }
    return count;
}

enum { WORK = 4 }; /* of a direction, in samples */

static void count_candidates(void *context, size_t cell)
{
    const cwi_directions *d = context;
    d->first[cell + 1] = (uint32_t)put_candidates(d, cell, NULL);
}

static void list_candidates(void *context, size_t cell)
{
    const cwi_directions *d = context;
    put_candidates(d, cell, d->candidates + d->first[cell]);
}

/* Makes the map, with about as many cells as directions. */
static cw_status make_map(cwi_directions *d, cw_error *err)
{
    const size_t cells = d->edge * d->edge;
    d->first = cwi_alloc_zeroed(cells + 1, sizeof *d->first);
    if (!d->first)
        return cwi_fail_memory(err);
    cwi_parallel_for_all(cells, WORK * d->count, 0, count_candidates, d);
    for (size_t n = 0; n < cells; n++)
        d->first[n + 1] += d->first[n];
    d->candidates = cwi_alloc_array(d->first[cells], sizeof *d->candidates);
    if (!d->candidates)
        return cwi_fail_memory(err);
    cwi_parallel_for_all(cells, WORK * d->count, 0, list_candidates, d);
    return CW_OK;
}

cw_status cwi_directions_make(size_t count, cwi_directions *directions, cw_error *err)
{
    cwi_directions *d = directions;
    *d = (cwi_directions){.count = count};
    if (count < 1 || count > CWI_MAX_DIRECTIONS)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%zu directions of gradients: expected 1 to %d",
                        count, CWI_MAX_DIRECTIONS);
    d->edge = (size_t)ceil(sqrt((double)count));
    d->all = cwi_alloc_array(count, sizeof *d->all);
    if (d->all)
        place_directions(d);
    cw_status st = d->all ? make_map(d, err) : cwi_fail_memory(err);
    if (st != CW_OK)
        cwi_directions_free(d);
    return st;
}

size_t cwi_directions_nearest(const cwi_directions *d, const double v[3])
{
    size_t cell, best;
    double max_cosine = -1;
    if (!cell_of(d, v, &cell))
        return d->count;
    best = d->candidates[d->first[cell]];
    for (uint32_t n = d->first[cell]; n < d->first[cell + 1]; n++) {
        const double cosine = fabs(cwi_dot(d->all[d->candidates[n]], v));
        if (cosine > max_cosine) {
            max_cosine = cosine;
            best = d->candidates[n];
        }
    }
    return best;
}
