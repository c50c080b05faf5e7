/* Writes the voxels of a volume to a file, row by row. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/volume.h"
#include "formats/volume/volume_writer.h"

#include <string.h>

/* A row of voxels without gaps: in the volume itself, or gathered into a buffer. */
typedef struct rows {
    const cw_volume *volume;
    size_t components; /* per voxel of the row */
    size_t bytes;
    unsigned char *buffer; /* NULL: rows are packed in the volume */
} rows;

static cw_status rows_open(rows *r, const cw_volume *v, bool components_last, cw_error *err)
{
    const size_t size = cw_type_size(v->type);
    *r = (rows){.volume = v, .components = components_last ? 1 : v->components};
    r->bytes = v->dim[0] * r->components * size;
    if (v->stride[0] == (ptrdiff_t)(r->components * size) &&
        (r->components == 1 || v->component_stride == (ptrdiff_t)size))
        return CW_OK;
    r->buffer = cwi_alloc_array(r->bytes, 1);
    return r->buffer ? CW_OK : cwi_fail_memory(err);
}

static const void *gather_row(const rows *r, const char *first)
{
    const cw_volume *v = r->volume;
    const size_t size = cw_type_size(v->type);
    unsigned char *to = r->buffer;
    if (!to)
        return first;
    for (size_t i = 0; i < v->dim[0]; i++)
        for (size_t c = 0; c < r->components; c++, to += size)
            memcpy(to, first + (ptrdiff_t)i * v->stride[0] + (ptrdiff_t)c * v->component_stride,
                   size);
    return r->buffer;
}

static cw_status save_slice(const rows *r, const char *first, cwi_sink *sink, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t j = 0; st == CW_OK && j < r->volume->dim[1]; j++)
        st = cwi_sink_write(sink, gather_row(r, first + (ptrdiff_t)j * r->volume->stride[1]),
                            r->bytes, err);
    return st;
}

cw_status cwi_save_voxels(const cwi_save *save, bool components_last, cwi_sink *sink,
                          cw_error *err)
{
    const cw_volume *v = save->volume;
    const char *step = sink->file ? "writing" : "measuring";
    const size_t outer = components_last ? v->components : 1;
    const size_t slices = outer * v->steps * v->dim[2];
    rows r;
    cw_status st = rows_open(&r, v, components_last, err);
    for (size_t s = 0; st == CW_OK && s < slices; s++) {
        const size_t k = s % v->dim[2], t = s / v->dim[2] % v->steps,
                     c = s / v->dim[2] / v->steps;
        const char *first = (const char *)v->data + (ptrdiff_t)k * v->stride[2] +
                            (ptrdiff_t)t * v->step_stride + (ptrdiff_t)c * v->component_stride;
        st = cwi_progress(save->progress, step, (double)s / (double)slices, err);
        if (st == CW_OK)
            st = save_slice(&r, first, sink, err);
    }
    if (st == CW_OK)
        st = cwi_sink_finish(sink, err);
    cwi_free(r.buffer);
    return st;
}
