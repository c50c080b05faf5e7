/* Volumes larger than memory: the voxels come slice by slice, and the surface leaves in chunks. */
#ifndef CUBEWRIGHT_STREAM_H
#define CUBEWRIGHT_STREAM_H

#include <cubewright/extract.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A volume whose slices are read when they are needed. */
typedef struct cw_slice_source {
    /* The volume without its voxels: data is NULL, and strides are those of packed slices. Its
     * first component and step are used. */
    cw_volume shape;
    /* Reads `count` slices, from slice `first` on, to packed memory. It is called on the calling
     * thread, for slices in rising order. A call for slice 0 starts again. */
    cw_status (*read)(void *user, size_t first, size_t count, void *to, cw_error *err);
    void *user;
} cw_slice_source;

/* A part of a surface, in the order of cw_extract(). The triangles of a chunk, and of all later
 * ones, name no vertex before the chunk's first_vertex: so vertices below it are final. */
typedef struct cw_mesh_chunk {
    cw_mesh mesh; /* borrowed arrays of this chunk alone. Its triangles name vertices by their
                     numbers in the whole surface; some may be of a later chunk */
    size_t first_vertex, first_triangle; /* numbers in the whole surface */
} cw_mesh_chunk;

/* A receiver of chunks, one after the other. A status other than CW_OK stops the maker, which
 * then returns it. The chunk belongs to the maker and is invalid after the call. */
typedef struct cw_chunk_sink {
    cw_status (*take)(void *user, const cw_mesh_chunk *chunk, cw_error *err);
    void *user;
} cw_chunk_sink;

/* Options of an extraction by slices. Zero fields mean the default named beside them. */
typedef struct cw_stream_desc {
    cw_extract_desc extract; /* as in cw_extract(). max_bytes limits the working memory */
    size_t layers;           /* layers of cells that are extracted together; default: as many as
                                24 bytes for each sample of a slice, and 8 MiB, hold, but at
                                least 4 */
} cw_stream_desc;

/* Extracts the surface of cw_extract() from slices, and gives it away in chunks. The chunks
 * together are that mesh to the bit, for any number of layers and threads. In memory are only
 * the slices of some layers, three more (four with cubic placement), and one chunk.
 *
 * Slices are read twice in three cases, as the result depends on all of them: the first layers
 * are inside; the volume has a no-data value; the surface is left open and voxels are floats.
 *
 * source  borrowed; at least 2 voxels along each axis
 * desc    borrowed; NULL means all defaults
 * sink    called on the calling thread; not at all for a volume without a crossing
 * counts  what was made; bytes are those of the working memory. Loops of the border are not
 *         counted: 0. May be NULL
 *
 * Returns CW_ERR_ARGUMENT     as cw_extract()
 *         CW_ERR_UNSUPPORTED  a sparse or irregular grid; snap; normals on a rectilinear grid; an
 *                             open surface of a volume with NaN or no-data voxels
 *         CW_ERR_LIMIT        more than 2^32 - 1 vertices, or a limit of desc: max_bytes below
 *                             what one layer needs. CW_ERR_NO_MEMORY; CW_ERR_CANCELLED; or what
 *                             source or sink returned
 * Cost    as cw_extract(), and reading
 * Source  edges with numbers in the whole volume, as in extract/streaming.md; streaming meshes
 *         [Isenburg2005] */
CW_NODISCARD CW_API cw_status cw_extract_stream(const cw_slice_source *source,
                                                const cw_stream_desc *desc, cw_chunk_sink sink,
                                                cw_extract_counts *counts, cw_error *err);

/* Returns the working memory of cw_extract_stream() in bytes, without that of the source and the
 * sink. minimum: with one layer at a time, which max_bytes has to allow. */
CW_API size_t cw_extract_stream_bytes(const cw_volume *shape, const cw_stream_desc *desc,
                                      bool minimum);

#ifdef __cplusplus
}
#endif

#endif
