/* Compares a decoded mesh with the original by order-independent sums of triangle hashes
 * [Steele2014]. */
#include "formats/codec/verify_decoded.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/mesh/weld.h"

#include <math.h>
#include <string.h>

static const double DEGREES = 180 / CWI_PI;

/* Largest difference of a number of a tangent. */
static const double TANGENT_ERROR = 0.01;

/* Sums over triangles, independent of their order. */
typedef struct sums {
    uint64_t a, b;
} sums;

/* Hashes one number [Steele2014]. */
static uint64_t mix_bits(uint64_t x)
{
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return x ^ x >> 31;
}

/* Hashes a triangle. Corners are the first vertices at their positions, the lowest of them first.
 * Turning a triangle changes nothing; reversing it does, unless two of its corners are one. */
static uint64_t hash_triangle(const uint32_t *triangle, const uint32_t *map)
{
    uint64_t c[3];
    for (int k = 0; k < 3; k++)
        c[k] = map[triangle[k]];
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0])
        return mix_bits(mix_bits(c[0]) + mix_bits(c[1]) + mix_bits(c[2]));
    const int k = c[0] < c[1] && c[0] < c[2] ? 0 : c[1] < c[2] ? 1 : 2;
    return mix_bits(c[k] ^ mix_bits(c[(k + 1) % 3] ^ mix_bits(c[(k + 2) % 3])));
}

static sums sum_triangles(const uint32_t *triangles, size_t count, const uint32_t *map)
{
    sums s = {0, 0};
    for (size_t t = 0; t < count; t++) {
        const uint64_t h = hash_triangle(triangles + 3 * t, map);
        s.a += h;
        s.b += mix_bits(h);
    }
    return s;
}

/* Stores the positions of the mesh, and after them those of the decoded one, as bits of floats:
 * below 2^30 they are finite. */
static void put_points(const cw_mesh *mesh, const cwi_quantization_grid *grid,
                       const cwi_decoded *d, float *grid_points)
{
    const size_t count = 3 * mesh->vertex_count;
    if (!grid->bits) {
        memcpy(grid_points, mesh->positions, count * sizeof *grid_points);
        memcpy(grid_points + count, d->positions, 3 * d->vertex_count * sizeof *grid_points);
        return;
    }
    for (size_t i = 0; i < count; i++) {
        const uint32_t grid_point = cwi_grid_round(grid, mesh->positions[i], (int)(i % 3));
        memcpy(grid_points + i, &grid_point, sizeof grid_point);
    }
    memcpy(grid_points + count, d->grid_points, 3 * d->vertex_count * sizeof *d->grid_points);
}

static double angle_between(const float *a, const float *b)
{
    const double u[3] = {(double)a[0], (double)a[1], (double)a[2]},
                 v[3] = {(double)b[0], (double)b[1], (double)b[2]};
    double w[3];
    cwi_cross(u, v, w);
    return atan2(cwi_length(w), cwi_dot(u, v)) * DEGREES;
}

/* Marks positions with several vertices of the mesh. There a decoded vertex cannot be assigned to
 * one of them. */
static void mark_shared(const uint32_t *map, size_t count, bool *shared)
{
    for (size_t v = 0; v < count; v++)
        if (map[v] != v)
            shared[map[v]] = true;
}

static cw_status compare_arrays(const cw_mesh *mesh, const cwi_decoded *d, const uint32_t *map,
                                const bool *shared, double *normal_degrees, cw_error *err)
{
    const size_t count = mesh->vertex_count;
    for (size_t v = 0; v < d->vertex_count; v++) {
        const uint32_t original = map[count + v];
        if (original >= count)
            return cwi_fail(err, CW_ERR_CHECK, "decoded vertex %zu stands where none was", v);
        if (d->normals && mesh->normals && !shared[original])
            *normal_degrees =
                fmax(*normal_degrees,
                     angle_between(d->normals + 3 * v, mesh->normals + 3 * (size_t)original));
    }
    const sums was = sum_triangles(mesh->triangles, mesh->triangle_count, map);
    const sums is = sum_triangles(d->triangles, d->triangle_count, map + count);
    if (was.a != is.a || was.b != is.b)
        return cwi_fail(err, CW_ERR_CHECK, "the decoded triangles are not those encoded");
    return CW_OK;
}

/* Returns the length of the longer side of the box around texture coordinates. */
static double measure_texture(const float *texture, size_t count)
{
    float low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (size_t i = 0; i < 2 * count; i++) {
        low[i % 2] = fminf(low[i % 2], texture[i]);
        high[i % 2] = fmaxf(high[i % 2], texture[i]);
    }
    return fmax((double)high[0] - (double)low[0], (double)high[1] - (double)low[1]);
}

/* Returns true if a decoded vertex has the tangent of an encoded one, up to its few bits, and the side of the
 * bitangent. */
static bool has_tangent(const cwi_decoded *d, size_t v, size_t w)
{
    const float *is = d->tangents + 4 * v, *was = d->tangents_encoded + 4 * w;
    for (int k = 0; k < 3; k++)
        if (!(fabs((double)is[k] - (double)was[k]) < TANGENT_ERROR))
            return false;
    return is[3] * was[3] > 0;
}

/* Looks for the texture coordinate of each decoded vertex among those of the vertices at its position. */
static cw_status compare_texture(const cw_mesh *mesh, const cwi_decoded *d, const uint32_t *map,
                                 cw_error *err)
{
    const size_t count = mesh->vertex_count;
    const double step = measure_texture(d->texture_encoded, count) / (1 << d->texture_bits);
    uint32_t *first = cwi_alloc_array(count, sizeof *first);
    uint32_t *next = cwi_alloc_array(count, sizeof *next); /* of the vertices at one position */
    cw_status st = first && next ? CW_OK : cwi_fail_memory(err);
    for (size_t v = 0; v < count && st == CW_OK; v++)
        first[v] = UINT32_MAX;
    for (uint32_t v = 0; v < count && st == CW_OK; v++) {
        next[v] = first[map[v]];
        first[map[v]] = v;
    }
    for (size_t v = 0; v < d->vertex_count && st == CW_OK; v++) {
        bool found = false;
        for (uint32_t w = first[map[count + v]]; w != UINT32_MAX && !found; w = next[w])
            found = fabs((double)d->texture[2 * v] -
                         (double)d->texture_encoded[2 * (size_t)w]) <= step &&
                    fabs((double)d->texture[2 * v + 1] -
                         (double)d->texture_encoded[2 * (size_t)w + 1]) <= step &&
                    (!d->tangents || has_tangent(d, v, w));
        if (!found)
            st = cwi_fail(
                err, CW_ERR_CHECK,
                "the texture coordinate or tangent of decoded vertex %zu is not the one encoded",
                v);
    }
    cwi_free(first);
    cwi_free(next);
    return st;
}

cw_status cwi_verify(const cw_mesh *mesh, const cwi_quantization_grid *grid,
                     const cwi_decoded *decoded, double *normal_degrees, cw_error *err)
{
    const size_t count = mesh->vertex_count + decoded->vertex_count;
    if (decoded->triangle_count != mesh->triangle_count)
        return cwi_fail(err, CW_ERR_CHECK, "%zu triangles were encoded, and %zu decoded",
                        mesh->triangle_count, decoded->triangle_count);
    float *grid_points = cwi_alloc_array(count, 3 * sizeof *grid_points);
    uint32_t *map = cwi_alloc_array(count, sizeof *map);
    bool *shared = cwi_alloc_zeroed(mesh->vertex_count, sizeof *shared);
    if (grid_points)
        put_points(mesh, grid, decoded, grid_points);
    cw_status st = CW_OK;
    if (grid_points && map && shared && cwi_weld(grid_points, count, map)) {
        mark_shared(map, mesh->vertex_count, shared);
        st = compare_arrays(mesh, decoded, map, shared, normal_degrees, err);
        if (st == CW_OK && decoded->texture && decoded->texture_encoded)
            st = compare_texture(mesh, decoded, map, err);
    } else {
        st = cwi_fail_memory(err);
    }
    cwi_free(shared);
    cwi_free(grid_points);
    cwi_free(map);
    return st;
}
