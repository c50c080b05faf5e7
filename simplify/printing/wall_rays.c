/* Casts rays against the normals of the surface, and along them: a wall is the way to where a ray
 * leaves the solid, a gap to where it enters again. */
#include "simplify/printing/wall_rays.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/box.h"
#include "core/geometry/bvh_segment.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh_triangle.h"
#include "core/mesh/triangle_boxes.h"
#include "simplify/printing/ray_lengths.h"

#include <string.h>

/* Points that large triangles are divided for, at least. */
static const double POINTS = 200000;

/* How many times as many, or as many as there are triangles, there may be for slivers. */
static const double MAX_SLIVER_POINTS = 4;

/* Rays around the first one, and how far they are off it. */
enum { AROUND = 6 };
static const double OFF_DEG = 5;

/* The normal of a point is that between the vertices' normals where all three agree with the
 * triangle; else there is an edge, and it is the triangle's. Thin triangles may face anywhere: those
 * lower than this fraction of their longest side need vertices that agree with each other. */
static const double SMOOTH_DEG = 30, THIN = 0.2;

/* Triangles farther than this off the normals of all their vertices are not measured, either. */
static const double ASTRAY_DEG = 60;

/* In limits: the walls that get the rays around, and the widest gaps that are looked for. */
static const double REACH = 4;

/* Triangles that one thread measures at a time, and most parts along a side of one. */
enum { PART = 1 << 10, MAX_PARTS = 1000 };

struct cwi_wall_field {
    const cw_mesh *mesh;
    const cw_print_desc *limits;
    cwi_wall_target target;
    float *normals;             /* vertices x 3; 0 at vertices without area around */
    float *wall, *gap;          /* of each triangle; may be NULL */
    bool seeks_thinnest;        /* nothing but the thinnest wall of each part */
    cwi_wall_sum *walls, *gaps; /* of each part */
    double step;                /* between points, mm */
    bool shares_points;         /* triangles lower than a step share points */
    double diagonal;
    size_t parts;
};

/* --- a point ------------------------------------------------------------------------------ */

/* Returns the wall or gap at a point: the least of its first ray and of those around that.
 * first_mm  the length of the first ray
 * direction  unit, of the first ray */
static double look_around(const cwi_wall_field *f, const cwi_ray_start *start,
                          const double direction[3], int end, double limit, double first_mm)
{
    const cwi_ray_cone cone = {AROUND, OFF_DEG * CWI_PI / 180};
    return first_mm < REACH * limit
               ? cwi_shortest_around(&f->target, start, direction, end, &cone, first_mm)
               : first_mm;
}

/* Measures the wall at a point, and the gap unless only the thinnest wall is sought.
 * relevant  longer walls do not matter */
static void measure_point(const cwi_wall_field *f, const cwi_ray_start *start,
                          const double normal[3], double relevant, double *wall, double *gap)
{
    const double limits[2] = {f->limits->min_wall_mm, f->limits->min_gap_mm},
                 reach[2] = {cwi_lesser(REACH * limits[0], f->diagonal), REACH * limits[1]},
                 inward[3] = {-normal[0], -normal[1], -normal[2]};
    double lengths[2] = {-1, -1}, next = reach[0];
    if (!f->seeks_thinnest) {
        cwi_ray_lengths(&f->target, start, normal, reach, lengths);
        next = 4 * reach[0];
        if (lengths[0] < 0 && reach[0] >= cwi_lesser(relevant, f->diagonal))
            lengths[0] = INFINITY;
        *gap = look_around(f, start, normal, CWI_RAY_ENTERS, limits[1],
                           lengths[1] < 0 ? INFINITY : lengths[1]);
    }
    if (lengths[0] < 0)
        lengths[0] = cwi_ray_length(&f->target, start, inward, CWI_RAY_LEAVES, next,
                                    f->diagonal, relevant);
    *wall = look_around(f, start, inward, CWI_RAY_LEAVES, limits[0], lengths[0]);
}

/* Finds the normal of a point of a triangle. Returns false where there is none that can be relied on.
 * weights  of the corners   flat  of the triangle, unit   is_thin  its own normal may be anything */
static bool find_normal(const cwi_wall_field *f, size_t triangle, const double weights[3],
                        const double flat[3], bool is_thin, double normal[3])
{
    const double smooth = cos(SMOOTH_DEG * CWI_PI / 180);
    double corners[3][3], with_flat = 1, among = 1, max_cosine = -1;
    memset(normal, 0, 3 * sizeof *normal);
    for (size_t c = 0; c < 3; c++) {
        const float *n = f->normals + 3 * (size_t)f->mesh->triangles[3 * triangle + c];
        for (int a = 0; a < 3; a++) {
            corners[c][a] = (double)n[a];
            normal[a] += weights[c] * corners[c][a];
        }
        with_flat = cwi_lesser(with_flat, cwi_dot(corners[c], flat));
        max_cosine = cwi_greater(max_cosine, cwi_dot(corners[c], flat));
    }
    for (int c = 0; c < 3; c++)
        among = cwi_lesser(among, cwi_dot(corners[c], corners[(c + 1) % 3]));
    const bool is_smooth = is_thin ? among >= smooth : with_flat >= smooth;
    if (is_smooth && cwi_normalise(normal))
        return true;
    memcpy(normal, flat, 3 * sizeof *normal);
    return max_cosine >= cos(ASTRAY_DEG * CWI_PI / 180);
}

static void add_measure(cwi_wall_sum *sum, double measured, double limit, const double at[3],
                        double area)
{
    if (measured < sum->min_mm) {
        sum->min_mm = measured;
        memcpy(sum->at, at, sizeof sum->at);
    }
    if (measured < limit)
        sum->below += area;
}

/* --- a triangle --------------------------------------------------------------------------- */

/* Points of equal area: `columns` along the longest side, `rows` toward the corner opposite. */
typedef struct point_grid {
    size_t apex; /* corner opposite of the longest side */
    size_t columns, rows;
    double start; /* of the first point, in columns */
    bool is_thin;
} point_grid;

/* Returns a place from 0 to 1 that spreads evenly over triangles that follow each other: multiples of the golden ratio. */
static double spread_start(size_t triangle)
{
    const double x = (double)triangle * 0.6180339887498949;
    return x - floor(x);
}

static size_t count_parts(double length, double step)
{
    const double parts = ceil(length / step);
    return parts > MAX_PARTS ? MAX_PARTS : parts > 1 ? (size_t)parts : 1;
}

/* Where slivers would get far too many points, triangles lower than a step share them: each gets as many as its area is
 * worth, at least one, at places of its own. */
static point_grid divide_triangle(const cwi_wall_field *f, size_t triangle,
                                  const double p[3][3], double twice_area)
{
    const double step = f->step;
    point_grid g = {0};
    double longest = -1;
    for (size_t c = 0; c < 3; c++) {
        double side[3];
        for (int a = 0; a < 3; a++)
            side[a] = p[(c + 2) % 3][a] - p[(c + 1) % 3][a];
        const double length = cwi_length(side);
        if (length > longest) {
            longest = length;
            g.apex = c;
        }
    }
    const double height = twice_area / longest;
    const bool shares = f->shares_points && height < step && longest > step;
    g.columns = count_parts(shares ? height * longest / step : longest, step);
    g.rows = count_parts(height, step);
    g.start = shares ? spread_start(triangle) : 0.5;
    g.is_thin = height < THIN * longest;
    return g;
}

/* Returns the length beyond which walls do not matter: where a triangle's wall is not requested, and
 * some are thinner. */
static double find_relevant_wall(const cwi_wall_field *f, const cwi_wall_sum *walls)
{
    return f->wall             ? INFINITY
           : f->seeks_thinnest ? walls->min_mm
                               : REACH * f->limits->min_wall_mm;
}

static void measure_triangle(cwi_wall_field *f, size_t triangle, cwi_wall_sum *walls,
                             cwi_wall_sum *gaps)
{
    double p[3][3], flat[3];
    cwi_ray_start start = {.triangle = triangle};
    cwi_mesh_corners(f->mesh, triangle, p);
    cwi_triangle_normal(p[0], p[1], p[2], flat);
    const double twice = cwi_length(flat);
    double min_mm[2] = {INFINITY, INFINITY};
    const cw_print_desc *limits = f->limits;
    if (twice > 0 && cwi_normalise(flat)) {
        const point_grid g = divide_triangle(f, triangle, (const double(*)[3])p, twice);
        const double area = twice / 2 / (double)(g.columns * g.rows);
        for (size_t n = 0; n < g.columns * g.rows; n++) {
            const double along = ((double)(n % g.columns) + g.start) / (double)g.columns,
                         up = 1 - sqrt(1 - ((double)(n / g.columns) + 0.5) / (double)g.rows);
            double weights[3], normal[3], wall = INFINITY, gap = INFINITY;
            weights[g.apex] = up;
            weights[(g.apex + 1) % 3] = (1 - up) * (1 - along);
            weights[(g.apex + 2) % 3] = (1 - up) * along;
            for (int a = 0; a < 3; a++)
                start.at[a] =
                    weights[0] * p[0][a] + weights[1] * p[1][a] + weights[2] * p[2][a];
            if (!find_normal(f, triangle, weights, flat, g.is_thin, normal))
                break;
            measure_point(f, &start, normal, find_relevant_wall(f, walls), &wall, &gap);
            add_measure(walls, wall, limits->min_wall_mm, start.at, area);
            add_measure(gaps, gap, limits->min_gap_mm, start.at, area);
            min_mm[0] = cwi_lesser(min_mm[0], wall);
            min_mm[1] = cwi_lesser(min_mm[1], gap);
        }
    }
    if (f->wall)
        f->wall[triangle] = (float)min_mm[0];
    if (f->gap && !f->seeks_thinnest)
        f->gap[triangle] = (float)min_mm[1];
}

static void measure_part(void *context, size_t k)
{
    cwi_wall_field *f = context;
    f->walls[k] = (cwi_wall_sum){.min_mm = INFINITY};
    if (!f->seeks_thinnest)
        f->gaps[k] = f->walls[k];
    for (size_t t = k * PART; t < (k + 1) * PART && t < f->mesh->triangle_count; t++)
        measure_triangle(f, t, &f->walls[k], &f->gaps[k]);
}

/* --- all ---------------------------------------------------------------------------------- */

/* Returns how many points there are where each triangle has its own. */
static double count_points(const cwi_wall_field *f)
{
    double sum = 0;
    for (size_t t = 0; t < f->mesh->triangle_count; t++) {
        double p[3][3], area[3];
        cwi_mesh_corners(f->mesh, t, p);
        cwi_triangle_normal(p[0], p[1], p[2], area);
        const double twice = cwi_length(area);
        if (!(twice > 0))
            continue;
        const point_grid g = divide_triangle(f, t, (const double(*)[3])p, twice);
        sum += (double)(g.columns * g.rows);
    }
    return sum;
}

/* Finds the normals of vertices, weighted by area, and the step between points. */
static void prepare_points(cwi_wall_field *f)
{
    const cw_mesh *mesh = f->mesh;
    double twice = 0, low[3], high[3];
    cwi_box_clear(low, high);
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        double p[3][3], area[3];
        cwi_mesh_corners(mesh, t, p);
        cwi_triangle_normal(p[0], p[1], p[2], area);
        twice += cwi_length(area);
        for (size_t n = 0; n < 9; n++)
            f->normals[3 * (size_t)mesh->triangles[3 * t + n / 3] + n % 3] +=
                (float)area[n % 3];
        for (int k = 0; k < 3; k++)
            cwi_box_add(low, high, p[k]);
    }
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        double normal[3];
        for (size_t a = 0; a < 3; a++)
            normal[a] = (double)f->normals[3 * v + a];
        const bool has_normal = cwi_normalise(normal);
        for (size_t a = 0; a < 3; a++)
            f->normals[3 * v + a] = has_normal ? (float)normal[a] : 0;
    }
    f->diagonal = cwi_distance(low, high);
    f->step = sqrt(twice / 2 / POINTS);
    f->shares_points =
        count_points(f) > MAX_SLIVER_POINTS * fmax(POINTS, (double)mesh->triangle_count);
    f->target.slack = f->target.tree.max * 0x1p-20f;
}

cw_status cwi_wall_field_new(const cw_mesh *mesh, const cw_print_desc *limits,
                             cwi_wall_field **field, cw_error *err)
{
    cwi_wall_field *f = *field = cwi_alloc_zeroed(1, sizeof *f);
    if (!f)
        return cwi_fail_memory(err);
    *f = (cwi_wall_field){.mesh = mesh, .target = {.mesh = mesh}, .limits = limits};
    f->parts = (mesh->triangle_count + PART - 1) / PART;
    f->normals = cwi_alloc_zeroed(mesh->vertex_count, 3 * sizeof *f->normals);
    f->walls = cwi_alloc_array(f->parts, sizeof *f->walls);
    f->gaps = cwi_alloc_array(f->parts, sizeof *f->gaps);
    cw_status st = f->normals && f->walls && f->gaps ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK && mesh->triangle_count)
        st = cwi_triangle_boxes_build(&f->target.tree, mesh->positions, mesh->vertex_count,
                                      mesh->triangles, mesh->triangle_count, err);
    if (st == CW_OK)
        prepare_points(f);
    return st;
}

void cwi_wall_field_free(cwi_wall_field *f)
{
    if (!f)
        return;
    cwi_boxes_free(&f->target.tree);
    cwi_free(f->normals);
    cwi_free(f->walls);
    cwi_free(f->gaps);
    cwi_free(f);
}

/* Adds up parts in their order, so that threads do not matter. */
static void add_parts(const cwi_wall_sum *parts, size_t count, cwi_wall_sum *sum)
{
    *sum = (cwi_wall_sum){.min_mm = INFINITY};
    for (size_t k = 0; k < count; k++) {
        if (parts[k].min_mm < sum->min_mm) {
            sum->min_mm = parts[k].min_mm;
            memcpy(sum->at, parts[k].at, sizeof sum->at);
        }
        sum->below += parts[k].below;
    }
}

static cw_status measure_parts(cwi_wall_field *f, cw_error *err)
{
    return cwi_parallel_for(f->parts, 1 << 16, f->limits->threads, &f->limits->progress,
                            "walls", measure_part, f, err);
}

cw_status cwi_measure_walls(cwi_wall_field *f, float *wall, float *gap, cwi_wall_sum *walls,
                            cwi_wall_sum *gaps, cw_error *err)
{
    f->wall = wall;
    f->gap = gap;
    cw_status st = measure_parts(f, err);
    if (st != CW_OK)
        return st;
    add_parts(f->gaps, f->parts, gaps);
    add_parts(f->walls, f->parts, walls);
    if (f->wall || walls->min_mm < INFINITY)
        return CW_OK;
    f->seeks_thinnest = true; /* all rays ended where walls are thick */
    st = measure_parts(f, err);
    if (st == CW_OK)
        add_parts(f->walls, f->parts, walls);
    return st;
}
