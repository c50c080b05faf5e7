/* A context without a display: EGL on Mesa's surfaceless platform, else on any device. */
#include "viewer/gl/gl_context.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

static EGLDisplay open_surfaceless(void)
{
    const char *extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    if (!extensions || !strstr(extensions, "EGL_MESA_platform_surfaceless"))
        return EGL_NO_DISPLAY;
    return eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
}

static EGLDisplay first_device(void)
{
    EGLDeviceEXT device;
    EGLint count = 0;
    const char *extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    if (!extensions || !strstr(extensions, "EGL_EXT_platform_device") ||
        !eglQueryDevicesEXT(1, &device, &count) || count < 1)
        return EGL_NO_DISPLAY;
    return eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, device, NULL);
}

/* Makes a context of a version that reports its loss, where that is supported. */
static EGLContext make_version(EGLDisplay display, EGLint major, EGLint minor)
{
    const EGLint attributes[] = {
        EGL_CONTEXT_MAJOR_VERSION, major, EGL_CONTEXT_MINOR_VERSION, minor,
        EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
        /* left out when it is not known: */
        EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY, EGL_LOSE_CONTEXT_ON_RESET, EGL_NONE};
    EGLint plain[7];
    memcpy(plain, attributes, 6 * sizeof *plain);
    plain[6] = EGL_NONE;
    EGLContext context =
        eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    return context != EGL_NO_CONTEXT
               ? context
               : eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, plain);
}

/* Makes a context with compute shaders, else without. NVIDIA's driver gives the version that was
 * asked for, others the newest that has all of it. */
static EGLContext make_context(EGLDisplay display)
{
    const EGLContext context = make_version(display, 4, 3);
    return context != EGL_NO_CONTEXT ? context : make_version(display, 3, 3);
}

static bool start_context(cwi_gl_context *c, EGLDisplay display)
{
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, NULL, NULL))
        return false;
    c->display = display;
    if (eglBindAPI(EGL_OPENGL_API))
        c->context = make_context(display);
    return c->context != EGL_NO_CONTEXT &&
           eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, c->context);
}

static void remember_current(cwi_gl_context *c)
{
    c->before.display = eglGetCurrentDisplay();
    c->before.draw = eglGetCurrentSurface(EGL_DRAW);
    c->before.read = eglGetCurrentSurface(EGL_READ);
    c->before.context = eglGetCurrentContext();
}

bool cwi_gl_context_enter(cwi_gl_context *c)
{
    remember_current(c);
    return eglMakeCurrent(c->display, EGL_NO_SURFACE, EGL_NO_SURFACE, c->context);
}

void cwi_gl_context_leave(cwi_gl_context *c)
{
    if (c->before.context != EGL_NO_CONTEXT && c->before.context != c->context)
        eglMakeCurrent(c->before.display, c->before.draw, c->before.read, c->before.context);
    else
        eglMakeCurrent(c->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

/* The display stays initialised: it is the process's, and others may use it. */
void cwi_gl_context_close(cwi_gl_context *c)
{
    if (c->display == EGL_NO_DISPLAY)
        return;
    cwi_gl_context_leave(c);
    if (c->context != EGL_NO_CONTEXT)
        eglDestroyContext(c->display, c->context);
    c->display = EGL_NO_DISPLAY;
    c->context = EGL_NO_CONTEXT;
}

static bool is_library(const char *name)
{
    void *library = dlopen(name, RTLD_LAZY | RTLD_LOCAL);
    if (library)
        dlclose(library);
    return library != NULL;
}

cw_status cwi_gl_is_there(cw_error *err)
{
    if (!is_library("libEGL.so.1") ||
        !(is_library("libOpenGL.so.0") || is_library("libGL.so.1")))
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "this machine has no OpenGL: " CWI_GL_PACKAGES);
    return CW_OK;
}

cw_status cwi_gl_context_open(cwi_gl_context *c, cw_error *err)
{
    cw_status st = cwi_gl_is_there(err);
    if (st != CW_OK)
        return st;
    remember_current(c);
    if (start_context(c, open_surfaceless()))
        return CW_OK;
    cwi_gl_context_close(c);
    if (start_context(c, first_device()))
        return CW_OK;
    cwi_gl_context_close(c);
    return cwi_fail(err, CW_ERR_UNSUPPORTED,
                    "no driver here offers OpenGL 3.3 without a display: " CWI_GL_PACKAGES);
}

void cwi_gl_describe(char *name, size_t size)
{
    snprintf(name, size, "OpenGL %d.%d, %s", epoxy_gl_version() / 10, epoxy_gl_version() % 10,
             (const char *)glGetString(GL_RENDERER));
}

static bool is_lost(void)
{
    return epoxy_gl_version() >= 45 ? glGetGraphicsResetStatus() != GL_NO_ERROR
           : epoxy_has_gl_extension("GL_ARB_robustness")
               ? glGetGraphicsResetStatusARB() != GL_NO_ERROR
               : false;
}

cw_status cwi_gl_check(cw_error *err)
{
    if (is_lost())
        return cwi_fail(err, CW_ERR_BACKEND, "the OpenGL context was lost");
    const GLenum first = glGetError();
    while (glGetError() != GL_NO_ERROR)
        ;
    if (first == GL_OUT_OF_MEMORY)
        return cwi_fail_memory(err);
    if (first != GL_NO_ERROR)
        return cwi_fail(err, CW_ERR_BACKEND, "OpenGL failed with error 0x%04x", first);
    return CW_OK;
}
