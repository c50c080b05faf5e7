/* What single precision leaves of a mesh in world coordinates. */
#include "formats/mesh_writers.h"

#include "core/memory.h"
#include "core/status.h"

#include <float.h>
#include <math.h>

/* Coordinates beyond single precision stay at its largest number. */
static void round_points(const cw_mesh *mesh, float *rounded)
{
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++) {
        const double world = cwi_world_coordinate(mesh, i / 3, (int)(i % 3));
        rounded[i] = (float)fmax(fmin(world, (double)FLT_MAX), -(double)FLT_MAX);
    }
}

static double step_of(const cw_mesh *mesh)
{
    double low[3], high[3], farthest = 0;
    cw_mesh_bounds(mesh, low, high);
    for (int a = 0; a < 3; a++)
        farthest = fmax(farthest, fmax(fabs(low[a]), fabs(high[a])));
    return farthest > 0 ? ldexp(1, ilogb(farthest) - 23) : 0;
}

static bool has_area(const float *points, const uint32_t *t)
{
    const float *p = points + 3 * (size_t)t[0], *q = points + 3 * (size_t)t[1],
                *r = points + 3 * (size_t)t[2];
    double u[3], v[3];
    for (int a = 0; a < 3; a++) {
        u[a] = (double)q[a] - (double)p[a];
        v[a] = (double)r[a] - (double)p[a];
    }
    return u[0] * v[1] != u[1] * v[0] || u[1] * v[2] != u[2] * v[1] ||
           u[2] * v[0] != u[0] * v[2];
}

static size_t count_flat(const cw_mesh *mesh, const float *rounded)
{
    size_t flat = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *triangle = mesh->triangles + 3 * t;
        flat += !has_area(rounded, triangle) && has_area(mesh->positions, triangle);
    }
    return flat;
}

static bool same_point(const float *points, size_t v, size_t u)
{
    const float *p = points + 3 * v, *q = points + 3 * u;
    return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
}

static size_t hash_point(const float *p)
{
    uint64_t hash = 0;
    for (int a = 0; a < 3; a++) {
        const float positive_zero = p[a] + 0.0f; /* -0 equals 0, so it must hash as 0 does */
        uint32_t bits;
        memcpy(&bits, &positive_zero, sizeof bits);
        hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 32;
    }
    return (size_t)hash;
}

/* Vertices whose rounded point an earlier one has that is elsewhere in truth. The table holds
 * vertex + 1 where the hash of its rounded point says, or in the next free slot. */
static size_t count_merged(const cw_mesh *mesh, const float *rounded, uint32_t *table,
                           size_t mask)
{
    size_t merged = 0;
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        size_t s = hash_point(rounded + 3 * v) & mask;
        while (table[s] && !same_point(rounded, v, table[s] - 1))
            s = (s + 1) & mask;
        if (!table[s])
            table[s] = (uint32_t)v + 1;
        merged += !same_point(mesh->positions, v, table[s] - 1);
    }
    return merged;
}

cw_status cwi_measure_loss(const cw_mesh *mesh, cw_write_loss *loss, cw_error *err)
{
    const size_t count = mesh->vertex_count;
    size_t size = 1;
    while (size < 2 * count)
        size *= 2;
    float *rounded = cwi_alloc_array(count, 3 * sizeof *rounded);
    uint32_t *table = cwi_alloc_zeroed(size, sizeof *table);
    const bool ok = rounded && table;
    if (ok) {
        round_points(mesh, rounded);
        loss->step_mm = step_of(mesh);
        loss->merged_vertices = count_merged(mesh, rounded, table, size - 1);
        loss->flat_triangles = count_flat(mesh, rounded);
    }
    cwi_free(rounded);
    cwi_free(table);
    return ok ? CW_OK
              : cw_fail(err, CW_ERR_NO_MEMORY, "no memory to compare %zu vertices", count);
}
