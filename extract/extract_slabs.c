/* Extracts a surface slab by slab: slabs share no vertex number, and meet in a seam. */
#include "extract/extract_internal.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/mesh.h"
#include "extract/common/extract_limits.h"
#include "extract/dense/slab_cuts.h"

#include <math.h>
#include <string.h>

static cwi_layer_sums sum_layers(const cwi_plan *p)
{
    return (cwi_layer_sums){.layers = p->grid.layers,
                            .count = p->grid.rows_z,
                            .vertices = p->counts.vertices,
                            .triangles = p->counts.triangles};
}

/* Turns numbers in the slab into those in the mesh, or, with negated arguments, back. */
static void shift_rows(cwi_plan *p, const cwi_writing *w, uint32_t vertices, size_t triangles)
{
    const size_t rows = p->grid.rows_y;
    for (cwi_row *row = p->rows + w->begin * rows; row <= p->rows + (w->end + 1) * rows;
         row++) {
        for (int kind = 0; kind < 4; kind++)
            row->first[kind] += vertices;
        row->triangle += triangles;
    }
}

static cw_status write_slab(cwi_plan *p, cwi_writing *w, const cw_extract_desc *d,
                            cw_mesh *mesh, uint8_t *seam, cw_slab_sink sink, cw_error *err)
{
    const cwi_layer_sums sums = sum_layers(p);
    const size_t vertices = cwi_vertices_before(&sums, w->begin),
                 triangles = sums.layers[w->begin].triangles, rows = p->grid.rows_y;
    const cwi_row *below = p->rows + w->begin * rows, *above = p->rows + w->end * rows;
    cw_slab slab = {.mesh = mesh,
                    .seam = seam,
                    .triangles = p->counts.triangles,
                    .last = w->end + 1 == p->grid.rows_z};
    mesh->vertex_count = cwi_vertices_before(&sums, w->end + 1) - vertices;
    mesh->triangle_count = sums.layers[w->end].triangles - triangles;
    shift_rows(p, w, -(uint32_t)vertices, -triangles);
    cw_status st = cwi_write_dense_layers(w, d, err);
    memset(seam, 0, mesh->vertex_count);
    if (w->begin)
        cwi_mark_seam(below, rows, 0, 1, seam);
    if (!slab.last)
        cwi_mark_seam(above, rows, 0, 2, seam);
    cwi_clear_beyond_seam(above, rows, 0, mesh->positions);
    shift_rows(p, w, (uint32_t)vertices, triangles);
    cwi_set_slab_planes(&p->grid.volume, w->sink.centre, w->begin, w->end, &slab);
    return st == CW_OK ? sink.take(sink.user, &slab, err) : st;
}

static cw_status write_slabs(cwi_plan *p, const cw_extract_desc *d, size_t triangles,
                             cw_slab_sink sink, cw_error *err)
{
    const cwi_layer_sums sums = sum_layers(p);
    const cw_extract_counts max = cwi_largest_slab(&sums, triangles);
    cw_mesh mesh;
    p->counts.bytes =
        cwi_extract_mesh_bytes(&max, false) + max.vertices + cwi_grid_bytes(&p->grid);
    cw_status st = cwi_extract_check_limits(d, &p->counts, err);
    if (st == CW_OK)
        st = cwi_mesh_alloc(&mesh, max.vertices, max.triangles, false, err);
    if (st != CW_OK)
        return st;
    uint8_t *seam = cwi_alloc_array(max.vertices, 1);
    if (!seam)
        st = cwi_fail_memory(err);
    memcpy(mesh.affine, p->grid.volume.affine, sizeof mesh.affine);
    cwi_writing w = {.plan = p,
                     .emission = cwi_make_emission(&p->grid.volume, d->simple_topology),
                     .sink = cwi_make_sink(&p->grid.volume, p->grid.invert, &mesh),
                     .triangles = mesh.triangles};
    for (; w.begin + 1 < p->grid.rows_z && st == CW_OK; w.begin = w.end) {
        w.end = cwi_end_of_slab(&sums, w.begin, triangles);
        st = write_slab(p, &w, d, &mesh, seam, sink, err);
    }
    cw_mesh_free(&mesh);
    cwi_free(seam);
    return st;
}

static cw_status give_whole(cwi_plan *p, const cw_extract_desc *d, cw_slab_sink sink,
                            cw_error *err)
{
    cw_mesh mesh = {0};
    uint8_t *seam = NULL;
    cw_slab slab = {.mesh = &mesh, .low = -INFINITY, .high = INFINITY, .last = true};
    cw_status st = cwi_extract_at_once(p, d, &mesh, err);
    if (st == CW_OK && mesh.triangle_count) {
        slab.seam = seam = cwi_alloc_zeroed(mesh.vertex_count, 1);
        slab.triangles = mesh.triangle_count;
        st = seam ? sink.take(sink.user, &slab, err) : cwi_fail_memory(err);
    }
    cwi_free(seam);
    cw_mesh_free(&mesh);
    return st;
}

cw_status cw_extract_slabs(const cw_volume *volume, const cw_extract_desc *desc,
                           size_t triangles, cw_slab_sink sink, cw_extract_counts *counts,
                           cw_error *err)
{
    CWI_REQUIRE(err, volume);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cw_extract_desc d = desc ? *desc : (cw_extract_desc){0};
    const size_t max_bytes = d.max_bytes;
    cwi_plan p = {0};
    d.no_normals = true;
    d.max_bytes = 0; /* the limit is for slabs, not for the whole surface */
    cw_status st = d.snap == 0
                       ? cwi_plan_init(&p, cwi_engine_best(), volume, err)
                       : cwi_fail(err, CW_ERR_ARGUMENT,
                                  "snap is %g; a surface made by slabs is not snapped", d.snap);
    if (st == CW_OK && cwi_plan_is_dense(&p))
        st = cwi_plan_make(&p, &d, err);
    d.max_bytes = max_bytes;
    if (st == CW_OK && !cwi_plan_is_dense(&p))
        st = give_whole(&p, &d, sink, err);
    else if (st == CW_OK && p.counts.triangles)
        st = write_slabs(&p, &d, triangles, sink, err);
    if (st == CW_OK && counts)
        *counts = p.counts;
    cwi_plan_free(&p);
    return st;
}
