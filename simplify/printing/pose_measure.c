/* Measures poses of a print: height, overhangs, and how it stands on its foot. */
#include "simplify/printing/pose_search.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh_triangle.h"
#include "simplify/printing/outline.h"

/* Poses that are measured in one pass over the triangles. */
enum { GROUP = 4 };

/* Makes two directions that are perpendicular to one, and to each other. */
static void make_axes(const double down[3], double x[3], double y[3])
{
    double other[3] = {0};
    other[fabs(down[0]) < 0.6 ? 0 : 1] = 1;
    cwi_cross(down, other, x);
    cwi_to_unit(x);
    cwi_cross(x, down, y);
}

static void measure_hull(cwi_pose_search *s, cwi_pose *c, double bottom)
{
    double x[3], y[3];
    const cwi_rest_body *b = &s->body;
    size_t count = 0;
    make_axes(c->down, x, y);
    for (size_t n = 0; n < b->count; n++)
        count += bottom - cwi_dot(b->points[n], c->down) < s->limits.layer_mm;
    cwi_plan_point *points = cwi_alloc_array(count, sizeof *points),
                   *hull = cwi_alloc_array(2 * count + 2, sizeof *hull);
    if (!points || !hull)
        cwi_set_flag(&s->no_memory);
    else {
        count = 0;
        for (size_t n = 0; n < b->count; n++)
            if (bottom - cwi_dot(b->points[n], c->down) < s->limits.layer_mm)
                points[count++] =
                    (cwi_plan_point){cwi_dot(b->points[n], x), cwi_dot(b->points[n], y)};
        const size_t corners = cwi_find_outline(points, count, hull);
        const double high = bottom - cwi_dot(b->center, c->down),
                     margin = cwi_outline_margin(
                         hull, corners,
                         &(cwi_plan_point){cwi_dot(b->center, x), cwi_dot(b->center, y)});
        c->stand.hull_mm2 = cwi_outline_area(hull, corners);
        c->stand.tip_deg = margin > 0 && high > 0 ? atan2(margin, high) * 180 / CWI_PI : 0;
    }
    cwi_free(points);
    cwi_free(hull);
}

static bool fits_plate(const cwi_pose_search *s, const double down[3], double height)
{
    const double *plate = s->limits.plate_mm;
    double turn[12], low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    if (plate[0] == 0)
        return true;
    cwi_turn_down(down, turn);
    for (size_t n = 0; n < s->body.count; n++)
        for (int a = 0; a < 2; a++) {
            const double at = cwi_dot(turn + 4 * a, s->body.points[n]);
            low[a] = cwi_lesser(low[a], at);
            high[a] = cwi_greater(high[a], at);
        }
    const double x = high[0] - low[0], y = high[1] - low[1];
    return height <= plate[2] &&
           ((x <= plate[0] && y <= plate[1]) || (x <= plate[1] && y <= plate[0]));
}

/* Finds how high a pose is. Returns where its bottom is, along down. */
static double measure_height(const cwi_pose_search *s, cwi_pose *c)
{
    double bottom = -INFINITY, top = INFINITY;
    for (size_t p = 0; p < s->body.count; p++) {
        const double at = cwi_dot(s->body.points[p], c->down);
        bottom = cwi_greater(bottom, at);
        top = cwi_lesser(top, at);
    }
    c->stand = (cw_print_stand){.height_mm = bottom - top};
    for (int a = 0; a < 3; a++)
        c->stand.up[a] = c->down[a] == 0 ? 0 : -c->down[a];
    return bottom;
}

static bool is_on_plate(const cwi_pose_search *s, size_t triangle, const double down[3],
                        double bottom)
{
    double corner[3][3];
    cwi_mesh_corners(s->mesh, triangle, corner);
    for (int k = 0; k < 3; k++)
        if (bottom - cwi_dot(corner[k], down) >= s->limits.layer_mm)
            return false;
    return true;
}

/* Adds up overhangs of some poses in one pass over the triangles. */
static void measure_overhangs(const cwi_pose_search *s, cwi_pose *poses, const double *bottoms,
                              size_t count)
{
    for (size_t t = 0; t < s->mesh->triangle_count; t++) {
        double normal[3];
        cwi_mesh_normal(s->mesh, t, normal);
        const double length = cwi_length(normal);
        for (size_t n = 0; n < count; n++)
            if (cwi_dot(normal, poses[n].down) > s->steep * length &&
                !is_on_plate(s, t, poses[n].down, bottoms[n]))
                poses[n].stand.overhang_mm2 += length / 2;
    }
}

/* Measures a group of poses exactly. */
static void measure_group(void *context, size_t group)
{
    cwi_pose_search *s = context;
    cwi_pose *poses = s->poses + group * GROUP;
    const size_t left = s->pose_count - group * GROUP, count = left < GROUP ? left : GROUP;
    double bottoms[GROUP];
    for (size_t n = 0; n < count; n++)
        bottoms[n] = measure_height(s, &poses[n]);
    measure_overhangs(s, poses, bottoms, count);
    for (size_t n = 0; n < count; n++) {
        poses[n].fits = fits_plate(s, poses[n].down, poses[n].stand.height_mm);
        measure_hull(s, &poses[n], bottoms[n]);
    }
}

void cwi_measure_poses(cwi_pose_search *s)
{
    cwi_parallel_for_all((s->pose_count + GROUP - 1) / GROUP, s->mesh->triangle_count,
                         s->limits.threads, measure_group, s);
}
