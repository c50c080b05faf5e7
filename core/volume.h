/* Reading single voxels of any type. */
#ifndef CORE_VOLUME_H
#define CORE_VOLUME_H

#include <cubewright/volume.h>

/* The stored number at an address, as it stands in memory; exact, as every type fits a double.
 */
static inline double cwi_voxel_at(cw_type type, const void *p)
{
    switch (type) {
#define CASE(name, ctype, text)                                                                \
    case name:                                                                                 \
        return (double)*(const ctype *)p;
        CW_TYPE_TABLE(CASE)
#undef CASE
    default:
        return 0;
    }
}

/* Leaves of a volume's shape (sizes and affine) what is inside a box; data are not touched.
 * Returns CW_ERR_ARGUMENT when the box is empty or leaves the volume. */
CW_API cw_status cwi_volume_shrink(cw_volume *v, const cw_box *box, cw_error *err);

static inline const void *cwi_voxel_address(const cw_volume *v, size_t i, size_t j, size_t k)
{
    return (const char *)v->data + (ptrdiff_t)i * v->stride[0] + (ptrdiff_t)j * v->stride[1] +
           (ptrdiff_t)k * v->stride[2];
}

#endif
