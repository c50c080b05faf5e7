/* Facts of an OpenVDB file, which the module "openvdb" (in a sandboxed process) puts into the
 * shared memory. Nothing in here has been checked. */
#ifndef FORMATS_VDB_VDB_H
#define FORMATS_VDB_VDB_H

#include "formats/volume/sandboxed_planes.h"

/* The planes of grid n that can be read, row by row: the leaves' places (three uint32_t), the
 * leaves' voxels (512, x fastest), and tiles (cw_tile). */
enum { CWI_VDB_LEAVES, CWI_VDB_VOXELS, CWI_VDB_TILES, CWI_VDB_PLANES };

enum { CWI_VDB_MAX_GRIDS = 1024 };

typedef struct cwi_vdb_grid {
    char name[64], kind[32]; /* "level set"; may be empty */
    char refusal[128];       /* reason why it cannot be read; empty: it can */
    cw_type type;
    uint32_t level_set, half;
    uint64_t leaf_count, tile_count, active; /* active: voxels */
    int64_t low[3], high[3]; /* first and last leaf that is not background, in leaves */
    double background;
    double affine[3][4]; /* index to world, as in the file */
} cwi_vdb_grid;

typedef struct cwi_vdb_facts {
    uint32_t grid_count; /* in the file */
    cwi_vdb_grid grid[CWI_VDB_MAX_GRIDS];
} cwi_vdb_facts;

extern CW_API const cwi_plane_functions cwi_module_openvdb;

#endif
