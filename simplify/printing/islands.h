/* Finds the places where a part of a print begins in the air. */
#ifndef SIMPLIFY_PRINTING_ISLANDS_H
#define SIMPLIFY_PRINTING_ISLANDS_H

#include <cubewright/mesh.h>

typedef struct cwi_islands {
    size_t count;
    uint32_t vertex; /* where the one begins that stands alone over the greatest height */
    double height;   /* of that; INFINITY: it meets nothing */
} cwi_islands;

/* Finds minima of the height, with the solid above, that stay alone for a layer or more.
 * mesh      welded; z is up
 * bottom    height of the plate; what begins within a layer of it stands on it
 * layer_mm  height of a layer
 * Returns   CW_ERR_NO_MEMORY
 * Source    [Edelsbrunner2002] */
CW_NODISCARD cw_status cwi_find_islands(const cw_mesh *mesh, double bottom, double layer_mm,
                                        cwi_islands *islands, cw_error *err);

#endif
