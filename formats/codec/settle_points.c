/* Finds places on a grid for points that rounding would put onto each other. */
#include "formats/codec/settle_points.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/triangle_intersect.h"
#include "core/geometry/vec3.h"
#include "core/mesh/corner_table.h"
#include "core/mesh/mesh.h"
#include "core/mesh/weld.h"

#include <math.h>
#include <string.h>

/* REACH: steps along each axis, at most, from the nearest place of a point to the one that it gets. */
enum { REACH = 2, SIDE = 2 * REACH + 1, PLACES = SIDE * SIDE * SIDE, PASSES = 4 };

/* In the table of cells. */
enum { EMPTY = 0, REMOVED = 1, FIRST = 2 };

/* --- gathering ---------------------------------------------------------------------------- */

static void put_triangles(cwi_settler *s, const cw_mesh *m, size_t triangle, size_t point)
{
    for (size_t c = 0; c < 3 * m->triangle_count; c++)
        s->corners[3 * triangle + c] = s->map[point + m->triangles[c]];
}

cw_status cwi_settler_init(cwi_settler *s, const cwi_parts *parts, cw_error *err)
{
    *s = (cwi_settler){0};
    for (size_t p = 0; p < parts->count; p++) {
        s->count += parts->items[p].mesh.vertex_count;
        s->triangles += parts->items[p].mesh.triangle_count;
    }
    if (s->count >= UINT32_MAX - FIRST || s->triangles > CWI_MAX_TRIANGLES)
        return cwi_fail(err, CW_ERR_LIMIT, "all parts have too many vertices or triangles");
    for (s->slots = 16; s->slots < 2 * s->count; s->slots *= 2)
        ;
    s->points = cwi_alloc_array(s->count, 3 * sizeof *s->points);
    s->map = cwi_alloc_array(s->count, sizeof *s->map);
    s->corners = cwi_alloc_array(s->triangles, 3 * sizeof *s->corners);
    s->first = cwi_alloc_array(s->count + 2, sizeof *s->first);
    s->around = cwi_alloc_array(s->triangles, 3 * sizeof *s->around);
    s->cell = cwi_alloc_array(s->count, sizeof *s->cell);
    s->table = cwi_alloc_array(s->slots, sizeof *s->table);
    if (!s->points || !s->map || !s->corners || !s->first || !s->around || !s->cell ||
        !s->table)
        return cwi_fail_memory(err);
    for (size_t p = 0, point = 0; p < parts->count; p++) {
        const cw_mesh *m = &parts->items[p].mesh;
        memcpy(s->points + 3 * point, m->positions, 3 * m->vertex_count * sizeof *s->points);
        point += m->vertex_count;
    }
    if (!cwi_weld(s->points, s->count, s->map))
        return cwi_fail_memory(err);
    for (size_t p = 0, point = 0, triangle = 0; p < parts->count; p++) {
        const cw_mesh *m = &parts->items[p].mesh;
        put_triangles(s, m, triangle, point);
        point += m->vertex_count;
        triangle += m->triangle_count;
    }
    cwi_fans_sort(s->corners, s->triangles, s->count, s->first, s->around);
    return CW_OK;
}

void cwi_settler_free(cwi_settler *s)
{
    cwi_free(s->points);
    cwi_free(s->map);
    cwi_free(s->corners);
    cwi_free(s->first);
    cwi_free(s->around);
    cwi_free(s->cell);
    cwi_free(s->table);
    *s = (cwi_settler){0};
}

/* --- taken places ------------------------------------------------------------------------- */

static size_t hash_cell(const uint32_t cell[3])
{
    uint64_t h = 0;
    for (int a = 0; a < 3; a++) {
        h = (h ^ cell[a]) * 0x9e3779b97f4a7c15u;
        h ^= h >> 29;
    }
    return (size_t)h;
}

/* Returns the slot of the point in a cell, or the empty one that ends the search. */
static size_t find_slot(const cwi_settler *s, const uint32_t cell[3])
{
    size_t at = hash_cell(cell) & (s->slots - 1);
    while (s->table[at] != EMPTY &&
           (s->table[at] == REMOVED ||
            memcmp(s->cell[s->table[at] - FIRST], cell, sizeof *s->cell) != 0))
        at = (at + 1) & (s->slots - 1);
    return at;
}

static bool is_taken(const cwi_settler *s, const uint32_t cell[3])
{
    return s->table[find_slot(s, cell)] != EMPTY;
}

static void take_cell(cwi_settler *s, uint32_t point, const uint32_t cell[3])
{
    memcpy(s->cell[point], cell, sizeof *s->cell);
    s->table[find_slot(s, cell)] = point + FIRST;
}

static void leave_cell(cwi_settler *s, uint32_t point)
{
    s->table[find_slot(s, s->cell[point])] = REMOVED;
}

/* --- triangles ---------------------------------------------------------------------------- */

/* Computes the area vector of a triangle on the grid: exact, below 2^62. */
static void find_area(const cwi_settler *s, const uint32_t *corners, int64_t area[3])
{
    int64_t u[3], v[3];
    for (int a = 0; a < 3; a++) {
        u[a] = (int64_t)s->cell[corners[1]][a] - s->cell[corners[0]][a];
        v[a] = (int64_t)s->cell[corners[2]][a] - s->cell[corners[0]][a];
    }
    for (int a = 0; a < 3; a++)
        area[a] = u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
}

/* Returns true if a triangle has an area on the grid, or had none. strict: it keeps its side, too */
static bool keeps_shape(const cwi_settler *s, size_t t, bool strict)
{
    const uint32_t *c = s->corners + 3 * t;
    int64_t area[3];
    double before[3], u[3], v[3];
    find_area(s, c, area);
    if (!cwi_has_area(s->points, c))
        return true;
    if (!area[0] && !area[1] && !area[2])
        return false;
    cwi_sub_points(s->points + 3 * (size_t)c[1], s->points + 3 * (size_t)c[0], u);
    cwi_sub_points(s->points + 3 * (size_t)c[2], s->points + 3 * (size_t)c[0], v);
    cwi_cross(u, v, before);
    return !strict || (double)area[0] * before[0] + (double)area[1] * before[1] +
                              (double)area[2] * before[2] >
                          0;
}

/* Returns true if the other corners of a triangle share a cell: no place of the point gives it an area. */
static bool others_coincide(const cwi_settler *s, size_t t, uint32_t point)
{
    const uint32_t *c = s->corners + 3 * t;
    const int k = c[0] == point ? 0 : c[1] == point ? 1 : 2;
    return memcmp(s->cell[c[(k + 1) % 3]], s->cell[c[(k + 2) % 3]], sizeof *s->cell) == 0;
}

static bool fan_keeps_shape(const cwi_settler *s, uint32_t point, bool strict)
{
    for (uint32_t n = s->first[point]; n < s->first[point + 1]; n++)
        if (!keeps_shape(s, s->around[n], strict) && !others_coincide(s, s->around[n], point))
            return false;
    return true;
}

/* --- places ------------------------------------------------------------------------------- */

/* A place near a point. */
typedef struct place {
    uint32_t cell[3];
    double distance_sq;
} place;

static double distance_sq_to(const cwi_settler *s, const cwi_quantization_grid *grid,
                             uint32_t point, const uint32_t cell[3])
{
    double sum = 0;
    for (int a = 0; a < 3; a++) {
        const double d = cwi_grid_decode(grid, cell[a], a) -
                         (double)s->points[3 * (size_t)point + (size_t)a];
        sum += d * d;
    }
    return sum;
}

static void round_point(const cwi_settler *s, const cwi_quantization_grid *grid, uint32_t point,
                        uint32_t cell[3])
{
    for (int a = 0; a < 3; a++)
        cell[a] = cwi_grid_round(grid, s->points[3 * (size_t)point + (size_t)a], a);
}

/* Lists the free places around a point, the nearest first, equal ones in the order of their numbers. */
static int list_places(const cwi_settler *s, const cwi_quantization_grid *grid, uint32_t point,
                       double most_mm, place *list)
{
    const int64_t last = ((int64_t)1 << grid->bits) - 1;
    uint32_t middle[3];
    int count = 0;
    round_point(s, grid, point, middle);
    for (int n = 0; n < PLACES; n++) {
        const int offset[3] = {n % SIDE, n / SIDE % SIDE, n / (SIDE * SIDE)};
        place p;
        bool inside = true;
        for (int a = 0; a < 3; a++) {
            const int64_t at = (int64_t)middle[a] + offset[a] - REACH;
            inside = inside && at >= 0 && at <= last;
            p.cell[a] = (uint32_t)at;
        }
        if (!inside || is_taken(s, p.cell))
            continue;
        p.distance_sq = distance_sq_to(s, grid, point, p.cell);
        if (p.distance_sq > most_mm * most_mm)
            continue;
        int at = count++;
        for (; at > 0 && list[at - 1].distance_sq > p.distance_sq; at--)
            list[at] = list[at - 1];
        list[at] = p;
    }
    return count;
}

/* Finds a free place where the triangles around a point keep their shape. The point is in no cell of the table.
 * Returns false, and leaves its cell as it was, if there is none. */
static bool find_place(cwi_settler *s, const cwi_quantization_grid *grid, uint32_t point,
                       double most_mm)
{
    place list[PLACES];
    uint32_t old[3];
    const int count = list_places(s, grid, point, most_mm, list);
    memcpy(old, s->cell[point], sizeof old);
    for (int strict = 1; strict >= 0; strict--)
        for (int n = 0; n < count; n++) {
            memcpy(s->cell[point], list[n].cell, sizeof *s->cell);
            if (fan_keeps_shape(s, point, strict)) {
                take_cell(s, point, list[n].cell);
                return true;
            }
        }
    memcpy(s->cell[point], old, sizeof old);
    return false;
}

/* Rounds all points, and marks those whose place is taken: their cells are not in the table. */
static size_t round_points(cwi_settler *s, const cwi_quantization_grid *grid, bool *waits)
{
    size_t waiting = 0;
    memset(s->table, 0, s->slots * sizeof *s->table);
    memset(waits, 0, s->count * sizeof *waits);
    for (uint32_t v = 0; v < s->count; v++) {
        if (s->map[v] != v)
            continue;
        round_point(s, grid, v, s->cell[v]);
        waits[v] = is_taken(s, s->cell[v]);
        waiting += waits[v];
        if (!waits[v])
            take_cell(s, v, s->cell[v]);
    }
    return waiting;
}

/* Moves a corner of a triangle that has lost its area. Returns false if none can be. */
static bool raise_triangle(cwi_settler *s, const cwi_quantization_grid *grid, size_t t,
                           double most_mm)
{
    for (size_t k = 0; k < 3; k++) {
        const uint32_t point = s->corners[3 * t + k];
        leave_cell(s, point);
        if (find_place(s, grid, point, most_mm))
            return true;
        take_cell(s, point, s->cell[point]);
    }
    return false;
}

/* Gives triangles that have lost their area one again. Returns the number of those that have not. */
static size_t raise_triangles(cwi_settler *s, const cwi_quantization_grid *grid, double most_mm)
{
    size_t flat = 1;
    for (int pass = 0; pass < PASSES && flat; pass++) {
        flat = 0;
        for (size_t t = 0; t < s->triangles; t++)
            flat += !keeps_shape(s, t, false) && !raise_triangle(s, grid, t, most_mm);
    }
    return flat;
}

bool cwi_settle_points(cwi_settler *s, const cwi_quantization_grid *grid, double most_mm,
                       size_t *moved)
{
    bool *waits = cwi_alloc_array(s->count, sizeof *waits);
    if (!waits)
        return false;
    size_t left = round_points(s, grid, waits);
    for (uint32_t v = 0; v < s->count && left; v++)
        left -= waits[v] && find_place(s, grid, v, most_mm);
    cwi_free(waits);
    if (left || raise_triangles(s, grid, most_mm))
        return false;
    *moved = 0;
    for (uint32_t v = 0; v < s->count; v++) {
        uint32_t cell[3];
        round_point(s, grid, v, cell);
        *moved += s->map[v] == v && memcmp(cell, s->cell[v], sizeof cell) != 0;
    }
    return true;
}

void cwi_settler_move(cwi_settler *s, const cwi_quantization_grid *grid, double *error_mm)
{
    double worst = 0;
    for (uint32_t v = 0; v < s->count; v++) {
        const uint32_t *cell = s->cell[s->map[v]];
        worst = fmax(worst, distance_sq_to(s, grid, v, cell));
    }
    for (uint32_t v = 0; v < s->count; v++) {
        const uint32_t *cell = s->cell[s->map[v]];
        uint32_t rounded[3];
        round_point(s, grid, v, rounded);
        for (int a = 0; a < 3 && memcmp(rounded, cell, sizeof rounded) != 0; a++)
            s->points[3 * (size_t)v + (size_t)a] = (float)cwi_grid_decode(grid, cell[a], a);
    }
    *error_mm = sqrt(worst);
}
