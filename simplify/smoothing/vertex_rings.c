/* Finds the neighbours of each vertex, and rims, by a counting sort of the sides of triangles. */
#include "simplify/smoothing/vertex_rings.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/triangle.h"

#include <stdlib.h>

/* Longer lists are sorted by qsort(), to keep hostile meshes from quadratic time. */
enum { SHORT_LIST = 64 };

/* Counts the sides at each vertex, two for each triangle, and places the lists one after the
 * other. */
static void place_lists(const cw_mesh *mesh, cwi_rings *r)
{
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *corners = mesh->triangles + 3 * t;
        for (int c = 0; c < 3 && !cwi_triangle_is_collapsed(corners); c++)
            r->begin[corners[c] + (size_t)1] += 2;
    }
    for (size_t v = 0; v < r->vertices; v++)
        r->begin[v + 1] += r->begin[v];
}

static void fill_lists(const cw_mesh *mesh, cwi_rings *r)
{
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *corners = mesh->triangles + 3 * t;
        for (int c = 0; c < 3 && !cwi_triangle_is_collapsed(corners); c++) {
            const uint32_t v = corners[c];
            uint32_t *list = r->neighbours + r->begin[v] + r->count[v];
            list[0] = corners[(c + 1) % 3];
            list[1] = corners[(c + 2) % 3];
            r->count[v] += 2;
        }
    }
}

static int compare_vertices(const void *a, const void *b)
{
    const uint32_t v = *(const uint32_t *)a, w = *(const uint32_t *)b;
    return v < w ? -1 : v > w;
}

static void sort_list(uint32_t *list, uint32_t count)
{
    if (count > SHORT_LIST) {
        qsort(list, count, sizeof *list, compare_vertices);
        return;
    }
    for (uint32_t i = 1; i < count; i++) {
        const uint32_t vertex = list[i];
        uint32_t n = i;
        for (; n > 0 && list[n - 1] > vertex; n--)
            list[n] = list[n - 1];
        list[n] = vertex;
    }
}

/* Returns how many entries from i on name the same neighbour: the triangles at the edge to it. */
static uint32_t count_same(const uint32_t *list, uint32_t count, uint32_t i)
{
    uint32_t same = 1;
    while (i + same < count && list[i + same] == list[i])
        same++;
    return same;
}

/* Keeps one of each neighbour, or only those at a rim. */
static uint32_t shorten_list(uint32_t *list, uint32_t count, bool of_border)
{
    uint32_t kept = 0;
    for (uint32_t i = 0, same; i < count; i += same) {
        same = count_same(list, count, i);
        if (!of_border || same != 2)
            list[kept++] = list[i];
    }
    return kept;
}

static cwi_vertex_border find_border(const uint32_t *list, uint32_t count)
{
    cwi_vertex_border border = CWI_BORDER_NONE;
    for (uint32_t i = 0, same; i < count && border != CWI_BORDER_OPEN; i += same) {
        same = count_same(list, count, i);
        border = same == 1 ? CWI_BORDER_OPEN : same > 2 ? CWI_BORDER_JUNCTION : border;
    }
    return border;
}

static void finish_part(void *context, size_t k)
{
    const cwi_rings *r = context;
    for (size_t v = k * CWI_RING_PART; v < (k + 1) * CWI_RING_PART && v < r->vertices; v++) {
        uint32_t *list = r->neighbours + r->begin[v];
        sort_list(list, r->count[v]);
        r->border[v] = (uint8_t)find_border(list, r->count[v]);
        r->count[v] = shorten_list(list, r->count[v], r->border[v] != CWI_BORDER_NONE);
    }
}

cw_status cwi_rings_find(const cw_mesh *mesh, int threads, const cw_progress *progress,
                         cwi_rings *rings, cw_error *err)
{
    const size_t count = mesh->vertex_count;
    *rings = (cwi_rings){.vertices = count};
    rings->begin = cwi_alloc_zeroed(count + 1, sizeof *rings->begin);
    rings->count = cwi_alloc_zeroed(count, sizeof *rings->count);
    rings->border = cwi_alloc_zeroed(count, sizeof *rings->border);
    if (rings->begin && rings->count && rings->border) {
        place_lists(mesh, rings);
        rings->neighbours = cwi_alloc_large(rings->begin[count], sizeof *rings->neighbours);
    }
    if (!rings->neighbours)
        return cwi_fail_memory(err);
    fill_lists(mesh, rings);
    return cwi_parallel_for((count + CWI_RING_PART - 1) / CWI_RING_PART, 8 * CWI_RING_PART,
                            threads, progress, "smoothing", finish_part, rings, err);
}

void cwi_rings_free(cwi_rings *rings)
{
    cwi_free(rings->begin);
    cwi_free(rings->count);
    cwi_free(rings->neighbours);
    cwi_free(rings->border);
    *rings = (cwi_rings){0};
}
