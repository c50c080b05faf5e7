/* Surfaces larger than memory, in temporary files. */
#ifndef CUBEWRIGHT_SPOOL_H
#define CUBEWRIGHT_SPOOL_H

#include <cubewright/stream.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A surface on its way from cw_extract_stream() to a file: its arrays are in temporary files,
 * which have no name and end with the process. Writers read them a piece at a time, so a file of
 * any size takes a few megabytes of memory. Its bytes are those that cw_mesh_write() makes of
 * the same mesh. */
typedef struct cw_mesh_spool cw_mesh_spool;

/* Makes an empty spool in the folder of a path (that of the file to write, say). A vertex takes
 * 12 bytes of the disk, with normals 24, and a triangle takes 12.
 * Returns CW_ERR_OUTPUT  the folder cannot be written; CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_mesh_spool_new(const char *path, cw_mesh_spool **out,
                                                cw_error *err);
CW_API void cw_mesh_spool_free(cw_mesh_spool *spool); /* harmless on NULL */

/* Returns the sink that appends chunks to a spool. It returns CW_ERR_OUTPUT when the disk is
 * full, and CW_ERR_ARGUMENT for a chunk that does not follow the last one. */
CW_API cw_chunk_sink cw_mesh_spool_sink(cw_mesh_spool *spool);

/* Returns a mesh with the counts, origin and affine of a spool, and without arrays. It is valid
 * until the spool changes. */
CW_API const cw_mesh *cw_mesh_spool_frame(const cw_mesh_spool *spool);

/* Computes the box around the vertices, as cw_mesh_bounds() does. */
CW_API bool cw_mesh_spool_bounds(const cw_mesh_spool *spool, double min[3], double max[3]);

#ifdef __cplusplus
}
#endif

#endif
