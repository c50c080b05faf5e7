/* Welds vertices within a distance of each other, on a lattice of cells of that size. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/lattice_map.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "simplify/repair/repair_state.h"

#include <math.h>
#include <string.h>

/* Cells along the longest side of the box, at most. */
static const double MAX_CELLS = 1 << 20;

/* Vertices that stay, by cells. */
typedef struct near_map {
    const cw_mesh *mesh;
    double low[3], cell_mm, distance_sq;
    cwi_lattice_map cells;
    uint32_t *first; /* of a cell: the last vertex that came; UINT32_MAX: none */
    size_t capacity;
    uint32_t *next; /* of a vertex: the one before it in its cell */
    uint32_t *map;  /* of a vertex: the one it becomes */
} near_map;

static void free_map(near_map *n)
{
    cwi_lattice_free(&n->cells);
    cwi_free(n->first);
    cwi_free(n->next);
    cwi_free(n->map);
}

static bool init_map(near_map *n, double distance_mm)
{
    double high[3], longest = 0;
    cw_mesh_bounds(n->mesh, n->low, high);
    for (int a = 0; a < 3; a++) {
        longest = fmax(longest, high[a] - n->low[a]);
        n->low[a] -= n->mesh->origin[a];
    }
    n->cell_mm = fmax(distance_mm, longest / MAX_CELLS);
    n->distance_sq = distance_mm * distance_mm;
    n->next = cwi_alloc_array(n->mesh->vertex_count, sizeof *n->next);
    n->map = cwi_alloc_array(n->mesh->vertex_count, sizeof *n->map);
    return n->next && n->map;
}

/* Finds the nearest vertex that stays within the distance; UINT32_MAX: none. at: cell + 1 */
static uint32_t find_near(const near_map *n, const float *p, const uint32_t at[3])
{
    uint32_t best = UINT32_MAX;
    double nearest_sq = n->distance_sq;
    for (uint32_t k = 0; k < 27; k++) {
        const uint32_t beside[3] = {at[0] + k % 3 - 1, at[1] + k / 3 % 3 - 1,
                                    at[2] + k / 9 - 1};
        const uint32_t cell = cwi_lattice_find(&n->cells, cwi_lattice_key(beside));
        if (cell == CWI_NO_LATTICE_POINT)
            continue;
        for (uint32_t v = n->first[cell]; v != UINT32_MAX; v = n->next[v]) {
            const double here_sq = cwi_point_distance_sq(p, n->mesh->positions + 3 * (size_t)v);
            if (here_sq < nearest_sq || (here_sq == nearest_sq && v < best)) {
                nearest_sq = here_sq;
                best = v;
            }
        }
    }
    return best;
}

static bool keep_vertex(near_map *n, uint32_t v, const uint32_t at[3])
{
    const uint32_t cell = cwi_lattice_add(&n->cells, cwi_lattice_key(at));
    if (cell == CWI_NO_LATTICE_POINT)
        return false;
    if (cell >= n->capacity) {
        const size_t capacity = 2 * (size_t)cell + 64;
        uint32_t *first = cwi_realloc_array(n->first, capacity, sizeof *first);
        if (!first)
            return false;
        memset(first + n->capacity, 0xff, (capacity - n->capacity) * sizeof *first);
        n->first = first;
        n->capacity = capacity;
    }
    n->next[v] = n->first[cell];
    n->first[cell] = v;
    return true;
}

static bool map_vertices(near_map *n)
{
    for (uint32_t v = 0; v < n->mesh->vertex_count; v++) {
        const float *p = n->mesh->positions + 3 * (size_t)v;
        uint32_t at[3];
        for (int a = 0; a < 3; a++)
            at[a] = (uint32_t)(((double)p[a] - n->low[a]) / n->cell_mm) + 1;
        const uint32_t near = find_near(n, p, at);
        n->map[v] = near == UINT32_MAX ? v : near;
        if (near == UINT32_MAX && !keep_vertex(n, v, at))
            return false;
    }
    return true;
}

cw_status cwi_weld_near(cw_mesh *mesh, double distance_mm, size_t *welded, cw_error *err)
{
    near_map n = {.mesh = mesh};
    bool *gone = cwi_alloc_zeroed(mesh->triangle_count, sizeof *gone);
    cw_status st =
        gone && init_map(&n, distance_mm) && map_vertices(&n) ? CW_OK : cwi_fail_memory(err);
    for (size_t c = 0; c < 3 * mesh->triangle_count && st == CW_OK; c++)
        mesh->triangles[c] = n.map[mesh->triangles[c]];
    for (size_t t = 0; t < mesh->triangle_count && st == CW_OK; t++) {
        const uint32_t *v = mesh->triangles + 3 * t;
        gone[t] = v[0] == v[1] || v[1] == v[2] || v[2] == v[0];
    }
    for (size_t v = 0; v < mesh->vertex_count && st == CW_OK; v++)
        *welded += n.map[v] != v;
    if (st == CW_OK)
        st = cwi_mesh_drop_marked(mesh, gone, err);
    cwi_free(gone);
    free_map(&n);
    return st;
}
