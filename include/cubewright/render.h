/* Rendering of volumes and meshes into pictures, in every classic mode, without a window;
 * picking. */
#ifndef CUBEWRIGHT_RENDER_H
#define CUBEWRIGHT_RENDER_H

#include <cubewright/camera.h>
#include <cubewright/mesh.h>
#include <cubewright/picture.h>
#include <cubewright/transfer.h>
#include <cubewright/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

/* One row per mode: constant, name, description, and the paper it follows.
 *
 * Intensity projections (mip, minip, average, local-mip) show one value per ray. It has the
 * colour of the transfer function and is opaque, whatever its opacity there. Nothing shows
 * where the ray meets no value. These modes have no light and no depth cue. average leaves gaps
 * on the ray out of the mean. A local maximum of local-mip may lie where the ray enters or
 * leaves values. If none reaches the threshold, the highest value counts. minip_inside makes
 * minip show what is lowest inside of an object; a ray through a solid one shows the threshold,
 * which it crosses on its way in.
 *
 * A gradient is interpolated between those of the voxels around. These are central differences,
 * one-sided at the border, 0 where a neighbour has no value and along an axis of one voxel. On a
 * rectilinear grid the slopes on both sides are weighted so that parabolas are exact, and on an
 * irregular one gradients are least squares over the edges of cells. A cell with a corner that
 * has no value is empty. The field in cells: viewer/irregular.md. */
#define CW_MODE_TABLE(X)                                                                       \
    X(CW_MODE_MESH, "mesh", "triangles, lit", "Blinn 1977")                                    \
    X(CW_MODE_COMPOSITE, "composite", "ray casting: emission and absorption",                  \
      "Upson & Keeler 1988; Drebin et al. 1988; Engel et al. 2001")                            \
    X(CW_MODE_MIP, "mip", "the highest value along each ray", "Wallis et al. 1989")            \
    X(CW_MODE_MINIP, "minip", "the lowest value along each ray", "Wallis et al. 1989")         \
    X(CW_MODE_AVERAGE, "average", "the mean value along each ray", "as an X-ray")              \
    X(CW_MODE_LOCAL_MIP, "local-mip", "the first maximum above a threshold",                   \
      "Sato et al. 1998")                                                                      \
    X(CW_MODE_PROJECTION, "projection", "coherent projection of cells",                        \
      "Wilhelms & Van Gelder 1991")                                                            \
    X(CW_MODE_SPLAT, "splat", "splatting, sheet by sheet", "Westover 1990")                    \
    X(CW_MODE_SPLAT_TREE, "splat-tree", "hierarchical splatting", "Laur & Hanrahan 1991")      \
    X(CW_MODE_TEXTURE, "texture", "slices through a 3D texture",                               \
      "Wilson, Van Gelder & Wilhelms 1994")                                                    \
    X(CW_MODE_SHADED_TEXTURE, "shaded-texture",                                                \
      "slices through a texture of quantised "                                                 \
      "gradients",                                                                             \
      "Van Gelder & Kim 1996")                                                                 \
    X(CW_MODE_SLICES, "slices", "axial, coronal, sagittal and oblique slices", "")             \
    X(CW_MODE_VBUFFER, "vbuffer", "ray casting cell by cell, on the CPU",                      \
      "Upson & Keeler 1988")                                                                   \
    X(CW_MODE_REFERENCE, "reference", "the rendering integral itself, on the CPU",             \
      "Sabella 1988; Max 1995")

/* The render modes. */
typedef enum cw_mode {
#define CW_MODE_ENUM(name, text, about, source) name,
    CW_MODE_TABLE(CW_MODE_ENUM)
#undef CW_MODE_ENUM
        CW_MODE_COUNT
} cw_mode;

/* Returns the fields of a row of CW_MODE_TABLE; static. */
CW_API const char *cw_mode_name(cw_mode mode);
CW_API const char *cw_mode_about(cw_mode mode);
CW_API const char *cw_mode_source(cw_mode mode);

/* Returns true for the intensity projections: mip, minip, average and local-mip. */
CW_API bool cw_mode_is_intensity(cw_mode mode);

/* Returns true if a mode draws a volume of this kind: all draw evenly spaced ones. Rectilinear
 * and irregular grids are drawn by the CPU, in the modes vbuffer, reference, projection, mip,
 * minip, average and local-mip. None draws sparse grids; see cw_volume_densify(). */
CW_API bool cw_mode_draws(cw_mode mode, const cw_volume *volume);

/* The backend that draws. */
typedef enum cw_backend {
    CW_BACKEND_AUTO, /* the CPU for its own modes (vbuffer, reference), for rectilinear and
                        irregular grids, and for projection where OpenGL is missing or runs on
                        the CPU, too; else EGL */
    CW_BACKEND_EGL,  /* OpenGL 3.3, without a display */
    CW_BACKEND_CPU,  /* vbuffer, reference, projection, intensity projections, and opaque
                        meshes, alone (in a light of their own) or with those */
    CW_BACKEND_COUNT
} cw_backend;

/* Maximum numbers of lights, clip planes and slices of a scene. */
enum { CW_MAX_LIGHTS = 4, CW_MAX_CLIPS = 12, CW_MAX_SLICES = 4 };

/* A light from far away. */
typedef struct cw_light {
    double direction[3]; /* towards the light, of any length, in the camera's frame: x to the
                            right, y up, z to the eye */
    float color[3];      /* linear, 1 is full */
} cw_light;

/* A clip plane: it keeps the points with normal . p >= distance, p in the world, LPS
 * millimetres. */
typedef struct cw_clip {
    double normal[3];   /* of any length but 0 */
    double distance_mm; /* from the world's zero, in units of the normal's length */
} cw_clip;

/* A slice to draw: all p with normal . p = distance. */
typedef cw_clip cw_slice;

/* Reflection of light: I = ambient C + sum over lights (diffuse |n.l| C + specular
 * |n.h|^shininess) I_l. Both sides are lit, unless the scene is one_sided. Where a volume's
 * gradient is 0 there is no n, and only ambient light. */
typedef struct cw_material {
    float ambient, diffuse, specular, shininess; /* all 0: 0.25, 0.75, 0.2, 32 */
} cw_material;

/* How the depth cue changes from its start to its end. */
typedef enum cw_cue_form {
    CW_CUE_LINEAR,      /* the background's fraction rises linearly, and is constant beyond the
                           end */
    CW_CUE_EXPONENTIAL, /* fog of one density: a fraction exp(-k d) of the light is left, d from
                           the start on; k gives the fraction that is named at the end, and it
                           goes on falling beyond */
    CW_CUE_COUNT
} cw_cue_form;

/* The source of a mesh's colours. */
typedef enum cw_tint {
    CW_TINT_COLORS,  /* the mesh's colours, else the scene's */
    CW_TINT_SCALARS, /* the mesh's scalars, dark to bright from tint_low to tint_high */
    CW_TINT_QUALITY, /* each triangle's shape: 4 sqrt(3) area / sum of squared edges, 0 to 1 */
    CW_TINT_COUNT
} cw_tint;

/* The pixel type in which slices of a texture are blended. */
typedef enum cw_target {
    CW_TARGET_32F, /* single precision */
    CW_TARGET_16,  /* unsigned, normalised */
    CW_TARGET_16F, /* half precision: rounds towards zero on some machines */
    CW_TARGET_8,
    CW_TARGET_COUNT
} cw_target;

/* The gradient of a point in shaded-texture, from the quantised ones of the voxels. */
typedef enum cw_direction_filter {
    CW_DIRECTIONS_LINEAR,  /* the directions of the eight voxels around it, each as long as its
                              gradient, are interpolated and lit for each fragment: the error
                              falls with the number of directions */
    CW_DIRECTIONS_NEAREST, /* that of the nearest voxel; its colour is in a table of lit colours,
                              as in 1996: faster, and facets show, however many directions */
    CW_DIRECTIONS_COUNT
} cw_direction_filter;

/* The blob that stands for a voxel in splatting. Gaussians are blobs in space, seen as ellipses.
 * B-splines lie in their sheet, across the lattice: with their own widths a constant volume is
 * constant in any view. */
typedef enum cw_splat_kernel {
    CW_SPLAT_GAUSSIAN, /* default width 0.6 voxels */
    CW_SPLAT_POLYGON,  /* a Gaussian as 24 triangles with colours at corners, as in 1991 */
    CW_SPLAT_TENT, /* linear B-spline: nearest to trilinear interpolation, and the fastest */
    CW_SPLAT_B_SPLINE, /* cubic B-spline: smooth */
    CW_SPLAT_COUNT
} cw_splat_kernel;

/* Shadows of a lit volume on itself: the volume between a voxel and a light absorbs. They are
 * computed at every second voxel, by rays in steps of the smallest spacing through the extinction
 * of voxels, and interpolated. Modes composite, texture, vbuffer and reference have them, of
 * evenly spaced volumes. */
typedef enum cw_shadow {
    CW_SHADOW_NONE,
    CW_SHADOW_LIGHT,   /* a ray to the first light: less of its diffuse and specular light */
    CW_SHADOW_AMBIENT, /* ambient occlusion: the mean over 14 rays of 12 steps. All light is
                          multiplied by twice that, at most 1, which it is at a flat surface */
    CW_SHADOW_COUNT
} cw_shadow;

/* A volume's isosurface that OpenGL extracts by itself, at full resolution, and draws as the
 * scene's mesh: that of cw_extract(), capped, with one normal a vertex. For an isovalue that moves:
 * vertices and triangles never leave the GPU. */
typedef struct cw_live_surface {
    const cw_volume *volume; /* evenly spaced, of any type but f64 */
    double isovalue;         /* in the unit of the values */
    bool inside_is_low;      /* default: values at or above the isovalue are inside */
    bool on_software;        /* also where OpenGL runs on the CPU, which is slower than
                                cw_extract(); default: refuse there */
} cw_live_surface;

/* Settings of samples along rays, and of slices of textures. Zero fields mean the default named beside
 * them, here and in the structs below. */
typedef struct cw_sampling {
    double step_vox;        /* distance of samples along a ray, or of slices of a texture, in
                               units of the smallest spacing; default 1 */
    bool cell_steps;        /* samples end at the faces of cells */
    bool no_preintegration; /* sample at the middle of each step. Default: composite does so for
                               wide transfer functions, and integrates narrow ones over each
                               step, as the other modes do all */
    bool jitter;            /* shift the samples of every ray by a different fraction of a
                               step */
    bool exact_filter;      /* trilinear interpolation by the shader, not the texture unit */
    bool no_skipping;       /* do not skip empty space */
    float stop_opacity;  /* rays, layers of meshes, and cells of projection on the CPU, end at
                               this opacity; default 0.9999, vbuffer 0.99999 */
    bool lean;           /* saves memory and time of the first picture. The shader computes
                               gradients where it can, instead of reading them from a texture;
                               lit rays are up to a third slower. Always so for large volumes.
                               Where the processor draws (Mesa's llvmpipe), voxels without gaps
                               of u8, u16, i16 or f32 are read from the caller's memory without
                               a texture; rays are a sixth slower. texture and shaded-texture
                               always have textures */
    size_t texture_edge; /* maximum edge of a 3D texture, in voxels; default: GL's maximum */
} cw_sampling;

/* Settings of intensity projections. */
typedef struct cw_intensity_look {
    double threshold;  /* local-mip: the minimum of a maximum that counts; minip_inside: what
                               values of the object reach */
    bool minip_inside; /* minip: the minimum between the first and the last place of a ray
                               whose value reaches threshold, so that the air around an object
                               does not count. A ray that does not reach it shows nothing.
                               Default: the minimum of the whole ray */
} cw_intensity_look;

/* Settings of texture and shaded-texture. */
typedef struct cw_texture_look {
    cw_target target;  /* the pixel type for blending slices */
    bool colors_first; /* texture, shaded-texture, reference on evenly spaced volumes:
                            interpolate the colours and extinctions of voxels, not data */
    size_t normals;    /* shaded-texture: number of directions in the table, at most 8192;
                               default 1024. The mode is lit whether or not lit is set */
    cw_direction_filter direction_filter; /* shaded-texture; colors_first has the table's
                               colours of eight voxels, whatever this is */
    bool material_table; /* shaded-texture: a value has the mean colour and opacity of its
                               material, the interval between two points of the opacities, as in
                               1996. The table has a column for each material and one for what is
                               invisible, instead of 256 for values */
    bool mark_boundary;  /* shaded-texture: draw only cells at material boundaries, and those
                               around them, so that no hole is left: between the values of their
                               samples lies a point of the opacities */
} cw_texture_look;

/* Settings of vbuffer. */
typedef struct cw_vbuffer_look {
    bool pixel_area; /* a pixel that is wider than a cell shows the mean over its
                               area, of evenly spaced volumes; default: what the ray through
                               its middle meets */
} cw_vbuffer_look;

/* Settings of projection. */
typedef struct cw_projection_look {
    bool linear_opacity; /* opacity, not depth, is linear over a polygon, as in 1991 */
    double tree_error; /* half the range of values of a node that is drawn whole, in the table's
                            range 0..1 of values; 0: each cell is drawn */
} cw_projection_look;

/* Settings of splat and splat-tree. */
typedef struct cw_splat_look {
    cw_splat_kernel kernel; /* the blob of a voxel */
    double width;           /* its standard deviation in voxels, 0.2 to 4;
                           default 0.6, of a tent 0.408, of a cubic B-spline 0.577 */
    double tree_error;      /* splat-tree: maximum error of a node, in the table's range 0..1 of
                               values; 0: every voxel is splatted */
    size_t budget;          /* splat-tree: approximate maximum of splats in a picture; the error
                               is raised until they suffice; default: no limit */
} cw_splat_look;

/* Settings of meshes, in any mode. */
typedef struct cw_mesh_look {
    float color[4]; /* sRGB and opacity of a mesh without colours; default a bone white */
    cw_tint tint;   /* default: its colours */
    double tint_low, tint_high; /* both 0: the range of the scalars */
    bool wireframe;             /* edges drawn over the triangles; faint where they are dense */
    bool same_inside;           /* the inside of a mesh, seen through a cut or a clear surface,
                                   has the colour of the outside; default: a red shade of it */
    bool cap;                   /* fill the cut through a clipped mesh, which must be closed */
    const cw_live_surface *live; /* drawn instead of a mesh, by OpenGL 4.3 alone, without
                               wireframe and in the scene's colour; default: none. Depths of a cue
                               are those of the volume's box */
} cw_mesh_look;

/* A scene. Zero-initialise it and set what you need; a zero field means the default named
 * beside it. Memory behind pointers is borrowed. */
typedef struct cw_scene {
    cw_mode mode;                /* default: mesh */
    const cw_volume *volume;     /* see cw_mode_draws(); required for all modes but mesh */
    const cw_mesh *mesh;         /* also drawn, opaque, in any mode; required for mesh */
    const cw_transfer *transfer; /* required for all modes but mesh */
    cw_camera camera;            /* default (up all 0): front view of everything, 30 degrees */
    size_t width, height;        /* pixels, at most 16384; default 1280 x 720 */
    int samples;                 /* a side: 1 to 4 squared samples a pixel; default 1 */

    cw_mode reference_of; /* reference: an intensity projection whose exact picture is drawn,
                             with the extremes or means of the field itself, on the CPU; default:
                             the rendering integral */

    /* light and depth */
    cw_light lights[CW_MAX_LIGHTS]; /* light_count of them */
    size_t light_count;             /* default: one, white, from the eye; for meshes without a
                                       material, studio lights */
    cw_material material;           /* default: as named beside its fields */
    double gradient_sigma; /* standard deviation of a Gaussian that smooths the field before
                              its gradient is taken, in units of the smallest spacing, at most
                              16, on evenly spaced volumes; default 0: none */
    bool lit;              /* volumes are shaded by their gradient; meshes always are */
    bool one_sided;      /* light falls only on the side that faces lower values (n is minus the
                             gradient), of meshes on the side that their triangles face: n.l and
                             n.h count where n.l is above 0, instead of their absolute values.
                             Things of low values in high ones, such as airways, are then lit
                             from inside of them. Default: both sides are lit */
    cw_shadow shadow;    /* default: none */
    float depth_cue;     /* 0 to 1: the fraction of the background at the cue's end; it is 0 up
                             to the cue's start. Below 1 if exponential */
    double cue_range[2]; /* start and end of the depth cue, as fractions of the scene's depth:
                             0 is its nearest point, 1 its farthest, and they may lie outside;
                             both 0: 0 and 1 */
    cw_cue_form cue_form;        /* default: linear */
    float background[2][3];      /* top and bottom, for depth_cue and slices; sRGB */
    cw_clip clips[CW_MAX_CLIPS]; /* clip_count planes: points kept by all of them are drawn */
    size_t clip_count;           /* default: none */
    bool cut_away;               /* leave out what all of them would keep, draw the rest */

    /* how modes draw */
    cw_sampling sampling;          /* of rays and slices */
    cw_intensity_look intensity;   /* of mip, minip, average, local-mip */
    cw_texture_look texture;       /* of texture, shaded-texture */
    cw_vbuffer_look vbuffer;       /* of vbuffer */
    cw_projection_look projection; /* of projection */
    cw_splat_look splat;           /* of splat, splat-tree */
    cw_mesh_look mesh_look;        /* of meshes, in any mode */

    /* slices */
    cw_slice slices[CW_MAX_SLICES]; /* slice_count of them */
    size_t slice_count;             /* default: axial, coronal, sagittal through the middle */

    int threads;          /* default: one per processor */
    cw_progress progress; /* default: none. Called every few milliseconds, except while GL
                             compiles a shader or allocates a volume. A cancelled picture leaves
                             its uploads in place, and the next picture is as usual. The report
                             runs with the EGL context that the caller of cw_render() had. It
                             may draw with any context, by EGL, also with another renderer, but
                             not with this one */
} cw_scene;

/* A renderer. It keeps the uploads of a scene for the next picture of it. */
typedef struct cw_renderer cw_renderer;

/* Makes a renderer.
 * backend   the backend that draws
 * renderer  set to the renderer; free it with cw_renderer_free()
 * Returns   CW_ERR_UNSUPPORTED  this build has no GL, the machine has no driver, or none with
 *                               OpenGL 3.3: the message names the packages; CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_renderer_new(cw_backend backend, cw_renderer **renderer,
                                              cw_error *err);

/* Frees a renderer and its uploads. Harmless on NULL. */
CW_API void cw_renderer_free(cw_renderer *renderer);

/* Returns the name of the device that drew the last picture, or before the first will draw:
 * "CPU", or the name that GL reports. Valid as long as the renderer.
 * renderer  borrowed */
CW_API const char *cw_renderer_name(const cw_renderer *renderer);

/* Draws a scene. Deterministic: the same scene gives the same picture on the same machine, and
 * on the CPU on any machine.
 *
 * picture  filled on success, emptied on failure; free it with cw_picture_free()
 * Returns  CW_ERR_ARGUMENT     an input of the mode is missing or out of range
 *          CW_ERR_UNSUPPORTED  the mode is not one of the backend's, or does not draw the
 *                              volume's kind of grid; a live surface cannot be had here
 *          CW_ERR_BACKEND      GL failed or its context was lost: make another renderer
 *          CW_ERR_LIMIT        also: a live surface is larger than OpenGL holds
 *          CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD CW_API cw_status cw_render(cw_renderer *renderer, const cw_scene *scene,
                                        cw_picture *picture, cw_error *err);

/* Begins what a live surface needs on the GPU: its shaders and the volume's voxels. Does not wait
 * for shaders that the driver compiles meanwhile; some drivers link one in the call. Not needed
 * before cw_render(), which waits for all: some seconds, the first time on a machine.
 *
 * live     borrowed; the volume's voxels are read now or in a later call
 * ready    set to true when cw_render() would draw the surface without such a wait
 * Returns  as cw_render() of a scene with the surface, where it cannot be had */
CW_NODISCARD CW_API cw_status cw_renderer_prepare(cw_renderer *renderer,
                                                  const cw_live_surface *live, bool *ready,
                                                  cw_error *err);

/* The kind of object that a pixel of a picture shows. */
typedef enum cw_pick_kind {
    CW_PICK_NOTHING,
    CW_PICK_VOLUME,
    CW_PICK_SLICE,
    CW_PICK_MESH
} cw_pick_kind;

/* The point that a pixel shows. */
typedef struct cw_picked {
    cw_pick_kind kind; /* CW_PICK_NOTHING: all below is 0 */
    double point[3];   /* in the world, LPS millimetres */
    double depth_mm;   /* before the eye, along the camera's line of sight */
    double value;      /* of the volume; of a mesh its scalar, NaN without scalars */
    size_t number;     /* of the slice or the triangle; SIZE_MAX: a cut that cap fills */
} cw_picked;

/* Finds the point that a scene shows at a pixel, as cw_render() would draw it, without drawing.
 * It is the nearest point of mesh, slices and volume that is not clipped. In a volume it is the
 * point where
 *  - the modes that blend reach half of full opacity, by rays as those of reference. Where they
 *    do not, it is the middle of the cell that covers most, if the whole ray covers 1/512 or
 *    more. Cells that shaded-texture's mark_boundary leaves out are included here;
 *  - mip, minip and local-mip find their value for the first time; average: the highest value.
 * A mesh behind that point is picked if the volume before it covers less than half. A
 * translucent mesh is picked like an opaque one.
 *
 * pixel    from the picture's upper left corner, y down
 * picked   filled on success
 * Returns  as cw_render(), and CW_ERR_ARGUMENT for a pixel that is not a number
 * Cost     in proportion to the triangles (a million: some 10 ms), and to the cells met */
CW_NODISCARD CW_API cw_status cw_pick(const cw_scene *scene, const double pixel[2],
                                      cw_picked *picked, cw_error *err);

/* Makes the orthographic camera that looks straight at a slice and sees all of it. aspect is
 * the picture's width over its height. With this camera the mode slices draws that slice flat.
 * Directions are those of radiology. Axial slices are seen from the feet, with the patient's
 * right on the picture's left and the front up. Coronal ones are seen from the front, right on
 * the left, the head up. Sagittal ones are seen from the left, the front on the picture's left,
 * the head up. Oblique ones are seen like those they are closest to.
 * slice    borrowed
 * aspect   above 0
 * Returns  CW_ERR_ARGUMENT for a slice that misses the volume or has no direction, for an
 * invalid aspect, and as cw_volume_resolve(). */
CW_NODISCARD CW_API cw_status cw_slice_camera(const cw_volume *volume, const cw_slice *slice,
                                              double aspect, cw_camera *camera, cw_error *err);

/* Makes a renderer forget the voxels and vertices that it has drawn. Call it after they were
 * changed or freed, since the renderer knows them by their address. */
CW_API void cw_renderer_forget(cw_renderer *renderer);

/* Options of drawing a mesh alone. Zero-initialise the struct; a zero field means the default
 * named beside it. */
typedef struct cw_render_mesh_desc {
    uint32_t version;         /* 0: the first version of this struct */
    cw_camera camera;         /* default (up all 0): front view of the whole mesh, 30 degrees */
    size_t width, height;     /* pixels, at most 16384; default 1280 x 720 */
    int samples;              /* a side: 1 to 4 squared samples a pixel; default 2 */
    uint8_t color[4];         /* sRGB of a mesh without colours; default a bone white */
    uint8_t background[2][4]; /* top and bottom, sRGB and alpha; all 0: a light gradient. For a
                               * transparent one give any colour and alpha 0 */
    double *depth_mm; /* not NULL: filled with height x width depths, along the line of sight,
                         of what is seen; INFINITY: nothing is. One sample a pixel only */
    bool same_inside; /* as in cw_scene; default: the inside is red */
    int threads;      /* default: one per processor */
    cw_progress progress; /* default: none */
} cw_render_mesh_desc;

/* Draws a mesh on the CPU in double precision, without OpenGL: the nearest surface, lit on both
 * sides. Back faces are tinted red, unless same_inside, so that an open or inside-out surface
 * shows. A mesh without
 * normals is drawn with the normals of its triangles.
 *
 * image    filled on success, emptied on failure; free it with cw_image_free()
 * Returns  CW_ERR_ARGUMENT  as cw_mesh_check() and cw_camera_axes(); sizes out of range
 *          CW_ERR_NO_MEMORY; CW_ERR_CANCELLED
 * Cost     in proportion to the triangles and to the samples they cover
 * Threads  reentrant; the same bytes for any number of threads */
CW_NODISCARD CW_API cw_status cw_render_mesh(const cw_mesh *mesh,
                                             const cw_render_mesh_desc *desc, cw_image *image,
                                             cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
