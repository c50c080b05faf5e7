/* CGAL behind plain C: the functions of the module "cgal". */
#ifndef QUALITY_CGAL_WRAP_H
#define QUALITY_CGAL_WRAP_H

#include "simplify/quality/welded_mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cwi_cgal_functions {
    /* Judges the mesh, welded as it is, by CGAL's Polygon Mesh Processing. */
    cw_status (*judge)(const cwi_welded *welded, cw_cgal_facts *out, cw_error *err);

    /* One-sided Hausdorff distance, off by at most tolerance_mm. Both meshes must be valid
     * polygon meshes: else CW_ERR_BACKEND. */
    cw_status (*hausdorff)(const cw_mesh *mesh, const cw_mesh *reference, double tolerance_mm,
                           double *out_mm, cw_error *err);
} cwi_cgal_functions;

extern CW_API const cwi_cgal_functions cwi_module_cgal;

#ifdef __cplusplus
}
#endif

#endif
