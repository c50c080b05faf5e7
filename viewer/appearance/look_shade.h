/* Light on surfaces whose look is compared: one matt grey material, one directional light, and light from
 * everywhere. */
#ifndef VIEWER_APPEARANCE_LOOK_SHADE_H
#define VIEWER_APPEARANCE_LOOK_SHADE_H

#include "viewer/raster/facet.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { CWI_LOOK_ALBEDO_VIEWS = 16, CWI_LOOK_ALBEDO_ROUGH = 4, CWI_LOOK_STEPS = 4096 };

/* Tables for shading: the part of light that the surface reflects at its face, and bytes of colours. */
typedef struct cwi_look_light {
    double to_light[3]; /* of length 1, in the world */
    double grey;        /* linear colour of the surface itself */
    double albedo[CWI_LOOK_ALBEDO_VIEWS][CWI_LOOK_ALBEDO_ROUGH][2]; /* for F0 and for F90 */
    uint8_t byte_of[CWI_LOOK_STEPS + 1]; /* of a linear colour, rounded down to a step */
    double first_of[257];                /* bytes: the least linear colour that rounds to it */
} cwi_look_light;

/* Makes the tables; the light's direction comes with cwi_look_turn_light(). */
void cwi_look_light_make(cwi_look_light *light);

/* Turns the light to a camera: it comes from above the left of it. */
void cwi_look_turn_light(const cwi_screen *screen, cwi_look_light *light);

/* A point of a surface that is to be shaded. */
typedef struct cwi_look_point {
    double normal[3], to_eye[3]; /* of length 1 */
    double color[3];             /* linear */
    double open;                 /* share of the light from everywhere that arrives */
    double bend; /* change of the surface's own normal from pixel to pixel: adds to roughness */
} cwi_look_point;

/* Computes the displayed colour, sRGB. */
void cwi_look_shade(const cwi_look_light *light, const cwi_look_point *point, uint8_t rgb[3]);

#ifdef __cplusplus
}
#endif

#endif
