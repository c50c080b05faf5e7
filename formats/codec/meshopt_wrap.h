/* meshoptimizer's codecs, and what else is asked of it: the functions of the
 * module "meshopt". */
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
    /* An order of triangles and vertices that codes well, or (draw) draws fast: triangles are
     * rewritten, remap (for each vertex) says where it goes. CW_ERR_NO_MEMORY. */
    cw_status (*reorder)(uint32_t *triangles, size_t triangle_count, size_t vertex_count,
                         bool draw, uint32_t *remap, cw_error *err);

    /* The bytes are freed with cwi_free(). CW_ERR_NO_MEMORY. */
    cw_status (*encode_vertices)(const void *vertices, size_t count, size_t stride,
                                 unsigned char **bytes, size_t *size, cw_error *err);
    cw_status (*encode_triangles)(const uint32_t *triangles, size_t triangle_count,
                                  size_t vertex_count, unsigned char **bytes, size_t *size,
                                  cw_error *err);

    /* Each fills all that there is room for, or fails with CW_ERR_FORMAT. Indices may name
     * anything. size: of an index, 2 or 4 */
    cw_status (*decode_vertices)(void *to, size_t count, size_t stride, const void *bytes,
                                 size_t size, cw_error *err);
    cw_status (*decode_triangles)(void *to, size_t index_count, size_t index_size,
                                  const void *bytes, size_t size, cw_error *err);
    cw_status (*decode_indices)(void *to, size_t index_count, size_t index_size,
                                const void *bytes, size_t size, cw_error *err);

    /* Undoes a cwi_meshopt_filter in place; a stride that is not the filter's is left as it is. */
    void (*filter)(void *vertices, size_t count, size_t stride, int filter);

    /* Its own simplification, to hold ours against: triangles between some of the vertices,
     * into room for all. Returns how many, about as many as asked for. */
    size_t (*simplify)(const cw_mesh *mesh, size_t triangles, uint32_t *left);
    int version; /* 180: 0.18 */
} cwi_meshopt_functions;

/* Loads the module. CW_ERR_UNSUPPORTED: not in this build. */
CW_NODISCARD cw_status cwi_meshopt_functions_load(const cwi_meshopt_functions **functions,
                                                  cw_error *err);

/* Puts triangles and vertices, with all that they have, in one of the orders of reorder(). The
 * mesh is as it was on failure. CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_mesh_reorder(cw_mesh *mesh, const cwi_meshopt_functions *meshopt,
                                        bool draw, cw_error *err);

extern CW_API const cwi_meshopt_functions cwi_module_meshopt;

#ifdef __cplusplus
}
#endif

#endif
