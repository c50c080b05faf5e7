#include <cubewright/extract.h>

#include "core/geometry/affine.h"
#include "core/base/parallel.h"
#include "core/base/memory.h"
#include "core/mesh/mesh.h"
#include "core/base/status.h"
#include "core/volume/volume.h"
#include "extract/cases/case_tables.h"
#include "extract/irregular/cell_surface.h"
#include "extract/dense/edge_crossing.h"
#include "extract/common/extract_limits.h"
#include "extract/common/field_normals.h"
#include "extract/dense/dense_plan.h"
#include "extract/snap/snap.h"
#include "extract/sparse/sparse_extract.h"

#include <math.h>
#include <string.h>

typedef cwi_plan plan;

static cw_status check_snap(const cw_extract_desc *d, cw_error *err)
{
    if (d->snap >= 0 && d->snap <= CW_EXTRACT_MAX_SNAP)
        return CW_OK;
    return cw_fail(err, CW_ERR_ARGUMENT,
                   "snap is a fraction of an edge from 0 (off) to %g, not %g",
                   CW_EXTRACT_MAX_SNAP, d->snap);
}

static void count_layer(void *context, size_t k)
{
    plan *p = context;
    p->engine->count_layer(&p->grid, k, p->rows);
}

/* First numbers within a layer become those within the mesh. */
static void number_layer(void *context, size_t k)
{
    plan *p = context;
    const size_t rows = p->grid.rows_y;
    for (cwi_row *row = p->rows + k * rows; row < p->rows + (k + 1) * rows; row++) {
        for (int kind = 0; kind < 4; kind++)
            row->first[kind] += (uint32_t)p->grid.layers[k].vertices;
        row->triangle += p->grid.layers[k].triangles;
    }
}

static cw_status number_rows(plan *p, int threads, cw_error *err)
{
    const cwi_grid *g = &p->grid;
    size_t v = 0, t = 0;
    for (size_t k = 0; k < g->rows_z; k++) {
        cwi_layer *layer = &g->layers[k];
        const size_t vertices = layer->vertices, triangles = layer->triangles;
        layer->vertices = v; /* from now on: before the layer */
        layer->triangles = t;
        v += vertices;
        t += triangles;
    }
    p->rows[g->rows] = (cwi_row){.first = {(uint32_t)v}, .triangle = t};
    p->counts.vertices = v;
    p->counts.triangles = t;
    if (v > UINT32_MAX)
        return cw_fail(err, CW_ERR_LIMIT, "the surface has %zu vertices; a mesh holds %u", v,
                       UINT32_MAX);
    return cwi_each_layer(g->rows_z, g->rows_y * g->words * 64, threads, &(cw_progress){0},
                          "numbering", number_layer, p, err);
}

cw_status cwi_plan_count(plan *p, int threads, const cw_progress *progress, cw_error *err)
{
    const cwi_grid *g = &p->grid;
    if (!p->rows)
        p->rows = cwi_alloc_large(g->rows + 1, sizeof *p->rows);
    if (!p->rows)
        return cw_fail(err, CW_ERR_NO_MEMORY, "no memory for %zu rows", g->rows);
    cw_status st = cwi_each_layer(g->rows_z, g->rows_y * g->words * 64, threads, progress,
                                  "counting", count_layer, p, err);
    return st == CW_OK ? number_rows(p, threads, err) : st;
}

static cw_status init_plan(plan *p, const cwi_engine *engine, const cw_volume *volume,
                           cw_error *err)
{
    memset(p, 0, sizeof *p);
    p->engine = engine;
    return volume->sparse || volume->cells
               ? cw_volume_select(volume, 0, 0, &p->grid.volume, err)
               : cwi_grid_init(&p->grid, volume, err);
}

/* Sparse and irregular grids are extracted at one go; mesh NULL: counted. */
static bool is_dense(const plan *p)
{
    return !p->grid.volume.sparse && !p->grid.volume.cells;
}

static cw_status extract_at_once(plan *p, const cw_extract_desc *d, cw_mesh *mesh,
                                 cw_error *err)
{
    const cw_volume *v = &p->grid.volume;
    memset(&p->counts, 0, sizeof p->counts);
    return v->cells ? cwi_cells_extract(v, d, mesh, &p->counts, err)
                    : cwi_extract_sparse(p->engine, v, d, mesh, &p->counts, err);
}

void cwi_plan_free(plan *p)
{
    cwi_grid_free(&p->grid);
    cwi_octree_free(&p->tree);
    cwi_free(p->rows);
    cw_mesh_free(&p->spare);
}

/* Everything that is known of the surface before it is made. */
static cw_status make_plan(plan *p, const cw_extract_desc *d, cw_error *err)
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
    const cwi_grid *g = &p->grid;
    st = cwi_plan_count(p, d->threads, &d->progress, err);
    if (st == CW_OK)
        st = cwi_grid_border_loops(&p->grid, &p->counts.border_loops, err);
    p->counts.bytes = cwi_extract_mesh_bytes(&p->counts, !d->no_normals) +
                      cwi_grid_bytes(&p->grid) + cwi_octree_bytes(&p->tree);
    if (d->snap > 0)
        p->counts.bytes += cwi_snap_bytes(g, p->counts.vertices, p->counts.triangles);
    return st == CW_OK ? cwi_extract_check_limits(d, &p->counts, err) : st;
}

cwi_vertex_sink cwi_make_sink(const cw_volume *v, bool invert, cw_mesh *mesh)
{
    cwi_vertex_sink sink = {
        .positions = mesh->positions, .normals = mesh->normals, .grid = v, .diagonal = true};
    cwi_outward(v, invert, sink.cofactor);
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++)
            sink.affine[r][c] = v->affine[r][c];
        sink.diagonal =
            sink.diagonal && v->affine[r][(r + 1) % 3] == 0 && v->affine[r][(r + 2) % 3] == 0;
        sink.centre[r] = 0.5 * (cwi_coordinate(v, r, 0, 0) +
                                cwi_coordinate(v, r, (ptrdiff_t)v->dim[r] - 1, 0));
    }
    for (int a = 0; a < 3; a++) {
        double square = 0;
        for (int r = 0; r < 3; r++)
            square += sink.cofactor[r][a] * sink.cofactor[r][a];
        for (int r = 0; r < 3; r++) {
            const double n = sink.cofactor[r][a] / sqrt(square) * (invert ? 1 : -1);
            sink.cap[a][0][r] = (float)-n;
            sink.cap[a][1][r] = (float)n;
        }
    }
    cwi_affine_apply(v->affine[0], sink.centre, mesh->origin);
    return sink;
}

/* A mirroring affine turns triangles inside out: two corners change places. */
static void turn_triangles(const uint8_t *from, int count, bool flip, uint8_t *to)
{
    for (int n = 0; n < 3 * count; n++)
        to[n] = from[flip && n % 3 ? n - n % 3 + 3 - n % 3 : n];
}

cwi_emission cwi_make_emission(const cw_volume *v, bool simple)
{
    const bool flip = cwi_affine_determinant(v->affine[0]) < 0;
    cwi_emission emission = {.flip = flip};
    for (unsigned c = 0; c < 256; c++) {
        cwi_case_emission *of = &emission.of_case[c];
        turn_triangles(cwi_case_triangles[c], cwi_case_count[c], flip, of->edge);
        of->edges = simple || !cwi_case_is_ambiguous[c] ? 3 * cwi_case_count[c] : 0;
        for (int n = 0; n < CWI_EDGE_ROWS; n++)
            of->crossed[n] = cwi_edge_is_crossed(c, cwi_row_edge(n));
    }
    for (int n = 0; n < CWI_CASE_CONFIGS; n++) {
        const cwi_config *config = &cwi_configs[n];
        const int count = config->vertex_count ? 0 : config->triangle_count;
        turn_triangles(config->triangles, count, flip, emission.config_edge[n]);
        emission.config_edges[n] = (uint8_t)(3 * count);
    }
    return emission;
}

/* Layers that a thread writes at a time: many at first, as two shares read some samples both;
 * few at last, so that no thread waits for long. */
enum { LARGE_SHARE = 32, SMALL_SHARE = 8 };

/* Layers of cells from begin to end, and the layer of samples that ends them. */
typedef struct writing {
    const plan *plan;
    size_t begin, end, large; /* large: so many shares are */
    cwi_emission emission;
    cwi_vertex_sink sink;
    uint32_t *triangles;
} writing;

static size_t begin_of_share(const writing *w, size_t share)
{
    const size_t large = share < w->large ? share : w->large;
    return w->begin + large * LARGE_SHARE + (share - large) * SMALL_SHARE;
}

static void write_share(void *context, size_t share)
{
    writing *w = context;
    const size_t begin = begin_of_share(w, share), end = begin_of_share(w, share + 1);
    const bool last = end >= w->end;
    w->plan->engine->write_layers(&w->plan->grid, begin, last ? w->end + 1 : end,
                                  last ? w->end : end, w->plan->rows, &w->emission, &w->sink,
                                  w->triangles);
}

static cw_status write_layers(writing *w, const cw_extract_desc *d, cw_error *err)
{
    const cwi_grid *g = &w->plan->grid;
    const size_t layers = w->end - w->begin, threads = (size_t)cwi_threads(d->threads);
    /* two for each thread are left for small ones */
    const size_t large = layers / LARGE_SHARE;
    w->large = large > 2 * threads ? large - 2 * threads : 0;
    const size_t rest = layers - w->large * LARGE_SHARE;
    return cwi_each_layer(w->large + (rest + SMALL_SHARE - 1) / SMALL_SHARE,
                          SMALL_SHARE * g->rows_y * g->words * 64, d->threads, &d->progress,
                          "marching", write_share, w, err);
}

/* On a rectilinear grid differences are not those of neighbours alone. */
static cw_status shade_by_coordinates(const plan *p, const cw_extract_desc *d, cw_mesh *mesh,
                                      cw_error *err)
{
    const cw_normals_desc desc = {.inside_is_low = d->inside_is_low, .threads = d->threads};
    return cwi_is_rectilinear(&p->grid.volume) && !d->no_normals
               ? cw_extract_normals(&p->grid.volume, &desc, mesh, err)
               : CW_OK;
}

static cw_status write_mesh(plan *p, const cw_extract_desc *d, cw_mesh *mesh, cw_error *err)
{
    const bool normals = !d->no_normals && !cwi_is_rectilinear(&p->grid.volume);
    *mesh = p->spare;
    p->spare = (cw_mesh){0};
    cw_status st = cwi_mesh_renew(mesh, p->counts.vertices, p->counts.triangles, normals, err);
    if (st != CW_OK)
        return st;
    writing w = {.plan = p,
                 .end = p->grid.rows_z - 1,
                 .emission = cwi_make_emission(&p->grid.volume, d->simple_topology),
                 .sink = cwi_make_sink(&p->grid.volume, p->grid.invert, mesh),
                 .triangles = mesh->triangles};
    st = write_layers(&w, d, err);
    if (st == CW_OK && w.sink.missing)
        st = cwi_mend_normals(mesh, cwi_voxel_scale(&p->grid.volume), err);
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

static cw_status extract(plan *p, const cw_extract_desc *desc, cw_mesh *mesh,
                         cw_extract_counts *counts, cw_error *err)
{
    const cw_extract_desc d = desc ? *desc : (cw_extract_desc){0};
    memset(mesh, 0, sizeof *mesh);
    cw_status st = is_dense(p) ? make_plan(p, &d, err) : extract_at_once(p, &d, mesh, err);
    if (st == CW_OK && p->counts.triangles && is_dense(p))
        st = write_mesh(p, &d, mesh, err);
    if (st == CW_OK && counts)
        *counts = p->counts;
    if (st != CW_OK)
        cw_mesh_free(mesh);
    return st;
}

/* --- a slab at a time -------------------------------------------------------------------- */

enum { LEAST_LAYERS = 16 };

static size_t triangles_before(const plan *p, size_t layer)
{
    return p->grid.layers[layer].triangles;
}

static size_t vertices_before(const plan *p, size_t layer)
{
    return layer < p->grid.rows_z ? p->grid.layers[layer].vertices : p->counts.vertices;
}

/* Where the slab that begins with a layer ends. What is left behind it is a slab of half the
 * size at least. */
static size_t end_of_slab(const plan *p, size_t begin, size_t triangles)
{
    const size_t last = p->grid.rows_z - 1;
    size_t end = begin + LEAST_LAYERS;
    while (end < last && triangles_before(p, end) - triangles_before(p, begin) < triangles)
        end++;
    return end >= last || p->counts.triangles - triangles_before(p, end) < triangles / 2 ? last
                                                                                         : end;
}

/* Vertices and triangles of the largest slab. */
static cw_extract_counts largest_slab(const plan *p, size_t triangles)
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

/* Numbers in the slab become those in the mesh, or, negative, the other way round. */
static void shift_rows(plan *p, const writing *w, uint32_t vertices, size_t triangles)
{
    const size_t rows = p->grid.rows_y;
    for (cwi_row *row = p->rows + w->begin * rows; row <= p->rows + (w->end + 1) * rows;
         row++) {
        for (int kind = 0; kind < 4; kind++)
            row->first[kind] += vertices;
        row->triangle += triangles;
    }
}

/* Crossings of edges that lie in the plane of a layer of samples. */
static void mark_seam(const plan *p, size_t layer, uint8_t mark, uint8_t *seam)
{
    const cwi_row *row = p->rows + layer * p->grid.rows_y;
    for (size_t j = 0; j < p->grid.rows_y; j++)
        memset(seam + row[j].first[0], mark, row[j].first[2] - row[j].first[0]);
}

/* What stands in the last layer, but belongs to the next slab, was written in part. */
static void clear_beyond(const plan *p, size_t layer, float *positions)
{
    const cwi_row *row = p->rows + layer * p->grid.rows_y;
    for (size_t j = 0; j < p->grid.rows_y; j++)
        memset(positions + 3 * (size_t)row[j].first[2], 0,
               (size_t)(row[j + 1].first[0] - row[j].first[2]) * 3 * sizeof *positions);
}

/* The height of a share of the way from a layer of samples to the next, from the origin. */
static double height_of(const writing *w, size_t layer, double share)
{
    const cw_volume *v = &w->plan->grid.volume;
    return cwi_coordinate(v, 2, (ptrdiff_t)layer - 1, share) - w->sink.centre[2];
}

/* Vertices are kept CWI_NUDGE away from planes; half of that allows for rounding. */
static void set_planes(const plan *p, const writing *w, cw_slab *slab)
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

static cw_status write_slab(plan *p, writing *w, const cw_extract_desc *d, cw_mesh *mesh,
                            uint8_t *seam, cw_slab_sink sink, cw_error *err)
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
    cw_status st = write_layers(w, d, err);
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

static cw_status write_slabs(plan *p, const cw_extract_desc *d, size_t triangles,
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
        st = cw_fail(err, CW_ERR_NO_MEMORY, "no memory for %zu vertices", most.vertices);
    memcpy(mesh.affine, p->grid.volume.affine, sizeof mesh.affine);
    writing w = {.plan = p,
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

static cw_status give_whole(plan *p, const cw_extract_desc *d, cw_slab_sink sink, cw_error *err)
{
    cw_mesh mesh = {0};
    uint8_t *seam = NULL;
    cw_slab slab = {.mesh = &mesh, .low = -INFINITY, .high = INFINITY, .last = true};
    cw_status st = extract_at_once(p, d, &mesh, err);
    if (st == CW_OK && mesh.triangle_count) {
        slab.seam = seam = cwi_alloc_zeroed(mesh.vertex_count, 1);
        slab.triangles = mesh.triangle_count;
        st = seam ? sink.take(sink.user, &slab, err)
                  : cw_fail(err, CW_ERR_NO_MEMORY, "no memory for %zu vertices",
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
    plan p = {0};
    d.no_normals = true;
    d.max_bytes = 0; /* is for slabs, not for all of it */
    cw_status st = d.snap == 0
                       ? init_plan(&p, cwi_engine_best(), volume, err)
                       : cw_fail(err, CW_ERR_ARGUMENT,
                                 "snap is %g; a surface made by slabs is not snapped", d.snap);
    if (st == CW_OK && is_dense(&p))
        st = make_plan(&p, &d, err);
    d.max_bytes = max_bytes;
    if (st == CW_OK && !is_dense(&p))
        st = give_whole(&p, &d, sink, err);
    else if (st == CW_OK && p.counts.triangles)
        st = write_slabs(&p, &d, triangles, sink, err);
    if (st == CW_OK && counts)
        *counts = p.counts;
    cwi_plan_free(&p);
    return st;
}

static cw_status predict(plan *p, const cw_extract_desc *desc, cw_extract_counts *counts,
                         cw_error *err)
{
    const cw_extract_desc d = desc ? *desc : (cw_extract_desc){0};
    cw_status st = is_dense(p) ? make_plan(p, &d, err) : extract_at_once(p, &d, NULL, err);
    if (st == CW_OK)
        *counts = p->counts;
    return st;
}

cw_status cwi_extract_with(const cwi_engine *engine, const cw_volume *volume,
                           const cw_extract_desc *desc, cw_mesh *mesh,
                           cw_extract_counts *counts, cw_error *err)
{
    plan p;
    memset(mesh, 0, sizeof *mesh);
    cw_status st = init_plan(&p, engine, volume, err);
    if (st == CW_OK)
        st = extract(&p, desc, mesh, counts, err);
    cwi_plan_free(&p);
    return st;
}

cw_status cw_extract(const cw_volume *volume, const cw_extract_desc *desc, cw_mesh *mesh,
                     cw_extract_counts *counts, cw_error *err)
{
    return cwi_extract_with(cwi_engine_best(), volume, desc, mesh, counts, err);
}

cw_status cw_extract_predict(const cw_volume *volume, const cw_extract_desc *desc,
                             cw_extract_counts *counts, cw_error *err)
{
    plan p;
    cw_status st = init_plan(&p, cwi_engine_best(), volume, err);
    if (st == CW_OK)
        st = predict(&p, desc, counts, err);
    cwi_plan_free(&p);
    return st;
}

cw_status cwi_extractor_new_with(const cwi_engine *engine, size_t leaf_bytes,
                                 const cw_volume *volume, cw_extractor **out, cw_error *err)
{
    cw_extractor *e = cwi_alloc_array(1, sizeof *e);
    *out = NULL;
    if (!e)
        return cw_fail(err, CW_ERR_NO_MEMORY, "no memory for an extractor");
    cw_status st = init_plan(e, engine, volume, err);
    if (st == CW_OK && is_dense(e))
        st = cwi_octree_init(&e->tree, &e->grid, err);
    e->tree.leaf_bytes = leaf_bytes;
    if (st == CW_OK)
        *out = e;
    else
        cw_extractor_free(e);
    return st;
}

cw_status cw_extractor_new(const cw_volume *volume, cw_extractor **out, cw_error *err)
{
    return cwi_extractor_new_with(cwi_engine_best(), CWI_LEAF_BYTES, volume, out, err);
}

void cw_extractor_free(cw_extractor *e)
{
    if (e)
        cwi_plan_free(e);
    cwi_free(e);
}

cw_status cw_extractor_extract(cw_extractor *e, const cw_extract_desc *desc, cw_mesh *mesh,
                               cw_extract_counts *counts, cw_error *err)
{
    return extract(e, desc, mesh, counts, err);
}

void cw_extractor_recycle(cw_extractor *e, cw_mesh *mesh)
{
    if (mesh->positions) {
        cw_mesh_free(&e->spare);
        e->spare = *mesh;
        *mesh = (cw_mesh){0};
    }
    cw_mesh_free(mesh);
}

cw_status cw_extractor_predict(cw_extractor *e, const cw_extract_desc *desc,
                               cw_extract_counts *counts, cw_error *err)
{
    return predict(e, desc, counts, err);
}
