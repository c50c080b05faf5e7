/* Wanted lengths of edges by curvature: tensors of vertices, from the angles at the edges around. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "simplify/remesh/remesh_state.h"

#include <string.h>

/* Lengths grow at most by this fraction of the distance from a place to another. */
static const double GROWTH = 0.4;

/* Fraction of the allowed distance that the chords of edges use. */
static const double CHORD_FRACTION = 0.5;

enum { SWEEPS = 6, SMOOTHINGS = 2, TENSOR = 7 }; /* six numbers of a tensor, and the area */

/* Adds a part of an edge's tensor to a vertex [CohenSteiner2003]. */
static void add_edge(const cwi_remesh *r, uint32_t corner, double *tensors)
{
    const uint32_t twin = r->twin[corner],
                   v[2] = {r->triangles[corner], r->triangles[cwi_corner_next(corner)]};
    const float *p = r->positions + 3 * (size_t)v[0], *q = r->positions + 3 * (size_t)v[1];
    double along[3], first[3], second[3], cross[3];
    for (size_t k = 0; k < 3; k++) {
        along[k] = (double)q[k] - (double)p[k];
        first[k] = (double)r->surface.normals[3 * (size_t)(corner / 3) + k];
        second[k] = (double)r->surface.normals[3 * (size_t)(twin / 3) + k];
    }
    const double length = cwi_length(along);
    if (!cwi_normalise(along))
        return;
    cwi_cross(first, second, cross);
    const double angle = atan2(cwi_dot(cross, along), cwi_dot(first, second));
    const double weight = angle * length / 2;
    for (int k = 0; k < 2; k++) {
        double *t = tensors + TENSOR * (size_t)v[k];
        t[0] += weight * along[0] * along[0];
        t[1] += weight * along[1] * along[1];
        t[2] += weight * along[2] * along[2];
        t[3] += weight * along[0] * along[1];
        t[4] += weight * along[0] * along[2];
        t[5] += weight * along[1] * along[2];
    }
}

static void sum_tensors(const cwi_remesh *r, double *tensors)
{
    for (uint32_t c = 0; c < 3 * r->triangle_count; c++)
        if (!cwi_is_sharp(r, c) && r->twin[c] > c)
            add_edge(r, c, tensors);
    for (size_t t = 0; t < r->triangle_count; t++) {
        const uint32_t *v = r->triangles + 3 * t;
        double normal[3];
        cwi_largest_cosine(r->positions + 3 * (size_t)v[0], r->positions + 3 * (size_t)v[1],
                           r->positions + 3 * (size_t)v[2], normal);
        const double area = cwi_length(normal) / 6;
        for (int k = 0; k < 3; k++)
            tensors[TENSOR * (size_t)v[k] + 6] += area;
    }
}

/* Adds the tensors and areas of the neighbours to those of each vertex, but not across features. */
static void spread_tensors(const cwi_remesh *r, const double *from, double *to)
{
    memcpy(to, from, TENSOR * r->vertex_count * sizeof *to);
    for (uint32_t c = 0; c < 3 * r->triangle_count; c++) {
        const uint32_t a = r->triangles[c], b = r->triangles[cwi_corner_next(c)];
        if (r->freedom[a] != CWI_FREE || r->freedom[b] != CWI_FREE)
            continue;
        for (size_t k = 0; k < TENSOR; k++)
            to[TENSOR * (size_t)a + k] += from[TENSOR * (size_t)b + k];
    }
}

/* Returns the largest absolute eigenvalue of a symmetric tensor: xx, yy, zz, xy, xz, yz. */
static double largest_eigenvalue(const double t[6])
{
    const double mean = (t[0] + t[1] + t[2]) / 3;
    const double x = t[0] - mean, y = t[1] - mean, z = t[2] - mean;
    const double size_sq =
        (x * x + y * y + z * z + 2 * (t[3] * t[3] + t[4] * t[4] + t[5] * t[5])) / 6;
    if (!(size_sq > 0))
        return fabs(mean);
    const double size = sqrt(size_sq);
    const double determinant = x * (y * z - t[5] * t[5]) - t[3] * (t[3] * z - t[5] * t[4]) +
                               t[4] * (t[3] * t[5] - y * t[4]);
    const double half = determinant / (2 * size * size_sq);
    const double angle = acos(cwi_greater(-1, cwi_lesser(1, half))) / 3;
    const double high = mean + 2 * size * cos(angle),
                 low = mean + 2 * size * cos(angle + 2 * CWI_PI / 3);
    return cwi_greater(fabs(high), fabs(low));
}

/* Returns the length of an edge whose triangle leaves a sphere of the curvature by a height. */
static double length_for(const cwi_remesh *r, double curvature)
{
    const double height = CHORD_FRACTION * r->desc.error_mm;
    const double length_sq =
        curvature > 0 ? 6 * height / curvature - 3 * height * height : INFINITY;
    const double length = length_sq > 0 ? sqrt(length_sq) : 0;
    return cwi_greater(r->desc.shortest_mm, cwi_lesser(r->desc.edge_mm, length));
}

static void limit_growth(const cwi_remesh *r, uint32_t a, uint32_t b)
{
    const double length = GROWTH * sqrt(cwi_point_distance_sq(r->positions + 3 * (size_t)a,
                                                              r->positions + 3 * (size_t)b));
    float *sizes = r->target_sizes;
    sizes[a] = (float)cwi_lesser((double)sizes[a], (double)sizes[b] + length);
    sizes[b] = (float)cwi_lesser((double)sizes[b], (double)sizes[a] + length);
}

/* Limits the growth along all edges, in one order or the other. */
static void sweep_sizes(const cwi_remesh *r, bool is_backward)
{
    const size_t corners = 3 * r->triangle_count;
    for (size_t n = 0; n < corners; n++) {
        const uint32_t c = (uint32_t)(is_backward ? corners - 1 - n : n);
        limit_growth(r, r->triangles[c], r->triangles[cwi_corner_next(c)]);
    }
}

cw_status cwi_remesh_size(cwi_remesh *r, cw_error *err)
{
    double *tensors = cwi_alloc_zeroed(r->vertex_count, TENSOR * sizeof *tensors),
           *spread = cwi_alloc_array(r->vertex_count, TENSOR * sizeof *spread);
    r->target_sizes = cwi_alloc_array(r->vertex_count, sizeof *r->target_sizes);
    const bool has_memory = tensors && spread && r->target_sizes;
    if (has_memory) {
        sum_tensors(r, tensors);
        for (int n = 0; n < SMOOTHINGS; n++) {
            spread_tensors(r, tensors, spread);
            memcpy(tensors, spread, TENSOR * r->vertex_count * sizeof *tensors);
        }
        for (size_t v = 0; v < r->vertex_count; v++) {
            const double *t = tensors + TENSOR * v;
            const double found = largest_eigenvalue(t);
            r->target_sizes[v] = (float)length_for(r, t[6] > 0 ? found / t[6] : 0);
        }
        for (int sweep = 0; sweep < SWEEPS; sweep++)
            sweep_sizes(r, sweep % 2);
    }
    cwi_free(tensors);
    cwi_free(spread);
    return has_memory ? CW_OK : cwi_fail_memory(err);
}
