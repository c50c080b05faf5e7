/* The surface inside one cell: where a trilinear function vanishes, and how near that comes. */
#ifndef SIMPLIFY_QUALITY_TRILINEAR_PATCH_H
#define SIMPLIFY_QUALITY_TRILINEAR_PATCH_H

#include <cubewright/core.h>

/* Lengths in index space as the world has them: |x|^2 = x . gram x. */
typedef struct cwi_metric {
    double gram[3][3];       /* A^T A of the volume's affine, mm^2 */
    double inverse[8][3][3]; /* of gram without the axes in a mask, where it is zero */
    double width[3];         /* how far a ball of 1 mm extends along each index axis */
    double voxel;            /* cube root of a voxel's volume, mm */
} cwi_metric;

/* From an affine, as affine.h has it, that can be inverted. */
void cwi_metric_init(cwi_metric *metric, const double *affine);

/* The eight corners' values, corner x + 2 y + 4 z, in units in which the largest is about 1. */
typedef struct cwi_patch {
    double c[8]; /* of 1, x, y, xy, z, xz, yz, xyz, from the cell's first corner */
} cwi_patch;

void cwi_patch_init(cwi_patch *patch, const double corners[8]);
double cwi_patch_value(const cwi_patch *patch, const double x[3]);

/* How much nearer the closest point may be than what is good enough, mm. */
static inline double cwi_slack(const cwi_metric *metric, double distance)
{
    return 5e-4 * distance + 5e-6 * metric->voxel;
}

/* Lowers *distance to that of the nearest point of the patch inside the unit cube from u, which
 * may be anywhere, given from the cell's first corner; within the slack. True when it did. */
bool cwi_patch_nearest(const cwi_patch *patch, const cwi_metric *metric, const double u[3],
                       double *distance);

#endif
