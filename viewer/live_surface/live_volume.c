/* Uploads voxels as a texture of whole numbers, in which shaders find their bits unchanged. */
#include "viewer/live_surface/live_internal.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <string.h>

enum { CHUNK_BYTES = 1 << 22 };

/* The texture of a type of voxels. Floats are taken as the bits that they are. */
typedef struct texels {
    GLenum inner, type;
} texels;

static texels texels_of(cw_type type)
{
    static const texels all[CW_TYPE_COUNT] = {
        [CW_U8] = {GL_R8UI, GL_UNSIGNED_BYTE},    [CW_I8] = {GL_R8I, GL_BYTE},
        [CW_U16] = {GL_R16UI, GL_UNSIGNED_SHORT}, [CW_I16] = {GL_R16I, GL_SHORT},
        [CW_U32] = {GL_R32UI, GL_UNSIGNED_INT},   [CW_I32] = {GL_R32I, GL_INT},
        [CW_F32] = {GL_R32UI, GL_UNSIGNED_INT}};
    return all[type];
}

static bool texture_fits(texels of, const size_t dim[3])
{
    GLint got = 0;
    glTexImage3D(GL_PROXY_TEXTURE_3D, 0, (GLint)of.inner, (GLsizei)dim[0], (GLsizei)dim[1],
                 (GLsizei)dim[2], 0, GL_RED_INTEGER, of.type, NULL);
    glGetTexLevelParameteriv(GL_PROXY_TEXTURE_3D, 0, GL_TEXTURE_WIDTH, &got);
    return got != 0;
}

typedef struct copying {
    const cw_volume *v;
    size_t first;
    char *to;
} copying;

static void copy_layer(void *context, size_t k)
{
    const copying *c = context;
    const cw_volume *v = c->v;
    const size_t size = cw_type_size(v->type), row = v->dim[0] * size;
    for (size_t j = 0; j < v->dim[1]; j++) {
        const char *from = cwi_voxel_address(v, 0, j, c->first + k);
        char *out = c->to + (k * v->dim[1] + j) * row;
        if (v->stride[0] == (ptrdiff_t)size)
            memcpy(out, from, row);
        for (size_t i = 0; i < v->dim[0] && v->stride[0] != (ptrdiff_t)size; i++)
            memcpy(out + i * size, from + (ptrdiff_t)i * v->stride[0], size);
    }
}

static void copy_layers(const cw_volume *v, size_t first, size_t count, char *to)
{
    copying c = {v, first, to};
    cwi_parallel_for_all(count, v->dim[0] * v->dim[1], 0, copy_layer, &c);
}

static cw_status upload_layers(const cw_volume *v, texels of, cw_error *err)
{
    const bool as_is = cwi_gl_is_packed(v);
    const size_t layer = v->dim[0] * v->dim[1] * cw_type_size(v->type);
    const size_t fit = CHUNK_BYTES / layer, step = fit < 1           ? 1
                                                   : fit < v->dim[2] ? fit
                                                                     : v->dim[2];
    char *chunk = as_is ? NULL : cwi_alloc_array(step, layer);
    if (!chunk && !as_is)
        return cwi_fail_memory(err);
    for (size_t k = 0; k < v->dim[2]; k += step) {
        const size_t n = v->dim[2] - k < step ? v->dim[2] - k : step;
        if (!as_is)
            copy_layers(v, k, n, chunk);
        glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, (GLint)k, (GLsizei)v->dim[0],
                        (GLsizei)v->dim[1], (GLsizei)n, GL_RED_INTEGER, of.type,
                        as_is ? cwi_voxel_address(v, 0, 0, k) : chunk);
    }
    cwi_free(chunk);
    return CW_OK;
}

cw_status cwi_live_upload(cwi_live *live, cw_error *err)
{
    const cw_volume *v = &live->key;
    const texels of = texels_of(v->type);
    const size_t bytes = v->dim[0] * v->dim[1] * v->dim[2] * cw_type_size(v->type);
    for (int a = 0; a < 3; a++)
        if (v->dim[a] > live->capacity.texture_edge)
            return cwi_fail(err, CW_ERR_LIMIT,
                            "%zu voxels along %c: OpenGL holds textures of up to %zu",
                            v->dim[a], "xyz"[a], live -> capacity.texture_edge);
    if (!texture_fits(of, v->dim))
        return cwi_fail(err, CW_ERR_LIMIT, "OpenGL holds no texture of %zu x %zu x %zu voxels",
                        v->dim[0], v->dim[1], v->dim[2]);
    if (!cwi_memory_take(bytes))
        return cwi_fail_memory(err);
    live->counted_bytes += bytes;
    live->voxels = cwi_gl_texture(GL_TEXTURE_3D, CWI_UNIT_FREE, false);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage3D(GL_TEXTURE_3D, 0, (GLint)of.inner, (GLsizei)v->dim[0], (GLsizei)v->dim[1],
                 (GLsizei)v->dim[2], 0, GL_RED_INTEGER, of.type, NULL);
    cw_status st = upload_layers(v, of, err);
    return st == CW_OK ? cwi_gl_check(err) : st;
}
