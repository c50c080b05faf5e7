/* Casts rays through the tree of a mesh's triangles [Moeller1997]. */
#include "simplify/printing/ray_lengths.h"

#include "core/geometry/bvh_segment.h"
#include "core/geometry/triangle.h"
#include "core/mesh/mesh_triangle.h"

#include <string.h>

/* How near the end of a ray must be to facing it: sharper edges are no walls. */
static const double FACING_DEG = 30;

/* Times the way to a hit: boxes up to there may hold one that is nearer, as rounding goes. */
static const double BEYOND = 1 + 1e-5;

typedef struct ray {
    double vector[3], reach; /* reach: its length */
    double fraction;         /* of the vector, to the first hit so far */
    size_t hit;
} ray;

/* A ray, and perhaps one the other way, in one search of the tree. */
typedef struct ray_search {
    const cwi_wall_target *target;
    const cwi_ray_start *start;
    ray rays[2];
    cwi_boxes_segment segment;
} ray_search;

static ray start_ray(const double direction[3], double reach)
{
    ray r = {.reach = reach, .fraction = 1, .hit = SIZE_MAX};
    for (int a = 0; a < 3; a++)
        r.vector[a] = reach * direction[a];
    return r;
}

/* Returns true if the triangle is the first that the ray meets so far. */
static bool meet_triangle(const ray_search *s, ray *r, const double p[3][3], size_t triangle)
{
    const double fraction = cwi_triangle_ray(p, s->start->at, r->vector);
    const bool is_first = fraction > 0 && fraction < r->fraction;
    if (is_first) {
        r->fraction = fraction;
        r->hit = triangle;
    }
    return is_first;
}

/* Loads the triangle in a slot of the tree. Returns false for the one that the rays start at. */
static bool load_triangle(const ray_search *s, size_t slot, double p[3][3], size_t *triangle)
{
    *triangle = s->target->tree.order[slot];
    if (*triangle == s->start->triangle)
        return false;
    cwi_mesh_corners(s->target->mesh, *triangle, p);
    return true;
}

static bool visit_one(void *context, size_t slot)
{
    ray_search *s = context;
    size_t triangle;
    double p[3][3];
    if (!load_triangle(s, slot, p, &triangle))
        return true;
    if (meet_triangle(s, &s->rays[0], (const double(*)[3])p, triangle))
        s->segment.reach = (float)cwi_lesser(1, BEYOND * s->rays[0].fraction);
    return true;
}

static bool visit_two(void *context, size_t slot)
{
    ray_search *s = context;
    size_t triangle;
    double p[3][3];
    if (!load_triangle(s, slot, p, &triangle))
        return true;
    if (meet_triangle(s, &s->rays[0], (const double(*)[3])p, triangle))
        s->segment.reach = (float)cwi_lesser(1, BEYOND * s->rays[0].fraction);
    else if (meet_triangle(s, &s->rays[1], (const double(*)[3])p, triangle))
        s->segment.begin =
            (float)(-BEYOND * s->rays[1].fraction * s->rays[1].reach / s->rays[0].reach);
    return true;
}

/* Returns the length of a ray that has met a triangle, or INFINITY: the triangle does not face it. */
static double find_length(const cwi_wall_target *target, const ray *r,
                          const double direction[3], int end)
{
    double p[3][3], normal[3];
    cwi_mesh_corners(target->mesh, r->hit, p);
    cwi_triangle_normal(p[0], p[1], p[2], normal);
    const bool faces = cwi_normalise(normal) &&
                       end * cwi_dot(normal, direction) >= cos(FACING_DEG * CWI_PI / 180);
    return faces ? r->fraction * r->reach : INFINITY;
}

/* --- a cone of rays ----------------------------------------------------------------------- */

enum { MAX_NEAR = 64 };

/* Triangles that rays in a cone may meet, in the order in which each ray would visit them. */
typedef struct near_triangles {
    const cwi_wall_target *target;
    const cwi_ray_start *start;
    cwi_boxes_segment segment;
    size_t count; /* beyond MAX_NEAR: not all are listed */
    size_t triangles[MAX_NEAR];
    double corners[MAX_NEAR][3][3];
} near_triangles;

static bool list_near(void *context, size_t slot)
{
    near_triangles *near = context;
    const size_t triangle = near->target->tree.order[slot];
    if (triangle == near->start->triangle)
        return true;
    if (near->count < MAX_NEAR) {
        near->triangles[near->count] = triangle;
        cwi_mesh_corners(near->target->mesh, triangle, near->corners[near->count]);
    }
    return near->count++ < MAX_NEAR;
}

/* Lists what rays up to a length may meet, whose ends are within a distance of the axis. */
static void list_around_axis(near_triangles *near, const double axis[3], double length,
                             double distance)
{
    double vector[3];
    for (int a = 0; a < 3; a++)
        vector[a] = length * axis[a];
    near->segment = cwi_boxes_segment_of(near->start->at, vector,
                                         near->target->slack + (float)(BEYOND * distance));
    cwi_boxes_pierce(&near->target->tree, &near->segment, list_near, near);
}

static double measure_listed(const near_triangles *near, const double direction[3], int end,
                             double reach)
{
    ray_search s = {.target = near->target, .start = near->start};
    s.rays[0] = start_ray(direction, reach);
    for (size_t n = 0; n < near->count; n++)
        meet_triangle(&s, &s.rays[0], (const double(*)[3])near->corners[n], near->triangles[n]);
    return s.rays[0].hit == SIZE_MAX ? INFINITY
                                     : find_length(near->target, &s.rays[0], direction, end);
}

double cwi_shortest_around(const cwi_wall_target *target, const cwi_ray_start *start,
                           const double axis[3], int end, const cwi_ray_cone *cone,
                           double length)
{
    near_triangles near; /* large: not cleared */
    double across[2][3];
    const double along = cos(cone->angle), off = sin(cone->angle);
    near.target = target;
    near.start = start;
    near.count = 0;
    cwi_find_across(axis, across);
    list_around_axis(&near, axis, length, length * off);
    for (int n = 0; n < cone->rays; n++) {
        const double turn = 2 * CWI_PI * n / cone->rays;
        double d[3];
        for (int a = 0; a < 3; a++)
            d[a] =
                along * axis[a] + off * (cos(turn) * across[0][a] + sin(turn) * across[1][a]);
        length =
            cwi_lesser(length, near.count > MAX_NEAR ? cwi_ray_length(target, start, d, end,
                                                                      length, length, INFINITY)
                                                     : measure_listed(&near, d, end, length));
    }
    return length;
}

/* --- single rays -------------------------------------------------------------------------- */

double cwi_ray_length(const cwi_wall_target *target, const cwi_ray_start *start,
                      const double direction[3], int end, double first, double max_reach,
                      double relevant)
{
    ray_search s = {.target = target, .start = start};
    for (double reach = cwi_lesser(first, max_reach);;
         reach = cwi_lesser(4 * reach, max_reach)) {
        s.rays[0] = start_ray(direction, reach);
        s.segment = cwi_boxes_segment_of(start->at, s.rays[0].vector, target->slack);
        cwi_boxes_pierce(&target->tree, &s.segment, visit_one, &s);
        if (s.rays[0].hit != SIZE_MAX)
            return find_length(target, &s.rays[0], direction, end);
        if (reach >= max_reach || reach >= relevant)
            return INFINITY;
    }
}

void cwi_ray_lengths(const cwi_wall_target *target, const cwi_ray_start *start,
                     const double normal[3], const double reach[2], double lengths[2])
{
    const double inward[3] = {-normal[0], -normal[1], -normal[2]};
    ray_search s = {.target = target, .start = start};
    s.rays[0] = start_ray(inward, reach[0]);
    s.rays[1] = start_ray(normal, reach[1]);
    s.segment = cwi_boxes_segment_of(start->at, s.rays[0].vector, target->slack);
    s.segment.begin = (float)(-BEYOND * reach[1] / reach[0]);
    cwi_boxes_pierce(&target->tree, &s.segment, visit_two, &s);
    for (int n = 0; n < 2; n++)
        lengths[n] = s.rays[n].hit == SIZE_MAX
                         ? -1
                         : find_length(target, &s.rays[n], n ? normal : inward,
                                       n ? CWI_RAY_ENTERS : CWI_RAY_LEAVES);
}
