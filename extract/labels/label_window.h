/* A window of slices that moves up through a label map. */
#ifndef EXTRACT_LABELS_LABEL_WINDOW_H
#define EXTRACT_LABELS_LABEL_WINDOW_H

#include "extract/labels/label_layers.h"

#include <cubewright/stream.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cwi_label_window {
    const cw_slice_source *source;
    cw_volume whole;     /* resolved, without data */
    size_t chunks;       /* whose slices it holds at one time */
    char *slices;        /* packed */
    size_t first, count; /* of the slices */
} cwi_label_window;

/* Opens a window over a source, which is borrowed. Close it also after an error.
 * chunks   that it holds; 0: as many as 32 MiB hold
 * Returns CW_ERR_UNSUPPORTED, CW_ERR_ARGUMENT, CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_label_window_open(cwi_label_window *w, const cw_slice_source *source,
                                             size_t chunks, cw_error *err);
void cwi_label_window_close(cwi_label_window *w);

/* Moves up to the slices of some chunks; those that it holds are not read again. */
CW_NODISCARD cw_status cwi_label_window_move(cwi_label_window *w,
                                             const cwi_label_layers *layers, size_t first_chunk,
                                             size_t chunks, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
