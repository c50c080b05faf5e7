// Walks over the triangles of an original, across sides and corners, to the triangle nearest to
// a point.
#include "simplify/collapse/surface_walk.hpp"

#include "core/geometry/triangle_cover.h"

namespace cw
{

bool Walk::is_near(const float *const corners[3])
{
    cwi_cover cover = {nearest, this, square, {}};
    double p[3][3];
    for (int n = 0; n < 3; n++)
        for (int k = 0; k < 3; k++)
            p[n][k] = double(corners[n][k]);
    return cwi_is_covered(&cover, p);
}

double Walk::nearest(void *walk, const double p[3], const float *facet[3])
{
    Walk *w = static_cast<Walk *>(walk);
    const double least = w->go(p);
    w->find(w->at, facet);
    w->passed.push_back(w->at);
    return least;
}

void Walk::find(uint32_t triangle, const float *facet[3]) const
{
    for (int k = 0; k < 3; k++)
        facet[k] = original->points + 3 * size_t(corners(triangle)[k]);
}

double Walk::square_from(uint32_t triangle, const double p[3]) const
{
    const float *facet[3];
    find(triangle, facet);
    return cwi_facet_square(facet[0], facet[1], facet[2], p);
}

// Over sides as far as that helps. Folds of the surface can keep the nearest triangle out of
// sight: if what was found is too far, those at corners are looked at, too.
double Walk::go(const double p[3])
{
    double least = square_from(at, p);
    while (step(p, &least)) {
    }
    while (least > square && jump(p, &least)) {
    }
    return least;
}

// Over a side that the point is beyond.
bool Walk::step(const double p[3], double *least)
{
    const float *f[3];
    find(at, f);
    const cwi_facet_view view = cwi_facet_look(f[0], f[1], f[2], p);
    const uint32_t *c = corners(at), sides[3][2] = {{c[0], c[1]}, {c[1], c[2]}, {c[2], c[0]}};
    return (view.in_c < 0 && cross(sides[0], p, least)) ||
           (view.in_a < 0 && cross(sides[1], p, least)) ||
           (view.in_b < 0 && cross(sides[2], p, least));
}

bool Walk::cross(const uint32_t side[2], const double p[3], double *least)
{
    for (const uint32_t *t = around(side[0]); t < around_end(side[0]); t++) {
        const uint32_t *c = corners(*t);
        if (*t != at && (c[0] == side[1] || c[1] == side[1] || c[2] == side[1]) &&
            take_nearer(*t, p, least))
            return true;
    }
    return false;
}

// To the nearest triangle at a corner.
bool Walk::jump(const double p[3], double *least)
{
    const uint32_t start = at;
    for (int k = 0; k < 3; k++) {
        const uint32_t corner = corners(start)[k];
        for (const uint32_t *t = around(corner); t < around_end(corner); t++)
            take_nearer(*t, p, least);
    }
    return at != start;
}

bool Walk::take_nearer(uint32_t triangle, const double p[3], double *least)
{
    const double s = square_from(triangle, p);
    if (!(s < *least))
        return false;
    *least = s;
    at = triangle;
    return true;
}

} // namespace cw
