/* Computes the colour ramp in CIELAB, the shape of triangles, and the range of a tint. */
#include "viewer/scene/mesh_tint.h"
#include "core/mesh/mesh_triangle.h"
#include "viewer/scene/srgb.h"

#include "core/base/status.h"
#include "core/geometry/vec3.h"

#include <math.h>

/* Returns the inverse of CIE's f(t): a cube root, with a straight line below it. */
static double inverse_f(double f)
{
    const double LAB_KNEE = 6.0 / 29;
    return f > LAB_KNEE ? f * f * f : 3 * LAB_KNEE * LAB_KNEE * (f - 4.0 / 29);
}

/* Converts CIELAB with the white of sRGB, D65; the matrix is IEC 61966-2-1's from XYZ. */
static void lab_to_srgb(double lightness, double a, double b, double srgb[3])
{
    static const double white[3] = {0.9505, 1, 1.0890};
    static const double from_xyz[3][3] = {
        {3.2406, -1.5372, -0.4986}, {-0.9689, 1.8758, 0.0415}, {0.0557, -0.2040, 1.0570}};
    const double y = (lightness + 16) / 116;
    const double f[3] = {y + a / 500, y, y - b / 200};
    double xyz[3];
    for (int c = 0; c < 3; c++)
        xyz[c] = white[c] * inverse_f(f[c]);
    for (int c = 0; c < 3; c++)
        srgb[c] = cwi_linear_to_srgb(cwi_dot(from_xyz[c], xyz));
}

void cwi_ramp_color(double fraction, double srgb[3])
{
    const double t = fmin(fmax(fraction, 0), 1), degree = CWI_PI / 180;
    const double lightness = 18 + 74 * t, hue = (310 - 205 * t) * degree;
    const double tint = 2 * t - 0.75; /* 0 where sRGB has least: in the teals */
    const double chroma = 27 + 30 * tint * tint;
    lab_to_srgb(lightness, chroma * cos(hue), chroma * sin(hue), srgb);
}

double cwi_triangle_shape(const cw_mesh *mesh, size_t triangle)
{
    double side[3][3], sides_sq = 0, normal[3];
    for (size_t e = 0; e < 3; e++) {
        cwi_sub_points(cwi_mesh_point(mesh, triangle, (e + 1) % 3),
                       cwi_mesh_point(mesh, triangle, e), side[e]);
        sides_sq += cwi_dot(side[e], side[e]);
    }
    cwi_cross(side[0], side[1], normal);
    return sides_sq > 0 ? 2 * sqrt(3) * cwi_length(normal) / sides_sq : 0;
}

static void find_range(const cw_mesh *mesh, double range[2])
{
    range[0] = INFINITY;
    range[1] = -INFINITY;
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        const double x = (double)mesh->scalars[v];
        if (isfinite(x)) {
            range[0] = fmin(range[0], x);
            range[1] = fmax(range[1], x);
        }
    }
    if (!(range[0] <= range[1]))
        range[0] = range[1] = 0;
}

cw_status cwi_tint_range(const cw_scene *scene, double range[2], cw_error *err)
{
    range[0] = 0;
    range[1] = 1;
    if ((unsigned)scene->mesh_look.tint >= CW_TINT_COUNT)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%d is not a tint (0 to %d)",
                        (int)scene->mesh_look.tint, CW_TINT_COUNT - 1);
    if (scene->mesh_look.tint == CW_TINT_SCALARS && !scene->mesh->scalars)
        return cwi_fail(err, CW_ERR_ARGUMENT, "the mesh has no scalars to be coloured by");
    if (scene->mesh_look.tint == CW_TINT_COLORS)
        return CW_OK;
    if (scene->mesh_look.tint_low != 0 || scene->mesh_look.tint_high != 0) {
        range[0] = scene->mesh_look.tint_low;
        range[1] = scene->mesh_look.tint_high;
        if (!(range[0] < range[1]) || !isfinite(range[1] - range[0]))
            return cwi_fail(err, CW_ERR_ARGUMENT, "colours from %g to %g: expected a range",
                            range[0], range[1]);
    } else if (scene->mesh_look.tint == CW_TINT_SCALARS) {
        find_range(scene->mesh, range);
        if (range[0] == range[1]) /* of one value: the middle colour */
            range[0] -= 0.5, range[1] += 0.5;
    }
    return CW_OK;
}
