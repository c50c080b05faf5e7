/* Extraction by slices with an engine of the caller's choice, and its first steps. */
#ifndef EXTRACT_STREAM_EXTRACT_STREAM_H
#define EXTRACT_STREAM_EXTRACT_STREAM_H

#include <cubewright/stream.h>

#include "extract/stream/slice_window.h"

/* cw_extract_stream() with an engine of the caller's choice, for tests. */
CW_NODISCARD cw_status cwi_extract_stream_with(const cwi_engine *engine,
                                               const cw_slice_source *source,
                                               const cw_stream_desc *desc, cw_chunk_sink sink,
                                               cw_extract_counts *counts, cw_error *err);

/* Checks a request, and sets up a zeroed window for it, before the first slice. Looks ahead where
 * the surface depends on slices far away. Free the window with cwi_slice_window_free(), also after
 * an error.
 *
 * layers  the layers that are extracted together */
CW_NODISCARD cw_status cwi_open_slices(cwi_slice_window *window, const cwi_engine *engine,
                                       const cw_slice_source *source,
                                       const cw_stream_desc *desc, size_t *layers,
                                       cw_error *err);

#endif
