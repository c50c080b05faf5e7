/* Casts rays at a surface: heights above a plane, and free space along a direction. */
#include "core/geometry/box.h"
#include "core/geometry/bvh_segment.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_triangle.h"
#include "core/mesh/triangle_boxes.h"
#include "simplify/engrave/engrave_state.h"

#include <string.h>

/* Tolerance of the weights of a triangle's corners, so that no ray slips between neighbours. */
static const double BESIDE = 1e-9;

/* Fraction of the diagonal before which hits do not count: the surface that a ray starts on. */
static const double START = 1e-6;

typedef struct ray {
    const cwi_ray_target *target;
    double from[3], vector[3];
    double wanted;   /* the fraction of the vector that the hit is to be next to */
    double least;    /* hits before this fraction do not count */
    bool faces_only; /* hits count where the surface faces the start */
    double found;    /* fraction of the best hit; INFINITY: none */
    double cosine;   /* of its normal and the vector turned round */
    cwi_boxes_segment segment;
} ray;

/* Returns the fraction of the vector at which a ray meets a triangle, or INFINITY [Moeller1997]. */
static double meet_triangle(const ray *r, double p[3][3])
{
    double sides[2][3], across[3], from[3], around[3];
    cwi_sub(p[1], p[0], sides[0]);
    cwi_sub(p[2], p[0], sides[1]);
    cwi_cross(r->vector, sides[1], across);
    const double det = cwi_dot(sides[0], across);
    if (det == 0)
        return INFINITY;
    cwi_sub(r->from, p[0], from);
    const double u = cwi_dot(from, across) / det;
    cwi_cross(from, sides[0], around);
    const double v = cwi_dot(r->vector, around) / det;
    const bool is_inside = u >= -BESIDE && v >= -BESIDE && u + v <= 1 + BESIDE;
    return is_inside ? cwi_dot(sides[1], around) / det : INFINITY;
}

/* Keeps a hit that is nearer to what is wanted; of two at the same place that of the surface that leans less. */
static bool visit_triangle(void *context, size_t slot)
{
    ray *r = context;
    double p[3][3], normal[3];
    cwi_mesh_corners(r->target->mesh, r->target->tree.order[slot], p);
    const double fraction = meet_triangle(r, p);
    if (!(fraction >= r->least && fraction <= 1))
        return true;
    cwi_triangle_normal(p[0], p[1], p[2], normal);
    const double cosine =
        cwi_normalise(normal) ? -cwi_dot(normal, r->vector) / cwi_length(r->vector) : 0;
    if (r->faces_only && !(cosine > 0))
        return true;
    const double gap = fabs(fraction - r->wanted), best = fabs(r->found - r->wanted);
    if (gap < best || (gap == best && cosine > r->cosine)) {
        r->found = fraction;
        r->cosine = cosine;
    }
    return true;
}

static ray cast_ray(const cwi_ray_target *target, const double from[3],
                    const double direction[3], double length, double wanted, double least,
                    bool faces_only)
{
    ray r = {.target = target,
             .wanted = wanted,
             .least = least,
             .faces_only = faces_only,
             .found = INFINITY};
    memcpy(r.from, from, sizeof r.from);
    for (int a = 0; a < 3; a++)
        r.vector[a] = length * direction[a];
    r.segment = cwi_boxes_segment_of(r.from, r.vector, target->slack);
    cwi_boxes_pierce(&target->tree, &r.segment, visit_triangle, &r);
    return r;
}

cw_status cwi_ray_target_build(cwi_ray_target *target, const cw_mesh *mesh, cw_error *err)
{
    double low[3], high[3];
    float max = 0;
    *target = (cwi_ray_target){.mesh = mesh};
    cwi_box_clear(low, high);
    cwi_box_add_points(low, high, mesh->positions, mesh->vertex_count);
    cwi_midpoint(low, high, target->middle);
    target->diagonal = cwi_box_diagonal(low, high);
    for (size_t n = 0; n < 3 * mesh->vertex_count; n++)
        max = fmaxf(max, fabsf(mesh->positions[n]));
    target->slack = max * 0x1p-20f;
    return cwi_triangle_boxes_build(&target->tree, mesh->positions, mesh->vertex_count,
                                    mesh->triangles, mesh->triangle_count, err);
}

void cwi_ray_target_free(cwi_ray_target *target)
{
    cwi_boxes_free(&target->tree);
}

double cwi_cast_along(const cwi_ray_target *target, const double from[3],
                      const double direction[3], double reach)
{
    const double least = START * target->diagonal / reach;
    const ray r = cast_ray(target, from, direction, reach, 0, least, false);
    return r.found * reach;
}

bool cwi_find_height(const cwi_ray_target *target, const cwi_text_place *place, double x,
                     double y, double reach, double *height, double *lean)
{
    double from[3], down[3];
    for (int a = 0; a < 3; a++) {
        from[a] = place->center[a] + x * place->right[a] + y * place->up[a] +
                  reach * place->normal[a];
        down[a] = -place->normal[a];
    }
    const ray r = cast_ray(target, from, down, 2 * reach, 0.5, 0, true);
    *height = reach - 2 * reach * r.found;
    *lean = r.cosine;
    return r.found <= 1;
}
