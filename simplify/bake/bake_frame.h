/* Frames of texels, and the points of a full surface that they take their values from. */
#ifndef SIMPLIFY_BAKE_BAKE_FRAME_H
#define SIMPLIFY_BAKE_BAKE_FRAME_H

#include "core/geometry/bvh.h"

#include <cubewright/mesh.h>

/* The frame of a texel: place, normal, tangent and bitangent. */
typedef struct cwi_texel_frame {
    double point[3], normal[3], tangent[3], bitangent[3];
} cwi_texel_frame;

/* Interpolates the frame of a point of a triangle, as viewers do.
 * mesh      with normals; vertices have one place each
 * tangents  of its vertices, see cwi_tangents() */
void cwi_texel_frame_find(const cw_mesh *mesh, const float (*tangents)[4], uint32_t triangle,
                          const double weights[3], cwi_texel_frame *frame);

/* Computes the shares of a direction along the frame's three directions; those of its normal where the frame is
 * flat. */
void cwi_texel_share_normal(const cwi_texel_frame *frame, const double normal[3],
                            double shares[3]);

/* Writes a direction as a pixel: its parts along the frame's three directions. */
void cwi_texel_put_normal(const cwi_texel_frame *frame, const double normal[3], uint8_t *pixel);

/* Finds the triangle of the nearest point that faces the same way as a normal.
 * bound        how far it is at most if it is in reach: a guess, which saves time
 * reach        how far it may be
 * distance_sq  set to the square of its distance
 * Returns      CWI_NO_TEXEL where there is none in reach */
uint32_t cwi_facing_find(const cw_mesh *full, const cwi_boxes *tree, const double point[3],
                         const double normal[3], double bound, double reach,
                         double *distance_sq);

#endif
