/* The modes that OpenGL draws, and entry points of the GL module. */
#ifndef VIEWER_MODES_GL_DRAW_H
#define VIEWER_MODES_GL_DRAW_H

#include "viewer/gl/gl_internal.h"

/* A mode: draws into gl->target, which is bound, cleared or with the mesh in it. */
typedef struct cwi_gl_mode {
    cw_mode mode;
    bool goes_along_rays; /* draws into target.rays */
    /* Draws by the mode's state, which is made at the first call. The frame is gl->frame. */
    cw_status (*draw)(cwi_gl *gl, void **state, cw_error *err);
    /* Frees it, when another volume or mesh comes and at the end; NULL: there is none. */
    void (*drop)(void *state);
    bool needs_textures; /* its shaders read values by themselves, not by texel_at() alone */
} cwi_gl_mode;

extern const cwi_gl_mode cwi_gl_composite, cwi_gl_mip, cwi_gl_minip, cwi_gl_average,
    cwi_gl_local_mip, cwi_gl_mesh_mode, cwi_gl_projection, cwi_gl_slices, cwi_gl_splat,
    cwi_gl_splat_tree, cwi_gl_texture_mode, cwi_gl_shaded_texture;

/* Draws the scene's mesh, opaque, with its depth. */
CW_NODISCARD cw_status cwi_gl_draw_mesh(cwi_gl *gl, cw_error *err);

CW_NODISCARD cw_status cwi_gl_draw(cwi_gl *gl, const cwi_frame *frame, cw_picture *picture,
                                   cw_error *err);

/* Returns the mode's row; NULL when GL does not draw it. */
const cwi_gl_mode *cwi_gl_find_mode(cw_mode mode);

#endif
