/* Components of a surface that a mesh of it lacks. */
#ifndef CLI_INPUTS_MISSING_COMPONENTS_H
#define CLI_INPUTS_MISSING_COMPONENTS_H

#include <cubewright/mesh.h>

typedef struct cli_missing {
    size_t count;
    double largest_mm3; /* what one of them encloses, at most */
    double max_mm;      /* how far their vertices are from the mesh, at most */
} cli_missing;

/* Takes out of a surface the components none of whose vertices is as near to the mesh as
 * `near`. surface      in place distance_mm  of each vertex from the mesh Returns
 * CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cli_drop_missing(cw_mesh *surface, const float *distance_mm,
                                        double near_mm, cli_missing *missing, cw_error *err);

#endif
