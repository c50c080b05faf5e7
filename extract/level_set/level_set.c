/* Makes a sparse level set from a mesh: distances by OpenVDB, rough ones computed again
 * exactly, and signs by winding numbers along rows. */
#include "extract/level_set/level_set.h"

#include "core/base/memory.h"
#include "core/base/module.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/base/thread_pool.h"
#include "core/volume/volume.h"
#include "extract/level_set/openvdb_distance_wrap.h"
#include "extract/level_set/winding_rows.h"

#include <cubewright/distance.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool cw_level_set_available(void)
{
    return cwi_module_present("levelset");
}

/* Number of voxels whose distances are computed at a time, and the bytes stored for each. */
enum { BATCH = 1 << 22, BATCH_BYTES = 4 * sizeof(float) + sizeof(float *) };

/* --- before it is made -------------------------------------------------------------------- */

cw_status cwi_level_set_check(const cw_mesh *mesh, int threads, cw_quality *q, cw_error *err)
{
    cw_status st = cw_quality_measure(mesh, &(cw_quality_desc){.threads = threads}, q, err);
    if (st != CW_OK)
        return st;
    if (!q->triangles)
        return cwi_fail(err, CW_ERR_ARGUMENT, "the mesh has no triangles");
    const size_t nonmanifold = q->nonmanifold_edges - q->contact_edges;
    if (q->open_edges || nonmanifold || q->misoriented_edges)
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "the mesh does not enclose a solid: %zu open edges, %zu of more than two "
            "triangles, %zu between triangles that face opposite ways; see "
            "cw_mesh_repair()",
            q->open_edges, nonmanifold, q->misoriented_edges);
    if (!(q->volume_mm3 > 0))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "the mesh encloses %g mm3: it faces inward, or is flat", q->volume_mm3);
    return CW_OK;
}

/* Returns the number of voxels along an axis, including the reach around the mesh, in whole
 * leaves. */
static double count_samples(const cw_quality *q, int a, double voxel_mm, double reach_mm)
{
    const double around = 2 * (reach_mm / voxel_mm + CWI_BAND + 2 * CWI_LEAF);
    return (q->max[a] - q->min[a]) / voxel_mm + around;
}

void cwi_level_set_round(cw_mesh *mesh, const double origin[3])
{
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        mesh->positions[i] =
            (float)((double)mesh->positions[i] + (mesh->origin[i % 3] - origin[i % 3]));
    memcpy(mesh->origin, origin, sizeof mesh->origin);
}

cw_status cwi_level_set_prove(const cw_mesh *surface, int threads, const cw_progress *progress,
                              cw_error *err)
{
    const cw_crossings_desc desc = {.threads = threads, .progress = *progress};
    cw_crossings found = {0};
    cw_status st = cw_self_intersections(surface, &desc, &found, err);
    if (st == CW_OK && found.count)
        st = cwi_fail(err, CW_ERR_CHECK,
                      "rounding makes %zu pairs of triangles of the result intersect; another "
                      "desc->voxel_mm helps",
                      found.count);
    cw_crossings_free(&found);
    return st;
}

/* Estimates bytes. A band around a plane meets leaves as if it were 12 voxels thicker. A leaf
 * exists with numbers of triangles while it is made, then with the volume's own. Distances from
 * triangles need 76 bytes each. */
double cwi_level_set_bytes(const cw_quality *q, double voxel_mm, double reach_mm)
{
    double box = 1;
    for (int a = 0; a < 3; a++)
        box *= count_samples(q, a, voxel_mm, reach_mm);
    const double side = q->area_mm2 / (voxel_mm * voxel_mm);
    const double voxels = fmin(side * (2 * (reach_mm / voxel_mm + CWI_BAND + 1) + 12), box);
    const double rows =
        count_samples(q, 1, voxel_mm, reach_mm) * count_samples(q, 2, voxel_mm, reach_mm);
    return 9 * voxels + sizeof(size_t) * rows + sizeof(cwi_row_crossing) * side +
           fmin(voxels, BATCH) * BATCH_BYTES + 76 * (double)q->triangles;
}

bool cwi_level_set_fits(const cw_quality *q, double voxel_mm, double reach_mm, size_t max_bytes)
{
    for (int a = 0; a < 3; a++)
        if (count_samples(q, a, voxel_mm, reach_mm) > CWI_WINDING_MAX)
            return false;
    return !max_bytes || cwi_level_set_bytes(q, voxel_mm, reach_mm) <= (double)max_bytes;
}

static cw_status check_fits(const cw_quality *q, const cw_level_set_desc *d, double reach_mm,
                            cw_error *err)
{
    double voxel = d->voxel_mm;
    if (cwi_level_set_fits(q, voxel, reach_mm, d->max_bytes))
        return CW_OK;
    while (!cwi_level_set_fits(q, voxel, reach_mm, d->max_bytes) && voxel < 1e30)
        voxel *= 1.05;
    if (!d->max_bytes || cwi_level_set_bytes(q, d->voxel_mm, reach_mm) <= (double)d->max_bytes)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "voxels of %.3g mm are more than %d along an axis; %.2g mm would do",
                        d->voxel_mm, CWI_WINDING_MAX, voxel);
    return cwi_fail(
        err, CW_ERR_LIMIT,
        "a level set with voxels of %.3g mm needs some %.3g MB, the limit is %.3g MB; "
        "voxels of %.2g mm would do",
        d->voxel_mm, cwi_level_set_bytes(q, d->voxel_mm, reach_mm) / 1e6,
        (double)d->max_bytes / 1e6, 1.05 * voxel);
}

/* --- leaves ------------------------------------------------------------------------------- */

typedef struct build {
    const cw_level_set_desc *desc;
    const cw_mesh *mesh;
    const double *level; /* distances must be exact near it; NULL: everywhere */
    const cwi_levelset_functions *functions;
    cwi_distances *distances;
    cwi_winding winding;
    double corner[3]; /* where voxel 0 stands in the world */
    double reach;     /* of distances, in voxels */
    size_t dim[3];    /* leaves */
    size_t leaf_count, tile_count;
    uint32_t (*leaves)[3];
    float *voxels;
    cw_tile *tiles;
} build;

/* Converts a leaf's distances from voxels to millimetres, with signs. */
static void sign_leaf(const build *b, const uint32_t at[3], float voxels[CWI_LEAF_VOXELS])
{
    bool inside[CWI_LEAF];
    for (size_t k = 0; k < CWI_LEAF; k++)
        for (size_t j = 0; j < CWI_LEAF; j++) {
            cwi_winding_row(&b->winding, CWI_LEAF * (size_t)at[0], CWI_LEAF * (size_t)at[1] + j,
                            CWI_LEAF * (size_t)at[2] + k, CWI_LEAF, inside);
            for (size_t i = 0; i < CWI_LEAF; i++, voxels++) {
                const double mm = b->desc->voxel_mm * (double)*voxels;
                *voxels = (float)(inside[i] ? -mm : mm);
            }
        }
}

static void take_leaf(void *context, size_t n)
{
    build *b = context;
    int32_t at[3];
    float *voxels = b->voxels + n * CWI_LEAF_VOXELS;
    b->functions->take(b->distances, n, at, voxels);
    for (int a = 0; a < 3; a++)
        b->leaves[n][a] = (uint32_t)at[a];
    sign_leaf(b, b->leaves[n], voxels);
}

/* Takes the leaves from OpenVDB. Places are within the grid, whose size is chosen
 * accordingly. */
static cw_status take_leaves(build *b, cw_error *err)
{
    b->leaf_count = b->functions->leaves(b->distances);
    b->leaves = cwi_alloc_array(b->leaf_count, sizeof *b->leaves);
    b->voxels = cwi_alloc_large(b->leaf_count, CWI_LEAF_VOXELS * sizeof *b->voxels);
    if (!b->leaves || !b->voxels)
        return cwi_fail_memory(err);
    cwi_parallel_for_all(b->leaf_count, CWI_LEAF_VOXELS, b->desc->threads, take_leaf, b);
    b->functions->close(b->distances);
    b->distances = NULL;
    return CW_OK;
}

/* --- exact distances ---------------------------------------------------------------------- */

typedef struct batch {
    size_t count;
    float (*points)[3]; /* relative to the grid's corner */
    float *distances;
    float **voxels; /* the voxels they belong to */
} batch;

/* Returns true if a distance may be inexact and matters. OpenVDB tests every triangle near a
 * voxel that is within about a voxel. Farther out it takes triangles from neighbours, and not
 * enough of them: some distances are too large, by a voxel at most. With a level, only those
 * within CWI_BAND of it matter. */
static bool is_rough(const build *b, float value)
{
    const double voxels = fabs((double)value) / b->desc->voxel_mm;
    if (voxels < 1 || voxels > b->reach - 1e-3)
        return false;
    return !b->level || fabs((double)value - *b->level) <= CWI_BAND * b->desc->voxel_mm;
}

static cw_status ask_openvdb(const build *b, batch *list, cw_error *err)
{
    cw_distance d;
    cw_mesh points = {.vertex_count = list->count, .positions = list->points[0]};
    const cw_mesh_distance_desc desc = {
        .vertices_only = true, .threads = b->desc->threads, .progress = b->desc->progress};
    memcpy(points.origin, b->corner, sizeof points.origin);
    cw_status st = cw_distance_to_mesh(&points, b->mesh, &desc, &d, list->distances, err);
    for (size_t n = 0; n < list->count && st == CW_OK; n++)
        *list->voxels[n] = copysignf(list->distances[n], *list->voxels[n]);
    list->count = 0;
    return st;
}

static void add_leaf(const build *b, size_t leaf, batch *list)
{
    for (size_t n = 0; n < CWI_LEAF_VOXELS; n++) {
        const size_t in[3] = {n % CWI_LEAF, n / CWI_LEAF % CWI_LEAF, n / (CWI_LEAF * CWI_LEAF)};
        float *voxel = b->voxels + leaf * CWI_LEAF_VOXELS + n;
        if (!is_rough(b, *voxel))
            continue;
        for (int a = 0; a < 3; a++)
            list->points[list->count][a] =
                (float)(b->desc->voxel_mm *
                        (double)(CWI_LEAF * (size_t)b->leaves[leaf][a] + in[a]));
        list->voxels[list->count++] = voxel;
    }
}

static cw_status make_exact(build *b, cw_error *err)
{
    const size_t max_points = b->leaf_count * CWI_LEAF_VOXELS,
                 capacity = max_points < BATCH ? max_points : (size_t)BATCH;
    batch list = {.points = cwi_alloc_array(capacity, sizeof *list.points),
                  .distances = cwi_alloc_array(capacity, sizeof *list.distances),
                  .voxels = cwi_alloc_array(capacity, sizeof *list.voxels)};
    cw_status st = list.points && list.distances && list.voxels ? CW_OK : cwi_fail_memory(err);
    for (size_t n = 0; n < b->leaf_count && st == CW_OK; n++) {
        add_leaf(b, n, &list);
        if (n + 1 == b->leaf_count || list.count + CWI_LEAF_VOXELS > capacity)
            st = ask_openvdb(b, &list, err);
    }
    cwi_free(list.points);
    cwi_free(list.distances);
    cwi_free(list.voxels);
    return st;
}

/* --- limits ------------------------------------------------------------------------------- */

/* Limits distances. Returns true if some voxels are not too far from the surface. */
static bool limit_leaf(const build *b, float voxels[CWI_LEAF_VOXELS])
{
    const float low = (float)-b->desc->inside_mm, high = (float)b->desc->outside_mm;
    bool near = false;
    for (size_t n = 0; n < CWI_LEAF_VOXELS; n++) {
        near = near || (voxels[n] > low && voxels[n] < high);
        voxels[n] = voxels[n] < low ? low : voxels[n] > high ? high : voxels[n];
    }
    return near;
}

/* Drops the leaves that have nothing but one of the two limits. */
static void limit_leaves(build *b)
{
    size_t to = 0;
    for (size_t n = 0; n < b->leaf_count; n++) {
        float *voxels = b->voxels + n * CWI_LEAF_VOXELS;
        if (!limit_leaf(b, voxels))
            continue;
        memmove(b->leaves[to], b->leaves[n], sizeof *b->leaves);
        memmove(b->voxels + to++ * CWI_LEAF_VOXELS, voxels, CWI_LEAF_VOXELS * sizeof *voxels);
    }
    b->leaf_count = to;
    float *less = cwi_realloc_array(b->voxels, to * CWI_LEAF_VOXELS, sizeof *less);
    b->voxels = less ? less : b->voxels;
}

/* --- inside, and far from the surface ----------------------------------------------------- */

static int compare_positions(const void *a, const void *b)
{
    const uint32_t *p = a, *q = b;
    for (int k = 2; k >= 0; k--)
        if (p[k] != q[k])
            return p[k] < q[k] ? -1 : 1;
    return 0;
}

/* Makes tiles of the gaps inside the mesh. Between two leaves in a row there is no surface: all
 * is inside, or all is outside. */
static cw_status make_tiles(build *b, cw_error *err)
{
    uint32_t(*rows)[3] = cwi_alloc_array(b->leaf_count, sizeof *rows);
    b->tiles = cwi_alloc_array(b->leaf_count, sizeof *b->tiles);
    if (!rows || !b->tiles) {
        cwi_free(rows);
        return cwi_fail_memory(err);
    }
    memcpy(rows, b->leaves, b->leaf_count * sizeof *rows);
    qsort(rows, b->leaf_count, sizeof *rows, compare_positions);
    for (size_t n = 1; n < b->leaf_count; n++) {
        const uint32_t *here = rows[n - 1], *next = rows[n];
        const uint32_t gap[3] = {here[0] + 1, here[1], here[2]};
        bool inside = false;
        if (here[1] != next[1] || here[2] != next[2] || gap[0] == next[0])
            continue;
        cwi_winding_row(&b->winding, CWI_LEAF * (size_t)gap[0], CWI_LEAF * (size_t)gap[1],
                        CWI_LEAF * (size_t)gap[2], 1, &inside);
        if (inside)
            b->tiles[b->tile_count++] = (cw_tile){.at = {gap[0], gap[1], gap[2]},
                                                  .size = {next[0] - gap[0], 1, 1},
                                                  .value = -b->desc->inside_mm};
    }
    cwi_free(rows);
    return CW_OK;
}

/* --- the volume --------------------------------------------------------------------------- */

/* Takes the voxels over; places and tiles are copied, with the struct, to one piece
 * of memory. */
static cw_status hand_over(build *b, cw_volume *v, cw_error *err)
{
    char *memory = cwi_alloc_array(sizeof(cw_sparse) + b->tile_count * sizeof(cw_tile) +
                                       b->leaf_count * sizeof *b->leaves,
                                   1);
    if (!memory)
        return cwi_fail_memory(err);
    cw_tile *tiles = (cw_tile *)(void *)(memory + sizeof(cw_sparse));
    uint32_t(*leaves)[3] = (uint32_t(*)[3])(void *)(tiles + b->tile_count);
    memcpy(tiles, b->tiles, b->tile_count * sizeof *tiles);
    memcpy(leaves, b->leaves, b->leaf_count * sizeof *leaves);
    cw_sparse *sparse = (cw_sparse *)(void *)memory;
    *sparse = (cw_sparse){.leaf_count = b->leaf_count,
                          .leaves = (const uint32_t(*)[3])leaves,
                          .tile_count = b->tile_count,
                          .tiles = tiles,
                          .background = (float)b->desc->outside_mm};
    for (size_t n = 0; n < b->tile_count; n++)
        tiles[n].value = (float)tiles[n].value; /* as in leaves */
    *v = (cw_volume){.type = CW_F32,
                     .components = 1,
                     .steps = 1,
                     .slope = 1,
                     .known = CW_KNOWN_UNIT | CW_KNOWN_LEVEL_SET,
                     .sparse = sparse,
                     .data = b->voxels,
                     .owned = b->voxels,
                     .owned_grid = memory};
    b->voxels = NULL;
    for (int a = 0; a < 3; a++) {
        v->dim[a] = CWI_LEAF * b->dim[a];
        v->affine[a][a] = b->desc->voxel_mm;
        v->affine[a][3] = b->corner[a];
    }
    return CW_OK;
}

static void free_build(build *b)
{
    if (b->functions)
        b->functions->close(b->distances);
    cwi_winding_free(&b->winding);
    cwi_free(b->leaves);
    cwi_free(b->voxels);
    cwi_free(b->tiles);
}

/* Makes the level set. The mesh's box begins in the middle between two samples. So faces of
 * boxes, which often are a whole number of voxels apart, do not coincide with samples. */
static cw_status make_level_set(build *b, const cw_quality *q, cw_volume *volume, cw_error *err)
{
    const double voxel = b->desc->voxel_mm;
    const double margin = CWI_LEAF * ceil((b->reach + CWI_BAND) / CWI_LEAF);
    const void *functions = NULL;
    cwi_distances_desc desc = {.mesh = b->mesh,
                               .voxel_mm = voxel,
                               .reach = b->reach,
                               .threads = cwi_threads(b->desc->threads),
                               .progress = b->desc->progress};
    size_t dim[3];
    for (int a = 0; a < 3; a++) {
        desc.first[a] = q->min[a] - b->mesh->origin[a] - (margin + 0.5) * voxel;
        b->corner[a] = b->mesh->origin[a] + desc.first[a];
        const double length = (q->max[a] - q->min[a]) / voxel;
        b->dim[a] = (size_t)ceil((2 * margin + length + 1) / CWI_LEAF);
        dim[a] = CWI_LEAF * b->dim[a];
    }
    cw_status st = cwi_module_load("levelset", &functions, err);
    b->functions = functions;
    if (st == CW_OK)
        st = cwi_winding_init(&b->winding, b->mesh, desc.first, voxel, dim, err);
    if (st == CW_OK)
        st = b->functions->open(&desc, &b->distances, err);
    if (st == CW_OK)
        st = take_leaves(b, err);
    if (st == CW_OK)
        st = make_exact(b, err);
    if (st != CW_OK)
        return st;
    limit_leaves(b);
    st = make_tiles(b, err);
    return st == CW_OK ? hand_over(b, volume, err) : st;
}

cw_status cwi_level_set_make(const cw_mesh *mesh, const cw_quality *q,
                             const cw_level_set_desc *desc, const double *level,
                             cw_volume *volume, cw_error *err)
{
    const double reach_mm = fmax(desc->inside_mm, desc->outside_mm);
    cw_level_set_desc d = *desc;
    build b = {.desc = &d, .mesh = mesh, .level = level};
    *volume = (cw_volume){0};
    d.inside_mm += CWI_BAND * d.voxel_mm;
    d.outside_mm += CWI_BAND * d.voxel_mm;
    cw_status st = check_fits(q, &d, reach_mm, err);
    b.reach = reach_mm / d.voxel_mm + CWI_BAND + 1;
    if (st == CW_OK)
        st = make_level_set(&b, q, volume, err);
    free_build(&b);
    return st;
}

bool cwi_level_set_leaves(const cw_volume *volume, cwi_lattice_map *leaves)
{
    const cw_sparse *sparse = volume->sparse;
    bool ok = true;
    for (size_t n = 0; n < sparse->leaf_count && ok; n++)
        ok =
            cwi_lattice_add(leaves, cwi_lattice_key(sparse->leaves[n])) != CWI_NO_LATTICE_POINT;
    return ok;
}

float *cwi_level_set_voxel(const cw_volume *volume, const cwi_lattice_map *leaves,
                           const uint32_t at[3])
{
    const uint32_t leaf[3] = {at[0] / CWI_LEAF, at[1] / CWI_LEAF, at[2] / CWI_LEAF};
    const uint32_t n = cwi_lattice_find(leaves, cwi_lattice_key(leaf));
    if (n == CWI_NO_LATTICE_POINT)
        return NULL;
    return (float *)volume->owned + (size_t)n * CWI_LEAF_VOXELS + at[0] % CWI_LEAF +
           CWI_LEAF * (at[1] % CWI_LEAF + CWI_LEAF * (at[2] % CWI_LEAF));
}

cw_status cw_level_set_from_mesh(const cw_mesh *mesh, const cw_level_set_desc *desc,
                                 cw_volume *volume, cw_error *err)
{
    CWI_REQUIRE(err, mesh, desc, volume);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cw_level_set_desc d = *desc;
    cw_quality q;
    *volume = (cw_volume){0};
    if (!(d.voxel_mm > 0 && d.inside_mm >= 0 && d.outside_mm >= 0 && isfinite(d.voxel_mm) &&
          isfinite(d.inside_mm) && isfinite(d.outside_mm)))
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "a level set needs voxels of more than 0 mm, and distances of 0 or more; "
            "not %g mm, %g and %g mm",
            d.voxel_mm, d.inside_mm, d.outside_mm);
    cw_status st = cwi_level_set_check(mesh, d.threads, &q, err);
    d.inside_mm = fmax(d.inside_mm - CWI_BAND * d.voxel_mm, 0);
    d.outside_mm = fmax(d.outside_mm - CWI_BAND * d.voxel_mm, 0);
    return st == CW_OK ? cwi_level_set_make(mesh, &q, &d, NULL, volume, err) : st;
}
