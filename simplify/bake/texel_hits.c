/* Finds the place of a texel on the full surface. */
#include "core/geometry/closest_point.h"
#include "core/geometry/point_triangle.h"
#include "core/geometry/vec3.h"
#include "simplify/bake/bake_state.h"
#include "simplify/bake/texels.h"

#include <math.h>

bool cwi_texel_hit_find(const cwi_baking *b, const cwi_texel_frame *frame, double bound,
                        cwi_texel_hit *hit)
{
    double distance_sq;
    *hit = (cwi_texel_hit){0};
    hit->triangle = cwi_facing_find(b->full, &b->tree, frame->point, frame->normal, bound,
                                    b->reach, &distance_sq);
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
