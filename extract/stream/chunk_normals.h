/* Normals of vertices where the gradient vanishes, from the triangles around them. */
#ifndef EXTRACT_STREAM_CHUNK_NORMALS_H
#define EXTRACT_STREAM_CHUNK_NORMALS_H

#include "extract/stream/write_chunks.h"

/* Replaces normals of a chunk that are zero by those of the triangles around their vertex, to
 * the bit as cwi_repair_normals() does for the whole surface. Triangles of other chunks are made
 * once more for it. The chunk lies in layers begin to end - 1. */
CW_NODISCARD cw_status cwi_chunk_mend_normals(const cwi_chunk_writer *c, cw_mesh_chunk *chunk,
                                              size_t begin, size_t end, cw_error *err);

#endif
