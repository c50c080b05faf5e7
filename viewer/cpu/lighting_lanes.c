/* Shades four points at once by the Blinn-Phong model. Near faces that clip planes cut, points
 * are shaded one by one. */
#include "viewer/cpu/lighting_lanes.h"

#include <math.h>

typedef cwi_lanes lanes;

static lanes raise_power(lanes x, float power)
{
    lanes result = cwi_lanes_spread(1);
    if (power != floorf(power) || power > 1024 || power < 0) {
        for (int k = 0; k < 4; k++)
            result[k] = powf(x[k], power);
        return result;
    }
    for (unsigned n = (unsigned)power; n > 0; n /= 2, x *= x)
        if (n & 1)
            result *= x;
    return result;
}

static inline lanes dot(const lanes a[3], const double b[3])
{
    return a[0] * (float)b[0] + a[1] * (float)b[1] + a[2] * (float)b[2];
}

static inline lanes magnitude(lanes x)
{
    return cwi_lanes_max(x, -x);
}

/* Adds the light that surfaces with normals of unit length reflect, times a factor. */
static inline void add_reflection(const cwi_lighting *l, const lanes n[3], const lanes color[3],
                                  lanes factor, lanes shadow, lanes light[3])
{
    for (size_t i = 0; i < l->count; i++) {
        const lanes facing = -dot(n, l->direction[i]);
        lanes lit = l->shadow == CW_SHADOW_LIGHT && i == 0 ? factor * shadow : factor;
        if (l->is_one_sided)
            lit = cwi_lanes_choose(facing > 0, lit, cwi_lanes_spread(0));
        const lanes diffuse = l->material.diffuse * magnitude(facing),
                    gloss = magnitude(dot(n, l->halfway[i])),
                    specular = l->material.specular * raise_power(gloss, l->material.shininess);
        for (int c = 0; c < 3; c++)
            light[c] += lit * (float)l->color[i][c] * (diffuse * color[c] + specular);
    }
}

static void shade_one_by_one(const cwi_lighting *l, lanes t, const lanes gradient[3],
                             float unit, lanes shadow, lanes color[3])
{
    for (int k = 0; k < 4; k++) {
        double g[3], c[3];
        for (int a = 0; a < 3; a++) {
            g[a] = (double)gradient[a][k] * (double)unit;
            c[a] = (double)color[a][k];
        }
        cwi_lighting_shade(l, (double)t[k], g, (double)shadow[k], c);
        for (int a = 0; a < 3; a++)
            color[a][k] = (float)c[a];
    }
}

void cwi_lighting_shade_lanes(const cwi_lighting *l, lanes t, const lanes gradient[3],
                              lanes length, float unit, lanes shadow, lanes color[3])
{
    if (l->face_count > 0) {
        shade_one_by_one(l, t, gradient, unit, shadow, color);
        return;
    }
    const lanes one = cwi_lanes_spread(1), none = cwi_lanes_spread(0);
    const cwi_int_lanes is_there = length > 0;
    const lanes scale = 1 / cwi_lanes_choose(is_there, length, one);
    const lanes strength =
        l->surface > 0 ? cwi_lanes_min(length * (unit * (float)l->surface), one) : one;
    lanes n[3], light[3];
    for (int a = 0; a < 3; a++) {
        n[a] = scale * gradient[a];
        light[a] = l->material.ambient * color[a];
    }
    add_reflection(l, n, color, cwi_lanes_choose(is_there, strength, none), shadow, light);
    for (int c = 0; c < 3; c++)
        color[c] = l->shadow == CW_SHADOW_AMBIENT ? shadow * light[c] : light[c];
}
