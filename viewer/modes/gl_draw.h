/* Entry points of the GL module. */
#ifndef VIEWER_MODES_GL_DRAW_H
#define VIEWER_MODES_GL_DRAW_H

#include "viewer/gl/gl_internal.h"

CW_NODISCARD cw_status cwi_gl_draw(cwi_gl *gl, const cwi_frame *frame, cw_picture *picture,
                                   cw_error *err);

/* Returns the mode's row; NULL when GL does not draw it. */
const cwi_gl_mode *cwi_gl_find_mode(cw_mode mode);

#endif
