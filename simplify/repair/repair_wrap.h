/* CGAL's alpha wrap behind plain C: the function of the module "wrap". */
#ifndef SIMPLIFY_REPAIR_REPAIR_WRAP_H
#define SIMPLIFY_REPAIR_REPAIR_WRAP_H

#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cwi_wrap_functions {
    /* Wraps the triangles of a mesh.
     * radius_mm, offset_mm  alpha and offset of [Portaneri2022] */
    cw_status (*wrap)(const cw_mesh *mesh, double radius_mm, double offset_mm, cw_mesh *out,
                      cw_error *err);
} cwi_wrap_functions;

extern CW_API const cwi_wrap_functions cwi_module_wrap;

#ifdef __cplusplus
}
#endif

#endif
