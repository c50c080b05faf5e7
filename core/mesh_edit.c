#include "core/memory.h"
#include "core/status.h"
#include "core/weld.h"

#include <cubewright/mesh.h>

#include <string.h>

/* Moves element v of each array to number[v], if it has one; numbers rise. */
static void move_vertices(cw_mesh *m, const uint32_t *number, size_t count)
{
    for (size_t v = 0; v < m->vertex_count; v++) {
        const size_t to = number[v];
        if (number[v] == UINT32_MAX || to == v)
            continue;
        memcpy(m->positions + 3 * to, m->positions + 3 * v, 3 * sizeof *m->positions);
        if (m->normals)
            memcpy(m->normals + 3 * to, m->normals + 3 * v, 3 * sizeof *m->normals);
        if (m->colors)
            memcpy(m->colors + 4 * to, m->colors + 4 * v, 4 * sizeof *m->colors);
        if (m->scalars)
            m->scalars[to] = m->scalars[v];
        if (m->labels)
            m->labels[to] = m->labels[v];
    }
    m->vertex_count = count;
}

/* Leaves out the vertices that no triangle names; number has room for all. */
static void drop_unused(cw_mesh *m, uint32_t *number)
{
    uint32_t count = 0;
    memset(number, 0xff, m->vertex_count * sizeof *number);
    for (size_t c = 0; c < 3 * m->triangle_count; c++)
        number[m->triangles[c]] = 0;
    for (size_t v = 0; v < m->vertex_count; v++)
        if (number[v] == 0)
            number[v] = count++;
    for (size_t c = 0; c < 3 * m->triangle_count; c++)
        m->triangles[c] = number[m->triangles[c]];
    move_vertices(m, number, count);
}

cw_status cw_mesh_weld(cw_mesh *mesh, size_t *merged, cw_error *err)
{
    cw_status st = cw_mesh_check(mesh, err);
    if (st != CW_OK)
        return st;
    uint32_t *map = cwi_alloc_array(mesh->vertex_count, sizeof *map);
    if (!map || !cwi_weld(mesh->positions, mesh->vertex_count, map)) {
        cwi_free(map);
        return cw_fail(err, CW_ERR_NO_MEMORY, "no memory to weld %zu vertices",
                       mesh->vertex_count);
    }
    size_t count = 0, kept = 0;
    for (size_t v = 0; v < mesh->vertex_count; v++)
        count += map[v] != v;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *from = mesh->triangles + 3 * t;
        const uint32_t c[3] = {map[from[0]], map[from[1]], map[from[2]]};
        if (c[0] != c[1] && c[1] != c[2] && c[2] != c[0])
            memcpy(mesh->triangles + 3 * kept++, c, sizeof c);
    }
    mesh->triangle_count = kept;
    drop_unused(mesh, map);
    cwi_free(map);
    if (merged)
        *merged = count;
    return CW_OK;
}
