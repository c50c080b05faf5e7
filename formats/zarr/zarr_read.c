/* Reads the volume of a Zarr store, or a part of it, and lists its levels. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/volume.h"
#include "formats/volume/named_arrays.h"
#include "formats/volume/slice_visit.h"
#include "formats/zarr/zarr_dialect.h"

#include <stdio.h>
#include <string.h>

static cwi_zarr_desc describe_opening(const cwi_zarr_dialect *dialect, const cw_read_desc *desc)
{
    return (cwi_zarr_desc){.array = desc->array,
                           .level = desc->level,
                           .allow_external = desc->allow_external,
                           .dialect = dialect};
}

/* Sets the strides of packed voxels, and counts their bytes. */
static cw_status pack_shape(const char *field, cw_volume *v, size_t *bytes, cw_error *err)
{
    size_t stride = cw_type_size(v->type);
    const size_t counts[] = {v->dim[0], v->dim[1], v->dim[2], v->components, v->steps};
    ptrdiff_t *const strides[] = {&v->stride[0], &v->stride[1], &v->stride[2],
                                  &v->component_stride, &v->step_stride};
    for (size_t n = 0; n < sizeof counts / sizeof *counts; n++) {
        *strides[n] = (ptrdiff_t)stride;
        if (!cwi_size_mul(stride, counts[n], &stride) || stride > PTRDIFF_MAX)
            return cwi_fail(err, CW_ERR_LIMIT,
                            "'%s' asks for more voxels than an address space holds", field);
    }
    *bytes = stride;
    return CW_OK;
}

/* Narrows the shape to the wanted part, and the box to its voxels. */
static cw_status narrow_shape(const cwi_zarr *zarr, const cw_read_desc *desc, cw_volume *v,
                              cwi_zarr_box *box, size_t *bytes, cw_error *err)
{
    const char *field = zarr->array.words->shape;
    size_t every[3];
    cw_status st = desc->region ? cwi_volume_shrink(v, desc->region, err) : CW_OK;
    for (int a = 0; a < 3; a++) {
        every[a] = desc->every[a] ? desc->every[a] : 1;
        box->first[a] = desc->region ? desc->region->first[a] : 0;
        box->count[a] = v->dim[a];
        box->every[a] = every[a];
    }
    box->count[CWI_AXIS_COMPONENT] = v->components;
    box->count[CWI_AXIS_STEP] = v->steps;
    if (st == CW_OK)
        st = cwi_volume_thin(v, every, err);
    for (int a = 0; st == CW_OK && a < 3; a++) /* those beyond the last step are left out */
        box->count[a] = (v->dim[a] - 1) * every[a] + 1;
    if (st == CW_OK)
        st = pack_shape(field, v, bytes, err);
    return st == CW_OK ? cwi_check_limits(v, *bytes, desc->region ? "region" : field, desc, err)
                       : st;
}

/* The slices of a box. */
typedef struct slice_reading {
    cwi_zarr *zarr;
    cwi_zarr_box box;
} slice_reading;

static cw_status read_slices(void *user, size_t first, size_t count, void *to, cw_error *err)
{
    static const cw_progress quiet = {0};
    const slice_reading *s = user;
    cwi_zarr_box box = s->box;
    box.first[CWI_AXIS_Z] += first * box.every[CWI_AXIS_Z];
    box.count[CWI_AXIS_Z] = (count - 1) * box.every[CWI_AXIS_Z] + 1;
    return cwi_zarr_read_box(s->zarr, &box, to, &quiet, err);
}

/* Gives the slices of one component and step to the visitor. */
static cw_status visit_slices(cwi_zarr *zarr, cwi_slice_visit *visit, const cw_read_desc *desc,
                              cw_error *err)
{
    cw_volume v = *cwi_zarr_shape(zarr);
    cw_read_desc limits = *desc;
    slice_reading s = {.zarr = zarr};
    size_t bytes = 0;
    limits.max_bytes = 0; /* voxels are not read at once */
    cwi_set_spacing(&v, desc);
    cw_status st = narrow_shape(zarr, &limits, &v, &s.box, &bytes, err);
    if (st != CW_OK)
        return st;
    v.components = v.steps = 1;
    v.component_stride = 0;
    s.box.first[CWI_AXIS_COMPONENT] = visit->component;
    s.box.first[CWI_AXIS_STEP] = visit->step;
    s.box.count[CWI_AXIS_COMPONENT] = s.box.count[CWI_AXIS_STEP] = 1;
    return cwi_visit_slices(visit, &v, read_slices, &s, err);
}

static cw_status load_volume(cwi_zarr *zarr, const cw_read_desc *desc, cw_volume *volume,
                             cw_error *err)
{
    cw_volume v = *cwi_zarr_shape(zarr);
    cwi_zarr_box box = {0};
    size_t bytes = 0;
    cwi_set_spacing(&v, desc);
    cw_status st = narrow_shape(zarr, desc, &v, &box, &bytes, err);
    if (st != CW_OK || desc->header_only) {
        if (st == CW_OK)
            *volume = v;
        return st;
    }
    v.owned = cwi_alloc_large(bytes, 1);
    if (!v.owned)
        return cwi_fail_memory(err);
    v.data = v.owned;
    st = cwi_zarr_read_box(zarr, &box, v.owned, &desc->progress, err);
    if (st == CW_OK)
        *volume = v;
    else
        cw_volume_free(&v);
    return st;
}

cw_status cwi_zarr_read_as(const cwi_zarr_dialect *dialect, const cwi_input *in,
                           const cw_read_desc *desc, cw_volume *volume, cw_error *err)
{
    const cwi_zarr_desc opening = describe_opening(dialect, desc);
    cwi_zarr_found found = {.arrays = in->arrays, .labels = in->labels};
    cwi_zarr *zarr;
    cw_status st = cwi_zarr_open_found(in->path, &opening, &found, &zarr, err);
    if (st == CW_OK && *found.note)
        cwi_note(desc, "%s", found.note);
    if (st == CW_OK && desc->ids)
        cwi_zarr_keep_wide(zarr);
    if (st == CW_OK)
        st = in->visit ? visit_slices(zarr, in->visit, desc, err)
                       : load_volume(zarr, desc, volume, err);
    cwi_zarr_close(zarr);
    return st;
}

/* --- levels ------------------------------------------------------------------------------- */

static void fill_level(const cwi_zarr *zarr, cw_level *level)
{
    snprintf(level->name, sizeof level->name, "%.*s", (int)sizeof level->name - 1,
             zarr->array.path);
    snprintf(level->axes, sizeof level->axes, "%.*s", (int)sizeof level->axes - 1, zarr->axes);
    level->shape = *cwi_zarr_shape(zarr);
}

cw_status cwi_zarr_levels_as(const cwi_zarr_dialect *dialect, const cwi_input *in,
                             const cw_read_desc *desc, cw_level **levels, size_t *count,
                             cw_error *err)
{
    cwi_zarr_desc opening = describe_opening(dialect, desc);
    cwi_zarr_found found = {0};
    cwi_zarr *zarr;
    opening.level = 0;
    *levels = NULL;
    *count = 0;
    cw_status st = cwi_zarr_open_found(in->path, &opening, &found, &zarr, err);
    const size_t all = st == CW_OK ? zarr->level_count : 0;
    cw_level *list = all ? cwi_alloc_zeroed(all, sizeof *list) : NULL;
    if (all && !list)
        st = cwi_fail_memory(err);
    for (size_t n = 0; st == CW_OK && n < all; n++) {
        if (n > 0) {
            cwi_zarr_close(zarr);
            opening.level = n;
            st = cwi_zarr_open_found(in->path, &opening, &found, &zarr, err);
        }
        if (st == CW_OK)
            fill_level(zarr, &list[n]);
    }
    cwi_zarr_close(zarr);
    if (st != CW_OK) {
        cwi_free(list);
        return st;
    }
    *levels = list;
    *count = all;
    return CW_OK;
}
