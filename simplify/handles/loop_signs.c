/* Signs of sides, by which loops that separate the surface are known from those that do not.
 *
 * A tree of triangles reaches all of them, nearest ones first, and a tree of edges that it does not
 * cross reaches all vertices. Each edge in neither makes a loop of its own; there are two for each
 * handle [Eppstein2003]. Such an edge gets a random sign, an edge of the second tree 0, and an
 * edge of the first one what makes the sum around each triangle 0. So the sum along a loop that bounds
 * part of the surface is 0. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/triangle.h"
#include "core/geometry/union_find.h"
#include "core/mesh/corner_table.h"
#include "core/synthetic/random_fill.h"
#include "simplify/handles/handle_state.h"

#include <string.h>

/* The tree of triangles and borders. Node n is triangle n, or border n - triangle_count. */
typedef struct face_tree {
    const cwi_handles *h;
    size_t node_count, reached;
    uint32_t *order;   /* nodes, in the order in which they were reached */
    uint32_t *parent;  /* of a node: the side that it was reached by, or CWI_NO_CORNER */
    uint32_t *depth;   /* of a node */
    uint8_t *is_inner; /* of a side: the tree crosses its edge */
    size_t components;
} face_tree;

static void free_tree(face_tree *t)
{
    cwi_free(t->order);
    cwi_free(t->parent);
    cwi_free(t->depth);
    cwi_free(t->is_inner);
}

/* Returns the node on the other side of a side. */
static uint32_t node_beyond(const face_tree *t, uint32_t side)
{
    const uint32_t twin = t->h->twin[side];
    return twin != CWI_NO_CORNER ? twin / 3
                                 : (uint32_t)t->h->triangle_count + t->h->border_of[side];
}

/* Reaches a node from another. side: of the node that is reached, or the open side between them */
static void reach_node(face_tree *t, uint32_t node, uint32_t side, uint32_t depth)
{
    if (t->depth[node] != UINT32_MAX)
        return;
    t->depth[node] = depth;
    t->parent[node] = side;
    t->order[t->reached++] = node;
    if (side == CWI_NO_CORNER)
        return;
    t->is_inner[side] = 1;
    if (t->h->twin[side] != CWI_NO_CORNER)
        t->is_inner[t->h->twin[side]] = 1;
}

static void reach_neighbours(face_tree *t, uint32_t node)
{
    const cwi_handles *h = t->h;
    const uint32_t depth = t->depth[node] + 1;
    if (node < h->triangle_count) {
        for (uint32_t side = 3 * node; side < 3 * node + 3; side++)
            reach_node(t, node_beyond(t, side),
                       h->twin[side] != CWI_NO_CORNER ? h->twin[side] : side, depth);
        return;
    }
    const size_t border = node - h->triangle_count;
    for (size_t n = border ? h->border_end[border - 1] : 0; n < h->border_end[border]; n++)
        reach_node(t, h->border[n] / 3, h->border[n], depth);
}

static bool grow_tree(face_tree *t)
{
    const size_t corners = 3 * t->h->triangle_count;
    t->node_count = t->h->triangle_count + t->h->border_count;
    t->order = cwi_alloc_array(t->node_count, sizeof *t->order);
    t->parent = cwi_alloc_array(t->node_count, sizeof *t->parent);
    t->depth = cwi_alloc_array(t->node_count, sizeof *t->depth);
    t->is_inner = cwi_alloc_zeroed(corners, 1);
    if (!t->order || !t->parent || !t->depth || !t->is_inner)
        return false;
    memset(t->depth, 0xff, t->node_count * sizeof *t->depth);
    size_t done = 0;
    for (uint32_t start = 0; start < t->node_count; start++) {
        if (t->depth[start] != UINT32_MAX)
            continue;
        t->components++;
        reach_node(t, start, CWI_NO_CORNER, 0);
        for (; done < t->reached; done++)
            reach_neighbours(t, t->order[done]);
    }
    return true;
}

/* Returns true for the lower side of each edge that the tree of triangles does not cross. */
static bool is_outer(const face_tree *t, uint32_t side)
{
    return !t->is_inner[side] && side < t->h->twin[side];
}

static size_t add_depths(const face_tree *t, uint32_t side)
{
    return (size_t)t->depth[side / 3] + t->depth[node_beyond(t, side)];
}

/* Lists the edges that the tree does not cross, deepest ones first: so loops of edges that are left over
 * are short. */
static uint32_t *sort_outer(const face_tree *t, size_t *count)
{
    const uint32_t corners = 3 * (uint32_t)t->h->triangle_count;
    size_t deepest = 0;
    *count = 0;
    for (uint32_t side = 0; side < corners; side++)
        if (is_outer(t, side)) {
            const size_t depths = add_depths(t, side);
            deepest = depths > deepest ? depths : deepest;
            ++*count;
        }
    size_t *place = cwi_alloc_zeroed(deepest + 2, sizeof *place);
    uint32_t *outer = cwi_alloc_array(*count, sizeof *outer);
    for (uint32_t side = 0; side < corners && place && outer; side++)
        if (is_outer(t, side))
            place[deepest - add_depths(t, side) + 1]++;
    for (size_t d = 0; d < deepest && place; d++)
        place[d + 1] += place[d];
    for (uint32_t side = 0; side < corners && place && outer; side++)
        if (is_outer(t, side))
            outer[place[deepest - add_depths(t, side)]++] = side;
    cwi_free(place);
    if (!place)
        cwi_free(outer);
    return place ? outer : NULL;
}

static void set_sign(cwi_handles *h, uint32_t side, uint64_t sign)
{
    h->signs[side] = sign;
    if (h->twin[side] != CWI_NO_CORNER)
        h->signs[h->twin[side]] = sign;
}

/* Gives the edges that neither tree has signs of their own. */
static bool sign_loops(cwi_handles *h, const face_tree *t)
{
    size_t count, loops = 0;
    uint32_t *outer = sort_outer(t, &count), *sets = cwi_sets_alloc(h->vertex_count);
    const bool ok = outer && sets;
    for (size_t n = 0; n < count && ok; n++) {
        const uint32_t side = outer[n], a = cwi_sets_find(sets, h->triangles[side]),
                       b = cwi_sets_find(sets, h->triangles[cwi_corner_next(side)]);
        if (a != b)
            cwi_sets_join(sets, a, b);
        else
            set_sign(h, side, cwi_random_bits(0, loops++));
    }
    cwi_free(outer);
    cwi_free(sets);
    return ok;
}

/* Gives edges that the tree of triangles crosses their signs: from the last node to the first. */
static void sign_tree(cwi_handles *h, const face_tree *t)
{
    for (size_t n = t->reached; n-- > 0;) {
        const uint32_t node = t->order[n], parent = t->parent[node];
        uint64_t sum = 0;
        if (parent == CWI_NO_CORNER)
            continue;
        if (node < h->triangle_count) {
            for (uint32_t side = 3 * node; side < 3 * node + 3; side++)
                sum ^= side == parent ? 0 : h->signs[side];
        } else {
            const size_t border = node - h->triangle_count;
            for (size_t i = border ? h->border_end[border - 1] : 0; i < h->border_end[border];
                 i++)
                sum ^= h->border[i] == parent ? 0 : h->signs[h->border[i]];
        }
        set_sign(h, parent, sum);
    }
}

cw_status cwi_handles_sign(cwi_handles *h, cw_error *err)
{
    face_tree t = {.h = h};
    const size_t corners = 3 * h->triangle_count, edges = (corners + h->open_count) / 2;
    memset(h->signs, 0, corners * sizeof *h->signs);
    bool ok = grow_tree(&t);
    ok = ok && sign_loops(h, &t);
    if (ok)
        sign_tree(h, &t);
    /* 2 components - 2 genus = fans - edges + faces */
    h->components = t.components;
    h->genus =
        (2 * t.components + edges - h->fan_count - h->triangle_count - h->border_count) / 2;
    free_tree(&t);
    return ok ? CW_OK : cwi_fail_memory(err);
}
