/* Makes outside what a mask leaves out. */
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/filter/inside.h"
#include "core/volume/volume.h"

#include <math.h>
#include <string.h>

typedef struct work {
    const cw_volume *in, *mask;
    const cw_inside *inside;
    double to_mask[3][4]; /* from an index of the volume to one of the mask */
    uint8_t *selected;
} work;

/* Sets the transform from indices of the volume to those of the mask. Both are affine. */
static cw_status set_transform(work *k, cw_error *err)
{
    double at[4][3], world[3];
    for (int n = 0; n < 4; n++) {
        const double index[3] = {n == 0, n == 1, n == 2};
        cw_volume_to_world(k->in, index, world);
        cw_status st = cw_volume_to_index(k->mask, world, at[n], err);
        if (st != CW_OK)
            return st;
    }
    for (int r = 0; r < 3; r++) {
        for (int a = 0; a < 3; a++)
            k->to_mask[r][a] = at[a][r] - at[3][r];
        k->to_mask[r][3] = at[3][r];
    }
    return CW_OK;
}

/* Returns true if the mask has a voxel other than 0 next to an index of the volume. */
static bool is_masked_in(const work *k, size_t i, size_t j, size_t z)
{
    size_t p[3];
    for (int a = 0; a < 3; a++) {
        const double *m = k->to_mask[a];
        const double x =
            floor(m[0] * (double)i + m[1] * (double)j + m[2] * (double)z + m[3] + 0.5);
        if (!(x >= 0 && x < (double)k->mask->dim[a]))
            return false;
        p[a] = (size_t)x;
    }
    const cw_volume *m = k->mask;
    const double stored = cwi_voxel_at(m->type, cwi_voxel_address(m, p[0], p[1], p[2]));
    return isfinite(stored) && !(m->has_nodata && stored == m->nodata) &&
           m->slope * stored + m->intercept != 0;
}

/* Leaves bytes of the inside where the mask has them. */
static void mask_slice(void *context, size_t z)
{
    const work *k = context;
    uint8_t *to = k->selected + z * k->in->dim[0] * k->in->dim[1];
    for (size_t j = 0; j < k->in->dim[1]; j++)
        for (size_t i = 0; i < k->in->dim[0]; i++, to++)
            *to = *to && is_masked_in(k, i, j, z);
}

static cw_status find_selected(work *k, const cw_filter_desc *d, cw_error *err)
{
    const size_t *dim = k->in->dim;
    cw_status st = set_transform(k, err);
    if (st == CW_OK)
        st = cwi_find_inside(k->in, k->inside, d, k->selected, err);
    if (st == CW_OK)
        st = cwi_parallel_for(dim[2], dim[0] * dim[1], d->threads, &d->progress, "masking",
                              mask_slice, k, err);
    return st;
}

cw_status cw_volume_mask(const cw_volume *volume, const cw_volume *mask,
                         const cw_inside *inside, const cw_filter_desc *desc, cw_volume *out,
                         cw_error *err)
{
    CWI_REQUIRE(err, volume, mask, inside, out);
    CWI_REQUIRE_VERSION(err, desc, 0);
    const cw_filter_desc none = {0}, *d = desc ? desc : &none;
    cw_volume in, m;
    *out = (cw_volume){0};
    cw_status st = cwi_check_inside(inside, err);
    if (st == CW_OK)
        st = cwi_filter_input(volume, "a mask", &in, err);
    if (st == CW_OK)
        st = cwi_filter_input(mask, "a mask", &m, err);
    if (st != CW_OK)
        return st;
    const size_t count = in.dim[0] * in.dim[1] * in.dim[2];
    work k = {.in = &in, .mask = &m, .inside = inside, .selected = cwi_alloc_array(count, 1)};
    if (!k.selected)
        return cwi_fail_memory(err);
    st = find_selected(&k, d, err);
    if (st == CW_OK)
        st = cwi_change_inside(&in, inside, k.selected, count, d, out, err);
    cwi_free(k.selected);
    return st;
}
