/* Interpolates the value of a volume trilinearly at a world point. */
#include "core/volume/volume.h"

#include <math.h>

/* Finds the cell and the fraction of the way through it along an axis. Rounding may move a
 * point on a border beyond it. Returns false outside. */
static bool find_cell(size_t dim, double index, size_t *cell, double *fraction)
{
    static const double ROUNDING = 1e-9; /* voxels */
    const double low = dim == 1 ? -0.5 : 0, high = dim == 1 ? 0.5 : (double)dim - 1;
    if (!(index >= low - ROUNDING && index <= high + ROUNDING))
        return false;
    if (dim == 1) {
        *cell = 0;
        *fraction = 0;
        return true;
    }
    const double inside = fmin(fmax(index, 0), high);
    *cell = (size_t)fmin(floor(inside), high - 1);
    *fraction = inside - (double)*cell;
    return true;
}

static double value_at(const cw_volume *v, const size_t at[3])
{
    const double x = cwi_voxel_at(v->type, cwi_voxel_address(v, at[0], at[1], at[2]));
    const bool has_value = isfinite(x) && !(v->has_nodata && x == v->nodata);
    return has_value ? v->slope * x + v->intercept : NAN;
}

double cw_volume_sample(const cw_volume *volume, const double world[3])
{
    if (!volume || !world)
        return NAN;
    cw_volume v;
    double index[3], fraction[3], sum = 0;
    size_t cell[3];
    if (cw_volume_resolve(volume, &v, NULL) != CW_OK || v.sparse || v.cells ||
        cw_volume_to_index(&v, world, index, NULL) != CW_OK)
        return NAN;
    for (int a = 0; a < 3; a++)
        if (!find_cell(v.dim[a], index[a], &cell[a], &fraction[a]))
            return NAN;
    for (int corner = 0; corner < 8; corner++) {
        size_t at[3];
        double weight = 1;
        for (int a = 0; a < 3; a++) {
            at[a] = cell[a] + (size_t)(corner >> a & 1);
            weight *= corner >> a & 1 ? fraction[a] : 1 - fraction[a];
        }
        if (weight > 0)
            sum += weight * value_at(&v, at);
    }
    return sum;
}
