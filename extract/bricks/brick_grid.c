/* Extracts the surface in one brick on a small grid. */
#include "extract/bricks/brick_grid.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/mesh.h"
#include "core/volume/volume.h"
#include "extract/dense/crossed_edges.h"

#include <string.h>

/* Voxels before the one where the brick's first cell begins, and after the one where its last cell
 * ends: a ring of cells, and the samples that place a vertex of theirs on a cubic. */
enum { HALO = 3 };

void cwi_brick_job_init(cwi_brick_job *job, const cwi_plan *whole, const cw_extract_desc *desc)
{
    cw_mesh mesh = {0};
    *job = (cwi_brick_job){.whole = whole, .desc = desc, .volume = whole->grid.volume};
    job->emission = cwi_make_emission(&job->volume, desc->simple_topology);
    job->sink = cwi_make_sink(&job->volume, whole->grid.invert, &mesh);
    memcpy(job->origin, mesh.origin, sizeof job->origin);
    cwi_shading_set_field(&job->shading, &job->volume, whole->grid.invert);
}

/* --- the small grid ----------------------------------------------------------------------- */

/* Finds the grid's place in the volume: padded sample 0 of the grid is first_voxel - 1. At the
 * volume's border both are padding; elsewhere the halo keeps the brick away from it. */
static void find_shape(const cw_volume *v, const size_t at[3], cwi_brick_shape *shape,
                       size_t first_voxel[3])
{
    for (int a = 0; a < 3; a++) {
        const size_t cell = at[a] * CW_EXTRACT_BRICK, cells = v->dim[a] + 1 - cell;
        const size_t low = cell > HALO + 1 ? cell - HALO - 1 : 0;
        const size_t end = cell + CW_EXTRACT_BRICK + HALO;
        first_voxel[a] = low;
        shape->dim[a] = (end < v->dim[a] ? end : v->dim[a]) - low;
        shape->first[a] = cell - low;
        shape->cells[a] = cells < CW_EXTRACT_BRICK ? cells : CW_EXTRACT_BRICK;
    }
}

static cw_volume make_view(const cw_volume *v, const cwi_brick_grid *b)
{
    const size_t *first = b->first_voxel;
    cw_volume view = *v;
    view.data = cwi_voxel_address(v, first[0], first[1], first[2]);
    memcpy(view.dim, b->shape.dim, sizeof view.dim);
    for (int a = 0; a < 3 && cwi_is_rectilinear(v); a++)
        view.coordinates[a] += first[a];
    return view;
}

static void free_planes(cwi_brick_grid *b)
{
    b->plan.grid.live = b->plan.grid.window = NULL; /* they are among those below */
    cwi_plan_free(&b->plan);
    for (int n = 0; n < CWI_WINDOWS; n++) {
        cwi_free(b->live[n]);
        cwi_free(b->window[n]);
        b->live[n] = b->window[n] = NULL;
    }
    cwi_free(b->own_rows);
    b->own_rows = NULL;
    b->plan = (cwi_plan){0};
}

void cwi_brick_grid_free(cwi_brick_grid *b)
{
    free_planes(b);
    cw_mesh_free(&b->around);
}

/* Allocates planes for bricks of this shape. */
static cw_status alloc_planes(cwi_brick_grid *b, const cwi_brick_job *job,
                              const cw_volume *view, cw_error *err)
{
    cwi_bit_grid *g = &b->plan.grid;
    free_planes(b);
    b->plan.engine = job->whole->engine;
    cw_status st = cwi_grid_init(g, view, err);
    if (st != CW_OK)
        return st;
    g->find_values = view->has_nodata;
    if (g->find_values)
        g->has = cwi_grid_plane(g);
    bool all = !g->find_values || g->has;
    for (int n = 0; n < CWI_WINDOWS && all; n++) {
        b->live[n] = cwi_grid_plane(g);
        b->window[n] = cwi_alloc_array(4 * g->rows, sizeof *b->window[n]);
        all = b->live[n] && b->window[n];
    }
    b->own_rows = cwi_alloc_array(g->rows, sizeof *b->own_rows);
    if (!all || !b->own_rows)
        return cwi_fail_memory(err);
    memset(g->inside, 0, g->rows * g->words * sizeof *g->inside);
    if (g->has)
        memset(g->has, 0, g->rows * g->words * sizeof *g->has);
    g->all_classified = true;
    return CW_OK;
}

/* Returns the live cells of the whole volume in row (j, k) of the small grid. */
static uint64_t live_cells_of_whole(const cwi_brick_grid *b, const cwi_bit_grid *whole,
                                    size_t j, size_t k)
{
    const size_t first = b->first_voxel[0], w = first / 64;
    const size_t row = j + b->first_voxel[1], layer = k + b->first_voxel[2];
    const uint64_t cells = cwi_live_cells(whole, row, layer, w);
    return first % 64 == 0 || w + 1 == whole->words
               ? cells >> first % 64
               : cells >> first % 64 | cwi_live_cells(whole, row, layer, w + 1)
                                           << (64 - first % 64);
}

/* Finds the cells that count, and the edges around them. ring: the number of cells around */
static void find_window(cwi_brick_grid *b, const cwi_bit_grid *whole, int window, size_t ring)
{
    cwi_bit_grid *g = &b->plan.grid;
    size_t low[3], end[3];
    for (int a = 0; a < 3; a++) {
        const size_t after = b->shape.first[a] + b->shape.cells[a] + ring;
        low[a] = b->shape.first[a] > ring ? b->shape.first[a] - ring : 0;
        end[a] = after < b->shape.dim[a] + 1 ? after : b->shape.dim[a] + 1;
    }
    g->live = b->live[window];
    memset(g->live, 0, g->rows * sizeof *g->live);
    for (size_t k = low[2]; k < end[2]; k++)
        for (size_t j = low[1]; j < end[1]; j++) {
            const uint64_t own = cwi_bits_between(0, low[0], end[0]);
            g->live[k * g->rows_y + j] =
                whole->live ? own & live_cells_of_whole(b, whole, j, k) : own;
        }
    g->window = NULL;
    cwi_find_window(g, b->window[window]);
}

/* Returns true if 64 voxels can be read from each of the grid's rows on: they end in the row, or
 * rows follow each other without gaps, and the last one ends in the volume. */
static bool can_read_words(const cwi_brick_grid *b, const cw_volume *v)
{
    size_t after = b->first_voxel[0] + 64, place = 1;
    const ptrdiff_t voxel = (ptrdiff_t)cw_type_size(v->type),
                    row = voxel * (ptrdiff_t)v->dim[0];
    if (v->stride[0] != voxel)
        return false;
    if (after <= v->dim[0])
        return true;
    if (v->stride[1] != row || v->stride[2] != row * (ptrdiff_t)v->dim[1])
        return false;
    for (int a = 1; a < 3; a++) {
        place *= v->dim[a - 1];
        after += (b->first_voxel[a] + b->shape.dim[a] - 1) * place;
    }
    return after <= place * v->dim[2];
}

/* Points the grid at a brick, in planes of its shape. */
static cw_status place_grid(cwi_brick_grid *b, const cwi_brick_job *job, const size_t at[3],
                            cw_error *err)
{
    const cwi_bit_grid *whole = &job->whole->grid;
    cwi_bit_grid *g = &b->plan.grid;
    cwi_brick_shape shape;
    find_shape(&job->volume, at, &shape, b->first_voxel);
    const bool same = b->own_rows && memcmp(&shape, &b->shape, sizeof shape) == 0;
    b->shape = shape;
    const cw_volume view = make_view(&job->volume, b);
    cw_status st = same ? CW_OK : alloc_planes(b, job, &view, err);
    if (st != CW_OK)
        return st;
    g->volume = view;
    g->reads_whole_words = can_read_words(b, &job->volume);
    g->level = whole->level;
    g->strict = whole->strict;
    g->invert = whole->invert;
    g->simple = whole->simple;
    g->cubic = whole->cubic;
    if (!same || whole->live) {
        find_window(b, whole, CWI_OWN_CELLS, 0);
        find_window(b, whole, CWI_CELLS_AROUND, 1);
    }
    return CW_OK;
}

/* Finds the samples along an axis whose side matters: the corners of the ring's cells. Where some
 * voxel has no value, it also matters which samples of the halo have one. */
static void find_corners(const cwi_brick_grid *b, int axis, size_t *low, size_t *end)
{
    const cwi_brick_shape *s = &b->shape;
    const size_t after = s->first[axis] + s->cells[axis] + 2;
    *low = 1;
    *end = s->dim[axis] + 1;
    if (b->plan.grid.find_values)
        return;
    *low = s->first[axis] > 2 ? s->first[axis] - 1 : 1;
    *end = after < *end ? after : *end;
}

cw_status cwi_brick_classify(cwi_brick_grid *b, const cwi_brick_job *job, const size_t at[3],
                             unsigned *sides, cw_error *err)
{
    bool in = false, out = false;
    size_t low[3], end[3];
    const cw_status st = place_grid(b, job, at, err);
    for (int a = 1; a < 3; a++)
        find_corners(b, a, &low[a], &end[a]);
    for (size_t k = low[2]; k < end[2] && st == CW_OK; k++)
        b->plan.engine->classify_rows(&b->plan.grid, low[1], k, end[1] - low[1], &in, &out);
    *sides = (in ? CWI_INSIDE : 0) | (out ? CWI_OUTSIDE : 0);
    return st;
}

/* --- the surface -------------------------------------------------------------------------- */

cw_status cwi_brick_count(cwi_brick_grid *b, int window, cw_error *err)
{
    b->plan.grid.live = b->live[window];
    b->plan.grid.window = b->window[window];
    return cwi_plan_count(&b->plan, 1, &(cw_progress){0}, err);
}

bool cwi_brick_write(const cwi_brick_grid *b, const cwi_brick_job *job, bool normals,
                     cw_mesh *mesh)
{
    const cwi_bit_grid *g = &b->plan.grid;
    const cwi_row_span all = {.end = g->rows_z, .cells = g->rows_z - 1, .row_end = g->rows_y};
    cwi_vertex_sink sink = job->sink;
    sink.positions = mesh->positions;
    sink.normals = normals ? mesh->normals : NULL;
    sink.grid = &g->volume;
    for (int a = 0; a < 3 && !cwi_is_rectilinear(&g->volume); a++)
        sink.centre[a] -= (double)b->first_voxel[a];
    b->plan.engine->write_span(g, &all, b->plan.rows, &job->emission, &sink, mesh->triangles);
    return sink.missing;
}

/* Computes normals on a rectilinear grid from the vertices' positions. */
static void shade_by_coordinates(const cwi_brick_job *job, cw_mesh *mesh)
{
    cwi_shading shading = job->shading;
    shading.mesh = mesh;
    shading.normals = mesh->normals;
    memset(mesh->normals, 0, 3 * mesh->vertex_count * sizeof *mesh->normals);
    for (size_t v = 0; v < mesh->vertex_count; v++)
        cwi_shade_vertex(&shading, v);
}

static cw_status write_brick(cwi_brick_grid *b, const cwi_brick_job *job, cw_mesh *mesh,
                             cw_error *err)
{
    const bool by_coordinates = cwi_is_rectilinear(&job->volume);
    cw_status st = cwi_mesh_renew(mesh, b->plan.counts.vertices, b->plan.counts.triangles,
                                  !job->desc->no_normals, err);
    if (st != CW_OK)
        return st;
    memcpy(mesh->origin, job->origin, sizeof mesh->origin);
    memcpy(mesh->affine, job->volume.affine, sizeof mesh->affine);
    const bool missing = cwi_brick_write(b, job, !by_coordinates, mesh);
    if (job->desc->no_normals)
        return CW_OK;
    if (by_coordinates)
        shade_by_coordinates(job, mesh);
    return missing || by_coordinates ? cwi_brick_repair_normals(b, job, mesh, err) : CW_OK;
}

cw_status cwi_brick_extract(cwi_brick_grid *b, const cwi_brick_job *job, cw_mesh *mesh,
                            bool *found, cw_error *err)
{
    const cw_status st = cwi_brick_count(b, CWI_OWN_CELLS, err);
    *found = st == CW_OK && b->plan.counts.triangles;
    return *found ? write_brick(b, job, mesh, err) : st;
}
