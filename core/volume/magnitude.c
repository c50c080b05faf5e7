/* Computes the lengths of the vectors of a volume's components. */
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <math.h>

static float magnitude_at(const cw_volume *v, const char *voxel)
{
    double sum = 0;
    for (size_t c = 0; c < v->components; c++, voxel += v->component_stride) {
        const double x = cwi_voxel_at(v->type, voxel);
        if (v->has_nodata && x == v->nodata)
            return NAN;
        const double value = v->slope * x + v->intercept;
        sum += value * value;
    }
    return (float)sqrt(sum);
}

static cw_status check_components(const cw_volume *v, size_t step, cw_error *err)
{
    if (step >= v->steps)
        return cwi_fail(err, CW_ERR_ARGUMENT, "step %zu: the volume has %zu steps", step,
                        v->steps);
    if (v->components < 2)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "a magnitude is of several components, and the volume has one");
    return v->sparse ? cwi_fail(err, CW_ERR_UNSUPPORTED, "magnitudes on a sparse grid") : CW_OK;
}

typedef struct magnitude_job {
    const cw_volume *v;
    size_t step;
    float *to;
} magnitude_job;

static void measure_slice(void *context, size_t k)
{
    const magnitude_job *job = context;
    const cw_volume *v = job->v;
    for (size_t j = 0; j < v->dim[1]; j++) {
        const char *p = cwi_voxel_address(v, 0, j, k);
        p += (ptrdiff_t)job->step * v->step_stride;
        float *row = job->to + (k * v->dim[1] + j) * v->dim[0];
        for (size_t i = 0; i < v->dim[0]; i++)
            row[i] = magnitude_at(v, p + (ptrdiff_t)i * v->stride[0]);
    }
}

cw_status cw_volume_magnitude(const cw_volume *in, size_t step, int threads, cw_volume *out,
                              cw_error *err)
{
    CWI_REQUIRE(err, in, out);
    cw_volume v, m = {0};
    cw_status st = cw_volume_resolve(in, &v, err);
    if (st == CW_OK)
        st = check_components(&v, step, err);
    if (st == CW_OK)
        st = cw_volume_alloc(&m, CW_F32, v.dim, 1, 1, err);
    if (st != CW_OK)
        return st;
    magnitude_job job = {&v, step, cw_volume_voxels(&m)};
    cwi_parallel_for_all(v.dim[2], v.dim[0] * v.dim[1], threads, measure_slice, &job);
    for (int a = 0; a < 3; a++) {
        m.coordinates[a] = v.coordinates[a];
        for (int c = 0; c < 4; c++)
            m.affine[a][c] = v.affine[a][c];
    }
    m.cells = v.cells;
    m.known = v.known & (CW_KNOWN_UNIT | CW_KNOWN_FRAME);
    *out = m;
    return CW_OK;
}
