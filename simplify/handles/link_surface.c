/* Links the sides of a surface, and finds its borders and the vertices that no loop may pass. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/triangle.h"
#include "core/mesh/corner_table.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_triangle.h"
#include "simplify/handles/handle_state.h"

#include <math.h>
#include <string.h>

void cwi_handles_free(cwi_handles *h)
{
    cwi_boxes_free(&h->tree);
    cwi_free(h->positions);
    cwi_free(h->source);
    cwi_free(h->first);
    cwi_free(h->fixed);
    cwi_free(h->triangles);
    cwi_free(h->twin);
    cwi_free(h->avoided);
    cwi_free(h->changed);
    cwi_free(h->border);
    cwi_free(h->border_end);
    cwi_free(h->border_of);
    cwi_free(h->signs);
    *h = (cwi_handles){0};
}

/* Lengthens an array; clear: what is new is zeroed. Returns false when memory is out. */
static bool lengthen(void *array, size_t from, size_t to, size_t size, bool clear)
{
    void *memory;
    memcpy(&memory, array, sizeof memory);
    memory = cwi_realloc_array(memory, to, size);
    if (!memory)
        return false;
    memcpy(array, &memory, sizeof memory);
    if (clear)
        memset((char *)memory + from * size, 0, (to - from) * size);
    return true;
}

static bool grow_vertices(cwi_handles *h, size_t needed)
{
    const size_t from = h->vertex_capacity, to = needed + needed / 8;
    if (needed <= from)
        return true;
    const bool ok = lengthen(&h->positions, from, to, 3 * sizeof *h->positions, false) &&
                    lengthen(&h->source, from, to, sizeof *h->source, false) &&
                    lengthen(&h->first, from, to, sizeof *h->first, false) &&
                    lengthen(&h->fixed, from, to, 1, true);
    h->vertex_capacity = ok ? to : from;
    return ok;
}

static bool grow_triangles(cwi_handles *h, size_t needed)
{
    const size_t from = h->triangle_capacity, to = needed + needed / 8;
    if (needed <= from)
        return true;
    const bool ok = lengthen(&h->triangles, from, to, 3 * sizeof *h->triangles, false) &&
                    lengthen(&h->twin, from, to, 3 * sizeof *h->twin, false) &&
                    lengthen(&h->avoided, from, to, 3, true) &&
                    lengthen(&h->changed, from, to, 1, true) &&
                    lengthen(&h->signs, from, to, 3 * sizeof *h->signs, false);
    h->triangle_capacity = ok ? to : from;
    return ok;
}

cw_status cwi_handles_reserve(cwi_handles *h, size_t vertices, size_t triangles, cw_error *err)
{
    const size_t v = h->vertex_count + vertices, t = h->triangle_count + triangles;
    if (v > CWI_MAX_TRIANGLES || t > CWI_MAX_TRIANGLES)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "closing handles would make %zu triangles, and %zu "
                        "vertices; %zu are the limit",
                        t, v, CWI_MAX_TRIANGLES);
    return grow_vertices(h, v) && grow_triangles(h, t) ? CW_OK : cwi_fail_memory(err);
}

/* Joins the sides of edges that have two, in opposite directions. Those of triangles that name a vertex twice stay
 * open. */
static bool join_sides(cwi_handles *h)
{
    const size_t corners = 3 * h->triangle_count;
    cwi_side *sides = cwi_alloc_array(corners, sizeof *sides);
    if (!sides)
        return false;
    cwi_sides_list(h->triangles, corners, sides);
    memset(h->twin, 0xff, corners * sizeof *h->twin);
    for (size_t n = 0, along; n < corners; n += along) {
        along = cwi_sides_along(sides, corners, n);
        const uint32_t a = sides[n].corner, b = sides[n + along - 1].corner;
        if (along == 2 && h->triangles[a] != h->triangles[b] &&
            !cwi_triangle_is_collapsed(h->triangles + a / 3 * 3) &&
            !cwi_triangle_is_collapsed(h->triangles + b / 3 * 3))
            cwi_twins_join(h->twin, a, b);
    }
    cwi_free(sides);
    return true;
}

/* --- fans --------------------------------------------------------------------------------- */

/* Marks the corners of the fan with a corner. Returns true if the fan has no open side. */
static bool mark_fan(const cwi_handles *h, uint32_t corner, uint8_t *visited)
{
    uint32_t c = corner;
    do {
        visited[c] = 1;
        c = h->twin[cwi_corner_prev(c)];
    } while (c != CWI_NO_CORNER && c != corner);
    if (c == corner)
        return true;
    for (c = corner; h->twin[c] != CWI_NO_CORNER;) {
        c = cwi_corner_next(h->twin[c]);
        visited[c] = 1;
    }
    return false;
}

/* Finds a corner at each vertex, and counts fans. Vertices without a fan that is closed and the only one are
 * fixed. */
static bool find_fans(cwi_handles *h)
{
    const size_t corners = 3 * h->triangle_count;
    uint8_t *visited = cwi_alloc_zeroed(corners, 1);
    if (!visited)
        return false;
    memset(h->first, 0xff, h->vertex_count * sizeof *h->first);
    for (uint32_t c = 0; c < corners; c++) {
        if (visited[c])
            continue;
        const uint32_t v = h->triangles[c];
        h->fixed[v] |= !mark_fan(h, c, visited) || h->first[v] != CWI_NO_CORNER;
        h->first[v] = c;
        h->fan_count++;
    }
    cwi_free(visited);
    return true;
}

/* --- borders ------------------------------------------------------------------------------ */

/* Returns the open side that follows an open side: around the fan at its end. */
static uint32_t follow_border(const cwi_handles *h, uint32_t side)
{
    uint32_t c = cwi_corner_next(side);
    while (h->twin[c] != CWI_NO_CORNER)
        c = cwi_corner_next(h->twin[c]);
    return c;
}

static bool find_borders(cwi_handles *h)
{
    const size_t corners = 3 * h->triangle_count;
    size_t open = 0;
    for (size_t c = 0; c < corners; c++)
        open += h->twin[c] == CWI_NO_CORNER;
    if (!open)
        return true;
    h->border = cwi_alloc_array(open, sizeof *h->border);
    h->border_end = cwi_alloc_array(open, sizeof *h->border_end);
    h->border_of = cwi_alloc_array(corners, sizeof *h->border_of);
    if (!h->border || !h->border_end || !h->border_of)
        return false;
    memset(h->border_of, 0xff, corners * sizeof *h->border_of);
    for (uint32_t c = 0; c < corners; c++) {
        if (h->twin[c] != CWI_NO_CORNER || h->border_of[c] != CWI_ADDED)
            continue;
        for (uint32_t at = c; h->border_of[at] == CWI_ADDED; at = follow_border(h, at)) {
            h->border_of[at] = (uint32_t)h->border_count;
            h->border[h->open_count++] = at;
        }
        h->border_end[h->border_count++] = h->open_count;
    }
    return true;
}

static double measure_edges(const cw_mesh *m)
{
    double sum = 0;
    for (size_t t = 0; t < m->triangle_count; t++)
        for (size_t k = 0; k < 3; k++)
            sum += sqrt(cwi_point_distance_sq(cwi_mesh_point(m, t, k),
                                              cwi_mesh_point(m, t, (k + 1) % 3)));
    return sum / (3 * (double)m->triangle_count);
}

cw_status cwi_handles_link(cwi_handles *h, cw_error *err)
{
    const cw_mesh *m = h->mesh;
    cw_status st = cwi_handles_reserve(h, m->vertex_count, m->triangle_count, err);
    if (st != CW_OK)
        return st;
    h->mean_edge = measure_edges(m);
    h->vertex_count = m->vertex_count;
    h->triangle_count = m->triangle_count;
    memcpy(h->positions, m->positions, 3 * m->vertex_count * sizeof *h->positions);
    memcpy(h->triangles, m->triangles, 3 * m->triangle_count * sizeof *h->triangles);
    for (uint32_t v = 0; v < m->vertex_count; v++)
        h->source[v] = v;
    return join_sides(h) && find_fans(h) && find_borders(h) ? CW_OK : cwi_fail_memory(err);
}
