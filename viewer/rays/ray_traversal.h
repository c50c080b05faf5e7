/* The cells a ray goes through, and the field along it: trilinear in a cell, so a cubic on a
 * line. */
#ifndef VIEWER_RAYS_RAY_TRAVERSAL_H
#define VIEWER_RAYS_RAY_TRAVERSAL_H

#include "viewer/scene/block_ranges.h"
#include "viewer/scene/frame_setup.h"

#include "core/geometry/vec3.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

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

/* A walk from cell to cell. An axis of one voxel has one cell, from -0.5 to 0.5. Each array has
 * a fourth number, so that two pairs are computed at once. */
typedef struct cwi_walk {
    double index[4], slope[4], inverse[4];
    double plane[4];   /* the next plane of voxels of each axis; INFINITY: none, */
    double next[4];    /* and where the ray meets it */
    double advance[4]; /* to the plane after that: 1 or -1; as step */
    int64_t cell[4], step[4];
    int64_t at[4];   /* the cell that was found, */
    double from, to; /* and the part of the ray in it */
    double t, stop;
    const cw_volume *volume, *gradient_volume;
    const float *shadows; /* as the frame's */
} cwi_walk;

typedef double cwi_pair __attribute__((vector_size(16)));
typedef int64_t cwi_int_pair __attribute__((vector_size(16)));

static inline cwi_pair cwi_pair_load(const double *p)
{
    cwi_pair v;
    memcpy(&v, p, sizeof v);
    return v;
}

static inline cwi_int_pair cwi_int_pair_load(const int64_t *p)
{
    cwi_int_pair v;
    memcpy(&v, p, sizeof v);
    return v;
}

void cwi_walk_start(cwi_walk *walk, const cwi_frame *frame, const cwi_ray *ray, int part);

/* Goes to the next cell, of which more than a point is met; returns false if there is none.
 * Rounding may put the start behind a plane it is close to: cells of zero length are skipped.
 * There are no branches by axis, which no processor foresees. Distances are computed from the
 * number of the plane, not from the plane before: errors do not add up. */
static inline bool cwi_walk_next(cwi_walk *w)
{
    while (w->t < w->stop) {
        const double nearest = cwi_lesser(cwi_lesser(w->next[0], w->next[1]), w->next[2]);
        w->from = w->t;
        w->to = w->t = cwi_lesser(cwi_greater(nearest, w->t), w->stop);
        for (int n = 0; n < 4; n += 2) {
            const cwi_int_pair is_left =
                cwi_pair_load(w->next + n) == (cwi_pair){nearest, nearest};
            const cwi_int_pair cell = cwi_int_pair_load(w->cell + n),
                               after = cell + (is_left & cwi_int_pair_load(w->step + n));
            const cwi_pair move = (cwi_pair)(is_left &
                                             (cwi_int_pair)cwi_pair_load(w->advance + n)),
                           plane = cwi_pair_load(w->plane + n) + move,
                           next = (plane - cwi_pair_load(w->index + n)) *
                                  cwi_pair_load(w->inverse + n);
            memcpy(w->at + n, &cell, sizeof cell);
            memcpy(w->cell + n, &after, sizeof after);
            memcpy(w->plane + n, &plane, sizeof plane);
            memcpy(w->next + n, &next, sizeof next);
        }
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
    return ((w->cell[0] ^ w->at[0]) | (w->cell[1] ^ w->at[1]) | (w->cell[2] ^ w->at[2])) &
           CWI_RANGE_EDGE;
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
