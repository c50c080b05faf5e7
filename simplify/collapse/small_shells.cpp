// Finds shells of few triangles: the sign of their volumes before and after a collapse, and
// those between a ring before and after.
#include "simplify/collapse/small_shells.hpp"

#include "core/geometry/union_find.h"
#include "core/geometry/vec3.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace cw
{

namespace
{

const uint32_t SMALL = 64;   // faces: the sides of larger shells are more than a ring
const uint32_t LISTED = 128; // faces of shells that rings could jump over

// Six times the volume between a triangle and the origin.
double volume(const Vec &a, const Vec &b, const Vec &c)
{
    return double(a[0]) * (double(b[1]) * double(c[2]) - double(b[2]) * double(c[1])) +
           double(a[1]) * (double(b[2]) * double(c[0]) - double(b[0]) * double(c[2])) +
           double(a[2]) * (double(b[0]) * double(c[1]) - double(b[1]) * double(c[0]));
}

// The solid angle of a triangle seen from the origin [VanOosterom1983].
double solid_angle(const Vec &p, const Vec &q, const Vec &r)
{
    const double a[3] = {double(p[0]), double(p[1]), double(p[2])},
                 b[3] = {double(q[0]), double(q[1]), double(q[2])},
                 c[3] = {double(r[0]), double(r[1]), double(r[2])};
    const double la = cwi_length(a), lb = cwi_length(b), lc = cwi_length(c);
    return 2 * std::atan2(volume(p, q, r), la * lb * lc + cwi_dot(a, b) * lc +
                                               cwi_dot(b, c) * la + cwi_dot(c, a) * lb);
}

void corners_of(const Surface &surface, uint32_t face, const Vec &origin, Vec corner[3])
{
    size_t n = 0;
    for (auto v = surface.cfv_iter(FaceHandle(int(face))); v.is_valid(); ++v)
        corner[n++] = surface.point(*v) - origin;
}

bool is_inside(const Box &box, const Vec &p)
{
    for (unsigned k = 0; k < 3; k++)
        if (!(p[k] >= box.side[k] && p[k] <= box.side[k + 3]))
            return false;
    return true;
}

// Returns true if a point is between a ring as it is and as it would be: these two are closed.
bool is_between(const Surface &surface, const OneRing &ring, const Vec &point)
{
    Vec corner[3];
    double angle = 0;
    for (uint32_t f : ring.gone) {
        corners_of(surface, f, point, corner);
        angle += solid_angle(corner[0], corner[1], corner[2]);
    }
    for (const RingTriangle &s : ring.triangles) {
        corners_of(surface, s.face, point, corner);
        angle += solid_angle(corner[0], corner[1], corner[2]) -
                 solid_angle(ring.position - point, s.pa - point, s.pb - point);
    }
    return std::abs(angle) > CWI_PI * 2;
}

} // namespace

SmallShells::SmallShells(const cwi_mesh_block &block)
    : shell_of(block.interior_count), locked(block.vertices)
{
    if (block.locked)
        locked.assign(block.locked, block.locked + block.vertices);
    std::vector<uint32_t> parent(block.vertices);
    std::iota(parent.begin(), parent.end(), 0);
    for (size_t t = 0; t < block.interior_count; t++) {
        const uint32_t *c = block.corners + 3 * t;
        cwi_sets_join(parent.data(), c[0], c[1]);
        cwi_sets_join(parent.data(), c[0], c[2]);
    }
    left.assign(parent.size(), 0);
    for (size_t t = 0; t < block.interior_count; t++) {
        shell_of[t] = cwi_sets_find(parent.data(), block.corners[3 * t]);
        left[shell_of[t]]++;
    }
    list_shells(block);
}

// Puts small shells into a tree.
void SmallShells::list_shells(const cwi_mesh_block &block)
{
    std::vector<uint32_t> shells;
    std::vector<Box> around;
    vertex_of.resize(block.vertices);
    boxes.resize(block.vertices);
    for (size_t t = 0; t < block.interior_count; t++)
        for (size_t k = 0; k < 3 && left[shell_of[t]] <= LISTED; k++) {
            const uint32_t v = block.corners[3 * t + k];
            boxes[shell_of[t]].add(Vec(block.points + 3 * size_t(v)));
            vertex_of[shell_of[t]] = v;
        }
    for (uint32_t shell = 0; shell < left.size(); shell++)
        if (left[shell] && left[shell] <= LISTED) {
            shells.push_back(shell);
            around.push_back(boxes[shell]);
        }
    if (!shells.empty())
        nearby = std::make_unique<Nearby>(shells, around, block.vertices);
}

// Collects all faces from one on.
SmallShells::End SmallShells::collect(const Surface &surface, uint32_t first)
{
    faces.assign(1, first);
    for (size_t n = 0; n < faces.size(); n++)
        for (auto h = surface.cfh_iter(FaceHandle(int(faces[n]))); h.is_valid(); ++h) {
            const FaceHandle f = surface.face_handle(surface.opposite_halfedge_handle(*h));
            if (!f.is_valid()) {
                const size_t a = size_t(surface.from_vertex_handle(*h).idx()),
                             b = size_t(surface.to_vertex_handle(*h).idx());
                return locked[a] && locked[b] ? End::SEAM : End::BORDER;
            }
            if (std::find(faces.begin(), faces.end(), uint32_t(f.idx())) == faces.end())
                faces.push_back(uint32_t(f.idx()));
        }
    return End::CLOSED;
}

bool SmallShells::turns(const Surface &surface, const OneRing &ring, bool *open)
{
    const uint32_t first = ring.triangles[0].face;
    if (!ring.closed || left[shell_of[first]] > SMALL)
        return false;
    const End end = collect(surface, first);
    *open = *open || end == End::SEAM;
    if (end != End::CLOSED)
        return end == End::SEAM;
    double before = 0, after = 0;
    for (uint32_t f : faces) {
        Vec corner[3];
        corners_of(surface, f, ring.position, corner);
        before += volume(corner[0], corner[1], corner[2]);
        const auto is_of_ring = [&](const RingTriangle &s) { return s.face == f; };
        const bool moves =
            std::any_of(ring.triangles.begin(), ring.triangles.end(), is_of_ring) ||
            std::find(ring.gone.begin(), ring.gone.end(), f) != ring.gone.end();
        if (!moves) // the others have a corner at the origin then
            after += volume(corner[0], corner[1], corner[2]);
    }
    return before > 0 ? !(after > 0) : before < 0 ? !(after < 0) : false;
}

bool SmallShells::sweeps(const Surface &surface, const OneRing &ring) const
{
    if (!nearby || !ring.closed)
        return false;
    const uint32_t own_shell = shell_of[ring.triangles[0].face];
    Box around;
    around.add(ring.position);
    for (const RingTriangle &s : ring.triangles) {
        around.add(s.pa);
        around.add(s.pb);
    }
    around.add(ring.old[0]);
    around.add(ring.old[1]);
    return nearby->any(around, [&](uint32_t shell, const float *) {
        const Vec at = surface.point(VertexHandle(int(vertex_of[shell])));
        return shell != own_shell && is_inside(around, at) && is_between(surface, ring, at);
    });
}

void SmallShells::change(const OneRing &ring)
{
    const uint32_t shell = shell_of[ring.triangles[0].face];
    const bool is_listed = boxes[shell].side[0] <= boxes[shell].side[3];
    left[shell] -= uint32_t(ring.gone.size());
    vertex_of[shell] = ring.vertex;
    if (!is_listed)
        return;
    boxes[shell].add(ring.position);
    nearby->move(shell, boxes[shell]);
}

} // namespace cw
