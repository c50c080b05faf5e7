// Checks an edge collapse: the ring of triangles around the edge must keep its shape, and must
// not meet other triangles.
#include "simplify/collapse/collapse_checks.hpp"

#include "core/geometry/triangle_intersect.h"

#include <cmath>
#include <cstring>

namespace cw
{

namespace
{

Vec point(const Surface &surface, uint32_t v)
{
    return surface.point(VertexHandle(int(v)));
}

// At least that of Euclid.
float length(const Vec &v)
{
    return std::abs(v[0]) + std::abs(v[1]) + std::abs(v[2]);
}

// On which side of a plane a point certainly is: 1, -1; 0 when that takes exact arithmetic. The
// normal is a product of vectors whose lengths have the product `scale`.
int clear_side(const Vec &normal, float scale, const Vec &displacement)
{
    const float height = normal | displacement, doubt = 2e-6f * scale * length(displacement);
    return height > doubt ? 1 : height < -doubt ? -1 : 0;
}

// Triangles around a vertex but those at the edge to the other.
void add_triangles(const Surface &surface, VertexHandle center, VertexHandle other,
                   OneRing &ring)
{
    const Vec old = surface.point(center);
    for (auto h = surface.cvoh_ccwiter(center); h.is_valid(); ++h) {
        const FaceHandle f = surface.face_handle(*h);
        if (!f.is_valid()) {
            ring.closed = false;
            continue;
        }
        const VertexHandle a = surface.to_vertex_handle(*h),
                           b = surface.to_vertex_handle(surface.next_halfedge_handle(*h));
        if (a == other || b == other)
            continue;
        const Vec pa = surface.point(a), pb = surface.point(b), side = pb - pa;
        ring.triangles.push_back({uint32_t(f.idx()), uint32_t(a.idx()), uint32_t(b.idx()), pa,
                                  pb, (pa - old) % side, (pa - ring.position) % side});
    }
}

} // namespace

bool OneRing::is_small(const Surface &surface, HalfedgeHandle edge)
{
    size_t edges = 0;
    for (const VertexHandle v :
         {surface.from_vertex_handle(edge), surface.to_vertex_handle(edge)})
        for (auto h = surface.cvoh_iter(v); h.is_valid(); ++h)
            if (++edges > MAX_RING + 4) // the edge itself and its triangles do not stay
                return false;
    return true;
}

bool OneRing::gather(const Surface &surface, HalfedgeHandle collapsed, const Vec &to)
{
    const VertexHandle u = surface.from_vertex_handle(collapsed),
                       v = surface.to_vertex_handle(collapsed);
    const HalfedgeHandle back = surface.opposite_halfedge_handle(collapsed);
    vertex = uint32_t(v.idx());
    position = to;
    old[0] = surface.point(u);
    old[1] = surface.point(v);
    closed = true;
    triangles.clear();
    gone.clear();
    for (HalfedgeHandle h : {collapsed, back})
        if (surface.face_handle(h).is_valid())
            gone.push_back(uint32_t(surface.face_handle(h).idx()));
    add_triangles(surface, u, v, *this);
    add_triangles(surface, v, u, *this);
    return triangles.size() >= (closed ? 3 : 1);
}

Box OneRing::box(const RingTriangle &ring_triangle) const
{
    Box box;
    box.add(position);
    box.add(ring_triangle.pa);
    box.add(ring_triangle.pb);
    return box;
}

bool Shape::is_inside(const Vec &position) const
{
    for (unsigned k = 0; k < 3; k++)
        if (!(position[k] >= low[k] && position[k] < high[k]))
            return false;
    const float height = position | along;
    return height >= from && height <= to;
}

bool Shape::is_kept(const OneRing &ring) const
{
    for (const RingTriangle &s : ring.triangles) {
        const float now = s.normal.sqrnorm(), before = s.old_normal.sqrnorm(),
                    turn = s.normal | s.old_normal;
        if (!(turn > 0) || turn * turn < 0.04f * now * before)
            return false;
        const float longest =
            std::max((s.pb - s.pa).sqrnorm(), std::max((s.pa - ring.position).sqrnorm(),
                                                       (s.pb - ring.position).sqrnorm()));
        if (now < 1e-7f * longest * longest && now < before) // needles may stay, and get wider
            return false;
    }
    return true;
}

// --- Contact -------------------------------------------------------------------------------

Contact::Contact(const cwi_mesh_block &block, const Surface &surface)
    : interior_count(block.interior_count), live(block.triangles),
      corners(block.corners, block.corners + 3 * block.triangles), marks(block.triangles)
{
#ifdef __x86_64__
    has_avx2 = __builtin_cpu_supports("avx2");
#endif
    build(surface);
}

void Contact::build(const Surface &surface)
{
    std::vector<uint32_t> faces;
    std::vector<Box> all;
    faces.reserve(live);
    all.reserve(live);
    for (uint32_t f = 0; f < marks.size(); f++) {
        if (f < interior_count && surface.status(FaceHandle(int(f))).deleted())
            continue;
        Box box;
        for (size_t k = 0; k < 3; k++)
            box.add(point(surface, corners[3 * size_t(f) + k]));
        faces.push_back(f);
        all.push_back(box);
    }
    nearby = std::make_unique<Nearby>(faces, all, marks.size());
    built = live = faces.size();
    build_fans(surface);
}

namespace
{

struct Corners {
    uint32_t id[3];
    Vec at[3];
};

bool has(const Corners &t, uint32_t id)
{
    return t.id[0] == id || t.id[1] == id || t.id[2] == id;
}

// The side of a plane that all corners are on but those shared with the other triangle.
int common_side(const Corners &t, const Corners &other, const Vec &normal, float scale,
                const Vec &position)
{
    int above = 0, below = 0, all = 0;
    for (int k = 0; k < 3; k++) {
        if (has(other, t.id[k]))
            continue;
        const int side = clear_side(normal, scale, t.at[k] - position);
        above += side > 0;
        below += side < 0;
        all++;
    }
    return above == all ? 1 : below == all ? -1 : 0;
}

// Whether the other triangle certainly is on one side of the triangle's plane, or beyond one of
// its sides; there they may share corners.
bool is_apart(const Corners &t, const Corners &other)
{
    const Vec ab = t.at[1] - t.at[0], ac = t.at[2] - t.at[0], normal = ab % ac;
    const float scale = length(ab) * length(ac);
    if (common_side(other, t, normal, scale, t.at[0]))
        return true;
    for (int k = 0; k < 3; k++) {
        const Vec side = t.at[(k + 1) % 3] - t.at[k];
        if (!has(other, t.id[(k + 2) % 3]) &&
            common_side(other, t, side % normal, scale * length(side), t.at[k]) > 0)
            return true;
    }
    return false;
}

void put(Eight &eight, size_t lane, const OneRing &ring, const RingTriangle &s)
{
    const Vec along = s.pb - s.pa, from_center = s.pa - ring.position, out = along % s.normal;
    const float scale = 2e-6f * length(from_center) * length(along);
    cwi_boxes_put(&eight.boxes, lane, ring.box(s).side);
    eight.a[lane] = s.a;
    eight.b[lane] = s.b;
    for (unsigned k = 0; k < 3; k++) {
        eight.face[k][lane] = s.normal[k];
        eight.side[k][lane] = out[k];
    }
    eight.face_doubt[lane] = scale;
    eight.side_height[lane] = out | from_center;
    eight.side_doubt[lane] = scale * length(along);
    eight.reach[lane] = length(from_center);
}

// Eight numbers at a time, said so.
typedef float Lanes __attribute__((vector_size(32)));
typedef int32_t Mask __attribute__((vector_size(32)));

template <typename Vector, typename T>
inline __attribute__((always_inline)) void load(Vector &vector, const T (&from)[8])
{
    std::memcpy(&vector, from, sizeof vector);
}

// Which of the ring triangles may meet a triangle: it is not clearly on one side of their planes, nor
// beyond their outer sides, but for corners that they share.
inline __attribute__((always_inline)) unsigned candidates(const Eight &e, const Corners &other,
                                                          const Vec &center)
{
    Mask a, b, above = Mask{} - 1, below = above, beyond = above;
    Lanes face[3], side[3], face_doubt, side_height, side_doubt, reach;
    for (int k = 0; k < 3; k++) {
        load(face[k], e.face[k]);
        load(side[k], e.side[k]);
    }
    load(a, e.a);
    load(b, e.b);
    load(face_doubt, e.face_doubt);
    load(side_height, e.side_height);
    load(side_doubt, e.side_doubt);
    load(reach, e.reach);
    for (int k = 0; k < 3; k++) {
        const Vec w = other.at[k] - center;
        const float far = length(w);
        const int32_t id = int32_t(other.id[k]);
        const Mask shared = (a == id) | (b == id);
        const Lanes height = face[0] * w[0] + face[1] * w[1] + face[2] * w[2],
                    out = side[0] * w[0] + side[1] * w[1] + side[2] * w[2] - side_height,
                    doubt = face_doubt * far, out_doubt = side_doubt * (reach + far);
        above &= shared | (height > doubt);
        below &= shared | (height < -doubt);
        beyond &= shared | (out > out_doubt);
    }
    const Mask left = ~(above | below | beyond);
    cwi_mask halves[2];
    std::memcpy(halves, &left, sizeof halves);
    return cwi_mask_bits(halves) | cwi_mask_bits(halves + 1) << 4;
}

} // namespace

// The moved vertex stands at its new place already.
inline __attribute__((always_inline)) bool Contact::meets(const Surface &surface,
                                                          const OneRing &ring, uint32_t face,
                                                          const float box[6]) const
{
    Corners other;
    std::memcpy(other.id, &corners[3 * size_t(face)], sizeof other.id);
    for (int k = 0; k < 3; k++)
        other.at[k] = point(surface, other.id[k]);
    for (size_t n = 0; n < triangles.size(); n++) {
        unsigned near = cwi_boxes_meeting(&triangles[n].boxes, box);
        if (near)
            near &= candidates(triangles[n], other, ring.position);
        for (; near; near &= near - 1) {
            const RingTriangle &s = ring.triangles[8 * n + unsigned(__builtin_ctz(near))];
            const Corners mine = {{ring.vertex, s.a, s.b}, {ring.position, s.pa, s.pb}};
            if (!is_apart(other, mine) && !is_apart(mine, other) &&
                cwi_triangles_meet(surface.points()->data(), mine.id, other.id))
                return true;
        }
    }
    return false;
}

// Seen along the sum of its normals a ring opens like a fan if all triangles face that way and
// go round once: then no two of them meet.
bool Contact::opens_like_a_fan(const OneRing &ring) const
{
    Vec axis(0), x;
    for (const RingTriangle &s : ring.triangles)
        axis += s.normal;
    x = axis % (std::abs(axis[0]) < std::abs(axis[1]) ? Vec(1, 0, 0) : Vec(0, 1, 0));
    int rounds = 0;
    for (const RingTriangle &s : ring.triangles) {
        const float scale = length(s.pa - ring.position) * length(s.pb - s.pa);
        if (clear_side(s.normal, scale, axis) <= 0)
            return false;
        rounds += (x | (s.pa - ring.position)) < 0 && (x | (s.pb - ring.position)) >= 0;
    }
    return rounds == 1 && ring.closed;
}

bool Contact::ring_meets_itself(const Surface &surface, const OneRing &ring) const
{
    for (const RingTriangle &s : ring.triangles)
        for (const RingTriangle *t = &s + 1; t < ring.triangles.data() + ring.triangles.size();
             t++) {
            const uint32_t mine[3] = {ring.vertex, s.a, s.b},
                           other[3] = {ring.vertex, t->a, t->b};
            if (cwi_triangles_meet(surface.points()->data(), mine, other))
                return true;
        }
    return false;
}

inline __attribute__((always_inline)) bool
Contact::meets_others(const Surface &surface, const OneRing &ring, const Box &around) const
{
    return nearby->any(
        around, [&](uint32_t face, const float box[6]) __attribute__((always_inline)) {
            return marks[face] != mark && meets(surface, ring, face, box);
        });
}

#ifdef __x86_64__
__attribute__((target("avx2"))) bool
Contact::meets_others_avx2(const Surface &surface, const OneRing &ring, const Box &around) const
{
    return meets_others(surface, ring, around);
}
#endif

bool Contact::find_others(const Surface &surface, const OneRing &ring, const Box &around) const
{
    if (!fans.empty() && meets_fans(surface, ring, around))
        return true;
#ifdef __x86_64__
    if (has_avx2)
        return meets_others_avx2(surface, ring, around);
#endif
    return meets_others(surface, ring, around);
}

bool Contact::arises(Surface &surface, const OneRing &ring)
{
    const VertexHandle moving(int(ring.vertex));
    const Vec before = surface.point(moving);
    Box all;
    all.add(ring.position);
    mark++;
    triangles.resize((ring.triangles.size() + 7) / 8);
    cwi_boxes_clear(&triangles.back().boxes);
    for (size_t i = 0; i < ring.triangles.size(); i++) {
        const RingTriangle &s = ring.triangles[i];
        put(triangles[i / 8], i % 8, ring, s);
        all.add(s.pa);
        all.add(s.pb);
        marks[s.face] = mark;
    }
    for (uint32_t f : ring.gone)
        marks[f] = mark;
    surface.set_point(moving, ring.position);
    const bool found = (!opens_like_a_fan(ring) && ring_meets_itself(surface, ring)) ||
                       find_others(surface, ring, all);
    surface.set_point(moving, before);
    return found;
}

// --- wide fans -----------------------------------------------------------------------------

// The box of the directions in which the fan's hub sees a triangle.
Box Contact::direction(const Fan &fan, const uint32_t id[3], const Vec at[3])
{
    const float *const corner[3] = {at[0].data(), at[1].data(), at[2].data()};
    const bool has_hub = id[0] == fan.hub || id[1] == fan.hub || id[2] == fan.hub;
    Box box;
    cwi_direction_box(fan.center.data(), corner, has_hub, box.side);
    return box;
}

Box Contact::direction(const Fan &fan, const OneRing &ring, const RingTriangle &s)
{
    const uint32_t id[3] = {ring.vertex, s.a, s.b};
    const Vec at[3] = {ring.position, s.pa, s.pb};
    return direction(fan, id, at);
}

// Takes the triangles of wide fans out of the tree, and sorts those of each by their directions.
void Contact::build_fans(const Surface &surface)
{
    struct Faces {
        const Surface *surface;
        size_t interior_count;
    } faces = {&surface, interior_count};
    cwi_wide_fans found;
    cw_error err;
    const cw_status st = cwi_wide_fans_find(
        &found, surface.n_vertices(), corners.data(), marks.size(),
        [](const void *context, size_t face) {
            const auto *f = static_cast<const Faces *>(context);
            return face < f->interior_count &&
                   f->surface->status(FaceHandle(int(face))).deleted();
        },
        &faces, &err);
    fans.clear();
    fan_of.clear();
    if (st == CW_OK && found.count)
        fan_of.assign(found.fan_of, found.fan_of + marks.size());
    for (size_t f = 0; f < found.count && st == CW_OK; f++) {
        Fan fan = {found.hubs[f], point(surface, found.hubs[f]), Box(), {}, nullptr};
        fan.faces.assign(found.triangles + found.first[f],
                         found.triangles + found.first[f + 1]);
        std::vector<Box> boxes;
        for (const uint32_t face : fan.faces) {
            Vec at[3];
            for (size_t k = 0; k < 3; k++) {
                at[k] = point(surface, corners[3 * size_t(face) + k]);
                fan.around.add(at[k]);
            }
            boxes.push_back(direction(fan, &corners[3 * size_t(face)], at));
            nearby->remove(face);
        }
        fan.directions = std::make_unique<Nearby>(fan.faces, boxes, marks.size());
        fans.push_back(std::move(fan));
    }
    cwi_wide_fans_free(&found);
    if (st != CW_OK)
        throw std::bad_alloc();
    if (!fans.empty())
        nearby->shrink();
}

// Whether a ring meets triangles of fans. All those of a fan whose hub is an end of the edge are in
// the ring.
bool Contact::meets_fans(const Surface &surface, const OneRing &ring, const Box &around) const
{
    for (const Fan &fan : fans) {
        if (!fan.directions || !fan.around.meets(around))
            continue;
        for (const RingTriangle &s : ring.triangles) {
            const Box seen = direction(fan, ring, s);
            const bool found = fan.directions->any(seen, [&](uint32_t face, const float *) {
                if (marks[face] == mark)
                    return false;
                Box box;
                for (size_t k = 0; k < 3; k++)
                    box.add(point(surface, corners[3 * size_t(face) + k]));
                return meets(surface, ring, face, box.side);
            });
            if (found)
                return true;
        }
    }
    return false;
}

// Gives the triangles of a fan back to the tree: its hub moves.
void Contact::release_fan(const Surface &surface, uint32_t fan)
{
    for (const uint32_t face : fans[fan].faces) {
        if (fan_of[face] != fan)
            continue; // it is gone
        fan_of[face] = CWI_NO_FAN;
        Box box;
        for (size_t k = 0; k < 3; k++)
            box.add(point(surface, corners[3 * size_t(face) + k]));
        nearby->move(face, box);
    }
    fans[fan].directions = nullptr;
}

void Contact::remove(uint32_t face)
{
    if (fan_of.empty() || fan_of[face] == CWI_NO_FAN) {
        nearby->remove(face);
        return;
    }
    fans[fan_of[face]].directions->remove(face);
    fan_of[face] = CWI_NO_FAN;
}

void Contact::move(const OneRing &ring, const RingTriangle &moved)
{
    const Box box = ring.box(moved);
    if (fan_of.empty() || fan_of[moved.face] == CWI_NO_FAN) {
        nearby->move(moved.face, box);
        return;
    }
    Fan &fan = fans[fan_of[moved.face]];
    fan.directions->move(moved.face, direction(fan, ring, moved));
    fan.around.add(&box.side[0]);
    fan.around.add(&box.side[3]);
}

// Moves the triangles of a ring in the tree, and builds the tree again when few of them are
// left: else most boxes would be empty.
void Contact::change(const Surface &surface, const OneRing &ring)
{
    for (const RingTriangle &s : ring.triangles) {
        const uint32_t fan = fan_of.empty() ? CWI_NO_FAN : fan_of[s.face];
        if (fan != CWI_NO_FAN && fans[fan].hub != s.a && fans[fan].hub != s.b)
            release_fan(surface, fan);
    }
    for (uint32_t f : ring.gone)
        remove(f);
    for (size_t i = 0; i < ring.triangles.size(); i++) {
        const RingTriangle &s = ring.triangles[i];
        const uint32_t now[3] = {ring.vertex, s.a, s.b};
        std::memcpy(&corners[3 * size_t(s.face)], now, sizeof now);
        move(ring, s);
    }
    live -= ring.gone.size();
    if (2 * live < built && live > 1024)
        build(surface);
}

} // namespace cw
