/* Opens and closes what is inside of a level, by an ellipsoid. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/filter/inside.h"

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
        st = change_bytes(bytes, value, in.dim, radius, d, work, err);
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
