/* The module that draws by OpenGL, as the rest of the library sees it: it includes no GL. */
#ifndef VIEWER_GL_GL_H
#define VIEWER_GL_GL_H

#include "viewer/scene/frame_setup.h"

#include <string.h>

/* Returns true if a renderer's name is that of one without hardware: OpenGL runs on the CPU. */
static inline bool cwi_gl_is_software(const char *name)
{
    static const char *const names[] = {"llvmpipe", "softpipe", "swrast", "SwiftShader"};
    bool found = false;
    for (size_t n = 0; name && n < sizeof names / sizeof *names; n++)
        found = found || strstr(name, names[n]);
    return found;
}

typedef struct cwi_gl cwi_gl; /* a context, and the data uploaded to it */

/* Limits of a live surface below the driver's; 0: the driver's. */
typedef struct cwi_live_limits {
    size_t texture_edge, buffer_bytes;
} cwi_live_limits;

/* Times that the GPU took for a live surface. */
typedef struct cwi_live_times {
    double classify_ms, scan_ms, emit_ms;
} cwi_live_times;

typedef struct cwi_gl_functions {
    cw_status (*open)(cwi_gl **gl, cw_error *err); /* by EGL, without a display */
    void (*close)(cwi_gl *gl);
    const char *(*name)(const cwi_gl *gl);
    void (*forget)(cwi_gl *gl);
    cw_status (*draw)(cwi_gl *gl, const cwi_frame *frame, cw_picture *picture, cw_error *err);
    /* As cw_renderer_prepare(). */
    cw_status (*prepare)(cwi_gl *gl, const cw_live_surface *desc, bool *ready, cw_error *err);
    /* Extracts a live surface and, unless mesh is NULL, copies it there; for tests and benches.
     * limits, times: may be NULL. The surface's size is stored in any case. */
    cw_status (*extract)(cwi_gl *gl, const cw_live_surface *desc, const cwi_live_limits *limits,
                         cwi_live_times *times, size_t size[2], cw_mesh *mesh, cw_error *err);
} cwi_gl_functions;

#endif
