/* Measures walls and gaps by rays from points of the surface. */
#ifndef SIMPLIFY_PRINTING_WALL_RAYS_H
#define SIMPLIFY_PRINTING_WALL_RAYS_H

#include <cubewright/print.h>

/* The thinnest of all, and the area of the surface at thin ones. Zeroed is not empty: see
 * cwi_measure_walls(). */
typedef struct cwi_wall_sum {
    double min_mm; /* mm; INFINITY: none */
    double at[3];  /* a point of the surface, relative to the mesh's origin */
    double below;  /* mm2: area below the limit */
} cwi_wall_sum;

/* The points of a surface, and the tree of its triangles. */
typedef struct cwi_wall_field cwi_wall_field;

/* Prepares the measurement. Free the field, also after a failure; it borrows mesh and limits.
 * mesh     welded
 * limits   with their defaults
 * Returns  CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_wall_field_new(const cw_mesh *mesh, const cw_print_desc *limits,
                                          cwi_wall_field **field, cw_error *err);
void cwi_wall_field_free(cwi_wall_field *field);

/* Measures at points spread over the surface, once for each field.
 * wall     triangle_count: the thinnest wall of each, or INFINITY; NULL: not requested, which is faster
 * gap      the same of gaps
 * walls, gaps  set
 * Returns  CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_measure_walls(cwi_wall_field *field, float *wall, float *gap,
                                         cwi_wall_sum *walls, cwi_wall_sum *gaps,
                                         cw_error *err);

#endif
