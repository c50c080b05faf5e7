/* Slices through bricks of a volume, blended back to front, for the modes that are textures. */
#ifndef VIEWER_MODES_SLAB_TEXTURES_H
#define VIEWER_MODES_SLAB_TEXTURES_H

#include "viewer/gl/gl_internal.h"
#include "viewer/proxy/view_slabs.h"

/* Texture units of these modes. */
enum {
    CWI_UNIT_SLICES = CWI_UNIT_FREE, /* blended, in the scene's precision */
    CWI_UNIT_CLASSES,                /* classified voxels */
    CWI_UNIT_NORMALS,                /* numbers of the voxels' directions */
    CWI_UNIT_SHADES,                 /* colours by direction, and by value or material */
    CWI_UNIT_DIRECTIONS,             /* the directions themselves */
    CWI_UNIT_MATERIALS               /* the material of a value */
};

/* State that a mode keeps from one picture to the next. Zeroed is valid. */
typedef struct cwi_gl_slabs {
    GLuint array, corners; /* of the rectangles drawn */
    GLuint framebuffer, color;
    GLsizei width, height;
    cw_target target;
} cwi_gl_slabs;

void cwi_gl_drop_slices(cwi_gl_slabs *slices);

/* Draws the frame's slices, with a program of slab.glsl and texture.glsl.
 * defines  the mode's own, after which those of the scene are put
 * bind     binds a mode's own textures of a brick, beside values and gradients; may be NULL */
CW_NODISCARD cw_status cwi_gl_draw_slices(cwi_gl *gl, cwi_gl_slabs *slices, const char *defines,
                                          void (*bind)(const void *state, size_t brick),
                                          const void *state, cw_error *err);

#endif
