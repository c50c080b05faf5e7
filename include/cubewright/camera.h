/* Cameras: the place, direction and opening from which a picture is taken. The world frame is
 * LPS millimetres. */
#ifndef CUBEWRIGHT_CAMERA_H
#define CUBEWRIGHT_CAMERA_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A camera: an eye that looks at a target. Zeroed: no camera yet, see cw_camera_fit(). */
typedef struct cw_camera {
    double eye[3], target[3]; /* places in the world */
    double up[3];             /* any length, not along the line of sight */
    double fov_deg;           /* vertical opening angle; 0: orthographic */
    double height_mm;         /* orthographic only: what the picture's height covers */
} cw_camera;

/* The view, box and margin to which cw_camera_fit() fits a camera. */
typedef struct cw_fit_desc {
    uint32_t version;      /* 0: the first version of this struct */
    const char *view;      /* a cw_view_name(); default "front" */
    double min[3], max[3]; /* corners of the box, in the world */
    double aspect;         /* width / height of the picture; 0 means 1 */
    double fov_deg;        /* 0: orthographic */
    double margin;         /* share of the picture left free on each side, below 0.5 */
    double azimuth_deg;    /* turns the eye from the view to the picture's right */
    double elevation_deg;  /* then turns the eye up; -90 to 90 */
} cw_fit_desc;

/* Returns the name of the n-th view; NULL after the last. The names are front (seen from the
 * patient's front), back, left, right, top, bottom and iso. Heads are up, and a patient seen
 * from the front has the left hand on the picture's right. From above and below the front is
 * up. */
CW_API const char *cw_view_name(size_t n);

/* Makes the camera of a view that sees a whole box, as large as the margin allows.
 * Returns CW_ERR_ARGUMENT for an unknown view, an unusable angle or margin. */
CW_NODISCARD CW_API cw_status cw_camera_fit(const cw_fit_desc *desc, cw_camera *camera,
                                            cw_error *err);

/* Computes the picture's axes in the world, of unit length.
 * right, up, forward  set to the axes
 * Returns             CW_ERR_ARGUMENT when eye and target coincide, when up is along the
 *                     line of sight, or when angle and height make no picture. */
CW_NODISCARD CW_API cw_status cw_camera_axes(const cw_camera *camera, double right[3],
                                             double up[3], double forward[3], cw_error *err);

/* Moves the eye around the target, to the picture's right, by an angle. The axis goes through
 * the target; up turns with the eye.
 * axis     in the world, of any length but 0
 * Returns  CW_ERR_ARGUMENT for an axis without a direction or an angle that is not a number. */
CW_NODISCARD CW_API cw_status cw_camera_turn(cw_camera *camera, const double axis[3],
                                             double degrees, cw_error *err);

/* Magnifies the middle of the picture by a factor; the eye stays where it is.
 * Returns CW_ERR_ARGUMENT for a factor that is not above 0. */
CW_NODISCARD CW_API cw_status cw_camera_zoom(cw_camera *camera, double factor, cw_error *err);

/* Magnifies the target by a factor while the opening angle stays the same: the eye comes
 * nearer. For an orthographic camera the height of the picture shrinks instead.
 * Returns CW_ERR_ARGUMENT for a factor that is not above 0. */
CW_NODISCARD CW_API cw_status cw_camera_dolly(cw_camera *camera, double factor, cw_error *err);

/* Moves the eye around the target: to the picture's right, and up. Heads stay up, as on a
 * turntable. The axis is the camera's up; for a camera that holds its picture level it is the
 * head's axis (z). The eye stops straight above and straight below; the axis is then the
 * camera's up.
 * right_deg, up_deg  angles in degrees
 * Returns            CW_ERR_ARGUMENT as cw_camera_axes(), and for an angle that is not a
 *                    number. */
CW_NODISCARD CW_API cw_status cw_camera_orbit(cw_camera *camera, double right_deg,
                                              double up_deg, cw_error *err);

/* Turns the picture's content clockwise about the middle of the picture.
 * Returns CW_ERR_ARGUMENT as cw_camera_axes(), and for an angle that is not a number. */
CW_NODISCARD CW_API cw_status cw_camera_roll(cw_camera *camera, double degrees, cw_error *err);

/* Moves eye and target so that points at the target's distance go right and down by some
 * pixels. The picture is height pixels high.
 * right_px, down_px  distances in pixels
 * Returns            CW_ERR_ARGUMENT as cw_camera_axes(), for a height of 0, and for
 *                    distances that are not numbers. */
CW_NODISCARD CW_API cw_status cw_camera_pan(cw_camera *camera, size_t height, double right_px,
                                            double down_px, cw_error *err);

/* Finds the pixel at which a picture of that size shows a world point. Pixels count from the
 * upper left corner, y down. depth_mm is the point's distance before the eye along the line of
 * sight; it may be NULL. Returns false when the picture does not show the point: it is behind
 * the eye of a perspective camera, the picture has no pixels, or the camera is invalid.
 * pixel     set to column and row; a pixel's middle is at 0.5
 * depth_mm  may be NULL */
CW_API bool cw_camera_project(const cw_camera *camera, size_t width, size_t height,
                              const double point[3], double pixel[2], double *depth_mm);

/* Computes the line of sight through a pixel of such a picture, the inverse of
 * cw_camera_project(). It starts at the eye, or for an orthographic camera in the eye's plane;
 * its direction has unit length.
 * pixel              column and row
 * origin, direction  set to a point and a unit vector in the world
 * Returns            CW_ERR_ARGUMENT as cw_camera_axes(), and for a picture without pixels. */
CW_NODISCARD CW_API cw_status cw_camera_ray(const cw_camera *camera, size_t width,
                                            size_t height, const double pixel[2],
                                            double origin[3], double direction[3],
                                            cw_error *err);

/* Computes the camera of a smooth path through key cameras, at a time. The path goes through each
 * key, to the bit; it rests at the first and the last, which also hold before and after. Target,
 * and the logarithms of the distance and of the opening, stay between those of the keys around;
 * the directions turn along a blend of quaternions.
 * keys, times  count of each; times rise, in any unit; all keys have a perspective, or none has
 * time         in the unit of times
 * camera       set to the camera at that time; as it was on failure
 * Returns      CW_ERR_ARGUMENT  no key; times that do not rise or are not finite; keys of both
 *                               kinds; as cw_camera_axes()
 * Source       monotone cubics [Fritsch1980], [Steffen1990]: core/README.md */
CW_NODISCARD CW_API cw_status cw_camera_path(const cw_camera *keys, const double *times,
                                             size_t count, double time, cw_camera *camera,
                                             cw_error *err);

enum { CW_CAMERA_TEXT = 1024 }; /* bytes that the text of a camera takes at most */

/* Reads or writes a camera as JSON: in a file, or as text with the last two functions.
 * Numbers are read back to the bit:
 *     {"schema": "cubewright-camera-1", "eye": [0, -500, 0], "target": [0, 0, 0],
 *      "up": [0, 0, 1], "fov_deg": 30, "height_mm": 200}
 * text     as in a file; when written, at most CW_CAMERA_TEXT bytes with the final 0
 * Returns  CW_ERR_IO; CW_ERR_FORMAT, with the line or the field that is wrong; CW_ERR_OUTPUT;
 *          CW_ERR_ARGUMENT for an invalid camera, as cw_camera_axes() */
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
