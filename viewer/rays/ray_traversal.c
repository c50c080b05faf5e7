/* Walks a ray from cell to cell, and finds the field's values, gradients and cubics along
 * it. */
#include "viewer/rays/ray_traversal.h"
#include "viewer/scene/cell_lattice.h"

#include "core/geometry/affine.h"
#include "core/volume/volume.h"

#include <string.h>

void cwi_ray_make(const cwi_frame *f, double x, double y, double depth, cwi_ray *ray)
{
    cwi_frame_ray(f, x, y, ray->origin, ray->direction);
    cwi_affine_apply(f->index_from_eye, ray->origin, ray->index);
    for (size_t r = 0; r < 3; r++)
        ray->slope[r] = cwi_dot(f->index_from_eye + 4 * r, ray->direction);
    const int count = cwi_frame_clip(f, ray->origin, ray->direction, ray->parts);
    const double end = depth / -ray->direction[2];
    ray->part_count = 0;
    for (int n = 0; n < count; n++) {
        ray->parts[n][1] = fmin(ray->parts[n][1], end);
        ray->part_count += ray->parts[n][0] < ray->parts[n][1];
    }
}

static ptrdiff_t cells_along(const cw_volume *v, int axis)
{
    return v->dim[axis] > 1 ? (ptrdiff_t)v->dim[axis] - 1 : 1;
}

/* Finds where the ray leaves the cell along an axis. */
static void find_next_plane(cwi_walk *w, int axis)
{
    w->plane[axis] = w->slope[axis] != 0 && w->volume->dim[axis] > 1
                         ? (double)(w->cell[axis] + (w->slope[axis] > 0))
                         : INFINITY;
    w->next[axis] = (w->plane[axis] - w->index[axis]) * w->inverse[axis];
}

void cwi_walk_start(cwi_walk *w, const cwi_frame *f, const cwi_ray *ray, int part)
{
    *w = (cwi_walk){.volume = &f->volume,
                    .gradient_volume = &f->gradient_volume,
                    .shadows = f->shadows,
                    .t = ray->parts[part][0],
                    .stop = ray->parts[part][1]};
    w->next[3] = INFINITY;
    for (int a = 0; a < 3; a++) {
        w->index[a] = ray->index[a];
        w->slope[a] = ray->slope[a];
        const ptrdiff_t cells = cells_along(w->volume, a);
        const double at = w->volume->dim[a] > 1 ? floor(w->index[a] + w->t * w->slope[a]) : 0;
        const bool rises = w->slope[a] > 0,
                   is_crossed = w->slope[a] != 0 && w->volume->dim[a] > 1;
        w->cell[a] = (ptrdiff_t)fmin(fmax(at, 0), (double)(cells - 1));
        w->step[a] = rises ? 1 : -1;
        w->advance[a] = rises ? 1 : -1;
        w->inverse[a] = is_crossed ? 1 / w->slope[a] : 1;
        find_next_plane(w, a);
        if (is_crossed)
            w->stop = cwi_lesser(w->stop,
                                 ((rises ? (double)cells : 0) - w->index[a]) * w->inverse[a]);
    }
}

/* Returns the cell at w->t along an axis. Rounding never takes a ray back to a cell it has
 * left; else it might go back and forth forever. */
static ptrdiff_t cell_after(const cwi_walk *w, int axis)
{
    const ptrdiff_t max = cells_along(w->volume, axis) - 1, before = w->cell[axis];
    ptrdiff_t cell = (ptrdiff_t)(w->index[axis] + w->t * w->slope[axis]);
    if (w->slope[axis] > 0 ? cell < before : cell > before)
        cell = before;
    return w->volume->dim[axis] == 1 || cell < 0 ? 0 : cell > max ? max : cell;
}

void cwi_walk_leap(cwi_walk *w, int edge, int distance)
{
    double to = INFINITY;
    int leave = 0;
    ptrdiff_t cell = 0;
    for (int a = 0; a < 3; a++) {
        const ptrdiff_t block = w->cell[a] / edge;
        const bool rises = w->slope[a] > 0;
        const ptrdiff_t plane = edge * (rises ? block + distance : block - distance + 1);
        const double t =
            w->next[a] < INFINITY ? ((double)plane - w->index[a]) * w->inverse[a] : INFINITY;
        if (t < to) {
            to = t;
            leave = a;
            cell = rises ? plane : plane - 1;
        }
    }
    w->t = cwi_greater(w->t, to);
    if (!(w->t < w->stop))
        return;
    for (int a = 0; a < 3; a++) {
        w->cell[a] = a == leave ? cell : cell_after(w, a);
        find_next_plane(w, a);
    }
    if (cell < 0 || cell >= cells_along(w->volume, leave))
        w->t = w->stop;
}

/* Reads the stored numbers at the corners, from the address of the first. */
static void read_corners(const cw_volume *volume, const char *p, double x[8])
{
    ptrdiff_t side[3];
    for (int a = 0; a < 3; a++)
        side[a] = volume->dim[a] > 1 ? volume->stride[a] : 0;
    switch (volume->type) {
#define CASE(name, ctype, text)                                                                \
    case name:                                                                                 \
        for (int n = 0; n < 8; n += 2) {                                                       \
            const char *edge = p + (n >> 1 & 1) * side[1] + (n >> 2) * side[2];                \
            x[n] = (double)*(const ctype *)edge;                                               \
            x[n + 1] = (double)*(const ctype *)(edge + side[0]);                               \
        }                                                                                      \
        break;
        CW_TYPE_TABLE(CASE)
#undef CASE
    default:
        break;
    }
}

bool cwi_walk_values(const cwi_walk *w, double v[8])
{
    const cw_volume *volume = w->volume;
    const char *base = (const char *)volume->data + w->at[0] * volume->stride[0] +
                       w->at[1] * volume->stride[1] + w->at[2] * volume->stride[2];
    double x[8] = {0}, none = 0;
    read_corners(volume, base, x);
    for (int n = 0; n < 8; n++) {
        none += x[n] - x[n]; /* 0, or NaN */
        v[n] = volume->slope * x[n] + volume->intercept;
    }
    for (int n = 0; n < 8 && volume->has_nodata; n++)
        if (x[n] == volume->nodata)
            return false;
    return none == 0;
}

/* Interpolates along x, which makes a line of each edge, then along y and z, each of which
 * raises the degree. */
void cwi_walk_cubic(const cwi_walk *w, const double v[8], double c[4])
{
    double s[3], d[3], line[4][2], q[2][3];
    for (int a = 0; a < 3; a++) {
        s[a] = w->index[a] + w->from * w->slope[a] - (double)w->at[a];
        d[a] = (w->to - w->from) * w->slope[a];
    }
    for (int n = 0; n < 4; n++) {
        const double rise = v[2 * n + 1] - v[2 * n];
        line[n][0] = v[2 * n] + rise * s[0];
        line[n][1] = rise * d[0];
    }
    for (int n = 0; n < 2; n++) {
        const double *a = line[2 * n], *b = line[2 * n + 1];
        const double rise[2] = {b[0] - a[0], b[1] - a[1]};
        q[n][0] = a[0] + rise[0] * s[1];
        q[n][1] = a[1] + rise[1] * s[1] + rise[0] * d[1];
        q[n][2] = rise[1] * d[1];
    }
    const double rise[3] = {q[1][0] - q[0][0], q[1][1] - q[0][1], q[1][2] - q[0][2]};
    c[0] = q[0][0] + rise[0] * s[2];
    c[1] = q[0][1] + rise[1] * s[2] + rise[0] * d[2];
    c[2] = q[0][2] + rise[2] * s[2] + rise[1] * d[2];
    c[3] = rise[2] * d[2];
}

void cwi_walk_gradients(const cwi_walk *w, double g[3][8])
{
    const cw_volume *v = w->gradient_volume;
    for (int n = 0; n < 8; n++) {
        size_t at[3];
        for (int a = 0; a < 3; a++)
            at[a] = (size_t)w->at[a] + (v->dim[a] > 1 && (n >> a & 1));
        double gradient[3];
        cwi_lattice_gradient(v, at, gradient);
        for (int a = 0; a < 3; a++) {
            const double scaled = v->slope * gradient[a];
            g[a][n] = isfinite(scaled) ? scaled : 0;
        }
    }
}

void cwi_walk_shadows(const cwi_walk *w, double shadows[8])
{
    const size_t *dim = w->volume->dim, row = dim[0], slice = dim[0] * dim[1];
    const size_t side[3] = {dim[0] > 1, dim[1] > 1 ? row : 0, dim[2] > 1 ? slice : 0};
    const size_t first = (size_t)w->at[2] * slice + (size_t)w->at[1] * row + (size_t)w->at[0];
    for (int n = 0; n < 8; n++)
        shadows[n] = w->shadows
                         ? (double)w->shadows[first + (n & 1 ? side[0] : 0) +
                                              (n & 2 ? side[1] : 0) + (n & 4 ? side[2] : 0)]
                         : 1;
}
