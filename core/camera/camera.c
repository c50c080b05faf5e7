/* Names the standard views, fits cameras to boxes, and turns and zooms cameras. */
#include <cubewright/camera.h>

#include "core/base/status.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* The views' directions of sight, in LPS: +x is the patient's left, +y the back, +z the
 * head. */
static const struct {
    const char *name;
    double forward[3], up[3];
} views[] = {
    {"front", {0, 1, 0}, {0, 0, 1}},         {"back", {0, -1, 0}, {0, 0, 1}},
    {"left", {-1, 0, 0}, {0, 0, 1}},         {"right", {1, 0, 0}, {0, 0, 1}},
    {"top", {0, 0, -1}, {0, -1, 0}},         {"bottom", {0, 0, 1}, {0, -1, 0}},
    {"iso", {-0.5, 0.75, -0.45}, {0, 0, 1}},
};

enum { VIEW_COUNT = sizeof views / sizeof *views };

const char *cw_view_name(size_t n)
{
    return n < VIEW_COUNT ? views[n].name : NULL;
}

cw_status cw_camera_axes(const cw_camera *camera, double right[3], double up[3],
                         double forward[3], cw_error *err)
{
    CWI_REQUIRE(err, camera, right, up, forward);
    cwi_sub(camera->target, camera->eye, forward);
    if (!cwi_to_unit(forward))
        return cwi_fail(err, CW_ERR_ARGUMENT, "the camera's eye and target must be apart");
    cwi_cross(forward, camera->up, right);
    if (!cwi_to_unit(right))
        return cwi_fail(err, CW_ERR_ARGUMENT, "the camera's up is along its line of sight");
    cwi_cross(right, forward, up);
    if (!(camera->fov_deg >= 0 && camera->fov_deg < 180))
        return cwi_fail(err, CW_ERR_ARGUMENT, "the camera opens %g degrees, not 0 to 180",
                        camera->fov_deg);
    if (camera->fov_deg == 0 && !(isnormal(camera->height_mm) && camera->height_mm > 0))
        return cwi_fail(err, CW_ERR_ARGUMENT, "the camera's picture is %g mm high",
                        camera->height_mm);
    return CW_OK;
}

static cw_status find_view(const char *name, int *view, cw_error *err)
{
    char list[128] = "";
    size_t used = 0;
    for (*view = 0; *view < VIEW_COUNT; ++*view) {
        if (strcmp(views[*view].name, name) == 0)
            return CW_OK;
        used += (size_t)snprintf(list + used, sizeof list - used, " %s", views[*view].name);
    }
    return cwi_fail(err, CW_ERR_ARGUMENT, "no view is named '%s'; there are%s", name, list);
}

/* Returns half the extent of the box along an axis; a box is symmetric. */
static double project_extent(const double half[3], const double axis[3])
{
    return fabs(half[0] * axis[0]) + fabs(half[1] * axis[1]) + fabs(half[2] * axis[2]);
}

/* Returns the distance from the box's middle at which the last corner enters the picture. */
static double perspective_distance(const double half[3], const double axes[3][3],
                                   const double slope[2])
{
    double distance = 1.01 * project_extent(half, axes[2]); /* the eye stays outside */
    for (int corner = 0; corner < 8; corner++) {
        double p[3];
        for (int a = 0; a < 3; a++)
            p[a] = corner >> a & 1 ? half[a] : -half[a];
        for (int a = 0; a < 2; a++)
            distance =
                fmax(distance, fabs(cwi_dot(p, axes[a])) / slope[a] - cwi_dot(p, axes[2]));
    }
    return distance;
}

static void place_camera(const cw_fit_desc *d, const double axes[3][3], cw_camera *camera)
{
    const double aspect = d->aspect > 0 ? d->aspect : 1, inner = 1 - 2 * d->margin;
    double half[3], distance;
    for (int a = 0; a < 3; a++) {
        half[a] = (d->max[a] - d->min[a]) / 2;
        camera->target[a] = d->min[a] + half[a];
    }
    if (half[0] + half[1] + half[2] == 0)
        half[0] = half[1] = half[2] = 0.5; /* a point: a picture of a millimetre around it */
    if (d->fov_deg > 0) {
        const double slope = tan(d->fov_deg * CWI_PI / 360) * inner;
        distance = perspective_distance(half, axes, (const double[2]){slope * aspect, slope});
    } else {
        const double tall =
            fmax(project_extent(half, axes[1]), project_extent(half, axes[0]) / aspect);
        camera->height_mm = 2 * tall / inner;
        distance = 2 * project_extent(half, axes[2]) + camera->height_mm;
    }
    for (int a = 0; a < 3; a++)
        camera->eye[a] = camera->target[a] - distance * axes[2][a];
}

/* Turns a vector about an axis of unit length (Rodrigues' formula). */
static void rotate_vector(double v[3], const double axis[3], double degrees)
{
    const double angle = degrees * CWI_PI / 180, c = cos(angle), s = sin(angle);
    const double along = cwi_dot(axis, v) * (1 - c);
    double across[3];
    cwi_cross(axis, v, across);
    for (int a = 0; a < 3; a++)
        v[a] = c * v[a] + s * across[a] + along * axis[a];
}

/* Turns a view's directions by azimuth and elevation. */
static cw_status turn_view(const cw_fit_desc *d, double forward[3], double up[3], cw_error *err)
{
    double right[3];
    if (!isfinite(d->azimuth_deg))
        return cwi_fail(err, CW_ERR_ARGUMENT, "an azimuth of %g is no angle", d->azimuth_deg);
    if (!(d->elevation_deg >= -90 && d->elevation_deg <= 90))
        return cwi_fail(err, CW_ERR_ARGUMENT, "an elevation of %g degrees, not -90 to 90",
                        d->elevation_deg);
    cwi_cross(forward, up, right); /* the up of some views is not perpendicular */
    cwi_cross(right, forward, up);
    cwi_to_unit(up);
    rotate_vector(forward, up, d->azimuth_deg);
    cwi_cross(forward, up, right);
    cwi_to_unit(right);
    rotate_vector(forward, right, -d->elevation_deg);
    rotate_vector(up, right, -d->elevation_deg);
    return CW_OK;
}

cw_status cw_camera_turn(cw_camera *camera, const double axis[3], double degrees, cw_error *err)
{
    CWI_REQUIRE(err, camera, axis);
    double unit[3], arm[3];
    memcpy(unit, axis, sizeof unit);
    if (!cwi_to_unit(unit) || !isfinite(degrees))
        return cwi_fail(err, CW_ERR_ARGUMENT, "a turn of %g degrees about (%g, %g, %g)",
                        degrees, axis[0], axis[1], axis[2]);
    cwi_sub(camera->eye, camera->target, arm);
    rotate_vector(arm, unit, degrees);
    rotate_vector(camera->up, unit, degrees);
    for (int a = 0; a < 3; a++)
        camera->eye[a] = camera->target[a] + arm[a];
    return CW_OK;
}

cw_status cw_camera_zoom(cw_camera *camera, double factor, cw_error *err)
{
    CWI_REQUIRE(err, camera);
    const double half = CWI_PI / 360;
    if (!(isnormal(factor) && factor > 0))
        return cwi_fail(err, CW_ERR_ARGUMENT, "a zoom of %g: above 0 was expected", factor);
    camera->fov_deg = atan(tan(camera->fov_deg * half) / factor) / half;
    camera->height_mm /= factor;
    return CW_OK;
}

cw_status cw_camera_fit(const cw_fit_desc *desc, cw_camera *camera, cw_error *err)
{
    CWI_REQUIRE(err, desc, camera);
    CWI_REQUIRE_VERSION(err, desc, 0);
    int view;
    double axes[3][3]; /* right, up, forward */
    cw_camera c = {.fov_deg = desc->fov_deg, .height_mm = 1};
    cw_status st = find_view(desc->view ? desc->view : "front", &view, err);
    if (st != CW_OK)
        return st;
    if (!(desc->margin >= 0 && desc->margin < 0.5))
        return cwi_fail(err, CW_ERR_ARGUMENT, "a margin of %g leaves no picture", desc->margin);
    memcpy(c.target, views[view].forward, sizeof c.target);
    memcpy(c.up, views[view].up, sizeof c.up);
    if (desc->azimuth_deg != 0 || desc->elevation_deg != 0)
        st = turn_view(desc, c.target, c.up, err);
    if (st == CW_OK)
        st = cw_camera_axes(&c, axes[0], axes[1], axes[2], err);
    if (st == CW_OK) {
        place_camera(desc, (const double(*)[3])axes, &c);
        *camera = c;
    }
    return st;
}
