/* Surfaces larger than memory, in temporary files. */
#ifndef CUBEWRIGHT_SPOOL_H
#define CUBEWRIGHT_SPOOL_H

#include <cubewright/stream.h>
#include <cubewright/team.h>

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
 * out      set to the spool
 * Returns  CW_ERR_OUTPUT  the folder cannot be written; CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_mesh_spool_new(const char *path, cw_mesh_spool **out,
                                                cw_error *err);

/* Frees a spool and its temporary files. Harmless on NULL. */
CW_API void cw_mesh_spool_free(cw_mesh_spool *spool);

/* Returns the sink that appends chunks to a spool. It returns CW_ERR_OUTPUT when the disk is
 * full, and CW_ERR_ARGUMENT for a chunk that does not follow the last one. */
CW_API cw_chunk_sink cw_mesh_spool_sink(cw_mesh_spool *spool);

/* Returns a mesh with the counts, origin and affine of a spool, and without arrays. It is valid
 * until the spool changes. */
CW_API const cw_mesh *cw_mesh_spool_frame(const cw_mesh_spool *spool);

/* Computes the box around the vertices, as cw_mesh_bounds() does. Returns false, and zeros, where
 * there are none. */
CW_API bool cw_mesh_spool_bounds(const cw_mesh_spool *spool, double min[3], double max[3]);

/* Gives the surface of a spool away again, in chunks of up to 16384 triangles.
 * Returns CW_ERR_IO, CW_ERR_NO_MEMORY, or what the sink returned
 * Cost    triangles are read twice. Memory: a chunk, and 4 bytes for each */
CW_NODISCARD CW_API cw_status cw_mesh_spool_read(const cw_mesh_spool *spool, cw_chunk_sink sink,
                                                 cw_error *err);

/* Joins the spools of all processes of a team: each holds a part of one surface, those of
 * cw_extract_stream_part() by rank. From then on the spool is the whole surface in every process,
 * and takes no more chunks. It is written by all together: cw_parts_write().
 *
 * What a process tells the others are counts, a box and names of files. All processes see the
 * spool's folder; its files have names there until they are open everywhere.
 *
 * team     borrowed, as long as the spool lives
 * Returns  in all processes the same: CW_ERR_LIMIT: more than 2^32 - 1 vertices; CW_ERR_OUTPUT;
 *          CW_ERR_IO: the folder is not shared; CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_mesh_spool_share(cw_mesh_spool *spool, const cw_team *team,
                                                  cw_error *err);

/* Options of cw_mesh_spool_drop_volumes(). */
typedef struct cw_spool_drop_desc {
    uint32_t version;     /* 0: the first version of this struct */
    double least_mm3;     /* as in cw_mesh_drop_volumes(); 0 keeps all components */
    size_t max_bytes;     /* limit of the working memory; default: none */
    cw_progress progress; /* default: none; called on the calling thread, may cancel */
} cw_spool_drop_desc;

/* Gives a spool's surface away in chunks, without the components that enclose less than a volume,
 * and without vertices that no triangle names. The chunks together are the mesh that
 * cw_mesh_drop_volumes() makes, to the bit; the counts are the same, too.
 *
 * In memory are only the vertices at the surface's front, in the order in which it was made:
 * between the lowest vertex that later triangles name and the highest one that earlier triangles
 * name. A vertex of it takes up to 25 bytes, and a component of it 96. So memory does not
 * grow with the number of components. A temporary file beside the spool's takes 4 bytes for a vertex of the surface.
 *
 * spool   borrowed and unchanged. It holds a whole surface
 * desc    borrowed; NULL means all defaults
 * kept    called on the calling thread; not at all if nothing is kept. It may be the sink of
 *         another spool
 * counts  may be NULL
 *
 * Returns CW_ERR_ARGUMENT  least_mm3 is negative or NaN; a position is not finite
 *         CW_ERR_FORMAT    a triangle names a vertex that is not there
 *         CW_ERR_LIMIT     the front needs more than max_bytes; CW_ERR_NO_MEMORY;
 *                          CW_ERR_OUTPUT; CW_ERR_IO; CW_ERR_CANCELLED; or what the sink returned
 * Cost    reads the triangles three times and the vertices twice
 * Source  union-find over the front of a streaming mesh [Isenburg2005] */
CW_NODISCARD CW_API cw_status cw_mesh_spool_drop_volumes(const cw_mesh_spool *spool,
                                                         const cw_spool_drop_desc *desc,
                                                         cw_chunk_sink kept,
                                                         cw_drop_counts *counts, cw_error *err);

/* A part of a surface in a file of its own: a fragment. */
typedef struct cw_fragment {
    size_t part, parts;    /* as in cw_extract_stream_part() */
    cw_part_counts counts; /* what that call made */
    uint64_t job; /* the caller's number of the extraction: fragments of different ones do
                              not fit together */
} cw_fragment;

/* Writes a part that is in a spool as a fragment: its facts, arrays and a checksum. It appears at
 * the path only when it is complete.
 * fragment  borrowed
 * Returns   CW_ERR_OUTPUT; CW_ERR_IO; CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_fragment_write(const char *path, const cw_fragment *fragment,
                                                const cw_mesh_spool *spool, cw_error *err);

/* Reads the facts of a fragment, and checks the size of its file.
 * fragment  filled on success
 * Returns   CW_ERR_IO, CW_ERR_FORMAT: it is no fragment, or not complete */
CW_NODISCARD CW_API cw_status cw_fragment_read(const char *path, cw_fragment *fragment,
                                               cw_error *err);

/* Appends a fragment to the spool that holds all parts before it, and verifies the checksum.
 * Returns as cw_fragment_read(), also for a wrong checksum, a position or an origin that is not
 *         finite, another origin than the parts before have, and a triangle whose vertex can be in
 *         no part; CW_ERR_LIMIT: more than 2^32 - 1 vertices; as the spool's sink */
CW_NODISCARD CW_API cw_status cw_fragment_append(const char *path, cw_mesh_spool *spool,
                                                 cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
