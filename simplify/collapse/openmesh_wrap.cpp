// Edge collapse by quadric error [Garland1997] on OpenMesh's kernel. Costs are looked at again
// only when their edge comes up: a quadric that was added to never costs less, so what stands
// in the queue is a lower bound, and the order is that of the true costs.
#include "simplify/collapse/openmesh_wrap.h"

#include "core/base/guard.hpp"
#include "core/base/memory.h"
#include "simplify/collapse/attribute_quadric.hpp"
#include "simplify/collapse/distance_bound.hpp"
#include "simplify/collapse/edge_heap.hpp"
#include "simplify/collapse/halfedge_mesh.hpp"
#include "simplify/collapse/small_shells.hpp"
#include "simplify/collapse/texture_charts.hpp"

#include <cmath>
#include <memory>

using namespace cw;

namespace
{

// Bytes that a triangle takes here, with its share of vertices, edges and the data kept for
// them.
enum { TRIANGLE_BYTES = 240, TEXTURE_BYTES = 48 };

// All that a cost needs of a vertex, in one line of a cache.
struct alignas(64) Node {
    cwi_quadric quadric;
    Vec point;
    uint32_t changed; // when it last did
    bool locked, border;
    bool open; // edges at it may be collapsed where there is more room
    bool wide; // edges at it were not tried, as too many triangles are around it
};

} // namespace

struct cwi_decimater {
    cwi_decimater(const cwi_mesh_block &block, const cwi_block_desc &desc,
                  const cwi_original *original)
        : taken((TRIANGLE_BYTES + (block.texture ? TEXTURE_BYTES : 0)) * block.triangles),
          global_ids(block.global_ids, block.global_ids + block.vertices),
          nodes(block.vertices), gradients(block), texture_scale(block.texture_scale),
          live(block.interior_count), shape(block), shells(block),
          bound(block, original, desc.error), progress(*desc.progress)
    {
        poll();
        const std::vector<uint8_t> unsound = connect(block, surface);
        poll();
        charts = std::make_unique<TextureCharts>(block, surface, desc.error);
        if (!desc.allow_crossings)
            contact = std::make_unique<Contact>(block, surface);
        for (size_t v = 0; v < block.vertices; v++) {
            poll_often();
            const VertexHandle handle{int(v)};
            nonmanifold_count += unsound[v];
            nodes[v].point = surface.point(handle);
            nodes[v].border = surface.is_boundary(handle);
            nodes[v].open = !block.open || block.open[v];
            nodes[v].locked = unsound[v] || (block.locked && block.locked[v]) ||
                              (desc.keep_border && nodes[v].border);
        }
        add_quadrics(block);
        fill_queue();
        for (size_t v = 0; v < nodes.size(); v++)
            nodes[v].open =
                nodes[v].locked || (block.holds_seams && charts->is_on_seam(uint32_t(v)));
    }

    void run(float max_cost, size_t min_triangles)
    {
        while (!queue.empty() && Queue::cost(queue.top()) <= max_cost && live > min_triangles) {
            poll_often();
            const uint32_t e = Queue::edge(queue.top());
            if (surface.status(EdgeHandle(int(e))).deleted()) {
                queue.pop();
                continue;
            }
            const Proposal p = propose(EdgeHandle(int(e)));
            if (p.changed > looked_at[e]) {
                looked_at[e] = tick;
                const uint64_t now =
                    Queue::entry(std::max(p.cost, Queue::cost(queue.top())), e);
                if (now > queue.top()) {
                    queue.replace_top(now);
                    continue;
                }
            }
            queue.pop();
            waiting[e] = false;
            try_to_collapse(p);
        }
    }

    Taken taken;
    Surface surface;
    std::vector<uint32_t> global_ids;
    std::vector<Node> nodes;
    AttributeGradients gradients;
    float texture_scale;
    size_t nonmanifold_count = 0;
    Queue queue;
    std::vector<uint32_t> looked_at; // edges: when their cost was
    std::vector<bool> waiting;       // edges that are in the queue
    uint32_t tick = 0;
    size_t live;
    Shape shape;
    SmallShells shells;
    Bound bound;
    std::unique_ptr<Contact> contact;
    std::unique_ptr<TextureCharts> charts;
    OneRing ring;

private:
    // The caller may have asked to stop. A negative share repeats the last one.
    void poll() const
    {
        if (cwi_progress(&progress, "simplifying", -1, nullptr) != CW_OK)
            throw Cancelled();
    }

    // For loops of short turns: some milliseconds between two polls.
    void poll_often()
    {
        if (++turns % 4096 == 0)
            poll();
    }

    const cw_progress progress;
    uint32_t turns = 0;

    struct Proposal {
        HalfedgeHandle halfedge; // from the vertex that goes to the one that stays
        cwi_quadric quadric;     // about where the halfedge starts
        Vec position;
        float cost;       // infinite where the texture forbids it
        uint32_t changed; // the later of the two vertices
    };

    Node &node(VertexHandle v)
    {
        return nodes[size_t(v.idx())];
    }

    cwi_quadric &quadric(VertexHandle v)
    {
        return node(v).quadric;
    }

    // By area to 5/8: where triangles are of all sizes the small ones, which follow what is
    // finest, count for more, and the root mean square falls. Trends are over areas.
    float weight_of(float area) const
    {
        return gradients.is_requested()
                   ? area
                   : std::sqrt(area) * std::sqrt(std::sqrt(std::sqrt(area)));
    }

    // Collects the attributes of a triangle's corners, measured as lengths.
    void collect_values(const cwi_mesh_block &block, FaceHandle f, const size_t corner[3],
                        AttributeGradients::Values &values) const
    {
        const size_t texture = block.texture ? CWI_TEXTURE_ATTRIBUTES : 0,
                     count = block.attributes - texture;
        for (size_t i = 0; i < 3; i++) {
            for (size_t k = 0; k < count; k++)
                values[i][k] = block.values[corner[i] * count + k];
            for (size_t k = 0; k < texture; k++)
                values[i][count + k] =
                    texture_scale * charts->at(uint32_t(f.idx()), uint32_t(corner[i]))[k];
        }
    }

    // Adds planes and gradients. On seams a texture is no linear function of place.
    void add_face(const cwi_mesh_block &block, FaceHandle f)
    {
        AttributeGradients::Values values;
        size_t corner[3], n = 0;
        for (auto it = surface.cfv_iter(f); it.is_valid(); ++it)
            corner[n++] = size_t(it->idx());
        const Vec a = nodes[corner[0]].point, ab = nodes[corner[1]].point - a,
                  ac = nodes[corner[2]].point - a;
        Vec normal = ab % ac;
        const float length = normal.norm();
        if (length > 0)
            normal /= length;
        for (size_t v : corner)
            add_plane(nodes[v].quadric, normal, weight_of(length / 2));
        if (!gradients.is_requested())
            return;
        collect_values(block, f, corner, values);
        gradients.add_face(corner, ab, ac, values, [&](size_t v) {
            return charts->is_on_seam(uint32_t(v)) ? nullptr : &nodes[v].quadric;
        });
    }

    // The plane through an edge of the border or along a seam, square to its triangle.
    void add_border(HalfedgeHandle h)
    {
        const HalfedgeHandle inner = surface.opposite_halfedge_handle(h);
        const VertexHandle a = surface.from_vertex_handle(inner),
                           b = surface.to_vertex_handle(inner),
                           c = surface.to_vertex_handle(surface.next_halfedge_handle(inner));
        const Vec along = surface.point(b) - surface.point(a),
                  face = along % (surface.point(c) - surface.point(a));
        Vec normal = along % face;
        const float length = normal.norm();
        if (!(length > 0))
            return;
        normal /= length;
        const float weight = (surface.is_boundary(h) ? 1 : 0.5f) * weight_of(along.sqrnorm());
        add_plane(quadric(a), normal, weight);
        add_plane(quadric(b), normal, weight);
    }

    // Between two vertices held for a seam no border is known; it is when one is released.
    void add_quadrics(const cwi_mesh_block &block)
    {
        if (block.quadrics)
            for (size_t v = 0; v < block.vertices; v++)
                nodes[v].quadric = block.quadrics[v];
        else
            for (auto f : surface.faces()) {
                poll_often();
                add_face(block, f);
            }
        for (int i = 0; i < int(surface.n_halfedges()); i++) {
            const HalfedgeHandle h(i);
            poll_often();
            if (!surface.is_boundary(h) &&
                !(charts->is_requested() && charts->is_seam(surface, h)))
                continue;
            const auto a = size_t(surface.from_vertex_handle(h).idx()),
                       b = size_t(surface.to_vertex_handle(h).idx());
            const bool both_locked = block.locked && block.locked[a] && block.locked[b],
                       unknown = block.seam ? block.seam[a] && block.seam[b] : true;
            if (unknown && !both_locked)
                add_border(h);
        }
    }

    void fill_queue()
    {
        const size_t edges = surface.n_edges();
        looked_at.assign(edges, 0);
        waiting.assign(edges, false);
        queue.reserve(edges);
        for (uint32_t e = 0; e < edges; e++) {
            poll_often();
            const HalfedgeHandle h = surface.halfedge_handle(EdgeHandle(int(e)), 0);
            const Node &u = node(surface.from_vertex_handle(h)),
                       &v = node(surface.to_vertex_handle(h));
            if (u.locked || v.locked || !(u.open || v.open))
                continue;
            queue.append(Queue::entry(propose(EdgeHandle(int(e))).cost, e));
            waiting[e] = true;
        }
        queue.build();
    }

    // A vertex of the border moves along it only, with another one; one on a seam of the texture, too.
    TextureCharts::Target target_of(HalfedgeHandle h)
    {
        if (charts->is_requested())
            return charts->target(surface, h);
        const Node &u = node(surface.from_vertex_handle(h)),
                   &v = node(surface.to_vertex_handle(h));
        return u.border == v.border ? TextureCharts::ANYWHERE
               : u.border           ? TextureCharts::AT_START
                                    : TextureCharts::AT_END;
    }

    Proposal propose(EdgeHandle e)
    {
        Proposal p;
        p.halfedge = surface.halfedge_handle(e, 0);
        const Node &u = node(surface.from_vertex_handle(p.halfedge)),
                   &v = node(surface.to_vertex_handle(p.halfedge));
        const Vec displacement = v.point - u.point;
        p.quadric = moved(v.quadric, -displacement);
        cwi_quadric_add(&p.quadric, &u.quadric);
        if (gradients.is_requested())
            join_gradients(p.halfedge, p.quadric);
        const TextureCharts::Target target = target_of(p.halfedge);
        if (charts->is_requested())
            p.quadric.c += texture_loss(p.halfedge, target);
        const Vec d = target == TextureCharts::ANYWHERE
                          ? minimizer(p.quadric, 0.5f * displacement)
                      : target == TextureCharts::AT_START ? Vec(0)
                                                          : displacement;
        p.position = u.point + d;
        p.cost =
            target == TextureCharts::NOWHERE
                ? INFINITY
                : error_at(p.quadric, d) + 1e-5f * trace(p.quadric) * displacement.sqrnorm();
        p.changed = std::max(u.changed, v.changed);
        return p;
    }

    // Computes the loss of a vertex inside a chart that goes to a seam.
    float texture_loss(HalfedgeHandle h, TextureCharts::Target target)
    {
        if (target == TextureCharts::AT_START)
            h = surface.opposite_halfedge_handle(h);
        const VertexHandle u = surface.from_vertex_handle(h), v = surface.to_vertex_handle(h);
        if (target == TextureCharts::ANYWHERE || charts->is_on_seam(uint32_t(u.idx())))
            return 0;
        const Place &place =
            charts->at(uint32_t(surface.face_handle(h).idx()), uint32_t(v.idx()));
        const float values[2] = {texture_scale * place[0], texture_scale * place[1]};
        return gradients.loss(size_t(u.idx()), node(v).point - node(u).point, values,
                              CWI_TEXTURE_ATTRIBUTES);
    }

    void join_gradients(HalfedgeHandle h, cwi_quadric &quadric)
    {
        const VertexHandle u = surface.from_vertex_handle(h), v = surface.to_vertex_handle(h);
        gradients.join(size_t(u.idx()), size_t(v.idx()), node(v).point - node(u).point,
                       quadric);
    }

    void store_gradients(const Proposal &p)
    {
        cwi_quadric known = p.quadric;
        join_gradients(p.halfedge, known);
        gradients.put(size_t(surface.to_vertex_handle(p.halfedge).idx()),
                      p.position - node(surface.from_vertex_handle(p.halfedge)).point);
    }

    void try_to_collapse(const Proposal &p)
    {
        const VertexHandle kept = surface.to_vertex_handle(p.halfedge);
        const Node &gone = node(surface.from_vertex_handle(p.halfedge));
        Node &stays = node(kept);
        if (std::isinf(p.cost))
            return;
        if (!shape.is_inside(p.position)) {
            stays.open = true;
            return;
        }
        if (!OneRing::is_small(surface, p.halfedge)) {
            node(surface.from_vertex_handle(p.halfedge)).wide = stays.wide = true;
            return;
        }
        if (!surface.is_collapse_ok(p.halfedge) ||
            !ring.gather(surface, p.halfedge, p.position) || !shape.is_kept(ring) ||
            (charts->is_requested() && !charts->is_kept(surface, p.halfedge, ring)) ||
            shells.turns(surface, ring, &stays.open) || !bound.is_kept(surface, ring) ||
            shells.sweeps(surface, ring) || (contact && contact->arises(surface, ring)))
            return;
        bound.change(ring);
        shells.change(ring);
        if (gradients.is_requested())
            store_gradients(p);
        if (charts->is_requested() && target_of(p.halfedge) != TextureCharts::ANYWHERE)
            gradients.drop(size_t(kept.idx()));
        const VertexHandle sides[2] = {
            vertex_across(p.halfedge),
            vertex_across(surface.opposite_halfedge_handle(p.halfedge))};
        if (charts->is_requested())
            charts->change(surface, p.halfedge, ring);
        surface.set_point(kept, p.position);
        surface.collapse(p.halfedge);
        if (contact)
            contact->change(surface, ring);
        stays.quadric = moved(p.quadric, p.position - gone.point);
        stays.point = p.position;
        stays.border |= gone.border;
        stays.open |= gone.open;
        stays.changed = ++tick;
        live -= ring.gone.size();
        for (auto e = surface.cve_iter(kept); e.is_valid(); ++e)
            wait_again(*e, kept, p.cost);
        for (const VertexHandle side : sides)
            if (side.is_valid() && node(side).wide)
                try_narrowed(side, p.cost);
    }

    // The third vertex of a halfedge's triangle; invalid at a border.
    VertexHandle vertex_across(HalfedgeHandle h) const
    {
        return surface.is_boundary(h)
                   ? VertexHandle()
                   : surface.to_vertex_handle(surface.next_halfedge_handle(h));
    }

    // Puts the edges at a vertex into the queue that were not tried because of its many triangles, as
    // soon as these are few enough.
    void try_narrowed(VertexHandle v, float cost)
    {
        const HalfedgeHandle any = surface.halfedge_handle(v);
        if (!any.is_valid() || !OneRing::is_small(surface, any))
            return;
        node(v).wide = false;
        for (auto e = surface.cve_iter(v); e.is_valid(); ++e) {
            const auto i = size_t(e->idx());
            const HalfedgeHandle h = surface.halfedge_handle(*e, 0);
            if (waiting[i] || node(surface.from_vertex_handle(h)).locked ||
                node(surface.to_vertex_handle(h)).locked)
                continue;
            waiting[i] = true;
            queue.push(Queue::entry(std::max(propose(*e).cost, cost), uint32_t(i)));
        }
    }

    // Puts an edge into the queue again: a collapse that was refused before may pass now.
    void wait_again(EdgeHandle e, VertexHandle kept, float cost)
    {
        const auto i = size_t(e.idx());
        const HalfedgeHandle h = surface.halfedge_handle(e, 0);
        const VertexHandle other = surface.to_vertex_handle(h) == kept
                                       ? surface.from_vertex_handle(h)
                                       : surface.to_vertex_handle(h);
        if (waiting[i] || node(other).locked)
            return;
        waiting[i] = true;
        queue.push(Queue::entry(cost, uint32_t(i)));
    }
};

namespace
{

cw_status open(const cwi_mesh_block *block, const cwi_block_desc *desc,
               const cwi_original *original, cwi_decimater **out, cw_error *err)
{
    return guard(err, "OpenMesh", [&] {
        *out = new cwi_decimater(*block, *desc, original);
        return CW_OK;
    });
}

cw_status run(cwi_decimater *decimater, float cost, size_t min_triangles, cw_error *err)
{
    return guard(err, "OpenMesh", [&] {
        decimater->run(cost, min_triangles);
        return CW_OK;
    });
}

size_t triangles(const cwi_decimater *decimater)
{
    return decimater->live;
}

float next(const cwi_decimater *decimater)
{
    return decimater->queue.empty() ? INFINITY : Queue::cost(decimater->queue.top());
}

void close(cwi_decimater *decimater)
{
    delete decimater;
}

template <typename T> T *array(size_t count)
{
    T *memory = static_cast<T *>(cwi_alloc_array(count, sizeof(T)));
    if (!memory)
        throw std::bad_alloc();
    return memory;
}

void copy_gradients(const cwi_decimater &d, cwi_mesh_block &out,
                    const std::vector<uint32_t> &numbers)
{
    out.attributes = d.gradients.size();
    out.areas = array<float>(out.vertices);
    out.gradients = array<cwi_attribute_gradient>(out.attributes * out.vertices);
    for (size_t v = 0; v < numbers.size(); v++) {
        if (numbers[v] == UINT32_MAX)
            continue;
        out.areas[numbers[v]] = d.gradients.area(v);
        std::copy_n(d.gradients.of(v), out.attributes,
                    out.gradients + out.attributes * numbers[v]);
    }
}

// Vertices that triangles are left around, in their old order.
void take_vertices(const cwi_decimater &d, cwi_mesh_block &out, std::vector<uint32_t> &numbers)
{
    numbers.assign(d.surface.n_vertices(), UINT32_MAX);
    for (const auto v : d.surface.vertices())
        if (!v.deleted() && v.halfedge().is_valid())
            numbers[size_t(v.idx())] = uint32_t(out.vertices++);
    out.points = array<float>(3 * out.vertices);
    out.global_ids = array<uint32_t>(out.vertices);
    out.locked = array<uint8_t>(out.vertices);
    out.open = array<uint8_t>(out.vertices);
    out.quadrics = array<cwi_quadric>(out.vertices);
    for (size_t v = 0; v < numbers.size(); v++) {
        const size_t n = numbers[v];
        if (n == UINT32_MAX)
            continue;
        for (unsigned k = 0; k < 3; k++)
            out.points[3 * n + k] = d.surface.point(VertexHandle(int(v)))[k];
        out.global_ids[n] = d.global_ids[v];
        out.locked[n] = d.nodes[v].locked;
        out.open[n] = d.nodes[v].open;
        out.quadrics[n] = d.nodes[v].quadric;
    }
    if (d.gradients.is_requested())
        copy_gradients(d, out, numbers);
}

void take_triangles(const cwi_decimater &d, cwi_mesh_block &out,
                    const std::vector<uint32_t> &numbers)
{
    out.corners = array<uint32_t>(3 * d.live);
    if (d.bound.is_requested())
        out.nearest_points = array<uint32_t>(d.live);
    if (d.charts->is_requested())
        out.texture = array<float>(6 * d.live);
    for (const auto f : d.surface.faces()) {
        if (f.deleted())
            continue;
        size_t corner = 3 * out.triangles;
        for (const auto v : f.vertices()) {
            if (out.texture)
                std::copy_n(d.charts->at(uint32_t(f.idx()), uint32_t(v.idx())).data(), 2,
                            out.texture + 2 * corner);
            out.corners[corner++] = numbers[size_t(v.idx())];
        }
        if (out.nearest_points)
            out.nearest_points[out.triangles] = d.bound.list(uint32_t(f.idx()));
        out.triangles++;
    }
    out.interior_count = out.triangles;
}

cw_status take(const cwi_decimater *decimater, cwi_mesh_block *out, cw_error *err)
{
    *out = cwi_mesh_block{};
    out->nonmanifold_count = decimater->nonmanifold_count;
    out->texture_scale = decimater->texture_scale;
    return guard(err, "OpenMesh", [&] {
        std::vector<uint32_t> numbers;
        take_vertices(*decimater, *out, numbers);
        take_triangles(*decimater, *out, numbers);
        return CW_OK;
    });
}

} // namespace

const cwi_openmesh_functions cwi_module_openmesh = {open, run, triangles, next, take, close};
