/* Steps from triangle to triangle of a surface, across sides and corners, to where a point is
 * near. */
#ifndef CORE_MESH_SURFACE_WALK_H
#define CORE_MESH_SURFACE_WALK_H

#include "core/geometry/point_triangle.h"
#include "core/mesh/corner_table.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Triangles, and for each vertex the triangles around it, as cwi_fans_sort() makes them. */
typedef struct cwi_fans {
    const float *points;     /* vertices x 3 */
    const uint32_t *corners; /* triangles x 3 */
    const uint32_t *first;   /* vertices + 1 */
    const uint32_t *around;
} cwi_fans;

/* Triangles around a vertex above which the fan is wide: walks neither search it nor begin at any
 * triangle of it, as they would take steps in proportion to its size. */
enum { CWI_WIDE_FAN = 512 };

typedef struct cwi_surface_walk {
    const cwi_fans *fans;
    double enough; /* the square of a distance: corners are not crossed for less */
    uint32_t at;   /* the triangle where the walk stands */
} cwi_surface_walk;

static inline bool cwi_fan_is_wide(const cwi_fans *f, uint32_t vertex)
{
    return f->first[vertex + 1] - f->first[vertex] > CWI_WIDE_FAN;
}

/* Sets the corners of the triangle where a walk stands. */
static inline void cwi_walk_facet(const cwi_surface_walk *w, uint32_t triangle,
                                  const float *facet[3])
{
    const uint32_t *c = w->fans->corners + 3 * (size_t)triangle;
    for (int k = 0; k < 3; k++)
        facet[k] = w->fans->points + 3 * (size_t)c[k];
}

static inline double cwi_walk_square(const cwi_surface_walk *w, uint32_t triangle,
                                     const double p[3])
{
    const float *facet[3];
    cwi_walk_facet(w, triangle, facet);
    return cwi_facet_distance_sq(facet[0], facet[1], facet[2], p);
}

/* A triangle seen from the point that is walked to. */
static inline cwi_facet_view cwi_walk_look(const cwi_surface_walk *w, uint32_t triangle,
                                           const double p[3])
{
    const float *f[3];
    cwi_walk_facet(w, triangle, f);
    return cwi_facet_look(f[0], f[1], f[2], p);
}

/* Goes to a triangle if it is nearer. */
static inline bool cwi_walk_take(cwi_surface_walk *w, uint32_t triangle, const double p[3],
                                 cwi_facet_view *view, double *nearest_sq)
{
    const cwi_facet_view other = cwi_walk_look(w, triangle, p);
    const double distance_sq = cwi_facet_view_distance_sq(&other);
    if (!(distance_sq < *nearest_sq))
        return false;
    *nearest_sq = distance_sq;
    *view = other;
    w->at = triangle;
    return true;
}

/* Swaps the ends of an edge if fewer triangles are around the second. The edge's triangles are around
 * both, in the same order. */
static inline void cwi_fans_choose_end(const cwi_fans *f, uint32_t *from, uint32_t *to)
{
    const uint32_t end = *from;
    if (f->first[*to + 1] - f->first[*to] < f->first[end + 1] - f->first[end]) {
        *from = *to;
        *to = end;
    }
}

/* Crosses a side if that leads nearer. */
static inline bool cwi_walk_cross(cwi_surface_walk *w, uint32_t from, uint32_t to,
                                  const double p[3], cwi_facet_view *view, double *nearest_sq)
{
    const cwi_fans *f = w->fans;
    cwi_fans_choose_end(f, &from, &to);
    for (uint32_t n = f->first[from]; n < f->first[from + 1]; n++) {
        const uint32_t t = f->around[n], *c = f->corners + 3 * (size_t)t;
        if (t != w->at && (c[0] == to || c[1] == to || c[2] == to) &&
            cwi_walk_take(w, t, p, view, nearest_sq))
            return true;
    }
    return false;
}

/* Crosses a side that the point is beyond. */
static inline bool cwi_walk_step(cwi_surface_walk *w, const double p[3], cwi_facet_view *view,
                                 double *nearest_sq)
{
    const uint32_t *c = w->fans->corners + 3 * (size_t)w->at;
    return (view->in_c < 0 && cwi_walk_cross(w, c[0], c[1], p, view, nearest_sq)) ||
           (view->in_a < 0 && cwi_walk_cross(w, c[1], c[2], p, view, nearest_sq)) ||
           (view->in_b < 0 && cwi_walk_cross(w, c[2], c[0], p, view, nearest_sq));
}

/* Goes to the nearest triangle at a corner whose fan is not wide. */
static inline bool cwi_walk_jump(cwi_surface_walk *w, const double p[3], cwi_facet_view *view,
                                 double *nearest_sq)
{
    const cwi_fans *f = w->fans;
    const uint32_t start = w->at, *c = f->corners + 3 * (size_t)start;
    for (int k = 0; k < 3; k++) {
        if (cwi_fan_is_wide(f, c[k]))
            continue;
        for (uint32_t n = f->first[c[k]]; n < f->first[c[k] + 1]; n++)
            cwi_walk_take(w, f->around[n], p, view, nearest_sq);
    }
    return w->at != start;
}

/* Walks to a triangle near a point, and returns the square of the point's distance from it. Sides
 * are crossed as far as that helps. Folds of the surface can keep the nearest triangle out of
 * sight: if what was found is too far, triangles at corners are looked at, too. */
static inline double cwi_walk_to(cwi_surface_walk *w, const double p[3])
{
    cwi_facet_view view = cwi_walk_look(w, w->at, p);
    double nearest_sq = cwi_facet_view_distance_sq(&view);
    while (cwi_walk_step(w, p, &view, &nearest_sq)) {
    }
    while (nearest_sq > w->enough && cwi_walk_jump(w, p, &view, &nearest_sq)) {
    }
    return nearest_sq;
}

#ifdef __cplusplus
}
#endif

#endif
