/* Voxelization: closed meshes to label maps and to partial volumes, on the grid of a scan or on a new
 * one. */
#ifndef CUBEWRIGHT_VOXELIZE_H
#define CUBEWRIGHT_VOXELIZE_H

#include <cubewright/mesh.h>
#include <cubewright/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Facts on one of the meshes that were voxelized. Of partial volumes the counts of voxels are 0. */
typedef struct cw_voxelize_part {
    double volume_mm3;   /* that the whole mesh encloses, by its triangles */
    double filled_mm3;   /* of its voxels in the grid, or of what partial volumes cover */
    size_t voxels;       /* with its label, before later meshes replace some */
    size_t overlapped;   /* of them, those that lose the label of an earlier mesh */
    size_t repeated;     /* around which the mesh winds more than once: it overlaps itself */
    size_t negative;     /* around which it winds a negative number of times: outside */
    size_t solids, lost; /* sets of triangles joined by vertices; those that no voxel shows */
    size_t thin_places;  /* connected sets of triangles that are farther than a voxel from the
                            border of the voxels: at thin walls and narrow gaps */
    double thin_mm2;     /* their area, by samples */
    double area_mm2;     /* of the whole mesh */
    double outside_mm2;  /* area of the surface outside of the grid, by samples */
    bool turned;         /* it faced inward as a whole: it enclosed a negative volume */
    bool open;           /* the call failed because it is open */
} cw_voxelize_part;

/* Options of a voxelization. Zero fields mean the default named beside them; either `like` or a
 * spacing is required. */
typedef struct cw_voxelize_desc {
    uint32_t version;        /* 0: the first version of this struct */
    const cw_volume *like;   /* whose grid is used; borrowed, its voxels are not read */
    double spacing_mm[3];    /* of a grid along the world's axes; y and z: 0 means as x */
    double low[3];           /* corner of the world box that this grid's voxels cover */
    double high[3];          /* its other corner; default, both 0: the box of the meshes and a
                                voxel more on all sides */
    const uint32_t *labels;  /* of each mesh, not 0; default: 1, 2, 3 ... */
    bool partial;            /* fractions of voxels that meshes cover; default: labels */
    size_t max_bytes;        /* of the voxels; default: no limit */
    cw_voxelize_part *parts; /* of each mesh: its facts are stored; default: none are */
    int threads;             /* default: all */
    cw_progress progress;    /* default: none */
} cw_voxelize_desc;

/* Makes voxels of closed meshes.
 *
 * A label map (CW_U8, CW_U16 or CW_U32, the smallest that holds the labels) has the label of a mesh at
 * voxels whose centre is inside of it, else 0. A point is inside if the mesh winds around it: a positive
 * number of times. So a mesh may cross itself and have cavities. Where several meshes contain a
 * centre, the last one wins. Centres are tested exactly, on vertices that are rounded to 1/65536 voxel
 * (more coarsely where something is beyond 8192 voxels). A centre on the surface belongs to the side at
 * higher indices, so that meshes which touch share no voxel and leave none out.
 *
 * Partial volumes (CW_F32) are the fraction of each voxel's cell that is inside of the meshes, all
 * together: exact but for rounding, to 2^-20. Where meshes overlap, or one overlaps itself, the fractions
 * add up, to 1 at most.
 *
 * A surface at 0.5 of a label map is within half of the diagonal of a voxel from the mesh; one of
 * partial volumes within half a voxel where the mesh is smooth. What is thinner than a voxel may have no voxel: the facts count it.
 *
 * meshes   count pointers, borrowed; each closed: at each edge as many triangles run one way as the other.
 *          Vertices at equal positions count as one
 * count    1 or more
 * desc     borrowed
 * volume   filled on success with the frame of `like`, or LPS millimetres; zeroed on failure; free it
 *          with cw_volume_free()
 * err      may be NULL
 *
 * Returns  CW_ERR_ARGUMENT     neither like nor a spacing, or both; a box of no size; a label is 0; as
 *                              cw_mesh_check() and cw_volume_resolve()
 *          CW_ERR_CHECK        a mesh is open, or triangles beside each other face opposite ways; the
 *                              message tells its number and counts: see cw_mesh_repair()
 *          CW_ERR_EMPTY        a mesh without triangles; or all meshes are outside of the grid
 *          CW_ERR_UNSUPPORTED  `like` is no evenly spaced grid
 *          CW_ERR_LIMIT        max_bytes; more than 2^24 voxels along an axis, or 2^32 / 3 triangles
 *          CW_ERR_NO_MEMORY; CW_ERR_CANCELLED
 * Cost     time in proportion to the triangles, to the rows of voxels that they cross, and to the voxels;
 *          about 40 bytes for each triangle
 * Threads  reentrant; the same to the bit for any number of threads
 * Source   rows and ties after [Edelsbrunner1990]; coverage by the divergence theorem, as [Catmull1978]
 *          does for polygons */
CW_NODISCARD CW_API cw_status cw_voxelize(const cw_mesh *const *meshes, size_t count,
                                          const cw_voxelize_desc *desc, cw_volume *volume,
                                          cw_error *err);

/* Values of a volume inside of a mesh. */
typedef struct cw_within {
    cw_voxelize_part mesh; /* facts on the mesh in the grid, as of partial volumes */
    double volume_mm3; /* inside of the mesh, in the grid and with values; 0: nothing is, and
                              the next four are 0 */
    double mean;       /* of the values, weighted by the fraction of each voxel inside */
    double sd;         /* standard deviation, weighted as well */
    double min;        /* of voxels at least half inside; if none is, of all partly inside */
    double max;        /* of the same voxels */
    size_t voxels;     /* partly inside, with a value */
    size_t halves;     /* of them, at least half inside */
} cw_within;

/* Measures the values of the first component and step of a volume inside of a closed mesh. Voxels count by the
 * fraction of their cell that is inside. Values between voxels are not interpolated.
 *
 * volume   borrowed; an evenly spaced grid
 * mesh     borrowed; as of cw_voxelize()
 * threads  0 means all
 * out      filled on success
 * Returns  as cw_voxelize(); CW_ERR_EMPTY: the mesh is outside of the volume
 * Cost     as cw_voxelize() for the voxels in the box of the mesh
 * Threads  reentrant; the same to the bit for any number of threads */
CW_NODISCARD CW_API cw_status cw_volume_within(const cw_volume *volume, const cw_mesh *mesh,
                                               int threads, cw_within *out, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
