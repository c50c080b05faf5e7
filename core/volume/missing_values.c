/* Tells of voxels that have no value: those of the no-data value, and NaN. */
#include "core/volume/missing_values.h"

#include <stdio.h>

void cwi_tell_missing(const cw_volume *v, const cw_statistics *counts,
                      char text[CWI_MISSING_TEXT])
{
    const double slope = v->slope != 0 ? v->slope : 1, value = slope * v->nodata + v->intercept;
    const size_t nodata = counts ? counts->nodata : 0, wild = counts ? counts->not_finite : 0;
    int used = 0;
    text[0] = '\0';
    if (nodata)
        used =
            snprintf(text, CWI_MISSING_TEXT,
                     "; %zu voxels have no value, since %.6g stands for none", nodata, value);
    else if (!counts && v->has_nodata)
        used = snprintf(text, CWI_MISSING_TEXT, "; voxels of %.6g count as without a value",
                        value);
    if (used)
        used += snprintf(text + used, CWI_MISSING_TEXT - (size_t)used,
                         " (desc->nodata = CW_NODATA_NONE makes a value of it)");
    if (wild)
        snprintf(text + used, CWI_MISSING_TEXT - (size_t)used,
                 "; %zu voxels are NaN or infinite", wild);
}
