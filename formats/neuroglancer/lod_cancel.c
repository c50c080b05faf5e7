/* Cancels pairs of triangles with the same corners and opposite windings. */
#include "core/base/memory.h"
#include "core/geometry/lattice_map.h"
#include "core/geometry/vec3.h"
#include "formats/neuroglancer/lod_grid.h"

#include <math.h>
#include <string.h>

/* A triangle with its corners in rising order. */
typedef struct sorted_corners {
    uint32_t corner[3];
    bool is_odd; /* sorting reversed the winding */
} sorted_corners;

static sorted_corners sort_corners(const uint32_t *triangle)
{
    sorted_corners s = {.corner = {triangle[0], triangle[1], triangle[2]}};
    for (int pass = 0; pass < 3; pass++) {
        const int k = pass % 2;
        if (s.corner[k] > s.corner[k + 1]) {
            const uint32_t lower = s.corner[k + 1];
            s.corner[k + 1] = s.corner[k];
            s.corner[k] = lower;
            s.is_odd = !s.is_odd;
        }
    }
    return s;
}

/* The height of needles, in steps: rounding moves each of three corners by less than one. */
static const double NEEDLE_STEPS = 2;

/* Returns true if the height over the longest side is small. */
static bool is_needle(const uint32_t *triangle, const uint64_t *keys)
{
    double corner[3][3], side[3][3], normal[3], longest_sq = 0;
    for (int k = 0; k < 3; k++) {
        uint32_t at[3];
        cwi_lattice_point(keys[triangle[k]], at);
        for (int a = 0; a < 3; a++)
            corner[k][a] = at[a];
    }
    for (int k = 0; k < 3; k++) {
        for (int a = 0; a < 3; a++)
            side[k][a] = corner[(k + 1) % 3][a] - corner[k][a];
        longest_sq = fmax(longest_sq, cwi_dot(side[k], side[k]));
    }
    cwi_cross(side[0], side[1], normal);
    return cwi_dot(normal, normal) <= NEEDLE_STEPS * NEEDLE_STEPS * longest_sq;
}

static uint64_t hash_corners(const sorted_corners *s)
{
    uint64_t h = 0;
    for (int k = 0; k < 3; k++) {
        h = (h ^ s->corner[k]) * UINT64_C(0x9E3779B97F4A7C15);
        h ^= h >> 32;
    }
    return h;
}

/* Enters a triangle into the table, or marks it and its opposite in the table as cancelled. */
static void enter_triangle(const uint32_t *triangles, uint32_t t, uint32_t *table, size_t slots,
                           bool *cancelled)
{
    const sorted_corners own = sort_corners(triangles + 3 * (size_t)t);
    size_t slot = (size_t)hash_corners(&own) & (slots - 1);
    for (; table[slot]; slot = (slot + 1) & (slots - 1)) {
        const uint32_t other = table[slot] - 1;
        const sorted_corners its = sort_corners(triangles + 3 * (size_t)other);
        if (!cancelled[other] && its.is_odd != own.is_odd &&
            memcmp(its.corner, own.corner, sizeof own.corner) == 0) {
            cancelled[other] = cancelled[t] = true;
            return;
        }
    }
    table[slot] = t + 1;
}

bool cwi_lod_cancel(cw_mesh *mesh, const uint64_t *keys)
{
    size_t slots = 16, kept = 0;
    while (slots < 2 * mesh->triangle_count)
        slots *= 2;
    uint32_t *table = cwi_alloc_zeroed(slots, sizeof *table);
    bool *cancelled = cwi_alloc_zeroed(mesh->triangle_count, sizeof *cancelled);
    const bool has_memory = table && cancelled;
    for (size_t t = 0; t < mesh->triangle_count && has_memory; t++)
        if (is_needle(mesh->triangles + 3 * t, keys))
            enter_triangle(mesh->triangles, (uint32_t)t, table, slots, cancelled);
    for (size_t t = 0; t < mesh->triangle_count && has_memory; t++)
        if (!cancelled[t])
            memmove(mesh->triangles + 3 * kept++, mesh->triangles + 3 * t,
                    3 * sizeof *mesh->triangles);
    mesh->triangle_count = has_memory ? kept : mesh->triangle_count;
    cwi_free(table);
    cwi_free(cancelled);
    return has_memory;
}
