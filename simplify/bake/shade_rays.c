/* Maps made by rays against the full surface: how open its surroundings are, and how thick it is. */
#include "core/geometry/bvh_segment.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh_triangle.h"
#include "simplify/bake/bake_state.h"

#include <math.h>
#include <string.h>

enum { OPEN_RAYS = 32, THICK_RAYS = 7 };

/* Half the angle of the cone of rays into the surface. */
static const double CONE_DEG = 30;

typedef struct ray {
    const cwi_baking *b;
    double from[3], vector[3];
    cwi_boxes_segment segment;
    double fraction; /* of the vector, at which the surface is met; 1: nowhere */
    bool any;        /* one triangle is enough */
} ray;

/* Meets a triangle as Möller and Trumbore do, from both sides. */
static bool meet_triangle(void *context, size_t slot)
{
    ray *r = context;
    double p[3][3], a[3], b[3], to[3], across[3], up[3];
    cwi_mesh_corners(r->b->full, r->b->tree.order[slot], p);
    cwi_sub(p[1], p[0], a);
    cwi_sub(p[2], p[0], b);
    cwi_cross(r->vector, b, across);
    const double volume = cwi_dot(a, across);
    cwi_sub(r->from, p[0], to);
    const double u = cwi_dot(to, across) / volume;
    cwi_cross(to, a, up);
    const double v = cwi_dot(r->vector, up) / volume, t = cwi_dot(b, up) / volume;
    if (!(u >= 0 && v >= 0 && u + v <= 1 && t >= 0 && t < r->fraction)) /* NaN: none is met */
        return true;
    r->fraction = t;
    r->segment.reach = (float)t;
    return !r->any;
}

/* Returns how far a ray goes, in mm, up to `reach`. direction: unit. any: that of any triangle is enough */
static double cast_ray(const cwi_baking *b, const double from[3], const double direction[3],
                       double reach, bool any)
{
    ray r = {.b = b, .fraction = 1, .any = any};
    memcpy(r.from, from, sizeof r.from);
    for (int k = 0; k < 3; k++)
        r.vector[k] = reach * direction[k];
    r.segment = cwi_boxes_segment_of(r.from, r.vector, (float)(b->tree.max * 1e-6f));
    cwi_boxes_pierce(&b->tree, &r.segment, meet_triangle, &r);
    return r.fraction * reach;
}

/* Places the n-th direction of a golden spiral around a normal. height: over the plane across it */
static void place_ray(const double normal[3], const double across[2][3], int n, double height,
                      double direction[3])
{
    const double turn = n * CWI_PI * (3 - sqrt(5.0)), out = sqrt(fmax(0, 1 - height * height));
    for (int k = 0; k < 3; k++)
        direction[k] =
            height * normal[k] + out * (cos(turn) * across[0][k] + sin(turn) * across[1][k]);
}

/* Rays are as dense as the light that a matt surface takes from there. */
void cwi_shade_occlusion(const cwi_baking *b, const cwi_texel_frame *f,
                         const cwi_texel_hit *hit, double color[3])
{
    double across[2][3], from[3], direction[3];
    int open = 0;
    (void)f;
    color[0] = color[1] = color[2] = 1;
    if (!hit)
        return;
    cwi_find_across(hit->normal, across);
    for (int k = 0; k < 3; k++)
        from[k] = hit->point[k] + b->bias * hit->normal[k];
    for (int n = 0; n < OPEN_RAYS; n++) {
        place_ray(hit->normal, (const double(*)[3])across, n, sqrt(1 - (n + 0.5) / OPEN_RAYS),
                  direction);
        open += cast_ray(b, from, direction, b->occlusion_mm, true) == b->occlusion_mm;
    }
    color[0] = color[1] = color[2] = (double)open / OPEN_RAYS;
}

/* The mean way through the solid within a cone, after the shape diameter. */
void cwi_shade_thickness(const cwi_baking *b, const cwi_texel_frame *f,
                         const cwi_texel_hit *hit, double color[3])
{
    double across[2][3], from[3], inward[3], direction[3], sum = 0;
    const double low = cos(CONE_DEG * CWI_PI / 180);
    (void)f;
    color[0] = color[1] = color[2] = 1;
    if (!hit)
        return;
    for (int k = 0; k < 3; k++) {
        inward[k] = -hit->normal[k];
        from[k] = hit->point[k] + b->bias * inward[k];
    }
    cwi_find_across(inward, across);
    for (int n = 0; n < THICK_RAYS; n++) {
        place_ray(inward, (const double(*)[3])across, n, 1 - (1 - low) * n / (THICK_RAYS - 1),
                  direction);
        sum += b->bias + cast_ray(b, from, direction, b->thickness_mm, false);
    }
    color[0] = color[1] = color[2] = fmin(1, sum / THICK_RAYS / b->thickness_mm);
}
