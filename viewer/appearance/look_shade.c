/* Computes the light that a matt grey surface reflects: Lambert's law, and a microfacet model
 * [Walter2007] with its lost light given back [Turquin2019]. */
#include "viewer/appearance/look_shade.h"

#include "core/geometry/vec3.h"
#include "viewer/scene/srgb.h"

#include <math.h>

static const double ROUGHNESS = 0.8;            /* its square is alpha of the microfacets */
static const double REFLECTANCE = 0.04;         /* F0: at right angles; 1 at grazing ones */
static const double GREY = 0.8;                 /* sRGB of the surface itself: 204 of 255 */
static const double SUN = 0.85, AMBIENT = 0.15; /* light: its part from one direction, and from
                                                   everywhere */

static double limit_unit(double x)
{
    return fmin(fmax(x, 0), 1);
}

/* --- the microfacet model ----------------------------------------------------------------- */

/* Returns the visibility, times 1 / (4 nl nv), of facets in correlated shadow [Heitz2014]. */
static double visibility(double alpha_sq, double nl, double nv)
{
    const double v = nl * sqrt(alpha_sq + (1 - alpha_sq) * nv * nv),
                 l = nv * sqrt(alpha_sq + (1 - alpha_sq) * nl * nl);
    return 0.5 / fmax(v + l, 1e-6);
}

/* Returns the density of facets in a direction [Walter2007]. */
static double density(double alpha_sq, double nh)
{
    const double d = nh * nh * (alpha_sq - 1) + 1;
    return alpha_sq / (CWI_PI * d * d);
}

/* Returns (1 - vh)^5, the part of F90 in Fresnel's reflectance [Schlick1994]. */
static double grazing(double vh)
{
    const double x = 1 - vh, square = x * x;
    return square * square * x;
}

/* Integrates the reflected part of light from everywhere, for F0 and for F90 [Karis2013]: directions of
 * facets are chosen by their density. */
static void integrate_albedo(double roughness, double nv, double albedo[2])
{
    enum { STEPS = 32 };
    const double alpha = roughness * roughness, alpha_sq = alpha * alpha,
                 across = sqrt(1 - nv * nv);
    double sum[2] = {0, 0};
    for (int i = 0; i < STEPS * STEPS; i++) {
        const double u = (i / STEPS + 0.5) / STEPS, phi = CWI_PI * (i % STEPS + 0.5) / STEPS;
        const double nh = sqrt((1 - u) / (1 + (alpha_sq - 1) * u));
        const double vh = across * sqrt(1 - nh * nh) * cos(phi) + nv * nh,
                     nl = 2 * vh * nh - nv;
        if (!(nl > 0 && vh > 0))
            continue;
        const double all = 4 * visibility(alpha_sq, nl, nv) * nl * vh / nh;
        sum[0] += all * (1 - grazing(vh));
        sum[1] += all * grazing(vh);
    }
    albedo[0] = sum[0] / (STEPS * STEPS);
    albedo[1] = sum[1] / (STEPS * STEPS);
}

/* Looks the albedo up, between the middles of the table's cells. */
static void find_albedo(const cwi_look_light *light, double roughness, double nv,
                        double albedo[2])
{
    const double all = CWI_LOOK_ALBEDO_VIEWS;
    const double x = fmin(roughness * all - 0.5, all - 1) - (all - CWI_LOOK_ALBEDO_ROUGH),
                 y = fmin(fmax(nv * all - 0.5, 0), all - 1);
    const int c = x < CWI_LOOK_ALBEDO_ROUGH - 1 ? (int)fmax(x, 0) : CWI_LOOK_ALBEDO_ROUGH - 2,
              r = y < all - 1 ? (int)y : CWI_LOOK_ALBEDO_VIEWS - 2;
    const double right = x - c, down = y - r;
    for (int k = 0; k < 2; k++)
        albedo[k] = (1 - down) * ((1 - right) * light->albedo[r][c][k] +
                                  right * light->albedo[r][c + 1][k]) +
                    down * ((1 - right) * light->albedo[r + 1][c][k] +
                            right * light->albedo[r + 1][c + 1][k]);
}

/* --- tables ------------------------------------------------------------------------------- */

static void make_bytes(cwi_look_light *light)
{
    int byte = 0;
    for (int n = 0; n < 256; n++)
        light->first_of[n] = n ? cwi_srgb_to_linear((n - 0.5) / 255) : 0;
    light->first_of[256] = INFINITY;
    for (int n = 0; n <= CWI_LOOK_STEPS; n++) {
        while ((double)n / CWI_LOOK_STEPS >= light->first_of[byte + 1])
            byte++;
        light->byte_of[n] = (uint8_t)byte;
    }
}

void cwi_look_light_make(cwi_look_light *light)
{
    const int all = CWI_LOOK_ALBEDO_VIEWS, first = all - CWI_LOOK_ALBEDO_ROUGH;
    for (int y = 0; y < all; y++)
        for (int x = 0; x < CWI_LOOK_ALBEDO_ROUGH; x++)
            integrate_albedo((first + x + 0.5) / all, (y + 0.5) / all, light->albedo[y][x]);
    light->grey = cwi_srgb_to_linear(GREY);
    make_bytes(light);
}

void cwi_look_turn_light(const cwi_screen *screen, cwi_look_light *light)
{
    for (int a = 0; a < 3; a++)
        light->to_light[a] = -0.6 * screen->right[a] + 0.8 * screen->up[a] - screen->forward[a];
    cwi_to_unit(light->to_light);
}

/* Rounds a linear colour to a byte of sRGB. */
static uint8_t to_byte(const cwi_look_light *light, double linear)
{
    const double x = limit_unit(linear);
    int byte = light->byte_of[(int)(x * CWI_LOOK_STEPS)];
    while (x >= light->first_of[byte + 1])
        byte++;
    return (uint8_t)byte;
}

/* --- a point ------------------------------------------------------------------------------ */

void cwi_look_shade(const cwi_look_light *light, const cwi_look_point *p, uint8_t rgb[3])
{
    const double roughness = fmin(ROUGHNESS + p->bend, 1), alpha = roughness * roughness;
    double half[3], albedo[2];
    for (int a = 0; a < 3; a++)
        half[a] = light->to_light[a] + p->to_eye[a];
    cwi_to_unit(half);
    const double nl = limit_unit(cwi_dot(p->normal, light->to_light)),
                 nv = limit_unit(cwi_dot(p->normal, p->to_eye)),
                 nh = limit_unit(cwi_dot(p->normal, half)),
                 vh = limit_unit(cwi_dot(p->to_eye, half));
    find_albedo(light, roughness, nv, albedo);
    const double fresnel = REFLECTANCE + (1 - REFLECTANCE) * grazing(vh);
    const double gain = 1 + REFLECTANCE * (1 / (albedo[0] + albedo[1]) - 1);
    const double gloss = fresnel * gain * visibility(alpha * alpha, nl, nv) *
                         density(alpha * alpha, nh) * nl * SUN * CWI_PI;
    /* Light that the face reflects, once and more often, does not reach the matt ground below. */
    const double single = REFLECTANCE * albedo[0] + albedo[1], lost = 1 - albedo[0] - albedo[1],
                 mean = REFLECTANCE + (1 - REFLECTANCE) / 21,
                 several = single * mean / (1 - lost * mean) * lost;
    const double matt = SUN * nl * (1 - fresnel) + AMBIENT * p->open * (1 - single - several);
    for (int c = 0; c < 3; c++)
        rgb[c] = to_byte(light, light->grey * p->color[c] * matt + gloss);
}
