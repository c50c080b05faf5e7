/* Merges clusters of crossings. Where several edges are crossed close to the sample at which
 * they meet, the triangles between the crossings are needles. Such crossings, as far as sides
 * of triangles join them, are a cluster. It becomes one vertex in their middle, where the field
 * has the isovalue.
 *
 * The triangles around a cluster are replaced by a cone over their rim. That changes no
 * topology if they form a disc, and no vertex of the rim is in the cluster: a disc is replaced
 * by a disc. It is done only when none of the new triangles is turned over, none is worse than
 * the worst old one, and none crosses another. Cases too close to decide stay unchanged.
 *
 * All triangles of a cluster are in the eight cells around its sample, and no vertex leaves
 * them by more than half a voxel, so all possible obstacles are within two cells. Clusters
 * three layers apart are independent: every third layer is snapped at the same time. */
#include "extract/snap/snap.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/geometry/triangle_separation.h"
#include "core/geometry/vec3.h"
#include "extract/dense/crossed_edges.h"
#include "extract/snap/snap_cluster.h"

#include <math.h>
#include <string.h>

enum { EVERY = 3 /* layers */ };

/* Flags in a vertex's sample: the cluster has been processed; it has been snapped. */
#define SEEN    (UINT64_C(1) << 63)
#define SNAPPED (UINT64_C(1) << 62)
#define SAMPLE  (SNAPPED - 1)

/* Distances by which a layer's clusters were moved. */
typedef struct layer_sums {
    size_t count;
    double moved[2], error[2], error_sum[2]; /* mm, voxels */
} layer_sums;

/* Data that the steps work on. */
typedef struct snap_run {
    cwi_snapping s;
    layer_sums *sums;
    size_t colour; /* the first layer of a step that takes every third */
} snap_run;

/* ---- vertices, samples and cells -------------------------------------------------------- */

/* Returns the edges with cells on all sides: vertices on other edges are on the mesh's
 * border. */
static uint64_t inner_edges(const cwi_bit_grid *g, int axis, size_t j, size_t k, size_t w)
{
    if (!g->live)
        return ~UINT64_C(0);
    const size_t dj = axis != 1, dk = axis != 2;
    const uint64_t here = cwi_live_cells(g, j, k, w) & cwi_live_cells(g, j - dj, k - dk, w);
    if (axis == 0)
        return here & cwi_live_cells(g, j - 1, k, w) & cwi_live_cells(g, j, k - 1, w);
    const uint64_t cells_before =
        w ? cwi_live_cells(g, j, k, w - 1) & cwi_live_cells(g, j - dj, k - dk, w - 1) : 0;
    return here & (here << 1 | cells_before >> 63);
}

/* Stores in into[], until cells are known, a vertex's sample along x, and whether its edge is
 * an x-edge. */
static void mark_vertex(cwi_snapping *s, size_t at[3], int axis, uint32_t v, bool inner)
{
    cwi_vertex_index *index = &s->indices[v];
    cwi_to_index(s, cwi_mesh_position(s, v), index->x);
    const double t = index->x[axis] - (double)at[axis];
    s->merged_into[v] = (uint32_t)at[0] << 1 | (axis == 0);
    index->near_sample = 0;
    if (!inner || (t > s->snap_distance && 1 - t > s->snap_distance))
        return;
    size_t to[3] = {at[0], at[1], at[2]};
    to[axis] += t > s->snap_distance;
    index->near_sample = cwi_sample_number(s->grid, to[0], to[1], to[2]);
}

static void mark_row(cwi_snapping *s, size_t j, size_t k, const cwi_row *row)
{
    const cwi_bit_grid *g = s->grid;
    const uint64_t *busy = cwi_grid_busy(g, k * g->rows_y + j);
    uint32_t number[3] = {row->first[0], row->first[1], row->first[2]};
    for (size_t w = cwi_next_marked_word(busy, 0, g->words); w < g->words;
         w = cwi_next_marked_word(busy, w + 1, g->words))
        for (int axis = 0; axis < 3; axis++) {
            const uint64_t inner = inner_edges(g, axis, j, k, w);
            for (uint64_t e = cwi_edge_vertices(g, axis, j, k, w); e; e &= e - 1) {
                size_t at[3] = {64 * w + (size_t)__builtin_ctzll(e), j, k};
                mark_vertex(s, at, axis, number[axis]++, (inner & e & -e) != 0);
            }
        }
    for (uint32_t v = row->first[3]; v < row[1].first[0]; v++) {
        cwi_to_index(s, cwi_mesh_position(s, v), s->indices[v].x);
        s->indices[v].near_sample = 0;
        s->merged_into[v] = UINT32_MAX;
    }
}

static void mark_layer(void *context, size_t k)
{
    cwi_snapping *s = &((snap_run *)context)->s;
    for (size_t j = 0; j < s->grid->rows_y; j++) {
        const cwi_row *row = s->rows + k * s->grid->rows_y + j;
        if (row[0].first[0] != row[1].first[0])
            mark_row(s, j, k, row);
    }
}

/* Returns the cell, along x, that a triangle is in. An x-edge decides it, and so do two walls.
 * In a single wall there is only one side, and then a vertex inside the cell. */
static uint32_t cell_of(const cwi_snapping *s, const uint32_t triangle[3])
{
    uint32_t low = UINT32_MAX, high = 0, inner = UINT32_MAX;
    for (int c = 0; c < 3; c++) {
        const uint32_t code = s->merged_into[triangle[c]];
        if (code == UINT32_MAX) {
            inner = triangle[c];
            continue;
        }
        if (code & 1)
            return code >> 1;
        low = code >> 1 < low ? code >> 1 : low;
        high = code >> 1 > high ? code >> 1 : high;
    }
    if (inner == UINT32_MAX || low != high)
        return low;
    return cwi_index(s, inner)[0] < (double)low ? low - 1 : low;
}

/* Finds the cells of a row's triangles, which are in the order of their cells. */
static void find_cells_of_row(const cwi_snapping *s, size_t row)
{
    const size_t first = s->rows[row].triangle, end = s->rows[row + 1].triangle;
    cwi_cell_word *words = s->cells + row * s->grid->words;
    uint32_t count = 0, last = UINT32_MAX;
    for (size_t t = first; t < end; t++) {
        const uint32_t cell = cell_of(s, s->mesh->triangles + 3 * t);
        count += cell != last;
        last = cell;
        words[cell / 64].has |= UINT64_C(1) << cell % 64;
        s->triangle_ends[first + count - 1] = (uint32_t)(t + 1 - first);
    }
    for (size_t w = 1; w < s->grid->words && first < end; w++)
        words[w].cells_before =
            words[w - 1].cells_before + (uint32_t)__builtin_popcountll(words[w - 1].has);
}

static void find_cells(void *context, size_t k)
{
    const cwi_snapping *s = &((snap_run *)context)->s;
    for (size_t r = k * s->grid->rows_y; r < (k + 1) * s->grid->rows_y; r++)
        find_cells_of_row(s, r);
}

static void reset_layer(void *context, size_t k)
{
    cwi_snapping *s = &((snap_run *)context)->s;
    const size_t first = k * s->grid->rows_y, end = first + s->grid->rows_y;
    for (uint32_t v = s->rows[first].first[0]; v < s->rows[end].first[0]; v++)
        s->merged_into[v] = v;
}

/* ---- snapping --------------------------------------------------------------------------- */

/* Sums the members' normals; takes the first one's where they cancel out. */
static void merge_normals(const cwi_snapping *s, const cwi_cluster *c)
{
    float *normals = s->mesh->normals, *to = normals + 3 * (size_t)c->member[0];
    double sum[3] = {0, 0, 0};
    for (int m = 0; m < c->count; m++)
        for (size_t a = 0; a < 3; a++)
            sum[a] += (double)normals[3 * (size_t)c->member[m] + a];
    const double length = cwi_length(sum);
    for (int a = 0; a < 3 && length > 1e-3; a++)
        to[a] = (float)(sum[a] / length);
}

/* Merges a cluster. Triangles with two corners in it get two equal corners: they are gone. */
static void merge_cluster(const cwi_snapping *s, const cwi_cluster *c, const double x[3],
                          const float p[3])
{
    if (s->mesh->normals)
        merge_normals(s, c);
    memcpy(s->indices[c->member[0]].x, x, 3 * sizeof *x);
    memcpy(s->mesh->positions + 3 * (size_t)c->member[0], p, 3 * sizeof *p);
    for (int n = 0; n < c->fan_count; n++) {
        uint32_t *t = s->mesh->triangles + 3 * c->fan[n];
        for (int corner = 0; corner < 3; corner++)
            if (cwi_is_member(c, t[corner]))
                t[corner] = c->member[0];
    }
    for (int m = 0; m < c->count; m++) {
        s->merged_into[c->member[m]] = c->member[0];
        s->indices[c->member[m]].near_sample |= SNAPPED;
    }
}

static void snap_layer(void *context, size_t n)
{
    const snap_run *run = context;
    const cwi_snapping *s = &run->s;
    cwi_cluster c;
    double x[3];
    float p[3];
    const cwi_bit_grid *g = s->grid;
    const size_t k = run->colour + EVERY * n, in_layer = g->rows_y * 64 * g->words;
    const uint64_t first = cwi_sample_number(g, 0, 0, k), end = first + in_layer;
    const uint32_t v_end = s->rows[(k + 1) * g->rows_y].first[0];
    for (uint32_t v = s->rows[(k ? k - 1 : 0) * g->rows_y].first[0]; v < v_end; v++) {
        if (s->indices[v].near_sample < first || s->indices[v].near_sample >= end)
            continue;
        cwi_cluster_find(s, v, &c);
        if (c.count > 1 && cwi_cluster_is_disc(s, &c) && cwi_cluster_position(s, &c, x, p))
            merge_cluster(s, &c, x, p);
        for (int m = 0; m < c.count; m++)
            s->indices[c.member[m]].near_sample |= SEEN;
    }
}

/* ---- errors ----------------------------------------------------------------------------- */

/* The distance of the surface from a vertex that was merged: in the world, and in voxels. */
typedef struct distances {
    const float *from;
    double from_x[3];
    double nearest[2][3];
} distances;

static void start_from(const cwi_snapping *s, uint32_t v, distances *d)
{
    d->from = s->cells_before + 3 * (size_t)v;
    cwi_to_index(s, d->from, d->from_x);
    for (int a = 0; a < 3; a++) {
        d->nearest[0][a] =
            (double)cwi_mesh_position(s, s->merged_into[v])[a] - (double)d->from[a];
        d->nearest[1][a] = cwi_index(s, s->merged_into[v])[a] - d->from_x[a];
    }
}

static void add_to_sums(layer_sums *sums, int unit, double moved, double error)
{
    sums->moved[unit] = fmax(sums->moved[unit], moved);
    sums->error[unit] = fmax(sums->error[unit], error);
    sums->error_sum[unit] += error;
}

/* Returns true if a triangle may be nearer: it cannot be nearer than a box around it. */
static bool may_be_nearer(const cwi_snapping *s, const distances *d, const cwi_triangle *t)
{
    double distance_sq = 0;
    for (int a = 0; a < 3; a++) {
        const double x = t->p[0][a], y = t->p[1][a], z = t->p[2][a];
        const double low = cwi_lesser(cwi_lesser(x, y), z),
                     high = cwi_greater(cwi_greater(x, y), z);
        const double off = cwi_greater(cwi_greater(low, -high), 0);
        distance_sq += off * off;
    }
    return distance_sq < cwi_dot(d->nearest[1], d->nearest[1]) ||
           (s->edge == 0 &&
            distance_sq * s->shrink * s->shrink < cwi_dot(d->nearest[0], d->nearest[0]));
}

static void try_triangle(const cwi_snapping *s, const uint32_t corner[3], distances *d)
{
    cwi_triangle voxels, world;
    for (int c = 0; c < 3; c++)
        for (int a = 0; a < 3; a++)
            voxels.p[c][a] = cwi_index(s, corner[c])[a] - d->from_x[a];
    if (!may_be_nearer(s, d, &voxels))
        return;
    cwi_nearest_of_triangle(&voxels, d->nearest[1]);
    if (s->edge > 0)
        return;
    for (int c = 0; c < 3; c++)
        for (int a = 0; a < 3; a++)
            world.p[c][a] = (double)cwi_mesh_position(s, corner[c])[a] - (double)d->from[a];
    cwi_nearest_of_triangle(&world, d->nearest[0]);
}

static void measure_distances(const cwi_snapping *s, const distances *d, double distance[2])
{
    distance[1] = cwi_length(d->nearest[1]);
    distance[0] = s->edge > 0 ? s->edge * distance[1] : cwi_length(d->nearest[0]);
}

/* Measures how far a merged vertex has moved, and how far the surface is now from its old
 * place. It searches the cells around the vertex's sample: most likely, the triangles that it
 * was merged into are nearest. */
static void measure_vertex(const cwi_snapping *s, uint32_t v, layer_sums *sums)
{
    size_t at[3], triangles[CWI_FAN];
    double moved[2], error[2];
    distances d;
    start_from(s, v, &d);
    measure_distances(s, &d, moved);
    cwi_sample_index(s->grid, s->indices[v].near_sample & SAMPLE, at);
    const int count = cwi_find_triangles(s, at, 1, triangles);
    for (int own = 1; own >= 0; own--)
        for (int n = 0; n < count; n++) {
            const uint32_t *t = s->mesh->triangles + 3 * triangles[n], to = s->merged_into[v];
            if ((t[0] == to || t[1] == to || t[2] == to) == own)
                try_triangle(s, t, &d);
        }
    measure_distances(s, &d, error);
    sums->count++;
    for (int u = 0; u < 2; u++)
        add_to_sums(sums, u, moved[u], error[u]);
}

static void measure_layer(void *context, size_t k)
{
    const snap_run *run = context;
    const cwi_snapping *s = &run->s;
    const size_t first = k * s->grid->rows_y, end = first + s->grid->rows_y;
    for (uint32_t v = s->rows[first].first[0]; v < s->rows[end].first[0]; v++)
        if (s->indices[v].near_sample & SNAPPED)
            measure_vertex(s, v, &run->sums[k]);
}

static void sum_layers(const snap_run *run, cw_snap_counts *counts)
{
    layer_sums all = {0};
    for (size_t k = 0; k < run->s.grid->rows_z; k++) {
        all.count += run->sums[k].count;
        for (int u = 0; u < 2; u++) {
            all.moved[u] = fmax(all.moved[u], run->sums[k].moved[u]);
            all.error[u] = fmax(all.error[u], run->sums[k].error[u]);
            all.error_sum[u] += run->sums[k].error_sum[u];
        }
    }
    const double count = all.count ? (double)all.count : 1;
    *counts = (cw_snap_counts){.vertices = all.count,
                               .max_moved_mm = all.moved[0],
                               .max_moved_voxels = all.moved[1],
                               .max_error_mm = all.error[0],
                               .mean_error_mm = all.error_sum[0] / count,
                               .max_error_voxels = all.error[1],
                               .mean_error_voxels = all.error_sum[1] / count};
}

/* ---- the whole -------------------------------------------------------------------------- */

/* Removes the gaps in the arrays of vertices and triangles. */
static void close_ranks(cwi_snapping *s)
{
    cw_mesh *mesh = s->mesh;
    uint32_t vertices = 0;
    size_t triangles = 0;
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        if (s->merged_into[v] != v)
            continue;
        memmove(mesh->positions + 3 * (size_t)vertices, mesh->positions + 3 * v,
                3 * sizeof *mesh->positions);
        if (mesh->normals)
            memmove(mesh->normals + 3 * (size_t)vertices, mesh->normals + 3 * v,
                    3 * sizeof *mesh->normals);
        s->merged_into[v] = vertices++;
    }
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *from = mesh->triangles + 3 * t;
        if (cwi_is_gone(from))
            continue;
        uint32_t *to = mesh->triangles + 3 * triangles++;
        for (int c = 0; c < 3; c++)
            to[c] = s->merged_into[from[c]];
    }
    mesh->vertex_count = vertices;
    mesh->triangle_count = triangles;
}

size_t cwi_snap_bytes(const cwi_bit_grid *grid, size_t vertices, size_t triangles)
{
    return vertices * (sizeof(cwi_vertex_index) + sizeof(uint32_t) + 3 * sizeof(float)) +
           triangles * sizeof(uint32_t) + grid->rows * grid->words * sizeof(cwi_cell_word);
}

static cw_status ensure_capacity(snap_run *run, cw_error *err)
{
    cwi_snapping *s = &run->s;
    const size_t vertices = s->mesh->vertex_count, triangles = s->mesh->triangle_count;
    s->indices = cwi_alloc_large(vertices, sizeof *s->indices);
    s->merged_into = cwi_alloc_large(vertices, sizeof *s->merged_into);
    s->cells_before = cwi_alloc_large(vertices, 3 * sizeof *s->cells_before);
    s->cells = cwi_alloc_zeroed(s->grid->rows, s->grid->words * sizeof *s->cells);
    s->triangle_ends = cwi_alloc_large(triangles, sizeof *s->triangle_ends);
    run->sums = cwi_alloc_zeroed(s->grid->rows_z, sizeof *run->sums);
    if (!s->indices || !s->merged_into || !s->cells_before || !s->cells || !s->triangle_ends ||
        !run->sums)
        return cwi_fail_memory(err);
    memcpy(s->cells_before, s->mesh->positions, 3 * vertices * sizeof *s->cells_before);
    return CW_OK;
}

static void free_room(snap_run *run)
{
    cwi_snapping *s = &run->s;
    cwi_free(s->indices);
    cwi_free(s->merged_into);
    cwi_free(s->cells_before);
    cwi_free(s->cells);
    cwi_free(s->triangle_ends);
    cwi_free(run->sums);
}

/* Returns the length of a voxel's edges if it is a cube, so that distances are measured only
 * once. */
static double find_edge(const cw_volume *v)
{
    double gram[3][3];
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            gram[a][b] = v->affine[0][a] * v->affine[0][b] + v->affine[1][a] * v->affine[1][b] +
                         v->affine[2][a] * v->affine[2][b];
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3;
        if (fabs(gram[a][b]) > 1e-12 * gram[a][a] ||
            fabs(gram[b][b] - gram[a][a]) > 1e-12 * gram[a][a])
            return 0;
    }
    return sqrt(gram[0][0]);
}

static void find_inverse(cwi_snapping *s)
{
    const cw_volume *v = &s->grid->volume;
    double sum_sq = 0;
    cwi_affine_invert(v->affine[0], s->inverse);
    for (int r = 0; r < 3; r++) {
        s->centre[r] = 0.5 * (double)(v->dim[r] - 1) + 1;
        sum_sq += cwi_dot(s->inverse[r], s->inverse[r]);
    }
    s->shrink = 1 / sqrt(sum_sq);
    s->edge = find_edge(v);
}

typedef struct snap_step {
    const char *name;
    void (*work)(void *context, size_t k);
    size_t every, from; /* layers */
} snap_step;

cw_status cwi_snap(const cwi_bit_grid *grid, const cwi_row *rows, const cw_extract_desc *desc,
                   cw_mesh *mesh, cw_snap_counts *counts, cw_error *err)
{
    static const snap_step steps[] = {
        {"finding needles", mark_layer, 1, 0},  {"finding needles", find_cells, 1, 0},
        {"finding needles", reset_layer, 1, 0}, {"snapping", snap_layer, EVERY, 0},
        {"snapping", snap_layer, EVERY, 1},     {"snapping", snap_layer, EVERY, 2},
        {"measuring", measure_layer, 1, 0},
    };
    snap_run run = {
        .s = {.grid = grid, .rows = rows, .mesh = mesh, .snap_distance = desc->snap}};
    find_inverse(&run.s);
    cw_status st = ensure_capacity(&run, err);
    for (size_t n = 0; n < sizeof steps / sizeof *steps && st == CW_OK; n++) {
        const snap_step *step = &steps[n];
        run.colour = step->from;
        st = cwi_parallel_for((grid->rows_z - step->from + step->every - 1) / step->every,
                              grid->rows_y * grid->words * 64, desc->threads, &desc->progress,
                              step->name, step->work, &run, err);
    }
    if (st == CW_OK) {
        sum_layers(&run, counts);
        close_ranks(&run.s);
    }
    free_room(&run);
    return st;
}
