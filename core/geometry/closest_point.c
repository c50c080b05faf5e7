/* Finds the point of a mesh closest to a given point, by a tree of boxes around its
 * triangles. */
#include "core/geometry/closest_point.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/point_triangle.h"

#include <math.h>

static void load_corners(const cw_mesh *m, size_t triangle, const float *p[3])
{
    for (size_t k = 0; k < 3; k++)
        p[k] = m->positions + 3 * (size_t)m->triangles[3 * triangle + k];
}

cw_status cwi_closest_build(const cw_mesh *m, cwi_boxes *tree, cw_error *err)
{
    float(*boxes)[6] = cwi_alloc_array(m->triangle_count, sizeof *boxes);
    if (!boxes)
        return cwi_fail_memory(err);
    for (size_t t = 0; t < m->triangle_count; t++)
        cwi_boxes_triangle(m->positions, m->triangles + 3 * t, boxes[t]);
    cw_status st = cwi_boxes_build(tree, (const float(*)[6])boxes, m->triangle_count, err);
    cwi_free(boxes);
    return st;
}

typedef struct search {
    const cw_mesh *mesh;
    const cwi_boxes *tree;
    const double *point;
    size_t triangle;
} search;

static void measure_slot(void *context, size_t slot, double *distance_sq)
{
    search *s = context;
    const float *p[3];
    load_corners(s->mesh, s->tree->order[slot], p);
    const double here = cwi_facet_distance_sq(p[0], p[1], p[2], s->point);
    if (here < *distance_sq) {
        *distance_sq = here;
        s->triangle = s->tree->order[slot];
    }
}

cwi_closest cwi_closest_find(const cw_mesh *mesh, const cwi_boxes *tree, const double point[3])
{
    search s = {.mesh = mesh, .tree = tree, .point = point};
    double distance_sq = INFINITY;
    const float *p[3];
    cwi_closest c = {0};
    cwi_boxes_nearest(tree, point, measure_slot, &s, &distance_sq);
    c.triangle = s.triangle;
    load_corners(mesh, c.triangle, p);
    cwi_facet_nearest(p[0], p[1], p[2], point, c.weights);
    for (int a = 0; a < 3; a++)
        for (int k = 0; k < 3; k++)
            c.point[a] += c.weights[k] * (double)p[k][a];
    return c;
}
