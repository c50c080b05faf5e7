/* A context without a display: EGL on Mesa's surfaceless platform, else on any device. */
#include "viewer/gl_draw.h"

#include "core/memory.h"
#include "core/status.h"

#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

#define PACKAGES "apt-get install libegl1 libgl1 libgl1-mesa-dri"

static EGLDisplay surfaceless(void)
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

/* Reports of a lost context are asked for where there are such. */
static EGLContext make_context(EGLDisplay display)
{
    const EGLint wanted[] = {
        EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 3,
        EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
        /* left out when it is not known: */
        EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY, EGL_LOSE_CONTEXT_ON_RESET, EGL_NONE};
    EGLint plain[7];
    memcpy(plain, wanted, 6 * sizeof *plain);
    plain[6] = EGL_NONE;
    EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, wanted);
    return context != EGL_NO_CONTEXT
               ? context
               : eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, plain);
}

static bool start(cwi_gl *gl, EGLDisplay display)
{
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, NULL, NULL))
        return false;
    gl->display = display;
    if (eglBindAPI(EGL_OPENGL_API))
        gl->context = make_context(display);
    return gl->context != EGL_NO_CONTEXT &&
           eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, gl->context);
}

/* The caller may have a context of its own on this thread. */
static void remember(cwi_gl *gl)
{
    gl->before.display = eglGetCurrentDisplay();
    gl->before.draw = eglGetCurrentSurface(EGL_DRAW);
    gl->before.read = eglGetCurrentSurface(EGL_READ);
    gl->before.context = eglGetCurrentContext();
}

bool cwi_gl_enter(cwi_gl *gl)
{
    remember(gl);
    return eglMakeCurrent(gl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, gl->context);
}

void cwi_gl_leave(cwi_gl *gl)
{
    if (gl->before.context != EGL_NO_CONTEXT && gl->before.context != gl->context)
        eglMakeCurrent(gl->before.display, gl->before.draw, gl->before.read,
                       gl->before.context);
    else
        eglMakeCurrent(gl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

/* The display stays initialised: it is the process's, and others may use it. */
static void stop(cwi_gl *gl)
{
    if (gl->display == EGL_NO_DISPLAY)
        return;
    cwi_gl_leave(gl);
    if (gl->context != EGL_NO_CONTEXT)
        eglDestroyContext(gl->display, gl->context);
    gl->display = EGL_NO_DISPLAY;
    gl->context = EGL_NO_CONTEXT;
}

static bool is_library(const char *name)
{
    void *library = dlopen(name, RTLD_LAZY | RTLD_LOCAL);
    if (library)
        dlclose(library);
    return library != NULL;
}

static cw_status open_context(cwi_gl *gl, cw_error *err)
{
    /* libepoxy ends the process where it finds one of them missing */
    if (!is_library("libEGL.so.1") ||
        !(is_library("libOpenGL.so.0") || is_library("libGL.so.1")))
        return cw_fail(err, CW_ERR_UNSUPPORTED, "this machine has no OpenGL: " PACKAGES);
    remember(gl);
    if (!start(gl, surfaceless())) {
        stop(gl);
        if (!start(gl, first_device())) {
            stop(gl);
            return cw_fail(err, CW_ERR_UNSUPPORTED,
                           "no driver here offers OpenGL 3.3 without a display: " PACKAGES);
        }
    }
    snprintf(gl->name, sizeof gl->name, "OpenGL %d.%d, %s", epoxy_gl_version() / 10,
             epoxy_gl_version() % 10, (const char *)glGetString(GL_RENDERER));
    return CW_OK;
}

static cw_status gl_open(cwi_gl **out, cw_error *err)
{
    cwi_gl *gl = cwi_alloc_zeroed(1, sizeof *gl);
    if (!gl)
        return cw_fail(err, CW_ERR_NO_MEMORY, "no memory for OpenGL");
    cw_status st = open_context(gl, err);
    if (st != CW_OK) {
        cwi_free(gl);
        return st;
    }
    glGenBuffers(1, &gl->frame_block);
    glGenVertexArrays(1, &gl->empty_array);
    cwi_gl_leave(gl);
    *out = gl;
    return CW_OK;
}

static void drop_states(cwi_gl *gl)
{
    for (int m = 0; m < CW_MODE_COUNT; m++) {
        const cwi_gl_mode *mode = cwi_gl_find_mode((cw_mode)m);
        if (mode && mode->drop && gl->state[m])
            mode->drop(gl->state[m]);
        gl->state[m] = NULL;
    }
}

void cwi_gl_drop_scene(cwi_gl *gl)
{
    drop_states(gl);
    cwi_gl_drop_volume(gl);
    cwi_gl_drop_transfer(gl);
}

static void gl_forget(cwi_gl *gl)
{
    cwi_gl_enter(gl);
    cwi_gl_drop_scene(gl);
    cwi_gl_leave(gl);
}

static void gl_close(cwi_gl *gl)
{
    cwi_gl_enter(gl);
    cwi_gl_drop_scene(gl);
    cwi_gl_drop_target(gl);
    for (size_t n = 0; n < gl->program_count; n++)
        glDeleteProgram(gl->programs[n].name);
    glDeleteBuffers(1, &gl->frame_block);
    glDeleteVertexArrays(1, &gl->empty_array);
    stop(gl);
    cwi_free(gl);
}

static const char *gl_name(const cwi_gl *gl)
{
    return gl->name;
}

CW_API extern const cwi_gl_functions cwi_module_gl;
const cwi_gl_functions cwi_module_gl = {gl_open, gl_close, gl_name, gl_forget, cwi_gl_draw};
