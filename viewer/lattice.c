#include "viewer/lattice.h"

#include "core/affine.h"
#include "core/memory.h"
#include "core/status.h"
#include "core/volume.h"

#include <math.h>

void cwi_lattice_eye(const cwi_frame *frame, double eye[3])
{
    const double at[3] = {0, 0, frame->perspective ? 0 : 1e6 * fmax(fabs(frame->far), 1)};
    cwi_affine_apply(frame->index_from_eye, at, eye);
}

void cwi_lattice_order(size_t count, double first, double step, double place, size_t *order)
{
    size_t low = 0, high = count;
    while (low < high) {
        const double below = fabs(first + step * (double)low - place);
        const double above = fabs(first + step * (double)(high - 1) - place);
        *order++ = below >= above ? low++ : --high;
    }
}

cw_status cwi_visible_make(const cwi_table *table, cwi_visible *visible, cw_error *err)
{
    visible->count = table->count;
    visible->before = cwi_alloc_array(table->count + 1, sizeof *visible->before);
    if (!visible->before)
        return cw_fail(err, CW_ERR_NO_MEMORY, "no memory for what is visible");
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

/* Clamped; a row that is interpolated is as visible as those around it. */
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

void cwi_lattice_load(const cwi_frame *frame, const cwi_table *table, const size_t first[3],
                      const size_t count[3], float *out)
{
    const cw_volume *v = &frame->volume;
    const double scale = v->slope / (table->high - table->low);
    const double bias = (v->intercept - table->low) / (table->high - table->low);
    for (size_t k = 0; k < count[2]; k++)
        for (size_t j = 0; j < count[1]; j++) {
            const char *p = cwi_voxel_address(v, first[0], first[1] + j, first[2] + k);
            for (size_t i = 0; i < count[0]; i++, p += v->stride[0]) {
                const double x = cwi_voxel_at(v->type, p);
                const bool is_empty = v->has_nodata && x == v->nodata;
                *out++ = is_empty ? NAN : (float)(x * scale + bias);
            }
        }
}
