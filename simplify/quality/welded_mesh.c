/* Welds the equal points of a mesh for the checks, and sorts its triangles into a tree of
 * boxes. */
#include "simplify/quality/welded_mesh.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/bvh.h"
#include "core/mesh/mesh.h"
#include "core/mesh/weld.h"
#include "core/mesh/wide_fans.h"

/* Chooses the points that are compared to weld vertices: positions, or world points. */
static bool choose_points(cwi_welded *w, cw_weld how)
{
    const cw_mesh *mesh = w->mesh;
    w->points = mesh->positions;
    if (how != CW_WELD_WORLD)
        return true;
    w->points = w->own_points = cwi_alloc_array(mesh->vertex_count, 3 * sizeof(float));
    for (size_t i = 0; i < 3 * mesh->vertex_count && w->own_points; i++)
        w->own_points[i] = (float)(mesh->origin[i % 3] + (double)mesh->positions[i]);
    return w->own_points;
}

static bool weld_corners(cwi_welded *w, cw_weld how)
{
    const size_t corners = 3 * w->mesh->triangle_count, vertices = w->mesh->vertex_count;
    w->vertex = w->mesh->triangles;
    if (!how)
        return true;
    uint32_t *map = cwi_alloc_array(vertices, sizeof *map);
    w->vertex = w->own_vertex = cwi_alloc_array(corners, sizeof *w->own_vertex);
    const bool ok = w->vertex && map && cwi_weld(w->points, vertices, map);
    for (size_t c = 0; c < corners && ok; c++)
        w->own_vertex[c] = map[w->mesh->triangles[c]];
    cwi_free(map);
    return ok;
}

cw_status cwi_welded_init(cwi_welded *w, const cw_mesh *mesh, cw_weld how, cw_error *err)
{
    *w = (cwi_welded){.mesh = mesh};
    cw_status st = cw_mesh_check(mesh, err);
    if (st == CW_OK && mesh->triangle_count > CWI_MAX_TRIANGLES)
        st = cwi_fail(err, CW_ERR_LIMIT, "%zu triangles are more than the checks can number",
                      mesh->triangle_count);
    if (st == CW_OK && !(choose_points(w, how) && weld_corners(w, how)))
        st = cwi_fail_memory(err);
    return st;
}

bool cwi_welded_sort(const cwi_welded *w, const uint32_t *fan_of, int threads, cwi_boxes *tree)
{
    const size_t count = w->mesh->triangle_count;
    float(*boxes)[6] = cwi_alloc_large(count, sizeof *boxes);
    uint32_t *triangle = cwi_alloc_array(count, sizeof *triangle);
    bool ok = boxes && triangle;
    size_t kept = 0;
    for (size_t t = 0; t < count && ok; t++)
        if ((!fan_of || fan_of[t] == CWI_NO_FAN) && !cwi_is_flat(w, t)) {
            cwi_boxes_triangle(w->points, w->vertex + 3 * t, boxes[kept]);
            triangle[kept++] = (uint32_t)t;
        }
    ok = ok && cwi_boxes_build_by(tree, (const float(*)[6])boxes, kept, threads, NULL) == CW_OK;
    for (size_t n = 0; n < kept && ok; n++)
        tree->order[n] = triangle[tree->order[n]];
    cwi_free(boxes);
    cwi_free(triangle);
    return ok;
}

void cwi_welded_free(cwi_welded *w)
{
    cwi_free(w->own_points);
    cwi_free(w->own_vertex);
    *w = (cwi_welded){0};
}
