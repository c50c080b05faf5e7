/* Smooths a volume with a Gaussian. */
#include "core/base/status.h"
#include "core/filter/filter_work.h"
#include "core/filter/separable.h"

#include <math.h>

static double gauss_kernel(double x, double sigma)
{
    return sigma > 0 ? exp(-0.5 * x * x / (sigma * sigma)) : 1;
}

static cw_status set_weights(cwi_axis_weights *w, size_t samples, double sigma, cw_error *err)
{
    const double reach = ceil(CWI_GAUSS_REACH * sigma);
    const size_t taps = 2 * (size_t)reach + 1;
    cw_status st = cwi_axis_weights_init(w, samples, taps < samples ? taps : samples, err);
    for (size_t n = 0; n < samples && st == CW_OK; n++)
        cwi_axis_weights_set(w, n, (double)n, samples, reach, gauss_kernel, sigma);
    return st;
}

cw_status cw_volume_gauss(const cw_volume *volume, const double sigma[3],
                          const cw_filter_desc *desc, cw_volume *out, cw_error *err)
{
    CWI_REQUIRE(err, volume, sigma, out);
    CWI_REQUIRE_VERSION(err, desc, 0);
    const cw_filter_desc none = {0}, *d = desc ? desc : &none;
    cwi_axis_weights w[3] = {{0}};
    cw_volume in;
    *out = (cw_volume){0};
    for (int a = 0; a < 3; a++)
        if (!(sigma[a] >= 0 && sigma[a] <= CWI_GAUSS_MAX))
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "sigma_voxels[%d] is %g; 0 to %d were expected", a, sigma[a],
                            CWI_GAUSS_MAX);
    cw_status st = cwi_filter_input(volume, "a Gaussian", &in, err);
    for (int a = 0; a < 3 && st == CW_OK; a++)
        st = set_weights(w + a, in.dim[a], sigma[a], err);
    if (st == CW_OK)
        st = cwi_separable_filter(&in, w, d, "smoothing", out, err);
    for (int a = 0; a < 3; a++)
        cwi_axis_weights_free(w + a);
    return st;
}
