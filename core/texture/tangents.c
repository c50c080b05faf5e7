/* Computes tangents from texture coordinates. */
#include "core/texture/tangents.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh_triangle.h"
#include "core/texture/split_seams.h"

#include <math.h>

/* Sums at a vertex: tangents by angles, and how much of them turns the other way. */
typedef struct tangent_sum {
    double along[3], turn;
} tangent_sum;

static void project(const double v[3], const double normal[3], double out[3])
{
    cwi_add_scaled(v, -cwi_dot(v, normal), normal, out);
}

static void load_normal(const cw_mesh *mesh, size_t v, double normal[3])
{
    for (size_t k = 0; k < 3; k++)
        normal[k] = (double)mesh->normals[3 * v + k];
    cwi_normalise(normal);
}

/* Computes where u grows on a triangle, and the sign of its area in the image as seen with v upward.
 * Returns false for a triangle without an area there. */
static bool find_tangent(const float *uv, const uint32_t v[3], const double p[3][3],
                         double tangent[3], double *sign)
{
    double side[3], other[3];
    const float *a = uv + 2 * (size_t)v[0], *b = uv + 2 * (size_t)v[1],
                *c = uv + 2 * (size_t)v[2];
    const double u1 = (double)b[0] - (double)a[0], v1 = (double)a[1] - (double)b[1],
                 u2 = (double)c[0] - (double)a[0], v2 = (double)a[1] - (double)c[1],
                 area = u1 * v2 - u2 * v1;
    if (area == 0)
        return false;
    cwi_sub(p[1], p[0], side);
    cwi_sub(p[2], p[0], other);
    *sign = area > 0 ? 1 : -1;
    for (int k = 0; k < 3; k++)
        tangent[k] = *sign * (v2 * side[k] - v1 * other[k]);
    return true;
}

static void add_corner(const cw_mesh *mesh, const double p[3][3], int k, uint32_t vertex,
                       const double tangent[3], double sign, tangent_sum *sum)
{
    double normal[3], along[3], a[3], b[3], flat_a[3], flat_b[3];
    load_normal(mesh, vertex, normal);
    project(tangent, normal, along);
    cwi_sub(p[(k + 1) % 3], p[k], a);
    cwi_sub(p[(k + 2) % 3], p[k], b);
    project(a, normal, flat_a);
    project(b, normal, flat_b);
    if (!cwi_normalise(along) || !cwi_normalise(flat_a) || !cwi_normalise(flat_b))
        return;
    const double angle = acos(fmax(-1, fmin(1, cwi_dot(flat_a, flat_b))));
    for (int i = 0; i < 3; i++)
        sum->along[i] += angle * along[i];
    sum->turn += angle * sign;
}

cw_status cwi_tangents(const cw_mesh *mesh, float (*tangents)[4], cw_error *err)
{
    const float *uv = cwi_texture_of(mesh)->data;
    tangent_sum *sums = cwi_alloc_zeroed(mesh->vertex_count, sizeof *sums);
    if (!sums)
        return cwi_fail_memory(err);
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *v = mesh->triangles + 3 * t;
        double p[3][3], tangent[3], sign;
        cwi_mesh_corners(mesh, t, p);
        if (find_tangent(uv, v, (const double(*)[3])p, tangent, &sign))
            for (int k = 0; k < 3; k++)
                add_corner(mesh, (const double(*)[3])p, k, v[k], tangent, sign, &sums[v[k]]);
    }
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        double normal[3], along[3];
        load_normal(mesh, v, normal);
        project(sums[v].along, normal, along);
        if (!cwi_normalise(along)) {
            const double axis[3] = {fabs(normal[0]) < 0.6, fabs(normal[0]) >= 0.6, 0};
            project(axis, normal, along);
            cwi_normalise(along);
        }
        for (int k = 0; k < 3; k++)
            tangents[v][k] = (float)along[k];
        tangents[v][3] = sums[v].turn < 0 ? -1 : 1;
    }
    cwi_free(sums);
    return CW_OK;
}
