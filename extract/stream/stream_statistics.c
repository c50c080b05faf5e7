/* Statistics of a volume whose slices are read when they are needed. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/histogram.h"

#include <cubewright/stream.h>

static const size_t READ_BYTES = 8 << 20; /* at a time, or one slice */

typedef cw_status visit(cw_statistics *statistics, const cw_volume *part, int threads,
                        cw_error *err);

/* Reads all slices, some at a time. */
static cw_status visit_parts(const cw_slice_source *source, int threads, void *memory,
                             size_t max, visit *visit_part, cw_statistics *s, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t k = 0; k < source->shape.dim[2] && st == CW_OK; k += max) {
        const size_t left = source->shape.dim[2] - k;
        cw_volume read = source->shape, part;
        read.data = memory;
        read.dim[2] = left < max ? left : max;
        st = source->read(source->user, k, read.dim[2], memory, err);
        if (st == CW_OK)
            st = cw_volume_select(&read, 0, 0, &part, err);
        if (st == CW_OK)
            st = visit_part(s, &part, threads, err);
    }
    return st;
}

cw_status cw_stream_statistics(const cw_slice_source *source, size_t bin_count, int threads,
                               cw_statistics *out, cw_error *err)
{
    CWI_REQUIRE(err, source, out);
    if (source->shape.stride[2] < 1)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "shape.stride[2] is %td; the bytes of a slice were expected",
                        source->shape.stride[2]);
    const size_t slice = (size_t)source->shape.stride[2], max = READ_BYTES / slice;
    const size_t slices = max < 1 ? 1 : max > source->shape.dim[2] ? source->shape.dim[2] : max;
    void *memory = cwi_alloc_large(slices, slice);
    cw_volume shape = source->shape;
    shape.slope = shape.slope != 0 ? shape.slope : 1;
    cw_statistics s = cwi_statistics_of(&shape);
    *out = (cw_statistics){0};
    cw_status st = memory ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK)
        st = visit_parts(source, threads, memory, slices, cwi_statistics_scan, &s, err);
    if (st == CW_OK)
        st = cwi_statistics_divide(&s, bin_count, err);
    if (st == CW_OK && s.bins)
        st = visit_parts(source, threads, memory, slices, cwi_statistics_count, &s, err);
    cwi_free(memory);
    if (st == CW_OK)
        *out = s;
    else
        cw_statistics_free(&s);
    return st;
}
