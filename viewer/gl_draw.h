/* Entry points of the GL module. */
#ifndef VIEWER_GL_DRAW_H
#define VIEWER_GL_DRAW_H

#include "viewer/gl_work.h"

cw_status cwi_gl_draw(cwi_gl *gl, const cwi_frame *frame, cw_picture *picture, cw_error *err);
void cwi_gl_forget(cwi_gl *gl);

#endif
