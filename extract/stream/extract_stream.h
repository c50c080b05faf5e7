/* Extraction by slices with an engine of the caller's choice. */
#ifndef EXTRACT_STREAM_EXTRACT_STREAM_H
#define EXTRACT_STREAM_EXTRACT_STREAM_H

#include <cubewright/stream.h>

#include "extract/dense/isa_dispatch.h"

/* cw_extract_stream() with an engine of the caller's choice, for tests. */
CW_NODISCARD cw_status cwi_extract_stream_with(const cwi_engine *engine,
                                               const cw_slice_source *source,
                                               const cw_stream_desc *desc, cw_chunk_sink sink,
                                               cw_extract_counts *counts, cw_error *err);

#endif
