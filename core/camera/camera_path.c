/* Computes cameras on a smooth path through key cameras, for films. */
#include <cubewright/camera.h>

#include "core/base/status.h"
#include "core/geometry/monotone_curve.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <string.h>

enum { AROUND = 4 }; /* keys that shape the path at one time: two on either side */

/* A camera as numbers that may be blended one by one: of a direction as a unit quaternion. */
typedef struct pose {
    double target[3], log_distance, log_opening, turn[4];
} pose;

/* The rotation from the world's axes to the picture's: Shepperd's choice of the largest part. */
static void find_rotation(double right[3], double up[3], double forward[3], double q[4])
{
    const double m[3][3] = {{right[0], up[0], -forward[0]},
                            {right[1], up[1], -forward[1]},
                            {right[2], up[2], -forward[2]}};
    const double trace = m[0][0] + m[1][1] + m[2][2];
    int largest = 0;
    for (int a = 1; a < 3; a++)
        largest = m[a][a] > m[largest][largest] ? a : largest;
    if (trace > m[largest][largest]) {
        const double w = 0.5 * sqrt(1 + trace);
        q[3] = w;
        for (int a = 0; a < 3; a++) {
            const int b = (a + 1) % 3, c = (a + 2) % 3;
            q[a] = (m[c][b] - m[b][c]) / (4 * w);
        }
        return;
    }
    const int a = largest, b = (a + 1) % 3, c = (a + 2) % 3;
    q[a] = 0.5 * sqrt(1 + m[a][a] - m[b][b] - m[c][c]);
    q[b] = (m[b][a] + m[a][b]) / (4 * q[a]);
    q[c] = (m[c][a] + m[a][c]) / (4 * q[a]);
    q[3] = (m[c][b] - m[b][c]) / (4 * q[a]);
}

static cw_status find_pose(const cw_camera *c, pose *p, cw_error *err)
{
    double axes[3][3], away[3];
    cw_status st = cw_camera_axes(c, axes[0], axes[1], axes[2], err);
    if (st != CW_OK)
        return st;
    cwi_sub(c->eye, c->target, away);
    memcpy(p->target, c->target, sizeof p->target);
    p->log_distance = log(hypot(hypot(away[0], away[1]), away[2]));
    p->log_opening = log(c->fov_deg > 0 ? c->fov_deg : c->height_mm);
    find_rotation(axes[0], axes[1], axes[2], p->turn);
    return CW_OK;
}

/* The camera of a pose, whose quaternion may have any length. */
static void make_camera(const pose *p, bool is_perspective, cw_camera *c)
{
    double length = 0, q[4];
    for (int a = 0; a < 4; a++)
        length += p->turn[a] * p->turn[a];
    for (int a = 0; a < 4; a++)
        q[a] = p->turn[a] / sqrt(length);
    const double x = q[0], y = q[1], z = q[2], w = q[3], distance = exp(p->log_distance);
    const double up[3] = {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)};
    const double back[3] = {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)};
    *c = (cw_camera){0};
    for (int a = 0; a < 3; a++) {
        c->target[a] = p->target[a];
        c->eye[a] = p->target[a] + distance * back[a];
        c->up[a] = up[a];
    }
    *(is_perspective ? &c->fov_deg : &c->height_mm) = exp(p->log_opening);
}

/* A quaternion and its negative are one rotation: chooses the one nearer to the key before. */
static void choose_nearer(const double before[4], double turn[4])
{
    double dot = 0;
    for (int a = 0; a < 4; a++)
        dot += before[a] * turn[a];
    for (int a = 0; a < 4 && dot < 0; a++)
        turn[a] = -turn[a];
}

/* A smooth path needs no more than two keys on either side of a time. */
static cw_status blend(const cw_camera *keys, const double *times, size_t count, double time,
                       cw_camera *camera, cw_error *err)
{
    enum { NUMBERS = sizeof(pose) / sizeof(double) };
    pose poses[AROUND], at;
    double values[AROUND], parts[NUMBERS];
    cw_status st = CW_OK;
    for (size_t n = 0; n < count && st == CW_OK; n++)
        st = find_pose(&keys[n], &poses[n], err);
    if (st != CW_OK)
        return st;
    for (size_t n = 1; n < count; n++)
        choose_nearer(poses[n - 1].turn, poses[n].turn);
    for (size_t k = 0; k < NUMBERS; k++) {
        for (size_t n = 0; n < count; n++) {
            memcpy(parts, &poses[n], sizeof parts);
            values[n] = parts[k];
        }
        ((double *)&at)[k] = cwi_monotone_curve(times, values, count, time);
    }
    make_camera(&at, keys[0].fov_deg > 0, camera);
    return CW_OK;
}

static cw_status check_keys(const cw_camera *keys, const double *times, size_t count,
                            double time, cw_error *err)
{
    if (count == 0)
        return cwi_fail(err, CW_ERR_ARGUMENT, "a path needs at least one camera");
    if (!isfinite(time))
        return cwi_fail(err, CW_ERR_ARGUMENT, "the time %g is not finite", time);
    for (size_t n = 0; n < count; n++) {
        if (!isfinite(times[n]) || (n && !(times[n] > times[n - 1])))
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "time %zu is %g: rising, finite times were expected", n, times[n]);
        if ((keys[n].fov_deg > 0) != (keys[0].fov_deg > 0))
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "camera %zu has a perspective where the first has none, or the "
                            "other way round: one kind was expected",
                            n);
    }
    return CW_OK;
}

cw_status cw_camera_path(const cw_camera *keys, const double *times, size_t count, double time,
                         cw_camera *camera, cw_error *err)
{
    CWI_REQUIRE(err, keys, times, camera);
    double axes[3][3];
    cw_status st = check_keys(keys, times, count, time, err);
    if (st != CW_OK)
        return st;
    size_t next = 0; /* the first key after the time */
    while (next < count && times[next] <= time)
        next++;
    const size_t at = next ? next - 1 : 0;
    if (next == 0 || next == count || times[at] == time) { /* a key itself, to the bit */
        st = cw_camera_axes(&keys[at], axes[0], axes[1], axes[2], err);
        if (st == CW_OK)
            *camera = keys[at];
        return st;
    }
    const size_t first = at ? at - 1 : 0, last = next + 1 < count ? next + 1 : next;
    return blend(keys + first, times + first, last - first + 1, time, camera, err);
}
