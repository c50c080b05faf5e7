/* Texture coordinates: a surface is cut into charts, which are laid flat and packed into a square. */
#ifndef CUBEWRIGHT_ATLAS_H
#define CUBEWRIGHT_ATLAS_H

#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The name of the attribute with texture coordinates: CW_ON_CORNERS, CW_F32, 2 components,
 * CW_INTERPOLATE_LINEAR. (0, 0) is the upper left corner of the texture's image, (1, 1) the lower right
 * one, as in glTF. On vertices instead of corners, each vertex has one. */
#define CW_TEXTURE_COORDINATES "texture_coordinates"

/* Settings of an atlas. Zero-initialise the struct and set what you need; a zero field means the
 * default named beside it. */
typedef struct cw_atlas_desc {
    uint32_t version; /* 0: the first version of this struct */
    uint32_t
        size; /* texels along each side of the texture, 64 to CW_ATLAS_MAX_SIZE; default: 2048 */
    uint32_t margin;      /* texels that are free between charts, 1 to 64; default: 2 */
    double texels_per_mm; /* default: as many as fit */
    double
        max_stretch; /* of a chart, more than 1; charts stretched more are cut in two; default: 1.25 */
    int threads;          /* default: one per processor */
    cw_progress progress; /* default: none */
} cw_atlas_desc;

/* Maximum of cw_atlas_desc.size. */
#define CW_ATLAS_MAX_SIZE ((uint32_t)16384)

/* Facts on a finished atlas. */
typedef struct cw_atlas_facts {
    uint32_t size, margin; /* those of the settings, or their defaults */
    size_t charts;         /* number of charts */
    size_t seams;          /* edges between two triangles that lie apart in the texture */
    size_t vertices;       /* vertices of files that hold one texture coordinate for each */
    double texels_per_mm;  /* in the mean of all areas */
    double stretch;        /* L2 of the whole surface [Sander2001]: 1 is none */
    double coverage;       /* share of the texture that triangles cover */
    size_t flipped;        /* triangles turned over by the rounding to single precision */
} cw_atlas_facts;

/* Gives a mesh texture coordinates: the attribute CW_TEXTURE_COORDINATES, in place of one that is there.
 * Everything else stays as it is.
 *
 * Neighbouring triangles are merged to charts while they face one way well enough, first those that
 * differ least in direction, so that seams follow creases and valleys [Garland2001, Cohen2004]. A chart is
 * laid flat and relaxed to the least symmetric Dirichlet energy [Smith2015]. One that folds, lies on
 * itself or is stretched too much is cut in two, along the seam that was merged last. Charts are packed
 * by their outlines [Levy2002], all with the same number of texels for a mm. Any mesh ends: a triangle
 * is a chart. The result does not depend on the number of threads.
 *
 * mesh     open ones, too, and those with edges of three or more triangles
 * desc     borrowed; NULL means all defaults
 * facts    may be NULL
 *
 * Returns  CW_ERR_ARGUMENT  a setting out of its range; a mesh without area; charts that do not fit
 *                           into the texture, at the density asked for or at any
 *          CW_ERR_CANCELLED, CW_ERR_NO_MEMORY; or as cw_mesh_check() */
CW_API CW_NODISCARD cw_status cw_mesh_atlas(cw_mesh *mesh, const cw_atlas_desc *desc,
                                            cw_atlas_facts *facts, cw_error *err);

/* Gives several meshes texture coordinates in one square: parts of a file, or levels of detail, which then share
 * their textures.
 *
 * meshes  count of them; on failure some may have texture coordinates that are not final
 * scales  count of them: texels of a mesh for its mm, as a share of those of the first, such as 1, 0.5, 0.25 for
 *         levels of detail; NULL: all the same
 * desc    borrowed; NULL means all defaults
 * facts   of all together; texels_per_mm is that of a scale of 1; may be NULL
 *
 * Returns as cw_mesh_atlas(); CW_ERR_ARGUMENT for a count of 0, and a scale that is not positive */
CW_API CW_NODISCARD cw_status cw_meshes_atlas(cw_mesh *const *meshes, const double *scales,
                                              size_t count, const cw_atlas_desc *desc,
                                              cw_atlas_facts *facts, cw_error *err);

/* Splits vertices whose corners have different texture coordinates, so that each vertex has one, for
 * programs that know values of vertices alone. The attribute CW_TEXTURE_COORDINATES then has
 * CW_ON_VERTICES. A mesh without it stays as it is.
 *
 * mesh     unchanged on failure
 *
 * Returns  CW_ERR_NO_MEMORY, or as cw_mesh_check() */
CW_API CW_NODISCARD cw_status cw_mesh_split_seams(cw_mesh *mesh, cw_error *err);

/* How far a texture has moved. */
typedef struct cw_texture_distance {
    size_t samples; /* points of the mesh that were compared */
    double max_mm;  /* the largest distance of one */
    double mean_mm; /* over the area of the mesh */
    double
        side_mm; /* what the texture's side measures on the full mesh, in the mean: a texture of n
                       texels has n / side_mm for a mm */
} cw_texture_distance;

/* Measures how far the texture of a mesh has moved from where it was on another one, such as before it was
 * simplified. A point of the mesh is as far from a point of the full mesh as the root of the sum of two
 * squares says: that of the way in space, and that of the way in the texture, on the surface. The nearest
 * point counts.
 *
 * mesh, full  with texture coordinates; borrowed
 * threads     0: one per processor
 * facts       filled on success
 * Returns     CW_ERR_ARGUMENT  no texture coordinates; those of the full mesh are not all finite
 *             CW_ERR_EMPTY     these cover no area; CW_ERR_NO_MEMORY; or as cw_mesh_check()
 * Source      points in space and texture as those of five dimensions [Garland1998] */
CW_API CW_NODISCARD cw_status cw_mesh_texture_distance(const cw_mesh *mesh, const cw_mesh *full,
                                                       int threads, cw_texture_distance *facts,
                                                       cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
