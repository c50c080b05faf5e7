/* Mesh simplification by edge collapse under an error bound, of whole meshes or slab by
 * slab. */
#ifndef CUBEWRIGHT_SIMPLIFY_H
#define CUBEWRIGHT_SIMPLIFY_H

#include <cubewright/camera.h>
#include <cubewright/distance.h>
#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A view of a surface, for which the surface is simplified. */
typedef struct cw_simplify_view {
    cw_camera camera;     /* the view's camera */
    size_t width, height; /* pixels; default: 1280 x 720 */
    float *depth;         /* width x height, top row first: for the middle of each pixel, the
                             depth of the visible point before the eye, in mm along the line of
                             sight; INFINITY: nothing is visible. Default: nothing is hidden */
} cw_simplify_view;

/* Draws the depths of one more mesh, or slab, into a view. Free them with
 * cw_simplify_view_free(), which is harmless where there are none.
 * view     its depths are made, or added to
 * Returns  CW_ERR_ARGUMENT for an invalid camera; CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_simplify_view_draw(cw_simplify_view *view, const cw_mesh *mesh,
                                                    cw_error *err);

/* Frees the depths of a view; the camera and the size stay. Harmless where there are none. */
CW_API void cw_simplify_view_free(cw_simplify_view *view);

/* Targets and limits of a simplification. Zero-initialise the struct and set what you need; a
 * zero field means the default named beside it. At least one of error_mm, triangles and ratio
 * is needed. The first one reached ends the simplification. */
typedef struct cw_simplify_desc {
    uint32_t version; /* 0: the first version of this struct */
    double error_mm;  /* no point of the input or of the result is farther than this from the
                        other surface; default: no such promise */
    /* A view lowers the error below error_mm where it sees the surface. Points within the lower
       error differ in the picture by at most pixel_error pixels. The same holds up to
       pixel_error pixels beside the picture. The lower error grows with the depth. Of several
       views the smallest error counts. Where no view sees the surface, error_mm counts. That
       includes places more than twice error_mm behind the view's depths. Points nearer to an
       eye than a thousandth of the way to its target count as at that distance. */
    const cw_simplify_view *views; /* view_count of them, borrowed until the call returns */
    size_t view_count;             /* default: no views */
    double pixel_error;            /* above 0 when there are views */
    double normal_deg; /* vertices that a view sees are joined only while the normals around
                           them are within this angle of their mean, for the sake of shading;
                           default: 180, any */
    size_t triangles;  /* stop at this number of triangles; default: no limit */
    double ratio; /* the same as a fraction of the input's; above 0, below 1; default: none */
    bool allow_crossings; /* default: no triangles meet that did not meet before */
    bool keep_border;     /* borders of open surfaces stay to the bit, so that parts cut from
                             one whole still fit together; default: borders are simplified,
                             too */
    float normal_weight, color_weight, scalar_weight; /* weights of attributes whose loss counts
                               as a distance, in percent of the diagonal of the mesh's box. They
                               are for the largest possible difference: of a colour from none to
                               full, of scalars from the minimum to the maximum, of normals by a
                               length of 1. Default: 0 */
    int threads;                                      /* default: one per processor */
    cw_progress progress;                             /* default: none */
} cw_simplify_desc;

/* Computes the error that a view allows at a world point: no place within it is seen more than
 * `pixels` away from the point. Infinite where the view does not see the point.
 * error_mm  set to the error
 * Returns   CW_ERR_ARGUMENT for an invalid camera, and pixels that are not above 0 */
CW_NODISCARD CW_API cw_status cw_simplify_view_error(const cw_simplify_view *view,
                                                     double pixels, const double point[3],
                                                     double *error_mm, cw_error *err);

/* Finds if a view may see a part of the convex hull of some points. The picture is enlarged by
 * `pixels` on all sides. false is certain, true is not.
 *
 * points   count x 3, in the world; count is 1 to 8
 * seen     set to false where no part can be seen
 * Returns  CW_ERR_ARGUMENT  an invalid camera, pixels that are not above 0, no points or
 *                           more than 8 */
CW_NODISCARD CW_API cw_status cw_simplify_view_sees(const cw_simplify_view *view, double pixels,
                                                    const double *points, size_t count,
                                                    bool *seen, cw_error *err);

/* Finds the largest distance that the views allow at the depths of some points, whether or not
 * they see the points: an error bound for parts that are out of sight.
 *
 * points    count x 3, in the world, such as cw_volume_corners()
 * error_mm  0 where no depth allows a finite distance
 * Returns   as cw_simplify_view_error() */
CW_NODISCARD CW_API cw_status cw_simplify_views_error(const cw_simplify_view *views,
                                                      size_t view_count, double pixels,
                                                      const double *points, size_t count,
                                                      double *error_mm, cw_error *err);

/* Finds the box of voxels that the views may see: whole bricks of 8 cells whose hull is in one
 * of the pictures, and two voxels around them. Occlusion is not considered.
 *
 * volume   borrowed; an evenly spaced or a rectilinear grid
 * box      for cw_volume_crop()
 * Returns  CW_ERR_EMPTY        no view sees any voxel
 *          CW_ERR_UNSUPPORTED  an irregular or a sparse grid
 *          CW_ERR_ARGUMENT     an unusable camera */
CW_NODISCARD CW_API cw_status cw_simplify_views_box(const cw_volume *volume,
                                                    const cw_simplify_view *views,
                                                    size_t view_count, cw_box *box,
                                                    cw_error *err);

/* Finds the largest of the given distances of vertices, in pixels of a view. Vertices that the
 * view does not see count as 0.
 *
 * distance_mm  vertex_count, such as cw_mesh_distance_desc.worst
 * pixels       set to the distance
 * Returns      CW_ERR_ARGUMENT for an unusable camera */
CW_NODISCARD CW_API cw_status cw_simplify_view_distance(const cw_simplify_view *view,
                                                        const cw_mesh *mesh,
                                                        const float *distance_mm,
                                                        double *pixels, cw_error *err);

/* Leaves out the triangles that certainly none of the views sees. Pictures are enlarged by
 * `pixels` on all sides. Triangles go that are beside the pictures, or everywhere more than
 * twice margin_mm behind the depths of the view. Then vertices go that no triangle names. The
 * remaining mesh is open.
 *
 * mesh       in place: its arrays stay where they are, and only get shorter;
 *            unchanged on failure
 * margin_mm  distance bound of the mesh from the one whose depths were drawn
 * dropped    number of triangles; may be NULL
 * Returns    CW_ERR_ARGUMENT as cw_simplify_view_sees(), cw_mesh_check(); CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_simplify_cull(cw_mesh *mesh, const cw_simplify_view *views,
                                               size_t count, double pixels, double margin_mm,
                                               size_t *dropped, cw_error *err);

/* Facts on a finished simplification. */
typedef struct cw_simplify_facts {
    size_t vertices, triangles; /* of the result */
    size_t cut;    /* vertices of the input whose triangles are no single fan: they stay where
                      they are, and everything around them */
    size_t passes; /* 1, and 1 more for each time that error_mm needed more care */
} cw_simplify_facts;

/* Simplifies a mesh by collapsing edges, those first that move the surface least.
 *
 * The result has as many components, handles and border loops as the input. It has no new edge
 * of three triangles. No triangle of the result is without area. None meets another triangle
 * that is not its neighbour, unless triangles of the input did. Attributes of vertices and corners are
 * those of the closest point of the input; triangles take those of the triangle closest to their middle.
 *
 * A mesh with texture coordinates (CW_TEXTURE_COORDINATES) keeps its texture: it still fits. Vertices on
 * seams move along them, and stay where seams meet or end. Charts keep their triangles on the texture;
 * none turns over there, and charts that lay apart do not come to overlap. The way of a place on the texture
 * counts as a distance, which no collapse moves farther than error_mm; cw_mesh_texture_distance() measures it.
 *
 * With triangles or ratio alone the result may have more triangles than requested. That happens
 * where every edge that is left would break one of these rules.
 *
 * mesh     borrowed; vertices at equal positions count as different ones: weld them first
 * desc     borrowed
 * out      filled on success, emptied on failure; free it with cw_mesh_free()
 * facts    may be NULL
 *
 * Returns  CW_ERR_ARGUMENT     no target; a target or weight that is negative or not finite; a
 *                              weight of an attribute that the mesh lacks; views without
 *                              error_mm; an invalid camera; or as cw_mesh_check()
 *          CW_ERR_UNSUPPORTED  this build has no OpenMesh
 *          CW_ERR_LIMIT        beyond 2^32 / 3 triangles or vertices
 *          CW_ERR_NO_MEMORY; CW_ERR_CANCELLED
 * Cost     about two microseconds of one processor for a triangle that is removed
 * Threads  reentrant; the same to the bit for any number of threads
 * Source   quadrics [Garland1997], of attributes [Hoppe1999] */
CW_NODISCARD CW_API cw_status cw_simplify(const cw_mesh *mesh, const cw_simplify_desc *desc,
                                          cw_mesh *out, cw_simplify_facts *facts,
                                          cw_error *err);

/* Simplifies to several numbers of triangles. Each level is made from the one before, so that
 * all take hardly longer than the last.
 *
 * triangles  levels, each fewer than the one before; desc has neither these, nor ratio or error
 * levels     number of levels
 * out        levels; filled on success, emptied on failure
 * facts      levels, or NULL
 * Returns    CW_ERR_ARGUMENT when the numbers do not fall; else as cw_simplify() */
CW_NODISCARD CW_API cw_status cw_simplify_levels(const cw_mesh *mesh,
                                                 const cw_simplify_desc *desc,
                                                 const size_t *triangles, size_t levels,
                                                 cw_mesh *out, cw_simplify_facts *facts,
                                                 cw_error *err);

/* Simplifies a surface that comes one slab at a time, such as from cw_extract_slabs(). It works
 * in tandem with the maker of the slabs, so the whole surface is never in memory:
 *
 *     cw_simplifier_new(&(cw_simplify_desc){.error_mm = 0.1}, &simplifier, &err);
 *     cw_extract_slabs(&volume, &extract_desc, CW_SIMPLIFIER_SLAB,
 *                      (cw_slab_sink){cw_simplifier_take, simplifier}, NULL, &err);
 *     cw_simplifier_finish(simplifier, &mesh, NULL, &err);
 *     cw_simplifier_free(simplifier);
 *
 * The promises of cw_simplify() hold across seams, too. With an error bound, a slab and half of
 * the one before are simplified as one, against the surface that came. The result is as good as
 * from the whole. With a number of triangles, each slab is simplified by itself to three times
 * its share; then all of them are simplified together.
 *
 * Source  [Attali2005] */
typedef struct cw_simplifier cw_simplifier;

/* Triangles of a slab, enough that seams are few among them. */
#define CW_SIMPLIFIER_SLAB ((size_t)1 << 19)

/* Makes a simplifier. Free it with cw_simplifier_free().
 * desc     copied; an error, or else triangles or a ratio
 * out      set to the simplifier
 * Returns  CW_ERR_ARGUMENT for both or none, and as cw_simplify() */
CW_NODISCARD CW_API cw_status cw_simplifier_new(const cw_simplify_desc *desc,
                                                cw_simplifier **out, cw_error *err);

/* Frees a simplifier. Harmless on NULL. */
CW_API void cw_simplifier_free(cw_simplifier *simplifier);

/* Takes the next slab; for cw_slab_sink. After an error the simplifier can only be freed.
 * simplifier  a cw_simplifier
 * slab        borrowed
 * Returns     as cw_simplify() */
CW_NODISCARD CW_API cw_status cw_simplifier_take(void *simplifier, const cw_slab *slab,
                                                 cw_error *err);

/* Makes the result, without normals: cw_extract_normals() adds them. Empty when no slab came.
 *
 * simplifier  used up: it can only be freed
 * out         filled on success, emptied on failure; free it with cw_mesh_free()
 * facts       may be NULL
 * Returns     CW_ERR_ARGUMENT when the last slab is missing; else as cw_simplify() */
CW_NODISCARD CW_API cw_status cw_simplifier_finish(cw_simplifier *simplifier, cw_mesh *out,
                                                   cw_simplify_facts *facts, cw_error *err);

/* Returns true if this build has OpenMesh, which cw_simplify() needs. */
CW_API bool cw_simplify_available(void);

#ifdef __cplusplus
}
#endif

#endif
