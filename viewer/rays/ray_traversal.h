/* The cells a ray goes through, and the field along it: trilinear in a cell, so a cubic on a
 * line. */
#ifndef VIEWER_RAYS_RAY_TRAVERSAL_H
#define VIEWER_RAYS_RAY_TRAVERSAL_H

#include "viewer/scene/block_ranges.h"
#include "viewer/scene/frame_setup.h"

#include "core/geometry/vec3.h"

#include <math.h>

#ifdef __cplusplus
extern "C" {
#endif

/* About the number of samples that a ray meets: the estimated work for a row of the picture. */
enum { CWI_RAY_SAMPLES = 512 };

/* A ray of the picture and the parts of it that are drawn, in units of eye space along it. */
typedef struct cwi_ray {
    double origin[3], direction[3]; /* eye space */
    double index[3], slope[3];      /* the same in index space */
    double parts[2][2];
    int part_count;
} cwi_ray;

/* Makes the ray through a point of the picture, as cwi_frame_ray(); nothing of it is drawn
 * beyond a depth (INFINITY: all is drawn). */
void cwi_ray_make(const cwi_frame *frame, double x, double y, double depth, cwi_ray *ray);

/* A walk from cell to cell. An axis of one voxel has one cell, from -0.5 to 0.5. */
typedef struct cwi_walk {
    const cw_volume *volume, *gradient_volume;
    const float *shadows; /* as the frame's */
    double index[3], slope[3], inverse[3];
    double next[3];            /* where the ray meets the next plane of voxels of each axis */
    ptrdiff_t cell[3], end[3]; /* end: the cell beyond the last along the ray */
    double t, stop;
    ptrdiff_t at[3]; /* the cell that was found, */
    double from, to; /* and the part of the ray in it */
    int leave;       /* the axis it is left along */
} cwi_walk;

void cwi_walk_start(cwi_walk *walk, const cwi_frame *frame, const cwi_ray *ray, int part);

/* Returns where the ray leaves the cell along an axis. Planes are computed from their number,
 * not from the plane before: errors do not add up. */
static inline double cwi_walk_plane(const cwi_walk *w, int axis)
{
    const double plane = (double)(w->cell[axis] + (w->slope[axis] > 0));
    return w->slope[axis] == 0 || w->volume->dim[axis] == 1
               ? INFINITY
               : (plane - w->index[axis]) * w->inverse[axis];
}

/* Goes to the next cell, of which more than a point is met; returns false if there is none.
 * Rounding may put the start behind a plane it is close to: cells of zero length are
 * skipped. */
static inline bool cwi_walk_next(cwi_walk *w)
{
    while (w->t < w->stop) {
        const int a = w->next[0] < w->next[1] ? (w->next[0] < w->next[2] ? 0 : 2)
                                              : (w->next[1] < w->next[2] ? 1 : 2);
        for (int i = 0; i < 3; i++)
            w->at[i] = w->cell[i];
        w->from = w->t;
        w->to = cwi_lesser(cwi_greater(w->next[a], w->t), w->stop);
        w->t = w->to;
        w->leave = a;
        w->cell[a] += w->slope[a] > 0 ? 1 : -1;
        if (w->cell[a] == w->end[a])
            w->t = w->stop;
        else
            w->next[a] = cwi_walk_plane(w, a);
        if (w->to > w->from)
            return true;
    }
    return false;
}

/* Returns the number of the block that the next cell is in, in a lattice of dim blocks of
 * CWI_RANGE_EDGE cells a side; and whether that is not the block of the current cell. */
static inline size_t cwi_walk_block(const cwi_walk *w, const size_t dim[3])
{
    const size_t i = (size_t)w->cell[0] / CWI_RANGE_EDGE,
                 j = (size_t)w->cell[1] / CWI_RANGE_EDGE,
                 k = (size_t)w->cell[2] / CWI_RANGE_EDGE;
    return (k * dim[1] + j) * dim[0] + i;
}

static inline bool cwi_walk_changes_block(const cwi_walk *w)
{
    return (w->cell[w->leave] ^ w->at[w->leave]) & CWI_RANGE_EDGE;
}

/* Leaves empty blocks of `edge` cells a side: the block of the next cell, and those around it
 * less than `distance` blocks away along every axis. */
void cwi_walk_leap(cwi_walk *walk, int edge, int distance);

/* Reads the values at the cell's corners; bit a of a corner's number is its place along axis a.
 * Returns false when one of them has no value: then the cell is empty. */
bool cwi_walk_values(const cwi_walk *walk, double v[8]);

/* Computes the field on the walk's part of the ray: c[0] + c[1] x + c[2] x^2 + c[3] x^3, x from
 * 0 to 1. */
void cwi_walk_cubic(const cwi_walk *walk, const double v[8], double c[4]);

/* Computes the gradient at the cell's corners, per voxel: central differences, one-sided at the
 * border; 0 where a neighbour has no value, and along an axis of one voxel. */
void cwi_walk_gradients(const cwi_walk *walk, double g[3][8]);

/* Reads the shadows at the cell's corners; 1 where there are none. */
void cwi_walk_shadows(const cwi_walk *walk, double shadows[8]);

#ifdef __cplusplus
}
#endif

#endif
