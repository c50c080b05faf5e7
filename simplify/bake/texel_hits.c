/* Finds the place of a texel on the mesh and on the full surface. */
#include "core/geometry/closest_point.h"
#include "core/geometry/point_triangle.h"
#include "core/geometry/vec3.h"
#include "core/texture/split_seams.h"
#include "simplify/bake/bake_state.h"
#include "simplify/bake/texels.h"

#include <math.h>
#include <string.h>

typedef struct facing_search {
    const cwi_baking *b;
    const double *point, *normal;
    uint32_t triangle;
} facing_search;

static void measure_facing(void *context, size_t slot, double *distance_sq)
{
    facing_search *s = context;
    const cw_mesh *m = s->b->full;
    const uint32_t t = s->b->tree.order[slot], *v = m->triangles + 3 * (size_t)t;
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

/* Finds the nearest triangle that faces the same way, and the square of its distance. bound: where one is
 * thought to be; else all in reach are looked at. */
static uint32_t find_facing(const cwi_baking *b, const double point[3], const double normal[3],
                            double bound, double *distance_sq)
{
    facing_search s = {.b = b, .point = point, .normal = normal, .triangle = CWI_NO_TEXEL};
    *distance_sq = fmin(bound * bound, b->reach * b->reach);
    cwi_boxes_nearest(&b->tree, point, measure_facing, &s, distance_sq);
    if (s.triangle == CWI_NO_TEXEL && bound < b->reach) {
        *distance_sq = b->reach * b->reach;
        cwi_boxes_nearest(&b->tree, point, measure_facing, &s, distance_sq);
    }
    return s.triangle;
}

bool cwi_texel_hit_find(const cwi_baking *b, const cwi_texel_frame *frame, double bound,
                        cwi_texel_hit *hit)
{
    double distance_sq;
    *hit = (cwi_texel_hit){0};
    hit->triangle = find_facing(b, frame->point, frame->normal, bound, &distance_sq);
    if (hit->triangle == CWI_NO_TEXEL)
        return false;
    hit->distance_mm = sqrt(distance_sq);
    const uint32_t *v = b->full->triangles + 3 * (size_t)hit->triangle;
    const float *p = b->full->positions, *n = b->full->normals;
    cwi_facet_nearest(p + 3 * (size_t)v[0], p + 3 * (size_t)v[1], p + 3 * (size_t)v[2],
                      frame->point, hit->weights);
    for (size_t k = 0; k < 3; k++)
        for (size_t c = 0; c < 3; c++) {
            hit->point[k] += hit->weights[c] * (double)p[3 * (size_t)v[c] + k];
            hit->normal[k] += hit->weights[c] * (double)n[3 * (size_t)v[c] + k];
        }
    return cwi_normalise(hit->normal);
}

void cwi_texel_frame_find(const cwi_baking *b, uint32_t triangle, uint32_t size, uint32_t x,
                          uint32_t y, cwi_texel_frame *f)
{
    const cw_mesh *m = &b->mesh;
    const uint32_t *v = m->triangles + 3 * (size_t)triangle;
    double weights[3];
    *f = (cwi_texel_frame){0};
    cwi_texel_weights(cwi_texture_of(m)->data, v, size, x, y, weights);
    for (int c = 0; c < 3; c++) {
        const float *p = m->positions + 3 * (size_t)v[c], *n = m->normals + 3 * (size_t)v[c],
                    *t = b->tangents[v[c]];
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
    for (int k = 0; k < 3; k++)
        f->point[k] += b->shift[k];
    cwi_normalise(f->normal);
    cwi_normalise(f->tangent);
    cwi_normalise(f->bitangent);
}
