/* Intersects a ray with the triangles of a mesh, and with the caps of its cuts. */
#include "viewer/interact/pick_mesh.h"

#include "core/geometry/vec3.h"
#include "core/mesh/mesh_triangle.h"

#include <math.h>
#include <string.h>

/* A mesh seen along a ray: x and y across it, 0 on it; z along. In mm from the ray's origin. */
typedef struct sight {
    const cw_mesh *mesh;
    double axes[3][3], from[3];
    double start;      /* of the ray, in mm */
    double kept[2][2]; /* parts of it that are drawn */
    int kept_count;
    size_t before[2]; /* triangles met before each part */
} sight;

/* Finds two directions across a third; all of unit length. */
static void find_across(double axes[3][3])
{
    const double *d = axes[2];
    const int axis = fabs(d[0]) < fabs(d[1]) ? (fabs(d[0]) < fabs(d[2]) ? 0 : 2)
                                             : (fabs(d[1]) < fabs(d[2]) ? 1 : 2);
    double side[3] = {0};
    side[axis] = 1;
    cwi_cross(d, side, axes[0]);
    const double length = cwi_length(axes[0]);
    for (int a = 0; a < 3; a++)
        axes[0][a] /= length;
    cwi_cross(d, axes[0], axes[1]);
}

static sight look_along(const cwi_frame *f, const double origin[3], const double direction[3])
{
    const double all[2] = {f->perspective ? f->near / -direction[2] : -INFINITY, INFINITY};
    sight s = {.mesh = f->scene.mesh, .start = all[0] * f->unit_mm};
    double eye[3];
    cwi_frame_to_world(f, origin, eye);
    for (int a = 0; a < 3; a++)
        s.axes[2][a] = direction[0] * f->axes[0][a] + direction[1] * f->axes[1][a] +
                       direction[2] * f->axes[2][a];
    find_across(s.axes);
    for (int a = 0; a < 3; a++) {
        double from_eye[3];
        cwi_sub(s.mesh->origin, eye, from_eye);
        s.from[a] = cwi_dot(from_eye, s.axes[a]);
    }
    s.kept_count = cwi_frame_keep(f, origin, direction, all, s.kept);
    for (int n = 0; n < 4; n++)
        s.kept[n / 2][n % 2] *= f->unit_mm;
    return s;
}

static double position_along(const sight *s, const float *p, int axis)
{
    const double *a = s->axes[axis];
    return s->from[axis] + (double)p[0] * a[0] + (double)p[1] * a[1] + (double)p[2] * a[2];
}

/* Finds on which side of an edge the ray passes, and how far. If the ray goes through the edge,
 * it counts as moved a little, in the same way for all edges. So exactly one of the triangles
 * that share an edge or a corner meets it. */
static bool side_of(const double a[2], const double b[2], double *area)
{
    *area = a[0] * b[1] - a[1] * b[0];
    return *area != 0 ? *area > 0 : b[1] != a[1] ? b[1] > a[1] : b[0] > a[0];
}

static bool meet_triangle(const sight *s, size_t triangle, double *z, double fraction[3])
{
    const float *p[3];
    double at[3][2], area[3];
    for (size_t n = 0; n < 3; n++) {
        p[n] = cwi_mesh_point(s->mesh, triangle, n);
        at[n][0] = position_along(s, p[n], 0);
        at[n][1] = position_along(s, p[n], 1);
    }
    const bool side = side_of(at[1], at[2], &area[0]);
    if (side_of(at[2], at[0], &area[1]) != side || side_of(at[0], at[1], &area[2]) != side)
        return false;
    const double sum = area[0] + area[1] + area[2];
    *z = 0;
    for (int n = 0; n < 3 && sum != 0; n++) {
        fraction[n] = area[n] / sum;
        *z += fraction[n] * position_along(s, p[n], 2);
    }
    return sum != 0;
}

static bool is_drawn(const cwi_frame *f, size_t triangle, const double fraction[3])
{
    const cw_mesh *m = f->scene.mesh;
    if (f->scene.mesh_look.tint != CW_TINT_COLORS || !m->colors)
        return f->scene.mesh_look.color[3] > 0;
    double opacity = 0;
    for (int n = 0; n < 3; n++)
        opacity +=
            fraction[n] * m->colors[4 * (size_t)m->triangles[3 * triangle + (size_t)n] + 3];
    return opacity > 0;
}

static bool is_kept(const sight *s, double z)
{
    for (int n = 0; n < s->kept_count; n++)
        if (z >= s->kept[n][0] && z <= s->kept[n][1])
            return true;
    return false;
}

/* Adds a filled cut where a part of the ray begins inside of the mesh. */
static void add_caps(const sight *s, cwi_mesh_hit *hit)
{
    for (int n = s->kept_count - 1; n >= 0; n--)
        if (s->before[n] % 2 && s->kept[n][0] <= hit->t && s->kept[n][0] > s->start)
            *hit = (cwi_mesh_hit){.t = s->kept[n][0], .triangle = SIZE_MAX};
}

cwi_mesh_hit cwi_pick_mesh(const cwi_frame *f, const double origin[3],
                           const double direction[3])
{
    sight s = look_along(f, origin, direction);
    cwi_mesh_hit hit = {.t = INFINITY};
    double z, fraction[3];
    for (size_t n = 0; n < s.mesh->triangle_count; n++) {
        if (!meet_triangle(&s, n, &z, fraction))
            continue;
        for (int part = 0; part < s.kept_count; part++)
            s.before[part] += z < s.kept[part][0];
        if (z < hit.t && is_kept(&s, z) && is_drawn(f, n, fraction)) {
            hit.t = z;
            hit.triangle = n;
            memcpy(hit.weights, fraction, sizeof fraction);
        }
    }
    if (f->scene.mesh_look.cap && f->scene.clip_count > 0)
        add_caps(&s, &hit);
    hit.t /= f->unit_mm;
    return hit;
}
