/* Welds vertices, and drops marked triangles and components that are small in diagonal or
 * volume. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/union_find.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "core/mesh/weld.h"

#include <cubewright/mesh.h>

#include <math.h>
#include <string.h>

/* Moves element v of each array to number[v], if it has one; numbers are rising. */
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

cw_status cwi_mesh_drop_marked(cw_mesh *mesh, const bool *marked, cw_error *err)
{
    uint32_t *number = cwi_alloc_array(mesh->vertex_count, sizeof *number);
    size_t kept = 0;
    if (!number)
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory to number %zu vertices",
                        mesh->vertex_count);
    for (size_t t = 0; t < mesh->triangle_count; t++)
        if (!marked[t])
            memmove(mesh->triangles + 3 * kept++, mesh->triangles + 3 * t,
                    3 * sizeof *mesh->triangles);
    mesh->triangle_count = kept;
    drop_unused(mesh, number);
    cwi_free(number);
    return CW_OK;
}

cw_status cw_mesh_weld(cw_mesh *mesh, size_t *merged, cw_error *err)
{
    cw_status st = cw_mesh_check(mesh, err);
    if (st != CW_OK)
        return st;
    uint32_t *map = cwi_alloc_array(mesh->vertex_count, sizeof *map);
    if (!map || !cwi_weld(mesh->positions, mesh->vertex_count, map)) {
        cwi_free(map);
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory to weld %zu vertices",
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

/* Sets of vertices that triangles join, each with its box and its measure. Both are stored at
 * the set's minimum vertex. */
typedef struct components {
    uint32_t *sets;
    float (*boxes)[6]; /* low, high */
    double *sizes;
    bool *dropped, *met;
} components;

static void free_components(components *c)
{
    cwi_free(c->sets);
    cwi_free(c->boxes);
    cwi_free(c->sizes);
    cwi_free(c->dropped);
    cwi_free(c->met);
}

static cw_status find_components(const cw_mesh *m, components *c, cw_error *err)
{
    c->sets = cwi_sets_alloc(m->vertex_count);
    c->boxes = cwi_alloc_array(m->vertex_count, sizeof *c->boxes);
    c->sizes = cwi_alloc_zeroed(m->vertex_count, sizeof *c->sizes);
    c->dropped = cwi_alloc_zeroed(m->vertex_count, sizeof *c->dropped);
    c->met = cwi_alloc_zeroed(m->vertex_count, sizeof *c->met);
    if (!c->sets || !c->boxes || !c->sizes || !c->dropped || !c->met)
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for the components of %zu vertices",
                        m->vertex_count);
    for (size_t t = 0; t < m->triangle_count; t++)
        for (size_t k = 1; k < 3; k++)
            cwi_sets_join(c->sets, m->triangles[3 * t], m->triangles[3 * t + k]);
    for (size_t v = 0; v < m->vertex_count; v++) {
        const uint32_t set = cwi_sets_find(c->sets, (uint32_t)v);
        float *box = c->boxes[set];
        for (size_t a = 0; a < 3; a++) {
            const float p = m->positions[3 * v + a];
            box[a] = v == set || p < box[a] ? p : box[a]; /* the minimum vertex comes first */
            box[3 + a] = v == set || p > box[3 + a] ? p : box[3 + a];
        }
    }
    return CW_OK;
}

static void measure_diagonals(const cw_mesh *m, components *c)
{
    for (size_t v = 0; v < m->vertex_count; v++) {
        const float *box = c->boxes[v];
        double square = 0;
        for (int a = 0; a < 3 && c->sets[v] == v; a++) {
            const double side = (double)box[3 + a] - (double)box[a];
            square += side * side;
        }
        c->sizes[v] = sqrt(square);
    }
}

/* Sums the tetrahedra up to the middle of the box. */
static void measure_volumes(const cw_mesh *m, components *c)
{
    for (size_t t = 0; t < m->triangle_count; t++) {
        const uint32_t set = cwi_sets_find(c->sets, m->triangles[3 * t]);
        const float *box = c->boxes[set];
        double corner[3][3], normal[3];
        for (size_t n = 0; n < 9; n++)
            corner[n / 3][n % 3] =
                (double)m->positions[3 * (size_t)m->triangles[3 * t + n / 3] + n % 3] -
                0.5 * ((double)box[n % 3] + (double)box[3 + n % 3]);
        cwi_cross(corner[1], corner[2], normal);
        c->sizes[set] += cwi_dot(corner[0], normal) / 6;
    }
    for (size_t v = 0; v < m->vertex_count; v++)
        c->sizes[v] = fabs(c->sizes[v]);
}

static void count_component(cw_drop_counts *n, double size, bool keep)
{
    if (keep) {
        n->least_kept_mm3 = n->kept ? fmin(n->least_kept_mm3, size) : size;
        n->kept++;
        return;
    }
    n->dropped++;
    n->dropped_mm3 += size;
    n->largest_mm3 = fmax(n->largest_mm3, size);
}

static void drop_components(cw_mesh *mesh, components *c, cw_drop_counts *counts)
{
    size_t triangles = 0;
    *counts = (cw_drop_counts){0};
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *corners = mesh->triangles + 3 * t;
        const uint32_t set = cwi_sets_find(c->sets, corners[0]);
        const bool keep = !c->dropped[set];
        if (!c->met[set])
            count_component(counts, c->sizes[set], keep);
        c->met[set] = true;
        counts->triangles += !keep;
        if (keep)
            memmove(mesh->triangles + 3 * triangles++, corners, 3 * sizeof *corners);
    }
    mesh->triangle_count = triangles;
    drop_unused(mesh, c->sets);
}

static cw_status drop_smaller(cw_mesh *mesh, double least,
                              void (*measure)(const cw_mesh *m, components *c),
                              cw_drop_counts *counts, cw_error *err)
{
    components c = {0};
    cw_status st = find_components(mesh, &c, err);
    if (st == CW_OK) {
        measure(mesh, &c);
        for (size_t v = 0; v < mesh->vertex_count; v++)
            c.dropped[v] = !(c.sizes[v] >= least);
        drop_components(mesh, &c, counts);
    }
    free_components(&c);
    return st;
}

cw_status cw_mesh_drop_components(cw_mesh *mesh, double diagonal_mm, size_t *dropped,
                                  size_t *kept, cw_error *err)
{
    cw_drop_counts counts;
    cw_status st = cw_mesh_check(mesh, err);
    if (st == CW_OK && !(diagonal_mm >= 0))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "diagonal_mm is %g; it must be 0 or more",
                      diagonal_mm);
    if (st == CW_OK)
        st = drop_smaller(mesh, diagonal_mm, measure_diagonals, &counts, err);
    if (st == CW_OK && dropped)
        *dropped = counts.dropped;
    if (st == CW_OK && kept)
        *kept = counts.kept;
    return st;
}

cw_status cw_mesh_drop_volumes(cw_mesh *mesh, double least_mm3, cw_drop_counts *counts,
                               cw_error *err)
{
    cw_drop_counts own;
    cw_status st = cw_mesh_check(mesh, err);
    if (st == CW_OK && !(least_mm3 >= 0))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "least_mm3 is %g; it must be 0 or more", least_mm3);
    return st == CW_OK
               ? drop_smaller(mesh, least_mm3, measure_volumes, counts ? counts : &own, err)
               : st;
}

cw_status cw_mesh_drop_distant(cw_mesh *mesh, const float *distance_mm, double limit_mm,
                               cw_drop_counts *counts, double *farthest_mm, cw_error *err)
{
    components c = {0};
    cw_drop_counts own;
    double farthest = 0;
    cw_status st = cw_mesh_check(mesh, err);
    if (st == CW_OK && !(limit_mm >= 0))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "limit_mm is %g; it must be 0 or more", limit_mm);
    if (st == CW_OK)
        st = find_components(mesh, &c, err);
    if (st == CW_OK) {
        measure_volumes(mesh, &c);
        memset(c.dropped, true, mesh->vertex_count * sizeof *c.dropped);
        for (uint32_t v = 0; v < mesh->vertex_count; v++)
            if ((double)distance_mm[v] <= limit_mm)
                c.dropped[cwi_sets_find(c.sets, v)] = false;
        for (size_t n = 0; n < 3 * mesh->triangle_count; n++) {
            const uint32_t v = mesh->triangles[n];
            if (c.dropped[cwi_sets_find(c.sets, v)])
                farthest = fmax(farthest, (double)distance_mm[v]);
        }
        drop_components(mesh, &c, counts ? counts : &own);
    }
    if (st == CW_OK && farthest_mm)
        *farthest_mm = farthest;
    free_components(&c);
    return st;
}
