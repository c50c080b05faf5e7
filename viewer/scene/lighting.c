/* Shades points by the Blinn-Phong model, lit from both sides or from outside alone, in eye
 * space. */
#include "viewer/scene/lighting.h"

#include "core/geometry/vec3.h"

#include <math.h>
#include <string.h>

/* Returns x^power for whole powers, as most are, and others; faster than pow(). */
static double raise_power(double x, double power)
{
    double result = 1;
    if (power != floor(power) || power > 1024 || power < 0)
        return pow(x, power);
    for (unsigned n = (unsigned)power; n > 0; n /= 2, x *= x)
        if (n & 1)
            result *= x;
    return result;
}

void cwi_lighting_make(const cwi_frame *f, const double direction[3], cwi_lighting *l)
{
    *l = (cwi_lighting){.material = f->scene.material,
                        .is_one_sided = f->scene.one_sided,
                        .count = f->scene.light_count};
    for (size_t n = 0; n < l->count; n++) {
        const cw_light *light = &f->scene.lights[n];
        memcpy(l->direction[n], light->direction, sizeof l->direction[n]);
        cwi_to_unit(l->direction[n]);
        for (int a = 0; a < 3; a++) {
            l->halfway[n][a] = l->direction[n][a] - direction[a];
            l->color[n][a] = (double)light->color[a];
        }
        cwi_to_unit(l->halfway[n]);
    }
}

void cwi_lighting_shade(const cwi_lighting *l, const double gradient[3], double color[3])
{
    double n[3] = {gradient[0], gradient[1], gradient[2]};
    double light[3];
    const bool has_side = n[0] != 0 || n[1] != 0 || n[2] != 0;
    cwi_to_unit(n);
    for (int c = 0; c < 3; c++)
        light[c] = (double)l->material.ambient * color[c];
    for (size_t i = 0; i < l->count && has_side; i++) {
        const double facing = -cwi_dot(n, l->direction[i]);
        if (l->is_one_sided && !(facing > 0))
            continue;
        const double diffuse = (double)l->material.diffuse * fabs(facing);
        const double gloss = fabs(cwi_dot(n, l->halfway[i]));
        const double specular =
            (double)l->material.specular * raise_power(gloss, (double)l->material.shininess);
        for (int c = 0; c < 3; c++)
            light[c] += l->color[i][c] * (diffuse * color[c] + specular);
    }
    memcpy(color, light, sizeof light);
}
