/* Extracts a surface slab by slab: slabs share no vertex number, and meet in a seam. */
#include "extract/extract_internal.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/mesh/mesh.h"
#include "core/volume/volume.h"
#include "extract/common/extract_limits.h"
#include "extract/dense/edge_crossing.h"

#include <math.h>
#include <string.h>

enum { MIN_LAYERS = 16 };

static size_t triangles_before(const cwi_plan *p, size_t layer)
{
    return p->grid.layers[layer].triangles;
}

static size_t vertices_before(const cwi_plan *p, size_t layer)
{
    return layer < p->grid.rows_z ? p->grid.layers[layer].vertices : p->counts.vertices;
}

/* Returns the layer where the slab that begins with a layer ends. The rest behind it is a slab
 * of at least half the size. */
static size_t end_of_slab(const cwi_plan *p, size_t begin, size_t triangles)
{
    const size_t last = p->grid.rows_z - 1;
    size_t end = begin + MIN_LAYERS;
    while (end < last && triangles_before(p, end) - triangles_before(p, begin) < triangles)
        end++;
    return end >= last || p->counts.triangles - triangles_before(p, end) < triangles / 2 ? last
                                                                                         : end;
}

/* Counts the vertices and triangles of the largest slab. */
static cw_extract_counts largest_slab(const cwi_plan *p, size_t triangles)
{
    cw_extract_counts most = {0};
    for (size_t k = 0, end; k + 1 < p->grid.rows_z; k = end) {
        end = end_of_slab(p, k, triangles);
        const size_t v = vertices_before(p, end + 1) - vertices_before(p, k),
                     t = triangles_before(p, end) - triangles_before(p, k);
        most.vertices = v > most.vertices ? v : most.vertices;
        most.triangles = t > most.triangles ? t : most.triangles;
    }
    return most;
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

/* Marks the crossings of edges that lie in the plane of a layer of samples. */
static void mark_seam(const cwi_plan *p, size_t layer, uint8_t mark, uint8_t *seam)
{
    const cwi_row *row = p->rows + layer * p->grid.rows_y;
    for (size_t j = 0; j < p->grid.rows_y; j++)
        memset(seam + row[j].first[0], mark, row[j].first[2] - row[j].first[0]);
}

/* Clears the vertices in the last layer that belong to the next slab: they were written in
 * part. */
static void clear_beyond(const cwi_plan *p, size_t layer, float *positions)
{
    const cwi_row *row = p->rows + layer * p->grid.rows_y;
    for (size_t j = 0; j < p->grid.rows_y; j++)
        memset(positions + 3 * (size_t)row[j].first[2], 0,
               (size_t)(row[j + 1].first[0] - row[j].first[2]) * 3 * sizeof *positions);
}

/* Returns the height, from the origin, of a fraction of the way from a layer of samples to the
 * next. */
static double height_of(const cwi_writing *w, size_t layer, double share)
{
    const cw_volume *v = &w->plan->grid.volume;
    return cwi_grid_coordinate(v, 2, (ptrdiff_t)layer - 1, share) - w->sink.centre[2];
}

/* Sets the planes of a slab. Vertices are kept CWI_NUDGE away from planes; half of that allows
 * for rounding. */
static void set_planes(const cwi_plan *p, const cwi_writing *w, cw_slab *slab)
{
    double cofactor[3][3];
    const double *affine = p->grid.volume.affine[0],
                 determinant = cwi_affine_determinant(affine);
    cwi_affine_cofactor(affine, cofactor);
    for (int a = 0; a < 3; a++)
        slab->along[a] = cofactor[a][2] / determinant;
    slab->low = w->begin ? height_of(w, w->begin, CWI_NUDGE / 2) : -INFINITY;
    slab->high = slab->last ? INFINITY : height_of(w, w->end - 1, 1 - CWI_NUDGE / 2);
}

static cw_status write_slab(cwi_plan *p, cwi_writing *w, const cw_extract_desc *d,
                            cw_mesh *mesh, uint8_t *seam, cw_slab_sink sink, cw_error *err)
{
    const size_t vertices = vertices_before(p, w->begin),
                 triangles = triangles_before(p, w->begin);
    cw_slab slab = {.mesh = mesh,
                    .seam = seam,
                    .triangles = p->counts.triangles,
                    .last = w->end + 1 == p->grid.rows_z};
    mesh->vertex_count = vertices_before(p, w->end + 1) - vertices;
    mesh->triangle_count = triangles_before(p, w->end) - triangles;
    shift_rows(p, w, -(uint32_t)vertices, -triangles);
    cw_status st = cwi_write_dense_layers(w, d, err);
    memset(seam, 0, mesh->vertex_count);
    if (w->begin)
        mark_seam(p, w->begin, 1, seam);
    if (!slab.last)
        mark_seam(p, w->end, 2, seam);
    clear_beyond(p, w->end, mesh->positions);
    shift_rows(p, w, (uint32_t)vertices, triangles);
    set_planes(p, w, &slab);
    return st == CW_OK ? sink.take(sink.user, &slab, err) : st;
}

static cw_status write_slabs(cwi_plan *p, const cw_extract_desc *d, size_t triangles,
                             cw_slab_sink sink, cw_error *err)
{
    const cw_extract_counts most = largest_slab(p, triangles);
    cw_mesh mesh;
    p->counts.bytes =
        cwi_extract_mesh_bytes(&most, false) + most.vertices + cwi_grid_bytes(&p->grid);
    cw_status st = cwi_extract_check_limits(d, &p->counts, err);
    if (st == CW_OK)
        st = cwi_mesh_alloc(&mesh, most.vertices, most.triangles, false, err);
    if (st != CW_OK)
        return st;
    uint8_t *seam = cwi_alloc_array(most.vertices, 1);
    if (!seam)
        st = cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for %zu vertices", most.vertices);
    memcpy(mesh.affine, p->grid.volume.affine, sizeof mesh.affine);
    cwi_writing w = {.plan = p,
                     .emission = cwi_make_emission(&p->grid.volume, d->simple_topology),
                     .sink = cwi_make_sink(&p->grid.volume, p->grid.invert, &mesh),
                     .triangles = mesh.triangles};
    for (; w.begin + 1 < p->grid.rows_z && st == CW_OK; w.begin = w.end) {
        w.end = end_of_slab(p, w.begin, triangles);
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
        st = seam ? sink.take(sink.user, &slab, err)
                  : cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for %zu vertices",
                             mesh.vertex_count);
    }
    cwi_free(seam);
    cw_mesh_free(&mesh);
    return st;
}

cw_status cw_extract_slabs(const cw_volume *volume, const cw_extract_desc *desc,
                           size_t triangles, cw_slab_sink sink, cw_extract_counts *counts,
                           cw_error *err)
{
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
