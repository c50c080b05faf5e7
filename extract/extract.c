/* Implements the public calls: a surface at once, several surfaces of one volume, and counts
 * alone. */
#include <cubewright/extract.h>

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/mesh.h"
#include "core/volume/volume.h"
#include "extract/common/extract_limits.h"
#include "extract/common/field_normals.h"
#include "extract/dense/border_loops.h"
#include "extract/extract_internal.h"
#include "extract/irregular/cell_surface.h"
#include "extract/snap/snap.h"
#include "extract/sparse/sparse_extract.h"

#include <string.h>

static cw_status check_snap(const cw_extract_desc *d, cw_error *err)
{
    if (d->snap >= 0 && d->snap <= CW_EXTRACT_MAX_SNAP)
        return CW_OK;
    return cwi_fail(err, CW_ERR_ARGUMENT,
                    "snap is a fraction of an edge from 0 (off) to %g, not %g",
                    CW_EXTRACT_MAX_SNAP, d->snap);
}

cw_status cwi_plan_init(cwi_plan *p, const cwi_engine *engine, const cw_volume *volume,
                        cw_error *err)
{
    memset(p, 0, sizeof *p);
    p->engine = engine;
    return volume->sparse || volume->cells
               ? cw_volume_select(volume, 0, 0, &p->grid.volume, err)
               : cwi_grid_init(&p->grid, volume, err);
}

/* Returns false for sparse and irregular grids, which are extracted at once; mesh NULL:
 * counted. */
bool cwi_plan_is_dense(const cwi_plan *p)
{
    return !p->grid.volume.sparse && !p->grid.volume.cells;
}

cw_status cwi_extract_at_once(cwi_plan *p, const cw_extract_desc *d, cw_mesh *mesh,
                              cw_error *err)
{
    const cw_volume *v = &p->grid.volume;
    memset(&p->counts, 0, sizeof p->counts);
    return v->cells ? cwi_cells_extract(v, d, mesh, &p->counts, err)
                    : cwi_extract_sparse(p->engine, v, d, mesh, &p->counts, err);
}

/* Finds everything that is known of the surface before it is made. */
cw_status cwi_plan_make(cwi_plan *p, const cw_extract_desc *d, cw_error *err)
{
    memset(&p->counts, 0, sizeof p->counts);
    cw_status st = check_snap(d, err);
    if (st == CW_OK && d->snap > 0)
        st = cwi_volume_expect_even(&p->grid.volume, "snap", err);
    if (st == CW_OK && d->cubic_placement)
        st = cwi_volume_expect_even(&p->grid.volume, "cubic placement", err);
    if (st == CW_OK)
        st = cwi_grid_classify(&p->grid, p->engine, p->tree.levels ? &p->tree : NULL, d, err);
    if (st != CW_OK || !p->grid.crossed)
        return st;
    const cwi_bit_grid *g = &p->grid;
    st = cwi_plan_count(p, d->threads, &d->progress, err);
    if (st == CW_OK)
        st = cwi_grid_border_loops(&p->grid, &p->counts.border_loops, err);
    p->counts.bytes = cwi_extract_mesh_bytes(&p->counts, !d->no_normals) +
                      cwi_grid_bytes(&p->grid) + cwi_octree_bytes(&p->tree);
    if (d->snap > 0)
        p->counts.bytes += cwi_snap_bytes(g, p->counts.vertices, p->counts.triangles);
    return st == CW_OK ? cwi_extract_check_limits(d, &p->counts, err) : st;
}

/* Computes normals on a rectilinear grid, where differences do not depend on neighbours
 * alone. */
static cw_status shade_by_coordinates(const cwi_plan *p, const cw_extract_desc *d,
                                      cw_mesh *mesh, cw_error *err)
{
    const cw_normals_desc desc = {.inside_is_low = d->inside_is_low, .threads = d->threads};
    return cwi_is_rectilinear(&p->grid.volume) && !d->no_normals
               ? cw_extract_normals(&p->grid.volume, &desc, mesh, err)
               : CW_OK;
}

static cw_status write_mesh(cwi_plan *p, const cw_extract_desc *d, cw_mesh *mesh, cw_error *err)
{
    const bool normals = !d->no_normals && !cwi_is_rectilinear(&p->grid.volume);
    *mesh = p->spare;
    p->spare = (cw_mesh){0};
    cw_status st = cwi_mesh_renew(mesh, p->counts.vertices, p->counts.triangles, normals, err);
    if (st != CW_OK)
        return st;
    cwi_writing w = {.plan = p,
                     .end = p->grid.rows_z - 1,
                     .emission = cwi_make_emission(&p->grid.volume, d->simple_topology),
                     .sink = cwi_make_sink(&p->grid.volume, p->grid.invert, mesh),
                     .triangles = mesh->triangles};
    st = cwi_write_dense_layers(&w, d, err);
    if (st == CW_OK && w.sink.missing)
        st = cwi_repair_normals(mesh, cwi_voxel_scale(&p->grid.volume), err);
    if (st == CW_OK)
        memcpy(mesh->affine, p->grid.volume.affine, sizeof mesh->affine);
    if (st == CW_OK)
        st = shade_by_coordinates(p, d, mesh, err);
    if (st == CW_OK && d->snap > 0)
        st = cwi_snap(&p->grid, p->rows, d, mesh, &p->counts.snap, err);
    p->counts.vertices = mesh->vertex_count;
    p->counts.triangles = mesh->triangle_count;
    return st;
}

/* Empties a mesh, and keeps its arrays for the next surface. */
static void take_arrays(cwi_plan *p, cw_mesh *mesh)
{
    if (mesh->positions && cwi_plan_is_dense(p)) {
        cw_mesh_free(&p->spare);
        p->spare = *mesh;
        *mesh = (cw_mesh){0};
    }
    cw_mesh_free(mesh);
}

static cw_status extract_planned(cwi_plan *p, const cw_extract_desc *desc, cw_mesh *mesh,
                                 cw_extract_counts *counts, cw_error *err)
{
    const cw_extract_desc d = desc ? *desc : (cw_extract_desc){0};
    take_arrays(p, mesh);
    cw_status st = cwi_plan_is_dense(p) ? cwi_plan_make(p, &d, err)
                                        : cwi_extract_at_once(p, &d, mesh, err);
    if (st == CW_OK && p->counts.triangles && cwi_plan_is_dense(p))
        st = write_mesh(p, &d, mesh, err);
    if (st == CW_OK && counts)
        *counts = p->counts;
    if (st != CW_OK)
        cw_mesh_free(mesh);
    return st;
}

static cw_status predict_planned(cwi_plan *p, const cw_extract_desc *desc,
                                 cw_extract_counts *counts, cw_error *err)
{
    const cw_extract_desc d = desc ? *desc : (cw_extract_desc){0};
    cw_status st = cwi_plan_is_dense(p) ? cwi_plan_make(p, &d, err)
                                        : cwi_extract_at_once(p, &d, NULL, err);
    if (st == CW_OK)
        *counts = p->counts;
    return st;
}

cw_status cwi_extract_with(const cwi_engine *engine, const cw_volume *volume,
                           const cw_extract_desc *desc, cw_mesh *mesh,
                           cw_extract_counts *counts, cw_error *err)
{
    cwi_plan p;
    cw_status st = cwi_plan_init(&p, engine, volume, err);
    if (st == CW_OK)
        st = extract_planned(&p, desc, mesh, counts, err);
    else
        cw_mesh_free(mesh);
    cwi_plan_free(&p);
    return st;
}

cw_status cw_extract(const cw_volume *volume, const cw_extract_desc *desc, cw_mesh *mesh,
                     cw_extract_counts *counts, cw_error *err)
{
    CWI_REQUIRE(err, volume, mesh);
    CWI_REQUIRE_VERSION(err, desc, 0);
    return cwi_extract_with(cwi_engine_best(), volume, desc, mesh, counts, err);
}

cw_status cw_extract_predict(const cw_volume *volume, const cw_extract_desc *desc,
                             cw_extract_counts *counts, cw_error *err)
{
    CWI_REQUIRE(err, volume);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cwi_plan p;
    cw_status st = cwi_plan_init(&p, cwi_engine_best(), volume, err);
    if (st == CW_OK)
        st = predict_planned(&p, desc, counts, err);
    cwi_plan_free(&p);
    return st;
}

cw_status cwi_extractor_new_with(const cwi_engine *engine, size_t leaf_bytes,
                                 const cw_volume *volume, cw_extractor **out, cw_error *err)
{
    cw_extractor *e = cwi_alloc_zeroed(1, sizeof *e);
    *out = NULL;
    if (!e)
        return cwi_fail_memory(err);
    cw_status st = cwi_plan_init(&e->plan, engine, volume, err);
    if (st == CW_OK && cwi_plan_is_dense(&e->plan))
        st = cwi_octree_init(&e->plan.tree, &e->plan.grid, err);
    e->plan.tree.leaf_bytes = leaf_bytes;
    e->has_nodata = e->plan.grid.volume.has_nodata;
    if (st == CW_OK)
        *out = e;
    else
        cw_extractor_free(e);
    return st;
}

cw_status cw_extractor_new(const cw_volume *volume, cw_extractor **out, cw_error *err)
{
    CWI_REQUIRE(err, volume, out);
    return cwi_extractor_new_with(cwi_engine_best(), CWI_LEAF_BYTES, volume, out, err);
}

void cw_extractor_free(cw_extractor *e)
{
    if (!e)
        return;
    cwi_plan_free(&e->plan);
    cwi_bricks_free(&e->bricks);
    cwi_free(e);
}

cw_status cw_extractor_extract(cw_extractor *e, const cw_extract_desc *desc, cw_mesh *mesh,
                               cw_extract_counts *counts, cw_error *err)
{
    CWI_REQUIRE(err, e, mesh);
    CWI_REQUIRE_VERSION(err, desc, 0);
    return extract_planned(&e->plan, desc, mesh, counts, err);
}

void cw_extractor_recycle(cw_extractor *e, cw_mesh *mesh)
{
    if (e && mesh)
        take_arrays(&e->plan, mesh);
}

cw_status cw_extractor_predict(cw_extractor *e, const cw_extract_desc *desc,
                               cw_extract_counts *counts, cw_error *err)
{
    CWI_REQUIRE(err, e);
    CWI_REQUIRE_VERSION(err, desc, 0);
    return predict_planned(&e->plan, desc, counts, err);
}
