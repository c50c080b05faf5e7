/* Tells triangles apart by the sides of planes, in double precision with a bound of its errors. Most
 * pairs need no exact test. */
#include "extract/labels/label_planes.h"

#include "core/geometry/vec3.h"

#include <math.h>

/* Bounds the rounding error of a determinant of differences of floats, relative to the product of
 * the sums of its rows' absolute values: ten times what doubles need. */
static const double ERROR_FRACTION = 1e-14;

enum { QUAD = 4 };

/* Returns the number of corners that are computed with: the same for most polygons. */
static int padded_count(const cwi_label_planes *p)
{
    return p->count <= QUAD ? QUAD : CWI_POLYGON_CORNERS;
}

void cwi_label_planes_load(cwi_label_planes *p, const cwi_label_net *net, const cw_mesh *mesh,
                           size_t first)
{
    p->count = cwi_polygon_corners(net, mesh, first, p->corners);
    p->has_normals = false;
    const int padded = padded_count(p);
    for (int n = 0; n < padded; n++) {
        const float *from = mesh->positions + 3 * (size_t)p->corners[n < p->count ? n : 0];
        for (int a = 0; a < 3; a++) {
            p->points[a][n] = (double)from[a];
            p->low[a] = n == 0 || from[a] < p->low[a] ? from[a] : p->low[a];
            p->high[a] = n == 0 || from[a] > p->high[a] ? from[a] : p->high[a];
        }
    }
}

static double sum_sizes(const double v[3])
{
    return fabs(v[0]) + fabs(v[1]) + fabs(v[2]);
}

/* Computes the way from corner 0 to another one. */
static void find_way(const cwi_label_planes *p, int corner, double way[3])
{
    for (int a = 0; a < 3; a++)
        way[a] = p->points[a][corner] - p->points[a][0];
}

static void find_normals(cwi_label_planes *p)
{
    double side[3], next[3];
    if (p->has_normals)
        return;
    p->has_normals = true;
    find_way(p, 1, side);
    for (int t = 0; t + 2 < p->count; t++) {
        find_way(p, t + 2, next);
        cwi_cross(side, next, p->normals[t]);
        p->errors[t] = ERROR_FRACTION * sum_sizes(side) * sum_sizes(next);
        for (int a = 0; a < 3; a++)
            side[a] = next[a];
    }
}

/* Returns the corners of a triangle, as bits. */
static uint32_t corners_of(int triangle)
{
    return 1u | 3u << (triangle + 1);
}

/* Corners of a polygon that are on the sides of a plane, as bits; others may be on either. */
typedef struct plane_sides {
    uint32_t above, below;
} plane_sides;

/* Finds the sides of a polygon's corners of the plane of a triangle of another one. */
static plane_sides find_sides(const cwi_label_planes *of, int triangle,
                              const cwi_label_planes *p, double extent)
{
    double heights[CWI_POLYGON_CORNERS];
    const double *normal = of->normals[triangle], error = of->errors[triangle] * extent;
    const double x = of->points[0][0], y = of->points[1][0], z = of->points[2][0];
    const int padded = padded_count(p);
    for (int n = 0; n < padded; n++)
        heights[n] = normal[0] * (p->points[0][n] - x) + normal[1] * (p->points[1][n] - y) +
                     normal[2] * (p->points[2][n] - z);
    plane_sides sides = {0, 0};
    for (int n = 0; n < padded; n++) {
        sides.above |= (uint32_t)(heights[n] > error) << n;
        sides.below |= (uint32_t)(heights[n] < -error) << n;
    }
    return sides;
}

/* Returns true if a triangle is on one side, but for corners in common with the plane's. */
static bool is_on_one_side(plane_sides sides, int triangle, uint32_t common)
{
    const uint32_t others = corners_of(triangle) & ~common;
    return others && ((sides.above & others) == others || (sides.below & others) == others);
}

/* Finds the corners of a polygon, as bits, that are corners of a triangle of another one. */
static uint32_t find_common(const cwi_label_planes *of, int triangle, const cwi_label_planes *p)
{
    const uint32_t a = of->corners[0], b = of->corners[triangle + 1],
                   c = of->corners[triangle + 2];
    uint32_t common = 0;
    for (int n = 0; n < p->count; n++) {
        const uint32_t v = p->corners[n];
        common |= (uint32_t)((v == a) | (v == b) | (v == c)) << n;
    }
    return common;
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
    uint64_t pairs = 0;
    bool are_apart;
    const double extent = find_extent(one, other, &are_apart);
    if (are_apart)
        return 0;
    find_normals(one);
    for (int s = 0; s + 2 < one->count; s++) {
        const plane_sides sides = find_sides(one, s, other, extent);
        const uint32_t common = find_common(one, s, other);
        for (int t = 0; t + 2 < other->count; t++)
            if (!is_on_one_side(sides, t, common))
                pairs |= (uint64_t)1 << (8 * s + t);
    }
    if (pairs == 0)
        return 0;
    find_normals(other);
    for (int t = 0; t + 2 < other->count; t++) {
        const plane_sides sides = find_sides(other, t, one, extent);
        const uint32_t common = find_common(other, t, one);
        for (int s = 0; s + 2 < one->count; s++)
            if (is_on_one_side(sides, s, common))
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
