/* Measures the walls of a lattice in the surface that was made: rays both ways from their middle. */
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/bvh_segment.h"
#include "core/geometry/triangle.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_triangle.h"
#include "core/mesh/triangle_boxes.h"
#include "extract/level_set/infill.h"

#include <cubewright/distance.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Points at most. */
enum { SAMPLES = 20000 };

typedef struct sampling {
    const cwi_infill *infill;
    const cw_mesh *voids;
    double wall_mm;
    cwi_boxes tree;
    size_t count, stride; /* of vertices */
    float *depth;         /* of each point below the outer surface, mm */
    double *thickness;    /* NaN: none was measured */
} sampling;

typedef struct ray {
    const sampling *s;
    double from[3], vector[3], fraction;
    cwi_boxes_segment segment;
} ray;

static bool meet_triangle(void *context, size_t slot)
{
    ray *r = context;
    double p[3][3];
    cwi_mesh_corners(r->s->voids, r->s->tree.order[slot], p);
    const double fraction = cwi_triangle_ray((const double(*)[3])p, r->from, r->vector);
    if (fraction >= 0 && fraction < r->fraction)
        r->fraction = fraction;
    return true;
}

/* Returns the distance along a direction to the channel, or NaN beyond the reach.
 * from  relative to the mesh's origin */
static double cast_ray(const sampling *s, const double from[3], const double direction[3],
                       double reach)
{
    ray r = {.s = s, .fraction = INFINITY};
    for (int a = 0; a < 3; a++) {
        r.from[a] = from[a];
        r.vector[a] = reach * direction[a];
    }
    r.segment = cwi_boxes_segment_of(r.from, r.vector, s->tree.max * 0x1p-20f);
    cwi_boxes_pierce(&s->tree, &r.segment, meet_triangle, &r);
    return r.fraction <= 1 ? r.fraction * reach : NAN;
}

/* Measures the wall beside a vertex of the channels. Nearer to the outer wall than a wall is thick, a
 * ray may meet the corner between both. */
static void measure_sample(void *context, size_t n)
{
    const sampling *s = context;
    double world[3], foot[3], normal[3], back[3], from[3];
    cwi_mesh_world(s->voids, n * s->stride, world);
    const double distance = cwi_infill_distance(s->infill, world, foot, normal),
                 depth = (double)s->depth[n] - distance, thickest = s->infill->thickest;
    s->thickness[n] = NAN;
    if (!(depth > s->wall_mm + thickest))
        return;
    for (int a = 0; a < 3; a++) {
        back[a] = -normal[a];
        from[a] = foot[a] - s->voids->origin[a];
    }
    s->thickness[n] =
        cast_ray(s, from, normal, 2 * thickest) + cast_ray(s, from, back, 2 * thickest);
}

static int compare_numbers(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static void sum_up(sampling *s, cw_hollow_facts *facts)
{
    size_t count = 0;
    for (size_t n = 0; n < s->count; n++)
        if (!isnan(s->thickness[n]))
            s->thickness[count++] = s->thickness[n];
    facts->infill_samples = count;
    if (!count)
        return;
    qsort(s->thickness, count, sizeof *s->thickness, compare_numbers);
    facts->infill_min_mm = s->thickness[0];
    facts->infill_median_mm = s->thickness[count / 2];
    facts->infill_max_mm = s->thickness[count - 1];
}

/* Finds how deep the samples are below the outer surface. */
static cw_status measure_depths(const sampling *s, const cw_mesh *outer, int threads,
                                const cw_progress *progress, cw_error *err)
{
    const cw_mesh_distance_desc desc = {
        .vertices_only = true, .threads = threads, .progress = *progress};
    cw_distance d;
    cw_mesh points = {.vertex_count = s->count};
    float *places = cwi_alloc_array(s->count, 3 * sizeof *places);
    if (!places)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < s->count; n++)
        memcpy(places + 3 * n, s->voids->positions + 3 * n * s->stride, 3 * sizeof *places);
    points.positions = places;
    memcpy(points.origin, s->voids->origin, sizeof points.origin);
    const cw_status st = cw_distance_to_mesh(&points, outer, &desc, &d, s->depth, err);
    cwi_free(places);
    return st;
}

cw_status cwi_infill_measure(const cwi_infill *infill, const cw_mesh *outer,
                             const cw_mesh *voids, double wall_mm, int threads,
                             const cw_progress *progress, cw_hollow_facts *facts, cw_error *err)
{
    sampling s = {.infill = infill, .voids = voids, .wall_mm = wall_mm};
    s.stride = voids->vertex_count / SAMPLES + 1;
    s.count = (voids->vertex_count + s.stride - 1) / s.stride;
    s.depth = cwi_alloc_array(s.count, sizeof *s.depth);
    s.thickness = cwi_alloc_array(s.count, sizeof *s.thickness);
    cw_status st = s.depth && s.thickness ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK)
        st = measure_depths(&s, outer, threads, progress, err);
    if (st == CW_OK)
        st = cwi_triangle_boxes_build(&s.tree, voids->positions, voids->vertex_count,
                                      voids->triangles, voids->triangle_count, err);
    if (st == CW_OK)
        st = cwi_parallel_for(s.count, 1 << 8, threads, progress, "lattice walls",
                              measure_sample, &s, err);
    if (st == CW_OK)
        sum_up(&s, facts);
    cwi_boxes_free(&s.tree);
    cwi_free(s.depth);
    cwi_free(s.thickness);
    return st;
}
