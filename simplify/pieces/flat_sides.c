/* Finds flat sides of a piece: triangles of about the same plane, on one side of which is all of the piece. */
#include "simplify/pieces/flat_sides.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/box.h"
#include "core/mesh/mesh_triangle.h"
#include "simplify/pieces/pieces_state.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Normals of one side are alike to this, and nothing is beyond it by more than this fraction of the diagonal. */
static const double NORMAL_STEP = 2e-3, BEYOND = 2e-5;

/* Sides that are tried, of each kind. */
enum { MAX_TRIED = 64 };

/* A triangle by the plane that it is in: a section's number, or its normal rounded to steps. */
typedef struct side_triangle {
    int32_t key
        [4]; /* the number of the section, or 0 and the normal; and the distance from the origin */
    uint32_t triangle;
} side_triangle;

/* A side whose triangles are known. */
typedef struct side_sum {
    double vector[3], area, at;
    bool is_section;
} side_sum;

static int compare_triangles(const void *x, const void *y)
{
    const side_triangle *a = x, *b = y;
    for (int k = 0; k < 4; k++)
        if (a->key[k] != b->key[k])
            return a->key[k] < b->key[k] ? -1 : 1;
    return a->triangle < b->triangle ? -1 : a->triangle > b->triangle;
}

static int compare_sums(const void *x, const void *y)
{
    const side_sum *a = x, *b = y;
    if (a->is_section != b->is_section)
        return a->is_section ? -1 : 1;
    if (a->area != b->area)
        return a->area > b->area ? -1 : 1;
    return memcmp(a->vector, b->vector, sizeof a->vector);
}

/* Lists triangles with an area by their planes. Those whose plane has something beyond it by far are left out. */
static size_t list_triangles(const cw_mesh *m, side_triangle *list)
{
    const uint32_t *number = cwi_section_numbers(m);
    size_t count = 0;
    for (size_t t = 0; t < m->triangle_count; t++) {
        double n[3];
        side_triangle *row = &list[count];
        cwi_mesh_normal(m, t, n);
        if (!cwi_normalise(n))
            continue;
        *row = (side_triangle){.triangle = (uint32_t)t};
        if (number && number[t])
            row->key[0] = (int32_t)number[t];
        else
            for (int k = 0; k < 3; k++)
                row->key[k + 1] = (int32_t)lround(n[k] / NORMAL_STEP);
        count++;
    }
    return count;
}

/* Returns the position of the farthest vertex along a direction. */
static double find_extreme(const cw_mesh *m, const double direction[3])
{
    double farthest = -INFINITY;
    for (size_t v = 0; v < m->vertex_count; v++) {
        const float *p = m->positions + 3 * v;
        farthest =
            cwi_greater(farthest, direction[0] * (double)p[0] + direction[1] * (double)p[1] +
                                      direction[2] * (double)p[2]);
    }
    return farthest;
}

/* Keeps of a side's triangles those in the outermost plane, and sums them up. slack: of that plane */
static side_sum sum_side(const cw_mesh *m, const side_triangle *list, size_t count,
                         double slack)
{
    side_sum s = {.is_section = list->key[0] != 0};
    double n[3], direction[3] = {0};
    for (size_t k = 0; k < count; k++) {
        cwi_mesh_normal(m, list[k].triangle, n);
        cwi_add_scaled(direction, 1, n, direction);
    }
    if (!cwi_normalise(direction))
        return s;
    const double at = find_extreme(m, direction);
    for (size_t k = 0; k < count; k++) {
        bool is_out = false;
        for (size_t c = 0; c < 3; c++) {
            double p[3];
            cwi_mesh_corner(m, list[k].triangle, c, p);
            is_out = is_out || cwi_dot(direction, p) < at - slack;
        }
        if (!is_out)
            s.area += cwi_mesh_area(m, list[k].triangle);
    }
    memcpy(s.vector, direction, sizeof direction);
    return s;
}

/* Groups of triangles with one key, by area; only the largest are tried. */
typedef struct side_group {
    size_t first, count;
    double area;
    bool is_section;
} side_group;

static int compare_groups(const void *x, const void *y)
{
    const side_group *a = x, *b = y;
    if (a->is_section != b->is_section)
        return a->is_section ? -1 : 1;
    if (a->area != b->area)
        return a->area > b->area ? -1 : 1;
    return a->first < b->first ? -1 : a->first > b->first;
}

static size_t group_triangles(const cw_mesh *m, const side_triangle *list, size_t count,
                              side_group *groups)
{
    size_t n = 0;
    for (size_t k = 0; k < count; k++) {
        if (k == 0 || memcmp(list[k].key, list[k - 1].key, sizeof list->key) != 0)
            groups[n++] = (side_group){.first = k, .is_section = list[k].key[0] != 0};
        groups[n - 1].count++;
        groups[n - 1].area += cwi_mesh_area(m, list[k].triangle);
    }
    if (n)
        qsort(groups, n, sizeof *groups, compare_groups);
    return n;
}

cw_status cwi_find_flat_sides(const cw_mesh *mesh, cwi_flat_side sides[CWI_MAX_SIDES],
                              size_t *count, cw_error *err)
{
    double low[3], high[3];
    side_sum sums[2 * MAX_TRIED];
    size_t found = 0, tried[2] = {0, 0};
    side_triangle *list = cwi_alloc_array(mesh->triangle_count, sizeof *list);
    side_group *groups = cwi_alloc_array(mesh->triangle_count, sizeof *groups);
    cw_mesh_bounds(mesh, low, high);
    const double slack = BEYOND * cwi_box_diagonal(low, high);
    *count = 0;
    const size_t triangles = list && groups ? list_triangles(mesh, list) : 0;
    if (triangles)
        qsort(list, triangles, sizeof *list, compare_triangles);
    const size_t all = triangles ? group_triangles(mesh, list, triangles, groups) : 0;
    for (size_t n = 0; n < all; n++) {
        const side_group *g = &groups[n];
        if (tried[g->is_section]++ >= MAX_TRIED)
            continue;
        const side_sum s = sum_side(mesh, list + g->first, g->count, slack);
        if (s.area > 0)
            sums[found++] = s;
    }
    if (found)
        qsort(sums, found, sizeof *sums, compare_sums);
    for (size_t n = 0; n < found && *count < CWI_MAX_SIDES; n++) {
        cwi_flat_side *side = &sides[(*count)++];
        memcpy(side->normal, sums[n].vector, sizeof side->normal);
        side->area_mm2 = sums[n].area;
        side->is_section = sums[n].is_section;
    }
    const bool is_done = list && groups;
    cwi_free(list);
    cwi_free(groups);
    return is_done ? CW_OK : cwi_fail_memory(err);
}
