/* Finds on which side of the plane vertices lie. Those very near to it move into it, so that the cut makes
 * no slivers along the section; a comparison of volumes tells if they moved too far. */
#include "core/base/memory.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh_triangle.h"
#include "simplify/cut/cut_state.h"

#include <math.h>

/* A vertex moves into the plane, and neighbours in it merge, if they are nearer than these fractions, of the longest edge at it and of the
 * largest coordinate. Extracted vertices are 1/1024 of a voxel from samples or more, and planes often run
 * through samples. */
static const double NEAR_EDGE = 1.0 / 512, NEAR_SIZE = 0x1p-16;

/* The largest change of the volume that is kept, as a fraction of it. */
static const double MAX_VOLUME_CHANGE = 1e-6;

/* Sets how near to the plane each vertex may be to move into it. Returns false when memory is out. */
static bool find_nearness(cwi_cut *c, double largest)
{
    const cw_mesh *m = c->mesh;
    c->near = cwi_alloc_zeroed(m->vertex_count, sizeof *c->near);
    for (size_t n = 0; n < 3 * m->triangle_count && c->near; n++) {
        const uint32_t a = m->triangles[n], b = m->triangles[n % 3 == 2 ? n - 2 : n + 1];
        const double length_sq =
            cwi_point_distance_sq(m->positions + 3 * (size_t)a, m->positions + 3 * (size_t)b);
        c->near[a] = cwi_greater(c->near[a], length_sq);
        c->near[b] = cwi_greater(c->near[b], length_sq);
    }
    for (size_t v = 0; v < m->vertex_count && c->near; v++)
        c->near[v] = c->nearness * fmin(NEAR_SIZE * largest, NEAR_EDGE * sqrt(c->near[v]));
    return c->near;
}

bool cwi_cut_find_sides(cwi_cut *c, double largest, bool has[3])
{
    const cw_mesh *m = c->mesh;
    c->side = cwi_alloc_array(m->vertex_count, sizeof *c->side);
    if (!c->side || (c->nearness > 0 && !find_nearness(c, largest)))
        return false;
    for (size_t v = 0; v < m->vertex_count; v++) {
        const double near = c->near ? fmax(c->tolerance, c->near[v]) : c->tolerance,
                     distance = cwi_cut_distance(c, v);
        c->side[v] = (int8_t)((distance > near) - (distance < -near));
    }
    for (size_t n = 0; n < 3 * m->triangle_count; n++)
        has[c->side[m->triangles[n]] + 1] = true;
    return true;
}

/* Returns six times the volume of the cone over a triangle; its tip is `tip`, in the plane. */
static double measure_cone(const double tip[3], const double corners[3][3])
{
    double edges[3][3], normal[3];
    for (int k = 0; k < 3; k++)
        cwi_sub(corners[k], tip, edges[k]);
    cwi_cross(edges[1], edges[2], normal);
    return cwi_dot(edges[0], normal);
}

/* Returns the same for what is above the plane of a triangle. */
static double measure_kept_cone(const cwi_cut *c, const double tip[3], size_t t)
{
    double p[3][3], height[3], corner[3][3];
    int above = 0;
    cwi_mesh_corners(c->mesh, t, p);
    for (int k = 0; k < 3; k++) {
        height[k] = cwi_dot(c->normal, p[k]) - c->offset;
        above += height[k] > 0;
    }
    const double whole = above ? measure_cone(tip, (const double(*)[3])p) : 0;
    if (above == 0 || above == 3)
        return whole;
    int apex = 0; /* the corner that the plane cuts off */
    while ((height[apex] > 0) != (above == 1))
        apex++;
    for (int k = 0; k < 3; k++) {
        const double t_cut = k == apex ? 0 : height[apex] / (height[apex] - height[k]);
        for (int a = 0; a < 3; a++)
            corner[k][a] = p[apex][a] + t_cut * (p[k][a] - p[apex][a]);
    }
    const double cut_off = measure_cone(tip, (const double(*)[3])corner);
    return above == 1 ? cut_off : whole - cut_off;
}

bool cwi_cut_keeps_volume(const cwi_cut *c)
{
    const cw_mesh made = {.positions = c->positions, .triangles = c->triangles};
    double tip[3], exact = 0, found = 0;
    for (int a = 0; a < 3; a++)
        tip[a] = c->offset * c->normal[a];
    for (size_t t = 0; t < c->mesh->triangle_count; t++)
        exact += measure_kept_cone(c, tip, t);
    for (size_t t = 0; t < c->triangle_count; t++) {
        double p[3][3];
        cwi_mesh_corners(&made, t, p);
        found += measure_cone(tip, (const double(*)[3])p);
    }
    return fabs(found - exact) <= MAX_VOLUME_CHANGE * fabs(exact);
}
