/* Topology from critical points, after Morse and, for fields smooth in pieces, Goresky and
 * MacPherson. As the level falls, { f >= level } changes only where a level passes a critical
 * point, and there its Euler number changes by 1 - chi(upper link): the directions in which f
 * rises. A trilinear field has three kinds:
 *
 *   samples          along each axis 0, 1 or 2 neighbours are higher
 *   face saddles     in a face; each of the two cells beside it rises or falls away from it
 *   interior saddles one direction rises and two fall, or one falls and two rise
 *
 * and no others: f is linear along an edge and along every axis. For the same reason it has no
 * maximum but samples, so every component of the inside holds samples; two are joined along an
 * edge, through a face or through a saddle, and walking up along axes from a saddle ends at a
 * sample of its component. All of that holds upside down for the outside. */
#include "support/truth.h"

#include <assert.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

/* Hairs of 1e-9 meet in products: that takes more than a double, where there is more. */
typedef long double real;

/* Values less the isovalue, made different from one another. */
typedef struct field {
    size_t dim[3], stride[3];
    real *values, *unraised;
    size_t *sets; /* of samples, and the exterior after them */
    long euler;   /* of the inside */
    bool close;   /* a critical value too close to the isovalue to trust */
} field;

/* A number in (0.5L, 1] that depends on n as if at random. */
static real any_number(size_t n)
{
    uint64_t x = ((uint64_t)n + 1) * UINT64_C(0x9E3779B97F4A7C15);
    x = (x ^ x >> 31) * UINT64_C(0xBF58476D1CE4E5B9);
    return 1 - 0.5L * (real)(x >> 11) / 9007199254740992.0L;
}

/* Every value is raised by a hair, each by its own: equal ones become different, and as none is
 * lowered { f >= 0 } only grows by a film, which keeps its topology. */
static void load_values(field *f, const float *voxels, float iso)
{
    const size_t count = f->dim[0] * f->dim[1] * f->dim[2];
    real largest = 0;
    for (size_t n = 0; n < count; n++)
        largest = fmaxl(largest, fabsl((real)voxels[n] - (real)iso));
    for (size_t n = 0; n < count; n++) {
        const real v = (real)voxels[n] - (real)iso;
        f->unraised[n] = v;
        f->values[n] = v + any_number(n) * (1e-9L * fabsl(v) + 1e-13L * largest);
    }
}

/* u of an axis's neighbours are higher: the upper link is a join of three such pairs of points
 * or less, and 1 - chi of it is the product of 1 - u. */
static void count_sample(field *f, const size_t at[3], size_t n)
{
    int change = 1;
    for (int a = 0; a < 3; a++) {
        int higher = 0;
        if (at[a] > 0)
            higher += f->values[n - f->stride[a]] > f->values[n];
        if (at[a] + 1 < f->dim[a])
            higher += f->values[n + f->stride[a]] > f->values[n];
        change *= 1 - higher;
    }
    if (f->values[n] >= 0)
        f->euler += change;
}

/* The field in a face or cell as sums of products of coordinates: c[axes as bits]. */
static void expand(const field *f, size_t n, const size_t step[3], real c[8])
{
    for (unsigned s = 0; s < 8; s++) {
        size_t at = n;
        for (unsigned a = 0; a < 3; a++)
            at += s >> a & 1 ? step[a] : 0;
        c[s] = f->values[at];
    }
    for (unsigned a = 0; a < 3; a++)
        for (unsigned s = 0; s < 8; s++)
            if (s >> a & 1)
                c[s] -= c[s & ~(1u << a)];
}

/* A face's saddle against the isovalue. Where corners are on both sides along the diagonals
 * that is decided on the values as they were, whose products are exact: a tie is inside, and a
 * hair is more than what may lie between floats and a tie. */
static bool saddle_is_inside(const field *f, size_t n, size_t u, size_t v)
{
    const real *q = f->values + n, *r = f->unraised + n;
    const bool in = q[0] >= 0;
    if ((q[u + v] >= 0) == in && (q[u] >= 0) != in && (q[v] >= 0) != in)
        return in ? r[0] * r[u + v] >= r[u] * r[v] : r[0] * r[u + v] <= r[u] * r[v];
    return q[0] - (q[u] - q[0]) * (q[v] - q[0]) / ((q[0] - q[u]) + (q[u + v] - q[v])) >= 0;
}

/* The saddle of a face lies in it when both of one diagonal are higher than both others. Both
 * arcs of its upper link are joined on every side that rises. */
static void count_face(field *f, const size_t at[3], size_t n, int axis)
{
    const size_t u = f->stride[(axis + 1) % 3], v = f->stride[(axis + 2) % 3];
    const real *q = f->values + n;
    const real a = q[0], b = q[u], c = q[u + v], d = q[v];
    const bool up = fminl(a, c) > fmaxl(b, d), down = fmaxl(a, c) < fminl(b, d);
    if (!up && !down)
        return;
    const real sum = (a - b) + (c - d), x = (a - d) / sum, y = (a - b) / sum;
    int rising = 0;
    for (int side = 0; side < 2; side++) {
        if (side ? at[axis] + 1 == f->dim[axis] : at[axis] == 0)
            continue;
        q = side ? f->values + n + f->stride[axis] : f->values + n - f->stride[axis];
        const real beside = (1 - y) * ((1 - x) * (q[0] - a) + x * (q[u] - a)) +
                            y * ((1 - x) * (q[v] - a) + x * (q[u + v] - a));
        rising += beside > -(b - a) * (d - a) / sum;
    }
    const bool inside = saddle_is_inside(f, n, u, v);
    if (inside)
        f->euler += rising - 1;
    if (up == inside) /* the higher two meet above the level, or the lower two below it */
        test_sets_join(f->sets, n, n + u + v);
    else
        test_sets_join(f->sets, n + u, n + v);
}

static real cell_value(const real c[8], const real p[3])
{
    return c[0] + c[1] * p[0] + c[2] * p[1] + c[4] * p[2] + c[3] * p[0] * p[1] +
           c[5] * p[0] * p[2] + c[6] * p[1] * p[2] + c[7] * p[0] * p[1] * p[2];
}

/* df/dp[a], and d2f/dp[u]dp[v] where u and v are the other two axes than a. */
static real cell_slope(const real c[8], const real p[3], int a)
{
    const int u = (a + 1) % 3, v = (a + 2) % 3;
    return c[1 << a] + c[1 << a | 1 << u] * p[u] + c[1 << a | 1 << v] * p[v] +
           c[7] * p[u] * p[v];
}

static real cell_bend(const real c[8], const real p[3], int a)
{
    return c[7 ^ 1 << a] + c[7] * p[a];
}

/* One step of Newton's method to where all slopes vanish: the Hessian has the bends beside its
 * zero diagonal. */
static void polish(const real c[8], real p[3])
{
    real g[3], h[3];
    for (int a = 0; a < 3; a++) {
        g[a] = cell_slope(c, p, a);
        h[a] = cell_bend(c, p, a);
    }
    const real det = 2 * h[0] * h[1] * h[2];
    for (int a = 0; a < 3 && det != 0; a++) {
        const int u = (a + 1) % 3, v = (a + 2) % 3;
        p[a] -= (-h[a] * h[a] * g[a] + h[a] * h[u] * g[u] + h[a] * h[v] * g[v]) / det;
    }
}

/* f is linear along every axis: moving to whichever end is higher never goes down. Returns the
 * corner it ends at; sign -1 walks down instead. */
static unsigned climb(const real c[8], const real from[3], real sign)
{
    real p[3] = {from[0], from[1], from[2]};
    unsigned corner = 0;
    for (int round = 0; round < 3; round++)
        for (int a = 0; a < 3; a++) {
            p[a] = sign * cell_slope(c, p, a) > 0;
            corner = (corner & ~(1u << a)) | (p[a] > 0 ? 1u << a : 0);
        }
    return corner;
}

/* With sign 1, a saddle with one rising line: its two ends are (s, s, s)-like directions along
 * which all three bends help. Near enough, the cubic term does not matter. */
static void join_through(field *f, const real c[8], const real p[3], size_t n, real sign)
{
    const real h[3] = {cell_bend(c, p, 0), cell_bend(c, p, 1), cell_bend(c, p, 2)};
    const real along[3] = {1, sign * h[2] < 0 ? -1 : 1, sign * h[1] < 0 ? -1 : 1};
    real t = 0.5L * (fabsl(h[0]) + fabsl(h[1]) + fabsl(h[2])) / (fabsl(c[7]) + 1e-300L);
    size_t end[2];
    for (int a = 0; a < 3; a++)
        t = fminl(t, 0.5L * fminl(p[a], 1 - p[a]));
    for (int side = 0; side < 2; side++) {
        real q[3];
        for (int a = 0; a < 3; a++)
            q[a] = p[a] + (side ? -t : t) * along[a];
        const unsigned corner = climb(c, q, sign);
        end[side] = n;
        for (int a = 0; a < 3; a++)
            end[side] += corner >> a & 1 ? f->stride[a] : 0;
    }
    test_sets_join(f->sets, end[0], end[1]);
}

static void count_interior(field *f, const real c[8], real p[3], size_t n, real scale)
{
    for (int round = 0; round < 3; round++)
        polish(c, p);
    for (int a = 0; a < 3; a++)
        if (!(p[a] > 0 && p[a] < 1))
            return;
    const real value = cell_value(c, p);
    const bool one_rises = cell_bend(c, p, 0) * cell_bend(c, p, 1) * cell_bend(c, p, 2) > 0;
    f->close = f->close || fabsl(value) < 1e-17L * scale; /* rounding may have decided */
    if (value >= 0)
        f->euler += one_rises ? -1 : 1;
    if (one_rises == (value >= 0))
        join_through(f, c, p, n, one_rises ? 1 : -1);
}

/* Slopes along y and z give z and y as fractions of x; put into the slope along x they leave a
 * quadratic equation. */
static void count_cell(field *f, size_t n)
{
    real c[8], scale = 0;
    expand(f, n, f->stride, c);
    for (int s = 0; s < 8; s++)
        scale = fmaxl(scale, fabsl(c[s]));
    const real k = c[1] * c[7] - c[3] * c[5];
    const real qa = c[7] * k, qb = c[6] * k,
               qc = c[6] * (c[1] * c[6] - c[3] * c[4] - c[5] * c[2]) + c[7] * c[4] * c[2];
    const real root = qb * qb - qa * qc;
    if (root < 0)
        return;
    const real q = -(qb + copysignl(sqrtl(root), qb));
    const real x[2] = {q / qa, qc / q};
    for (int r = 0; r < 2; r++) {
        const real below = c[6] + c[7] * x[r];
        real p[3] = {x[r], -(c[4] + c[5] * x[r]) / below, -(c[2] + c[3] * x[r]) / below};
        if (fabsl(p[0] - 0.5L) + fabsl(p[1] - 0.5L) + fabsl(p[2] - 0.5L) <
            3) /* false for NaN */
            count_interior(f, c, p, n, scale);
    }
}

static void join_edge(field *f, size_t a, size_t b)
{
    if ((f->values[a] >= 0) == (f->values[b] >= 0))
        test_sets_join(f->sets, a, b);
}

static void visit(field *f, const size_t at[3])
{
    const size_t n = at[0] + at[1] * f->stride[1] + at[2] * f->stride[2];
    bool room[3], rim = false;
    for (int a = 0; a < 3; a++) {
        room[a] = at[a] + 1 < f->dim[a];
        rim = rim || at[a] == 0 || !room[a];
    }
    count_sample(f, at, n);
    if (rim && f->values[n] < 0)
        test_sets_join(f->sets, n, f->dim[0] * f->dim[1] * f->dim[2]);
    for (int a = 0; a < 3; a++) {
        if (room[a])
            join_edge(f, n, n + f->stride[a]);
        if (room[(a + 1) % 3] && room[(a + 2) % 3])
            count_face(f, at, n, a);
    }
    if (room[0] && room[1] && room[2])
        count_cell(f, n);
}

test_truth test_topology_counted(const float *voxels, const size_t dim[3], float iso)
{
    const size_t count = dim[0] * dim[1] * dim[2];
    field f = {.dim = {dim[0], dim[1], dim[2]},
               .stride = {1, dim[0], dim[0] * dim[1]},
               .values = malloc(count * sizeof *f.values),
               .unraised = malloc(count * sizeof *f.unraised),
               .sets = malloc((count + 1) * sizeof *f.sets)};
    size_t sets = 0;
    assert(f.values && f.unraised && f.sets);
    load_values(&f, voxels, iso);
    test_sets_start(f.sets, count + 1);
    for (size_t n = 0; n < count; n++)
        visit(&f, (size_t[3]){n % dim[0], n / dim[0] % dim[1], n / dim[0] / dim[1]});
    for (size_t n = 0; n <= count; n++)
        sets += test_sets_find(f.sets, n) == n;
    free(f.values);
    free(f.unraised);
    free(f.sets);
    return (test_truth){.decidable = !f.close, .components = sets - 1, .euler = 2 * f.euler};
}
