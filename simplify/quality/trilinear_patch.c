/* The nearest point of a trilinear patch, for certain.
 *
 * On the patch F = 0, L(x) = |x - u|^2 / 2 + m F(x) is half the squared distance for any m:
 * what L is at least in a box bounds the distance of the patch there. Newton's method finds a
 * point q of the patch where L has no slope, but into the box's walls, for some m. If L is
 * convex in the box, which its second derivatives tell, q is its lowest point and the nearest
 * of the patch; if it is not quite, L is lower elsewhere by so much at most. Near the surface
 * the whole cell is cleared so mostly. Else the box is halved, until each part is cleared, has
 * no surface, or is too far away. */
#include "simplify/quality/trilinear_patch.h"

#include "core/geometry/affine.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <string.h>

/* A function below this is zero for all that doubles can tell: the largest corner is 1. */
#define NOTHING 1e-14

typedef struct box {
    double low[3], high[3];
} box;

typedef struct search {
    const cwi_patch *patch;
    const cwi_metric *metric;
    double u[3];
    double best;   /* mm, of the nearest point found */
    double limit;  /* best less the slack: what is not nearer than this does not matter */
    double looser; /* the slack's factor */
    size_t boxes;  /* looked at */
} search;

/* Number of boxes after which the slack is doubled. Where samples equal the isovalue, patches touch
 * each other along edges and faces of cells: no box clears those, and a point could take millions
 * of boxes. The point that is found is on the surface with any slack. */
enum { PATIENCE = 4096 };

static double clamp_between(double x, double low, double high)
{
    return cwi_lesser(cwi_greater(x, low), high);
}

static void multiply_vector(const double m[3][3], const double x[3], double y[3])
{
    for (int r = 0; r < 3; r++)
        y[r] = m[r][0] * x[0] + m[r][1] * x[1] + m[r][2] * x[2];
}

static double metric_length(const cwi_metric *m, const double x[3])
{
    double y[3];
    multiply_vector(m->gram, x, y);
    return sqrt(cwi_greater(cwi_dot(x, y), 0));
}

/* The inverse of a symmetric matrix without some of its axes: those become the identity's. */
static void invert_gram(const double gram[3][3], unsigned without, double inverse[3][3])
{
    double a[12] = {0}, c[3][3];
    for (int r = 0; r < 3; r++)
        for (int s = 0; s < 3; s++) {
            const bool out = (without >> r | without >> s) & 1;
            a[4 * r + s] = out ? r == s : gram[r][s];
        }
    cwi_affine_cofactor(a, c);
    const double determinant = cwi_affine_determinant(a);
    for (int r = 0; r < 3; r++)
        for (int s = 0; s < 3; s++)
            inverse[r][s] = (without >> r | without >> s) & 1 ? 0 : c[r][s] / determinant;
}

void cwi_metric_init(cwi_metric *m, const double *affine)
{
    for (int r = 0; r < 3; r++)
        for (int s = 0; s < 3; s++) {
            m->gram[r][s] = 0;
            for (int k = 0; k < 3; k++)
                m->gram[r][s] += affine[4 * k + r] * affine[4 * k + s];
        }
    for (unsigned without = 0; without < 8; without++)
        invert_gram((const double(*)[3])m->gram, without, m->inverse[without]);
    for (int r = 0; r < 3; r++)
        m->width[r] = sqrt(m->inverse[0][r][r]);
    m->voxel = cbrt(fabs(cwi_affine_determinant(affine)));
}

void cwi_patch_init(cwi_patch *patch, const double corners[8])
{
    double *c = patch->c;
    memcpy(c, corners, sizeof patch->c);
    for (int axis = 1; axis < 8; axis *= 2)
        for (int n = 0; n < 8; n++)
            if (n & axis)
                c[n] -= c[n ^ axis];
}

/* The same polynomial around x: value, gradient and higher terms, in the order of c. */
static void expand_field(const cwi_patch *patch, const double x[3], double t[8])
{
    const double *c = patch->c;
    t[7] = c[7];
    t[6] = c[6] + c[7] * x[0];
    t[5] = c[5] + c[7] * x[1];
    t[3] = c[3] + c[7] * x[2];
    const double y4 = c[4] + c[5] * x[0], y2 = c[2] + c[3] * x[0];
    t[4] = y4 + t[6] * x[1];
    t[2] = y2 + t[6] * x[2];
    t[1] = c[1] + c[3] * x[1] + t[5] * x[2];
    t[0] = c[0] + c[1] * x[0] + y2 * x[1] + t[4] * x[2];
}

double cwi_patch_value(const cwi_patch *patch, const double x[3])
{
    double t[8];
    expand_field(patch, x, t);
    return t[0];
}

/* The point y of a box nearest to u where the plane f + g . (y - x) vanishes: axes along which
 * the nearest point lies outside the box are fixed to its wall, the worst first. *pull is such
 * that y = u - pull * g / gram, but for the walls. */
static bool project_on_patch(const search *s, const box *b, const double x[3], double f,
                             const double g[3], double y[3], double *pull)
{
    double away[3] = {0, 0, 0}; /* of y from u, along fixed axes */
    for (unsigned fixed = 0; fixed < 7;) {
        const double(*inverse)[3] = (const double(*)[3])s->metric->inverse[fixed];
        double back[3] = {0, 0, 0}, down[3], rest = f, worst = 0;
        int axis = -1;
        if (fixed) {
            double force[3];
            multiply_vector((const double(*)[3])s->metric->gram, away, force);
            multiply_vector(inverse, force, back);
        }
        for (int a = 0; a < 3; a++) {
            y[a] = fixed >> a & 1 ? s->u[a] + away[a] : s->u[a] - back[a];
            rest += g[a] * (y[a] - x[a]);
        }
        multiply_vector(inverse, g, down);
        const double metric_sq = cwi_dot(g, down);
        if (!(metric_sq > 0))
            return false;
        *pull = rest / metric_sq;
        for (int a = 0; a < 3; a++) {
            y[a] -= *pull * down[a];
            const double out = cwi_greater(b->low[a] - y[a], y[a] - b->high[a]);
            if (!(fixed >> a & 1) && out > worst) {
                worst = out;
                axis = a;
            }
        }
        if (axis < 0)
            return true;
        fixed |= 1u << axis;
        away[axis] = (y[axis] < b->low[axis] ? b->low[axis] : b->high[axis]) - s->u[axis];
    }
    return false;
}

/* Serves where that fails: pulls the point of the box nearest to u towards the plane until it
 * comes there or can go no farther, axes taken as orthogonal. Each begins to move when it comes
 * off a wall of the box, and stops at the other. */
static double press_bound(const search *s, const box *b, const double x[3], double f,
                          const double g[3], double y[3])
{
    double rest = f, speed[3], start[3], stop[3], pull = 0;
    for (int a = 0; a < 3; a++)
        rest += g[a] * (clamp_between(s->u[a], b->low[a], b->high[a]) - x[a]);
    const double side = rest < 0 ? -1 : 1;
    for (int a = 0; a < 3; a++) {
        speed[a] = side * g[a] / s->metric->gram[a][a];
        const double near = speed[a] > 0 ? b->high[a] : b->low[a];
        const double far = speed[a] > 0 ? b->low[a] : b->high[a];
        start[a] = cwi_greater((s->u[a] - near) / speed[a], 0);
        stop[a] = cwi_greater((s->u[a] - far) / speed[a], 0);
    }
    for (rest *= side;;) {
        double rate = 0, next = INFINITY; /* until an axis starts or stops */
        for (int a = 0; a < 3; a++) {
            rate += start[a] <= pull && pull < stop[a] ? side * g[a] * speed[a] : 0;
            next = start[a] > pull ? cwi_lesser(next, start[a]) : next;
            next = stop[a] > pull ? cwi_lesser(next, stop[a]) : next;
        }
        if (next == INFINITY)
            break;
        if (rate * (next - pull) >= rest) {
            pull += rate > 0 ? rest / rate : 0;
            break;
        }
        rest -= rate * (next - pull);
        pull = next;
    }
    for (int a = 0; a < 3; a++)
        y[a] = clamp_between(s->u[a] - pull * speed[a], b->low[a], b->high[a]);
    return side * pull;
}

static double slack_of(const search *s, double distance)
{
    return s->looser * cwi_slack(s->metric, distance);
}

static void offer_point(search *s, const double x[3], double margin)
{
    const double offset[3] = {x[0] - s->u[0], x[1] - s->u[1], x[2] - s->u[2]};
    const double d = metric_length(s->metric, offset) + margin;
    if (d < s->best) {
        s->best = d;
        s->limit = d - slack_of(s, d);
    }
}

/* Whether the function vanishes at x, or changes its sign within a millionth of a voxel along
 * its slope, inside the box. */
static bool on_surface(const search *s, const box *b, const double x[3])
{
    double t[8], down[3], y[3];
    expand_field(s->patch, x, t);
    const double g[3] = {t[1], t[2], t[4]}, close = 1e-6 * s->metric->voxel;
    multiply_vector((const double(*)[3])s->metric->inverse[0], g, down);
    const double step = copysign(close / sqrt(cwi_dot(g, down)), t[0]);
    for (int a = 0; a < 3; a++)
        y[a] = clamp_between(x[a] - step * down[a], b->low[a], b->high[a]);
    return t[0] * cwi_patch_value(s->patch, y) <= 0;
}

/* Newton's method in a box: the nearest point on the tangent plane at the nearest point on the
 * tangent plane ... What it finds on the surface is offered. Returns the last pull. */
static double descend_to_patch(search *s, const box *b, double x[3])
{
    const double close = 1e-7 * s->metric->voxel;
    double pull = 0, moved = INFINITY;
    for (int n = 0; n < 16 && moved >= close; n++) {
        double t[8], y[3];
        expand_field(s->patch, x, t);
        const double g[3] = {t[1], t[2], t[4]};
        const bool reached = project_on_patch(s, b, x, t[0], g, y, &pull);
        if (!reached)
            pull = press_bound(s, b, x, t[0], g, y);
        const double move[3] = {y[0] - x[0], y[1] - x[1], y[2] - x[2]};
        moved = metric_length(s->metric, move);
        memcpy(x, y, 3 * sizeof *x);
        if (!reached)
            return pull;
    }
    if (moved < close || on_surface(s, b, x))
        offer_point(s, x, 0);
    return pull;
}

/* The square of the longest that a vector within the half sizes can be. */
static double radius_squared(const cwi_metric *m, const double half[3])
{
    double metric_sq = 0;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            metric_sq += fabs(m->gram[r][c]) * half[r] * half[c];
    return metric_sq;
}

/* Whether gram + pull * (second derivatives) is positive definite, the mixed ones
 * being these. */
static bool is_convex(const cwi_metric *m, double pull, double xy, double xz, double yz)
{
    const double a = m->gram[0][0], b = m->gram[1][1], c = m->gram[2][2];
    const double d = m->gram[0][1] + pull * xy, e = m->gram[0][2] + pull * xz,
                 f = m->gram[1][2] + pull * yz;
    return a * b - d * d > 0 &&
           a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e) > 0;
}

/* The same wherever no coordinate is farther from that of x than this, t being the patch around
 * x: rows in which the diagonal outweighs the rest, whatever its signs, are enough. */
static bool is_plainly_convex(const cwi_metric *m, double pull, const double t[8],
                              const double far[3])
{
    const double p = fabs(pull), bent = fabs(t[7]);
    const double xy = fabs(m->gram[0][1]) + p * (fabs(t[3]) + bent * far[2]),
                 xz = fabs(m->gram[0][2]) + p * (fabs(t[5]) + bent * far[1]),
                 yz = fabs(m->gram[1][2]) + p * (fabs(t[6]) + bent * far[0]);
    return m->gram[0][0] > xy + xz && m->gram[1][1] > xy + yz && m->gram[2][2] > xz + yz;
}

/* Whether nothing of the patch in the box is nearer than the limit, as L(y) = |y - u|^2 / 2 +
 * pull * F(y) tells from x, which may be anywhere. With stiffness * |y - x|^2 / 2 added, where
 * that makes it convex, L is at least what its slope at x says; so L itself is at least as much
 * less what the addition comes to in the box. Second derivatives are linear in place, and
 * positive definite matrices a convex set: the box's corners decide. */
static bool is_cleared(const search *s, const box *b, const double x[3], double pull)
{
    double t[8], slope[3], far[3];
    const double offset[3] = {x[0] - s->u[0], x[1] - s->u[1], x[2] - s->u[2]};
    expand_field(s->patch, x, t);
    multiply_vector((const double(*)[3])s->metric->gram, offset, slope);
    double slack = (cwi_dot(offset, slope) - s->limit * s->limit) / 2 + pull * t[0];
    slack -= fabs(pull) * NOTHING;
    for (int a = 0; a < 3; a++) {
        const double down = x[a] - b->low[a], up = b->high[a] - x[a];
        slope[a] += pull * t[1 << a];
        slack += cwi_lesser(-slope[a] * down, slope[a] * up);
        far[a] = cwi_greater(down, up);
    }
    if (!(slack > 0))
        return false;
    const double stiffness = 2 * slack / radius_squared(s->metric, far);
    pull /= 1 + stiffness;
    if (is_plainly_convex(s->metric, pull, t, far))
        return true;
    for (int n = 0; n < 8; n++) {
        const double dx = (n & 1 ? b->high : b->low)[0] - x[0];
        const double dy = (n & 2 ? b->high : b->low)[1] - x[1];
        const double dz = (n & 4 ? b->high : b->low)[2] - x[2];
        if (!is_convex(s->metric, pull, t[3] + t[7] * dz, t[5] + t[7] * dy, t[6] + t[7] * dx))
            return false;
    }
    return true;
}

/* Clips a box to the part that is nearer than the limit along each axis; false when nothing is
 * left. */
static bool clip_box(const search *s, box *b)
{
    for (int a = 0; a < 3; a++) {
        const double width = s->limit * s->metric->width[a];
        b->low[a] = cwi_greater(b->low[a], s->u[a] - width);
        b->high[a] = cwi_lesser(b->high[a], s->u[a] + width);
        if (!(b->low[a] <= b->high[a]))
            return false;
    }
    return true;
}

/* Whether the patch may come nearer than the limit inside a box of this middle and these half
 * sizes: the function must vanish somewhere, and so near. */
static bool may_be_near(const search *s, const double middle[3], const double half[3])
{
    double t[8], down[3], linear = 0;
    expand_field(s->patch, middle, t);
    const double g[3] = {t[1], t[2], t[4]};
    const double bent = fabs(t[3]) * half[0] * half[1] + fabs(t[5]) * half[0] * half[2] +
                        fabs(t[6]) * half[1] * half[2] +
                        fabs(t[7]) * half[0] * half[1] * half[2] + NOTHING;
    for (int a = 0; a < 3; a++)
        linear += fabs(g[a]) * half[a];
    if (fabs(t[0]) > linear + bent)
        return false;
    const double offset[3] = {s->u[0] - middle[0], s->u[1] - middle[1], s->u[2] - middle[2]};
    const double plane = fabs(t[0] + cwi_dot(g, offset)) - bent;
    if (plane > 0) {
        multiply_vector((const double(*)[3])s->metric->inverse[0], g, down);
        if (plane * plane >= s->limit * s->limit * cwi_dot(g, down))
            return false;
    }
    return true;
}

static void search_box(search *s, box b, double *start);

/* Halves a box across its longest side, and looks into the half nearer to the point first. */
static void search_halves(search *s, const box *b, const double middle[3], const double half[3])
{
    int axis = 0;
    for (int a = 1; a < 3; a++)
        if (half[a] * half[a] * s->metric->gram[a][a] >
            half[axis] * half[axis] * s->metric->gram[axis][axis])
            axis = a;
    box low = *b, high = *b;
    low.high[axis] = high.low[axis] = middle[axis];
    const bool low_first = s->u[axis] < middle[axis];
    search_box(s, low_first ? low : high, NULL);
    search_box(s, low_first ? high : low, NULL);
}

/* Newton's method starts from `start` or the box's middle. When it has found something the box
 * is smaller, and is looked at again. */
static void search_box(search *s, box b, double *start)
{
    double middle[3], half[3], x[3], before;
    if (++s->boxes % PATIENCE == 0) {
        s->looser *= 2;
        s->limit = s->best - slack_of(s, s->best);
    }
    do {
        if (!(s->limit > 0) || !clip_box(s, &b))
            return;
        for (int a = 0; a < 3; a++) {
            middle[a] = (b.low[a] + b.high[a]) / 2;
            half[a] = (b.high[a] - b.low[a]) / 2;
            x[a] = start ? clamp_between(start[a], b.low[a], b.high[a]) : middle[a];
        }
        if (!may_be_near(s, middle, half))
            return;
        const double offset[3] = {middle[0] - s->u[0], middle[1] - s->u[1],
                                  middle[2] - s->u[2]};
        const double r = sqrt(radius_squared(s->metric, half));
        const double d = metric_length(s->metric, offset);
        if (d - r >= s->limit)
            return;
        if (2 * r < slack_of(s, d)) { /* a point is here, no nearer one matters */
            offer_point(s, middle, r);
            return;
        }
        before = s->limit;
        const double pull = descend_to_patch(s, &b, x);
        if (is_cleared(s, &b, x, pull))
            return;
        start = x;
    } while (s->limit < before);
    search_halves(s, &b, middle, half);
}

bool cwi_patch_nearest(const cwi_patch *patch, const cwi_metric *metric, const double u[3],
                       double *distance)
{
    search s = {.patch = patch, .metric = metric, .best = *distance, .looser = 1};
    double start[3] = {u[0], u[1], u[2]};
    memcpy(s.u, u, sizeof s.u);
    s.limit = s.best - slack_of(&s, s.best);
    search_box(&s, (box){{0, 0, 0}, {1, 1, 1}}, start);
    const bool nearer = s.best < *distance;
    *distance = s.best;
    return nearer;
}
