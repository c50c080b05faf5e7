/* The interface of the module "meshopt": meshoptimizer's codecs, orders and simplification. */
#ifndef FORMATS_CODEC_MESHOPT_WRAP_H
#define FORMATS_CODEC_MESHOPT_WRAP_H

#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The filters of EXT_meshopt_compression. */
typedef enum cwi_meshopt_filter {
    CWI_MESHOPT_PLAIN,
    CWI_MESHOPT_OCTAHEDRAL,
    CWI_MESHOPT_QUATERNION,
    CWI_MESHOPT_EXPONENTIAL
} cwi_meshopt_filter;

typedef struct cwi_meshopt_functions {
    /* Finds an order of triangles and vertices that codes well, or (draw) draws fast. Triangles
     * are rewritten; remap gives the new place of each vertex. Returns CW_ERR_NO_MEMORY. */
    cw_status (*reorder)(uint32_t *triangles, size_t triangle_count, size_t vertex_count,
                         bool draw, uint32_t *remap, cw_error *err);

    /* Encode vertices or triangles. The bytes are freed with cwi_free(). Return
     * CW_ERR_NO_MEMORY. */
    cw_status (*encode_vertices)(const void *vertices, size_t count, size_t stride,
                                 unsigned char **bytes, size_t *size, cw_error *err);
    cw_status (*encode_triangles)(const uint32_t *triangles, size_t triangle_count,
                                  size_t vertex_count, unsigned char **bytes, size_t *size,
                                  cw_error *err);

    /* Decode exactly the stated counts, or fail with CW_ERR_FORMAT. Indices are not checked.
     * size: of an index, 2 or 4 */
    cw_status (*decode_vertices)(void *to, size_t count, size_t stride, const void *bytes,
                                 size_t size, cw_error *err);
    cw_status (*decode_triangles)(void *to, size_t index_count, size_t index_size,
                                  const void *bytes, size_t size, cw_error *err);
    cw_status (*decode_indices)(void *to, size_t index_count, size_t index_size,
                                const void *bytes, size_t size, cw_error *err);

    /* Undoes a cwi_meshopt_filter in place; data with another stride than the filter's stay
     * unchanged. */
    void (*filter)(void *vertices, size_t count, size_t stride, int filter);

    /* Simplifies by meshoptimizer, for comparison with our own simplification. Writes triangles
     * between some of the vertices, into room for all. Returns their number, about the
     * requested one. */
    size_t (*simplify)(const cw_mesh *mesh, size_t triangles, uint32_t *left);
    int version; /* 180: 0.18 */
} cwi_meshopt_functions;

/* Loads the module. Returns CW_ERR_UNSUPPORTED if it is not in this build. */
CW_NODISCARD cw_status cwi_meshopt_functions_load(const cwi_meshopt_functions **functions,
                                                  cw_error *err);

/* Puts triangles and vertices, with all attributes, in one of the orders of reorder(). The mesh
 * is unchanged on failure. Returns CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_mesh_reorder(cw_mesh *mesh, const cwi_meshopt_functions *meshopt,
                                        bool draw, cw_error *err);

extern CW_API const cwi_meshopt_functions cwi_module_meshopt;

#ifdef __cplusplus
}
#endif

#endif
