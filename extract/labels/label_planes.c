/* Tells triangles apart by the sides of planes, in double precision with a bound of its errors. Most
 * pairs need no exact test. */
#include "extract/labels/label_planes.h"

#include "core/geometry/vec3.h"

#include <math.h>

/* Bounds the rounding error of a determinant of differences of floats, relative to the product of
 * the sums of its rows' absolute values: ten times what doubles need. */
static const double ERROR_FRACTION = 1e-14;

/* Sides of a plane, as bits; a corner in common has none, and one that may be on either has both. */
enum { ABOVE = 1, BELOW = 2 };

void cwi_label_planes_load(cwi_label_planes *p, const cwi_label_net *net, const cw_mesh *mesh,
                           size_t first)
{
    p->count = cwi_polygon_corners(net, mesh, first, p->corners);
    p->has_normals = false;
    for (int n = 0; n < p->count; n++) {
        const float *from = mesh->positions + 3 * (size_t)p->corners[n];
        for (int a = 0; a < 3; a++) {
            p->points[n][a] = (double)from[a];
            p->low[a] = n == 0 || from[a] < p->low[a] ? from[a] : p->low[a];
            p->high[a] = n == 0 || from[a] > p->high[a] ? from[a] : p->high[a];
        }
    }
}

static double sum_sizes(const double v[3])
{
    return fabs(v[0]) + fabs(v[1]) + fabs(v[2]);
}

static void find_normals(cwi_label_planes *p)
{
    double side[3], next[3];
    if (p->has_normals)
        return;
    p->has_normals = true;
    cwi_sub(p->points[1], p->points[0], side);
    for (int t = 0; t + 2 < p->count; t++) {
        cwi_sub(p->points[t + 2], p->points[0], next);
        cwi_cross(side, next, p->normals[t]);
        p->errors[t] = ERROR_FRACTION * sum_sizes(side) * sum_sizes(next);
        for (int a = 0; a < 3; a++)
            side[a] = next[a];
    }
}

/* Finds the sides of a polygon's corners of the plane of a triangle of another one. */
static void find_sides(const cwi_label_planes *of, int triangle, const cwi_label_planes *p,
                       double extent, int sides[CWI_POLYGON_CORNERS])
{
    const uint32_t a = of->corners[0], b = of->corners[triangle + 1],
                   c = of->corners[triangle + 2];
    const double *normal = of->normals[triangle], *at = of->points[0],
                 error = of->errors[triangle] * extent;
    for (int n = 0; n < p->count; n++) {
        const uint32_t v = p->corners[n];
        const double height = normal[0] * (p->points[n][0] - at[0]) +
                              normal[1] * (p->points[n][1] - at[1]) +
                              normal[2] * (p->points[n][2] - at[2]);
        sides[n] = v == a || v == b || v == c ? 0
                   : height > error           ? ABOVE
                   : height < -error          ? BELOW
                                              : ABOVE | BELOW;
    }
}

/* Returns true if a triangle with such sides is on one side, or has corners in common there. */
static bool is_on_one_side(const int sides[CWI_POLYGON_CORNERS], int triangle)
{
    const int all = sides[0] | sides[triangle + 1] | sides[triangle + 2];
    return all == ABOVE || all == BELOW;
}

/* Finds whether two boxes are apart. Returns a bound for the distance of points in them, by axes. */
static double find_extent(const cwi_label_planes *one, const cwi_label_planes *other,
                          bool *are_apart)
{
    double extent = 0;
    *are_apart = false;
    for (int a = 0; a < 3; a++) {
        const float low = one->low[a] < other->low[a] ? one->low[a] : other->low[a];
        const float high = one->high[a] > other->high[a] ? one->high[a] : other->high[a];
        *are_apart = *are_apart || one->low[a] > other->high[a] || other->low[a] > one->high[a];
        extent += (double)high - (double)low;
    }
    return extent;
}

uint64_t cwi_label_planes_pairs(cwi_label_planes *one, cwi_label_planes *other)
{
    int sides[CWI_POLYGON_CORNERS];
    uint64_t pairs = 0;
    bool are_apart;
    const double extent = find_extent(one, other, &are_apart);
    if (are_apart)
        return 0;
    find_normals(one);
    for (int s = 0; s + 2 < one->count; s++) {
        find_sides(one, s, other, extent, sides);
        for (int t = 0; t + 2 < other->count; t++)
            if (!is_on_one_side(sides, t))
                pairs |= (uint64_t)1 << (8 * s + t);
    }
    if (pairs == 0)
        return 0;
    find_normals(other);
    for (int t = 0; t + 2 < other->count; t++) {
        find_sides(other, t, one, extent, sides);
        for (int s = 0; s + 2 < one->count; s++)
            if (is_on_one_side(sides, s))
                pairs &= ~((uint64_t)1 << (8 * s + t));
    }
    return pairs;
}

bool cwi_label_planes_has_area(cwi_label_planes *p, int triangle)
{
    find_normals(p);
    const double *n = p->normals[triangle], error = p->errors[triangle];
    return fabs(n[0]) > error || fabs(n[1]) > error || fabs(n[2]) > error;
}
