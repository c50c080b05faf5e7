/* Writes the layers of a window as chunks of a surface. */
#ifndef EXTRACT_STREAM_WRITE_CHUNKS_H
#define EXTRACT_STREAM_WRITE_CHUNKS_H

#include "extract/common/field_normals.h"
#include "extract/stream/slice_window.h"

/* The state of writing, from slab to slab. */
typedef struct cwi_chunk_writer {
    cwi_slice_window *window;
    cw_chunk_sink sink;
    cwi_emission emission;
    cwi_vertex_sink vertices; /* of the whole volume: arrays and first are set for each chunk */
    bool by_position;         /* normals are found at vertices, as on a rectilinear grid */
    cwi_shading shading;
    cw_mesh frame; /* origin and affine of every chunk */
    float *positions, *normals;
    uint32_t *corners;
    size_t vertex_capacity, triangle_capacity;
} cwi_chunk_writer;

/* Bytes of a chunk, unless a single row has more. */
enum { CWI_CHUNK_BYTES = 4 << 20 };

/* A zeroed writer can be freed. The window is borrowed. */
void cwi_chunks_init(cwi_chunk_writer *c, cwi_slice_window *window, cw_chunk_sink sink);
void cwi_chunks_free(cwi_chunk_writer *c);

/* Gives layers begin to end - 1 of the surface to the sink. The window stands at them. */
CW_NODISCARD cw_status cwi_chunks_write(cwi_chunk_writer *c, size_t begin, size_t end,
                                        cw_error *err);

#endif
