/* Planes of a cut: checked, and moved onto vertices that they are meant to meet. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "simplify/pieces/pieces_state.h"

#include <math.h>

/* Makes two axes across the normal; along the axes of the world where the normal is one. */
static void make_frame(cwi_cut_plane *p)
{
    const int axis = cwi_longest_axis(p->normal);
    double next[3] = {0};
    next[(axis + 1) % 3] = 1;
    cwi_cross(p->normal, next, p->v);
    cwi_normalise(p->v);
    cwi_cross(p->v, p->normal, p->u);
}

static cw_status check_plane(const cw_cut_desc *d, size_t n, cw_error *err)
{
    if (d->version > 0)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "plane %zu: its version is %u; this library knows up to 0", n + 1,
                        (unsigned)d->version);
    for (int a = 0; a < 3; a++)
        if (!isfinite(d->normal[a]) || !isfinite(d->point[a]))
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "plane %zu: point and normal must be finite; found %g and %g",
                            n + 1, d->point[a], d->normal[a]);
    if (d->normal[0] == 0 && d->normal[1] == 0 && d->normal[2] == 0)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "plane %zu: the normal is 0, 0, 0; it must have a length", n + 1);
    return CW_OK;
}

/* Returns the distance of the nearest vertex if that is within the tolerance, else 0; and the range of all. */
static double measure_vertices(const cwi_cutter *c, const cwi_cut_plane *p, double range[2])
{
    double nearest = INFINITY;
    range[0] = INFINITY;
    range[1] = -INFINITY;
    for (size_t v = 0; v < c->mesh->vertex_count; v++) {
        double x[3];
        cwi_plane_local(p, c->mesh->positions + 3 * v, x);
        range[0] = cwi_lesser(range[0], x[2]);
        range[1] = cwi_greater(range[1], x[2]);
        if (fabs(x[2]) < fabs(nearest))
            nearest = x[2];
    }
    return fabs(nearest) <= c->tolerance ? nearest : 0;
}

static cw_status place_plane(cwi_cutter *c, const cw_cut_desc *d, size_t n, cw_error *err)
{
    cwi_cut_plane *p = &c->planes[n];
    double at[3], range[2], offset = 0;
    cw_status st = check_plane(d, n, err);
    if (st != CW_OK)
        return st;
    for (int a = 0; a < 3; a++) {
        p->normal[a] = d->normal[a];
        at[a] = d->point_is_percent ? c->low[a] + (c->high[a] - c->low[a]) * d->point[a] / 100
                                    : d->point[a] - c->mesh->origin[a];
    }
    cwi_normalise(p->normal);
    make_frame(p);
    for (int a = 0; a < 3; a++)
        offset += p->normal[a] == 0 ? 0 : p->normal[a] * (at[a] - (c->low[a] + c->high[a]) / 2);
    for (int a = 0; a < 3; a++) /* the middle of the box, moved along the normal */
        p->point[a] = (c->low[a] + c->high[a]) / 2 + offset * p->normal[a];
    const double nearest = measure_vertices(c, p, range);
    if (range[0] > c->tolerance || range[1] < -c->tolerance) {
        const double here = cwi_dot(p->normal, p->point) + cwi_dot(p->normal, c->mesh->origin);
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "plane %zu misses the mesh: it is at %.6g mm along its normal %.3g, %.3g, %.3g, and "
            "the mesh reaches from %.6g to %.6g mm",
            n + 1, here, p->normal[0], p->normal[1], p->normal[2], here + range[0],
            here + range[1]);
    }
    cwi_add_scaled(p->point, nearest, p->normal, p->point);
    return CW_OK;
}

cw_status cwi_place_planes(cwi_cutter *c, const cw_cut_desc *planes, size_t count,
                           cw_error *err)
{
    cw_status st = CW_OK;
    c->planes = cwi_alloc_zeroed(count, sizeof *c->planes);
    if (!c->planes)
        return cwi_fail_memory(err);
    c->plane_count = count;
    for (size_t n = 0; n < count && st == CW_OK; n++)
        st = place_plane(c, &planes[n], n, err);
    return st;
}
