/* An OpenGL context without a display, for drawing volumes and for hidden windows. */
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

/* Opens a context; it is current afterwards, as after enter(). CW_ERR_UNSUPPORTED: the message
 * names the package to install */
CW_NODISCARD cw_status cwi_gl_context_open(cwi_gl_context *context, cw_error *err);
void cwi_gl_context_close(cwi_gl_context *context);

/* Makes the context current. The caller may have a context of its own on this thread: leave()
 * restores it. */
bool cwi_gl_context_enter(cwi_gl_context *context);
void cwi_gl_context_leave(cwi_gl_context *context);

/* Checks that OpenGL exists. libepoxy ends the process where it finds none: call this first. */
CW_NODISCARD cw_status cwi_gl_is_there(cw_error *err);

/* The rest is of the current context. "OpenGL 4.5, llvmpipe ..." */
void cwi_gl_describe(char *name, size_t size);

/* Reports GL's errors since the last check, and a lost context. */
CW_NODISCARD cw_status cwi_gl_check(cw_error *err);

#endif
