/* Distances in a section: to its border, and to where the material beside it is too thin. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "simplify/pieces/section_map.h"

#include <math.h>
#include <string.h>

/* Sides of the polygon that stands for the circle around a hole: it contains the circle. */
enum { CIRCLE_SIDES = 32 };

/* --- cells -------------------------------------------------------------------------------- */

/* Replaces f by min over q of (p - q)^2 + f(q): the lower envelope of parabolas. at, start: count + 1 */
static void spread_row(double *f, size_t count, size_t stride, double *row, size_t *at,
                       double *start)
{
    size_t k = 0;
    for (size_t q = 0; q < count; q++)
        row[q] = f[q * stride];
    at[0] = 0;
    start[0] = -INFINITY;
    start[1] = INFINITY;
    for (size_t q = 1; q < count; q++) {
        double s;
        for (;; k--) {
            const double a = (double)q, b = (double)at[k];
            s = (row[q] + a * a - row[at[k]] - b * b) / (2 * (a - b));
            if (s > start[k])
                break;
        }
        at[++k] = q;
        start[k] = s;
        start[k + 1] = INFINITY;
    }
    for (size_t q = 0, n = 0; q < count; q++) {
        while (start[n + 1] < (double)q)
            n++;
        const double d = (double)q - (double)at[n];
        f[q * stride] = d * d + row[at[n]];
    }
}

/* Returns true if a triangle may be above a cell: none of its sides has the whole cell outside. */
static bool covers_cell(const cwi_near_triangle *t, const double middle[2], double cell)
{
    double area = 0;
    for (int k = 0; k < 3; k++) {
        const double *a = t->p[k], *b = t->p[(k + 1) % 3];
        area += a[0] * b[1] - a[1] * b[0];
    }
    for (int k = 0; k < 3; k++) {
        const double *a = t->p[k], *b = t->p[(k + 1) % 3];
        const double e =
            (b[0] - a[0]) * (middle[1] - a[1]) - (b[1] - a[1]) * (middle[0] - a[0]);
        const double slack = cell / 2 * (fabs(b[0] - a[0]) + fabs(b[1] - a[1]));
        if ((area >= 0 ? e : -e) < -slack)
            return false;
    }
    return true;
}

/* Blocks the cells that a triangle may be above. */
static void block_triangle(cwi_section_map *map, const cwi_near_triangle *t)
{
    size_t from[2], to[2];
    const size_t counts[2] = {map->nx, map->ny};
    for (int a = 0; a < 2; a++) {
        const double low = fmin(fmin(t->p[0][a], t->p[1][a]), t->p[2][a]) - map->corner[a];
        const double high = fmax(fmax(t->p[0][a], t->p[1][a]), t->p[2][a]) - map->corner[a];
        const double last = (double)counts[a] - 1;
        from[a] = (size_t)fmin(fmax(floor(low / map->cell), 0), last);
        to[a] = (size_t)fmin(fmax(floor(high / map->cell), 0), last);
    }
    for (size_t y = from[1]; y <= to[1]; y++)
        for (size_t x = from[0]; x <= to[0]; x++) {
            double middle[2];
            cwi_cell_middle(map, y * map->nx + x, middle);
            if (covers_cell(t, middle, map->cell))
                map->distance_sq[y * map->nx + x] = 0;
        }
}

cw_status cwi_section_map_measure(cwi_section_map *map, const double depth[2], cw_error *err)
{
    const size_t cells = map->nx * map->ny, longest = map->nx > map->ny ? map->nx : map->ny;
    const double far = 4.0 * (double)longest * (double)longest;
    if (!map->distance_sq)
        map->distance_sq = cwi_alloc_array(cells, sizeof *map->distance_sq);
    double *row = cwi_alloc_array(2 * longest + 2, sizeof *row);
    size_t *at = cwi_alloc_array(longest + 1, sizeof *at);
    if (!map->distance_sq || !row || !at) {
        cwi_free(row);
        cwi_free(at);
        return cwi_fail_memory(err);
    }
    for (size_t n = 0; n < cells; n++)
        map->distance_sq[n] = map->region[n] ? far : 0;
    for (int side = 0; side < 2; side++)
        for (size_t n = 0; n < map->near_count[side]; n++)
            if (map->near[side][n].low < depth[side])
                block_triangle(map, &map->near[side][n]);
    for (size_t y = 0; y < map->ny; y++)
        spread_row(map->distance_sq + y * map->nx, map->nx, 1, row, at, row + longest);
    for (size_t x = 0; x < map->nx; x++)
        spread_row(map->distance_sq + x, map->ny, map->nx, row, at, row + longest);
    cwi_free(row);
    cwi_free(at);
    return CW_OK;
}

/* --- points ------------------------------------------------------------------------------- */

double cwi_border_distance(const cwi_section_map *map, uint32_t region, const double p[2])
{
    double least = INFINITY;
    for (size_t n = map->border_start[region]; n < map->border_start[region + 1]; n++) {
        const double *e = map->border[n];
        const double d[2] = {e[2] - e[0], e[3] - e[1]}, w[2] = {p[0] - e[0], p[1] - e[1]};
        const double length_sq = d[0] * d[0] + d[1] * d[1];
        double t = length_sq > 0 ? (w[0] * d[0] + w[1] * d[1]) / length_sq : 0;
        t = t < 0 ? 0 : t > 1 ? 1 : t;
        const double x = w[0] - t * d[0], y = w[1] - t * d[1];
        least = cwi_lesser(least, x * x + y * y);
    }
    return sqrt(least);
}

double cwi_leave_border(const cwi_section_map *map, uint32_t region, double p[2])
{
    double best = cwi_border_distance(map, region, p);
    double step = map->cell;
    for (int n = 0; n < 24 && step > map->cell / 64; n++) {
        double found[2] = {p[0], p[1]};
        for (int k = 0; k < 8; k++) {
            const double angle = CWI_PI / 4 * k;
            const double q[2] = {p[0] + step * cos(angle), p[1] + step * sin(angle)};
            const double d = cwi_border_distance(map, region, q);
            if (d > best) {
                best = d;
                memcpy(found, q, sizeof q);
            }
        }
        if (found[0] == p[0] && found[1] == p[1])
            step /= 2;
        memcpy(p, found, sizeof found);
    }
    return best;
}

/* Clips a polygon to the side of a line on which normal . x <= offset. Returns its new count. */
static int clip_side(double (*p)[3], int count, const double normal[2], double offset)
{
    double out[CIRCLE_SIDES + 4][3];
    int kept = 0;
    for (int n = 0; n < count; n++) {
        const double *a = p[n], *b = p[(n + 1) % count];
        const double da = normal[0] * a[0] + normal[1] * a[1] - offset,
                     db = normal[0] * b[0] + normal[1] * b[1] - offset;
        if (da <= 0)
            memcpy(out[kept++], a, sizeof *out);
        if ((da < 0 && db > 0) || (da > 0 && db < 0)) {
            cwi_lerp(a, b, da / (da - db), out[kept]);
            kept++;
        }
    }
    memcpy(p, out, (size_t)kept * sizeof *out);
    return kept;
}

double cwi_section_depth(const cwi_section_map *map, int side, const double p[2], double radius)
{
    double least = INFINITY;
    for (size_t n = 0; n < map->near_count[side]; n++) {
        const cwi_near_triangle *t = &map->near[side][n];
        double polygon[CIRCLE_SIDES + 4][3];
        int count = 3;
        bool is_far = t->low >= least;
        for (int a = 0; a < 2 && !is_far; a++)
            is_far = fmin(fmin(t->p[0][a], t->p[1][a]), t->p[2][a]) > p[a] + radius ||
                     fmax(fmax(t->p[0][a], t->p[1][a]), t->p[2][a]) < p[a] - radius;
        if (is_far)
            continue;
        memcpy(polygon, t->p, sizeof t->p);
        for (int k = 0; k < CIRCLE_SIDES && count; k++) {
            const double angle = 2 * CWI_PI / CIRCLE_SIDES * k;
            const double normal[2] = {cos(angle), sin(angle)};
            count =
                clip_side(polygon, count, normal, normal[0] * p[0] + normal[1] * p[1] + radius);
        }
        for (int k = 0; k < count; k++)
            least = cwi_lesser(least, polygon[k][2]);
    }
    return least;
}
