/* Sets a volume's uniforms for shaders, and lets them read voxels in the caller's memory. */
#include "viewer/gl/gl_internal.h"

#include "core/volume/volume.h"

#include <string.h>

bool cwi_gl_is_packed(const cw_volume *v)
{
    const ptrdiff_t size = (ptrdiff_t)cw_type_size(v->type);
    return v->stride[0] == size && v->stride[1] == size * (ptrdiff_t)v->dim[0] &&
           v->stride[2] == v->stride[1] * (ptrdiff_t)v->dim[1];
}

/* Returns true for voxels that can be fetched. Signed ones become the texels that textures have
 * of them. */
static bool is_fetched(const cw_volume *v, const cwi_gl_texels *kind)
{
    return (kind->as_is || (v->type == CW_I16 && !v->has_nodata)) && cwi_gl_is_packed(v);
}

/* Returns true if voxels can be read in place: Mesa's software renderer reads any memory of the
 * process as a buffer. */
static bool can_find(const cwi_gl *gl, size_t count)
{
    GLint max = 0;
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &max);
    return count <= (size_t)max && strstr(gl->name, "llvmpipe") &&
           epoxy_has_gl_extension("GL_AMD_pinned_memory");
}

static void make_voxels(const cwi_gl_volume *g, cwi_gl_brick *b, size_t count)
{
    glGenBuffers(1, &b->buffer);
    glBindBuffer(GL_EXTERNAL_VIRTUAL_MEMORY_BUFFER_AMD, b->buffer);
    glBufferData(GL_EXTERNAL_VIRTUAL_MEMORY_BUFFER_AMD, (GLsizeiptr)(count * g->kind.size),
                 g->key.data, GL_STATIC_DRAW);
    glBindBuffer(GL_EXTERNAL_VIRTUAL_MEMORY_BUFFER_AMD, 0);
    glGenTextures(1, &b->voxels);
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_VOLUME);
    glBindTexture(GL_TEXTURE_BUFFER, b->voxels);
    glTexBuffer(GL_TEXTURE_BUFFER, g->key.type == CW_I16 ? GL_R16I : g->kind.inner, b->buffer);
}

bool cwi_gl_find_voxels(cwi_gl *gl)
{
    const cwi_gl_volume *g = &gl->volume;
    const size_t count = g->key.dim[0] * g->key.dim[1] * g->key.dim[2];
    if (g->brick_count != 1 || g->edge || !is_fetched(&g->key, &g->kind) ||
        !can_find(gl, count))
        return false;
    if (!g->bricks->voxels)
        make_voxels(g, g->bricks, count);
    return true;
}

/* Sets the steps from a voxel to the next along each axis; 0 where there is only one. */
static void set_steps(GLuint program, const size_t dim[3])
{
    const size_t steps[3] = {1, dim[0], dim[0] * dim[1]};
    GLint out[3];
    double last[3];
    for (int a = 0; a < 3; a++) {
        out[a] = dim[a] > 1 ? (GLint)steps[a] : 0;
        last[a] = dim[a] > 1 ? (double)dim[a] - 2 : 0;
    }
    glUniform3iv(glGetUniformLocation(program, "voxel_steps"), 1, out);
    cwi_gl_set3(program, "last_cell", last);
}

void cwi_gl_bind_brick(GLuint program, const cwi_gl_brick *brick)
{
    const double first[3] = {(double)brick->first[0], (double)brick->first[1],
                             (double)brick->first[2]};
    const double size[3] = {(double)brick->count[0], (double)brick->count[1],
                            (double)brick->count[2]};
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_VOLUME);
    glBindTexture(GL_TEXTURE_3D, brick->values);
    glBindTexture(GL_TEXTURE_BUFFER, brick->voxels);
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_GRADIENT);
    glBindTexture(GL_TEXTURE_3D, brick->gradients);
    cwi_gl_set3(program, "brick_first", first);
    cwi_gl_set3(program, "brick_size", size);
    set_steps(program, brick->count);
}

void cwi_gl_set_last_block(GLuint program, const size_t dim[3])
{
    cwi_gl_set3(program, "last_block",
                (double[]){(double)dim[0] - 1, (double)dim[1] - 1, (double)dim[2] - 1});
}
