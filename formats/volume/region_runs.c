/* Plans the runs of bytes that a region of a file's voxels consists of. */
#include "formats/volume/region_runs.h"

/* Plans the runs. As long as all of the faster axes is wanted, the wanted part of an axis is
 * contiguous. */
void cwi_runs_plan(cwi_runs *runs, const cwi_source *src, const cw_box *box,
                   const size_t every[3])
{
    uint64_t stride = cw_type_size(src->shape.type);
    *runs = (cwi_runs){.end = stride, .bytes = stride};
    for (size_t a = 0; a < src->axis_count; a++) {
        const cwi_axis *axis = &src->axes[a];
        const bool part = box && axis->role <= CWI_AXIS_Z;
        const size_t first = part ? box->first[axis->role] : 0;
        const size_t step = axis->role <= CWI_AXIS_Z ? every[axis->role] : 1;
        const size_t all = part ? box->count[axis->role] : axis->size;
        const size_t count = (all - 1) / step + 1;
        runs->next += first * stride;
        runs->end += (first + (count - 1) * step) * stride;
        if (runs->bytes == stride && step == 1) {
            runs->bytes *= count;
        } else {
            runs->axes[runs->axis_count].stride = stride * step;
            runs->axes[runs->axis_count++].count = count;
        }
        stride *= axis->size;
    }
    runs->left = runs->bytes;
}

void cwi_runs_take(cwi_runs *runs, uint64_t bytes)
{
    runs->next += bytes;
    runs->left -= bytes;
    if (runs->left > 0 || runs->next == runs->end)
        return;
    runs->next -= runs->bytes;
    for (size_t a = 0; a < runs->axis_count; a++) {
        runs->next += runs->axes[a].stride;
        if (++runs->axes[a].at < runs->axes[a].count)
            break;
        runs->next -= runs->axes[a].count * runs->axes[a].stride;
        runs->axes[a].at = 0;
    }
    runs->left = runs->bytes;
}
