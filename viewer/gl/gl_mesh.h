/* A mesh on the GPU, and the textures for drawing it translucent and cut open. */
#ifndef VIEWER_GL_GL_MESH_H
#define VIEWER_GL_GL_MESH_H

#include "viewer/gl/gl_internal.h"

/* Texture units of the shaders that draw it. */
enum {
    CWI_UNIT_RAMP = CWI_UNIT_FREE,
    CWI_UNIT_LAYER,
    CWI_UNIT_PEELED,
    CWI_UNIT_COVERED,
    CWI_UNIT_WINDING,
};

/* Planes counted in one pass, one a channel. */
enum { CWI_PLANES_A_PASS = 4, CWI_WINDINGS = CW_MAX_CLIPS / CWI_PLANES_A_PASS };

typedef struct cwi_gl_mesh {
    cw_mesh key;
    bool is_uploaded, is_expanded; /* each triangle has corners of its own */
    cw_tint tint;
    bool has_alpha; /* some vertex is translucent */
    double tint_range[2];
    GLuint array, vertices, indices, ramp, query;
    GLuint live_array; /* of a live surface, drawn in place of what was uploaded; else 0 */
    size_t live_triangles;

    /* Textures of the target's size; 0 until they are needed. Layers: a color, and the depths
     * of this layer and the one before. Windings: how often the mesh goes around points of
     * planes. */
    GLsizei width, height;
    GLuint layer_color, layer_depth[2], layers[2];
    GLuint windings[CWI_WINDINGS], winding_targets[CWI_WINDINGS];
} cwi_gl_mesh;

/* Uploads the frame's mesh, unless it is there as the scene wants it. Made at the
 * first call. */
CW_NODISCARD cw_status cwi_gl_take_mesh(cwi_gl *gl, void **state, cwi_gl_mesh **mesh,
                                        cw_error *err);
void cwi_gl_drop_mesh(void *state);

/* Takes a live surface in its place: a vertex array of positions and normals, and indices. */
CW_NODISCARD cw_status cwi_gl_lend_mesh(void **state, GLuint array, size_t triangles,
                                        cwi_gl_mesh **mesh, cw_error *err);

/* Textures of the target's size. */
CW_NODISCARD cw_status cwi_gl_need_layers(cwi_gl *gl, cwi_gl_mesh *mesh, cw_error *err);
CW_NODISCARD cw_status cwi_gl_need_winding(cwi_gl *gl, cwi_gl_mesh *mesh, size_t n,
                                           cw_error *err);

/* Sets matrix and samplers of a program of mesh.glsl, and draws all triangles.
 * CW_ERR_CANCELLED */
void cwi_gl_set_mesh(const cwi_gl *gl, GLuint program);
CW_NODISCARD cw_status cwi_gl_draw_whole_mesh(cwi_gl *gl, const cwi_gl_mesh *mesh,
                                              cw_error *err);

#endif
