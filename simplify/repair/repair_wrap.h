/* CGAL's constructions behind plain C: the functions of the module "wrap". */
#ifndef SIMPLIFY_REPAIR_REPAIR_WRAP_H
#define SIMPLIFY_REPAIR_REPAIR_WRAP_H

#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cwi_wrap_functions {
    /* Unites closed manifolds without crossings, whichever way they face.
     * shell    of each triangle: the component that it belongs to, below shells
     * marked   of each triangle: belongs to one of them
     * is_done  set to false, with an empty mesh, when CGAL cannot */
    cw_status (*unite)(const cw_mesh *mesh, const uint32_t *shell, uint32_t shells,
                       const bool *marked, cw_mesh *out, bool *is_done, cw_error *err);

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
