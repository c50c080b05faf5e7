/* Shells that face the wrong way, turned round. */
#include <cubewright/quality.h>

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/union_find.h"
#include "core/mesh/mesh_attributes.h"
#include "core/mesh/mesh_triangle.h"

/* Whether the normals at a triangle's corners point to the side from which it is seen to wind
 * counter-clockwise. */
static bool normals_agree(const cw_mesh *m, size_t t)
{
    const uint32_t *corner = m->triangles + 3 * t;
    double normal[3], sum[3] = {0};
    cwi_mesh_normal(m, t, normal);
    for (size_t n = 0; n < 9; n++)
        sum[n % 3] += (double)m->normals[3 * (size_t)corner[n / 3] + n % 3];
    return cwi_dot(normal, sum) >= 0;
}

typedef struct work {
    cw_mesh *mesh;
    uint8_t *turn;   /* of triangles */
    uint32_t *shell; /* union-find of vertices, as indexed */
    int64_t *agree;  /* of a root: triangles whose normals agree, less those whose do not */
    uint8_t *turned; /* of a root */
} work;

static void look_at_normals(work *w)
{
    const cw_mesh *m = w->mesh;
    for (size_t t = 0; t < m->triangle_count && m->normals; t++)
        if (w->turn[t])
            w->agree[cwi_sets_find(w->shell, m->triangles[3 * t])] +=
                normals_agree(m, t) ? 1 : -1;
}

static void turn_normals(work *w)
{
    const cw_mesh *m = w->mesh;
    for (uint32_t v = 0; v < m->vertex_count && m->normals; v++) {
        const uint32_t root = cwi_sets_find(w->shell, v);
        for (size_t a = 0; a < 3 && w->turned[root] && w->agree[root] >= 0; a++)
            m->normals[3 * (size_t)v + a] = -m->normals[3 * (size_t)v + a];
    }
}

static void turn_shells(work *w, cw_orient_counts *counts)
{
    cw_mesh *m = w->mesh;
    for (size_t t = 0; t < m->triangle_count; t++) {
        const uint32_t *corner = m->triangles + 3 * t;
        cwi_sets_join(w->shell, corner[0], corner[1]);
        cwi_sets_join(w->shell, corner[0], corner[2]);
    }
    look_at_normals(w);
    for (size_t t = 0; t < m->triangle_count; t++)
        if (w->turn[t]) {
            w->turned[cwi_sets_find(w->shell, m->triangles[3 * t])] = 1;
            cwi_mesh_swap_corners(w->mesh, t, 1, 2);
            counts->triangles++;
        }
    turn_normals(w);
}

cw_status cw_mesh_orient(cw_mesh *mesh, int threads, cw_orient_counts *counts, cw_error *err)
{
    CWI_REQUIRE(err, mesh);
    cw_orient_counts own = {0};
    cw_quality q;
    work w = {.mesh = mesh};
    w.turn = cwi_alloc_zeroed(mesh->triangle_count + 1, 1);
    w.shell = cwi_sets_alloc(mesh->vertex_count + 1);
    w.agree = cwi_alloc_zeroed(mesh->vertex_count + 1, sizeof *w.agree);
    w.turned = cwi_alloc_zeroed(mesh->vertex_count + 1, 1);
    cw_status st = w.turn && w.shell && w.agree && w.turned ? CW_OK : cwi_fail_memory(err);
    const cw_quality_desc desc = {
        .weld = CW_WELD_LOCAL, .shells = true, .threads = threads, .turn = w.turn};
    if (st == CW_OK)
        st = cw_quality_measure(mesh, &desc, &q, err);
    if (st == CW_OK) {
        turn_shells(&w, &own);
        own.turned = q.to_turn;
    }
    cwi_free(w.turn);
    cwi_free(w.shell);
    cwi_free(w.agree);
    cwi_free(w.turned);
    if (counts)
        *counts = own;
    return st;
}
