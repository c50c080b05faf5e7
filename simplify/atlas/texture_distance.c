/* Measures how far the texture of a surface has moved: as a distance between points in space and texture. */
#include <cubewright/atlas.h>

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/closest_point.h"
#include "core/geometry/point_triangle.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_triangle.h"
#include "core/texture/split_seams.h"

#include <math.h>

enum {
    CHUNK = 256,
    SAMPLES_PER_TRIANGLE = 4, /* of the full mesh, up to the next */
    MAX_SAMPLES = 1 << 17,    /* of all triangles, beside their corners */
    MAX_STEPS = 64,           /* along a side */
    FIRST_VISITS = 4096,      /* triangles near in space */
    MAX_VISITS =
        1 << 14 /* triangles for a point: where more lie on one place, a bound is found */
};

static const uint32_t NO_TRIANGLE = UINT32_MAX;

/* How much farther than the nearest triangle others may be, to be looked at first. */
static const double AROUND = 1.5;

typedef struct chunk_facts {
    size_t samples;
    double max, sum, area;
} chunk_facts;

typedef struct comparison {
    const cw_mesh *mesh, *full;
    cw_mesh flat;   /* full's triangles in the texture, scaled to mm, three vertices each */
    cwi_boxes tree; /* of flat */
    cwi_boxes space_tree; /* of full */
    double scale;         /* mm for the texture's side */
    double sample_mm2;    /* of the mesh, for each sample */
    double shift[3];      /* from mesh's origin to that of full */
    chunk_facts *chunks;
} comparison;

/* Coordinates in space and in the texture, in mm. */
enum { DIMENSIONS = 5, IN_TEXTURE = 3 };

typedef struct place_search {
    const comparison *c;
    const double *point; /* in space and in the texture */
    double best_sq;
    uint32_t triangle; /* that is so near */
    size_t visits;
} place_search;

static const float *place_of(const cw_attribute *uv, const cw_mesh *mesh, size_t corner)
{
    const size_t at = uv->on == CW_ON_CORNERS ? corner : mesh->triangles[corner];
    return (const float *)uv->data + 2 * at;
}

static double dot(const double *a, const double *b)
{
    double sum = 0;
    for (int k = 0; k < DIMENSIONS; k++)
        sum += a[k] * b[k];
    return sum;
}

/* Returns the square of the distance from a segment. from: the point, seen from where the segment starts */
static double segment_distance_sq(const double *from, const double *along)
{
    const double length_sq = dot(along, along), on_it = dot(from, along),
                 t = length_sq > 0 ? fmin(fmax(on_it / length_sq, 0), 1) : 0;
    return fmax(0, dot(from, from) - 2 * t * on_it + t * t * length_sq);
}

/* Returns the square of a point's distance from a triangle: the nearest point lies in the triangle's plane
 * or on a side. */
static double triangle_distance_sq(const double corner[3][DIMENSIONS], const double *point)
{
    double ab[DIMENSIONS], ac[DIMENSIONS], bc[DIMENSIONS], ap[DIMENSIONS], bp[DIMENSIONS];
    for (int k = 0; k < DIMENSIONS; k++) {
        ab[k] = corner[1][k] - corner[0][k];
        ac[k] = corner[2][k] - corner[0][k];
        bc[k] = corner[2][k] - corner[1][k];
        ap[k] = point[k] - corner[0][k];
        bp[k] = point[k] - corner[1][k];
    }
    const double bb = dot(ab, ab), cc = dot(ac, ac), mixed = dot(ab, ac), pb = dot(ap, ab),
                 pc = dot(ap, ac), area_sq = bb * cc - mixed * mixed,
                 in_b = cc * pb - mixed * pc, in_c = bb * pc - mixed * pb;
    if (area_sq > 0 && in_b >= 0 && in_c >= 0 && in_b + in_c <= area_sq)
        return fmax(0, dot(ap, ap) - (in_b * pb + in_c * pc) / area_sq);
    return fmin(segment_distance_sq(ap, ab),
                fmin(segment_distance_sq(ap, ac), segment_distance_sq(bp, bc)));
}

/* Measures the distance from a triangle of the full mesh, and keeps the nearest one. */
static void look_at(place_search *s, uint32_t t)
{
    const comparison *c = s->c;
    const float *flat = c->flat.positions + 9 * (size_t)t;
    double corner[3][DIMENSIONS];
    for (size_t k = 0; k < 3; k++) {
        cwi_mesh_corner(c->full, t, k, corner[k]);
        corner[k][IN_TEXTURE] = (double)flat[3 * k];
        corner[k][IN_TEXTURE + 1] = (double)flat[3 * k + 1];
    }
    const double distance_sq =
        triangle_distance_sq((const double(*)[DIMENSIONS])corner, s->point);
    if (!(distance_sq < s->best_sq))
        return;
    s->best_sq = distance_sq;
    s->triangle = t;
}

/* Looks at triangles near a point in space: one of them is near in the texture, too, as a rule. */
static void measure_space(void *context, size_t slot, double *distance_sq)
{
    place_search *s = context;
    look_at(s, s->c->space_tree.order[slot]);
    if (++s->visits > FIRST_VISITS)
        *distance_sq = 0;
}

/* Looks at the triangles that are about as near in space as the nearest one: those on both sides of a seam. */
static void look_around(place_search *s)
{
    const comparison *c = s->c;
    const cwi_closest nearest = cwi_closest_find(c->full, &c->space_tree, s->point);
    const double reach = AROUND * cwi_distance(nearest.point, s->point) + sqrt(c->sample_mm2);
    double reach_sq = reach * reach;
    look_at(s, (uint32_t)nearest.triangle);
    cwi_boxes_nearest(&c->space_tree, s->point, measure_space, s, &reach_sq);
    s->visits = 0;
}

static void measure_place(void *context, size_t slot, double *distance_sq)
{
    place_search *s = context;
    look_at(s, s->c->tree.order[slot]);
    *distance_sq = ++s->visits > MAX_VISITS ? 0 : s->best_sq;
}

/* near: a triangle of the full mesh that may be near, or NO_TRIANGLE; set to the nearest one */
static double measure_sample(const comparison *c, size_t t, const double weights[3],
                             const cw_attribute *uv, uint32_t *near)
{
    double point[DIMENSIONS] = {0};
    for (size_t k = 0; k < 3; k++) {
        const float *place = place_of(uv, c->mesh, 3 * t + k),
                    *p = cwi_mesh_point(c->mesh, t, k);
        for (size_t a = 0; a < 3; a++)
            point[a] += weights[k] * ((double)p[a] + c->shift[a]);
        for (size_t a = 0; a < 2; a++)
            point[IN_TEXTURE + a] += weights[k] * c->scale * (double)place[a];
    }
    const double place[3] = {point[IN_TEXTURE], point[IN_TEXTURE + 1], 0};
    place_search s = {c, point, INFINITY, *near, 0};
    if (*near != NO_TRIANGLE)
        look_at(&s, *near);
    look_around(&s);
    double distance_sq = s.best_sq;
    cwi_boxes_nearest(&c->tree, place, measure_place, &s, &distance_sq);
    *near = s.triangle;
    return sqrt(s.best_sq);
}

/* Samples a triangle evenly, and at its corners. */
static void measure_triangle(const comparison *c, size_t t, const cw_attribute *uv,
                             uint32_t *near, chunk_facts *facts)
{
    const double area = cwi_mesh_area(c->mesh, t);
    const double steps = ceil(sqrt(2 * area / c->sample_mm2));
    const int n = steps >= 1 ? (int)fmin(steps, MAX_STEPS) : 1;
    double sum = 0;
    size_t count = 0;
    for (int k = 0; k < 3; k++) {
        const double corner[3] = {k == 0, k == 1, k == 2};
        facts->max = fmax(facts->max, measure_sample(c, t, corner, uv, near));
    }
    for (int i = 0; i < n; i++)
        for (int j = 0; i + j < n; j++, count++) {
            const double a = (i + 1.0 / 3) / n, b = (j + 1.0 / 3) / n;
            const double distance =
                measure_sample(c, t, (const double[3]){a, b, 1 - a - b}, uv, near);
            facts->max = fmax(facts->max, distance);
            sum += distance;
        }
    facts->samples += count + 3;
    facts->area += area;
    facts->sum += area * sum / (double)count;
}

static void measure_chunk(void *context, size_t n)
{
    comparison *c = context;
    const cw_attribute *uv = cwi_texture_of(c->mesh);
    uint32_t near = NO_TRIANGLE;
    for (size_t t = n * CHUNK; t < (n + 1) * CHUNK && t < c->mesh->triangle_count; t++)
        measure_triangle(c, t, uv, &near, &c->chunks[n]);
}

/* Returns the area of a mesh, and sets that in its texture. */
static double find_areas(const cw_mesh *mesh, double *in_texture)
{
    const cw_attribute *uv = cwi_texture_of(mesh);
    double area = 0;
    *in_texture = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const float *a = place_of(uv, mesh, 3 * t), *b = place_of(uv, mesh, 3 * t + 1),
                    *c = place_of(uv, mesh, 3 * t + 2);
        area += cwi_mesh_area(mesh, t);
        *in_texture += fabs(((double)b[0] - (double)a[0]) * ((double)c[1] - (double)a[1]) -
                            ((double)b[1] - (double)a[1]) * ((double)c[0] - (double)a[0])) /
                       2;
    }
    return area;
}

/* Lays the triangles of the full mesh flat, where they lie in the texture. */
static cw_status lay_flat(comparison *c, cw_error *err)
{
    const cw_mesh *full = c->full;
    const cw_attribute *uv = cwi_texture_of(full);
    cw_status st =
        cwi_mesh_alloc(&c->flat, 3 * full->triangle_count, full->triangle_count, false, err);
    for (size_t n = 0; n < 3 * full->triangle_count && st == CW_OK; n++) {
        const float *at = place_of(uv, full, n);
        c->flat.triangles[n] = (uint32_t)n;
        for (size_t a = 0; a < 2; a++)
            c->flat.positions[3 * n + a] = (float)(c->scale * (double)at[a]);
        c->flat.positions[3 * n + 2] = 0;
        if (!isfinite(c->flat.positions[3 * n]) || !isfinite(c->flat.positions[3 * n + 1]))
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "texture coordinates of triangle %zu are not finite", n / 3);
    }
    if (st == CW_OK)
        st = cwi_closest_build(full, &c->space_tree, err);
    return st == CW_OK ? cwi_closest_build(&c->flat, &c->tree, err) : st;
}

static cw_status measure(comparison *c, int threads, cw_texture_distance *facts, cw_error *err)
{
    const cw_mesh *m = c->mesh;
    const size_t chunks = (m->triangle_count + CHUNK - 1) / CHUNK,
                 all = SAMPLES_PER_TRIANGLE * c->full->triangle_count,
                 wanted = all < MAX_SAMPLES ? all : MAX_SAMPLES;
    double in_texture, full_area = find_areas(c->full, &in_texture);
    *facts = (cw_texture_distance){0};
    if (!(in_texture > 0) || !(full_area > 0))
        return cwi_fail(err, CW_ERR_EMPTY, "the full mesh covers no area of its texture");
    c->scale = sqrt(full_area / in_texture);
    c->sample_mm2 = full_area / (double)wanted;
    for (int a = 0; a < 3; a++)
        c->shift[a] = m->origin[a] - c->full->origin[a];
    c->chunks = cwi_alloc_zeroed(chunks, sizeof *c->chunks);
    cw_status st = c->chunks ? lay_flat(c, err) : cwi_fail_memory(err);
    if (st == CW_OK)
        st = cwi_parallel_for(chunks, CHUNK * 256, threads, &(cw_progress){0}, "measuring",
                              measure_chunk, c, err);
    double area = 0;
    for (size_t n = 0; n < chunks && st == CW_OK; n++) {
        facts->samples += c->chunks[n].samples;
        facts->max_mm = fmax(facts->max_mm, c->chunks[n].max);
        facts->mean_mm += c->chunks[n].sum;
        area += c->chunks[n].area;
    }
    facts->mean_mm = area > 0 ? facts->mean_mm / area : 0;
    facts->side_mm = c->scale;
    return st;
}

cw_status cw_mesh_texture_distance(const cw_mesh *mesh, const cw_mesh *full, int threads,
                                   cw_texture_distance *facts, cw_error *err)
{
    CWI_REQUIRE(err, mesh, full, facts);
    comparison c = {.mesh = mesh, .full = full};
    cw_status st = cwi_mesh_check_size(mesh, "measured", err);
    if (st == CW_OK)
        st = cwi_mesh_check_size(full, "measured", err);
    if (st == CW_OK && (!cwi_texture_of(mesh) || !cwi_texture_of(full)))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "the %s has no texture coordinates",
                      cwi_texture_of(mesh) ? "full mesh" : "mesh");
    if (st == CW_OK)
        st = measure(&c, threads, facts, err);
    cw_mesh_free(&c.flat);
    cwi_boxes_free(&c.tree);
    cwi_boxes_free(&c.space_tree);
    cwi_free(c.chunks);
    return st;
}
