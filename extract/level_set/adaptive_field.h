/* A signed distance from a mesh, sampled more finely where that is needed [Frisken2000].
 *
 * Samples are an even grid's. Cells of that, and those in turn, are divided into eight where
 * something asks for it, and their neighbours so that no two that touch are more than one
 * division apart. Where a cell meets smaller ones it becomes pyramids and tetrahedra around its
 * middle; so faces of cells coincide, and the surface comes from the extraction of irregular
 * grids with all that it promises.
 *
 * The smallest cells are divided once more, into tetrahedra around points on their edges, in
 * their faces and in themselves, which stand where the mesh is: so no wall, gap or speck is too
 * thin for them. */
#ifndef EXTRACT_LEVEL_SET_ADAPTIVE_FIELD_H
#define EXTRACT_LEVEL_SET_ADAPTIVE_FIELD_H

#include "core/geometry/bvh.h"
#include "core/geometry/lattice_map.h"

#include <cubewright/level_set.h>

/* The smallest cells have 1 / 8 of a voxel's side; points between their corners are odd parts
 * of a voxel, but for where they stand. */
enum { CWI_DIVISIONS = 3, CWI_PARTS = 2 << CWI_DIVISIONS };

/* Voxels that points are from the surface, at least: what is thinner becomes so thick that its
 * triangles are not flat. */
#define CWI_THIN 0.01

typedef struct cwi_adaptive {
    const cw_mesh *mesh;
    const cw_volume *volume;
    const cw_offset_desc *desc;
    double corner[3], voxel; /* where sample 0 stands, from the mesh's origin; mm */
    cwi_boxes tree;          /* of the mesh */
    double (*normals)[3];    /* of its triangles, of any length */
    cwi_places leaves;       /* of the volume */
    cwi_places divided[CWI_DIVISIONS + 1]; /* cells, by their place among those of that size */
    cwi_places points;                     /* in CWI_PARTS of a voxel */
    double (*places)[3];                   /* where they stand, in voxels */
    float *values;                         /* there, in mm; of the first `measured` points */
    size_t measured;
} cwi_adaptive;

/* Free with cwi_adaptive_free(), also after an error.
 * mesh, volume, desc  borrowed; the volume is of cwi_level_set_make() with level 0
 * Returns             CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_adaptive_init(cwi_adaptive *a, const cw_mesh *mesh,
                                         const cw_volume *volume, const cw_offset_desc *desc,
                                         cw_error *err);
void cwi_adaptive_free(cwi_adaptive *a);

/* The parts of a surface that are not near the mesh. */
typedef struct cwi_beyond {
    bool any;       /* point of the one is too far from the other */
    size_t divided; /* cells there, but those that cannot be divided any more */
} cwi_beyond;

/* Divides the cells where the surface is farther than limit_mm from the mesh and, if both_ways,
 * those where the mesh is that far from the surface.
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_adaptive_divide(cwi_adaptive *a, const cw_mesh *surface,
                                           double limit_mm, bool both_ways, cwi_beyond *beyond,
                                           cw_error *err);

/* The cells at the surface as an irregular grid, whose values are borrowed from here; free it
 * with cw_volume_free(). The same for any number of threads.
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED; CW_ERR_LIMIT for desc->max_bytes */
CW_NODISCARD cw_status cwi_adaptive_grid(cwi_adaptive *a, cw_volume *grid, cw_error *err);

/* The side of the smallest cells, in mm. */
double cwi_adaptive_least(const cwi_adaptive *a);

/* ---- between adaptive*.c ----------------------------------------------------------------- */

/* Places and measures the points that are not measured yet. */
CW_NODISCARD cw_status cwi_adaptive_measure(cwi_adaptive *a, cw_error *err);

/* Where a point of the lattice stands, in voxels, and whether it was put there for a side of
 * the surface, which is then the one that it counts as being on. */
bool cwi_adaptive_place(const cwi_adaptive *a, const uint32_t at[3], double place[3],
                        bool *inside);

/* A mesh's vertex in voxels; and a place in voxels from the mesh's origin. */
void cwi_adaptive_from_mesh(const cwi_adaptive *a, const cw_mesh *m, uint32_t vertex,
                            double place[3]);
void cwi_adaptive_to_mesh(const cwi_adaptive *a, const double place[3], double p[3]);

bool cwi_adaptive_is_inside(const cwi_adaptive *a, const double place[3]);

/* Divides a cell of a size: 0 is a voxel's. False: no memory. */
bool cwi_adaptive_put(cwi_adaptive *a, int size, const uint32_t at[3]);

static inline bool cwi_adaptive_is_divided(const cwi_adaptive *a, int size,
                                           const uint32_t at[3])
{
    return cwi_places_find(&a->divided[size], cwi_place_key(at)) != CWI_NO_PLACE;
}

#endif
