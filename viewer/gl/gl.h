/* The module that draws by OpenGL, as the rest of the library sees it: it includes no GL. */
#ifndef VIEWER_GL_GL_H
#define VIEWER_GL_GL_H

#include "viewer/scene/frame_setup.h"

typedef struct cwi_gl cwi_gl; /* a context, and the data uploaded to it */

typedef struct cwi_gl_functions {
    cw_status (*open)(cwi_gl **gl, cw_error *err); /* by EGL, without a display */
    void (*close)(cwi_gl *gl);
    const char *(*name)(const cwi_gl *gl);
    void (*forget)(cwi_gl *gl);
    cw_status (*draw)(cwi_gl *gl, const cwi_frame *frame, cw_picture *picture, cw_error *err);
} cwi_gl_functions;

#endif
