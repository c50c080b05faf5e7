/* Orders the layers of a lattice from the eye, tests ranges of values for visibility, and finds
 * gradients and masses of voxels. */
#include "viewer/scene/cell_lattice.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/volume/volume.h"

#include <math.h>

void cwi_lattice_eye(const cwi_frame *frame, double eye[3])
{
    const double at[3] = {0, 0, frame->perspective ? 0 : 1e6 * fmax(fabs(frame->far), 1)};
    cwi_affine_apply(frame->index_from_eye, at, eye);
}

void cwi_lattice_order(size_t count, double first, double step, double position, size_t *order)
{
    size_t low = 0, high = count;
    while (low < high) {
        const double below = fabs(first + step * (double)low - position);
        const double above = fabs(first + step * (double)(high - 1) - position);
        *order++ = below >= above ? low++ : --high;
    }
}

cw_status cwi_visible_make(const cwi_table *table, cwi_visible *visible, cw_error *err)
{
    visible->count = table->count;
    visible->before = cwi_alloc_array(table->count + 1, sizeof *visible->before);
    if (!visible->before)
        return cwi_fail_memory(err);
    visible->before[0] = 0;
    for (size_t n = 0; n < table->count; n++)
        visible->before[n + 1] = visible->before[n] + (table->rows[4 * n + 3] > 0);
    return CW_OK;
}

void cwi_visible_free(cwi_visible *visible)
{
    cwi_free(visible->before);
    *visible = (cwi_visible){0};
}

/* Returns the row of a coordinate, clamped; an interpolated row is as visible as those around
 * it. */
static float row_of(const cwi_visible *visible, float at)
{
    return (at < 0 ? 0 : at > 1 ? 1 : at) * (float)(visible->count - 1);
}

bool cwi_visible_any(const cwi_visible *visible, float low, float high)
{
    if (!(low <= high))
        return false;
    const size_t first = (size_t)floorf(row_of(visible, low)),
                 last = (size_t)ceilf(row_of(visible, high));
    return visible->before[last + 1] > visible->before[first];
}

/* A row of voxels to load: a coordinate in the table is voxel x scale + bias. */
typedef struct voxel_row {
    const char *from;
    ptrdiff_t stride;
    size_t count;
    double scale, bias;
    const double *nodata; /* NULL: every number is a value */
} voxel_row;

#define LOAD(name, ctype, text)                                                                \
    static void load_##name(const voxel_row *r, float *to)                                     \
    {                                                                                          \
        for (size_t i = 0; i < r->count; i++) {                                                \
            const double x = (double)*(const ctype *)(r->from + (ptrdiff_t)i * r->stride);     \
            to[i] = r->nodata && x == *r->nodata ? NAN : (float)(x * r->scale + r->bias);      \
        }                                                                                      \
    }
CW_TYPE_TABLE(LOAD)
#undef LOAD

static void (*const load_functions[CW_TYPE_COUNT])(const voxel_row *r, float *to) = {
#define ROW(name, ctype, text) load_##name,
    CW_TYPE_TABLE(ROW)
#undef ROW
};

void cwi_lattice_load(const cw_volume *v, const cwi_table *table, const size_t first[3],
                      const size_t count[3], float *out)
{
    voxel_row row = {.stride = v->stride[0], .count = count[0]};
    row.scale = v->slope / (table->high - table->low);
    row.bias = (v->intercept - table->low) / (table->high - table->low);
    row.nodata = v->has_nodata ? &v->nodata : NULL;
    for (size_t k = 0; k < count[2]; k++)
        for (size_t j = 0; j < count[1]; j++, out += count[0]) {
            row.from = cwi_voxel_address(v, first[0], first[1] + j, first[2] + k);
            load_functions[v->type](&row, out);
        }
}

static bool has_value(const cw_volume *v, size_t i, size_t j, size_t k)
{
    const double x = cwi_voxel_at(v->type, cwi_voxel_address(v, i, j, k));
    return isfinite(x) && !(v->has_nodata && x == v->nodata);
}

/* Returns true if the cell between two samples along each axis has values at all corners. */
static bool is_whole(const cw_volume *v, const size_t low[3], const size_t high[3])
{
    for (size_t k = low[2]; k <= high[2]; k++)
        for (size_t j = low[1]; j <= high[1]; j++)
            for (size_t i = low[0]; i <= high[0]; i++)
                if (!has_value(v, i, j, k))
                    return false;
    return true;
}

double cwi_lattice_mass(const cw_volume *v, const size_t at[3], bool has_gaps)
{
    int cells = 0;
    bool is_within = true;
    for (int a = 0; a < 3; a++)
        is_within = is_within && at[a] > 0 && at[a] + 1 < v->dim[a];
    if (is_within && !has_gaps)
        return 1;
    for (int n = 0; n < 8; n++) {
        size_t low[3], high[3];
        bool is_inside = true;
        for (int a = 0; a < 3; a++) {
            const bool is_above = n >> a & 1, is_flat = v->dim[a] == 1;
            is_inside =
                is_inside && (is_flat || (is_above ? at[a] + 1 < v->dim[a] : at[a] > 0));
            low[a] = is_flat || is_above ? at[a] : at[a] - 1;
            high[a] = is_flat || !is_above ? at[a] : at[a] + 1;
        }
        cells += is_inside && (!has_gaps || is_whole(v, low, high));
    }
    return cells / 8.0;
}

static double row_derivative(const cw_volume *v, const char *at, int axis, size_t n)
{
    const bool below = n > 0, above = n + 1 < v->dim[axis];
    if (!below && !above)
        return 0;
    const double a = cwi_voxel_at(v->type, below ? at - v->stride[axis] : at);
    const double b = cwi_voxel_at(v->type, above ? at + v->stride[axis] : at);
    const double d = (b - a) / (below && above ? 2 : 1);
    return isfinite(d) && !(v->has_nodata && (a == v->nodata || b == v->nodata)) ? d : 0;
}

/* Computes the derivative along an axis of uneven spacing: the slopes on both sides, each
 * weighted by the distance on the other side, which is exact for parabolas. */
static double uneven_derivative(const cw_volume *v, const char *at, int axis, size_t n)
{
    const double *x = v->coordinates[axis];
    const bool below = n > 0, above = n + 1 < v->dim[axis];
    if (!below && !above)
        return 0;
    const double a = cwi_voxel_at(v->type, below ? at - v->stride[axis] : at);
    const double b = cwi_voxel_at(v->type, above ? at + v->stride[axis] : at);
    const double low = below ? x[n] - x[n - 1] : 0, high = above ? x[n + 1] - x[n] : 0;
    double d = (b - a) / (low + high);
    if (below && above) {
        const double centre = cwi_voxel_at(v->type, at);
        d = ((centre - a) / low * high + (b - centre) / high * low) / (low + high);
    }
    return isfinite(d) && !(v->has_nodata && (a == v->nodata || b == v->nodata)) ? d : 0;
}

void cwi_lattice_gradient(const cw_volume *v, const size_t at[3], double gradient[3])
{
    const char *p = cwi_voxel_address(v, at[0], at[1], at[2]);
    for (int a = 0; a < 3; a++)
        gradient[a] = v->coordinates[a] ? uneven_derivative(v, p, a, at[a])
                                        : row_derivative(v, p, a, at[a]);
}
