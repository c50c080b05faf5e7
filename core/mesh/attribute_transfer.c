/* Carries attributes to another mesh from known sources, or from the closest point of the first,
 * found by a tree of boxes. */
#include "core/mesh/attribute_transfer.h"

#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/closest_point.h"
#include "core/mesh/mesh_attributes.h"
#include "core/mesh/mesh_triangle.h"
#include "core/mesh/triangle_boxes.h"

enum { CHUNK = 1024 };

/* How far from a corner to the middle of its triangle the point is that tells the side of a seam. */
static const double INWARD = 0.05;

typedef struct carrier {
    const cw_mesh *from;
    cwi_sources sources;
    cw_mesh *to;
    cwi_boxes tree;
} carrier;

static uint32_t source_at(const uint32_t *sources, size_t n)
{
    return sources ? sources[n] : UINT32_MAX;
}

static void carry_vertices(void *context, size_t chunk)
{
    const carrier *c = context;
    for (size_t v = chunk * CHUNK; v < (chunk + 1) * CHUNK && v < c->to->vertex_count; v++) {
        const uint32_t source = source_at(c->sources.vertices, v);
        if (source != UINT32_MAX) {
            cwi_attributes_put(c->from, source, c->to, v);
            continue;
        }
        double point[3];
        for (size_t a = 0; a < 3; a++)
            point[a] = (double)c->to->positions[3 * v + a];
        const cwi_closest at = cwi_closest_find(c->from, &c->tree, point);
        cwi_attributes_mix(c->from, c->from->triangles + 3 * at.triangle, at.weights, 3, c->to,
                           v);
    }
}

/* Finds the triangle that is closest to the middle of another, or to a point inside near its corner k: so
 * that a corner beside a seam takes its attributes from its own side. */
static size_t find_triangle(const carrier *c, size_t t, const double corner[3])
{
    double p[3][3], point[3];
    cwi_mesh_corners(c->to, t, p);
    cwi_triangle_centroid(p[0], p[1], p[2], point);
    if (corner)
        cwi_lerp(corner, point, INWARD, point);
    return cwi_closest_find(c->from, &c->tree, point).triangle;
}

static void carry_triangle(const carrier *c, size_t t)
{
    const uint32_t source = source_at(c->sources.triangles, t);
    uint32_t same[3];
    for (size_t k = 0; k < 3; k++)
        same[k] = source_at(c->sources.vertices, c->to->triangles[3 * t + k]);
    if (source != UINT32_MAX) {
        cwi_attributes_put_triangle(c->from, source, same, c->to, t);
        return;
    }
    cwi_attributes_put_triangle(c->from, find_triangle(c, t, NULL), same, c->to, t);
    for (size_t k = 0; k < 3 && cwi_attributes_any(c->from, 1u << CW_ON_CORNERS); k++) {
        double corner[3];
        cwi_mesh_corner(c->to, t, k, corner);
        cwi_attributes_put_corner(c->from, find_triangle(c, t, corner), same[k], c->to,
                                  3 * t + k);
    }
}

static void carry_triangles(void *context, size_t chunk)
{
    const carrier *c = context;
    for (size_t t = chunk * CHUNK; t < (chunk + 1) * CHUNK && t < c->to->triangle_count; t++)
        carry_triangle(c, t);
}

cw_status cwi_carry(const cw_mesh *from, const cwi_sources *sources, int threads,
                    const cw_progress *progress, cw_mesh *to, cw_error *err)
{
    carrier c = {.from = from, .sources = sources ? *sources : (cwi_sources){0}, .to = to};
    cw_status st = cwi_attributes_alloc(from, to, err);
    if (st != CW_OK || !cwi_attributes_any(from, ~0u))
        return st;
    st = cwi_triangle_boxes_build(&c.tree, from->positions, from->vertex_count, from->triangles,
                                  from->triangle_count, err);
    if (st == CW_OK && cwi_attributes_any(from, 1u << CW_ON_VERTICES))
        st = cwi_parallel_for((to->vertex_count + CHUNK - 1) / CHUNK, CHUNK * 64, threads,
                              progress, "carrying", carry_vertices, &c, err);
    if (st == CW_OK && cwi_attributes_any(from, 1u << CW_ON_CORNERS | 1u << CW_ON_TRIANGLES))
        st = cwi_parallel_for((to->triangle_count + CHUNK - 1) / CHUNK, CHUNK * 64, threads,
                              progress, "carrying", carry_triangles, &c, err);
    cwi_boxes_free(&c.tree);
    return st;
}
