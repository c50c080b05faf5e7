/* Leaves the outer shells of solids alone: cavities go, and all inside them. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/union_find.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "simplify/quality/topology.h"

#include <cubewright/quality.h>

#include <math.h>
#include <string.h>

/* Components by their roots, and which triangles go. Arrays of vertex_count or triangle_count. */
typedef struct voids {
    cw_mesh *mesh;
    uint32_t *root;   /* vertices */
    double *volume;   /* roots: six times what they enclose, signed */
    uint8_t *defects; /* triangles */
    uint8_t *skipped; /* roots: not closed or not oriented; afterwards: counted */
    bool *goes;       /* triangles */
} voids;

static void free_voids(voids *v)
{
    cwi_free(v->root);
    cwi_free(v->volume);
    cwi_free(v->defects);
    cwi_free(v->skipped);
    cwi_free(v->goes);
}

static cw_status ensure_capacity(voids *v, cw_error *err)
{
    const size_t vertices = v->mesh->vertex_count, triangles = v->mesh->triangle_count;
    v->root = cwi_sets_alloc(vertices);
    v->volume = cwi_alloc_array(vertices, sizeof *v->volume);
    v->defects = cwi_alloc_array(triangles, 1);
    v->skipped = cwi_alloc_array(vertices, 1);
    v->goes = cwi_alloc_array(triangles, sizeof *v->goes);
    return v->root && v->volume && v->defects && v->skipped && v->goes ? CW_OK
                                                                       : cwi_fail_memory(err);
}

/* Names the components of the triangles that are left, and sums their volumes. */
static void measure_components(voids *v)
{
    const cw_mesh *m = v->mesh;
    enum { UNBOUNDED = CW_DEFECT_OPEN | CW_DEFECT_NONMANIFOLD | CW_DEFECT_MISORIENTED };
    for (uint32_t n = 0; n < m->vertex_count; n++)
        v->root[n] = n;
    memset(v->skipped, 0, m->vertex_count);
    memset(v->volume, 0, m->vertex_count * sizeof *v->volume);
    for (size_t c = 0; c < 3 * m->triangle_count; c++)
        cwi_sets_join(v->root, m->triangles[c], m->triangles[c - c % 3]);
    for (size_t t = 0; t < m->triangle_count; t++) {
        const uint32_t *c = m->triangles + 3 * t, root = cwi_sets_find(v->root, c[0]);
        const float *from = m->positions + 3 * (size_t)root;
        double p[3][3], area[3];
        for (size_t n = 0; n < 9; n++)
            p[n / 3][n % 3] =
                (double)m->positions[3 * (size_t)c[n / 3] + n % 3] - (double)from[n % 3];
        cwi_cross(p[1], p[2], area);
        v->volume[root] += cwi_dot(p[0], area);
        v->skipped[root] |= v->defects[t] & UNBOUNDED ? 1 : 0;
    }
}

/* Chooses the closed components that face inward, or those that lie inside others. */
static void choose_components(voids *v, bool inside)
{
    for (size_t t = 0; t < v->mesh->triangle_count; t++) {
        const uint32_t root = cwi_sets_find(v->root, v->mesh->triangles[3 * t]);
        v->goes[t] = !v->skipped[root] && (inside ? (v->defects[t] & CW_DEFECT_INSIDE_OUT) != 0
                                                  : v->volume[root] < 0);
    }
}

static void count_components(voids *v, cw_drop_counts *counts)
{
    counts->kept = 0;
    memset(v->skipped, 0, v->mesh->vertex_count);
    for (size_t t = 0; t < v->mesh->triangle_count; t++) {
        const uint32_t root = cwi_sets_find(v->root, v->mesh->triangles[3 * t]);
        counts->triangles += v->goes[t];
        if (v->skipped[root])
            continue;
        v->skipped[root] = 1;
        counts->kept += !v->goes[t];
        if (!v->goes[t])
            continue;
        counts->dropped++;
        counts->dropped_mm3 -= v->volume[root] / 6;
        counts->largest_mm3 = fmax(counts->largest_mm3, fabs(v->volume[root] / 6));
    }
}

/* Where a component goes, one inside it becomes one of its surroundings. */
static cw_status drop_components(voids *v, bool inside, int threads, cw_drop_counts *counts,
                                 cw_error *err)
{
    cw_quality q;
    memset(v->defects, 0, v->mesh->triangle_count);
    const cw_quality_desc desc = {.shells = inside, .threads = threads, .defects = v->defects};
    cw_status st = cwi_measure_topology(v->mesh, &desc, &q, err);
    if (st != CW_OK)
        return st;
    measure_components(v);
    choose_components(v, inside);
    count_components(v, counts);
    return cwi_mesh_drop_marked(v->mesh, v->goes, err);
}

cw_status cw_mesh_fill_voids(cw_mesh *mesh, int threads, cw_drop_counts *counts, cw_error *err)
{
    CWI_REQUIRE(err, mesh);
    cw_drop_counts own, *c = counts ? counts : &own;
    voids v = {.mesh = mesh};
    *c = (cw_drop_counts){0};
    cw_status st = cw_mesh_check(mesh, err);
    if (st == CW_OK)
        st = ensure_capacity(&v, err);
    if (st == CW_OK)
        st = drop_components(&v, false, threads, c, err);
    if (st == CW_OK && c->dropped)
        st = drop_components(&v, true, threads, c, err);
    free_voids(&v);
    return st;
}
