/* Adds points to a patch until its triangles are as large as those around it [Liepa2003], and flips
 * edges so that no triangle is thin. */
#include "core/base/memory.h"
#include "core/geometry/triangle.h"
#include "core/geometry/vec3.h"
#include "core/mesh/corner_table.h"
#include "simplify/repair/hole_patch.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Rounds of division, rounds of flips after each, and triangles beyond which none is divided. */
enum { DIVIDE_ROUNDS = 24, FLIP_ROUNDS = 12, MAX_TRIANGLES = 4000000 };

/* Points are as dense as around: the factor of [Liepa2003]. */
static const double DENSITY = 1.4142135623730951;

/* Cotangents of opposite angles whose sum is below this make an edge flip. */
static const double FLIP_BELOW = -1e-6;

typedef struct refinement {
    cwi_hole_patch *patch;
    const cwi_boundary_loop *loop;
    const cwi_hole_mesh *around;
    double times; /* how many times larger than around the rim triangles may be */
} refinement;

typedef struct patch_side {
    uint64_t key;
    uint32_t triangle, corner;
} patch_side;

static int compare_sides(const void *a, const void *b)
{
    const patch_side *s = a, *t = b;
    if (s->key != t->key)
        return s->key < t->key ? -1 : 1;
    return s->triangle < t->triangle ? -1 : s->triangle > t->triangle;
}

static bool find_neighbours(cwi_hole_patch *p)
{
    const size_t count = 3 * p->triangle_count;
    patch_side *sides = cwi_alloc_array(count, sizeof *sides);
    if (!sides)
        return false;
    for (uint32_t n = 0; n < count; n++) {
        const uint64_t a = p->triangles[n / 3][n % 3], b = p->triangles[n / 3][(n + 1) % 3];
        sides[n] = (patch_side){a < b ? a << 32 | b : b << 32 | a, n / 3, n % 3};
    }
    qsort(sides, count, sizeof *sides, compare_sides);
    for (size_t n = 0; n + 1 < count; n++)
        if (sides[n].key == sides[n + 1].key) {
            p->neighbours[sides[n].triangle][sides[n].corner] = sides[n + 1].triangle;
            p->neighbours[sides[n + 1].triangle][sides[n + 1].corner] = sides[n].triangle;
        }
    cwi_free(sides);
    return true;
}

/* Returns the mean length of the mesh's edges at a vertex. */
static double measure_edges(const refinement *r, uint32_t v)
{
    const cw_mesh *m = r->around->mesh;
    double sum = 0, points[2][3];
    size_t count = 0;
    for (uint32_t i = r->around->first[v]; i < r->around->first[v + 1]; i++) {
        const uint32_t *corners = m->triangles + 3 * (size_t)r->around->around[i];
        for (int k = 0; k < 3; k++) {
            if (corners[k] == v)
                continue;
            for (size_t a = 0; a < 3; a++) {
                points[0][a] = (double)m->positions[3 * (size_t)v + a];
                points[1][a] = (double)m->positions[3 * (size_t)corners[k] + a];
            }
            sum += cwi_distance(points[0], points[1]);
            count++;
        }
    }
    return count ? sum / (double)count : 0;
}

/* Sets the sizes at the rim, and of a point in the middle of a fan. */
static void measure_loop(refinement *r)
{
    double mean = 0;
    for (size_t n = 0; n < r->loop->size; n++) {
        r->patch->sizes[n] = measure_edges(r, r->loop->vertices[n]);
        mean += r->patch->sizes[n] / (double)r->loop->size;
    }
    for (size_t n = r->loop->size; n < r->patch->count; n++)
        if (r->patch->sizes[n] == 0)
            r->patch->sizes[n] = mean;
}

/* --- flips -------------------------------------------------------------------------------- */

static int corner_of(const cwi_hole_patch *p, uint32_t t, uint32_t vertex)
{
    return p->triangles[t][0] == vertex ? 0 : p->triangles[t][1] == vertex ? 1 : 2;
}

/* Returns the side of a triangle at which a neighbour lies. */
static int side_toward(const cwi_hole_patch *p, uint32_t t, uint32_t neighbour)
{
    return p->neighbours[t][0] == neighbour ? 0 : p->neighbours[t][1] == neighbour ? 1 : 2;
}

/* Returns true if the patch has an edge from a to b; t has the corner a. Goes round a, one way and, at
 * a rim, the other. */
static bool has_patch_edge(const cwi_hole_patch *p, uint32_t t, uint32_t a, uint32_t b)
{
    for (int forward = 0; forward < 2; forward++) {
        uint32_t at = t;
        do {
            const int k = corner_of(p, at, a);
            if (p->triangles[at][(k + 1) % 3] == b || p->triangles[at][(k + 2) % 3] == b)
                return true;
            at = p->neighbours[at][forward ? k : (k + 2) % 3];
        } while (at != CWI_NO_NEIGHBOUR && at != t);
        if (at == t)
            return false;
    }
    return false;
}

static void compute_normal(const cwi_hole_patch *p, uint32_t a, uint32_t b, uint32_t c,
                           double normal[3])
{
    cwi_triangle_normal(p->points[a], p->points[b], p->points[c], normal);
}

static double cotangent_at(const cwi_hole_patch *p, uint32_t tip, uint32_t a, uint32_t b)
{
    double u[3], v[3], area[3];
    cwi_sub(p->points[a], p->points[tip], u);
    cwi_sub(p->points[b], p->points[tip], v);
    cwi_cross(u, v, area);
    const double sine = cwi_length(area), cosine = cwi_dot(u, v);
    return sine > 0 ? cosine / sine : cosine < 0 ? -1e30 : 1e30;
}

/* Returns true if both new triangles face the way of the old ones. */
static bool keeps_facing(const cwi_hole_patch *p, uint32_t a, uint32_t b, uint32_t tip,
                         uint32_t far)
{
    double old[2][3], made[2][3], sum[3];
    compute_normal(p, a, b, tip, old[0]);
    compute_normal(p, b, a, far, old[1]);
    compute_normal(p, a, far, tip, made[0]);
    compute_normal(p, far, b, tip, made[1]);
    for (int k = 0; k < 3; k++)
        sum[k] = old[0][k] + old[1][k];
    return cwi_dot(made[0], sum) > 0 && cwi_dot(made[1], sum) > 0;
}

static void replace_neighbour(cwi_hole_patch *p, uint32_t t, uint32_t before, uint32_t now)
{
    if (t != CWI_NO_NEIGHBOUR)
        p->neighbours[t][side_toward(p, t, before)] = now;
}

/* Flips the edge at a corner of a triangle if the two angles opposite to it are too large together. */
static bool flip_edge(refinement *r, uint32_t t, int k)
{
    cwi_hole_patch *p = r->patch;
    const uint32_t u = p->neighbours[t][k];
    if (u == CWI_NO_NEIGHBOUR || u < t)
        return false;
    const int l = side_toward(p, u, t);
    const uint32_t a = p->triangles[t][k], b = p->triangles[t][(k + 1) % 3],
                   tip = p->triangles[t][(k + 2) % 3], far = p->triangles[u][(l + 2) % 3];
    const double sum = cotangent_at(p, tip, a, b) + cotangent_at(p, far, a, b);
    if (!(sum < FLIP_BELOW) || !keeps_facing(p, a, b, tip, far) || tip == far ||
        has_patch_edge(p, t, tip, far))
        return false;
    if (tip < r->loop->size && far < r->loop->size &&
        cwi_edge_exists(r->around->edges, r->around->edge_count, r->loop->vertices[tip],
                        r->loop->vertices[far]))
        return false;
    const uint32_t beyond_b = p->neighbours[t][(k + 1) % 3], /* edge b, tip */
        beyond_a = p->neighbours[t][(k + 2) % 3],            /* edge tip, a */
        past_a = p->neighbours[u][(l + 1) % 3],              /* edge a, far */
        past_b = p->neighbours[u][(l + 2) % 3];              /* edge far, b */
    replace_neighbour(p, past_a, u, t);
    replace_neighbour(p, beyond_b, t, u);
    memcpy(p->triangles[t], (const uint32_t[3]){a, far, tip}, sizeof *p->triangles);
    memcpy(p->neighbours[t], (const uint32_t[3]){past_a, u, beyond_a}, sizeof *p->neighbours);
    memcpy(p->triangles[u], (const uint32_t[3]){far, b, tip}, sizeof *p->triangles);
    memcpy(p->neighbours[u], (const uint32_t[3]){past_b, beyond_b, t}, sizeof *p->neighbours);
    return true;
}

static void flip_edges(refinement *r)
{
    bool flipped = true;
    for (int n = 0; n < FLIP_ROUNDS && flipped; n++) {
        flipped = false;
        for (uint32_t t = 0; t < r->patch->triangle_count; t++)
            for (int k = 0; k < 3; k++)
                flipped = flip_edge(r, t, k) || flipped;
    }
}

/* --- division ----------------------------------------------------------------------------- */

static bool is_too_large(const refinement *r, uint32_t t, double middle[3], double *size)
{
    const uint32_t *v = r->patch->triangles[t];
    *size = 0;
    cwi_triangle_centroid(r->patch->points[v[0]], r->patch->points[v[1]],
                          r->patch->points[v[2]], middle);
    for (int k = 0; k < 3; k++)
        *size += r->patch->sizes[v[k]] / 3;
    for (int k = 0; k < 3; k++) {
        const double d = DENSITY * cwi_distance(middle, r->patch->points[v[k]]);
        if (!(d > r->times * *size) || !(d > r->times * r->patch->sizes[v[k]]))
            return false;
    }
    return true;
}

/* Divides a triangle in three around a new point. */
static bool divide_triangle(refinement *r, uint32_t t, const double middle[3], double size)
{
    cwi_hole_patch *p = r->patch;
    const uint32_t tip = (uint32_t)p->count, second = (uint32_t)p->triangle_count,
                   third = second + 1;
    const uint32_t a = p->triangles[t][0], b = p->triangles[t][1], c = p->triangles[t][2];
    const uint32_t beyond[3] = {p->neighbours[t][0], p->neighbours[t][1], p->neighbours[t][2]};
    if (!cwi_patch_add_point(p, middle) || !cwi_patch_add_triangle(p, b, c, tip) ||
        !cwi_patch_add_triangle(p, c, a, tip))
        return false;
    p->sizes[tip] = size;
    p->triangles[t][2] = tip;
    memcpy(p->neighbours[t], (const uint32_t[3]){beyond[0], second, third}, sizeof beyond);
    memcpy(p->neighbours[second], (const uint32_t[3]){beyond[1], third, t}, sizeof beyond);
    memcpy(p->neighbours[third], (const uint32_t[3]){beyond[2], t, second}, sizeof beyond);
    replace_neighbour(p, beyond[1], t, second);
    replace_neighbour(p, beyond[2], t, third);
    return true;
}

bool cwi_patch_refine(cwi_hole_patch *patch, const cwi_boundary_loop *loop,
                      const cwi_hole_mesh *around, double times)
{
    refinement r = {.patch = patch, .loop = loop, .around = around, .times = times};
    bool ok = find_neighbours(patch), divided = true;
    if (ok) {
        measure_loop(&r);
        flip_edges(&r);
    }
    for (int n = 0; n < DIVIDE_ROUNDS && ok && divided; n++) {
        const size_t count = patch->triangle_count;
        divided = false;
        for (uint32_t t = 0; t < count && ok && patch->triangle_count < MAX_TRIANGLES; t++) {
            double middle[3], size;
            if (!is_too_large(&r, t, middle, &size))
                continue;
            ok = divide_triangle(&r, t, middle, size);
            divided = true;
        }
        if (ok)
            flip_edges(&r);
    }
    return ok;
}
