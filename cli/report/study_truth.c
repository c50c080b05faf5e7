/* How far a mesh is from a surface that is known on paper: not from the voxels between which
 * that was interpolated. */
#include "cli/report/study.h"

#include <math.h>
#include <stdlib.h>

enum { STEPS = 12, BINS = 4096 };

static double field_gradient(cw_field field, const double p[3], double h, double g[3])
{
    double square = 0;
    for (int a = 0; a < 3; a++) {
        double low[3] = {p[0], p[1], p[2]}, high[3] = {p[0], p[1], p[2]};
        low[a] -= h;
        high[a] += h;
        g[a] = (cw_field_value(field, high) - cw_field_value(field, low)) / (2 * h);
        square += g[a] * g[a];
    }
    return square;
}

/* Walks to the surface by Newton's steps, none longer than a voxel, and leaves the last
 * gradient in g; NaN: it is not reached. */
static double walk_to_surface(cw_field field, double iso, double voxel_mm, const double from[3],
                              double g[3])
{
    double p[3] = {from[0], from[1], from[2]}, length = INFINITY;
    for (int n = 0; n < STEPS && length > 1e-7 * voxel_mm; n++) {
        const double off = iso - cw_field_value(field, p);
        const double square = field_gradient(field, p, 1e-4 * voxel_mm, g);
        if (!(square > 0))
            return NAN;
        length = fabs(off) / sqrt(square);
        const double by = off / square * (length > voxel_mm ? voxel_mm / length : 1);
        for (int a = 0; a < 3; a++)
            p[a] += by * g[a];
    }
    if (length > 1e-3 * voxel_mm)
        return NAN;
    return hypot(hypot(p[0] - from[0], p[1] - from[1]), p[2] - from[2]);
}

typedef struct sum {
    double max, square, area;
    double bins[BINS]; /* area by distance, up to 4 voxels */
} sum;

static void add_distance(sum *s, double mm, double area, double voxel_mm)
{
    if (!isfinite(mm))
        return;
    const double bin = mm / (4 * voxel_mm) * BINS;
    s->max = fmax(s->max, mm);
    s->square += mm * mm * area;
    s->area += area;
    s->bins[bin < BINS - 1 ? (size_t)bin : BINS - 1] += area;
}

static void vertex_of(const cw_mesh *m, size_t vertex, double p[3])
{
    for (size_t a = 0; a < 3; a++)
        p[a] = m->origin[a] + (double)m->positions[3 * vertex + a];
}

/* At the corners of a triangle, and in its middle, in the shares that are exact for squares. */
static void add_triangle(sum *s, cw_field field, double iso, double voxel_mm, const cw_mesh *m,
                         size_t t)
{
    double c[3][3], middle[3], u[3], v[3], g[3];
    for (size_t n = 0; n < 3; n++)
        vertex_of(m, m->triangles[3 * t + n], c[n]);
    for (int a = 0; a < 3; a++) {
        middle[a] = (c[0][a] + c[1][a] + c[2][a]) / 3;
        u[a] = c[1][a] - c[0][a];
        v[a] = c[2][a] - c[0][a];
    }
    const double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2],
                 z = u[0] * v[1] - u[1] * v[0], area = 0.5 * hypot(hypot(x, y), z);
    for (int n = 0; n < 3; n++)
        add_distance(s, walk_to_surface(field, iso, voxel_mm, c[n], g), area / 12, voxel_mm);
    add_distance(s, walk_to_surface(field, iso, voxel_mm, middle, g), area * 3 / 4, voxel_mm);
}

static double find_p99(const sum *s, double voxel_mm)
{
    double below = 0;
    size_t n = 0;
    while (n < BINS && (below += s->bins[n]) < 0.99 * s->area)
        n++;
    return fmin((double)(n + 1) / BINS * 4 * voxel_mm, s->max);
}

cli_gap cli_measure_truth(cw_field field, double iso, double voxel_mm, const cw_mesh *mesh)
{
    sum *s = calloc(1, sizeof *s);
    cli_gap gap = {0};
    for (size_t t = 0; t < mesh->triangle_count && s; t++)
        add_triangle(s, field, iso, voxel_mm, mesh, t);
    if (s && s->area > 0)
        gap = (cli_gap){true, s->max, sqrt(s->square / s->area), find_p99(s, voxel_mm)};
    free(s);
    return gap;
}

/* Between lines: which way normals point is a matter of convention. */
static double angle_deg(const float n[3], const double g[3])
{
    double dot = 0, cross = 0;
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        const double x = (double)n[b] * g[c] - (double)n[c] * g[b];
        dot += (double)n[a] * g[a];
        cross += x * x;
    }
    return atan2(sqrt(cross), fabs(dot)) * 180 / acos(-1);
}

cli_vertex_errors cli_measure_vertices(cw_field field, double iso, double voxel_mm,
                                       const cw_mesh *mesh, size_t one_of)
{
    cli_vertex_errors e = {0};
    for (size_t v = 0; v < mesh->vertex_count; v += one_of) {
        double p[3], g[3];
        vertex_of(mesh, v, p);
        const double mm = walk_to_surface(field, iso, voxel_mm, p, g);
        if (isnan(mm)) {
            e.missed++;
            continue;
        }
        const double deg = mesh->normals ? angle_deg(mesh->normals + 3 * v, g) : 0;
        e.count++;
        e.mean_mm += (mm - e.mean_mm) / (double)e.count;
        e.max_mm = fmax(e.max_mm, mm);
        e.mean_deg += (deg - e.mean_deg) / (double)e.count;
        e.max_deg = fmax(e.max_deg, deg);
    }
    e.has_normals = mesh->normals && e.count;
    return e;
}
