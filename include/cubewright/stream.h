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
     * thread, for slices in rising order. After a look ahead it starts again. */
    cw_status (*read)(void *user, size_t first, size_t count, void *to, cw_error *err);
    void *user; /* passed to read */
} cw_slice_source;

/* A piece of a surface, in the order of cw_extract(). The triangles of a chunk, and of all later
 * ones, name no vertex before the chunk's first_vertex: so vertices below it are final. */
typedef struct cw_mesh_chunk {
    cw_mesh mesh; /* borrowed arrays of this chunk alone. Its triangles name vertices by their
                     numbers in the whole surface; some may be of a later chunk */
    size_t first_vertex, first_triangle; /* numbers in the whole surface */
} cw_mesh_chunk;

/* A receiver of chunks, one after the other. A status other than CW_OK stops the maker, which
 * then returns it. The chunk belongs to the maker and is invalid after the call. */
typedef struct cw_chunk_sink {
    /* Takes one chunk, on the calling thread. */
    cw_status (*take)(void *user, const cw_mesh_chunk *chunk, cw_error *err);
    void *user; /* passed to take */
} cw_chunk_sink;

/* Options of an extraction by slices. Zero fields mean the default named beside them. */
typedef struct cw_stream_desc {
    uint32_t version;        /* 0: the first version of this struct */
    cw_extract_desc extract; /* as in cw_extract(). max_bytes limits the working memory */
    size_t layers;           /* layers of cells that are extracted together; default: as many as
                                24 bytes for each sample of a slice, and 8 MiB, hold, but at
                                least 4 */
} cw_stream_desc;

/* Extracts the surface of cw_extract() from slices, and gives it away in chunks. The chunks
 * together are that mesh to the bit, for any number of layers and threads. In memory are only
 * the slices of some layers, three more (four with cubic placement, five with normals on a
 * rectilinear grid), and one chunk.
 *
 * Slices are read twice in three cases, as the result depends on all of them: the first layers
 * are inside; the volume has a no-data value; the surface is left open and voxels are floats. If it
 * is open and some voxel has no value, up to 13 slices more are in memory, and a part reads all
 * slices below it.
 *
 * source  borrowed; at least 2 voxels along each axis
 * desc    borrowed; NULL means all defaults
 * sink    called on the calling thread; not at all for a volume without a crossing
 * counts  what was made; bytes are those of the working memory. May be NULL
 *
 * Returns CW_ERR_ARGUMENT     as cw_extract()
 *         CW_ERR_UNSUPPORTED  a sparse or irregular grid; snap; an open surface whose border,
 *                             around voxels without a value, depends on more slices than these
 *         CW_ERR_LIMIT        more than 2^32 - 1 vertices, or a limit of desc: max_bytes below
 *                             what one layer needs. CW_ERR_NO_MEMORY; CW_ERR_CANCELLED; or what
 *                             source or sink returned
 * Cost    as cw_extract(), and reading
 * Source  edges with numbers in the whole volume, as in extract/streaming.md; streaming meshes
 *         [Isenburg2005] */
CW_NODISCARD CW_API cw_status cw_extract_stream(const cw_slice_source *source,
                                                const cw_stream_desc *desc, cw_chunk_sink sink,
                                                cw_extract_counts *counts, cw_error *err);

/* Counts of a part of a surface. */
typedef struct cw_part_counts {
    size_t vertices, triangles;   /* of the part */
    bool has_inside, has_outside; /* samples on each side were found. A volume whose parts all
                                     have one side only has no surface */
} cw_part_counts;

/* Extracts a part of the surface of cw_extract_stream(): the layers of cells of part `part`, from 0,
 * out of `parts` that share them evenly. Parts are made in any order, or on several machines.
 *
 * Vertices and triangles of a part count from 0. A triangle may name vertices beyond the part's
 * last: vertex number vertices + n of a part is vertex n of those behind it. So a part's numbers, plus
 * the vertices of all parts before it, are those of the whole surface.
 *
 * part, parts  number of the part from 0; number of all parts
 * counts       what was made; may be NULL
 * Returns      as cw_extract_stream(); CW_ERR_ARGUMENT: part is not below parts */
CW_NODISCARD CW_API cw_status cw_extract_stream_part(const cw_slice_source *source,
                                                     const cw_stream_desc *desc, size_t part,
                                                     size_t parts, cw_chunk_sink sink,
                                                     cw_part_counts *counts, cw_error *err);

/* Extracts the slabs of cw_extract_slabs() from slices: the same vertices, triangles and seams. In
 * memory are one slab, and the slices of some layers. Slices are read twice, since where slabs end
 * depends on all of them; three times where cw_extract_stream() looks ahead for values.
 *
 *     cw_simplifier_new(&(cw_simplify_desc){.error_mm = 0.1}, &simplifier, &err);
 *     cw_extract_stream_slabs(&source, &stream_desc, CW_SIMPLIFIER_SLAB,
 *                             (cw_slab_sink){cw_simplifier_take, simplifier}, NULL, &err);
 *     cw_simplifier_finish(simplifier, &mesh, NULL, &err);
 *     cw_extract_stream_normals(&source, &normals_desc, 0, &mesh, &err);
 *
 * triangles  minimum of a slab, as in cw_extract_slabs()
 * sink       called on the calling thread; not at all for a volume without a crossing
 * counts     what was made; bytes are those of the largest slab and of the working memory. May be NULL
 * Returns    as cw_extract_stream(). CW_ERR_LIMIT also for max_bytes below what the largest slab
 *            needs, before the sink is called */
CW_NODISCARD CW_API cw_status cw_extract_stream_slabs(const cw_slice_source *source,
                                                      const cw_stream_desc *desc,
                                                      size_t triangles, cw_slab_sink sink,
                                                      cw_extract_counts *counts, cw_error *err);

/* Gives the vertices of a mesh the normals of cw_extract_normals(), to the bit, from slices. Each
 * slice with vertices near it is read once. In memory are the mesh, 17 bytes for each of its
 * vertices, and some slices.
 *
 * max_bytes  limit of the working memory, without the mesh; 0: none
 * mesh       its normals are replaced, or added; unchanged on failure
 * Returns    as cw_extract_normals(); CW_ERR_LIMIT: max_bytes is too low; or what source
 *            returned */
CW_NODISCARD CW_API cw_status cw_extract_stream_normals(const cw_slice_source *source,
                                                        const cw_normals_desc *desc,
                                                        size_t max_bytes, cw_mesh *mesh,
                                                        cw_error *err);

/* Computes what cw_volume_statistics() does from slices, which are read twice, once if bin_count
 * is 0.
 * source     borrowed
 * bin_count  as in cw_volume_statistics(); 0: range only
 * threads    0 means all
 * out        set on success; free with cw_statistics_free()
 * Returns    as cw_volume_statistics(), or what source returned */
CW_NODISCARD CW_API cw_status cw_stream_statistics(const cw_slice_source *source,
                                                   size_t bin_count, int threads,
                                                   cw_statistics *out, cw_error *err);

/* Returns the working memory of cw_extract_stream() in bytes, without that of the source and the
 * sink. minimum: with one layer at a time, which max_bytes has to allow.
 * shape    as in cw_slice_source
 * minimum  true: with one layer at a time */
CW_API size_t cw_extract_stream_bytes(const cw_volume *shape, const cw_stream_desc *desc,
                                      bool minimum);

#ifdef __cplusplus
}
#endif

#endif
