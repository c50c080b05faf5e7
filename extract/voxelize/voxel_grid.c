/* The grid of a voxelization: that of a scan, or one by spacing and box; and the meshes in its index space. */
#include "extract/voxelize/voxel_grid.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/base/thread_pool.h"
#include "core/geometry/affine.h"
#include "core/geometry/vec3.h"
#include "core/volume/volume.h"

#include <math.h>
#include <string.h>

/* Maximum number of voxels along an axis. */
enum { MAX_DIM = 1 << 24 };

static cw_status fail_size(const cw_voxelize_desc *d, const double dim[3], double bytes,
                           cw_error *err)
{
    for (int a = 0; a < 3; a++)
        if (dim[a] > MAX_DIM)
            return cwi_fail(
                err, CW_ERR_LIMIT,
                "the grid would have %.6g x %.6g x %.6g voxels, and %d along an axis are the "
                "maximum: wider spacing helps",
                dim[0], dim[1], dim[2], MAX_DIM);
    return cwi_fail(
        err, CW_ERR_LIMIT,
        "%.6g x %.6g x %.6g voxels need %.4g MB, and desc->max_bytes allows %.4g MB: a spacing "
        "%.3g times as wide helps",
        dim[0], dim[1], dim[2], bytes / 1e6, (double)d->max_bytes / 1e6,
        1.01 * cbrt(bytes / (double)d->max_bytes));
}

static cw_status check_size(const cw_voxelize_desc *d, const double dim[3], size_t voxel,
                            cw_error *err)
{
    const double bytes = dim[0] * dim[1] * dim[2] * (double)voxel;
    const bool is_long = dim[0] > MAX_DIM || dim[1] > MAX_DIM || dim[2] > MAX_DIM;
    return is_long || (d->max_bytes && bytes > (double)d->max_bytes)
               ? fail_size(d, dim, bytes, err)
               : CW_OK;
}

/* Finds the world box of all meshes. */
static void find_box(const cw_mesh *const *meshes, size_t count, double low[3], double high[3])
{
    bool any = false;
    for (size_t n = 0; n < count; n++) {
        double min[3], max[3];
        if (!cw_mesh_bounds(meshes[n], min, max))
            continue;
        for (int a = 0; a < 3; a++) {
            low[a] = any ? fmin(low[a], min[a]) : min[a];
            high[a] = any ? fmax(high[a], max[a]) : max[a];
        }
        any = true;
    }
}

/* Makes the grid of a box and a spacing. */
static cw_status make_grid(const cw_mesh *const *meshes, size_t count,
                           const cw_voxelize_desc *d, cw_type type, cw_volume *out,
                           cw_error *err)
{
    double spacing[3], low[3] = {0}, high[3] = {0}, dim[3];
    bool has_box = false;
    for (int a = 0; a < 3; a++) {
        spacing[a] = d->spacing_mm[a] != 0 ? d->spacing_mm[a] : d->spacing_mm[0];
        has_box = has_box || d->low[a] != 0 || d->high[a] != 0;
        if (!(spacing[a] > 0) || !isfinite(spacing[a]))
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "desc->spacing_mm is %g, %g, %g; expected lengths above 0",
                            d->spacing_mm[0], d->spacing_mm[1], d->spacing_mm[2]);
    }
    find_box(meshes, count, low, high);
    for (int a = 0; a < 3; a++) {
        low[a] = has_box ? d->low[a] : low[a] - spacing[a];
        high[a] = has_box ? d->high[a] : high[a] + spacing[a];
        if (!(high[a] > low[a]) || !isfinite(high[a] - low[a]))
            return cwi_fail(
                err, CW_ERR_ARGUMENT,
                "the box reaches from %g to %g mm along %c; expected a length above 0", low[a],
                high[a], 'x' + a);
        dim[a] = ceil((high[a] - low[a]) / spacing[a] * (1 - 1e-12));
    }
    cw_status st = check_size(d, dim, cw_type_size(type), err);
    if (st != CW_OK)
        return st;
    const size_t sizes[3] = {(size_t)dim[0], (size_t)dim[1], (size_t)dim[2]};
    st = cw_volume_alloc(out, type, sizes, 1, 1, err);
    out->known = CW_KNOWN_UNIT | CW_KNOWN_FRAME;
    for (int a = 0; a < 3; a++)
        for (int c = 0; c < 4; c++)
            out->affine[a][c] = c == a ? spacing[a] : c < 3 ? 0 : low[a] + spacing[a] / 2;
    return st;
}

/* Makes a grid like that of a volume, with its frame. */
static cw_status copy_grid(const cw_voxelize_desc *d, cw_type type, cw_volume *out,
                           cw_error *err)
{
    cw_volume shape = *d->like, like;
    shape.data = NULL;
    shape.steps = shape.components = 1;
    cw_status st = cwi_volume_expect_even(d->like, "voxelizing", err);
    if (st == CW_OK)
        st = cwi_volume_resolve_shape(&shape, &like, err);
    if (st != CW_OK)
        return st;
    const double dim[3] = {(double)like.dim[0], (double)like.dim[1], (double)like.dim[2]};
    st = check_size(d, dim, cw_type_size(type), err);
    if (st == CW_OK)
        st = cw_volume_alloc(out, type, like.dim, 1, 1, err);
    if (st != CW_OK)
        return st;
    memcpy(out->affine, like.affine, sizeof out->affine);
    out->known = like.known & (CW_KNOWN_UNIT | CW_KNOWN_FRAME);
    out->said_unit_mm = like.said_unit_mm;
    out->said_ras = like.said_ras;
    return CW_OK;
}

cw_status cwi_voxel_grid_make(const cw_mesh *const *meshes, size_t count,
                              const cw_voxelize_desc *d, cw_type type, cw_volume *out,
                              cw_error *err)
{
    const bool has_spacing =
        d->spacing_mm[0] != 0 || d->spacing_mm[1] != 0 || d->spacing_mm[2] != 0;
    if (!d->like == !has_spacing)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "a grid is required: desc->like or desc->spacing_mm, and not both");
    cw_status st =
        d->like ? copy_grid(d, type, out, err) : make_grid(meshes, count, d, type, out, err);
    if (st == CW_OK && !d->partial)
        out->known |= CW_KNOWN_LABELS;
    return st;
}

/* --- meshes in index space ---------------------------------------------------------------- */

typedef struct mapping {
    const cw_mesh *mesh;
    double inverse[3][3], shift[3]; /* index = inverse * (position + shift) */
    double (*points)[3];
} mapping;

enum { CHUNK = 1 << 14 };

static void map_chunk(void *context, size_t chunk)
{
    const mapping *m = context;
    const size_t begin = chunk * CHUNK, end = begin + CHUNK < m->mesh->vertex_count
                                                  ? begin + CHUNK
                                                  : m->mesh->vertex_count;
    for (size_t n = begin; n < end; n++) {
        double p[3];
        for (int a = 0; a < 3; a++)
            p[a] = (double)m->mesh->positions[3 * n + (size_t)a] + m->shift[a];
        for (int a = 0; a < 3; a++)
            m->points[n][a] = cwi_dot(m->inverse[a], p);
    }
}

int cwi_voxel_grid_map(const cw_volume *grid, const cw_mesh *mesh, int threads,
                       double (*points)[3])
{
    mapping m = {.mesh = mesh, .points = points};
    cwi_affine_invert(grid->affine[0], m.inverse);
    for (int a = 0; a < 3; a++)
        m.shift[a] = mesh->origin[a] - grid->affine[a][3];
    cwi_parallel_for_all((mesh->vertex_count + CHUNK - 1) / CHUNK, CHUNK, threads, map_chunk,
                         &m);
    return cwi_affine_determinant(grid->affine[0]) < 0 ? -1 : 1;
}
