/* Cuts polygons of files into triangles that do not overlap. The builder has made a fan of each, which is
 * right for most: convex ones, and those that can be seen whole from their first corner. */
#include "formats/mesh/face_polygons.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/clip_ears.h"

#include <math.h>
#include <string.h>

/* A polygon, seen along the axis along which it is largest. */
typedef struct polygon {
    const float *positions;
    uint32_t *triangles; /* count x 3: the fan */
    size_t count;
    cwi_ring_node *nodes; /* count + 2 of them */
    size_t capacity;
    size_t filled; /* triangles that have replaced the fan's */
} polygon;

/* Returns corner n of the polygon that a fan was made of. */
static uint32_t corner_of(const uint32_t *fan, size_t n)
{
    return n < 2 ? fan[n] : fan[3 * (n - 2) + 2];
}

/* Finds twice the area as seen along each axis (Newell's method). */
static void find_normal(const polygon *p, double normal[3])
{
    const float *origin = p->positions + 3 * (size_t)p->triangles[0];
    normal[0] = normal[1] = normal[2] = 0;
    for (size_t t = 0; t < p->count; t++) {
        double d[2][3];
        for (int k = 0; k < 2; k++)
            for (int a = 0; a < 3; a++)
                d[k][a] = (double)p->positions[3 * (size_t)p->triangles[3 * t + 1 + (size_t)k] +
                                               (size_t)a] -
                          (double)origin[a];
        for (int a = 0; a < 3; a++)
            normal[a] +=
                d[0][(a + 1) % 3] * d[1][(a + 2) % 3] - d[0][(a + 2) % 3] * d[1][(a + 1) % 3];
    }
}

/* Returns true if all triangles face the same way. */
static bool face_one_way(const polygon *p, int axis, int direction)
{
    for (size_t t = 0; t < p->count; t++) {
        const uint32_t *v = p->triangles + 3 * t;
        if (direction * cwi_orient2d(p->positions + 3 * (size_t)v[0],
                                     p->positions + 3 * (size_t)v[1],
                                     p->positions + 3 * (size_t)v[2], axis) <
            0)
            return false;
    }
    return true;
}

static bool put_triangle(void *user, uint32_t a, uint32_t b, uint32_t c)
{
    polygon *p = user;
    uint32_t *t = p->triangles + 3 * p->filled++;
    t[0] = a;
    t[1] = b;
    t[2] = c;
    return true;
}

/* Makes a ring of the corners, before their triangles are replaced. */
static bool make_ring(polygon *p)
{
    const uint32_t count = (uint32_t)p->count + 2;
    if (count > p->capacity) {
        cwi_ring_node *nodes = cwi_realloc_array(p->nodes, count, sizeof *nodes);
        if (!nodes)
            return false;
        p->nodes = nodes;
        p->capacity = count;
    }
    for (uint32_t n = 0; n < count; n++)
        p->nodes[n] = (cwi_ring_node){.vertex = corner_of(p->triangles, n),
                                      .next = n + 1 < count ? n + 1 : 0,
                                      .prev = n > 0 ? n - 1 : count - 1};
    p->filled = 0;
    return true;
}

/* Replaces the fan of a polygon that it does not fit. *crosses: the polygon crosses itself */
static cw_status cut_polygon(polygon *p, bool *crosses, cw_error *err)
{
    double normal[3];
    int axis = 0;
    *crosses = false;
    find_normal(p, normal);
    for (int a = 1; a < 3; a++)
        axis = fabs(normal[a]) > fabs(normal[axis]) ? a : axis;
    const int direction = normal[axis] < 0 ? -1 : 1;
    if (normal[axis] == 0 || !isfinite(normal[axis]) || face_one_way(p, axis, direction))
        return CW_OK;
    if (!make_ring(p))
        return cwi_fail_memory(err);
    cwi_ears ears = {.positions = p->positions,
                     .nodes = p->nodes,
                     .node_count = p->count + 2,
                     .axis = axis,
                     .direction = direction,
                     .add = put_triangle,
                     .user = p};
    cw_status st = cwi_clip_ears(&ears, 0, err);
    *crosses = st == CW_OK && !face_one_way(p, axis, direction);
    return st;
}

cw_status cwi_cut_polygons(const cwi_face_polygon *polygons, size_t count, cw_mesh *mesh,
                           size_t *crossing, cw_error *err)
{
    polygon p = {.positions = mesh->positions};
    cw_status st = CW_OK;
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        bool crosses;
        p.triangles = mesh->triangles + 3 * (size_t)polygons[n].first;
        p.count = polygons[n].count;
        st = cut_polygon(&p, &crosses, err);
        *crossing += crosses;
    }
    cwi_free(p.nodes);
    return st;
}
