/* Finds the frames of texels, and points of a full surface that face the same way. */
#include "simplify/bake/bake_frame.h"

#include "core/geometry/point_triangle.h"
#include "simplify/bake/texels.h"

#include <math.h>

typedef struct facing_search {
    const cw_mesh *full;
    const cwi_boxes *tree;
    const double *point, *normal;
    uint32_t triangle;
} facing_search;

static void measure_facing(void *context, size_t slot, double *distance_sq)
{
    facing_search *s = context;
    const cw_mesh *m = s->full;
    const uint32_t t = s->tree->order[slot], *v = m->triangles + 3 * (size_t)t;
    const cwi_facet_view f =
        cwi_facet_look(m->positions + 3 * (size_t)v[0], m->positions + 3 * (size_t)v[1],
                       m->positions + 3 * (size_t)v[2], s->point);
    if (!(cwi_dot(f.normal, s->normal) > 0))
        return;
    const double here = cwi_facet_view_distance_sq(&f);
    if (here < *distance_sq) {
        *distance_sq = here;
        s->triangle = t;
    }
}

uint32_t cwi_facing_find(const cw_mesh *full, const cwi_boxes *tree, const double point[3],
                         const double normal[3], double bound, double reach,
                         double *distance_sq)
{
    facing_search s = {full, tree, point, normal, CWI_NO_TEXEL};
    *distance_sq = fmin(bound * bound, reach * reach);
    cwi_boxes_nearest(tree, point, measure_facing, &s, distance_sq);
    if (s.triangle == CWI_NO_TEXEL && bound < reach) {
        *distance_sq = reach * reach;
        cwi_boxes_nearest(tree, point, measure_facing, &s, distance_sq);
    }
    return s.triangle;
}

void cwi_texel_frame_find(const cw_mesh *m, const float (*tangents)[4], uint32_t triangle,
                          const double weights[3], cwi_texel_frame *f)
{
    const uint32_t *v = m->triangles + 3 * (size_t)triangle;
    *f = (cwi_texel_frame){0};
    for (int c = 0; c < 3; c++) {
        const float *p = m->positions + 3 * (size_t)v[c], *n = m->normals + 3 * (size_t)v[c],
                    *t = tangents[v[c]];
        const double normal[3] = {(double)n[0], (double)n[1], (double)n[2]},
                     tangent[3] = {(double)t[0], (double)t[1], (double)t[2]};
        double across[3];
        cwi_cross(normal, tangent, across);
        for (int k = 0; k < 3; k++) {
            f->point[k] += weights[c] * (double)p[k];
            f->normal[k] += weights[c] * normal[k];
            f->tangent[k] += weights[c] * tangent[k];
            f->bitangent[k] += weights[c] * (double)t[3] * across[k];
        }
    }
    cwi_normalise(f->normal);
    cwi_normalise(f->tangent);
    cwi_normalise(f->bitangent);
}

void cwi_texel_share_normal(const cwi_texel_frame *f, const double normal[3], double shares[3])
{
    double across[3];
    cwi_cross(f->bitangent, f->normal, across);
    const double volume = cwi_dot(f->tangent, across);
    shares[0] = cwi_dot(normal, across) / volume;
    cwi_cross(f->normal, f->tangent, across);
    shares[1] = cwi_dot(normal, across) / volume;
    cwi_cross(f->tangent, f->bitangent, across);
    shares[2] = cwi_dot(normal, across) / volume;
    if (!(fabs(volume) > 1e-3) || !cwi_normalise(shares)) {
        shares[0] = shares[1] = 0;
        shares[2] = 1;
    }
}

void cwi_texel_put_normal(const cwi_texel_frame *f, const double normal[3], uint8_t *pixel)
{
    double shares[3];
    cwi_texel_share_normal(f, normal, shares);
    for (int k = 0; k < 3; k++)
        pixel[k] = (uint8_t)floor(127.5 * (shares[k] + 1) + 0.5);
    pixel[3] = 255;
}
