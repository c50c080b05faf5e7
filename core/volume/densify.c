/* Dense copies of sparse grids. */
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <string.h>

static size_t sample_address(const cw_volume *v, size_t i, size_t j, size_t k)
{
    return ((k * v->dim[1] + j) * v->dim[0] + i) * cw_type_size(v->type);
}

static size_t min_size(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* Gives a box of voxels one value, as far as it is inside. */
static void fill_box(const cw_volume *v, char *voxels, const size_t at[3], const size_t size[3],
                     double value)
{
    const size_t width = cw_type_size(v->type);
    double voxel = 0; /* room for any type, aligned for all */
    size_t end[3];
    cwi_voxel_put(v->type, &voxel, value);
    for (int a = 0; a < 3; a++)
        end[a] = min_size(at[a] + size[a], v->dim[a]);
    for (size_t k = at[2]; k < end[2]; k++)
        for (size_t j = at[1]; j < end[1]; j++)
            for (size_t i = at[0]; i < end[0]; i++)
                memcpy(voxels + sample_address(v, i, j, k), &voxel, width);
}

static void fill_tiles(const cw_volume *v, const cw_sparse *sparse, char *voxels)
{
    for (size_t n = 0; n < sparse->tile_count; n++) {
        const cw_tile *tile = &sparse->tiles[n];
        size_t at[3], size[3];
        for (int a = 0; a < 3; a++) {
            at[a] = (size_t)CWI_LEAF * tile->at[a];
            size[a] = (size_t)CWI_LEAF * tile->size[a];
        }
        fill_box(v, voxels, at, size, tile->value);
    }
}

static void copy_leaf(const cw_volume *sparse, size_t n, const cw_volume *v, char *voxels)
{
    const size_t width = cw_type_size(v->type);
    const char *from = (const char *)sparse->data + n * CWI_LEAF_VOXELS * width;
    size_t at[3], end[3];
    for (int a = 0; a < 3; a++) {
        at[a] = (size_t)CWI_LEAF * sparse->sparse->leaves[n][a];
        end[a] = min_size(at[a] + CWI_LEAF, v->dim[a]);
    }
    for (size_t k = at[2]; k < end[2]; k++)
        for (size_t j = at[1]; j < end[1]; j++)
            if (at[0] < end[0])
                memcpy(voxels + sample_address(v, at[0], j, k),
                       from + ((k - at[2]) * CWI_LEAF + j - at[1]) * CWI_LEAF * width,
                       (end[0] - at[0]) * width);
}

cw_status cw_volume_densify(const cw_volume *sparse, size_t max_voxels, cw_volume *dense,
                            cw_error *err)
{
    CWI_REQUIRE(err, sparse, dense);
    const size_t *n = sparse->dim;
    *dense = (cw_volume){0};
    if (!sparse->sparse)
        return cwi_fail(err, CW_ERR_ARGUMENT, "a sparse grid was expected; this one is not");
    if ((double)n[0] * (double)n[1] * (double)n[2] > (double)max_voxels)
        return cwi_fail(
            err, CW_ERR_LIMIT,
            "the box around the sparse grid has %zu x %zu x %zu voxels; the limit is "
            "%zu",
            n[0], n[1], n[2], max_voxels);
    cw_status st = cw_volume_alloc(dense, sparse->type, n, 1, 1, err);
    if (st != CW_OK)
        return st;
    char *voxels = cw_volume_voxels(dense);
    memcpy(dense->affine, sparse->affine, sizeof dense->affine);
    dense->slope = sparse->slope;
    dense->intercept = sparse->intercept;
    dense->known = sparse->known;
    dense->has_nodata = sparse->has_nodata;
    dense->nodata = sparse->nodata;
    fill_box(dense, voxels, (size_t[3]){0}, n, sparse->sparse->background);
    fill_tiles(dense, sparse->sparse, voxels);
    for (size_t leaf = 0; leaf < sparse->sparse->leaf_count; leaf++)
        copy_leaf(sparse, leaf, dense, voxels);
    return CW_OK;
}
