/* Allocates textures, and the framebuffer of 32-bit floats that pictures are drawn into. */
#include "viewer/gl/gl_internal.h"

#include "core/base/status.h"

GLuint cwi_gl_texture(GLenum kind, int unit, bool linear)
{
    GLuint name;
    const GLint filter = linear ? GL_LINEAR : GL_NEAREST;
    glGenTextures(1, &name);
    glActiveTexture(GL_TEXTURE0 + (GLenum)unit);
    glBindTexture(kind, name);
    glTexParameteri(kind, GL_TEXTURE_MIN_FILTER, filter);
    glTexParameteri(kind, GL_TEXTURE_MAG_FILTER, filter);
    glTexParameteri(kind, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(kind, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glTexParameteri(kind, GL_TEXTURE_WRAP_R, GL_CLAMP_TO_EDGE);
    glTexParameteri(kind, GL_TEXTURE_MAX_LEVEL, 0);
    return name;
}

void cwi_gl_drop_target(cwi_gl *gl)
{
    glDeleteFramebuffers(1, &gl->target.framebuffer);
    glDeleteFramebuffers(1, &gl->target.rays);
    glDeleteTextures(1, &gl->target.color);
    glDeleteTextures(1, &gl->target.depth);
    gl->target = (cwi_gl_target){0};
}

static GLuint framebuffer_of(GLuint color)
{
    GLuint name;
    glGenFramebuffers(1, &name);
    glBindFramebuffer(GL_FRAMEBUFFER, name);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, color, 0);
    return name;
}

static void make_target(cwi_gl_target *t, GLsizei width, GLsizei height)
{
    t->width = width;
    t->height = height;
    t->color = cwi_gl_texture(GL_TEXTURE_2D, CWI_UNIT_FREE, false);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, width, height, 0, GL_RGBA, GL_FLOAT, NULL);
    t->depth = cwi_gl_texture(GL_TEXTURE_2D, CWI_UNIT_DEPTH, false);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, width, height, 0, GL_DEPTH_COMPONENT,
                 GL_FLOAT, NULL);
    t->rays = framebuffer_of(t->color);
    t->framebuffer = framebuffer_of(t->color);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, t->depth, 0);
}

cw_status cwi_gl_take_target(cwi_gl *gl, cw_error *err)
{
    GLint max;
    const cw_scene *s = &gl->frame->scene;
    const GLsizei width = (GLsizei)s->width, height = (GLsizei)s->height;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &max);
    if (width > max || height > max)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "a picture of %d x %d samples: this OpenGL draws up to %d", width,
                        height, max);
    if (gl->target.width != width || gl->target.height != height) {
        cwi_gl_drop_target(gl);
        make_target(&gl->target, width, height);
    }
    glBindFramebuffer(GL_FRAMEBUFFER, gl->target.framebuffer);
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        return cwi_fail(err, CW_ERR_BACKEND, "OpenGL does not draw into floats");
    glViewport(0, 0, width, height);
    return CW_OK;
}
