// Quadrics about their own vertex, so that single precision is enough: nothing large cancels.
#ifndef SIMPLIFY_COLLAPSE_QUADRIC_HPP
#define SIMPLIFY_COLLAPSE_QUADRIC_HPP

#include "simplify/collapse/openmesh_wrap.h"

#include <OpenMesh/Core/Geometry/VectorT.hh>

#include <algorithm>

namespace cw
{

using Vec = OpenMesh::Vec3f;

inline Vec times(const cwi_quadric &q, const Vec &d)
{
    return {q.a[0] * d[0] + q.a[1] * d[1] + q.a[2] * d[2],
            q.a[1] * d[0] + q.a[3] * d[1] + q.a[4] * d[2],
            q.a[2] * d[0] + q.a[4] * d[1] + q.a[5] * d[2]};
}

inline float trace(const cwi_quadric &q)
{
    return q.a[0] + q.a[3] + q.a[5];
}

inline float error_at(const cwi_quadric &q, const Vec &d)
{
    const Vec b(q.b[0], q.b[1], q.b[2]);
    return std::max(0.0f, ((times(q, d) + 2 * b) | d) + q.c);
}

// Adds weight x the square of the distance from a plane through the vertex.
inline void add_plane(cwi_quadric &q, const Vec &normal, float weight)
{
    const Vec n = normal * weight;
    q.a[0] += n[0] * normal[0];
    q.a[1] += n[0] * normal[1];
    q.a[2] += n[0] * normal[2];
    q.a[3] += n[1] * normal[1];
    q.a[4] += n[1] * normal[2];
    q.a[5] += n[2] * normal[2];
}

// Returns the quadric about a position that is `displacement` from the old one.
inline cwi_quadric moved(const cwi_quadric &q, const Vec &displacement)
{
    const Vec ad = times(q, displacement);
    cwi_quadric r = q;
    for (int k = 0; k < 3; k++)
        r.b[k] += ad[k];
    r.c = error_at(q, displacement);
    return r;
}

// Returns the position of least error, slightly pulled towards another, so that there is one.
inline Vec minimizer(const cwi_quadric &q, const Vec &towards)
{
    const float pull = 1e-5f * trace(q) + 1e-30f;
    const float xx = q.a[0] + pull, xy = q.a[1], xz = q.a[2], yy = q.a[3] + pull, yz = q.a[4],
                zz = q.a[5] + pull;
    const Vec right(pull * towards[0] - q.b[0], pull * towards[1] - q.b[1],
                    pull * towards[2] - q.b[2]);
    const float l10 = xy / xx, l20 = xz / xx; // L D L^T
    const float d1 = yy - l10 * xy, e = yz - l20 * xy, l21 = e / d1,
                d2 = zz - l20 * xz - l21 * e;
    const float y0 = right[0], y1 = right[1] - l10 * y0, y2 = right[2] - l20 * y0 - l21 * y1;
    const float z = y2 / d2, y = y1 / d1 - l21 * z;
    return {y0 / xx - l10 * y - l20 * z, y, z};
}

} // namespace cw

#endif
