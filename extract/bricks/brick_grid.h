/* The part of a surface in one brick: extracted on a small grid over the brick's samples and those
 * around it, so that every vertex comes out as in the whole surface. */
#ifndef EXTRACT_BRICKS_BRICK_GRID_H
#define EXTRACT_BRICKS_BRICK_GRID_H

#include "extract/common/field_normals.h"
#include "extract/dense/dense_plan.h"

/* Data that all bricks of an extraction have in common. */
typedef struct cwi_brick_job {
    const cwi_plan *whole; /* level, live cells and octree of the whole volume */
    const cw_extract_desc *desc;
    cw_volume volume; /* the whole one */
    cwi_emission emission;
    cwi_vertex_sink sink; /* of the whole volume, without arrays */
    cwi_shading shading;  /* the field of a rectilinear grid */
    double origin[3];     /* of all meshes */
} cwi_brick_job;

/* The cells of a brick's grid that count: its own, or also those of a ring around them, which have
 * all triangles at its vertices. */
enum { CWI_OWN_CELLS, CWI_CELLS_AROUND, CWI_WINDOWS };

/* A box of cells in a small grid. Grids of the same shape share planes and windows. */
typedef struct cwi_brick_shape {
    size_t dim[3];   /* voxels of the grid */
    size_t first[3]; /* the brick's first cell, of padded ones */
    size_t cells[3]; /* of the brick */
} cwi_brick_shape;

/* One thread's grid. A zeroed one is valid; free it with cwi_brick_grid_free(). */
typedef struct cwi_brick_grid {
    cwi_plan plan;
    cwi_brick_shape shape;
    size_t first_voxel[3]; /* of the grid, in the volume */
    uint64_t *live[CWI_WINDOWS], *window[CWI_WINDOWS];
    cwi_row *own_rows; /* numbers of the brick's vertices while those of the ring are counted */
    cw_mesh around;    /* the surface in the brick and the ring */
    cw_status status;  /* of the first brick that failed */
    cw_error error;
} cwi_brick_grid;

/* Sets up what bricks have in common: for the level and the live cells of a plan. */
void cwi_brick_job_init(cwi_brick_job *job, const cwi_plan *whole, const cw_extract_desc *desc);

/* Classifies the samples of the brick at[]. sides: where they are, CWI_OUTSIDE and CWI_INSIDE; also
 * those of some samples around it */
CW_NODISCARD cw_status cwi_brick_classify(cwi_brick_grid *brick, const cwi_brick_job *job,
                                          const size_t at[3], unsigned *sides, cw_error *err);

/* Extracts the surface in a classified brick. *found: there is any; else the mesh is left as it is,
 * to be written to later. */
CW_NODISCARD cw_status cwi_brick_extract(cwi_brick_grid *brick, const cwi_brick_job *job,
                                         cw_mesh *mesh, bool *found, cw_error *err);
void cwi_brick_grid_free(cwi_brick_grid *brick);

/* Makes some cells of the grid those that count, and numbers their vertices. */
CW_NODISCARD cw_status cwi_brick_count(cwi_brick_grid *brick, int window, cw_error *err);

/* Writes the vertices and triangles that were counted. normals: those of vertices, too. Returns
 * true if some gradient vanished. */
bool cwi_brick_write(const cwi_brick_grid *brick, const cwi_brick_job *job, bool normals,
                     cw_mesh *mesh);

/* Replaces normals that are zero by those of the triangles around their vertex, in the brick and
 * beyond it, to the bit as cwi_repair_normals() does for the whole surface. */
CW_NODISCARD cw_status cwi_brick_repair_normals(cwi_brick_grid *brick, const cwi_brick_job *job,
                                                cw_mesh *mesh, cw_error *err);

#endif
