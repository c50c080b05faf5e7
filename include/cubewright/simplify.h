/* Mesh to smaller mesh, under a promise. */
#ifndef CUBEWRIGHT_SIMPLIFY_H
#define CUBEWRIGHT_SIMPLIFY_H

#include <cubewright/camera.h>
#include <cubewright/distance.h>
#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A picture that is to be taken of a surface. */
typedef struct cw_simplify_view {
    cw_camera camera;
    size_t width, height; /* pixels; default: 1280 x 720 */
    float *depth;         /* width x height, top row first: how far before the eye, in mm along
                             the line of sight, what is seen in the middles of pixels is;
                             INFINITY: nothing. Default: nothing is hidden */
} cw_simplify_view;

/* Draws the depths of one more mesh, or slab, of what a view shows. Free them with
 * cw_simplify_view_free(), which is harmless where there are none.
 * Returns  CW_ERR_ARGUMENT for a camera that is none; CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_simplify_view_draw(cw_simplify_view *view, const cw_mesh *mesh,
                                                    cw_error *err);
CW_API void cw_simplify_view_free(cw_simplify_view *view);

/* How far to simplify, and what to spare. Zero-initialise it and set what you need; a zero
 * field means the default named beside it. At least one of error_mm, triangles and ratio is
 * needed; what is met first ends it. */
typedef struct cw_simplify_desc {
    double error_mm; /* no point of the input or of the result is farther than this from
                        the other one; default: no such promise */
    /* Less than error_mm where a view sees the surface: what is within such a distance is in no
       picture farther apart than so many pixels, up to so many beside it. It grows with the
       depth. Of several views the least counts; where none sees the surface, error_mm does: so
       where it lies more than twice that behind what a view has depths of. Nearer to an eye
       than a thousandth of the way to its target is as there. */
    const cw_simplify_view *views; /* view_count of them, borrowed until the call returns */
    size_t view_count;
    double pixel_error; /* above 0 when there are views */
    double normal_deg;  /* vertices that a view sees are joined only while the surface's normals
                           around them are no farther than this from their mean, which shading
                           follows; default: 180, any */
    size_t triangles;   /* stop when there are so many; default: no limit */
    double ratio; /* the same as a share of the input's, above 0, below 1; default: none */
    bool allow_crossings; /* default: no triangles meet that did not meet before */
    bool keep_border;     /* borders of open surfaces stay to the bit, so that what was cut from
                             one whole still fits together; default: they are simplified, too */
    /* Attributes whose loss counts, too: what as large a difference as there can be (of a
       colour from none to full, of scalars from the lowest to the highest, of normals by a
       length of 1) counts as a distance, in percent of the diagonal of the mesh's box. Default:
       0. */
    float normal_weight, color_weight, scalar_weight;
    int threads;          /* default: all that OpenMP offers */
    cw_progress progress; /* default: none */
} cw_simplify_desc;

/* How far a view lets a point in the world go: no place so near to it is seen more than so many
 * pixels away. Infinite where it does not see the point.
 * Returns  CW_ERR_ARGUMENT for a camera that is none, and pixels that are not above 0 */
CW_NODISCARD CW_API cw_status cw_simplify_view_error(const cw_simplify_view *view,
                                                     double pixels, const double point[3],
                                                     double *error_mm, cw_error *err);

/* Whether a view may see something of the convex hull of some points, with so many pixels
 * around its picture: false is certain, true is not.
 *
 * points   count x 3, in the world; count is 1 to 8
 * Returns  CW_ERR_ARGUMENT  a camera that is none, pixels that are not above 0, no points or
 *                           more than 8 */
CW_NODISCARD CW_API cw_status cw_simplify_view_sees(const cw_simplify_view *view, double pixels,
                                                    const double *points, size_t count,
                                                    bool *seen, cw_error *err);

/* The largest distance that some views allow at the depths of some points, wherever the points
 * are beside the axes: an error bound for what is out of sight.
 *
 * points    count x 3, in the world, such as cw_volume_corners()
 * error_mm  0 where no depth allows a finite distance
 * Returns   as cw_simplify_view_error() */
CW_NODISCARD CW_API cw_status cw_simplify_views_error(const cw_simplify_view *views,
                                                      size_t view_count, double pixels,
                                                      const double *points, size_t count,
                                                      double *error_mm, cw_error *err);

/* The box of voxels that some views may see: whole bricks of 8 cells whose hull is in one of the
 * pictures, and two voxels around them. Nothing is taken to hide anything.
 *
 * volume   borrowed; an evenly spaced or a rectilinear grid
 * box      for cw_volume_crop()
 * Returns  CW_ERR_EMPTY        no view sees any voxel
 *          CW_ERR_UNSUPPORTED  an irregular or a sparse grid
 *          CW_ERR_ARGUMENT     a camera that is none */
CW_NODISCARD CW_API cw_status cw_simplify_views_box(const cw_volume *volume,
                                                    const cw_simplify_view *views,
                                                    size_t view_count, cw_box *box,
                                                    cw_error *err);

/* The largest of some distances around the vertices of a mesh, in pixels of a view; vertices
 * that it does not see count as 0.
 *
 * distance_mm  vertex_count, such as cw_mesh_distance_desc.worst
 * Returns      CW_ERR_ARGUMENT for a camera that is none */
CW_NODISCARD CW_API cw_status cw_simplify_view_distance(const cw_simplify_view *view,
                                                        const cw_mesh *mesh,
                                                        const float *distance_mm,
                                                        double *pixels, cw_error *err);

/* Leaves out the triangles that certainly none of some views sees, with so many pixels around
 * their pictures: what is beside them, and what is farther than twice margin_mm behind what
 * they have depths of, all around it. Then vertices that no triangle names. What is left is
 * open.
 *
 * mesh       in place: its arrays stay where they are, and only get shorter; on failure as it
 *            was
 * margin_mm  how far the mesh may be from the one whose depths were drawn
 * dropped    triangles; may be NULL
 * Returns    CW_ERR_ARGUMENT as cw_simplify_view_sees(), cw_mesh_check(); CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_simplify_cull(cw_mesh *mesh, const cw_simplify_view *views,
                                               size_t count, double pixels, double margin_mm,
                                               size_t *dropped, cw_error *err);

/* What a simplification made. */
typedef struct cw_simplify_facts {
    size_t vertices, triangles;
    size_t cut;    /* vertices of the input whose triangles are no single fan: they stay where
                      they are, and all that is around them */
    size_t passes; /* 1, and 1 more for each time that error_mm took more care to keep */
} cw_simplify_facts;

/* Simplifies a mesh by collapsing edges, those first that move the surface least.
 *
 * The result has as many components, handles and border loops as the input, and no edge of
 * three triangles that had none before; none of its triangles is without area, and none meets
 * another that is not its neighbour, unless triangles of the input did. Scalars, colours and
 * labels, and normals, are those of the closest point of the input.
 *
 * With triangles or ratio alone the result may have more triangles than asked for: where every
 * edge that is left would break one of these rules.
 *
 * mesh     borrowed; vertices at equal positions count as different ones: weld them first
 * desc     borrowed
 * out      filled on success, emptied on failure; free it with cw_mesh_free()
 * facts    may be NULL
 *
 * Returns  CW_ERR_ARGUMENT     no target, one that is negative or not finite; so a weight, or
 *                              one of what the mesh has not; views without error_mm, a camera
 *                              that is none; or as cw_mesh_check()
 *          CW_ERR_UNSUPPORTED  this build has no OpenMesh
 *          CW_ERR_LIMIT        more than 2^30 vertices or triangles
 *          CW_ERR_NO_MEMORY; CW_ERR_CANCELLED
 * Cost     about two microseconds of one processor for a triangle that goes
 * Threads  reentrant; the same to the bit for any number of threads
 * Source   quadrics [Garland1997], of attributes [Hoppe1999] */
CW_NODISCARD CW_API cw_status cw_simplify(const cw_mesh *mesh, const cw_simplify_desc *desc,
                                          cw_mesh *out, cw_simplify_facts *facts,
                                          cw_error *err);

/* The same with several numbers of triangles: each level is made from the one before, so that
 * all take hardly longer than the last.
 *
 * triangles  levels, each fewer than the one before; desc has neither these, nor ratio or error
 * out        levels; filled on success, emptied on failure
 * facts      levels, or NULL
 *
 * Returns    CW_ERR_ARGUMENT when the numbers are not so; else as cw_simplify() */
CW_NODISCARD CW_API cw_status cw_simplify_levels(const cw_mesh *mesh,
                                                 const cw_simplify_desc *desc,
                                                 const size_t *triangles, size_t levels,
                                                 cw_mesh *out, cw_simplify_facts *facts,
                                                 cw_error *err);

/* Simplifies a surface that comes a slab at a time, such as from cw_extract_slabs(), in tandem
 * with what makes it, so that all of it never is in memory:
 *
 *     cw_simplifier_new(&(cw_simplify_desc){.error_mm = 0.1}, &simplifier, &err);
 *     cw_extract_slabs(&volume, &extract_desc, CW_SIMPLIFIER_SLAB,
 *                      (cw_slab_sink){cw_simplifier_take, simplifier}, NULL, &err);
 *     cw_simplifier_finish(simplifier, &mesh, NULL, &err);
 *     cw_simplifier_free(simplifier);
 *
 * What cw_simplify() promises holds across seams, too. With an error to keep a slab and the
 * half of the one before are simplified as one, against the surface that came: the result is as
 * good as from the whole. With a number of triangles to meet slabs go to three times their
 * share, each by itself, and then all together on.
 *
 * Source  [Attali2005] */
typedef struct cw_simplifier cw_simplifier;

/* Triangles of a slab: so many that seams are few among them. */
#define CW_SIMPLIFIER_SLAB ((size_t)1 << 19)

/* desc      copied; an error, or else triangles or a ratio. Free with cw_simplifier_free().
 * Returns   CW_ERR_ARGUMENT for both or none, and as cw_simplify() */
CW_NODISCARD CW_API cw_status cw_simplifier_new(const cw_simplify_desc *desc,
                                                cw_simplifier **out, cw_error *err);
CW_API void cw_simplifier_free(cw_simplifier *simplifier); /* harmless on NULL */

/* Takes the next slab; for cw_slab_sink. After an error only freeing is of use. */
CW_NODISCARD CW_API cw_status cw_simplifier_take(void *simplifier, const cw_slab *slab,
                                                 cw_error *err);

/* The result, without normals: cw_extract_normals() has them. Empty when no slab came.
 *
 * out       filled on success, emptied on failure; free it with cw_mesh_free()
 * facts     may be NULL
 * Returns   CW_ERR_ARGUMENT when the last slab is missing; else as cw_simplify() */
CW_NODISCARD CW_API cw_status cw_simplifier_finish(cw_simplifier *simplifier, cw_mesh *out,
                                                   cw_simplify_facts *facts, cw_error *err);

/* Whether this build can: whether it has OpenMesh. */
CW_API bool cw_simplify_available(void);

#ifdef __cplusplus
}
#endif

#endif
