/* Normals of corners, which part at creases. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/mesh/corner_table.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_triangle.h"

#include <cubewright/mesh.h>

#include <math.h>
#include <string.h>

/* Corners at one vertex with no crease between them are a group: groups are trees, whose root is their first
 * corner. */
typedef struct grouping {
    const cw_mesh *mesh;
    const uint8_t *regions;
    double least_cosine; /* of the angle between triangles with no crease between them */
    uint32_t *parent;    /* corners */
    size_t creases;      /* edges */
} grouping;

static uint32_t find_root(uint32_t *parent, uint32_t c)
{
    while (parent[c] != c) {
        parent[c] = parent[parent[c]];
        c = parent[c];
    }
    return c;
}

static void join_groups(uint32_t *parent, uint32_t a, uint32_t b)
{
    a = find_root(parent, a);
    b = find_root(parent, b);
    if (a < b)
        parent[b] = a;
    else
        parent[a] = b;
}

/* Returns the corner of a triangle at a vertex that it names. */
static uint32_t corner_at(const cw_mesh *m, uint32_t corner, uint32_t vertex)
{
    uint32_t c = corner / 3 * 3;
    while (m->triangles[c] != vertex)
        c++;
    return c;
}

/* A triangle without area has no direction that could make a crease. */
static bool is_crease(const grouping *g, uint32_t s, uint32_t t)
{
    double m[3], n[3];
    if (g->regions && g->regions[s] != g->regions[t])
        return true;
    cwi_mesh_normal(g->mesh, s, m);
    cwi_mesh_normal(g->mesh, t, n);
    return cwi_normalise(m) && cwi_normalise(n) && cwi_dot(m, n) < g->least_cosine;
}

/* Joins the corners at both ends of an edge of two triangles. */
static void cross_edge(grouping *g, uint32_t a, uint32_t b)
{
    const uint32_t *corners = g->mesh->triangles;
    const uint32_t ends[2] = {corners[a], corners[a / 3 * 3 + (a + 1) % 3]};
    if (is_crease(g, a / 3, b / 3)) {
        g->creases++;
        return;
    }
    for (int e = 0; e < 2; e++)
        join_groups(g->parent, corner_at(g->mesh, a, ends[e]), corner_at(g->mesh, b, ends[e]));
}

static bool group_corners(grouping *g)
{
    const size_t count = 3 * g->mesh->triangle_count;
    cwi_side *sides = cwi_alloc_array(count, sizeof *sides);
    g->parent = cwi_alloc_array(count, sizeof *g->parent);
    if (!sides || !g->parent) {
        cwi_free(sides);
        return false;
    }
    for (uint32_t c = 0; c < count; c++)
        g->parent[c] = c;
    cwi_sides_list(g->mesh->triangles, count, sides);
    for (size_t s = 0, n; s < count; s += n) {
        n = cwi_sides_along(sides, count, s);
        for (size_t k = 1; k < n; k++)
            cross_edge(g, sides[s].corner, sides[s + k].corner);
    }
    cwi_free(sides);
    return true;
}

/* Adds up the normals of triangles for each group, by the root. */
static double (*sum_groups(grouping *g))[3]
{
    const cw_mesh *m = g->mesh;
    double(*sums)[3] = cwi_alloc_zeroed(3 * m->triangle_count, sizeof *sums);
    for (uint32_t t = 0; sums && t < m->triangle_count; t++) {
        uint32_t at[3];
        for (uint32_t c = 0; c < 3; c++)
            at[c] = find_root(g->parent, 3 * t + c);
        cwi_add_corner_normals(m, t, at, sums);
    }
    return sums;
}

/* Finds the vertices that have more than one group. */
static uint8_t *find_parted(grouping *g)
{
    const cw_mesh *m = g->mesh;
    uint8_t *parted = cwi_alloc_zeroed(m->vertex_count, 1);
    uint32_t *root = cwi_alloc_array(m->vertex_count, sizeof *root);
    if (parted && root) {
        memset(root, 0xff, m->vertex_count * sizeof *root);
        for (uint32_t c = 0; c < 3 * m->triangle_count; c++) {
            const uint32_t r = find_root(g->parent, c), v = m->triangles[c];
            parted[v] = parted[v] || (root[v] != UINT32_MAX && root[v] != r);
            root[v] = r;
        }
    } else {
        cwi_free(parted);
        parted = NULL;
    }
    cwi_free(root);
    return parted;
}

/* Corners of vertices with one group keep the normal of the vertex, and so do those whose triangles cancel out. */
static void set_normals(grouping *g, const uint8_t *parted, double (*sums)[3], float *normals)
{
    const cw_mesh *m = g->mesh;
    for (uint32_t c = 0; c < 3 * m->triangle_count; c++) {
        const uint32_t v = m->triangles[c];
        double n[3];
        memcpy(n, sums[find_root(g->parent, c)], sizeof n);
        const bool is_own = parted[v] && cwi_normalise(n);
        for (size_t a = 0; a < 3; a++)
            normals[3 * (size_t)c + a] = is_own ? (float)n[a] : m->normals[3 * (size_t)v + a];
    }
}

static cw_status add_normals(cw_mesh *mesh, grouping *g, cw_error *err)
{
    const cw_attribute like = {.name = CW_CORNER_NORMALS,
                               .on = CW_ON_CORNERS,
                               .type = CW_F32,
                               .components = 3,
                               .interpolation = CW_INTERPOLATE_DIRECTION};
    cw_attribute *added = NULL;
    uint8_t *parted = find_parted(g);
    double(*sums)[3] = sum_groups(g);
    cw_status st =
        parted && sums ? cw_mesh_attribute_add(mesh, &like, &added, err) : cwi_fail_memory(err);
    if (st == CW_OK)
        set_normals(g, parted, sums, added->data);
    cwi_free(parted);
    cwi_free(sums);
    return st;
}

cw_status cw_mesh_crease_normals(cw_mesh *mesh, double degrees, const uint8_t *regions,
                                 size_t *creases, cw_error *err)
{
    CWI_REQUIRE(err, mesh);
    grouping g = {.mesh = mesh, .regions = regions};
    cw_status st = cwi_mesh_check_size(mesh, "given normals of corners", err);
    if (st == CW_OK && !(degrees >= 0 && degrees <= 180))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "degrees %g: expected 0 to 180", degrees);
    if (st == CW_OK && !mesh->normals)
        st = cw_mesh_normals(mesh, err);
    if (st != CW_OK)
        return st;
    cw_mesh_attribute_remove(mesh, CW_CORNER_NORMALS);
    g.least_cosine = degrees < 180 ? cos(degrees * (acos(-1.0) / 180)) : -2;
    if (!group_corners(&g))
        st = cwi_fail_memory(err);
    if (st == CW_OK && g.creases)
        st = add_normals(mesh, &g, err);
    cwi_free(g.parent);
    if (st == CW_OK && creases)
        *creases = g.creases;
    return st;
}
