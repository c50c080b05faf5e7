/* Cuts the surface along a loop: gives the right rim vertices of its own, and adds both caps. */
#include "core/base/memory.h"
#include "core/geometry/triangle.h"
#include "core/mesh/corner_table.h"
#include "simplify/handles/handle_state.h"

#include <string.h>

static uint32_t add_vertex(cwi_handles *h, const float point[3], uint32_t source)
{
    const uint32_t v = (uint32_t)h->vertex_count++;
    memcpy(h->positions + 3 * (size_t)v, point, 3 * sizeof *h->positions);
    h->source[v] = source;
    h->fixed[v] = 0;
    h->fan_count++;
    return v;
}

/* Marks the triangles around a vertex of a rim as changed: those from a side to the side before `end`.
 * vertex: their corners there get it */
static void change_fan(cwi_handles *h, uint32_t from, uint32_t end, uint32_t vertex)
{
    for (uint32_t c = from;; c = h->twin[cwi_corner_prev(c)]) {
        h->triangles[c] = vertex;
        h->changed[c / 3] = 1;
        if (cwi_corner_prev(c) == end)
            return;
    }
}

/* Moves both rims. rims: set to their vertices, left and right */
static void part_rims(cwi_handles *h, const uint32_t *sides, const cwi_handle_cut *cut,
                      uint32_t *rims)
{
    const uint32_t count = cut->count;
    for (uint32_t n = 0; n < count; n++) {
        const uint32_t v = h->triangles[sides[n]];
        rims[n] = v;
        memcpy(h->positions + 3 * (size_t)v, cut->rims[0] + 3 * (size_t)n,
               3 * sizeof *h->positions);
        rims[count + n] = add_vertex(h, cut->rims[1] + 3 * (size_t)n, h->source[v]);
    }
    for (uint32_t n = 0; n < count; n++) {
        const uint32_t before = sides[n ? n - 1 : count - 1];
        change_fan(h, sides[n], before, rims[n]);
        change_fan(h, h->twin[before], h->twin[sides[n]], rims[count + n]);
        h->first[rims[n]] = sides[n];
        h->first[rims[count + n]] = h->twin[before];
    }
}

/* Adds the triangles of a cap. Returns the first corner. */
static uint32_t add_cap(cwi_handles *h, const cwi_handle_cut *cut, int side,
                        const uint32_t *rims)
{
    const uint32_t first = 3 * (uint32_t)h->triangle_count, count = cut->count,
                   base = (uint32_t)h->vertex_count;
    for (size_t n = 0; n < cut->point_count[side]; n++)
        add_vertex(h, cut->points[side] + 3 * n, CWI_ADDED);
    for (uint32_t n = 0; n < 3 * cut->cap_count[side]; n++) {
        const uint32_t v = cut->caps[side][n];
        h->triangles[first + n] = v < count ? rims[(side ? count : 0) + v] : base + v - count;
        h->avoided[first + n] = 0;
        if (v >= count)
            h->first[base + v - count] = first + n;
    }
    memset(h->changed + h->triangle_count, 1, cut->cap_count[side]);
    h->triangle_count += cut->cap_count[side];
    return first;
}

/* Lists the sides of a cap and those of its rim, sorted by edges. keys: vertices of the cap */
static void list_sides(const cwi_handle_cut *cut, int side, uint32_t first,
                       const uint32_t *rim_sides, cwi_side *out)
{
    const uint32_t count = cut->count, corners = 3 * (uint32_t)cut->cap_count[side];
    cwi_sides_list(cut->caps[side], corners, out);
    for (uint32_t n = 0; n < corners; n++)
        out[n].corner += first;
    for (uint32_t n = 0; n < count; n++)
        out[corners + n] = (cwi_side){cwi_edge_key(n, (n + 1) % count), rim_sides[n]};
    cwi_sides_sort(out, corners + count);
}

bool cwi_handles_cut(cwi_handles *h, const cwi_loops *loops, const cwi_loop *loop,
                     const cwi_handle_cut *cut)
{
    const uint32_t *sides = loops->sides + loop->first, count = cut->count;
    const size_t most =
        cut->cap_count[0] > cut->cap_count[1] ? cut->cap_count[0] : cut->cap_count[1];
    uint32_t *rims = cwi_alloc_array(2 * (size_t)count, sizeof *rims);
    uint32_t *rim_sides = cwi_alloc_array(2 * (size_t)count, sizeof *rim_sides);
    cwi_side *list = cwi_alloc_array(3 * most + count, sizeof *list);
    const bool ok = rims && rim_sides && list;
    for (uint32_t n = 0; n < count && ok; n++) {
        rim_sides[n] = sides[n];
        rim_sides[count + n] = h->twin[sides[n]];
    }
    if (ok)
        part_rims(h, sides, cut, rims);
    for (int side = 0; side < 2 && ok; side++) {
        const uint32_t first = add_cap(h, cut, side, rims);
        const size_t listed = 3 * cut->cap_count[side] + count;
        list_sides(cut, side, first, rim_sides + (side ? count : 0), list);
        for (size_t n = 0; n + 1 < listed; n += 2)
            cwi_twins_join(h->twin, list[n].corner, list[n + 1].corner);
    }
    cwi_free(rims);
    cwi_free(rim_sides);
    cwi_free(list);
    return ok;
}
