/* Proves that two triangles are apart, by a separating plane: for triangles few planes need to
 * be tried. Every comparison keeps a margin far above the rounding errors of doubles, so the
 * answer `true` is a proof. */
#include "core/geometry/triangle_separation.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <string.h>

/* Sines of angles: values below the first are zero up to rounding, values above the second are
 * not. */
#define FLAT  1e-9
#define SLOPE (1.0 / 8192)

typedef double vector[3];

/* ---- no corner in common ---------------------------------------------------------------- */

/* Returns true if the projections of the triangles on a line do not meet. */
static bool axis_separates(const double axis[3], const cwi_triangle *s, const cwi_triangle *t)
{
    const double length = cwi_length(axis);
    const double a = cwi_dot(axis, s->p[0]), b = cwi_dot(axis, s->p[1]),
                 c = cwi_dot(axis, s->p[2]);
    const double d = cwi_dot(axis, t->p[0]), e = cwi_dot(axis, t->p[1]),
                 f = cwi_dot(axis, t->p[2]);
    const double margin = CWI_APART * length;
    if (!(length > 0)) /* any other direction works, with any rounding */
        return false;
    return cwi_lesser(cwi_lesser(a, b), c) > cwi_greater(cwi_greater(d, e), f) + margin ||
           cwi_lesser(cwi_lesser(d, e), f) > cwi_greater(cwi_greater(a, b), c) + margin;
}

/* Tries the planes perpendicular to s along its sides. */
static bool side_parts(const double normal[3], vector sides[3], const cwi_triangle *s,
                       const cwi_triangle *t)
{
    for (int i = 0; i < 3; i++) {
        vector axis;
        cwi_cross(normal, sides[i], axis);
        if (axis_separates(axis, s, t))
            return true;
    }
    return axis_separates(normal, s, t);
}

static bool are_apart(const cwi_triangle *s, const cwi_triangle *t)
{
    vector s_sides[3], t_sides[3], m, n, axis;
    for (int a = 0; a < 3; a++) /* from middle to middle: usually succeeds */
        axis[a] = s->p[0][a] + s->p[1][a] + s->p[2][a] - t->p[0][a] - t->p[1][a] - t->p[2][a];
    if (axis_separates(axis, s, t))
        return true;
    for (int i = 0; i < 3; i++) {
        cwi_sub(s->p[(i + 1) % 3], s->p[i], s_sides[i]);
        cwi_sub(t->p[(i + 1) % 3], t->p[i], t_sides[i]);
    }
    cwi_cross(s_sides[0], s_sides[1], m);
    cwi_cross(t_sides[0], t_sides[1], n);
    if (side_parts(m, s_sides, s, t) || side_parts(n, t_sides, s, t))
        return true;
    for (int i = 0; i < 9; i++) {
        cwi_cross(s_sides[i / 3], t_sides[i % 3], axis);
        if (axis_separates(axis, s, t))
            return true;
    }
    return false;
}

/* ---- one corner in common: plane cones, defined by directions only ----------------- */

static bool unit_direction(const double from[3], const double to[3], vector out)
{
    cwi_sub(to, from, out);
    const double length = cwi_length(out);
    for (int i = 0; i < 3; i++)
        out[i] /= length;
    return length > 0;
}

/* Tries a plane through the apex with s on one side and t on the other, one of them not in it.
 * A plane through a side of each may touch both, along two lines. */
static bool parts_cones(const double axis[3], vector s[2], vector t[2], bool through_sides)
{
    const double length = cwi_length(axis), flat = FLAT * length, slope = SLOPE * length;
    const double a = cwi_dot(axis, s[0]), b = cwi_dot(axis, s[1]), c = cwi_dot(axis, t[0]),
                 d = cwi_dot(axis, t[1]);
    if (!(length > SLOPE))
        return false;
    for (int sign = 1; sign >= -1; sign -= 2) {
        const double s_low = cwi_lesser(sign * a, sign * b),
                     s_high = cwi_greater(sign * a, sign * b);
        const double t_low = cwi_lesser(sign * c, sign * d),
                     t_high = cwi_greater(sign * c, sign * d);
        if (s_low < -flat || t_high > flat)
            continue;
        if (s_low > slope || t_high < -slope)
            return true;
        if (through_sides && s_high > slope && t_low < -slope)
            return true;
    }
    return false;
}

static bool side_parts_cones(vector s[2], vector t[2])
{
    vector normal, axis;
    cwi_cross(s[0], s[1], normal);
    for (int i = 0; i < 2; i++) {
        cwi_cross(normal, s[i], axis);
        if (parts_cones(axis, s, t, false))
            return true;
    }
    return parts_cones(normal, s, t, false);
}

static bool cones_apart(const cwi_triangle *s, const cwi_triangle *t)
{
    vector u[2], v[2], axis;
    if (!unit_direction(s->p[0], s->p[1], u[0]) || !unit_direction(s->p[0], s->p[2], u[1]) ||
        !unit_direction(t->p[0], t->p[1], v[0]) || !unit_direction(t->p[0], t->p[2], v[1]))
        return false;
    for (int a = 0; a < 3; a++) /* from middle to middle: usually succeeds */
        axis[a] = u[0][a] + u[1][a] - v[0][a] - v[1][a];
    if (parts_cones(axis, u, v, false) || side_parts_cones(u, v) || side_parts_cones(v, u))
        return true;
    for (int i = 0; i < 4; i++) {
        cwi_cross(u[i / 2], v[i % 2], axis);
        if (parts_cones(axis, u, v, true))
            return true;
    }
    return false;
}

/* ---- two corners in common: a hinge, which must not be closed --------------------------- */

static bool hinge_is_open(const cwi_triangle *s, const cwi_triangle *t)
{
    vector hinge, u, v, m, n, across;
    cwi_sub(s->p[1], s->p[0], hinge);
    cwi_sub(s->p[2], s->p[0], u);
    cwi_sub(t->p[2], t->p[0], v);
    cwi_cross(hinge, u, m);
    cwi_cross(hinge, v, n);
    cwi_cross(m, n, across);
    const double cosine = cwi_dot(m, n), sine = cwi_length(across);
    const double size = cwi_length(m) * cwi_length(n);
    return size > 0 && (cosine < 0 || sine > SLOPE * size);
}

bool cwi_triangles_apart(const cwi_triangle *s, const cwi_triangle *t, int shared)
{
    switch (shared) {
    case 0:
        return are_apart(s, t);
    case 1:
        return cones_apart(s, t);
    case 2:
        return hinge_is_open(s, t);
    default:
        return false;
    }
}

/* ---- distance of a triangle -------------------------------------------------------------- */

/* Tries the nearest point of the line from p to q to the origin, if it is nearer. */
static void try_side(const double p[3], const double q[3], double nearest[3])
{
    vector d, at;
    cwi_sub(q, p, d);
    const double t = cwi_lesser(cwi_greater(-cwi_dot(p, d) / cwi_dot(d, d), 0), 1);
    cwi_add_scaled(p, t, d, at);
    if (cwi_dot(at, at) < cwi_dot(nearest, nearest))
        memcpy(nearest, at, sizeof at);
}

/* Finds the nearest point of the triangle's plane, if all sides have it on their left;
 * otherwise a point of a side that has it on its right. The corners' cross products add up to
 * the normal. */
void cwi_nearest_of_triangle(const cwi_triangle *t, double nearest[3])
{
    vector corners[3], n;
    for (int c = 0; c < 3; c++)
        cwi_cross(t->p[c], t->p[(c + 1) % 3], corners[c]);
    for (int a = 0; a < 3; a++)
        n[a] = corners[0][a] + corners[1][a] + corners[2][a];
    const double normal_sq = cwi_dot(n, n), height = cwi_dot(n, t->p[0]);
    if (height * height >= normal_sq * cwi_dot(nearest, nearest))
        return;
    bool inside = true;
    for (int c = 0; c < 3; c++)
        if (!(cwi_dot(n, corners[c]) >= 0)) {
            inside = false;
            try_side(t->p[c], t->p[(c + 1) % 3], nearest);
        }
    for (int a = 0; a < 3 && inside; a++)
        nearest[a] = height / normal_sq * n[a];
}
