/* Carries normals, colours, scalars and labels to another mesh, from the closest point of the
 * first, found by a tree of boxes. */
#include "simplify/attribute_transfer.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/closest_point.h"
#include "core/geometry/vec3.h"

#include <math.h>

enum { CHUNK = 1024 };

typedef struct carrier {
    const cw_mesh *from;
    cw_mesh *to;
    cwi_boxes tree;
} carrier;

static void blend_attributes(const carrier *c, const uint32_t corner[3], const double share[3],
                             size_t v)
{
    const cw_mesh *m = c->from;
    cw_mesh *to = c->to;
    double normal[3] = {0}, color[4] = {0}, scalar = 0;
    size_t nearest = 0;
    for (size_t k = 0; k < 3; k++) {
        const size_t from = corner[k];
        nearest = share[k] > share[nearest] ? k : nearest;
        for (size_t a = 0; a < 3 && m->normals; a++)
            normal[a] += share[k] * (double)m->normals[3 * from + a];
        for (size_t a = 0; a < 4 && m->colors; a++)
            color[a] += share[k] * (double)m->colors[4 * from + a];
        if (m->scalars)
            scalar += share[k] * (double)m->scalars[from];
    }
    const double length = cwi_length(normal);
    for (size_t a = 0; a < 3 && m->normals; a++)
        to->normals[3 * v + a] = length > 0 ? (float)(normal[a] / length)
                                            : m->normals[3 * (size_t)corner[nearest] + a];
    for (size_t a = 0; a < 4 && m->colors; a++)
        to->colors[4 * v + a] = (uint8_t)(color[a] + 0.5);
    if (m->scalars)
        to->scalars[v] = (float)scalar;
    if (m->labels)
        to->labels[v] = m->labels[corner[nearest]];
}

static void carry_chunk(void *context, size_t chunk)
{
    const carrier *c = context;
    for (size_t v = chunk * CHUNK; v < (chunk + 1) * CHUNK && v < c->to->vertex_count; v++) {
        double point[3];
        for (size_t a = 0; a < 3; a++)
            point[a] = (double)c->to->positions[3 * v + a];
        const cwi_closest at = cwi_closest_find(c->from, &c->tree, point);
        blend_attributes(c, c->from->triangles + 3 * at.triangle, at.share, v);
    }
}

static bool alloc_carried(const cw_mesh *from, cw_mesh *to)
{
    const size_t n = to->vertex_count;
    if (from->normals)
        to->normals = cwi_alloc_array(3 * n, sizeof *to->normals);
    if (from->scalars)
        to->scalars = cwi_alloc_array(n, sizeof *to->scalars);
    if (from->colors)
        to->colors = cwi_alloc_array(4 * n, sizeof *to->colors);
    if (from->labels)
        to->labels = cwi_alloc_array(n, sizeof *to->labels);
    return !from->normals == !to->normals && !from->scalars == !to->scalars &&
           !from->colors == !to->colors && !from->labels == !to->labels;
}

cw_status cwi_carry(const cw_mesh *from, int threads, const cw_progress *progress, cw_mesh *to,
                    cw_error *err)
{
    carrier c = {.from = from, .to = to};
    if (!from->normals && !from->scalars && !from->colors && !from->labels)
        return CW_OK;
    if (!alloc_carried(from, to))
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for %zu vertices", to->vertex_count);
    cw_status st = cwi_closest_build(from, &c.tree, err);
    if (st == CW_OK)
        st = cwi_each_layer((to->vertex_count + CHUNK - 1) / CHUNK, CHUNK * 64, threads,
                            progress, "carrying", carry_chunk, &c, err);
    cwi_boxes_free(&c.tree);
    return st;
}
