/* Maps of the full surface itself: its normals, its colours, and how it bends. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh_triangle.h"
#include "simplify/bake/bake_state.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The share of vertices whose curvature is within the range of the map. */
static const double WITHIN = 0.95;

/* Cotangents of needles are cut off here. */
static const double MAX_COTANGENT = 20;

enum { SMOOTHINGS = 2 };

/* The shares of a normal in the frame's three directions. */
void cwi_shade_normal(const cwi_baking *b, const cwi_texel_frame *f, const cwi_texel_hit *hit,
                      double color[3])
{
    double across[3], shares[3] = {0, 0, 1};
    (void)b;
    if (hit) {
        cwi_cross(f->bitangent, f->normal, across);
        const double volume = cwi_dot(f->tangent, across);
        shares[0] = cwi_dot(hit->normal, across) / volume;
        cwi_cross(f->normal, f->tangent, across);
        shares[1] = cwi_dot(hit->normal, across) / volume;
        cwi_cross(f->tangent, f->bitangent, across);
        shares[2] = cwi_dot(hit->normal, across) / volume;
        if (!(fabs(volume) > 1e-3) || !cwi_normalise(shares)) {
            shares[0] = shares[1] = 0;
            shares[2] = 1;
        }
    }
    for (int k = 0; k < 3; k++)
        color[k] = (shares[k] + 1) / 2;
}

void cwi_shade_color(const cwi_baking *b, const cwi_texel_frame *f, const cwi_texel_hit *hit,
                     double color[3])
{
    (void)f;
    for (size_t k = 0; k < 3; k++) {
        color[k] = hit ? 0 : 0.5;
        for (size_t c = 0; hit && c < 3; c++) {
            const size_t v = b->full->triangles[3 * (size_t)hit->triangle + c];
            color[k] += hit->weights[c] * b->full->colors[4 * v + k] / 255;
        }
    }
}

/* --- curvature ------------------------------------------------------------------------------ */

void cwi_shade_curvature(const cwi_baking *b, const cwi_texel_frame *f,
                         const cwi_texel_hit *hit, double color[3])
{
    double curvature = 0;
    (void)f;
    for (size_t c = 0; hit && c < 3; c++)
        curvature += hit->weights[c] *
                     (double)b->curvature[b->full->triangles[3 * (size_t)hit->triangle + c]];
    const double share =
        b->curvature_max > 0 ? fmax(-1, fmin(1, curvature / b->curvature_max)) : 0;
    color[0] = color[1] = color[2] = (share + 1) / 2;
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Finds the range that most vertices are in. values: reordered */
static double find_range(double *values, size_t count)
{
    for (size_t v = 0; v < count; v++)
        values[v] = fabs(values[v]);
    qsort(values, count, sizeof *values, compare_doubles);
    return count ? values[(size_t)(WITHIN * (double)(count - 1))] : 0;
}

/* Adds a triangle's share of twice the mean curvature times the normal, and of the area, at its corners.
 * sums: vertices x 4 */
static void add_triangle(const cw_mesh *m, size_t t, double (*sums)[4])
{
    const uint32_t *v = m->triangles + 3 * t;
    double p[3][3], normal[3];
    cwi_mesh_corners(m, t, p);
    cwi_triangle_normal(p[0], p[1], p[2], normal);
    const double twice_area = sqrt(cwi_dot(normal, normal));
    if (!(twice_area > 0))
        return;
    for (size_t c = 0; c < 3; c++) {
        const size_t i = (c + 1) % 3, j = (c + 2) % 3;
        double a[3], b[3];
        cwi_sub(p[i], p[c], a);
        cwi_sub(p[j], p[c], b);
        const double cotangent =
            fmax(-MAX_COTANGENT, fmin(MAX_COTANGENT, cwi_dot(a, b) / twice_area));
        for (int k = 0; k < 3; k++) {
            sums[v[i]][k] += cotangent / 2 * (p[i][k] - p[j][k]);
            sums[v[j]][k] += cotangent / 2 * (p[j][k] - p[i][k]);
        }
        sums[v[c]][3] += twice_area / 6;
    }
}

/* Gives each vertex the mean of it and of the vertices around it, by their areas: needles have little, and
 * their curvatures mean little. sums: areas in the last column, which stay */
static void smooth_values(const cw_mesh *m, float *values, double (*sums)[4])
{
    for (size_t v = 0; v < m->vertex_count; v++) {
        sums[v][0] = sums[v][3] * (double)values[v];
        sums[v][1] = sums[v][3];
    }
    for (size_t c = 0; c < 3 * m->triangle_count; c++) {
        const uint32_t v = m->triangles[c], next = m->triangles[c - c % 3 + (c + 1) % 3];
        sums[v][0] += sums[next][3] * (double)values[next];
        sums[v][1] += sums[next][3];
    }
    for (size_t v = 0; v < m->vertex_count; v++)
        values[v] = (float)(sums[v][1] > 0 ? sums[v][0] / sums[v][1] : 0);
}

cw_status cwi_curvature_find(cwi_baking *b, cw_error *err)
{
    const cw_mesh *m = b->full;
    double(*sums)[4] = cwi_alloc_zeroed(m->vertex_count, sizeof *sums);
    double *range = cwi_alloc_array(m->vertex_count, sizeof *range);
    b->curvature = cwi_alloc_array(m->vertex_count, sizeof *b->curvature);
    const bool has_memory = sums && range && b->curvature;
    for (size_t t = 0; has_memory && t < m->triangle_count; t++)
        add_triangle(m, t, sums);
    for (size_t v = 0; has_memory && v < m->vertex_count; v++) {
        const float *n = m->normals + 3 * v;
        const double along =
            sums[v][0] * (double)n[0] + sums[v][1] * (double)n[1] + sums[v][2] * (double)n[2];
        b->curvature[v] = (float)(sums[v][3] > 0 ? along / (2 * sums[v][3]) : 0);
    }
    for (int n = 0; has_memory && n < SMOOTHINGS; n++)
        smooth_values(m, b->curvature, sums);
    for (size_t v = 0; has_memory && v < m->vertex_count; v++)
        range[v] = (double)b->curvature[v];
    if (has_memory && !(b->curvature_max > 0))
        b->curvature_max = find_range(range, m->vertex_count);
    cwi_free(sums);
    cwi_free(range);
    return has_memory ? CW_OK : cwi_fail_memory(err);
}
