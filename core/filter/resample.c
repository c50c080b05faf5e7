/* Samples a volume at other distances, by a kernel along each axis. */
#include "core/base/status.h"
#include "core/filter/resample_grid.h"
#include "core/filter/separable.h"
#include "core/geometry/vec3.h"
#include "core/volume/volume.h"

#include <math.h>

static const double MAX_SAMPLES = 1e9; /* samples along an axis */

/* The rounding of a number of steps. */
static const double SLACK = 1e-6;

static double linear_kernel(double x, double width)
{
    return fmax(0, 1 - fabs(x) / width);
}

/* The cubic through the samples that is exact for squares: a is -1/2 [Keys1981]. */
static double cubic_kernel(double x, double width)
{
    const double d = fabs(x) / width;
    return d < 1 ? (1.5 * d - 2.5) * d * d + 1 : d < 2 ? ((-0.5 * d + 2.5) * d - 4) * d + 2 : 0;
}

static double compute_sinc(double x)
{
    return x == 0 ? 1 : sin(CWI_PI * x) / (CWI_PI * x);
}

static double lanczos_kernel(double x, double width)
{
    const double d = fabs(x) / width;
    return d < 3 ? compute_sinc(d) * compute_sinc(d / 3) : 0;
}

typedef struct kernel {
    const char *name;
    double (*weight)(double x, double width);
    double reach;
} kernel;

static const kernel kernels[CW_KERNEL_COUNT] = {
    [CW_KERNEL_LINEAR] = {"linear", linear_kernel, 1},
    [CW_KERNEL_CUBIC] = {"cubic", cubic_kernel, 2},
    [CW_KERNEL_LANCZOS] = {"lanczos", lanczos_kernel, 3},
};

const char *cw_kernel_name(cw_kernel k)
{
    return (unsigned)k < CW_KERNEL_COUNT ? kernels[k].name : NULL;
}

static cw_status plan_axis(const cw_volume *in, int a, double spacing, cwi_sample_axis *out,
                           cw_error *err)
{
    const size_t last = in->dim[a] - 1;
    const double *at = in->coordinates[a];
    double mm[3];
    cw_volume_spacing(in, mm);
    const double old = at && last ? (at[last] - at[0]) / (double)last : 1;
    const double step = spacing > 0 && mm[a] > 0 ? old * (spacing / mm[a]) : old;
    const double steps = (double)last * old / step;
    if (!(steps < MAX_SAMPLES))
        return cwi_fail(err, CW_ERR_LIMIT,
                        "spacing_mm[%d] of %g makes more than %g samples along an axis", a,
                        spacing, MAX_SAMPLES);
    if (last && steps < 1 - SLACK)
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "spacing_mm[%d] of %g is more than the %g mm between the first and the last "
            "voxel: at least two samples were expected",
            a, spacing, (double)last * mm[a]);
    *out = (cwi_sample_axis){.first = at ? at[0] : 0,
                             .step = step,
                             .wider = fmax(1, step / old),
                             .count = (size_t)(steps + SLACK) + 1};
    return CW_OK;
}

cw_status cwi_sample_axes_plan(const cw_volume *in, const double spacing[3],
                               cwi_sample_axis axes[3], cw_error *err)
{
    cw_status st = CW_OK;
    for (int a = 0; a < 3; a++)
        if (!(spacing[a] >= 0) || !isfinite(spacing[a]))
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "spacing_mm[%d] is %g; 0 or a length was expected", a, spacing[a]);
    for (int a = 0; a < 3 && st == CW_OK; a++)
        st = plan_axis(in, a, spacing[a], axes + a, err);
    return st;
}

double cwi_sample_position(const cw_volume *in, int a, const cwi_sample_axis *axis, size_t n)
{
    const double at = axis->first + (double)n * axis->step;
    return in->dim[a] < 2 ? 0 : cwi_coordinate_index(in, a, at);
}

void cwi_sample_affine(const cw_volume *in, const cwi_sample_axis x[3], cw_volume *out)
{
    for (int r = 0; r < 3; r++) {
        out->affine[r][3] = in->affine[r][3];
        for (int a = 0; a < 3; a++) {
            out->affine[r][3] += in->affine[r][a] * x[a].first;
            out->affine[r][a] = in->affine[r][a] * x[a].step;
        }
    }
}

/* Returns how many samples of the input an output sample is made of. */
static size_t count_taps(const cwi_sample_axis *x, const kernel *k, size_t samples)
{
    const double most = floor(2 * k->reach * x->wider) + 1;
    return most < (double)samples ? (size_t)most : samples;
}

/* Fails if the result is too large, before anything is allocated. */
static cw_status check_size(const cw_volume *in, const cwi_sample_axis x[3], const kernel *k,
                            const cw_filter_desc *desc, cw_error *err)
{
    size_t dim[3], weights = 0;
    for (int a = 0; a < 3; a++) {
        dim[a] = x[a].count;
        weights += x[a].count *
                   (count_taps(x + a, k, in->dim[a]) * sizeof(double) + 2 * sizeof(size_t));
    }
    return cwi_filter_check_size(cw_filter_type(in), dim, desc, weights, err);
}

static cw_status set_weights(cwi_axis_weights *w, const cw_volume *in, int a,
                             const cwi_sample_axis *x, const kernel *k, cw_error *err)
{
    const double reach = k->reach * x->wider;
    const size_t samples = in->dim[a];
    cw_status st = cwi_axis_weights_init(w, x->count, count_taps(x, k, samples), err);
    for (size_t n = 0; n < x->count && st == CW_OK; n++) {
        const double position = cwi_sample_position(in, a, x, n);
        cwi_axis_weights_set(w, n, position, samples, reach, k->weight, x->wider);
    }
    return st;
}

static cw_status check_kernel(const cw_volume *in, cw_kernel k, cw_error *err)
{
    if (!cw_kernel_name(k))
        return cwi_fail(err, CW_ERR_ARGUMENT, "kernel is %d; a cw_kernel was expected", (int)k);
    if (k != CW_KERNEL_LINEAR && cwi_is_rectilinear(in))
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "a rectilinear grid is resampled with the linear kernel only");
    return CW_OK;
}

cw_status cw_volume_resample(const cw_volume *volume, const double spacing[3], cw_kernel k,
                             const cw_filter_desc *desc, cw_volume *out, cw_error *err)
{
    CWI_REQUIRE(err, volume, spacing, out);
    CWI_REQUIRE_VERSION(err, desc, 0);
    const cw_filter_desc none = {0}, *d = desc ? desc : &none;
    cwi_axis_weights w[3] = {{0}};
    cwi_sample_axis x[3];
    cw_volume in;
    *out = (cw_volume){0};
    cw_status st = cw_volume_select(volume, 0, 0, &in, err);
    if (st == CW_OK)
        st = cwi_volume_expect_dense(&in, "resampling", err);
    if (st == CW_OK)
        st = check_kernel(&in, k, err);
    if (st == CW_OK)
        st = cwi_sample_axes_plan(&in, spacing, x, err);
    if (st == CW_OK)
        st = check_size(&in, x, kernels + k, d, err);
    for (int a = 0; a < 3 && st == CW_OK; a++)
        st = set_weights(w + a, &in, a, x + a, kernels + k, err);
    if (st == CW_OK)
        st = cwi_separable_filter(&in, w, d, "resampling", out, err);
    if (st == CW_OK)
        cwi_sample_affine(&in, x, out);
    for (int a = 0; a < 3; a++)
        cwi_axis_weights_free(w + a);
    return st;
}
