/* Lattices inside of hollow solids: walls along triply periodic surfaces, added to a level set. */
#ifndef EXTRACT_LEVEL_SET_INFILL_H
#define EXTRACT_LEVEL_SET_INFILL_H

#include <cubewright/level_set.h>
#include <cubewright/quality.h>

/* Voxels across a wall of a lattice, at least. */
enum { CWI_INFILL_VOXELS = 4 };

/* A lattice in the world. */
typedef struct cwi_infill {
    const cw_infill_desc *desc;
    double center[3];          /* the cells are counted from here */
    double per_mm;             /* radians: a cell is 2 pi */
    double thinnest, thickest; /* of the walls, mm */
    double low, high;          /* range of desc->by */
    cw_volume by;              /* desc->by resolved, borrowed */
} cwi_infill;

/* Checks options of a lattice, and the voxels for it; 0: they are chosen later.
 * Returns CW_ERR_ARGUMENT */
CW_NODISCARD cw_status cwi_infill_check(const cw_infill_desc *desc, double voxel_mm,
                                        cw_error *err);

/* Prepares a lattice for a mesh. Returns what cw_volume_statistics() does; CW_ERR_EMPTY: the
 * volume has a single value; CW_ERR_UNSUPPORTED: or is not dense */
CW_NODISCARD cw_status cwi_infill_init(cwi_infill *infill, const cw_infill_desc *desc,
                                       const cw_quality *q, int threads, cw_error *err);

/* Returns the thinner of the two walls that a lattice may have. */
double cwi_infill_thinnest(const cw_infill_desc *desc);

/* Estimates the bytes of the grid and surface of a lattice in a mesh. */
double cwi_infill_bytes(const cw_infill_desc *desc, const cw_quality *q, double voxel_mm,
                        bool drains);

/* Returns the distance from the middle of the nearest wall, mm.
 * foot    the nearest point of that surface, in the world
 * normal  of it, unit; either way */
double cwi_infill_distance(const cwi_infill *infill, const double world[3], double foot[3],
                           double normal[3]);

/* Returns the thickness that a wall must have at a place.
 * depth_mm  below the cavity's surface */
double cwi_infill_wall(const cwi_infill *infill, const double world[3], double depth_mm);

/* Turns the level set of a mesh into that of the channels: negative where the mesh is deeper than
 * its wall and where no wall of the lattice is.
 * volume   of cwi_level_set_make(), in place
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_infill_apply(const cwi_infill *infill, double wall_mm, int threads,
                                        const cw_progress *progress, cw_volume *volume,
                                        cw_error *err);

/* Measures walls by rays both ways from points of their middle, away from the outer wall.
 * outer, voids  the mesh, and the surface of the channels
 * facts         the fields of infill are set
 * Returns       as cw_distance_to_mesh() */
CW_NODISCARD cw_status cwi_infill_measure(const cwi_infill *infill, const cw_mesh *outer,
                                          const cw_mesh *voids, double wall_mm, int threads,
                                          const cw_progress *progress, cw_hollow_facts *facts,
                                          cw_error *err);

#endif
