#include "core/memory.h"
#include "core/sets.h"
#include "core/status.h"
#include "core/weld.h"

#include <cubewright/mesh.h>

#include <math.h>
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

/* --- components -------------------------------------------------------------------------- */

/* Sets of vertices that triangles join, each with its box: at the place of its least vertex. */
typedef struct components {
    uint32_t *sets;
    float (*boxes)[6]; /* low, high */
    bool *met;
} components;

static cw_status find_components(const cw_mesh *m, components *c, cw_error *err)
{
    c->sets = cwi_sets_alloc(m->vertex_count);
    c->boxes = cwi_alloc_array(m->vertex_count, sizeof *c->boxes);
    c->met = cwi_alloc_zeroed(m->vertex_count, sizeof *c->met);
    if (!c->sets || !c->boxes || !c->met)
        return cw_fail(err, CW_ERR_NO_MEMORY, "no memory for the components of %zu vertices",
                       m->vertex_count);
    for (size_t t = 0; t < m->triangle_count; t++)
        for (size_t k = 1; k < 3; k++)
            cwi_sets_join(c->sets, m->triangles[3 * t], m->triangles[3 * t + k]);
    for (size_t v = 0; v < m->vertex_count; v++) {
        const uint32_t set = cwi_sets_find(c->sets, (uint32_t)v);
        float *box = c->boxes[set];
        for (size_t a = 0; a < 3; a++) {
            const float p = m->positions[3 * v + a];
            box[a] = v == set || p < box[a] ? p : box[a]; /* the least vertex comes first */
            box[3 + a] = v == set || p > box[3 + a] ? p : box[3 + a];
        }
    }
    return CW_OK;
}

static double diagonal_of(const float box[6])
{
    double square = 0;
    for (int a = 0; a < 3; a++) {
        const double side = (double)box[3 + a] - (double)box[a];
        square += side * side;
    }
    return sqrt(square);
}

cw_status cw_mesh_drop_components(cw_mesh *mesh, double diagonal_mm, size_t *dropped,
                                  size_t *kept, cw_error *err)
{
    components c = {0};
    size_t triangles = 0, count[2] = {0, 0}; /* dropped, kept */
    cw_status st = cw_mesh_check(mesh, err);
    if (st == CW_OK && !(diagonal_mm >= 0))
        st = cw_fail(err, CW_ERR_ARGUMENT, "diagonal_mm is %g; it must be 0 or more",
                     diagonal_mm);
    if (st == CW_OK)
        st = find_components(mesh, &c, err);
    for (size_t t = 0; t < mesh->triangle_count && st == CW_OK; t++) {
        const uint32_t *corners = mesh->triangles + 3 * t;
        const uint32_t set = cwi_sets_find(c.sets, corners[0]);
        const bool keep = diagonal_of(c.boxes[set]) >= diagonal_mm;
        count[keep] += !c.met[set];
        c.met[set] = true;
        if (keep)
            memmove(mesh->triangles + 3 * triangles++, corners, 3 * sizeof *corners);
    }
    if (st == CW_OK) {
        mesh->triangle_count = triangles;
        drop_unused(mesh, c.sets);
        if (dropped)
            *dropped = count[0];
        if (kept)
            *kept = count[1];
    }
    cwi_free(c.sets);
    cwi_free(c.boxes);
    cwi_free(c.met);
    return st;
}
