/* Sets the value of voxels that have none, as the caller states it. */
#include "formats/volume/no_data.h"

#include "core/base/status.h"

#include <math.h>

/* The range of whole numbers that a type holds; false: it holds floats. */
static bool find_range(cw_type type, double *low, double *high)
{
    const double bits = 8 * (double)cw_type_size(type);
    const bool is_signed = type == CW_I8 || type == CW_I16 || type == CW_I32;
    if (type == CW_F32 || type == CW_F64)
        return false;
    *low = is_signed ? -ldexp(1, (int)bits - 1) : 0;
    *high = ldexp(1, (int)bits - is_signed) - 1;
    return true;
}

/* Finds the stored number of a value; false: no voxel of the volume's type has that value. */
static bool find_stored(const cw_volume *v, double value, double *stored)
{
    double low, high;
    const double exact = (value - v->intercept) / v->slope;
    if (!find_range(v->type, &low, &high)) {
        *stored = v->type == CW_F32 ? (double)(float)exact : exact;
        return isfinite(*stored);
    }
    *stored = round(exact);
    return fabs(*stored - exact) <= 1e-6 * fmax(1, fabs(exact)) && *stored >= low &&
           *stored <= high;
}

cw_status cwi_set_nodata(const cw_read_desc *desc, cw_volume *v, cw_error *err)
{
    double stored = 0;
    if (desc->nodata == CW_NODATA_FILE)
        return CW_OK;
    if (desc->nodata == CW_NODATA_VALUE && !find_stored(v, desc->nodata_value, &stored))
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "no voxel can have the value %.9g that desc->nodata states as none: they "
            "are %s, of slope %.9g and intercept %.9g",
            desc->nodata_value, cw_type_name(v->type), v->slope, v->intercept);
    v->has_nodata = desc->nodata == CW_NODATA_VALUE;
    v->nodata = stored;
    return CW_OK;
}
