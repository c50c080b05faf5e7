/* A signed distance from a mesh, sampled more finely where that is needed [Frisken2000].
 *
 * The samples form an even grid. Its cells, and then their parts, are divided into eight where
 * more detail is needed. Neighbours are divided too, so that no two cells that touch are more
 * than one division apart. Where a cell meets smaller ones it becomes pyramids and tetrahedra
 * around its middle; so faces of cells coincide, and the surface comes from the extraction of
 * irregular grids with all that it promises.
 *
 * The smallest cells are divided once more, into tetrahedra around points on their edges, in
 * their faces and in themselves, which stand where the mesh is: so no wall, gap or speck is too
 * thin for them. */
#ifndef EXTRACT_LEVEL_SET_ADAPTIVE_FIELD_H
#define EXTRACT_LEVEL_SET_ADAPTIVE_FIELD_H

#include "core/geometry/bvh.h"
#include "core/geometry/lattice_map.h"
#include "core/geometry/point_in_mesh.h"
#include "core/geometry/vec3.h"

#include <cubewright/level_set.h>

/* The smallest cells have 1 / 8 of a voxel's side. Points between their corners are at odd
 * multiples of 1 / CWI_PARTS of a voxel, unless they are moved. */
enum { CWI_DIVISIONS = 3, CWI_PARTS = 2 << CWI_DIVISIONS };

/* Minimum distance of points from the surface, in voxels: thinner parts are thickened so that
 * their triangles are not flat. */
#define CWI_THIN 0.01

typedef struct cwi_adaptive {
    const cw_mesh *mesh;
    const cw_volume *volume;
    const cw_offset_desc *desc;
    double corner[3], voxel; /* where sample 0 stands, from the mesh's origin; mm */
    cwi_boxes tree;          /* of the mesh */
    double (*normals)[3];    /* of its triangles, of any length */
    cwi_lattice_map leaves;  /* of the volume */
    cwi_lattice_map
        divided[CWI_DIVISIONS + 1]; /* cells, by their place among those of that size */
    cwi_lattice_map points;         /* in CWI_PARTS of a voxel */
    double (*positions)[3];         /* where they stand, in voxels */
    float *values;                  /* there, in mm; of the first `measured` points */
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
    bool any;       /* some point of one is too far from the other */
    size_t divided; /* cells there, except those that cannot be divided further */
} cwi_beyond;

/* Divides the cells where the surface is farther than limit_mm from the mesh and, if both_ways,
 * those where the mesh is that far from the surface.
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_adaptive_divide(cwi_adaptive *a, const cw_mesh *surface,
                                           double limit_mm, bool both_ways, cwi_beyond *beyond,
                                           cw_error *err);

/* Makes an irregular grid of the cells at the surface, whose values are borrowed from here;
 * free it with cw_volume_free(). The same for any number of threads.
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED; CW_ERR_LIMIT for desc->max_bytes */
CW_NODISCARD cw_status cwi_adaptive_grid(cwi_adaptive *a, cw_volume *grid, cw_error *err);

/* Returns the side of the smallest cells, in mm. */
double cwi_adaptive_min(const cwi_adaptive *a);

/* ---- between adaptive*.c ----------------------------------------------------------------- */

/* Places and measures the points that are not measured yet. */
CW_NODISCARD cw_status cwi_adaptive_measure(cwi_adaptive *a, cw_error *err);

/* Finds where a point of the lattice stands, in voxels. Returns true if it was moved to be on a
 * side of the surface, and then reports that side. */
bool cwi_adaptive_position(const cwi_adaptive *a, const uint32_t at[3], double position[3],
                           bool *inside);

/* Converts a mesh's vertex to voxels, and a place in voxels to a position from the mesh's
 * origin. */
static inline void cwi_adaptive_from_mesh(const cwi_adaptive *a, const cw_mesh *m,
                                          uint32_t vertex, double position[3])
{
    const float *p = m->positions + 3 * (size_t)vertex;
    for (int k = 0; k < 3; k++)
        position[k] =
            (m->origin[k] - a->mesh->origin[k] + (double)p[k] - a->corner[k]) / a->voxel;
}

static inline void cwi_adaptive_to_mesh(const cwi_adaptive *a, const double position[3],
                                        double p[3])
{
    cwi_add_scaled(a->corner, a->voxel, position, p);
}

static inline bool cwi_adaptive_is_inside(const cwi_adaptive *a, const double position[3])
{
    double p[3];
    cwi_adaptive_to_mesh(a, position, p);
    return cwi_is_inside(a->mesh, &a->tree, (const double(*)[3])a->normals, p);
}

/* Divides a cell of a size: 0 is a voxel's. Returns false without memory. */
bool cwi_adaptive_put(cwi_adaptive *a, int size, const uint32_t at[3]);

static inline bool cwi_adaptive_is_divided(const cwi_adaptive *a, int size,
                                           const uint32_t at[3])
{
    return cwi_lattice_find(&a->divided[size], cwi_lattice_key(at)) != CWI_NO_LATTICE_POINT;
}

#endif
