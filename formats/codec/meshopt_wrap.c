/* Wraps meshoptimizer; this is the only file that uses it. It writes the formats of
 * EXT_meshopt_compression: indices of version 1, vertices of version 0. */
#include "formats/codec/meshopt_wrap.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <meshoptimizer.h>
#include <string.h>

static cw_status reorder_mesh(uint32_t *triangles, size_t triangle_count, size_t vertex_count,
                              bool draw, uint32_t *remap, cw_error *err)
{
    const size_t count = 3 * triangle_count;
    uint32_t *ordered = cwi_alloc_array(count, sizeof *ordered);
    if (!ordered)
        return cwi_fail_memory(err);
    if (draw)
        meshopt_optimizeVertexCache(ordered, triangles, count, vertex_count);
    else
        meshopt_optimizeVertexCacheStrip(ordered, triangles, count, vertex_count);
    size_t next = meshopt_optimizeVertexFetchRemap(remap, ordered, count, vertex_count);
    for (size_t v = 0; v < vertex_count; v++)
        if (remap[v] == ~0u) /* no triangle names it: it comes last */
            remap[v] = (uint32_t)next++;
    for (size_t i = 0; i < count; i++)
        triangles[i] = remap[ordered[i]];
    cwi_free(ordered);
    return CW_OK;
}

/* Gives back the unused part of a buffer that was allocated by an upper bound. */
static cw_status shrink_bytes(unsigned char **bytes, size_t size, cw_error *err)
{
    unsigned char *fit = cwi_realloc_array(*bytes, size, 1);
    if (!fit)
        return cwi_fail_memory(err);
    *bytes = fit;
    return CW_OK;
}

static cw_status encode_vertices(const void *vertices, size_t count, size_t stride,
                                 unsigned char **bytes, size_t *size, cw_error *err)
{
    const size_t bound = meshopt_encodeVertexBufferBound(count, stride);
    *bytes = cwi_alloc_array(bound, 1);
    if (!*bytes)
        return cwi_fail_memory(err);
    meshopt_encodeVertexVersion(0);
    *size = meshopt_encodeVertexBuffer(*bytes, bound, vertices, count, stride);
    return shrink_bytes(bytes, *size, err);
}

static cw_status encode_triangles(const uint32_t *triangles, size_t triangle_count,
                                  size_t vertex_count, unsigned char **bytes, size_t *size,
                                  cw_error *err)
{
    const size_t bound = meshopt_encodeIndexBufferBound(3 * triangle_count, vertex_count);
    *bytes = cwi_alloc_array(bound, 1);
    if (!*bytes)
        return cwi_fail_memory(err);
    meshopt_encodeIndexVersion(1);
    *size = meshopt_encodeIndexBuffer(*bytes, bound, triangles, 3 * triangle_count);
    return shrink_bytes(bytes, *size, err);
}

static cw_status fail_unless_zero(int code, const char *what, cw_error *err)
{
    return code == 0 ? CW_OK
                     : cwi_fail(err, CW_ERR_FORMAT,
                                "the %s that meshopt compressed are damaged", what);
}

static cw_status decode_vertices(void *to, size_t count, size_t stride, const void *bytes,
                                 size_t size, cw_error *err)
{
    return fail_unless_zero(meshopt_decodeVertexBuffer(to, count, stride, bytes, size),
                            "vertices", err);
}

static cw_status decode_triangles(void *to, size_t index_count, size_t index_size,
                                  const void *bytes, size_t size, cw_error *err)
{
    return fail_unless_zero(meshopt_decodeIndexBuffer(to, index_count, index_size, bytes, size),
                            "triangles", err);
}

static cw_status decode_indices(void *to, size_t index_count, size_t index_size,
                                const void *bytes, size_t size, cw_error *err)
{
    return fail_unless_zero(
        meshopt_decodeIndexSequence(to, index_count, index_size, bytes, size), "indices", err);
}

static void undo_filter(void *vertices, size_t count, size_t stride, int kind)
{
    if (kind == CWI_MESHOPT_OCTAHEDRAL && (stride == 4 || stride == 8))
        meshopt_decodeFilterOct(vertices, count, stride);
    else if (kind == CWI_MESHOPT_QUATERNION && stride == 8)
        meshopt_decodeFilterQuat(vertices, count, stride);
    else if (kind == CWI_MESHOPT_EXPONENTIAL && stride % 4 == 0)
        meshopt_decodeFilterExp(vertices, count, stride);
}

static size_t simplify_mesh(const cw_mesh *mesh, size_t triangles, uint32_t *left)
{
    const float NO_LIMIT = 1e10f; /* of the error */
    return meshopt_simplify(left, mesh->triangles, 3 * mesh->triangle_count, mesh->positions,
                            mesh->vertex_count, 3 * sizeof(float), 3 * triangles, NO_LIMIT, 0,
                            NULL) /
           3;
}

const cwi_meshopt_functions cwi_module_meshopt = {
    .reorder = reorder_mesh,
    .encode_vertices = encode_vertices,
    .encode_triangles = encode_triangles,
    .decode_vertices = decode_vertices,
    .decode_triangles = decode_triangles,
    .decode_indices = decode_indices,
    .filter = undo_filter,
    .simplify = simplify_mesh,
    .version = MESHOPTIMIZER_VERSION,
};
