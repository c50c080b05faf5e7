/* Computes quadrics of planes and lines [Garland1997], and the positions where they are least. */
#include "simplify/interfaces/label_quadrics.h"

#include "core/geometry/triangle.h"
#include "core/geometry/vec3.h"

#include <string.h>

/* The pull towards the middle of an edge, by the quadric's trace: it decides where the quadric
 * itself does not, as in a plane. */
#define PULL 1e-5

/* The cost of an edge's length: distances of a three-hundredth of it count as much. It orders
 * collapses in planes. */
#define COST_OF_LENGTH 1e-5

/* The weight of a curve: its line counts as much as this times the squared length of planes. */
#define CURVE_WEIGHT 1.0

static void get_point(const cwi_complex *c, uint32_t vertex, double p[3])
{
    for (size_t k = 0; k < 3; k++)
        p[k] = (double)c->points[3 * (size_t)vertex + k];
}

/* Adds weight x (x - p) M (x - p) for a symmetric matrix M. */
static void add_form(cwi_label_quadric *q, const double m[6], const double p[3], double weight)
{
    const double mp[3] = {m[0] * p[0] + m[1] * p[1] + m[2] * p[2],
                          m[1] * p[0] + m[3] * p[1] + m[4] * p[2],
                          m[2] * p[0] + m[4] * p[1] + m[5] * p[2]};
    for (int i = 0; i < 6; i++)
        q->a[i] += weight * m[i];
    for (int k = 0; k < 3; k++)
        q->b[k] -= weight * mp[k];
    q->c += weight * cwi_dot(p, mp);
}

static void add_triangle(const cwi_complex *c, size_t triangle, cwi_label_quadric *quadrics)
{
    double p[3][3], n[3];
    for (size_t k = 0; k < 3; k++)
        get_point(c, c->corners[3 * triangle + k], p[k]);
    cwi_triangle_normal(p[0], p[1], p[2], n);
    const double area = cwi_length(n) / 2;
    if (!cwi_to_unit(n))
        return;
    const double m[6] = {n[0] * n[0], n[0] * n[1], n[0] * n[2],
                         n[1] * n[1], n[1] * n[2], n[2] * n[2]};
    for (size_t k = 0; k < 3; k++)
        add_form(&quadrics[c->corners[3 * triangle + k]], m, p[0], area);
}

static void add_curve(const cwi_complex *c, size_t edge, cwi_label_quadric *quadrics)
{
    double p[3], d[3];
    get_point(c, c->ends[edge][0], p);
    get_point(c, c->ends[edge][1], d);
    for (int k = 0; k < 3; k++)
        d[k] -= p[k];
    const double weight = CURVE_WEIGHT * cwi_dot(d, d);
    if (!cwi_to_unit(d))
        return;
    const double m[6] = {1 - d[0] * d[0], -d[0] * d[1], -d[0] * d[2],
                         1 - d[1] * d[1], -d[1] * d[2], 1 - d[2] * d[2]};
    for (int k = 0; k < 2; k++)
        add_form(&quadrics[c->ends[edge][k]], m, p, weight);
}

void cwi_label_quadrics_build(const cwi_complex *c, cwi_label_quadric *quadrics)
{
    memset(quadrics, 0, c->vertex_count * sizeof *quadrics);
    for (size_t t = 0; t < c->triangle_count; t++)
        add_triangle(c, t, quadrics);
    for (size_t e = 0; e < c->edge_count; e++)
        if (c->is_curve[e])
            add_curve(c, e, quadrics);
}

void cwi_label_quadrics_join(cwi_label_quadric *quadrics, uint32_t keep, uint32_t drop)
{
    cwi_label_quadric *q = &quadrics[keep], *other = &quadrics[drop];
    for (int i = 0; i < 6; i++)
        q->a[i] += other->a[i];
    for (int k = 0; k < 3; k++)
        q->b[k] += other->b[k];
    q->c += other->c;
}

/* Computes A d. */
static void multiply_matrix(const double a[6], const double d[3], double out[3])
{
    out[0] = a[0] * d[0] + a[1] * d[1] + a[2] * d[2];
    out[1] = a[1] * d[0] + a[3] * d[1] + a[4] * d[2];
    out[2] = a[2] * d[0] + a[4] * d[1] + a[5] * d[2];
}

static double find_error(const cwi_label_quadric *q, const double p[3])
{
    double ap[3];
    multiply_matrix(q->a, p, ap);
    return cwi_greater(cwi_dot(ap, p) + 2 * cwi_dot(q->b, p) + q->c, 0);
}

/* Moves a position to where the quadric and the pull towards the position are least together.
 * Solves by L D L^T. */
static void find_minimum(const cwi_label_quadric *q, double position[3])
{
    const double pull = PULL * (q->a[0] + q->a[3] + q->a[5]) + 1e-300;
    double slope[3];
    multiply_matrix(q->a, position, slope);
    for (int k = 0; k < 3; k++)
        slope[k] = -slope[k] - q->b[k];
    const double xx = q->a[0] + pull, xy = q->a[1], xz = q->a[2];
    const double l10 = xy / xx, l20 = xz / xx;
    const double d1 = q->a[3] + pull - l10 * xy, e = q->a[4] - l20 * xy, l21 = e / d1;
    const double d2 = q->a[5] + pull - l20 * xz - l21 * e;
    const double y1 = slope[1] - l10 * slope[0], y2 = slope[2] - l20 * slope[0] - l21 * y1;
    const double z = y2 / d2, y = y1 / d1 - l21 * z;
    position[0] += slope[0] / xx - l10 * y - l20 * z;
    position[1] += y;
    position[2] += z;
}

/* Finds the best position on the edge from p along d. */
static void find_minimum_along(const cwi_label_quadric *q, const double p[3], const double d[3],
                               double position[3])
{
    double ap[3], ad[3];
    multiply_matrix(q->a, p, ap);
    multiply_matrix(q->a, d, ad);
    const double pull = PULL * (q->a[0] + q->a[3] + q->a[5]) * cwi_dot(d, d) + 1e-300;
    const double bend = cwi_dot(ad, d) + pull;
    const double fall = -cwi_dot(ap, d) - cwi_dot(q->b, d) + pull / 2;
    const double t = cwi_lesser(cwi_greater(fall / bend, 0), 1);
    cwi_add_scaled(p, t, d, position);
}

/* Finds the best position for two inner vertices. A position far from both is not used. */
static void find_minimum_between(const cwi_label_quadric *q, const double p[3],
                                 const double d[3], double position[3])
{
    double middle[3], displacement[3];
    for (int k = 0; k < 3; k++)
        position[k] = middle[k] = p[k] + d[k] / 2;
    find_minimum(q, position);
    cwi_sub(position, middle, displacement);
    if (!(cwi_dot(displacement, displacement) <= 4 * cwi_dot(d, d)))
        memcpy(position, middle, sizeof middle);
}

cwi_label_move cwi_label_move_plan(const cwi_complex *c, const cwi_label_quadric *quadrics,
                                   uint32_t edge)
{
    cwi_label_move move = {.edge = edge, .cost = INFINITY};
    double p[3], other[3], d[3], position[3];
    if (!cwi_complex_choose(c, edge, &move.keep, &move.drop))
        return move;
    cwi_label_quadric q = quadrics[move.keep];
    const cwi_label_quadric *dropped = &quadrics[move.drop];
    for (int i = 0; i < 6; i++)
        q.a[i] += dropped->a[i];
    for (int k = 0; k < 3; k++)
        q.b[k] += dropped->b[k];
    q.c += dropped->c;
    get_point(c, move.keep, p);
    get_point(c, move.drop, other);
    cwi_sub(other, p, d);
    memcpy(position, p, sizeof p);
    if (c->orders[move.keep] == CWI_ORDER_INNER)
        find_minimum_between(&q, p, d, position);
    else if (c->orders[move.keep] == c->orders[move.drop])
        find_minimum_along(&q, p, d, position);
    for (int k = 0; k < 3; k++) {
        move.position[k] = (float)position[k];
        position[k] = (double)move.position[k];
    }
    const double weight = q.a[0] + q.a[3] + q.a[5];
    move.cost = (float)(find_error(&q, position) + COST_OF_LENGTH * weight * cwi_dot(d, d));
    return move;
}
