/* Vertices by the cells of a grid, to find the closest one within a radius. */
#include "simplify/boolean/snapping.h"

#include "core/base/memory.h"
#include "core/geometry/vec3.h"

#include <math.h>

bool cwi_anchors_init(cwi_anchors *a, const cwi_soup *soup, double radius)
{
    size_t capacity = 64;
    while (capacity < 2 * soup->vertex_count)
        capacity *= 2;
    *a = (cwi_anchors){.soup = soup, .radius = radius, .mask = capacity - 1};
    a->capacity = soup->vertex_count;
    a->heads = cwi_alloc_zeroed(capacity, sizeof *a->heads);
    a->next = cwi_alloc_array(a->capacity, sizeof *a->next);
    return a->heads && a->next;
}

void cwi_anchors_free(cwi_anchors *a)
{
    cwi_free(a->heads);
    cwi_free(a->next);
    *a = (cwi_anchors){0};
}

static size_t find_list(const cwi_anchors *a, const int64_t cell[3])
{
    return cwi_hash_cell(cell) & a->mask;
}

static void find_cell(const cwi_anchors *a, const double x[3], int64_t cell[3])
{
    for (int k = 0; k < 3; k++)
        cell[k] = (int64_t)floor(x[k] / a->radius);
}

bool cwi_anchors_add(cwi_anchors *a, uint32_t v)
{
    int64_t cell[3];
    if (v >= a->capacity) {
        uint32_t *next = cwi_grow_array(a->next, v, &a->capacity, sizeof *next);
        if (!next)
            return false;
        a->next = next;
    }
    find_cell(a, a->soup->vertices[v], cell);
    const size_t list = find_list(a, cell);
    a->next[v] = a->heads[list];
    a->heads[list] = v + 1;
    return true;
}

uint32_t cwi_anchors_find(const cwi_anchors *a, const double x[3])
{
    double closest_sq = a->radius * a->radius;
    uint32_t closest = CWI_NOTHING;
    int64_t own[3];
    find_cell(a, x, own);
    for (int n = 0; n < 27; n++) {
        const int64_t cell[3] = {own[0] + n % 3 - 1, own[1] + n / 3 % 3 - 1,
                                 own[2] + n / 9 - 1};
        for (uint32_t u = a->heads[find_list(a, cell)]; u; u = a->next[u - 1]) {
            const double distance_sq = cwi_distance_sq(a->soup->vertices[u - 1], x);
            if (distance_sq < closest_sq || (distance_sq == closest_sq && u - 1 < closest)) {
                closest_sq = distance_sq;
                closest = u - 1;
            }
        }
    }
    return closest;
}
