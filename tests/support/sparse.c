/* Makes a sparse grid from a dense volume: leaves with one value become tiles. */
#include "support/sparse.h"

#include "core/volume/volume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct making {
    const cw_volume *dense;
    cw_sparse sparse;
    uint32_t (*leaves)[3];
    cw_tile *tiles;
    char *voxels;
} making;

static double value(const cw_volume *v, size_t i, size_t j, size_t k)
{
    const size_t n = (k * v->dim[1] + j) * v->dim[0] + i;
    return cwi_voxel_at(v->type, (const char *)v->data + n * cw_type_size(v->type));
}

static bool is_constant(const cw_volume *v, const size_t at[3])
{
    const double first = value(v, at[0], at[1], at[2]);
    for (size_t n = 0; n < 512; n++)
        if (value(v, at[0] + n % 8, at[1] + n / 8 % 8, at[2] + n / 64) != first)
            return false;
    return true;
}

static void copy_leaf(const cw_volume *v, const size_t at[3], char *to)
{
    const size_t size = cw_type_size(v->type);
    for (size_t row = 0; row < 64; row++) {
        const size_t j = at[1] + row % 8, k = at[2] + row / 8;
        memcpy(to + row * 8 * size,
               (const char *)v->data + ((k * v->dim[1] + j) * v->dim[0] + at[0]) * size,
               8 * size);
    }
}

static void take_leaf(making *m, const size_t at[3])
{
    cw_sparse *s = &m->sparse;
    const double first = value(m->dense, at[0], at[1], at[2]);
    const uint32_t leaf[3] = {(uint32_t)at[0] / 8, (uint32_t)at[1] / 8, (uint32_t)at[2] / 8};
    if (!is_constant(m->dense, at)) {
        copy_leaf(m->dense, at, m->voxels + s->leaf_count * 512 * cw_type_size(m->dense->type));
        memcpy(m->leaves[s->leaf_count++], leaf, sizeof leaf);
    } else if (first != s->background) {
        m->tiles[s->tile_count++] = (cw_tile){{leaf[0], leaf[1], leaf[2]}, {1, 1, 1}, first};
    }
}

cw_volume test_sparse_of(const cw_volume *dense, double background)
{
    const size_t *n = dense->dim, count = n[0] * n[1] * n[2] / 512;
    making m = {.dense = dense, .sparse = {.background = background}};
    char *memory = malloc(sizeof m.sparse + count * (sizeof *m.leaves + sizeof *m.tiles));
    m.voxels = malloc(count * 512 * cw_type_size(dense->type));
    assert_non_null(memory);
    assert_non_null(m.voxels);
    m.tiles = (cw_tile *)(void *)(memory + sizeof m.sparse);
    m.leaves = (uint32_t(*)[3])(void *)(m.tiles + count);
    for (size_t k = 0; k < n[2]; k += 8)
        for (size_t j = 0; j < n[1]; j += 8)
            for (size_t i = 0; i < n[0]; i += 8)
                take_leaf(&m, (size_t[3]){i, j, k});
    m.sparse.leaves = (const uint32_t(*)[3])m.leaves;
    m.sparse.tiles = m.tiles;
    memcpy(memory, &m.sparse, sizeof m.sparse);
    cw_volume v = *dense;
    v.data = v.owned = m.voxels;
    v.owned_grid = memory;
    v.sparse = (const cw_sparse *)(void *)memory;
    memset(v.stride, 0, sizeof v.stride);
    return v;
}
