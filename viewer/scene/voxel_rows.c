/* Converts rows of voxels of any type to floats, with NaN for voxels without value. */
#include "viewer/scene/voxel_rows.h"

#include "core/volume/volume.h"

#include <math.h>

#define LOAD(name, ctype, text)                                                                \
    static void load_##name(const char *from, ptrdiff_t stride, size_t count, float *to)       \
    {                                                                                          \
        const ctype *row = (const ctype *)from;                                                \
        if (stride == (ptrdiff_t)sizeof *row)                                                  \
            for (size_t i = 0; i < count; i++)                                                 \
                to[i] = (float)row[i];                                                         \
        else                                                                                   \
            for (size_t i = 0; i < count; i++)                                                 \
                to[i] = (float)*(const ctype *)(from + (ptrdiff_t)i * stride);                 \
    }
CW_TYPE_TABLE(LOAD)
#undef LOAD

void cwi_row_load(const cw_volume *v, const void *from, size_t count, float *to)
{
    switch (v->type) {
#define CASE(name, ctype, text)                                                                \
    case name:                                                                                 \
        load_##name(from, v->stride[0], count, to);                                            \
        break;
        CW_TYPE_TABLE(CASE)
#undef CASE
    default:
        break;
    }
    for (size_t i = 0; i < count && v->has_nodata; i++)
        if (cwi_voxel_at(v->type, (const char *)from + (ptrdiff_t)i * v->stride[0]) ==
            v->nodata)
            to[i] = NAN;
}

const float *cwi_row_of(const cw_volume *v, const void *from, size_t count, float *buffer)
{
    if (v->type == CW_F32 && v->stride[0] == (ptrdiff_t)sizeof(float) && !v->has_nodata)
        return from;
    cwi_row_load(v, from, count, buffer);
    return buffer;
}
