/* Places a cluster's vertex, and decides if the cone over the rim of its star is good
 * enough. */
#include "core/geometry/triangle_separation.h"
#include "core/geometry/vec3.h"
#include "extract/dense/ambiguous_cells.h"
#include "extract/snap/snap_cluster.h"

#include <math.h>
#include <string.h>

/* Limits in voxels: a vertex stays as close to its sample as its crossings are, and keeps off
 * the middle between two samples. */
#define FARTHEST 0.49
#define ROUNDING 1e-4

/* Maximum distance of a merged vertex from the surface, in voxels, times the share. */
#define MAX_ERROR 0.25

/* ---- where a cluster goes --------------------------------------------------------------- */

/* Evaluates the trilinear field and its gradient; NaN where the field has none. */
static double evaluate_field(const cwi_bit_grid *g, const double x[3], double gradient[3])
{
    size_t at[3];
    double t[3], corner[8], value = 0;
    for (int a = 0; a < 3; a++) {
        at[a] = (size_t)x[a];
        t[a] = x[a] - (double)at[a];
        gradient[a] = 0;
    }
    cwi_corner_values(g, at, corner);
    for (size_t c = 0; c < 8; c++) {
        const double f = corner[c];
        double weight[3];
        for (int a = 0; a < 3; a++)
            weight[a] = c >> a & 1 ? t[a] : 1 - t[a];
        value += f * weight[0] * weight[1] * weight[2];
        for (int a = 0; a < 3; a++)
            gradient[a] += (c >> a & 1 ? f : -f) * weight[(a + 1) % 3] * weight[(a + 2) % 3];
    }
    return value;
}

/* Takes a step of Newton's method along the gradient, the locked axes kept, towards a value. */
static bool approach_level(const cwi_bit_grid *g, double target, const bool locked[3],
                           double x[3])
{
    double gradient[3], largest = 0, gradient_sq = 0;
    const double miss = evaluate_field(g, x, gradient) - target;
    for (int a = 0; a < 3; a++) {
        gradient[a] = locked[a] ? 0 : gradient[a];
        largest = fmax(largest, fabs(gradient[a]));
    }
    for (int a = 0; a < 3; a++) {
        gradient[a] /= largest;
        gradient_sq += gradient[a] * gradient[a];
    }
    for (int a = 0; a < 3; a++)
        x[a] -= miss / largest / gradient_sq * gradient[a];
    return isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2]);
}

/* Computes the middle of some vertices, and returns the mean of the field there. */
static double find_middle(const cwi_snapping *s, const uint32_t *vertex, int count,
                          double middle[3])
{
    double value = 0, unused[3];
    middle[0] = middle[1] = middle[2] = 0;
    for (int n = 0; n < count; n++) {
        const double *x = cwi_index(s, vertex[n]);
        value += evaluate_field(s->grid, x, unused) / count;
        for (int a = 0; a < 3; a++)
            middle[a] += x[a] / count;
    }
    return value;
}

/* Goes from the middle to a near place where the field has the value it had at the vertices:
 * the isovalue, where these were placed by the trilinear field. */
static bool find_position(const cwi_snapping *s, double target, const double middle[3],
                          const bool locked[3], double index[3])
{
    memcpy(index, middle, 3 * sizeof *index);
    for (int step = 0; step < 3; step++) {
        if (!approach_level(s->grid, target, locked, index))
            return false;
        for (int a = 0; a < 3; a++)
            if (fabs(index[a] - middle[a]) > 0.5 * s->snap_distance)
                return false;
    }
    return true;
}

/* Finds the vertices that decide the place. Where the volume ends the surface has a crease.
 * Caps are flat: their vertices are ignored where there are others in the same plane, and
 * decide alone where there are none. */
static int find_voters(const cwi_snapping *s, const cwi_cluster *c, uint32_t *vertex,
                       bool locked[3])
{
    const size_t *dim = s->grid->volume.dim;
    int count = 0;
    locked[0] = locked[1] = locked[2] = false;
    for (int m = 0; m < c->count; m++)
        for (int a = 0; a < 3; a++) {
            const double x = cwi_index(s, c->member[m])[a];
            locked[a] = locked[a] || x < 1 || x > (double)dim[a];
        }
    for (int pass = 0; pass < 2 && count == 0; pass++)
        for (int m = 0; m < c->count; m++) {
            const double *x = cwi_index(s, c->member[m]);
            bool chosen = true;
            for (int a = 0; a < 3; a++)
                chosen = chosen && (!locked[a] || fabs(x[a] - (double)c->at[a]) <
                                                      (pass ? 2.0 / 1024 : 0.5 / 1024));
            if (chosen)
                vertex[count++] = c->member[m];
        }
    return count;
}

/* ---- whether it may go there ------------------------------------------------------------ */

typedef struct shape {
    double normal[3]; /* times twice the area */
    double sharpness; /* square of the cotangent of the smallest angle */
} shape;

/* Computes the shape of a triangle. An angle's cotangent is the dot product of its sides over
 * twice the area. */
static shape shape_of(const float *p, const float *q, const float *r)
{
    double u[3], v[3], w[3];
    shape out;
    for (int a = 0; a < 3; a++) {
        u[a] = (double)q[a] - (double)p[a];
        v[a] = (double)r[a] - (double)q[a];
        w[a] = (double)p[a] - (double)r[a];
    }
    for (int a = 0; a < 3; a++)
        out.normal[a] = u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
    const double x = -cwi_dot(u, v), y = -cwi_dot(v, w), z = -cwi_dot(w, u), xy = x > y ? x : y;
    const double largest = xy > z ? xy : z;
    out.sharpness = largest * largest / cwi_dot(out.normal, out.normal);
    return out;
}

static shape shape_at(const cwi_snapping *s, size_t triangle)
{
    const uint32_t *t = s->mesh->triangles + 3 * triangle;
    return shape_of(cwi_mesh_position(s, t[0]), cwi_mesh_position(s, t[1]),
                    cwi_mesh_position(s, t[2]));
}

/* Shape of a cluster's triangles before the cluster moves. */
typedef struct looks {
    double normal[CWI_LINK][3]; /* of the owners */
    double worst;               /* sharpness */
} looks;

static void look_at(const cwi_snapping *s, const cwi_cluster *c, looks *cells_before)
{
    cells_before->worst = 0;
    for (int n = 0; n < c->fan_count; n++) {
        const shape is = shape_at(s, c->fan[n]);
        cells_before->worst = fmax(cells_before->worst, is.sharpness);
        for (int m = 0; m < c->link_count; m++)
            if (c->owner[m] == c->fan[n])
                memcpy(cells_before->normal[m], is.normal, sizeof is.normal);
    }
}

/* Returns true if, in the world, where angles matter, no new triangle is turned over, and none
 * has a smaller angle than the smallest before. */
static bool looks_good(const cwi_snapping *s, const cwi_cluster *c, const looks *cells_before,
                       const float p[3])
{
    for (int n = 0; n < c->link_count; n++) {
        const shape is = shape_of(p, cwi_mesh_position(s, c->link[n]),
                                  cwi_mesh_position(s, c->link[cwi_link_next(c, n)]));
        if (!(cwi_dot(cells_before->normal[n], is.normal) > 0) ||
            !(is.sharpness <= cells_before->worst))
            return false;
    }
    return true;
}

/* Returns the square of the distance from a point to the nearest point of the new triangles, or
 * to one that is near enough. */
static double distance_sq_from(const cwi_snapping *s, const cwi_cluster *c, const double x[3],
                               const double from[3], double enough)
{
    cwi_triangle t;
    double nearest[3];
    for (int a = 0; a < 3; a++)
        nearest[a] = t.p[0][a] = x[a] - from[a];
    for (int n = 0; n < c->link_count && cwi_dot(nearest, nearest) > enough; n++) {
        const double *q = cwi_index(s, c->link[n]),
                     *r = cwi_index(s, c->link[cwi_link_next(c, n)]);
        for (int a = 0; a < 3; a++) {
            t.p[1][a] = q[a] - from[a];
            t.p[2][a] = r[a] - from[a];
        }
        cwi_nearest_of_triangle(&t, nearest);
    }
    return cwi_dot(nearest, nearest);
}

/* Returns true if no member is left far from the new triangles. */
static bool is_faithful(const cwi_snapping *s, const cwi_cluster *c, const double x[3])
{
    const double max_distance = MAX_ERROR * s->snap_distance;
    for (int m = 0; m < c->count; m++)
        if (distance_sq_from(s, c, x, cwi_index(s, c->member[m]), max_distance * max_distance) >
            max_distance * max_distance)
            return false;
    return true;
}

static bool may_go(const cwi_snapping *s, const cwi_cluster *c, const looks *cells_before,
                   const double index[3], double x[3], float p[3])
{
    const double max_distance = fmin(s->snap_distance + ROUNDING, FARTHEST);
    double from[3];
    cwi_to_position(s, index, p);
    cwi_to_index(s, p, x);
    for (int a = 0; a < 3; a++)
        from[a] = x[a] - (double)c->at[a];
    return cwi_dot(from, from) < max_distance * max_distance &&
           looks_good(s, c, cells_before, p) && is_faithful(s, c, x) &&
           cwi_fan_is_clear(s, c, x);
}

bool cwi_cluster_position(const cwi_snapping *s, const cwi_cluster *c, double x[3],
                          float position[3])
{
    uint32_t vertex[CWI_MEMBERS];
    double middle[3], index[3];
    bool locked[3];
    looks cells_before;
    const int count = find_voters(s, c, vertex, locked);
    if (count == 0)
        return false;
    const double target = find_middle(s, vertex, count, middle);
    if (!find_position(s, target, middle, locked, index))
        memcpy(index, middle, sizeof index);
    look_at(s, c, &cells_before);
    bool fits = may_go(s, c, &cells_before, index, x, position);
    for (int n = 0; n < count && !fits; n++)
        fits = may_go(s, c, &cells_before, cwi_index(s, vertex[n]), x, position);
    return fits;
}
