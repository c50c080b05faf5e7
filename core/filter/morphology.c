/* Opens and closes what is inside of a level, by an ellipsoid. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/filter/inside.h"

#include <math.h>
#include <string.h>

/* Replaces bytes by those that have a voxel with `value` within the radius, twice: first of one side,
 * then of the other. What is left of the first is not `value`. */
static cw_status change_bytes(uint8_t *bytes, uint8_t value, const size_t dim[3],
                              const double radius[3], const cw_filter_desc *desc, uint8_t *work,
                              cw_error *err)
{
    const size_t count = dim[0] * dim[1] * dim[2];
    cw_status st = cwi_spread_bytes(bytes, value, dim, radius, desc, work, err);
    if (st == CW_OK) /* where work is 0, the other side is left */
        st = cwi_spread_bytes(work, 0, dim, radius, desc, bytes, err);
    for (size_t n = 0; n < count && st == CW_OK; n++)
        bytes[n] = bytes[n] ? !value : value;
    return st;
}

/* Voxels around those that are inside, with room for an ellipsoid at every side. */
typedef struct padded_box {
    size_t low[3], size[3]; /* of the voxels, in the volume */
    size_t pad[3], dim[3];  /* at each side; with it */
} padded_box;

/* Returns false if no voxel is inside. */
static bool find_padded_box(const uint8_t *bytes, const size_t dim[3], const double radius[3],
                            padded_box *box)
{
    size_t low[3] = {SIZE_MAX, SIZE_MAX, SIZE_MAX}, high[3] = {0, 0, 0};
    for (size_t z = 0, n = 0; z < dim[2]; z++)
        for (size_t y = 0; y < dim[1]; y++)
            for (size_t x = 0; x < dim[0]; x++, n++) {
                const size_t at[3] = {x, y, z};
                for (int a = 0; bytes[n] && a < 3; a++) {
                    low[a] = at[a] < low[a] ? at[a] : low[a];
                    high[a] = at[a] > high[a] ? at[a] : high[a];
                }
            }
    for (int a = 0; a < 3; a++) {
        box->low[a] = low[a];
        box->size[a] = high[a] - low[a] + 1;
        box->pad[a] = (size_t)ceil(radius[a]);
        box->dim[a] = box->size[a] + 2 * box->pad[a];
    }
    return low[0] != SIZE_MAX;
}

/* Copies the rows of the box between the volume's bytes and padded ones. */
static void copy_rows(const padded_box *box, const size_t dim[3], uint8_t *bytes,
                      uint8_t *padded, bool back)
{
    for (size_t z = 0; z < box->size[2]; z++)
        for (size_t y = 0; y < box->size[1]; y++) {
            uint8_t *in = bytes + ((z + box->low[2]) * dim[1] + y + box->low[1]) * dim[0] +
                          box->low[0],
                    *out = padded +
                           ((z + box->pad[2]) * box->dim[1] + y + box->pad[1]) * box->dim[0] +
                           box->pad[0];
            memcpy(back ? in : out, back ? out : in, box->size[0]);
        }
}

/* Closes bytes. What an ellipsoid reaches beyond the volume counts, so that the result stays in the convex
 * hull of what was inside. */
static cw_status close_bytes(const cw_volume *in, uint8_t *bytes, const double radius[3],
                             const cw_filter_desc *d, cw_error *err)
{
    padded_box box;
    if (!find_padded_box(bytes, in->dim, radius, &box))
        return CW_OK;
    const size_t count = box.dim[0] * box.dim[1] * box.dim[2];
    cw_status st = cwi_filter_check_size(in->type, in->dim, d,
                                         in->dim[0] * in->dim[1] * in->dim[2] + 2 * count, err);
    if (st != CW_OK)
        return st;
    uint8_t *padded = cwi_alloc_zeroed(count, 1), *work = cwi_alloc_array(count, 1);
    st = padded && work ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK) {
        copy_rows(&box, in->dim, bytes, padded, false);
        st = change_bytes(padded, 1, box.dim, radius, d, work, err);
    }
    if (st == CW_OK)
        copy_rows(&box, in->dim, bytes, padded, true);
    cwi_free(padded);
    cwi_free(work);
    return st;
}

static cw_status change_volume(const cw_volume *volume, const double radius[3], uint8_t value,
                               const cw_inside *inside, const cw_filter_desc *desc,
                               cw_volume *out, cw_error *err)
{
    const cw_filter_desc none = {0}, *d = desc ? desc : &none;
    cw_volume in;
    cw_status st = cwi_check_radius(radius, err);
    if (st == CW_OK)
        st = cwi_check_inside(inside, err);
    if (st == CW_OK)
        st = cwi_filter_input(volume, value ? "closing" : "opening", &in, err);
    if (st != CW_OK)
        return st;
    const size_t count = in.dim[0] * in.dim[1] * in.dim[2];
    st = cwi_filter_check_size(in.type, in.dim, d, 2 * count, err);
    if (st != CW_OK)
        return st;
    uint8_t *bytes = cwi_alloc_array(count, 2), *work = bytes ? bytes + count : NULL;
    if (!bytes)
        return cwi_fail_memory(err);
    st = cwi_find_inside(&in, inside, d, bytes, err);
    if (st == CW_OK)
        st = value ? close_bytes(&in, bytes, radius, d, err)
                   : change_bytes(bytes, 0, in.dim, radius, d, work, err);
    if (st == CW_OK)
        st = cwi_change_inside(&in, inside, bytes, 2 * count, d, out, err);
    cwi_free(bytes);
    return st;
}

cw_status cw_volume_open(const cw_volume *volume, const double radius[3],
                         const cw_inside *inside, const cw_filter_desc *desc, cw_volume *out,
                         cw_error *err)
{
    CWI_REQUIRE(err, volume, radius, inside, out);
    CWI_REQUIRE_VERSION(err, desc, 0);
    *out = (cw_volume){0};
    return change_volume(volume, radius, 0, inside, desc, out, err);
}

cw_status cw_volume_close(const cw_volume *volume, const double radius[3],
                          const cw_inside *inside, const cw_filter_desc *desc, cw_volume *out,
                          cw_error *err)
{
    CWI_REQUIRE(err, volume, radius, inside, out);
    CWI_REQUIRE_VERSION(err, desc, 0);
    *out = (cw_volume){0};
    return change_volume(volume, radius, 1, inside, desc, out, err);
}
