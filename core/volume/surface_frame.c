/* Computes the directions and the scale of a volume's surfaces. */
#include "core/volume/surface_frame.h"

#include "core/geometry/affine.h"
#include "core/volume/volume.h"

#include <math.h>

void cwi_outward(const cw_volume *volume, bool invert, double cofactor[3][3])
{
    const double *affine = volume->affine[0];
    const double sign = (cwi_affine_determinant(affine) < 0) != invert ? 1 : -1;
    double largest = 0;
    cwi_affine_cofactor(affine, cofactor);
    for (int i = 0; i < 9; i++)
        largest = fmax(largest, fabs(cofactor[i / 3][i % 3]));
    for (int i = 0; i < 9; i++)
        cofactor[i / 3][i % 3] *= sign / largest;
}

double cwi_voxel_scale(const cw_volume *v)
{
    double largest = 0;
    int exponent;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            largest = fmax(largest, fabs(v->affine[r][c]));
    frexp(largest, &exponent);
    return ldexp(1, -exponent);
}

void cwi_surface_frame_make(const cw_volume *v, bool invert, cwi_surface_frame *frame)
{
    cwi_outward(v, invert, frame->cofactor);
    frame->is_diagonal = true;
    for (int r = 0; r < 3; r++) {
        frame->is_diagonal = frame->is_diagonal && v->affine[r][(r + 1) % 3] == 0 &&
                             v->affine[r][(r + 2) % 3] == 0;
        frame->center[r] = 0.5 * (cwi_grid_coordinate(v, r, 0, 0) +
                                  cwi_grid_coordinate(v, r, (ptrdiff_t)v->dim[r] - 1, 0));
    }
    for (int a = 0; a < 3; a++) {
        double length_sq = 0;
        for (int r = 0; r < 3; r++)
            length_sq += frame->cofactor[r][a] * frame->cofactor[r][a];
        for (int r = 0; r < 3; r++) {
            const double n = frame->cofactor[r][a] / sqrt(length_sq) * (invert ? 1 : -1);
            frame->cap[a][0][r] = (float)-n;
            frame->cap[a][1][r] = (float)n;
        }
    }
}
