/* Moves a window of slices up through a label map. */
#include "extract/labels/label_window.h"

#include "extract/labels/label_chunks.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <string.h>

/* Bytes of the slices, if one chunk takes no more; and chunks at most. */
enum { WINDOW_BYTES = 32 << 20, MAX_CHUNKS = 64 };

/* Slices that a chunk needs beside those of its layers. */
enum { BESIDE = 3 };

cw_status cwi_label_window_open(cwi_label_window *w, const cw_slice_source *source,
                                size_t chunks, cw_error *err)
{
    *w = (cwi_label_window){.source = source};
    cw_status st = cwi_volume_resolve_shape(&source->shape, &w->whole, err);
    if (st != CW_OK)
        return st;
    const size_t slice = (size_t)w->whole.stride[2],
                 fit = WINDOW_BYTES / slice / CWI_LABEL_CHUNK;
    w->chunks = chunks ? chunks : fit < 1 ? 1 : fit < MAX_CHUNKS ? fit : MAX_CHUNKS;
    w->slices = cwi_alloc_array(w->chunks * CWI_LABEL_CHUNK + BESIDE, slice);
    return w->slices ? CW_OK : cwi_fail_memory(err);
}

void cwi_label_window_close(cwi_label_window *w)
{
    cwi_free(w->slices);
    w->slices = NULL;
}

cw_status cwi_label_window_move(cwi_label_window *w, const cwi_label_layers *l,
                                size_t first_chunk, size_t chunks, cw_error *err)
{
    const size_t cubes = l->count - 1, begin = first_chunk * CWI_LABEL_CHUNK,
                 end = begin + chunks * CWI_LABEL_CHUNK < cubes
                           ? begin + chunks * CWI_LABEL_CHUNK
                           : cubes,
                 slice = (size_t)w->whole.stride[2];
    const size_t first = cwi_label_layer_slice(l, begin > 0 ? begin - 1 : 0),
                 last = cwi_label_layer_slice(l, end);
    const size_t held =
        w->first + w->count > first && w->count ? w->first + w->count - first : 0;
    memmove(w->slices, w->slices + (w->count - held) * slice, held * slice);
    w->first = first;
    w->count = last - first + 1;
    return w->count > held ? w->source->read(w->source->user, first + held, w->count - held,
                                             w->slices + held * slice, err)
                           : CW_OK;
}
