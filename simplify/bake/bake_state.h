/* A bake at work: both surfaces, the place of a texel on them, and the functions that make maps of it. */
#ifndef SIMPLIFY_BAKE_BAKE_STATE_H
#define SIMPLIFY_BAKE_BAKE_STATE_H

#include <cubewright/bake.h>

#include "core/geometry/bvh.h"

/* Both surfaces. Places are relative to the origin of the full one. */
typedef struct cwi_baking {
    cw_mesh mesh;         /* a copy, with vertices split at seams */
    const cw_mesh *full;  /* with normals */
    cw_mesh own;          /* the copy that full is, where it had none; or empty */
    float (*tangents)[4]; /* vertices of mesh */
    cwi_boxes tree;       /* triangles of full */
    double reach;         /* mm: how far full may be */
    double shift[3];      /* from mesh's origin to that of full */
    double bias;          /* mm: rays start this far off the surface */
    double occlusion_mm;  /* length of rays that may be blocked */
    double thickness_mm;  /* that is white */
    float *curvature;     /* vertices of full, 1 / mm; NULL: not asked for */
    double curvature_max; /* 1 / mm: that is white */
} cwi_baking;

/* The frame that a viewer has at a texel, and its place on the mesh. Directions have the length 1. */
typedef struct cwi_texel_frame {
    double point[3], normal[3], tangent[3], bitangent[3];
} cwi_texel_frame;

/* The nearest point of the full surface that faces the same way. */
typedef struct cwi_texel_hit {
    uint32_t triangle;
    double weights[3]; /* of its corners */
    double point[3], normal[3];
    double distance_mm;
} cwi_texel_hit;

/* Makes a texel: red, green and blue from 0 to 1. hit: NULL: the texel found nothing, or lies in no chart */
typedef void cwi_texel_shader(const cwi_baking *b, const cwi_texel_frame *frame,
                              const cwi_texel_hit *hit, double color[3]);

cwi_texel_shader cwi_shade_normal, cwi_shade_occlusion, cwi_shade_curvature,
    cwi_shade_thickness, cwi_shade_color;

/* Interpolates the frame at a texel of a triangle of b->mesh. size: texels along each side */
void cwi_texel_frame_find(const cwi_baking *b, uint32_t triangle, uint32_t size, uint32_t x,
                          uint32_t y, cwi_texel_frame *frame);

/* Finds the nearest point of the full surface that faces the same way as a frame. bound: mm in which one is
 * thought to be. Returns false where none is in reach. */
bool cwi_texel_hit_find(const cwi_baking *b, const cwi_texel_frame *frame, double bound,
                        cwi_texel_hit *hit);

/* Fills b->curvature, and b->curvature_max unless it is set. Returns CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_curvature_find(cwi_baking *b, cw_error *err);

#endif
