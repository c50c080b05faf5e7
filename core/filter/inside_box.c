/* Finds the box around what is inside of a level. */
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/filter/inside.h"
#include "core/volume/volume.h"

typedef struct work {
    const cw_volume *in;
    const cw_inside *inside;
    cw_box *boxes; /* one a slice, of x and y; count 0: nothing is inside */
    bool starved;
} work;

/* Widens the range of an axis by an index. */
static void include_index(cw_box *box, int a, size_t at)
{
    const size_t end = box->first[a] + box->count[a];
    if (!box->count[a]) {
        box->first[a] = at;
        box->count[a] = 1;
    } else if (at < box->first[a]) {
        box->count[a] = end - at;
        box->first[a] = at;
    } else if (at >= end) {
        box->count[a] = at + 1 - box->first[a];
    }
}

static void box_slice(void *context, size_t z)
{
    work *k = context;
    const size_t nx = k->in->dim[0];
    double *row = cwi_alloc_array(2 * nx, sizeof *row);
    if (!row)
        cwi_set_flag(&k->starved);
    for (size_t j = 0; j < k->in->dim[1] && row; j++) {
        size_t first = nx, last = 0;
        cwi_filter_load(k->in, j, z, row, row + nx);
        for (size_t i = 0; i < nx; i++)
            if (row[nx + i] > 0 && cwi_value_is_inside(k->in, k->inside, row[i])) {
                first = first < i ? first : i;
                last = i;
            }
        if (first == nx)
            continue;
        include_index(k->boxes + z, 0, first);
        include_index(k->boxes + z, 0, last);
        include_index(k->boxes + z, 1, j);
    }
    cwi_free(row);
}

/* Joins the boxes of slices, and widens the result by the margin. */
static void join_boxes(const work *k, size_t margin, cw_box *box)
{
    const size_t *dim = k->in->dim;
    for (size_t z = 0; z < dim[2]; z++) {
        const cw_box *b = k->boxes + z;
        if (!b->count[0])
            continue;
        include_index(box, 2, z);
        for (int a = 0; a < 2; a++) {
            include_index(box, a, b->first[a]);
            include_index(box, a, b->first[a] + b->count[a] - 1);
        }
    }
    for (int a = 0; a < 3 && box->count[0]; a++) {
        const size_t end = box->first[a] + box->count[a], left = dim[a] - end;
        const size_t low = box->first[a] < margin ? 0 : box->first[a] - margin;
        box->first[a] = low;
        box->count[a] = end + (left < margin ? left : margin) - low;
    }
}

cw_status cw_volume_inside_box(const cw_volume *volume, const cw_inside *inside, size_t margin,
                               int threads, cw_box *box, cw_error *err)
{
    CWI_REQUIRE(err, volume, inside, box);
    cw_volume in;
    *box = (cw_box){0};
    cw_status st = cwi_check_inside(inside, err);
    if (st == CW_OK)
        st = cw_volume_select(volume, 0, 0, &in, err);
    if (st == CW_OK)
        st = cwi_volume_expect_dense(&in, "a box around the inside", err);
    if (st != CW_OK)
        return st;
    work k = {
        .in = &in, .inside = inside, .boxes = cwi_alloc_zeroed(in.dim[2], sizeof *k.boxes)};
    if (!k.boxes)
        return cwi_fail_memory(err);
    st = cwi_parallel_for(in.dim[2], in.dim[0] * in.dim[1], threads, &(cw_progress){0},
                          "finding the inside", box_slice, &k, err);
    if (st == CW_OK && k.starved)
        st = cwi_fail_memory(err);
    if (st == CW_OK)
        join_boxes(&k, margin, box);
    cwi_free(k.boxes);
    if (st == CW_OK && !box->count[0])
        st = cwi_fail(err, CW_ERR_EMPTY, "no voxel is %s %g",
                      inside->inside_is_low ? "below" : "at or above", inside->level);
    return st;
}
