/* Reading and writing single voxels of any type. */
#ifndef CORE_VOLUME_H
#define CORE_VOLUME_H

#include <cubewright/volume.h>

#include <math.h>

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

/* Stores a number that the type can hold; integers are rounded to the nearest. */
static inline void cwi_voxel_put(cw_type type, void *p, double value)
{
    switch (type) {
    case CW_F32:
        *(float *)p = (float)value;
        break;
    case CW_F64:
        *(double *)p = value;
        break;
#define CASE(name, ctype)                                                                      \
    case name:                                                                                 \
        *(ctype *)p = (ctype)rint(value);                                                      \
        break;
        CASE(CW_U8, uint8_t)
        CASE(CW_I8, int8_t)
        CASE(CW_U16, uint16_t)
        CASE(CW_I16, int16_t)
        CASE(CW_U32, uint32_t)
        CASE(CW_I32, int32_t)
#undef CASE
    default:
        break;
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
