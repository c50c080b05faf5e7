/* The components of a mesh: sets of vertices that triangles join, with their boxes and volumes. */
#ifndef CORE_MESH_COMPONENTS_H
#define CORE_MESH_COMPONENTS_H

#include "core/mesh/enclosed_volume.h"

#include <cubewright/mesh.h>

/* Sets of vertices that triangles join, each with its box and, if that is the measure, its
 * volume. A vertex without triangles is a set, too. */
typedef struct cwi_components {
    uint32_t *set; /* number of a vertex' set; sets have the order of their first vertices */
    size_t count;
    float (*boxes)[6];    /* low, high */
    cwi_volume_sum *sums; /* twelve times the volume; NULL: diagonals are the measure */
    cwi_volume_unit unit; /* of the sums */
    bool *cavity;         /* a closed set that faces inward; NULL like sums */
    bool *dropped, *met;
} cwi_components;

/* Finds the sets and their boxes.
 * same  of each vertex the first one at its place, as from cwi_weld(): they are in one set; NULL: only
 *       triangles join vertices
 * c     zeroed before; free it, also after failure, with cwi_components_free()
 * Returns CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_components_find(const cw_mesh *mesh, const uint32_t *same,
                                           cwi_components *c, cw_error *err);

/* Finds sums, unit and cavity of the sets. Returns CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_components_measure(const cw_mesh *mesh, cwi_components *c,
                                              cw_error *err);

void cwi_components_free(cwi_components *c);

#endif
