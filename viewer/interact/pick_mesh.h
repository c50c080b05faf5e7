/* Finds where a ray meets a mesh. */
#ifndef VIEWER_INTERACT_PICK_MESH_H
#define VIEWER_INTERACT_PICK_MESH_H

#include "viewer/scene/frame_setup.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A point of a mesh on a ray. */
typedef struct cwi_mesh_hit {
    double t;          /* along the ray, in eye space; INFINITY: there is none */
    size_t triangle;   /* SIZE_MAX: a filled cut */
    double weights[3]; /* of the triangle's corners; 0 of a cut */
} cwi_mesh_hit;

/* Finds the nearest point of the frame's mesh that is drawn, even with an opacity that rounds
 * to 0, on a ray in eye space. Rays through edges and corners meet one of the triangles
 * there. */
cwi_mesh_hit cwi_pick_mesh(const cwi_frame *frame, const double origin[3],
                           const double direction[3]);

#ifdef __cplusplus
}
#endif

#endif
