/* Distances from a mesh to the surface of a volume, and from a mesh to another mesh. */
#ifndef CUBEWRIGHT_DISTANCE_H
#define CUBEWRIGHT_DISTANCE_H

#include <cubewright/mesh.h>
#include <cubewright/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Distances of the points of a mesh, in millimetres of the world. Mean, rms, bias and p99 are
 * weighted by the area of the mesh's surface, not by its vertices. */
typedef struct cw_distance {
    double max_mm, rms_mm, mean_mm; /* the largest; root of the mean square; mean */
    double p99_mm;                  /* 99 % of the area is nearer; known to 0.2 % */
    double bias_mm;                 /* mean with a sign, positive outside; from a mesh: 0 */
    double bound_mm;  /* from a mesh: no point is farther than this; from a field: 0 */
    double where[3];  /* the point of the mesh, in the world, with the distance max */
    size_t triangle;  /* the triangle with that point */
    size_t triangles; /* triangles measured: all of the mesh; 0: nothing to measure, all is 0 */
    size_t samples;   /* points measured */
    size_t missed;    /* samples without a surface within reach: they count as reach */
} cw_distance;

/* Options of measuring from the surface of a volume. Zero fields mean the default named beside
 * them. */
typedef struct cw_field_distance_desc {
    uint32_t version;     /* 0: the first version of this struct */
    double isovalue;      /* in the unit of the values; 0 means 0 */
    bool inside_is_low;   /* default: values at or above the isovalue are inside */
    bool leave_open;      /* default: where the data end inside, their end is surface too */
    double reach_mm;      /* how far to look for the surface; default: 4 voxels, a voxel being
                             the cube root of its volume */
    double step_voxels;   /* largest distance between points along sides; default 1 */
    float *worst;         /* vertex_count values: the largest distance met in the triangles
                             around each vertex; default: not kept */
    int threads;          /* default: one per processor */
    cw_progress progress; /* default: none */
} cw_field_distance_desc;

/* Measures how far a mesh lies from the surface { p : f(p) = isovalue } of the trilinear field
 * f of a volume. cw_extract() approximates that surface.
 *
 * Distances are Euclidean, in the world, to the closest point of the surface itself, within 0.1
 * % and 1e-5 voxels. They are taken at vertices, in the middle of sides and in the middle of
 * triangles. Triangles with sides longer than two steps are first divided evenly. Beyond 2^25
 * points the steps grow. The domain ends at the volume's border and at NaN and no-data voxels.
 * Where it ends inside, its end closes the surface. With leave_open, cells that touch missing
 * voxels have no surface instead. Points count as inside as in cw_extract().
 *
 * mesh        borrowed
 * volume      borrowed; at least 2 voxels along each axis; first component and step are used
 * desc        borrowed; NULL means all defaults
 * out         zeroed on failure
 * per_vertex  vertex_count distances in mm, negative inside; or NULL. For a mesh without
 *             triangles these are the only result
 *
 * Returns  CW_ERR_ARGUMENT  isovalue not finite, reach or step negative or not finite, volume
 *                           too thin, or as cw_mesh_check() and cw_volume_resolve()
 *          CW_ERR_UNSUPPORTED  the grid is rectilinear
 *          CW_ERR_NO_MEMORY; CW_ERR_CANCELLED
 * Cost     about half a microsecond for a point near the surface; elsewhere in proportion to
 *          the voxels within reach
 * Threads  reentrant; the same to the bit for any number of threads
 * Source   simplify/README.md */
CW_NODISCARD CW_API cw_status cw_distance_to_field(const cw_mesh *mesh, const cw_volume *volume,
                                                   const cw_field_distance_desc *desc,
                                                   cw_distance *out, float *per_vertex,
                                                   cw_error *err);

/* Options of measuring from a mesh. Zero fields mean the default named beside them. */
typedef struct cw_mesh_distance_desc {
    uint32_t version;     /* 0: the first version of this struct */
    double tolerance_mm;  /* bound_mm - max_mm is at most this; default: 5 % of max_mm, or
                             1 % of the reference's average side where that is more */
    double step_mm;       /* largest distance between the points of mean, rms and p99 along
                             sides; default: the average length of a side in the reference */
    bool vertices_only;   /* measure only at the vertices, all with equal weight; bound_mm is
                             then 0. Default: over the surface */
    float *worst;         /* as in cw_field_distance_desc */
    int threads;          /* default: one per processor */
    cw_progress progress; /* default: none */
} cw_mesh_distance_desc;

/* Measures how far a mesh lies from a reference mesh: the one-sided Hausdorff distance and
 * the mean over its surface. Exchange the meshes for the other side.
 *
 * Distances are to the closest point of the reference's triangles, exact but for rounding. The
 * largest over all points of all triangles is at least max_mm, reached at `where`, and at most
 * bound_mm. Mean, rms and p99 are over points as in cw_distance_to_field().
 *
 * mesh, reference  borrowed; each with its own origin; triangles without area count as
 *                  sides or points
 * desc             borrowed; NULL means all defaults
 * out              zeroed on failure
 * per_vertex       vertex_count distances of mesh in mm; or NULL
 *
 * Returns  CW_ERR_ARGUMENT  the reference has no triangle, tolerance or step negative or not
 *                           finite, or as cw_mesh_check()
 *          CW_ERR_LIMIT     the reference has more than 2^31 triangles
 *          CW_ERR_NO_MEMORY; CW_ERR_CANCELLED
 * Cost     a microsecond or two for a point near the reference; 70 bytes a triangle of it
 * Threads  reentrant; the same to the bit for any number of threads
 * Source   bounds after [Tang2009] */
CW_NODISCARD CW_API cw_status cw_distance_to_mesh(const cw_mesh *mesh, const cw_mesh *reference,
                                                  const cw_mesh_distance_desc *desc,
                                                  cw_distance *out, float *per_vertex,
                                                  cw_error *err);

/* Two meshes compared both ways, as one or in parts. A zeroed struct compares nothing yet. */
typedef struct cw_mesh_comparison {
    cw_distance to_reference;            /* of the points of the mesh */
    cw_distance from_reference;          /* of the points of the reference */
    double area_mm2, reference_area_mm2; /* areas that were compared */
} cw_mesh_comparison;

/* Measures a mesh and its reference both ways, and adds that to what was compared before: parts
 * of one surface, such as the parts of a file, are compared one after the other. Maxima and
 * bounds are the largest of all parts, rms and mean are by area, and p99 is the largest of the
 * parts', which bounds that of all.
 *
 * reference   borrowed
 * desc        as in cw_distance_to_mesh(); `worst` must be NULL
 * comparison  zeroed before the first part; as it was on failure
 * Returns     as cw_distance_to_mesh() */
CW_NODISCARD CW_API cw_status cw_mesh_compare(const cw_mesh *mesh, const cw_mesh *reference,
                                              const cw_mesh_distance_desc *desc,
                                              cw_mesh_comparison *comparison, cw_error *err);

/* Returns the root of the mean of both squared rms: a symmetric distance, in mm. */
CW_API double cw_mesh_comparison_rms(const cw_mesh_comparison *comparison);

/* Returns the larger of both maxima: the Hausdorff distance in mm, as far as it was sampled. */
CW_API double cw_mesh_comparison_max(const cw_mesh_comparison *comparison);

#ifdef __cplusplus
}
#endif

#endif
