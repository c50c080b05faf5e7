/* Volumes of the components of a mesh, and how to get them back after vertices moved. */
#ifndef SIMPLIFY_SMOOTHING_KEPT_VOLUMES_H
#define SIMPLIFY_SMOOTHING_KEPT_VOLUMES_H

#include "simplify/smoothing/vertex_rings.h"

/* A component: triangles joined by vertices. */
typedef struct cwi_kept_volume {
    uint32_t reference; /* its first vertex; volumes are measured from there */
    bool is_open;       /* it has a border */
    bool is_branched;   /* it has junctions: no sides, and no volume */
    double before, now; /* mm3, signed */
    double area;        /* gained volume for each mm that its inner vertices move outward */
} cwi_kept_volume;

typedef struct cwi_kept_volumes {
    const cw_mesh *mesh;    /* as it was before */
    uint32_t *component;    /* of each vertex */
    cwi_kept_volume *items; /* count */
    size_t count;
} cwi_kept_volumes;

/* Finds the components and their volumes before anything moved.
 * borders    of each vertex, a cwi_vertex_border
 * positions  vertices x 3: the positions of the mesh, in double precision
 * volumes    filled; free it with cwi_volumes_free(), also after failure. It borrows the mesh
 * Returns    CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_volumes_find(const cw_mesh *mesh, const uint8_t *borders,
                                        const double *positions, cwi_kept_volumes *volumes,
                                        cw_error *err);
void cwi_volumes_free(cwi_kept_volumes *volumes);

/* Measures the volume now of all components.
 * positions  vertices x 3 */
void cwi_volumes_measure(cwi_kept_volumes *volumes, const double *positions);

/* Measures the volumes, too, and finds their gradient at each vertex and the area of each component.
 * borders    of each vertex: those at a rim add to no area
 * gradients  vertices x 3: a normal that is as long as a third of the area around the vertex */
void cwi_volumes_gradients(cwi_kept_volumes *volumes, const double *positions,
                           const uint8_t *borders, double *gradients);

/* Adds up the volumes of components that have one, those before or those now. */
double cwi_volumes_sum(const cwi_kept_volumes *volumes, bool before);

#endif
