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

void cwi_lighting_make(const cwi_frame *f, const double origin[3], const double direction[3],
                       cwi_lighting *l)
{
    *l = (cwi_lighting){.material = f->scene.material,
                        .is_one_sided = f->scene.one_sided,
                        .count = f->scene.light_count,
                        .surface = f->surface,
                        .shadow = f->shadows ? f->scene.shadow : CW_SHADOW_NONE,
                        .side = f->scene.cut_away ? -1 : 1};
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
    for (size_t n = 0; n < f->scene.clip_count; n++) {
        if (!(f->faces >> n & 1))
            continue;
        l->faces[l->face_count] = f->clips[n];
        l->face_start[l->face_count] = cwi_dot(f->clips[n], origin) - f->clips[n][3];
        l->face_slope[l->face_count++] = cwi_dot(f->clips[n], direction);
    }
}

/* Adds the light that a surface with a normal of unit length reflects, times a factor. */
static void add_reflection(const cwi_lighting *l, const double n[3], const double color[3],
                           double factor, double shadow, bool is_glossy, double light[3])
{
    for (size_t i = 0; i < l->count; i++) {
        const double lit = l->shadow == CW_SHADOW_LIGHT && i == 0 ? factor * shadow : factor;
        const double facing = -cwi_dot(n, l->direction[i]);
        if (l->is_one_sided && !(facing > 0))
            continue;
        const double diffuse = (double)l->material.diffuse * fabs(facing);
        const double gloss = fabs(cwi_dot(n, l->halfway[i]));
        const double specular = is_glossy
                                    ? (double)l->material.specular *
                                          raise_power(gloss, (double)l->material.shininess)
                                    : 0;
        for (int c = 0; c < 3; c++)
            light[c] += lit * l->color[i][c] * (diffuse * color[c] + specular);
    }
}

double cwi_lighting_face_fraction(double distance)
{
    return fmin(fmax(2 - fabs(distance), 0), 1);
}

/* Finds the face that clip planes cut near a place of the ray; returns its share of the light. */
static double find_face(const cwi_lighting *l, double t, double normal[3])
{
    double nearest = INFINITY;
    for (size_t n = 0; n < l->face_count; n++) {
        const double distance = l->face_start[n] + t * l->face_slope[n];
        if (distance < nearest) {
            nearest = distance;
            for (int a = 0; a < 3; a++)
                normal[a] = l->side * l->faces[n][a];
        }
    }
    return cwi_lighting_face_fraction(nearest);
}

void cwi_lighting_shade(const cwi_lighting *l, double t, const double gradient[3],
                        double shadow, double color[3])
{
    double n[3] = {gradient[0], gradient[1], gradient[2]}, face[3] = {0};
    double light[3];
    const double length = cwi_length(n);
    const double strength = l->surface > 0 ? fmin(length * l->surface, 1) : 1;
    const double fraction = find_face(l, t, face);
    cwi_to_unit(n);
    for (int c = 0; c < 3; c++)
        light[c] = (double)l->material.ambient * color[c];
    if (fraction < 1 && length > 0)
        add_reflection(l, n, color, (1 - fraction) * strength, shadow, true, light);
    if (fraction > 0)
        add_reflection(l, face, color, fraction, shadow, false, light);
    for (int c = 0; c < 3; c++)
        color[c] = l->shadow == CW_SHADOW_AMBIENT ? shadow * light[c] : light[c];
}
