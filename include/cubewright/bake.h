/* Baking: detail of a full mesh as a texture of a mesh with fewer triangles. */
#ifndef CUBEWRIGHT_BAKE_H
#define CUBEWRIGHT_BAKE_H

#include <cubewright/mesh.h>
#include <cubewright/picture.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The maps that can be baked: constant, and name. One that a later version adds stands at the end. */
#define CW_MAP_TABLE(X)                                                                        \
    X(CW_MAP_NORMALS, "normals")                                                               \
    X(CW_MAP_OCCLUSION, "occlusion")                                                           \
    X(CW_MAP_CURVATURE, "curvature")                                                           \
    X(CW_MAP_THICKNESS, "thickness")                                                           \
    X(CW_MAP_COLORS, "colors")

/* Maps that are made by rays, occlusion and thickness, have a fourth of the size along each side. */
#define CW_OCCLUSION_DIVISOR 4

/* Identifies a map. */
typedef enum cw_map {
#define CW_X(name, text) name,
    CW_MAP_TABLE(CW_X)
#undef CW_X
        CW_MAP_COUNT
} cw_map;

/* Returns the name of a map, such as "normals"; static. NULL for an unknown one.
 * map  any number */
CW_API const char *cw_map_name(cw_map map);

/* Settings of a bake. Zero-initialise the struct and set what you need; a zero field means the default
 * named beside it. */
typedef struct cw_bake_desc {
    uint32_t version; /* 0: the first version of this struct */
    uint32_t size;    /* texels along each side, 16 to 16384; default: 2048 */
    uint32_t margin;  /* texels around each chart that get the colour beside them; default: 2 */
    double reach_mm;  /* how far the full surface may be; default: 4 % of the box's diagonal */
    int threads;      /* default: one per processor */
    cw_progress progress; /* default: none */
    unsigned maps;        /* a bit 1u << cw_map for each; default: that of normals */
    double occlusion_mm;  /* farther than this nothing darkens; default: 10 % of the diagonal */
    double thickness_mm;  /* that is white; default: 10 % of the diagonal */
    double curvature_max; /* 1 / mm: that is white; default: 95 % of the vertices have less */
    bool deep;            /* fill cw_image.deep, too: 16 bits a channel */
} cw_bake_desc;

/* Facts on a finished bake. */
typedef struct cw_bake_facts {
    size_t texels; /* whose middle lies in a triangle */
    size_t
        missed; /* of them: those from which no surface that faces the same way is in reach */
    double max_mm;        /* the largest distance that was bridged, and */
    double mean_mm;       /* the mean */
    double mean_deg;      /* the mean angle between the normals of both surfaces */
    double reach_mm;      /* as in the settings, or the default */
    double occlusion_mm;  /* the same; 0: of pictures */
    double thickness_mm;  /* the same */
    double curvature_max; /* 1 / mm; 0: no curvature was asked for */
} cw_bake_facts;

/* Bakes the normals of a full surface into a normal map in the tangent space of [Mikkelsen2008], as glTF
 * has it: red along the tangent, green upward in the image, blue outward.
 *
 * Each texel takes the normal of the nearest point of the full surface that faces the same way, not the one
 * along a ray: there is no cage to get wrong. Texels that miss are flat.
 *
 * mesh   has texture coordinates (cw_mesh_atlas()), and normals, which must be those that are written with
 *        it; borrowed
 * full   borrowed; without normals, those of its triangles are averaged at vertices
 * desc   borrowed; NULL means all defaults
 * image  allocated and filled on success; free it with cw_image_free()
 * facts  may be NULL
 *
 * Returns  CW_ERR_ARGUMENT  no texture coordinates or normals; an empty full mesh; a setting out of its
 *                           range
 *          CW_ERR_CANCELLED, CW_ERR_NO_MEMORY; or as cw_mesh_check() */
CW_API CW_NODISCARD cw_status cw_bake_normals(const cw_mesh *mesh, const cw_mesh *full,
                                              const cw_bake_desc *desc, cw_image *image,
                                              cw_bake_facts *facts, cw_error *err);

/* Bakes maps of a full surface. Each texel takes what the surface has at the point that cw_bake_normals()
 * takes the normal of; places that no texel of a chart covers have the value for no surface.
 *
 * CW_MAP_NORMALS    as of cw_bake_normals()
 * CW_MAP_OCCLUSION  the share of the light of an even sky that nothing within occlusion_mm keeps off, by 32
 *                   rays [Zhukov1998]: white is open
 * CW_MAP_CURVATURE  the mean curvature [Meyer2003], smoothed over two rings: grey is flat, white a bump,
 *                   black a dent of curvature_max or more
 * CW_MAP_THICKNESS  the mean way through the solid within 30 degrees, by 7 rays [Shapira2008]: white is
 *                   thickness_mm or more
 * CW_MAP_COLORS     the colours of the full mesh's vertices
 *
 * Occlusion and thickness have size / CW_OCCLUSION_DIVISOR texels along each side.
 *
 * mesh    as in cw_bake_normals()
 * full    borrowed; the same, and with colours if those are asked for
 * desc    borrowed; NULL means all defaults
 * images  CW_MAP_COUNT of them: those that are asked for are allocated and filled on success, the others
 *         zeroed; free them with cw_image_free()
 * facts   may be NULL; texels and misses are those of the largest map
 *
 * Returns as cw_bake_normals(); CW_ERR_ARGUMENT for colours that the full mesh lacks
 * Threads reentrant; the same to the bit for any number of threads */
CW_API CW_NODISCARD cw_status cw_bake_maps(const cw_mesh *mesh, const cw_mesh *full,
                                           const cw_bake_desc *desc, cw_image *images,
                                           cw_bake_facts *facts, cw_error *err);

/* Bakes the same maps for several meshes that share a square, of cw_meshes_atlas(): parts, or levels of detail.
 * meshes  count of them; borrowed
 * count   number of meshes
 * full    as in cw_bake_maps()
 * desc    the same
 * images  the same
 * facts   the same
 * Returns as cw_bake_maps() */
CW_API CW_NODISCARD cw_status cw_bake_meshes(const cw_mesh *const *meshes, size_t count,
                                             const cw_mesh *full, const cw_bake_desc *desc,
                                             cw_image *images, cw_bake_facts *facts,
                                             cw_error *err);
/* The pictures of a material. */
typedef enum cw_picture_use {
    CW_PICTURE_COLOR,
    CW_PICTURE_NORMAL, /* a normal map in tangent space */
    CW_PICTURE_METALLIC_ROUGHNESS,
    CW_PICTURE_OCCLUSION,
    CW_PICTURE_EMISSIVE,
    CW_PICTURE_USES
} cw_picture_use;

/* A textured surface, with its decoded pictures. */
typedef struct cw_bake_source {
    const cw_mesh *mesh; /* with texture coordinates, if it has pictures */
    const cw_image *pictures[CW_PICTURE_USES]; /* NULL: none */
    bool repeats; /* the pictures go on beyond 0 and 1; default: they end there */
} cw_bake_source;

/* Bakes the pictures of textured surfaces into the texture of another mesh, such as one that was remeshed.
 *
 * Each texel takes the values of the nearest point that faces the same way, between four pixels of the
 * stored numbers (colours in sRGB, as they are). Normals are turned into the tangent space of the mesh. Where a
 * source has no picture of a use that another one has, texels are white, and normals those of its surface. Texels
 * that miss are white and flat.
 *
 * mesh      as in cw_bake_normals()
 * sources   count, borrowed; without normals, those of their triangles are averaged at vertices
 * desc      borrowed; NULL means all defaults
 * pictures  CW_PICTURE_USES of them: those that some source has are allocated and filled on success, the
 *           others zeroed; free each with cw_image_free()
 * facts     may be NULL
 *
 * Returns   as cw_bake_normals(); CW_ERR_ARGUMENT for pictures without texture coordinates */
CW_API CW_NODISCARD cw_status cw_bake_pictures(const cw_mesh *mesh,
                                               const cw_bake_source *sources, size_t count,
                                               const cw_bake_desc *desc, cw_image *pictures,
                                               cw_bake_facts *facts, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
