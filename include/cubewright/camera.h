/* Where a picture is taken from. World frame: LPS millimetres. */
#ifndef CUBEWRIGHT_CAMERA_H
#define CUBEWRIGHT_CAMERA_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cw_camera {
    double eye[3], target[3];
    double up[3];     /* any length, not along the line of sight */
    double fov_deg;   /* vertical opening angle; 0: orthographic */
    double height_mm; /* orthographic only: what the picture's height covers */
} cw_camera;

/* What a fitted camera has to see. */
typedef struct cw_fit_desc {
    const char *view; /* a cw_view_name(); default "front" */
    double min[3], max[3];
    double aspect;        /* width / height of the picture; 0 means 1 */
    double fov_deg;       /* 0: orthographic */
    double margin;        /* share of the picture left free on each side, below 0.5 */
    double azimuth_deg;   /* how far the eye goes round from there to the picture's right, */
    double elevation_deg; /* and then up: -90 to 90 */
} cw_fit_desc;

/* The name of the n-th view; NULL after the last. They are front (seen from the patient's
 * front), back, left, right, top, bottom and iso. Heads are up, and a patient seen from the
 * front has the left hand on the picture's right; from above and below the front is up. */
CW_API const char *cw_view_name(size_t n);

/* The camera of a view that sees a whole box, as large as the margin allows.
 * Returns CW_ERR_ARGUMENT for an unknown view, an unusable angle or margin. */
CW_NODISCARD CW_API cw_status cw_camera_fit(const cw_fit_desc *desc, cw_camera *camera,
                                            cw_error *err);

/* The picture's axes in the world, unit length. Returns CW_ERR_ARGUMENT when eye and target
 * coincide, up is along the line of sight, or angle and height make no picture. */
CW_NODISCARD CW_API cw_status cw_camera_axes(const cw_camera *camera, double right[3],
                                             double up[3], double forward[3], cw_error *err);

/* Moves the eye around the target, to the picture's right, by an angle about an axis through
 * the target; up turns with it.
 * Returns CW_ERR_ARGUMENT for an axis without a direction and an angle that is no number. */
CW_NODISCARD CW_API cw_status cw_camera_turn(cw_camera *camera, const double axis[3],
                                             double degrees, cw_error *err);

/* What is in the picture's middle becomes so many times as large; the eye stays where it is.
 * Returns CW_ERR_ARGUMENT for a factor that is not above 0. */
CW_NODISCARD CW_API cw_status cw_camera_zoom(cw_camera *camera, double factor, cw_error *err);

/* What is at the target becomes so many times as large, and nothing opens wider: the eye comes
 * nearer; of an orthographic camera the picture's height shrinks.
 * Returns CW_ERR_ARGUMENT for a factor that is not above 0. */
CW_NODISCARD CW_API cw_status cw_camera_dolly(cw_camera *camera, double factor, cw_error *err);

/* Moves the eye around the target: to the picture's right, and up. As on a turntable, heads
 * stay up: the axis is that of the camera's up, and of a camera that holds its picture level,
 * the head's (z). Straight above and below is as far as it goes. The camera's up is the axis
 * then. Returns CW_ERR_ARGUMENT as cw_camera_axes(), and for what is no angle. */
CW_NODISCARD CW_API cw_status cw_camera_orbit(cw_camera *camera, double right_deg,
                                              double up_deg, cw_error *err);

/* What is seen turns clockwise about the picture's middle.
 * Returns CW_ERR_ARGUMENT as cw_camera_axes(), and for what is no angle. */
CW_NODISCARD CW_API cw_status cw_camera_roll(cw_camera *camera, double degrees, cw_error *err);

/* Moves eye and target, so that what is as far away as the target goes right and down by so
 * many pixels, of which the picture is height high. Returns CW_ERR_ARGUMENT as
 * cw_camera_axes(), for a height of 0 and what is no way. */
CW_NODISCARD CW_API cw_status cw_camera_pan(cw_camera *camera, size_t height, double right_px,
                                            double down_px, cw_error *err);

/* Where a picture of that size shows a world point: in pixels from its upper left corner, y
 * down, and how far before the eye, along the line of sight (depth_mm may be NULL).
 * False when it does not: the point is behind the eye of a perspective camera, the picture has
 * no pixels, the camera is none. */
CW_API bool cw_camera_project(const cw_camera *camera, size_t width, size_t height,
                              const double point[3], double pixel[2], double *depth_mm);

/* The line of sight through a place on such a picture, the other way round: from the eye, of an
 * orthographic camera from the plane it is in, in a direction of unit length.
 * Returns CW_ERR_ARGUMENT as cw_camera_axes(), and for a picture without pixels. */
CW_NODISCARD CW_API cw_status cw_camera_ray(const cw_camera *camera, size_t width,
                                            size_t height, const double pixel[2],
                                            double origin[3], double direction[3],
                                            cw_error *err);

/* A camera as JSON, in a file or as text, with either of the last two; numbers are read back to
 * the bit:
 *     {"schema": "cubewright-camera-1", "eye": [0, -500, 0], "target": [0, 0, 0],
 *      "up": [0, 0, 1], "fov_deg": 30, "height_mm": 200}
 * text     as it is in a file, of at most CW_CAMERA_TEXT bytes with the 0 at its end when it is
 *          written
 * Returns  CW_ERR_IO; CW_ERR_FORMAT, with the line or the field that is wrong; CW_ERR_OUTPUT;
 *          CW_ERR_ARGUMENT for a camera that is none, as cw_camera_axes() */
enum { CW_CAMERA_TEXT = 1024 };
CW_NODISCARD CW_API cw_status cw_camera_read(const char *path, cw_camera *camera,
                                             cw_error *err);
CW_NODISCARD CW_API cw_status cw_camera_write(const char *path, const cw_camera *camera,
                                              cw_error *err);
CW_NODISCARD CW_API cw_status cw_camera_parse(const char *text, cw_camera *camera,
                                              cw_error *err);
CW_NODISCARD CW_API cw_status cw_camera_format(const cw_camera *camera,
                                               char text[CW_CAMERA_TEXT], cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
