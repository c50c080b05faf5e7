/* Appearance: how alike two surfaces look, measured on pictures of both from the same places. */
#ifndef CUBEWRIGHT_APPEARANCE_H
#define CUBEWRIGHT_APPEARANCE_H

#include <cubewright/camera.h>
#include <cubewright/mesh.h>
#include <cubewright/picture.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A surface and the pictures on it. Several of them, such as the parts of a file, are looked at
 * together.
 *
 * Colours are those of CW_FACE_COLORS or of vertices, if there are any. A mesh without normals is flat. */
typedef struct cw_surface_look {
    const cw_mesh *mesh; /* borrowed; with texture coordinates if there are maps */
    const cw_image
        *normal_map; /* borrowed; in tangent space, as cw_bake_normals() makes it, for a
                                   mesh with normals; default: none */
    const cw_image *color_map; /* borrowed; sRGB, multiplied with the colours; default: none */
    const cw_image
        *occlusion_map; /* borrowed; its red darkens the light from everywhere; default: none */
} cw_surface_look;

/* Settings of the measurement. Zero-initialise the struct and set what you need; a zero field means
 * the default named beside it. */
typedef struct cw_appearance_desc {
    uint32_t version; /* 0: the first version of this struct */
    uint32_t views;   /* 1 to CW_APPEARANCE_MAX_VIEWS; default: 8 */
    uint32_t
        size; /* pixels along each side of a view, 16 to CW_APPEARANCE_MAX_SIZE; default: 1024 */
    int threads;          /* default: one per processor */
    cw_progress progress; /* default: none */
} cw_appearance_desc;

/* Maximum of cw_appearance_desc.views. */
#define CW_APPEARANCE_MAX_VIEWS 64

/* Maximum of cw_appearance_desc.size. */
#define CW_APPEARANCE_MAX_SIZE 4096

/* The difference of two pictures, over the pixels that at least one shows a surface in; what one does
 * not show is black there. With `_both`: over the pixels that both show, inside both outlines. */
typedef struct cw_look_difference {
    size_t pixels;       /* that at least one shows a surface in; 0: none, and all below is 0 */
    size_t shown_by_one; /* of them: those that only one does */
    double rmse;         /* of red, green and blue, 0 to 255 */
    double psnr_db;      /* 20 log10(255 / rmse); INFINITY: equal */
    double delta_e;      /* mean CIEDE2000 [Sharma2005] */
    double rmse_both;    /* as rmse, inside both outlines */
    double psnr_both_db; /* as psnr_db, there */
    double delta_e_both; /* as delta_e, there */
} cw_look_difference;

/* A view: the camera looks at the middle of the reference's box from outside of it. */
typedef struct cw_appearance_view {
    cw_camera camera; /* from which it is drawn */
    double
        azimuth_deg; /* 0: from the patient's front; 90: from the patient's left; below 360 */
    double elevation_deg; /* -90: from below, 90: from above */
} cw_appearance_view;

/* How alike two surfaces look. */
typedef struct cw_appearance {
    uint32_t views, size;   /* those of the settings, or their defaults */
    uint32_t worst;         /* the view with the largest rmse */
    cw_look_difference all; /* over all views */
    cw_look_difference view[CW_APPEARANCE_MAX_VIEWS];  /* of each view */
    cw_appearance_view place[CW_APPEARANCE_MAX_VIEWS]; /* of each view */
} cw_appearance;

/* Measures how alike two surfaces look: both are drawn from the same places, spread evenly over a
 * sphere [Swinbank2006], in the same light, as matt grey, and compared pixel by pixel.
 *
 * Pictures are drawn on the CPU: perspective of 30 degrees, 4 samples a pixel, the front sides alone. The
 * light comes from above the left of the camera, and goes with it; 15 % of it come from everywhere.
 * viewer/appearance.md has the definition, and how near three.js comes to it.
 *
 * reference        reference_count of them, borrowed; the views are those of their box
 * reference_count  number of references
 * surface          surface_count of them, borrowed, in the same frame
 * surface_count    number of surfaces
 * desc             borrowed; NULL means all defaults
 * with_maps        filled on success
 * without_maps     filled on success: the same without the maps of `surface`, those of the reference
 *                  stay; may be NULL
 *
 * Returns  CW_ERR_ARGUMENT  no reference, or one without a triangle or without extent; maps without
 *                           texture coordinates; a normal map without normals; a setting out of its range
 *          CW_ERR_LIMIT     more than 2^32 - 1 vertices
 *          CW_ERR_CANCELLED, CW_ERR_NO_MEMORY; or as cw_mesh_check()
 * Cost     time in proportion to the triangles and to the pixels, for each view
 * Threads  the same to the bit for any number of them
 * Source   CIEDE2000 [Sharma2005]; reflection [Walter2007], [Schlick1994], [Turquin2019]; edge functions
 *          [Olano1997] */
CW_NODISCARD CW_API cw_status cw_appearance_measure(
    const cw_surface_look *reference, size_t reference_count, const cw_surface_look *surface,
    size_t surface_count, const cw_appearance_desc *desc, cw_appearance *with_maps,
    cw_appearance *without_maps, cw_error *err);

/* Finds one of the views of a reference.
 * reference  reference_count of them, borrowed
 * reference_count  number of references
 * views    number of all views, as in cw_appearance_desc; 0: the default
 * n        number of the view, below views
 * view     filled on success
 * Returns  CW_ERR_ARGUMENT as above */
CW_NODISCARD CW_API cw_status cw_appearance_find_view(const cw_surface_look *reference,
                                                      size_t reference_count, uint32_t views,
                                                      uint32_t n, cw_appearance_view *view,
                                                      cw_error *err);

/* Draws surfaces from a camera as cw_appearance_measure() does.
 * surface  count of them; none gives a picture of nothing
 * desc     its size, threads and progress
 * image    allocated and filled on success: black and opacity 0 where no surface is, colours
 *          multiplied with the opacity at outlines; free it with cw_image_free()
 * Returns  as above; CW_ERR_ARGUMENT as cw_camera_axes() */
CW_NODISCARD CW_API cw_status cw_appearance_draw(const cw_surface_look *surface, size_t count,
                                                 const cw_camera *camera,
                                                 const cw_appearance_desc *desc,
                                                 cw_image *image, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
