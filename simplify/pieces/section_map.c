/* Makes the grid of a section: its triangles are joined to regions, drawn into cells, and their border listed. */
#include "simplify/pieces/section_map.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/union_find.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh_triangle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A directed edge of a triangle of the section. */
typedef struct section_edge {
    uint32_t low, high; /* vertices */
    uint32_t triangle;
    bool falls; /* runs from the higher one */
} section_edge;

typedef struct section_parts {
    const cw_mesh *mesh;
    uint32_t *triangles; /* of the mesh, that are in the section */
    size_t count;
    uint32_t *sets; /* of them, by region */
    section_edge *edges;
} section_parts;

static bool list_triangles(section_parts *s, uint32_t number)
{
    const uint32_t *numbers = cwi_section_numbers(s->mesh);
    for (int pass = 0; pass < 2; pass++) {
        s->count = 0;
        for (size_t t = 0; t < s->mesh->triangle_count && numbers; t++)
            if (numbers[t] == number) {
                if (pass)
                    s->triangles[s->count] = (uint32_t)t;
                s->count++;
            }
        if (!pass)
            s->triangles = cwi_alloc_array(s->count, sizeof *s->triangles);
        if (!s->triangles)
            return false;
    }
    s->sets = cwi_sets_alloc(s->count);
    s->edges = cwi_alloc_array(3 * s->count, sizeof *s->edges);
    return s->sets && s->edges;
}

static int compare_edges(const void *x, const void *y)
{
    const section_edge *a = x, *b = y;
    if (a->low != b->low)
        return a->low < b->low ? -1 : 1;
    if (a->high != b->high)
        return a->high < b->high ? -1 : 1;
    if (a->falls != b->falls)
        return a->falls ? 1 : -1;
    return a->triangle < b->triangle ? -1 : a->triangle > b->triangle;
}

/* Joins triangles at common edges, and keeps the other edges at the front. Returns how many these are. */
static size_t join_triangles(section_parts *s)
{
    size_t left = 0;
    for (size_t n = 0; n < s->count; n++)
        for (int k = 0; k < 3; k++) {
            const uint32_t *v = s->mesh->triangles + 3 * (size_t)s->triangles[n];
            const uint32_t a = v[k], b = v[(k + 1) % 3];
            s->edges[3 * n + (size_t)k] =
                (section_edge){a < b ? a : b, a < b ? b : a, (uint32_t)n, a > b};
        }
    if (s->count)
        qsort(s->edges, 3 * s->count, sizeof *s->edges, compare_edges);
    for (size_t n = 0; n < 3 * s->count; n++) {
        const section_edge *e = &s->edges[n];
        if (n + 1 < 3 * s->count && e[1].low == e->low && e[1].high == e->high &&
            e[1].falls != e->falls) {
            cwi_sets_join(s->sets, e->triangle, e[1].triangle);
            n++;
        } else
            s->edges[left++] = *e;
    }
    return left;
}

static void corner_at(const cwi_section_map *map, const cw_mesh *mesh, uint32_t vertex,
                      double p[3])
{
    cwi_plane_local(map->plane, mesh->positions + 3 * (size_t)vertex, p);
}

/* Lists the border by region, and numbers the regions from 1 in the order of their first triangles.
 * numbers  of triangles, by the root of their set */
static bool list_border(const section_parts *s, size_t edges, cwi_section_map *map,
                        uint32_t *numbers)
{
    for (size_t n = 0; n < s->count; n++) {
        const uint32_t root = cwi_sets_find(s->sets, (uint32_t)n);
        numbers[n] = root == n ? (uint32_t)++map->region_count : numbers[root];
    }
    map->border = cwi_alloc_array(edges, sizeof *map->border);
    map->border_start = cwi_alloc_zeroed(map->region_count + 2, sizeof *map->border_start);
    if (!map->border || !map->border_start)
        return false;
    for (size_t n = 0; n < edges; n++)
        map->border_start[numbers[s->edges[n].triangle] + 1]++;
    for (size_t r = 0; r <= map->region_count; r++)
        map->border_start[r + 1] += map->border_start[r];
    for (size_t n = 0; n < edges; n++) {
        double p[3], q[3];
        double *row = map->border[map->border_start[numbers[s->edges[n].triangle]]++];
        corner_at(map, s->mesh, s->edges[n].low, p);
        corner_at(map, s->mesh, s->edges[n].high, q);
        memcpy(row, p, 2 * sizeof *p);
        memcpy(row + 2, q, 2 * sizeof *q);
    }
    for (size_t r = map->region_count + 1; r > 0; r--)
        map->border_start[r] = map->border_start[r - 1];
    return true;
}

/* Marks the cells whose middles are in a triangle. */
static void draw_triangle(cwi_section_map *map, double p[3][3], uint32_t region)
{
    double low = INFINITY, high = -INFINITY;
    for (int k = 0; k < 3; k++) {
        low = cwi_lesser(low, p[k][1]);
        high = cwi_greater(high, p[k][1]);
    }
    const double first = floor((low - map->corner[1]) / map->cell - 0.5);
    for (size_t y = first > 0 ? (size_t)first : 0; y < map->ny; y++) {
        const double at = map->corner[1] + map->cell * ((double)y + 0.5);
        double from = INFINITY, to = -INFINITY;
        if (at > high)
            break;
        for (int k = 0; k < 3; k++) {
            const double *a = p[k], *b = p[(k + 1) % 3];
            if ((a[1] <= at) == (b[1] <= at))
                continue;
            const double x = a[0] + (b[0] - a[0]) * (at - a[1]) / (b[1] - a[1]);
            from = cwi_lesser(from, x);
            to = cwi_greater(to, x);
        }
        const double start = ceil((from - map->corner[0]) / map->cell - 0.5);
        for (size_t x = start > 0 && isfinite(start) ? (size_t)start : 0; x < map->nx; x++) {
            const double middle = map->corner[0] + map->cell * ((double)x + 0.5);
            if (middle > to)
                break;
            if (middle >= from)
                map->region[y * map->nx + x] = region;
        }
    }
}

static bool draw_section(const section_parts *s, cwi_section_map *map, const uint32_t *numbers)
{
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, p[3][3];
    for (size_t n = 0; n < 3 * s->count; n++) {
        corner_at(map, s->mesh, s->mesh->triangles[3 * (size_t)s->triangles[n / 3] + n % 3],
                  p[0]);
        for (int a = 0; a < 2; a++) {
            low[a] = cwi_lesser(low[a], p[0][a]);
            high[a] = cwi_greater(high[a], p[0][a]);
        }
    }
    map->cell = cwi_greater(high[0] - low[0], high[1] - low[1]) / CWI_SECTION_CELLS;
    map->nx =
        (size_t)ceil((high[0] - low[0]) / map->cell) + 2; /* a cell outside on each side */
    map->ny = (size_t)ceil((high[1] - low[1]) / map->cell) + 2;
    for (int a = 0; a < 2; a++)
        map->corner[a] = low[a] - map->cell;
    map->region = cwi_alloc_zeroed(map->nx * map->ny, sizeof *map->region);
    for (size_t n = 0; n < s->count && map->region; n++) {
        for (size_t k = 0; k < 3; k++)
            corner_at(map, s->mesh, s->mesh->triangles[3 * (size_t)s->triangles[n] + k], p[k]);
        draw_triangle(map, p, numbers[n]);
    }
    return map->region;
}

cw_status cwi_section_map_make(const cwi_cutter *c, const cw_piece_section *section,
                               cwi_section_map *map, cw_error *err)
{
    section_parts s = {.mesh = &c->out->pieces[section->below].mesh};
    *map = (cwi_section_map){.plane = &c->planes[section->plane]};
    bool is_made = list_triangles(&s, (uint32_t)section->plane + 1);
    uint32_t *numbers = is_made ? cwi_alloc_array(s.count, sizeof *numbers) : NULL;
    is_made = numbers && list_border(&s, join_triangles(&s), map, numbers) &&
              draw_section(&s, map, numbers);
    cwi_free(s.triangles);
    cwi_free(s.sets);
    cwi_free(s.edges);
    cwi_free(numbers);
    return is_made ? CW_OK : cwi_fail_memory(err);
}

void cwi_section_map_free(cwi_section_map *map)
{
    cwi_free(map->region);
    cwi_free(map->border);
    cwi_free(map->border_start);
    cwi_free(map->near[0]);
    cwi_free(map->near[1]);
    cwi_free(map->distance_sq);
    *map = (cwi_section_map){0};
}

/* --- the surfaces below and above ---------------------------------------------------------- */

static bool add_side(const cw_mesh *mesh, uint32_t number, double depth, int side,
                     cwi_section_map *map)
{
    const uint32_t *numbers = cwi_section_numbers(mesh);
    const double width = map->cell * (double)map->nx, height = map->cell * (double)map->ny;
    size_t capacity = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        cwi_near_triangle n = {.low = INFINITY};
        double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
        if (numbers && numbers[t] == number)
            continue;
        for (size_t k = 0; k < 3; k++) {
            corner_at(map, mesh, mesh->triangles[3 * t + k], n.p[k]);
            n.p[k][2] = fabs(n.p[k][2]);
            n.low = cwi_lesser(n.low, n.p[k][2]);
            for (int a = 0; a < 2; a++) {
                low[a] = cwi_lesser(low[a], n.p[k][a]);
                high[a] = cwi_greater(high[a], n.p[k][a]);
            }
        }
        if (n.low > depth || high[0] < map->corner[0] || high[1] < map->corner[1] ||
            low[0] > map->corner[0] + width || low[1] > map->corner[1] + height)
            continue;
        cwi_near_triangle *grown =
            cwi_grow_array(map->near[side], map->near_count[side], &capacity, sizeof n);
        if (!grown)
            return false;
        map->near[side] = grown;
        grown[map->near_count[side]++] = n;
    }
    return true;
}

cw_status cwi_section_map_add_surfaces(const cwi_cutter *c, const cw_piece_section *section,
                                       const double depth[2], cwi_section_map *map,
                                       cw_error *err)
{
    const uint32_t number = (uint32_t)section->plane + 1;
    const cw_piece *pieces = c->out->pieces;
    return add_side(&pieces[section->below].mesh, number, depth[0], 0, map) &&
                   add_side(&pieces[section->above].mesh, number, depth[1], 1, map)
               ? CW_OK
               : cwi_fail_memory(err);
}
