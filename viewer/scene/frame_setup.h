/* A scene resolved for one picture: the data with which the CPU and GL draw the same thing.
 *
 * Eye space has its origin at the eye, x to the right, y up and z towards the eye; its unit is
 * the volume's smallest spacing, so that single precision is enough for scenes of any size and
 * place. On a rectilinear grid it is the smallest mean spacing, on an irregular one the edge of
 * the mean cell, and without a volume 1/256 of the mesh's diagonal. */
#ifndef VIEWER_SCENE_FRAME_SETUP_H
#define VIEWER_SCENE_FRAME_SETUP_H

#include <cubewright/render.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cwi_frame {
    cw_scene scene;   /* defaults filled in; width and height are samples, not pixels */
    cw_volume volume; /* resolved; data is NULL when there is none */
    double unit_mm;   /* of eye space */
    double axes[3][3], eye_mm[3]; /* of the camera in the world: right, up, to the eye; unit */

    /* Index space: voxel (i, j, k) is the point (i, j, k), on a rectilinear grid the point of its
     * coordinates, and on an irregular one sample n is point n. The volume reaches from low to
     * high: from 0 to dim - 1, along an axis of one voxel 0.5 to both sides. */
    double low[3], high[3];
    double eye_from_index[12], index_from_eye[12]; /* affines, 3x4 */

    /* The picture in eye space: a ray through sample (x, y) of the picture, y down, starts at
     * origin and goes along direction, of unit length. Perspective: half[] is the slope of the
     * picture's edges; else half its size. */
    bool perspective;
    double half[2];

    /* Neither lights nor a material were given: meshes are lit as in reference_mesh.c. */
    bool studio_light;

    /* Range of distances from the eye's plane (depths) that contains the whole scene; near is
     * above 0 in perspective. */
    double near, far;

    /* The depth cue: where it starts and ends, and the decay per unit of an exponential one. */
    double cue_start, cue_end, cue_decay;

    /* The transfer function: extinction is per unit of eye space. */
    cw_transfer transfer;
    bool is_reference; /* an exact picture was requested, of scene.mode: an intensity projection
                             has its own mode here */
    double opacity_units; /* length to which the transfer function's opacities refer */

    /* Gradients are those of this volume, on the same grid: `volume` itself, or its indices,
     * smoothed or not; see gradient_volume.h. */
    cw_volume gradient_volume;
    size_t gradient_version; /* 0: it is `volume`; else another number for other contents */
    const float *shadows;  /* of the volume's voxels, 0 to 1, x fastest; NULL: there are none */
    size_t shadow_version; /* another number for other contents */
    double surface; /* length, in units, over which an index changes by 1 at a surface of full
                       strength; 0: there are no indices, and all surfaces are of that */

    /* Planes that clip, in eye space: n . p >= d is kept. */
    double clips[CW_MAX_CLIPS][4];
    uint32_t faces; /* bit n: plane n cuts the volume, and is lit as a face */
} cwi_frame;

/* Standard deviations of a linear and a cubic B-spline with steps of 1. */
#define CWI_TENT_WIDTH     0.40824829046386302
#define CWI_B_SPLINE_WIDTH 0.57735026918962576

/* Resolves a scene: fills in defaults, and checks the conditions of all modes. Returns
 * CW_ERR_ARGUMENT, CW_ERR_UNSUPPORTED as cw_render(). */
CW_NODISCARD cw_status cwi_frame_init(cwi_frame *frame, const cw_scene *scene, cw_error *err);

/* Computes the ray through a point of the picture, in samples from its upper left corner, in
 * eye space. Distances along it are in units of eye space. */
void cwi_frame_ray(const cwi_frame *frame, double x, double y, double origin[3],
                   double direction[3]);

/* Finds the parts of a ray inside the volume's box that clip planes keep: up to two intervals,
 * in order; returns their number. The ray is in eye space. */
int cwi_frame_clip(const cwi_frame *frame, const double origin[3], const double direction[3],
                   double intervals[2][2]);

/* Cuts an interval to where at + t slope >= 0. */
void cwi_cut_interval(double at, double slope, double t[2]);

/* Finds the parts of an interval of a ray that clip planes keep: up to two, in order; returns
 * their number. */
int cwi_frame_keep(const cwi_frame *frame, const double origin[3], const double direction[3],
                   const double interval[2], double kept[2][2]);

/* Converts a point in eye space to the world. */
void cwi_frame_to_world(const cwi_frame *frame, const double eye[3], double world[3]);

/* Returns the extinction coefficient, per unit of eye space, of an opacity of the transfer
 * function. The opacity is limited to CWI_MAX_OPACITY. */
#define CWI_MAX_OPACITY (1 - 1e-6)
double cwi_frame_extinction(const cwi_frame *frame, double opacity);

/* Returns true if light or the transfer function needs gradients. */
bool cwi_frame_needs_gradients(const cwi_frame *frame);

/* Returns the strength of a surface, 0 to 1, where the gradient has a length, per unit. */
double cwi_frame_surface_strength(const cwi_frame *frame, double length);

/* Returns the transfer function's factor of the extinction for a length of the gradient. */
double cwi_frame_gradient_factor(const cwi_frame *frame, double length);

/* Returns the fraction of light that is left at a depth: 1 at the cue's start, 1 - depth_cue at
 * its end. */
double cwi_frame_cue(const cwi_frame *frame, double depth);

/* Computes the matrix that takes a gradient in index space (per voxel) to eye space (per
 * unit). */
void cwi_frame_gradient_matrix(const cwi_frame *frame, double m[3][3]);

#ifdef __cplusplus
}
#endif

#endif
