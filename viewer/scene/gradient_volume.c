/* Computes indices of voxels, and smooths volumes by a separable Gaussian. */
#include "viewer/scene/gradient_volume.h"

#include "viewer/scene/voxel_rows.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <math.h>
#include <string.h>

typedef struct job {
    const cwi_frame *frame;
    const size_t *dim;
    float *values;
    int axis;
    size_t reach;         /* of the kernel: weights at 0 to reach */
    const float *weights; /* of the kernel */
    bool is_starved;
} job;

/* Converts a layer to scaled values, or to their indices. */
static void convert_layer(void *context, size_t k)
{
    const job *work = context;
    const cw_volume *v = &work->frame->volume;
    const cw_transfer *t = &work->frame->transfer;
    for (size_t j = 0; j < v->dim[1]; j++) {
        float *to = work->values + (k * v->dim[1] + j) * v->dim[0];
        cwi_row_load(v, cwi_voxel_address(v, 0, j, k), v->dim[0], to);
        for (size_t i = 0; i < v->dim[0]; i++) {
            const double value = v->slope * (double)to[i] + v->intercept;
            to[i] = isfinite(value) ? (float)cw_transfer_index(t, value) : NAN;
        }
    }
}

/* Smooths lines that lie side by side, in place. Voxels without a value keep none, and have no
 * weight; neither have places beyond the border.
 * count, step    of the voxels of a line
 * lines          number of lines, one float apart
 * scratch        room for count x lines + 2 lines floats */
static void smooth_lines(const job *work, float *first, size_t count, size_t step, size_t lines,
                         float *scratch)
{
    float *sum = scratch + count * lines, *weight = sum + lines;
    for (size_t n = 0; n < count; n++)
        memcpy(scratch + n * lines, first + n * step, lines * sizeof *scratch);
    for (size_t n = 0; n < count; n++) {
        const size_t low = n > work->reach ? n - work->reach : 0;
        const size_t high = n + work->reach < count ? n + work->reach : count - 1;
        memset(sum, 0, 2 * lines * sizeof *sum);
        for (size_t m = low; m <= high; m++) {
            const float w = work->weights[m > n ? m - n : n - m];
            const float *from = scratch + m * lines;
            for (size_t i = 0; i < lines; i++) {
                const bool is_value = from[i] == from[i];
                sum[i] += is_value ? w * from[i] : 0;
                weight[i] += is_value ? w : 0;
            }
        }
        for (size_t i = 0; i < lines; i++)
            first[n * step + i] =
                scratch[n * lines + i] == scratch[n * lines + i] ? sum[i] / weight[i] : NAN;
    }
}

/* Smooths a plane of lines along the axis: that of a z for lines along x and y, that of a y for
 * lines along z. */
static void smooth_plane(void *context, size_t n)
{
    job *work = context;
    const size_t *dim = work->dim, layer = dim[0] * dim[1], count = dim[work->axis];
    float *scratch = cwi_alloc_array((count + 2) * (work->axis ? dim[0] : 1), sizeof *scratch);
    if (!scratch) {
        cwi_set_flag(&work->is_starved);
        return;
    }
    if (work->axis == 2)
        smooth_lines(work, work->values + n * dim[0], count, layer, dim[0], scratch);
    else if (work->axis == 1)
        smooth_lines(work, work->values + n * layer, count, dim[0], dim[0], scratch);
    for (size_t j = 0; j < dim[1] && work->axis == 0; j++)
        smooth_lines(work, work->values + n * layer + j * dim[0], count, 1, 1, scratch);
    cwi_free(scratch);
}

/* Smooths along an axis by a Gaussian with a standard deviation in voxels. */
static cw_status smooth_axis(job *work, int axis, double sigma, cw_error *err)
{
    const cw_scene *s = &work->frame->scene;
    const size_t planes = work->dim[axis == 2 ? 1 : 2];
    const size_t reach = (size_t)ceil(3 * sigma);
    float *weights = cwi_alloc_array(reach + 1, sizeof *weights);
    if (!weights)
        return cwi_fail_memory(err);
    for (size_t n = 0; n <= reach; n++)
        weights[n] = (float)exp(-0.5 * (double)(n * n) / (sigma * sigma));
    work->axis = axis;
    work->reach = reach;
    work->weights = weights;
    cw_status st =
        cwi_parallel_for(planes, work->dim[0] * work->dim[axis == 2 ? 2 : 1] * (2 * reach + 1),
                         s->threads, &s->progress, "smoothing", smooth_plane, work, err);
    cwi_free(weights);
    if (st == CW_OK && work->is_starved)
        st = cwi_fail_memory(err);
    return st;
}

static cw_status make_values(const cwi_frame *f, float *values, cw_error *err)
{
    const cw_scene *s = &f->scene;
    const size_t *dim = f->volume.dim;
    double spacing[3];
    job work = {.frame = f, .dim = dim, .values = values};
    cw_status st = cwi_parallel_for(dim[2], 4 * dim[0] * dim[1], s->threads, &s->progress,
                                    "classifying", convert_layer, &work, err);
    cw_volume_spacing(&f->volume, spacing);
    for (int a = 0; a < 3 && st == CW_OK && s->gradient_sigma > 0; a++)
        if (dim[a] > 1)
            st = smooth_axis(&work, a, s->gradient_sigma * f->unit_mm / spacing[a], err);
    return st;
}

/* Puts the values in the frame, in place of its volume. */
static void replace_volume(const cwi_gradient_volume *made, cwi_frame *f)
{
    cw_volume *v = &f->gradient_volume;
    *v = f->volume;
    v->data = made->values;
    v->type = CW_F32;
    v->stride[0] = (ptrdiff_t)sizeof(float);
    v->stride[1] = v->stride[0] * (ptrdiff_t)v->dim[0];
    v->stride[2] = v->stride[1] * (ptrdiff_t)v->dim[1];
    v->slope = 1;
    v->intercept = 0;
    v->has_nodata = false;
    f->gradient_version = made->version;
}

static cw_status make_volume(cwi_gradient_volume *made, const cwi_frame *f, cw_error *err)
{
    const size_t *dim = f->volume.dim, version = made->version;
    cwi_gradient_volume_free(made);
    float *values = cwi_alloc_array(dim[0] * dim[1] * dim[2], sizeof *values);
    if (!values)
        return cwi_fail_memory(err);
    cw_status st = make_values(f, values, err);
    if (st == CW_OK)
        made->values = values;
    else
        cwi_free(values);
    made->key = f->volume;
    made->sigma = f->scene.gradient_sigma;
    made->version = version + 1;
    return st;
}

cw_status cwi_gradient_volume_take(cwi_gradient_volume *made, cwi_frame *f, cw_error *err)
{
    const double sigma = f->scene.gradient_sigma;
    cw_transfer indices;
    cw_status st = CW_OK;
    if (!f->volume.data || !cwi_frame_needs_gradients(f) ||
        (f->transfer.index_count == 0 && !(sigma > 0)))
        return CW_OK;
    if (sigma > 0 && cwi_volume_kind(&f->volume))
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "gradients are smoothed on evenly spaced volumes, not on %s",
                        cwi_volume_kind(&f->volume));
    memset(&indices, 0, sizeof indices); /* keys are compared by their bytes */
    indices.index_count = f->transfer.index_count;
    memcpy(indices.indices, f->transfer.indices, sizeof indices.indices);
    if (!made->values || memcmp(&made->key, &f->volume, sizeof made->key) != 0 ||
        memcmp(&made->transfer, &indices, sizeof indices) != 0 || made->sigma != sigma)
        st = make_volume(made, f, err);
    if (st != CW_OK)
        return st;
    memcpy(&made->transfer, &indices, sizeof indices);
    replace_volume(made, f);
    return CW_OK;
}

void cwi_gradient_volume_free(cwi_gradient_volume *made)
{
    const size_t version = made->version; /* numbers go on */
    cwi_free(made->values);
    *made = (cwi_gradient_volume){.version = version};
}
