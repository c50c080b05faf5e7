// From triangle to triangle of an original, to where a point is near.
#ifndef SIMPLIFY_COLLAPSE_SURFACE_WALK_HPP
#define SIMPLIFY_COLLAPSE_SURFACE_WALK_HPP

#include "simplify/collapse/openmesh_wrap.h"

#include <vector>

namespace cw
{

class Walk
{
public:
    Walk(const cwi_original *original_, uint32_t start, float distance)
        : original(original_), at(start), square(double(distance) * double(distance))
    {
    }

    // Whether all of a triangle certainly is within the distance.
    bool is_near(const float *const corners[3]);

    // Triangles that pieces of it were held against, some more than once.
    std::vector<uint32_t> passed;

private:
    static double nearest(void *walk, const double p[3], const float *facet[3]);

    const uint32_t *around(uint32_t point) const
    {
        return original->around + original->first[point];
    }

    const uint32_t *around_end(uint32_t point) const
    {
        return original->around + original->first[point + 1];
    }

    const uint32_t *corners(uint32_t triangle) const
    {
        return original->corners + 3 * size_t(triangle);
    }

    void find(uint32_t triangle, const float *facet[3]) const;
    double square_from(uint32_t triangle, const double p[3]) const;
    double go(const double p[3]);
    bool step(const double p[3], double *least);
    bool cross(const uint32_t side[2], const double p[3], double *least);
    bool jump(const double p[3], double *least);
    bool take_nearer(uint32_t triangle, const double p[3], double *least);

    const cwi_original *original;
    uint32_t at;   // the triangle gone to last
    double square; // of the distance
};

} // namespace cw

#endif
