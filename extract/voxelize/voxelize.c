/* Makes label maps and partial volumes of closed meshes: checks the meshes, sorts triangles into blocks of
 * layers, fills these, and gathers the facts. */
#include "extract/voxelize/voxelize_state.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "extract/voxelize/voxel_grid.h"

#include <cubewright/quality.h>

#include <math.h>
#include <string.h>

/* --- what goes in ------------------------------------------------------------------------- */

/* Mixes the bits of a number, so that sums of mixed numbers are equal by chance alone. */
static uint64_t mix_bits(uint64_t x)
{
    x = (x ^ x >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ x >> 27) * UINT64_C(0x94d049bb133111eb);
    return x ^ x >> 31;
}

static uint64_t hash_point(const float p[3])
{
    uint64_t hash = UINT64_C(0x9e3779b97f4a7c15);
    for (int a = 0; a < 3; a++) {
        uint32_t bits;
        const float value = p[a] + 0.0f; /* -0 becomes 0 */
        memcpy(&bits, &value, sizeof bits);
        hash = mix_bits(hash + bits + (uint64_t)a);
    }
    return hash;
}

/* Returns true if as many triangles run through each edge one way as the other: each edge adds a hash of its
 * ends in one direction, and subtracts it in the other. Ends at equal positions are the same. */
static bool is_closed(const cw_mesh *mesh)
{
    uint64_t sum = 0, hash[3];
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        for (int k = 0; k < 3; k++)
            hash[k] =
                hash_point(mesh->positions + 3 * (size_t)mesh->triangles[3 * t + (size_t)k]);
        for (int k = 0; k < 3; k++) {
            const uint64_t a = hash[k], b = hash[(k + 1) % 3];
            sum += a < b ? mix_bits(a * 3 + b) : a > b ? 0 - mix_bits(b * 3 + a) : 0;
        }
    }
    return sum == 0;
}

static cw_status fail_open(const cwi_voxelize *v, size_t n, cw_error *err)
{
    const cw_quality_desc desc = {.weld = CW_WELD_LOCAL, .threads = v->desc->threads};
    cw_quality q;
    const cw_status st = cw_quality_measure(v->meshes[n], &desc, &q, err);
    if (st != CW_OK)
        return st;
    if (v->desc->parts)
        v->desc->parts[n].open = true;
    return cwi_fail(
        err, CW_ERR_CHECK,
        "mesh %zu does not enclose a solid: %zu open edges, %zu of more than two triangles, %zu "
        "between triangles that face opposite ways; see cw_mesh_repair()",
        n + 1, q.open_edges, q.nonmanifold_edges - q.contact_edges, q.misoriented_edges);
}

static cw_status check_meshes(cwi_voxelize *v, cw_error *err)
{
    size_t total = 0;
    for (size_t n = 0; n < v->count; n++) {
        cw_status st = cwi_mesh_check_size(v->meshes[n], "voxelized", err);
        if (st != CW_OK)
            return st;
        total += v->meshes[n]->triangle_count;
        if (!v->meshes[n]->triangle_count)
            return cwi_fail(err, CW_ERR_EMPTY, "mesh %zu has no triangles", n + 1);
        if (total > CWI_MAX_TRIANGLES)
            return cwi_fail(err, CW_ERR_LIMIT, "the meshes have more than %zu triangles",
                            CWI_MAX_TRIANGLES);
        if (!is_closed(v->meshes[n]))
            return fail_open(v, n, err);
    }
    return CW_OK;
}

static cw_status choose_labels(cwi_voxelize *v, cw_type *type, cw_error *err)
{
    uint32_t max = 0;
    v->label = cwi_alloc_array(v->count, sizeof *v->label);
    if (!v->label)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < v->count; n++) {
        v->label[n] = v->desc->labels ? v->desc->labels[n] : (uint32_t)(n + 1);
        if (!v->label[n])
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "desc->labels: that of mesh %zu is 0, which stands for no mesh",
                            n + 1);
        max = v->label[n] > max ? v->label[n] : max;
    }
    *type = v->desc->partial    ? CW_F32
            : max <= UINT8_MAX  ? CW_U8
            : max <= UINT16_MAX ? CW_U16
                                : CW_U32;
    return CW_OK;
}

/* --- in the grid -------------------------------------------------------------------------- */

/* Computes six times the volume that a mesh encloses, in voxels: about the middle of its box. */
static double enclosed_voxels(const cwi_voxelize *v, size_t mesh)
{
    const double *origin = v->points[v->first_vertex[mesh]];
    double sum = 0;
    for (size_t t = v->first_triangle[mesh]; t < v->first_triangle[mesh + 1]; t++) {
        const double *c[3];
        double p[3][3], cross[3];
        cwi_voxelize_corners(v, t, mesh, c);
        for (int k = 0; k < 3; k++)
            cwi_sub(c[k], origin, p[k]);
        cwi_cross(p[1], p[2], cross);
        sum += cwi_dot(p[0], cross);
    }
    return sum;
}

static cw_status map_meshes(cwi_voxelize *v, cw_error *err)
{
    v->first_vertex = cwi_alloc_zeroed(v->count + 1, sizeof *v->first_vertex);
    v->first_triangle = cwi_alloc_zeroed(v->count + 1, sizeof *v->first_triangle);
    v->turn = cwi_alloc_array(v->count, sizeof *v->turn);
    if (!v->first_vertex || !v->first_triangle || !v->turn)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < v->count; n++) {
        v->first_vertex[n + 1] = v->first_vertex[n] + v->meshes[n]->vertex_count;
        v->first_triangle[n + 1] = v->first_triangle[n] + v->meshes[n]->triangle_count;
    }
    v->points = cwi_alloc_array(v->first_vertex[v->count], sizeof *v->points);
    if (!v->points)
        return cwi_fail_memory(err);
    const double voxel_mm3 = fabs(cwi_affine_determinant(v->volume->affine[0]));
    for (size_t n = 0; n < v->count; n++) {
        const int mirror = cwi_voxel_grid_map(v->volume, v->meshes[n], v->desc->threads,
                                              v->points + v->first_vertex[n]);
        const double volume = mirror * enclosed_voxels(v, n) / 6;
        v->turn[n] = volume < 0 ? -mirror : mirror;
        if (v->desc->parts) {
            v->desc->parts[n].volume_mm3 = fabs(volume) * voxel_mm3;
            v->desc->parts[n].turned = volume < 0;
        }
    }
    return CW_OK;
}

/* Chooses steps so fine that integers of 64 bits hold products of coordinates. */
static cw_status choose_lattice(cwi_voxelize *v, cw_error *err)
{
    enum { COORDINATE_BITS = 29, FINEST_BITS = 16 };
    double reach = 1;
    bool is_finite = true;
    int bits;
    for (int a = 0; a < 3; a++)
        reach = fmax(reach, (double)v->volume->dim[a]);
    for (size_t n = 0; n < v->first_vertex[v->count]; n++)
        for (int a = 0; a < 3; a++) {
            reach = cwi_greater(reach, fabs(v->points[n][a]));
            is_finite = is_finite && isfinite(v->points[n][a]);
        }
    frexp(reach, &bits);
    bits = COORDINATE_BITS - bits;
    if (!is_finite || bits < 0)
        return cwi_fail(
            err, CW_ERR_LIMIT,
            "the meshes reach %.3g voxels far, and 2^%d are the maximum: check the unit of mesh "
            "and grid",
            reach, COORDINATE_BITS);
    v->lattice = (int64_t)1 << (bits < FINEST_BITS ? bits : FINEST_BITS);
    return CW_OK;
}

/* Fails if no mesh has a part of its box in the grid. */
static cw_status check_place(const cwi_voxelize *v, cw_error *err)
{
    const size_t *dim = v->volume->dim;
    for (size_t n = 0; n < v->count; n++) {
        double low[3] = {INFINITY, INFINITY, INFINITY},
               high[3] = {-INFINITY, -INFINITY, -INFINITY};
        bool meets = true;
        for (size_t p = v->first_vertex[n]; p < v->first_vertex[n + 1]; p++)
            for (int a = 0; a < 3; a++) {
                low[a] = cwi_lesser(low[a], v->points[p][a]);
                high[a] = cwi_greater(high[a], v->points[p][a]);
            }
        for (int a = 0; a < 3; a++)
            meets = meets && low[a] < (double)dim[a] - 0.5 && high[a] > -0.5;
        if (meets)
            return CW_OK;
    }
    double corners[8][3], low[3], high[3];
    cw_volume_corners(v->volume, corners);
    cw_mesh_bounds(v->meshes[0], low, high);
    return cwi_fail(
        err, CW_ERR_EMPTY,
        "the mesh is outside of the grid: its box is from (%.6g, %.6g, %.6g) to (%.6g, %.6g, %.6g) mm, "
        "and the grid reaches from (%.6g, %.6g, %.6g) to (%.6g, %.6g, %.6g): check unit and frame",
        low[0], low[1], low[2], high[0], high[1], high[2], corners[0][0], corners[0][1],
        corners[0][2], corners[7][0], corners[7][1], corners[7][2]);
}

/* --- blocks ------------------------------------------------------------------------------- */

/* Finds the blocks whose layers a triangle may meet. Returns false if it meets none, or is beyond the
 * ends of all rows. */
static bool find_blocks(const cwi_voxelize *v, size_t triangle, size_t mesh, size_t *low,
                        size_t *high)
{
    const double *c[3], last = (double)v->volume->dim[2] - 1;
    cwi_voxelize_corners(v, triangle, mesh, c);
    const double z0 = floor(cwi_lesser(cwi_lesser(c[0][2], c[1][2]), c[2][2])),
                 z1 = ceil(cwi_greater(cwi_greater(c[0][2], c[1][2]), c[2][2])),
                 y0 = floor(cwi_lesser(cwi_lesser(c[0][1], c[1][1]), c[2][1])),
                 y1 = ceil(cwi_greater(cwi_greater(c[0][1], c[1][1]), c[2][1])),
                 x0 = floor(cwi_lesser(cwi_lesser(c[0][0], c[1][0]), c[2][0]));
    if (z0 > last || z1 < 0 || y0 >= (double)v->volume->dim[1] || y1 < 0 ||
        x0 >= (double)v->volume->dim[0])
        return false;
    *low = (size_t)cwi_greater(z0, 0) / CWI_VOXELIZE_LAYERS;
    *high = (size_t)cwi_lesser(z1, last) / CWI_VOXELIZE_LAYERS;
    return true;
}

static void list_triangles(cwi_voxelize *v, bool keep)
{
    size_t mesh = 0, low, high;
    for (size_t t = 0; t < v->first_triangle[v->count]; t++) {
        mesh = cwi_voxelize_mesh(v, t, mesh);
        if (!find_blocks(v, t, mesh, &low, &high))
            continue;
        for (size_t b = low; b <= high; b++)
            if (keep)
                v->list[v->first[b]++] = (uint32_t)t;
            else
                v->first[b + 1]++;
    }
}

static cw_status sort_triangles(cwi_voxelize *v, cw_error *err)
{
    v->blocks = (v->volume->dim[2] + CWI_VOXELIZE_LAYERS - 1) / CWI_VOXELIZE_LAYERS;
    v->first = cwi_alloc_zeroed(v->blocks + 1, sizeof *v->first);
    if (!v->first)
        return cwi_fail_memory(err);
    list_triangles(v, false);
    for (size_t b = 0; b < v->blocks; b++)
        v->first[b + 1] += v->first[b];
    v->list = cwi_alloc_array(v->first[v->blocks], sizeof *v->list);
    if (!v->list)
        return cwi_fail_memory(err);
    list_triangles(v, true);
    memmove(v->first + 1, v->first, v->blocks * sizeof *v->first);
    v->first[0] = 0;
    return CW_OK;
}

static cw_status fill_blocks(cwi_voxelize *v, cw_error *err)
{
    size_t slots;
    v->counts = cwi_size_mul(v->blocks, v->count, &slots)
                    ? cwi_alloc_zeroed(slots, sizeof *v->counts)
                    : NULL;
    if (!v->counts)
        return cwi_fail_memory(err);
    const size_t layer = v->volume->dim[0] * v->volume->dim[1] * CWI_VOXELIZE_LAYERS;
    cw_status st = cwi_parallel_for(
        v->blocks, layer, v->desc->threads, &v->desc->progress, "voxelizing",
        v->desc->partial ? cwi_voxelize_coverage : cwi_voxelize_labels, v, err);
    return st == CW_OK && v->no_memory ? cwi_fail_memory(err) : st;
}

/* --- facts -------------------------------------------------------------------------------- */

static cw_status gather_facts(const cwi_voxelize *v, cw_error *err)
{
    const double voxel_mm3 = fabs(cwi_affine_determinant(v->volume->affine[0]));
    cw_status st = CW_OK;
    for (size_t n = 0; n < v->count && v->desc->parts && st == CW_OK; n++) {
        cw_voxelize_part *part = &v->desc->parts[n];
        double covered = 0;
        for (size_t b = 0; b < v->blocks; b++) {
            const cwi_voxelize_counts *c = &v->counts[b * v->count + n];
            part->voxels += c->voxels;
            part->overlapped += c->overlapped;
            part->repeated += c->repeated;
            part->negative += c->negative;
            covered += c->covered;
        }
        part->filled_mm3 = voxel_mm3 * (v->desc->partial ? covered : (double)part->voxels);
        st = cwi_find_thin_places(v, n, part, err);
    }
    return st;
}

static void free_state(cwi_voxelize *v)
{
    cwi_free(v->first_vertex);
    cwi_free(v->first_triangle);
    cwi_free(v->points);
    cwi_free(v->turn);
    cwi_free(v->label);
    cwi_free(v->first);
    cwi_free(v->list);
    cwi_free(v->counts);
}

cw_status cw_voxelize(const cw_mesh *const *meshes, size_t count, const cw_voxelize_desc *desc,
                      cw_volume *volume, cw_error *err)
{
    CWI_REQUIRE(err, meshes, desc, volume);
    CWI_REQUIRE_VERSION(err, desc, 0);
    *volume = (cw_volume){0};
    if (!count)
        return cwi_fail(err, CW_ERR_ARGUMENT, "count is 0; expected a mesh or more");
    for (size_t n = 0; n < count; n++)
        if (!meshes[n])
            return cwi_fail(err, CW_ERR_ARGUMENT, "cw_voxelize: mesh %zu is NULL", n + 1);
    cwi_voxelize v = {.meshes = meshes, .count = count, .desc = desc, .volume = volume};
    if (desc->parts)
        memset(desc->parts, 0, count * sizeof *desc->parts);
    cw_type type = CW_U8;
    cw_status st = check_meshes(&v, err);
    if (st == CW_OK)
        st = choose_labels(&v, &type, err);
    if (st == CW_OK)
        st = cwi_voxel_grid_make(meshes, count, desc, type, volume, err);
    if (st == CW_OK)
        st = map_meshes(&v, err);
    if (st == CW_OK)
        st = choose_lattice(&v, err);
    if (st == CW_OK)
        st = check_place(&v, err);
    if (st == CW_OK)
        st = sort_triangles(&v, err);
    if (st == CW_OK)
        st = fill_blocks(&v, err);
    if (st == CW_OK)
        st = gather_facts(&v, err);
    free_state(&v);
    if (st != CW_OK)
        cw_volume_free(volume);
    return st;
}
