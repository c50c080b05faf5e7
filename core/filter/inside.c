/* Finds voxels inside of a level, and moves voxels to the other side of it. */
#include "core/filter/inside.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <math.h>
#include <string.h>

typedef struct work {
    const cw_volume *in;
    cw_volume *out;
    const cw_inside *inside;
    const uint8_t *selected;
    uint8_t *found;
    double mirror;    /* stored number at the level */
    double low, high; /* of the type */
    bool is_integer, has_gaps, starved, stuck;
} work;

bool cwi_value_is_inside(const cw_volume *in, const cw_inside *inside, double stored)
{
    const double value = in->slope * stored + in->intercept;
    return inside->inside_is_low ? value < inside->level : value >= inside->level;
}

cw_status cwi_check_inside(const cw_inside *inside, cw_error *err)
{
    return isfinite(inside->level)
               ? CW_OK
               : cwi_fail(err, CW_ERR_ARGUMENT, "inside->level is %g; a number was expected",
                          inside->level);
}

/* Allocates the memory for a row and which of it are values. */
static double *alloc_row(work *k)
{
    double *row = cwi_alloc_array(2 * k->in->dim[0], sizeof *row);
    if (!row)
        cwi_set_flag(&k->starved);
    return row;
}

static void find_in_slice(void *context, size_t z)
{
    work *k = context;
    const size_t nx = k->in->dim[0], ny = k->in->dim[1];
    double *row = alloc_row(k);
    for (size_t j = 0; j < ny && row; j++) {
        uint8_t *to = k->found + (z * ny + j) * nx;
        cwi_filter_load(k->in, j, z, row, row + nx);
        for (size_t i = 0; i < nx; i++)
            to[i] = row[nx + i] > 0 && cwi_value_is_inside(k->in, k->inside, row[i]);
    }
    cwi_free(row);
}

cw_status cwi_find_inside(const cw_volume *in, const cw_inside *inside,
                          const cw_filter_desc *desc, uint8_t *to, cw_error *err)
{
    work k = {.in = in, .inside = inside, .found = to};
    cw_status st =
        cwi_parallel_for(in->dim[2], in->dim[0] * in->dim[1], desc->threads, &desc->progress,
                         "finding the inside", find_in_slice, &k, err);
    if (st == CW_OK && k.starved)
        st = cwi_fail_memory(err);
    return st;
}

/* Returns the next number of the type, up or down. */
static double step_number(const work *k, double x, bool up)
{
    if (k->is_integer)
        return up ? x + 1 : x - 1;
    return k->in->type == CW_F32 ? (double)nextafterf((float)x, up ? INFINITY : -INFINITY)
                                 : nextafter(x, up ? (double)INFINITY : (double)-INFINITY);
}

/* Returns the mirror image of a stored number at the level. Near the level or beyond the type, it is
 * the nearest number that is on the other side, and not no data. */
static double mirror_number(work *k, double stored)
{
    const bool was = cwi_value_is_inside(k->in, k->inside, stored),
               up = stored < k->mirror || (stored == k->mirror && k->in->slope < 0);
    double x = 2 * k->mirror - stored;
    if (k->is_integer)
        x = fmin(fmax(rint(x), k->low), k->high);
    else if (k->in->type == CW_F32)
        x = (double)(float)x;
    for (int tries = 0; tries < 4; tries++) { /* rounding takes one, no data another */
        if (cwi_value_is_inside(k->in, k->inside, x) != was &&
            !(k->in->has_nodata && x == k->in->nodata))
            break;
        x = step_number(k, x, up);
    }
    if (cwi_value_is_inside(k->in, k->inside, x) == was || x < k->low || x > k->high) {
        cwi_set_flag(&k->stuck);
        return stored;
    }
    return x;
}

static void change_slice(void *context, size_t z)
{
    work *k = context;
    const size_t nx = k->in->dim[0], ny = k->in->dim[1], size = cw_type_size(k->in->type);
    double *row = alloc_row(k);
    for (size_t j = 0; j < ny && row; j++) {
        const uint8_t *selected = k->selected + (z * ny + j) * nx;
        char *to = (char *)cw_volume_voxels(k->out) + (z * ny + j) * nx * size;
        cwi_filter_load(k->in, j, z, row, row + nx);
        for (size_t i = 0; i < nx; i++, to += size)
            if (row[nx + i] > 0 &&
                cwi_value_is_inside(k->in, k->inside, row[i]) != (selected[i] != 0))
                cwi_voxel_put(k->out->type, to, mirror_number(k, row[i]));
            else
                memcpy(to, cwi_voxel_address(k->in, i, j, z), size);
    }
    cwi_free(row);
}

static void set_limits(work *k)
{
    static const double limits[CW_TYPE_COUNT][2] = {
        [CW_U8] = {0, UINT8_MAX},           [CW_I8] = {INT8_MIN, INT8_MAX},
        [CW_U16] = {0, UINT16_MAX},         [CW_I16] = {INT16_MIN, INT16_MAX},
        [CW_U32] = {0, (double)UINT32_MAX}, [CW_I32] = {INT32_MIN, INT32_MAX},
    };
    k->is_integer = k->in->type != CW_F32 && k->in->type != CW_F64;
    k->low = k->is_integer ? limits[k->in->type][0] : (double)-INFINITY;
    k->high = k->is_integer ? limits[k->in->type][1] : (double)INFINITY;
}

cw_status cwi_change_inside(const cw_volume *in, const cw_inside *inside,
                            const uint8_t *selected, size_t bytes, const cw_filter_desc *desc,
                            cw_volume *out, cw_error *err)
{
    work k = {.in = in, .out = out, .inside = inside, .selected = selected};
    k.mirror = (inside->level - in->intercept) / in->slope;
    set_limits(&k);
    cw_status st = cwi_filter_result(in, in->type, in->dim, desc, bytes, out, err);
    if (st != CW_OK)
        return st;
    st = cwi_parallel_for(in->dim[2], in->dim[0] * in->dim[1], desc->threads, &desc->progress,
                          "changing the inside", change_slice, &k, err);
    if (st == CW_OK && k.starved)
        st = cwi_fail_memory(err);
    if (st == CW_OK && k.stuck)
        st = cwi_fail(err, CW_ERR_ARGUMENT,
                      "inside->level is %g: voxels of type %s have no value on its other side",
                      inside->level, cw_type_name(in->type));
    if (st != CW_OK)
        cw_volume_free(out);
    return st;
}
