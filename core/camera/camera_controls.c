/* Projects points and rays through a camera, and moves it: pan, orbit, roll and dolly. */
#include <cubewright/camera.h>

#include "core/base/status.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

typedef struct axes {
    double right[3], up[3], forward[3];
} axes;

static cw_status find_axes(const cw_camera *camera, axes *a, cw_error *err)
{
    return cw_camera_axes(camera, a->right, a->up, a->forward, err);
}

/* Returns half of the picture's height; in perspective at one millimetre before the eye. */
static double half_height(const cw_camera *c)
{
    return c->fov_deg > 0 ? tan(c->fov_deg * CWI_PI / 360) : c->height_mm / 2;
}

static double target_distance(const cw_camera *c)
{
    return hypot(hypot(c->target[0] - c->eye[0], c->target[1] - c->eye[1]),
                 c->target[2] - c->eye[2]);
}

bool cw_camera_project(const cw_camera *camera, size_t width, size_t height,
                       const double point[3], double pixel[2], double *depth_mm)
{
    if (!camera || !point || !pixel)
        return false;
    axes a;
    if (width == 0 || height == 0 || find_axes(camera, &a, NULL) != CW_OK)
        return false;
    const double from_eye[3] = {point[0] - camera->eye[0], point[1] - camera->eye[1],
                                point[2] - camera->eye[2]};
    const double depth = cwi_dot(from_eye, a.forward);
    if (camera->fov_deg > 0 && !(depth > 0))
        return false;
    const double half = half_height(camera) * (camera->fov_deg > 0 ? depth : 1);
    const double scale = (double)height / (2 * half);
    pixel[0] = (double)width / 2 + scale * cwi_dot(from_eye, a.right);
    pixel[1] = (double)height / 2 - scale * cwi_dot(from_eye, a.up);
    if (depth_mm)
        *depth_mm = depth;
    return isfinite(pixel[0]) && isfinite(pixel[1]);
}

static cw_status check_size(size_t width, size_t height, cw_error *err)
{
    return width > 0 && height > 0
               ? CW_OK
               : cwi_fail(err, CW_ERR_ARGUMENT, "a picture of %zu x %zu pixels has no inside",
                          width, height);
}

cw_status cw_camera_ray(const cw_camera *camera, size_t width, size_t height,
                        const double pixel[2], double origin[3], double direction[3],
                        cw_error *err)
{
    CWI_REQUIRE(err, camera, pixel, origin, direction);
    axes a;
    cw_status st = check_size(width, height, err);
    if (st == CW_OK)
        st = find_axes(camera, &a, err);
    if (st != CW_OK)
        return st;
    const double scale = 2 * half_height(camera) / (double)height;
    const double x = scale * (pixel[0] - (double)width / 2),
                 y = scale * ((double)height / 2 - pixel[1]);
    const bool flat = camera->fov_deg == 0;
    const double length = flat ? 1 : sqrt(x * x + y * y + 1);
    for (int i = 0; i < 3; i++) {
        const double across = x * a.right[i] + y * a.up[i];
        origin[i] = camera->eye[i] + (flat ? across : 0);
        direction[i] = (a.forward[i] + (flat ? 0 : across)) / length;
    }
    return CW_OK;
}

cw_status cw_camera_pan(cw_camera *camera, size_t height, double right_px, double down_px,
                        cw_error *err)
{
    CWI_REQUIRE(err, camera);
    axes a;
    cw_status st = check_size(1, height, err);
    if (st == CW_OK && !(isfinite(right_px) && isfinite(down_px)))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "a way of %g, %g pixels", right_px, down_px);
    if (st == CW_OK)
        st = find_axes(camera, &a, err);
    if (st != CW_OK)
        return st;
    const double depth = camera->fov_deg > 0 ? target_distance(camera) : 1;
    const double scale = 2 * half_height(camera) * depth / (double)height;
    for (int i = 0; i < 3; i++) {
        const double displacement = scale * (down_px * a.up[i] - right_px * a.right[i]);
        camera->eye[i] += displacement;
        camera->target[i] += displacement;
    }
    return CW_OK;
}

/* Finds the axis of an orbit. An up that is not perpendicular to the line of sight is itself
 * the axis. A perpendicular up may be just the picture's (as those of cw_camera_fit() are). If
 * the picture is level, the axis is then z, so that heads stay up. */
static void find_turning_axis(const cw_camera *c, const axes *a, double axis[3])
{
    static const double LEVEL_TOLERANCE = 1e-6; /* sine of an angle that is rounding */
    const double lean = cwi_dot(c->up, a->forward) / cwi_length(c->up);
    memcpy(axis, c->up, 3 * sizeof *axis);
    if (fabs(lean) > LEVEL_TOLERANCE || fabs(a->right[2]) > LEVEL_TOLERANCE)
        return;
    axis[0] = axis[1] = 0;
    axis[2] = a->up[2] < -LEVEL_TOLERANCE ? -1 : 1;
}

/* Limits the climb of the eye: it stops just before the pole, where up and line of sight would
 * meet. */
static double clamp_climb(const axes *a, const double axis[3], double degrees)
{
    static const double MAX_ELEVATION_DEG = 90 - 1e-4;
    double level[3];
    cwi_cross(a->forward, axis, level);
    const double now = atan2(-cwi_dot(a->forward, axis), cwi_length(level));
    const double elevation = now * 180 / CWI_PI;
    return fmin(fmax(elevation + degrees, -MAX_ELEVATION_DEG), MAX_ELEVATION_DEG) - elevation;
}

cw_status cw_camera_orbit(cw_camera *camera, double right_deg, double up_deg, cw_error *err)
{
    CWI_REQUIRE(err, camera);
    axes a;
    double axis[3];
    cw_camera c = *camera;
    cw_status st = find_axes(camera, &a, err);
    if (st == CW_OK && !(isfinite(right_deg) && isfinite(up_deg)))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "an orbit of %g and %g degrees", right_deg, up_deg);
    if (st != CW_OK || (right_deg == 0 && up_deg == 0))
        return st;
    find_turning_axis(&c, &a, axis);
    st = cw_camera_turn(&c, a.right, -clamp_climb(&a, axis, up_deg), err);
    if (st == CW_OK)
        st = cw_camera_turn(&c, axis, right_deg, err);
    if (st == CW_OK) {
        memcpy(c.up, axis, sizeof c.up);
        *camera = c;
    }
    return st;
}

cw_status cw_camera_roll(cw_camera *camera, double degrees, cw_error *err)
{
    CWI_REQUIRE(err, camera);
    axes a;
    const double angle = degrees * CWI_PI / 180;
    cw_status st = find_axes(camera, &a, err);
    if (st == CW_OK && !isfinite(degrees))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "a roll of %g degrees", degrees);
    for (int i = 0; i < 3 && st == CW_OK; i++)
        camera->up[i] = cos(angle) * a.up[i] - sin(angle) * a.right[i];
    return st;
}

cw_status cw_camera_dolly(cw_camera *camera, double factor, cw_error *err)
{
    CWI_REQUIRE(err, camera);
    if (!(isnormal(factor) && factor > 0))
        return cwi_fail(err, CW_ERR_ARGUMENT, "%g times as near: above 0 was expected", factor);
    if (camera->fov_deg == 0) {
        camera->height_mm /= factor;
        return CW_OK;
    }
    for (int i = 0; i < 3; i++)
        camera->eye[i] = camera->target[i] + (camera->eye[i] - camera->target[i]) / factor;
    return CW_OK;
}
