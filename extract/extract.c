#include <cubewright/extract.h>

#include "core/memory.h"
#include "core/mesh.h"
#include "core/status.h"
#include "extract/march.h"

#include <math.h>
#include <string.h>

/* What an extraction holds between counting and writing. */
typedef struct plan {
    cwi_grid grid;
    cwi_row *rows;
    cw_extract_counts counts;
} plan;

static size_t mesh_bytes(const cw_extract_counts *c, bool normals)
{
    return c->vertices * 3 * sizeof(float) * (normals ? 2 : 1) +
           c->triangles * 3 * sizeof(uint32_t);
}

static cw_status check_limits(const cw_extract_desc *d, const cw_extract_counts *c,
                              cw_error *err)
{
    if (d->max_triangles && c->triangles > d->max_triangles)
        return cw_fail(err, CW_ERR_LIMIT, "the surface has %zu triangles; the limit is %zu",
                       c->triangles, d->max_triangles);
    if (d->max_bytes && c->bytes > d->max_bytes)
        return cw_fail(err, CW_ERR_LIMIT,
                       "extraction of %zu triangles needs %zu bytes; the limit is %zu",
                       c->triangles, c->bytes, d->max_bytes);
    return CW_OK;
}

static cw_status make_plan(plan *p, const cw_volume *volume, const cw_extract_desc *d,
                           cw_error *err)
{
    memset(p, 0, sizeof *p);
    cw_status st = cwi_grid_build(&p->grid, volume, d, err);
    if (st != CW_OK || !p->grid.crossed)
        return st;
    p->rows = cwi_alloc_array(p->grid.rows, sizeof *p->rows);
    if (!p->rows)
        return cw_fail(err, CW_ERR_NO_MEMORY, "no memory for %zu rows", p->grid.rows);
    st = cwi_march_count(&p->grid, d, p->rows, &p->counts.vertices, &p->counts.triangles, err);
    if (st == CW_OK)
        st = cwi_grid_border_loops(&p->grid, &p->counts.border_loops, err);
    p->counts.bytes = mesh_bytes(&p->counts, !d->no_normals) + cwi_grid_bytes(&p->grid);
    return st == CW_OK ? check_limits(d, &p->counts, err) : st;
}

static void free_plan(plan *p)
{
    cwi_grid_free(&p->grid);
    cwi_free(p->rows);
}

static void add_triangle_normal(const cw_mesh *mesh, const uint32_t *t, float *normal)
{
    const float *p = mesh->positions;
    double u[3], v[3];
    for (int a = 0; a < 3; a++) {
        u[a] = (double)p[3 * t[1] + (size_t)a] - (double)p[3 * t[0] + (size_t)a];
        v[a] = (double)p[3 * t[2] + (size_t)a] - (double)p[3 * t[0] + (size_t)a];
    }
    for (int a = 0; a < 3; a++)
        normal[a] += (float)(u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3]);
}

static void normalise(float *n)
{
    const double length = sqrt((double)n[0] * n[0] + (double)n[1] * n[1] + (double)n[2] * n[2]);
    for (int a = 0; a < 3; a++)
        n[a] = length > 0 ? (float)(n[a] / length) : a == 2;
}

/* Where the gradient vanished the normal is zero; the triangles around the vertex give it one.
 * One thread, in the order of triangles: sums do not depend on the number of threads. */
static cw_status mend_normals(cw_mesh *mesh, cw_error *err)
{
    size_t count = 0;
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        const float *n = mesh->normals + 3 * v;
        count += n[0] == 0 && n[1] == 0 && n[2] == 0;
    }
    if (!count)
        return CW_OK;
    bool *missing = cwi_alloc_zeroed(mesh->vertex_count, sizeof *missing);
    if (!missing)
        return cw_fail(err, CW_ERR_NO_MEMORY, "no memory to mend %zu normals", count);
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        const float *n = mesh->normals + 3 * v;
        missing[v] = n[0] == 0 && n[1] == 0 && n[2] == 0;
    }
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *triangle = mesh->triangles + 3 * t;
        for (int c = 0; c < 3; c++)
            if (missing[triangle[c]])
                add_triangle_normal(mesh, triangle, mesh->normals + 3 * (size_t)triangle[c]);
    }
    for (size_t v = 0; v < mesh->vertex_count; v++)
        if (missing[v])
            normalise(mesh->normals + 3 * v);
    cwi_free(missing);
    return CW_OK;
}

static cw_status write_mesh(const plan *p, const cw_extract_desc *d, cw_mesh *mesh,
                            cw_error *err)
{
    cw_status st =
        cwi_mesh_alloc(mesh, p->counts.vertices, p->counts.triangles, !d->no_normals, err);
    if (st == CW_OK)
        st = cwi_march_write(&p->grid, d, p->rows, mesh, err);
    if (st == CW_OK && mesh->normals)
        st = mend_normals(mesh, err);
    if (st == CW_OK)
        memcpy(mesh->affine, p->grid.volume.affine, sizeof mesh->affine);
    return st;
}

cw_status cw_extract(const cw_volume *volume, const cw_extract_desc *desc, cw_mesh *mesh,
                     cw_extract_counts *counts, cw_error *err)
{
    const cw_extract_desc d = desc ? *desc : (cw_extract_desc){0};
    plan p;
    memset(mesh, 0, sizeof *mesh);
    cw_status st = make_plan(&p, volume, &d, err);
    if (st == CW_OK && p.counts.triangles)
        st = write_mesh(&p, &d, mesh, err);
    if (st == CW_OK && counts)
        *counts = p.counts;
    if (st != CW_OK)
        cw_mesh_free(mesh);
    free_plan(&p);
    return st;
}

cw_status cw_extract_predict(const cw_volume *volume, const cw_extract_desc *desc,
                             cw_extract_counts *counts, cw_error *err)
{
    const cw_extract_desc d = desc ? *desc : (cw_extract_desc){0};
    plan p;
    cw_status st = make_plan(&p, volume, &d, err);
    if (st == CW_OK)
        *counts = p.counts;
    free_plan(&p);
    return st;
}
