/* An OpenGL context without a display: of what draws volumes, and of windows that
 * nobody sees. */
#ifndef VIEWER_GL_GL_CONTEXT_H
#define VIEWER_GL_GL_CONTEXT_H

#include <cubewright/core.h>

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#define CWI_GL_PACKAGES "apt-get install libegl1 libgl1 libgl1-mesa-dri"

typedef struct cwi_gl_context {
    EGLDisplay display;
    EGLContext context;
    struct {
        EGLDisplay display;
        EGLSurface draw, read;
        EGLContext context;
    } before; /* the caller's, while this one draws */
} cwi_gl_context;

/* Opens one; it is current afterwards, as after enter(). CW_ERR_UNSUPPORTED: what to install */
CW_NODISCARD cw_status cwi_gl_context_open(cwi_gl_context *context, cw_error *err);
void cwi_gl_context_close(cwi_gl_context *context);

/* The caller may have a context of its own on this thread: it comes back by leave(). */
bool cwi_gl_context_enter(cwi_gl_context *context);
void cwi_gl_context_leave(cwi_gl_context *context);

/* libepoxy ends the process where it finds no OpenGL: ask before anything else of it. */
CW_NODISCARD cw_status cwi_gl_is_there(cw_error *err);

/* The rest is of the current context. "OpenGL 4.5, llvmpipe ..." */
void cwi_gl_describe(char *name, size_t size);

/* GL's errors since the last look, and a lost context. */
CW_NODISCARD cw_status cwi_gl_check(cw_error *err);

#endif
