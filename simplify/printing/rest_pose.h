/* Bodies that roll on a plate until they rest. */
#ifndef SIMPLIFY_PRINTING_REST_POSE_H
#define SIMPLIFY_PRINTING_REST_POSE_H

#include <cubewright/mesh.h>

/* Points of a body, relative to the mesh's origin, and its centre of mass. */
typedef struct cwi_rest_body {
    double (*points)[3];
    size_t count;
    double center[3];
} cwi_rest_body;

/* Lists the points of the vertices that triangles name. Free it. CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_rest_body_make(const cw_mesh *mesh, cwi_rest_body *body,
                                          cw_error *err);

/* Keeps the outermost points of a body, along each axis in columns of a 48th of the box. CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_rest_body_thin(const cwi_rest_body *body, cwi_rest_body *few,
                                          cw_error *err);
void cwi_rest_body_free(cwi_rest_body *body);

/* Drops points that are deeper than `depth` inside the convex hull of all, as far as a coarse grid
 * tells: in no pose they come near the plate. */
CW_NODISCARD cw_status cwi_rest_body_drop_inner(cwi_rest_body *body, double depth,
                                                cw_error *err);

/* Lets a body roll from where a direction points down, until its centre of mass is above the hull of what
 * touches the plate.
 * down     of length 1; set to the direction of the pose
 * Returns  false when memory is out */
bool cwi_roll_to_rest(const cwi_rest_body *body, double down[3]);

/* Makes the rotation by the smallest angle that turns a direction down; exact for axes. */
void cwi_turn_down(const double down[3], double matrix[12]);

#endif
