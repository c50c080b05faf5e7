/* Entry points of the GL module. */
#ifndef VIEWER_MODES_GL_DRAW_H
#define VIEWER_MODES_GL_DRAW_H

#include "viewer/gl/gl_internal.h"

cw_status cwi_gl_draw(cwi_gl *gl, const cwi_frame *frame, cw_picture *picture, cw_error *err);

/* Makes the context this thread's, until cwi_gl_leave() puts back what was there; false when it
 * was lost. */
bool cwi_gl_enter(cwi_gl *gl);
void cwi_gl_leave(cwi_gl *gl);

/* Starts asking the frame's progress anew. */
void cwi_gl_start_watch(cwi_gl *gl);

/* Frees what was made of a volume, a mesh and a transfer function. */
void cwi_gl_drop_scene(cwi_gl *gl);

#endif
