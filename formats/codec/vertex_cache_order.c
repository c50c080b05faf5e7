/* Reorders triangles and vertices of a mesh for the vertex cache, by meshoptimizer. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/mesh_attributes.h"
#include "formats/codec/meshopt_wrap.h"

#include <cubewright/formats.h>

#include <stdlib.h>
#include <string.h>

/* A triangle with its number, to find it again in another order. */
typedef struct numbered {
    uint32_t corners[3], number;
} numbered;

static int compare_numbered(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(numbered));
}

/* Lists triangles, whose vertices may get other numbers, and sorts them. */
static void list_triangles(const uint32_t *triangles, size_t count, const uint32_t *remap,
                           numbered *list)
{
    for (uint32_t t = 0; t < count; t++) {
        for (size_t k = 0; k < 3; k++) {
            const uint32_t v = triangles[3 * (size_t)t + k];
            list[t].corners[k] = remap ? remap[v] : v;
        }
        list[t].number = t;
    }
    qsort(list, count, sizeof *list, compare_numbered);
}

/* Gives elements of a size new numbers. copy: room for all */
static void permute_array(void *data, const uint32_t *number, size_t count, size_t size,
                          char *copy)
{
    memcpy(copy, data, count * size);
    for (size_t n = 0; n < count; n++)
        memcpy((char *)data + number[n] * size, copy + n * size, size);
}

/* Gives positions and attributes the numbers of vertices and triangles. */
static void permute_rows(const cw_mesh *mesh, const uint32_t *vertices,
                         const uint32_t *triangles, char *copy)
{
    permute_array(mesh->positions, vertices, mesh->vertex_count, 3 * sizeof *mesh->positions,
                  copy);
    for (size_t n = 0; n < cwi_attribute_count(mesh); n++) {
        const cw_attribute row = cwi_attribute_at(mesh, n);
        const size_t size = cwi_attribute_bytes(&row);
        if (row.data && row.on == CW_ON_VERTICES)
            permute_array(row.data, vertices, mesh->vertex_count, size, copy);
        else if (row.on == CW_ON_TRIANGLES || row.on == CW_ON_CORNERS)
            permute_array(row.data, triangles, mesh->triangle_count,
                          row.on == CW_ON_CORNERS ? 3 * size : size, copy);
    }
}

/* Returns the bytes of the largest array. */
static size_t find_largest(const cw_mesh *mesh)
{
    size_t largest = 3 * sizeof *mesh->positions * mesh->vertex_count;
    for (size_t n = 0; n < cwi_attribute_count(mesh); n++) {
        const cw_attribute row = cwi_attribute_at(mesh, n);
        const size_t bytes =
            row.data ? cwi_attribute_elements(mesh, row.on) * cwi_attribute_bytes(&row) : 0;
        largest = bytes > largest ? bytes : largest;
    }
    return largest;
}

cw_status cwi_mesh_reorder(cw_mesh *mesh, const cwi_meshopt_functions *meshopt, bool draw,
                           cw_error *err)
{
    const size_t count = mesh->vertex_count;
    const bool by_triangle =
        cwi_attributes_any(mesh, 1u << CW_ON_TRIANGLES | 1u << CW_ON_CORNERS);
    const size_t listed = by_triangle ? mesh->triangle_count : 0;
    uint32_t *remap = cwi_alloc_array(count, sizeof *remap);
    char *copy = cwi_alloc_array(find_largest(mesh), 1);
    uint32_t *before = cwi_alloc_array(listed, 3 * sizeof *before);
    uint32_t *order = cwi_alloc_array(listed, sizeof *order);
    numbered *lists[2] = {cwi_alloc_array(listed, sizeof *lists[0]),
                          cwi_alloc_array(listed, sizeof *lists[1])};
    const bool ok = remap && copy && before && order && lists[0] && lists[1];
    if (ok && listed)
        memcpy(before, mesh->triangles, 3 * listed * sizeof *before);
    cw_status st = ok ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK)
        st = meshopt->reorder(mesh->triangles, mesh->triangle_count, count, draw, remap, err);
    if (st == CW_OK) {
        list_triangles(before, listed, remap, lists[0]);
        list_triangles(mesh->triangles, listed, NULL, lists[1]);
        for (size_t n = 0; n < listed; n++)
            order[lists[0][n].number] = lists[1][n].number;
        permute_rows(mesh, remap, order, copy);
    }
    cwi_free(remap);
    cwi_free(copy);
    cwi_free(before);
    cwi_free(order);
    cwi_free(lists[0]);
    cwi_free(lists[1]);
    return st;
}

cw_status cw_mesh_optimize(cw_mesh *mesh, cw_error *err)
{
    CWI_REQUIRE(err, mesh);
    const cwi_meshopt_functions *meshopt;
    cw_status st = cw_mesh_check(mesh, err);
    if (st == CW_OK)
        st = cwi_meshopt_functions_load(&meshopt, err);
    return st == CW_OK ? cwi_mesh_reorder(mesh, meshopt, true, err) : st;
}
